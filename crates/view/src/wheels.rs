//! The wheels of a rigid body: they turn, steer, spring and sink.

use crate::ViewError;
use crate::colour::{GREEN, PURPLE, YELLOW};
use crate::entity::part;
use crate::mesh::{Mesh, Point, single};
use crate::path::Path;
use crate::recorder::Recorder;
use crate::ruts::{at, below_m, hub};
use crate::scene::Scene;
use crate::setting::{Rig, RigWheel};
use crate::strip::round_up;
use crate::tractor;
use crate::turn::{about, quaternion, then};
use headland_trace::Run;
use rerun::{Arrows3D, Color, EntityPath, Mesh3D, Transform3D};
use std::f64::consts::TAU;

/// The longest arrow at a wheel, in radii of it.
const LONGEST: f64 = 3.2;
/// Wheels that slip more are drawn as if they slipped so much: how fast they spin, a slip of 1 does not say.
const MOST_SLIP: f64 = 0.9;

/// How far the tread of a wheel has come at each sample [m]: a wheel that slips by s ≥ 0 rolls at v / (1 − s), one that is braked
/// to s < 0 at v (1 + s).
pub(crate) fn rolled_m(run: &Run, wheel: &RigWheel) -> Vec<f64> {
    let times_s = run.trace.time_s();
    let speeds_m_s = run.trace.get("speed_m_s");
    let mut rolled_m = 0.0;
    (0..times_s.len())
        .map(|row| {
            let slip = at(run, wheel, "slip", row).unwrap_or(0.0).clamp(-MOST_SLIP, MOST_SLIP);
            let speed_m_s = speeds_m_s.map_or(0.0, |speeds| speeds[row]);
            let step_s = row.checked_sub(1).map_or(0.0, |before| times_s[row] - times_s[before]);
            let faster = if slip >= 0.0 { 1.0 / (1.0 - slip) } else { 1.0 + slip };
            if speed_m_s.is_finite() {
                rolled_m += step_s * speed_m_s * faster;
            }
            rolled_m
        })
        .collect()
}

/// Draws the wheels below their vehicle.
pub(crate) fn draw(
    to: &Recorder,
    base: &EntityPath,
    run: &Run,
    path: &Path,
    rig: &Rig,
    look: impl Fn(Mesh) -> Mesh3D,
) -> Result<(), ViewError> {
    for wheel in &rig.wheels {
        let entity = part(&part(base, "wheels"), &wheel.name);
        to.fixed(&entity, &look(tractor::wheel(wheel.radius_m, wheel.width_m)))?;
        let rolled_m = rolled_m(run, wheel);
        let turns = path.poses.iter().map(|pose| {
            let steer_rad = at(run, wheel, "steer_rad", pose.row).unwrap_or(0.0);
            quaternion(then(
                about(2, steer_rad),
                about(1, (rolled_m[pose.row] / wheel.radius_m).rem_euclid(TAU)),
            ))
        });
        let hubs = path.poses.iter().map(|pose| single(hub(run, wheel, pose.row)));
        let columns = Transform3D::update_fields().with_many_translation(hubs).with_many_quaternion(turns);
        to.rows(
            &entity,
            path.poses.iter().map(|pose| pose.time_s),
            columns.columns(vec![1; path.poses.len()]),
        )?;
    }
    Ok(())
}

/// Load, force along the wheel, and across it [N].
fn forces_n(run: &Run, wheel: &RigWheel, row: usize) -> [f64; 3] {
    let value = |what: &str| at(run, wheel, what, row).unwrap_or(0.0);
    [value("load_n"), value("traction_n") - value("resistance_n"), value("side_force_n")]
}

/// How many newtons a metre of arrow at a wheel stands for: a round number, the same for all wheels of a scene; `None` where
/// no run has wheels.
pub(crate) fn newton_per_m(scene: &Scene) -> Option<f64> {
    let of_runs = scene.runs.iter().filter_map(|run| Some((run, scene.rig(&run.id)?)));
    let wheels = of_runs.flat_map(|(run, rig)| rig.wheels.iter().map(move |wheel| (run, wheel)));
    let share = |(run, wheel): (&Run, &RigWheel)| {
        let largest = (0..run.trace.len())
            .flat_map(|row| forces_n(run, wheel, row))
            .fold(0.0f64, |largest, force| largest.max(force.abs()));
        largest / (LONGEST * wheel.radius_m)
    };
    wheels.map(share).reduce(f64::max).filter(|least| *least > 0.0).map(round_up)
}

/// Draws the forces of the ground on each wheel, beside it where it meets the ground.
pub(crate) fn draw_forces(
    to: &Recorder,
    base: &EntityPath,
    run: &Run,
    path: &Path,
    rig: &Rig,
    newton_per_m: f64,
) -> Result<(), ViewError> {
    for wheel in &rig.wheels {
        let entity = part(&part(base, "wheel_forces"), &wheel.name);
        let mut origins: Vec<Point> = Vec::with_capacity(3 * path.poses.len());
        let mut vectors: Vec<Point> = Vec::with_capacity(3 * path.poses.len());
        for pose in &path.poses {
            let [load, along, across] = forces_n(run, wheel, pose.row).map(|force| force / newton_per_m);
            let (sine, cosine) = at(run, wheel, "steer_rad", pose.row).unwrap_or(0.0).sin_cos();
            let out = if wheel.hub_m[1] < 0.0 { -1.0 } else { 1.0 } * (0.55 * wheel.width_m + 0.05);
            let hub = hub(run, wheel, pose.row);
            let foot =
                [hub[0] - sine * out, hub[1] + cosine * out, hub[2] - below_m(run, wheel, pose.row) + 0.1];
            origins.extend([foot; 3]);
            vectors.extend([
                [0.0, 0.0, load],
                [cosine * along, sine * along, 0.0],
                [-sine * across, cosine * across, 0.0],
            ]);
        }
        #[expect(clippy::cast_possible_truncation, reason = "pictures are drawn in single precision")]
        let radius_m = (0.045 * wheel.radius_m) as f32;
        let look = Arrows3D::update_fields()
            .with_colors([YELLOW, GREEN, PURPLE].map(|[red, green, blue]| Color::from_rgb(red, green, blue)))
            .with_radii([radius_m])
            .with_show_labels(false);
        to.fixed(&entity, &look)?;
        let columns = Arrows3D::update_fields()
            .with_vectors(vectors.into_iter().map(single))
            .with_origins(origins.into_iter().map(single))
            .columns(vec![3; path.poses.len()]);
        to.rows(&entity, path.poses.iter().map(|pose| pose.time_s), columns)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::run;
    use crate::setting::tests::wheel;

    /// 2 m/s: a slip of 0.2 rolls at 2.5 m/s, one of −0.5 at 1 m/s.
    #[test]
    fn a_wheel_that_slips_turns_faster_and_a_braked_one_slower() {
        let run = run("r1", &[("speed_m_s", &[2.0, 2.0, 2.0]), ("axle_1_left_slip", &[0.0, 0.2, -0.5])]);
        assert_eq!(rolled_m(&run, &wheel()), [0.0, 2.5, 3.5]);
    }

    #[test]
    fn what_drives_a_wheel_is_its_traction_less_what_resists_it() {
        let run = run(
            "r1",
            &[
                ("speed_m_s", &[2.0]),
                ("axle_1_left_load_n", &[3e4]),
                ("axle_1_left_traction_n", &[5e3]),
                ("axle_1_left_resistance_n", &[2e3]),
            ],
        );
        assert_eq!(forces_n(&run, &wheel(), 0), [3e4, 3e3, 0.0]);
    }
}
