//! Centre of gravity, plumb line and velocity of a rigid body.
//!
//! The centre is hidden in the vehicle, so a bar goes through it from side to side.

use crate::ViewError;
use crate::entity::{Who, of_run, part, vehicle};
use crate::mesh::{Point, single};
use crate::path::{Path, Pose};
use crate::recorder::Recorder;
use crate::scene::Body;
use crate::setting::Rig;
use crate::strip::round_up;
use crate::turn::{self, rotated};
use headland_trace::Run;
use rerun::{Arrows3D, Color, LineStrips3D, Points3D};

/// The longest arrow of a velocity, in lengths of the vehicle.
const LONGEST: f64 = 0.9;
const WHITE: [u8; 3] = [245, 245, 245];

/// How many metres a second a metre of arrow stands for.
pub(crate) fn m_s_per_m(runs: &[Run], body: &Body) -> f64 {
    let speeds = runs.iter().filter_map(|run| run.trace.get("speed_m_s")).flatten();
    let fastest = speeds.filter(|speed| speed.is_finite()).fold(0.0f64, |most, speed| most.max(speed.abs()));
    if fastest > 0.0 { round_up(fastest / (LONGEST * body.length_m)) } else { 1.0 }
}

/// What is so far left of the centre of gravity, in the world [m].
fn beside(pose: &Pose, rig: &Rig, left_m: f64) -> Point {
    let arm = rotated(turn::of(pose), [0.0, left_m, rig.centre_height_m]);
    [pose.at[0] + arm[0], pose.at[1] + arm[1], pose.at[2] + pose.lift_m + arm[2]]
}

/// Draws the centre of gravity with the plumb line through it, and the velocity over the roof.
pub(crate) fn draw(
    to: &Recorder,
    run: &Run,
    path: &Path,
    rig: &Rig,
    body: &Body,
    (m_s_per_m, labelled): (f64, bool),
) -> Result<(), ViewError> {
    let base = vehicle(&run.id, Who::Modelled);
    let times = || path.poses.iter().map(|pose| pose.time_s);
    let each = || vec![1; path.poses.len()];
    let [red, green, blue] = WHITE;
    let white = Color::from_rgb(red, green, blue);
    let entity = of_run(&run.id, Who::Modelled, "centre_of_gravity");
    let half_m = 0.5 * body.width_m + 0.25;
    let ends = |pose: &Pose| [half_m, -half_m].map(|left_m| single(beside(pose, rig, left_m)));
    to.fixed(&entity, &Points3D::update_fields().with_colors([white]).with_radii([0.11]))?;
    let places = path.poses.iter().flat_map(ends);
    let twice = vec![2; path.poses.len()];
    to.rows(&entity, times(), Points3D::update_fields().with_positions(places).columns(twice))?;
    let bar = part(&entity, "bar");
    to.fixed(&bar, &LineStrips3D::update_fields().with_colors([white]).with_radii([0.035]))?;
    let bars = path.poses.iter().map(ends);
    to.rows(&bar, times(), LineStrips3D::update_fields().with_strips(bars).columns(each()))?;
    let entity = of_run(&run.id, Who::Modelled, "plumb_line");
    to.fixed(&entity, &LineStrips3D::update_fields().with_colors([white]).with_radii([0.025]))?;
    let lines = path.poses.iter().map(|pose| {
        let [east, north, up] = beside(pose, rig, 0.0);
        [[east, north, pose.at[2]], [east, north, up - rig.centre_height_m + 1.06 * body.height_m]]
            .map(single)
    });
    to.rows(&entity, times(), LineStrips3D::update_fields().with_strips(lines).columns(each()))?;
    let entity = part(&base, "velocity");
    to.fixed(
        &entity,
        &Arrows3D::update_fields().with_colors([white]).with_radii([0.07]).with_show_labels(labelled),
    )?;
    let value = |name: &str, pose: &Pose| {
        run.trace.get(name).map(|values| values[pose.row]).filter(|value| value.is_finite()).unwrap_or(0.0)
    };
    let velocities: Vec<[f64; 2]> =
        path.poses.iter().map(|pose| [value("speed_m_s", pose), value("side_speed_m_s", pose)]).collect();
    let columns = Arrows3D::update_fields()
        .with_origins(path.poses.iter().map(|_| single([0.0, 0.0, 1.06 * body.height_m])))
        .with_vectors(
            velocities.iter().map(|[ahead, left]| single([ahead / m_s_per_m, left / m_s_per_m, 0.0])),
        )
        .with_labels(velocities.iter().map(|[ahead, left]| format!("{:.1} m/s", ahead.hypot(*left))))
        .columns(each());
    to.rows(&entity, times(), columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vehicle on a side slope: its centre of gravity leans to the side that is down, here the right one (east).
    #[test]
    fn the_centre_of_gravity_leans_with_the_vehicle() {
        let rig = Rig { centre_height_m: 1.2, wheels: Vec::new() };
        let pose = Pose { at: [1.0, 2.0, 3.0], roll_rad: 0.3, ..Pose::default() };
        let [east, north, up] = beside(&pose, &rig, 0.0);
        assert!((east - 1.0 - 1.2 * 0.3f64.sin()).abs() < 1e-12 && (north - 2.0).abs() < 1e-12);
        assert!((up - 3.0 - 1.2 * 0.3f64.cos()).abs() < 1e-12);
    }
}
