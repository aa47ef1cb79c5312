//! What wheels leave behind: their ruts, as far as the vehicle has come.
//!
//! The viewer shows the latest state of each entity, so a rut that grows sample by sample would be stored over and over; it
//! is cut into pieces instead, and only the piece below the vehicle grows.

use crate::ViewError;
use crate::colour::Colour;
use crate::entity::{Who, of_run, part};
use crate::mesh::{Mesh, Point};
use crate::path::{Path, Pose};
use crate::recorder::Recorder;
use crate::setting::{Rig, RigWheel};
use crate::turn::{self, rotated};
use crate::vehicle;
use headland_trace::Run;

/// Pieces of a run's ruts, and stages in which each of them grows.
const PIECES: usize = 48;
const STAGES: usize = 12;
/// Ruts are drawn so far above the ground, which would hide them [m]; a deeper one lies on top of a shallower one in the same
/// place, by as much as they differ in depth.
const ABOVE_M: f64 = 0.03;
/// Of no depth, and of the deepest.
const SHALLOW: Colour = [84, 62, 46];
const DEEP: Colour = [22, 14, 10];

/// Where a wheel touches the ground: left and right edge of its rut, and how deep that is [m].
type Print = Option<([Point; 2], f64)>;

/// A value of a wheel at a sample.
pub(crate) fn at(run: &Run, wheel: &RigWheel, what: &str, row: usize) -> Option<f64> {
    run.trace
        .get(&format!("{}_{what}", wheel.name))
        .map(|values| values[row])
        .filter(|value| value.is_finite())
}

/// Hub of a wheel in the vehicle's frame, with what its suspension gives way [m].
pub(crate) fn hub(run: &Run, wheel: &RigWheel, row: usize) -> Point {
    let raised_m =
        at(run, wheel, "suspension_m", row).map_or(0.0, |squeezed_m| squeezed_m - wheel.squeezed_m);
    [wheel.hub_m[0], wheel.hub_m[1], wheel.hub_m[2] + raised_m]
}

/// Where the ground lies below the hub, in the vehicle's frame [m].
pub(crate) fn below_m(run: &Run, wheel: &RigWheel, row: usize) -> f64 {
    let given_m = at(run, wheel, "deflection_m", row).unwrap_or(0.0).max(0.0);
    wheel.radius_m - given_m - at(run, wheel, "sinkage_m", row).unwrap_or(0.0)
}

fn print(run: &Run, wheel: &RigWheel, pose: &Pose) -> Print {
    let pressed = at(run, wheel, "load_n", pose.row).is_some_and(|load| load > 0.0);
    let turn = turn::of(pose);
    let mut foot = hub(run, wheel, pose.row);
    foot[2] -= below_m(run, wheel, pose.row);
    let steer_rad = at(run, wheel, "steer_rad", pose.row).unwrap_or(0.0);
    let across = [-steer_rad.sin(), steer_rad.cos(), 0.0];
    let depth_m = at(run, wheel, "sinkage_m", pose.row).unwrap_or(0.0);
    let edge = |side: f64| {
        let arm = [0, 1, 2].map(|axis| foot[axis] + side * 0.5 * wheel.width_m * across[axis]);
        let arm = rotated(turn, arm);
        [pose.at[0] + arm[0], pose.at[1] + arm[1], pose.at[2] + pose.lift_m + arm[2] + ABOVE_M + depth_m]
    };
    pressed.then(|| ([edge(1.0), edge(-1.0)], depth_m))
}

/// The deepest rut of a run [m]; `None` where no soil says a depth.
pub(crate) fn deepest_m(run: &Run, rig: &Rig) -> Option<f64> {
    let channels = rig.wheels.iter().filter_map(|wheel| run.trace.get(&format!("{}_sinkage_m", wheel.name)));
    channels.flatten().copied().filter(|depth| depth.is_finite()).reduce(f64::max)
}

/// Draws the ruts of a run under a name; `deepest_m` is that of the scene.
pub(crate) fn draw(
    to: &Recorder,
    run: &Run,
    path: &Path,
    rig: &Rig,
    deepest_m: Option<f64>,
    name: &str,
) -> Result<(), ViewError> {
    let stations = stations(&path.poses);
    let prints: Vec<Vec<Print>> = rig
        .wheels
        .iter()
        .map(|wheel| stations.iter().map(|pose| print(run, wheel, pose)).collect())
        .collect();
    let base = of_run(&run.id, Who::Modelled, name);
    let length = stations.len().saturating_sub(1).div_ceil(PIECES).max(1);
    let last = stations.len().saturating_sub(1);
    for (piece, first) in (0..last).step_by(length).enumerate() {
        let entity = part(&base, &format!("{piece:02}"));
        let end = (first + length).min(last);
        let stride = (end - first).div_ceil(STAGES).max(1);
        for to_station in (first + 1..=end).filter(|at| (at - first) % stride == 0 || *at == end) {
            let mesh = ribbons(&prints, first..to_station, deepest_m);
            if mesh.triangles.is_empty() {
                continue;
            }
            to.at(&entity, stations[to_station].time_s, &vehicle::surface(&mesh))?;
        }
    }
    Ok(())
}

/// Poses that are some way apart: as many as there are stages.
fn stations(poses: &[Pose]) -> Vec<Pose> {
    let way_m: f64 = poses.windows(2).map(|pair| apart_m(&pair[0], &pair[1])).sum();
    let least_m = (way_m / (PIECES * STAGES) as f64).max(0.02);
    let mut stations: Vec<Pose> = Vec::new();
    for pose in poses {
        if stations.last().is_none_or(|last| apart_m(last, pose) >= least_m) {
            stations.push(*pose);
        }
    }
    stations
}

fn apart_m(one: &Pose, other: &Pose) -> f64 {
    (one.at[0] - other.at[0]).hypot(one.at[1] - other.at[1])
}

fn ribbons(prints: &[Vec<Print>], stations: std::ops::Range<usize>, deepest_m: Option<f64>) -> Mesh {
    let mut mesh = Mesh::default();
    for wheel in prints {
        for station in stations.clone() {
            let (Some((from, depth_m)), Some((to, _))) = (&wheel[station], &wheel[station + 1]) else {
                continue;
            };
            let share = deepest_m.filter(|deepest| *deepest > 0.0).map_or(0.0, |deepest| depth_m / deepest);
            mesh.face(&[from[1], to[1], to[0], from[0]], of_depth(share));
        }
    }
    mesh
}

/// Darker the deeper, from no depth at 0 to the deepest at 1.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two colours")]
fn of_depth(share: f64) -> Colour {
    [0, 1, 2].map(|axis| {
        let (one, other) = (f64::from(SHALLOW[axis]), f64::from(DEEP[axis]));
        (one + share.clamp(0.0, 1.0) * (other - one)).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::run;
    use crate::setting::tests::wheel;

    /// Heading north: ahead is north, left is west. The suspension is 0.05 m more squeezed than on level ground, the tyre gives
    /// way by 0.1 m and stands 0.2 m deep: the ground was at 0.9 + 0.05 − (1.0 − 0.1 − 0.2) = 0.25 m.
    #[test]
    fn a_rut_lies_below_its_wheel_where_the_ground_was() {
        let run = run(
            "r1",
            &[
                ("position_m", &[0.0]),
                ("axle_1_left_load_n", &[1e4]),
                ("axle_1_left_suspension_m", &[0.15]),
                ("axle_1_left_deflection_m", &[0.1]),
                ("axle_1_left_sinkage_m", &[0.2]),
            ],
        );
        let pose = Pose { at: [10.0, 20.0, 5.0], lift_m: 0.5, ..Pose::default() };
        let ([left, right], depth_m) = print(&run, &wheel(), &pose).unwrap();
        let near = |one: Point, other: Point| one.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(near(left, [10.0 - 1.3, 21.5, 5.5 + 0.25 + ABOVE_M + 0.2]), "{left:?}");
        assert!(near(right, [10.0 - 0.7, 21.5, 5.5 + 0.25 + ABOVE_M + 0.2]) && depth_m == 0.2, "{right:?}");
    }

    #[test]
    fn a_wheel_in_the_air_leaves_no_rut() {
        let run = run("r1", &[("position_m", &[0.0]), ("axle_1_left_load_n", &[0.0])]);
        assert_eq!(print(&run, &wheel(), &Pose::default()), None);
        let mesh = ribbons(&[vec![None, None]], 0..1, None);
        assert!(mesh.triangles.is_empty());
    }
}
