//! A trailer behind its vehicle: a box on a frame, with a drawbar, on wheels that turn and sink.

use crate::ViewError;
use crate::colour::Colour;
use crate::entity::{Who, of_run, part};
use crate::lanes::Lane;
use crate::mesh::{Mesh, single};
use crate::path::{Path, Pose};
use crate::recorder::Recorder;
use crate::setting::Towed;
use crate::summary::Scales;
use crate::turn::{self, quaternion, rotated};
use crate::{ruts, vehicle, wheels};
use headland_trace::Run;
use rerun::Transform3D;

const IRON: Colour = [84, 88, 94];
const WALL: Colour = [138, 146, 150];

/// Where the point of the trailer is that touches level ground, below its centre of gravity, at the samples of its vehicle.
fn poses(run: &Run, path: &Path, towed: &Towed, shift: [f64; 3]) -> Vec<Pose> {
    let value =
        |name: &str, row: usize| run.trace.get(name).map(|values| values[row]).filter(|v| v.is_finite());
    let pose = |of_vehicle: &Pose| {
        let row = of_vehicle.row;
        let pose = Pose {
            heading_rad: value("trailer_heading_rad", row)?,
            roll_rad: value("trailer_roll_rad", row)?,
            pitch_rad: value("trailer_pitch_rad", row)?,
            lift_m: 0.0,
            ..*of_vehicle
        };
        let down = rotated(turn::of(&pose), [0.0, 0.0, -towed.rig.centre_height_m]);
        let centre =
            [value("trailer_east_m", row)?, value("trailer_north_m", row)?, value("trailer_height_m", row)?];
        Some(Pose { at: [0, 1, 2].map(|axis| centre[axis] + down[axis] + shift[axis]), ..pose })
    };
    path.poses.iter().filter_map(pose).collect()
}

/// Everything but the wheels, in the frame of the centre of gravity's foot.
fn body(towed: &Towed, colour: Colour) -> Mesh {
    let wheels = &towed.rig.wheels;
    let most = |of: &dyn Fn(usize) -> f64| (0..wheels.len()).map(of).fold(f64::MIN, f64::max);
    let radius_m = most(&|wheel| wheels[wheel].radius_m);
    let half_m = most(&|wheel| wheels[wheel].hub_m[1].abs() + 0.5 * wheels[wheel].width_m);
    let inner_m = -most(&|wheel| 0.5 * wheels[wheel].width_m - wheels[wheel].hub_m[1].abs());
    let last_m = most(&|wheel| -wheels[wheel].hub_m[0]);
    let [coupling_m, height_m] = towed.coupling_m;
    let (rear, front) = (-last_m - 1.6 * radius_m, (coupling_m - 1.5).max(radius_m));
    let floor = 2.05 * radius_m;
    let mut mesh = Mesh::default();
    let beam = 0.5 * inner_m.max(0.2);
    mesh.block([rear, -beam, floor - 0.25], [front, beam, floor], IRON);
    for wheel in wheels {
        let [x, y, z] = wheel.hub_m;
        let (low, high) = (y.min(0.0), y.max(0.0));
        mesh.block([x - 0.08, low, z - 0.08], [x + 0.08, high, z + 0.08], IRON);
        mesh.block(
            [x - 0.12, y.signum() * beam - 0.06, z],
            [x + 0.12, y.signum() * beam + 0.06, floor],
            IRON,
        );
    }
    // The drawbar rises from the coupling to the frame.
    let (w, t) = (0.07, 0.14);
    mesh.tower(
        [
            [front - 0.3, -w, floor - 0.25],
            [coupling_m, -w, height_m - t / 2.0],
            [coupling_m, w, height_m - t / 2.0],
            [front - 0.3, w, floor - 0.25],
        ],
        [
            [front - 0.3, -w, floor - 0.25 + t],
            [coupling_m, -w, height_m + t / 2.0],
            [coupling_m, w, height_m + t / 2.0],
            [front - 0.3, w, floor - 0.25 + t],
        ],
        IRON,
    );
    mesh.block([rear, -half_m, floor], [front, half_m, floor + 0.15], WALL);
    mesh.block([rear, -half_m, floor + 0.15], [front, half_m, floor + 1.15], colour);
    mesh
}

/// Draws the trailer of a run, its wheels with their forces, and its ruts.
pub(crate) fn draw(to: &Recorder, lane: &Lane, towed: &Towed, scales: &Scales) -> Result<(), ViewError> {
    let Lane { run, path, colour, shift, .. } = lane;
    let path = Path { poses: poses(run, path, towed, *shift), located: true };
    if path.poses.is_empty() {
        return Ok(());
    }
    let base = of_run(&run.id, Who::Modelled, "trailer");
    let transforms = Transform3D::update_fields()
        .with_many_translation(path.poses.iter().map(|pose| single(pose.at)))
        .with_many_quaternion(path.poses.iter().map(|pose| quaternion(turn::of(pose))));
    to.rows(&base, path.poses.iter().map(|pose| pose.time_s), transforms.columns(vec![1; path.poses.len()]))?;
    to.fixed(&part(&base, "body"), &vehicle::surface(&body(towed, *colour)))?;
    wheels::draw(to, &base, run, &path, &towed.rig, |mesh| vehicle::surface(&mesh))?;
    if let Some(newton_per_m) = scales.wheels_newton_per_m {
        wheels::draw_forces(to, &base, run, &path, &towed.rig, newton_per_m)?;
    }
    ruts::draw(to, run, &path, &towed.rig, scales.deepest_m, "trailer_ruts")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::run;
    use crate::setting::Rig;

    /// Heading east and level, its centre of gravity 1.4 m up: its foot is below it, moved as the run was.
    #[test]
    fn a_trailer_stands_below_its_centre_of_gravity() {
        let run = run(
            "r1",
            &[
                ("trailer_east_m", &[5.0]),
                ("trailer_north_m", &[7.0]),
                ("trailer_height_m", &[3.0]),
                ("trailer_heading_rad", &[std::f64::consts::FRAC_PI_2]),
                ("trailer_roll_rad", &[0.0]),
                ("trailer_pitch_rad", &[0.0]),
            ],
        );
        let towed = Towed { rig: Rig { centre_height_m: 1.4, wheels: Vec::new() }, coupling_m: [4.0, 0.7] };
        let path = Path { poses: vec![Pose { lift_m: 9.0, ..Pose::default() }], located: true };
        let poses = poses(&run, &path, &towed, [100.0, 0.0, -1.0]);
        let near = poses[0].at.iter().zip([105.0, 7.0, 0.6]).all(|(at, wanted)| (at - wanted).abs() < 1e-12);
        assert!(near && poses[0].lift_m == 0.0, "{poses:?}");
    }
}
