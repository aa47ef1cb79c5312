//! A vehicle that moves.

use crate::ViewError;
use crate::colour::{Colour, MODELLED, pale};
use crate::entity::{self, Who, line, part, vehicle};
use crate::mesh::{Mesh, single};
use crate::path::{Path, Pose};
use crate::recorder::Recorder;
use crate::scene::Body;
use crate::tractor;
use rerun::{
    Angle, Color, LineStrips3D, Mesh3D, Points3D, Quaternion, Rgba32, RotationAxisAngle, Transform3D,
};

/// How much of what lies behind a recorded vehicle it hides, out of 255.
const GHOST: u8 = 110;

/// How far around the vehicle's middle there has to be something to see, in its lengths.
const REACH: f64 = 0.79;

/// Turns what looks along x to where the pose looks: q = q_z(π/2 − heading) q_y(−pitch), as x, y, z, w.
fn turn(pose: &Pose) -> [f64; 4] {
    let (sine_z, cosine_z) = ((std::f64::consts::FRAC_PI_2 - pose.heading_rad) / 2.0).sin_cos();
    let (sine_y, cosine_y) = (-pose.pitch_rad / 2.0).sin_cos();
    [-sine_z * sine_y, cosine_z * sine_y, sine_z * cosine_y, cosine_z * cosine_y]
}

/// A colour as light as a part of the vehicle, or half as dark.
fn tinted(colour: Colour, [red, green, blue]: Colour) -> Colour {
    let light = (u16::from(red) + u16::from(green) + u16::from(blue)) / 6 + 127;
    colour.map(|part| u8::try_from(u16::from(part) * light / 255).unwrap_or(u8::MAX))
}

/// How far a wheel has turned [rad], kept within one turn.
fn roll_rad(pose: &Pose, radius_m: f64) -> f64 {
    (pose.travelled_m / radius_m).rem_euclid(std::f64::consts::TAU)
}

#[expect(clippy::cast_possible_truncation, reason = "pictures are drawn in single precision")]
fn quaternion(pose: &Pose) -> Quaternion {
    Quaternion::from_xyzw(turn(pose).map(|part| part as f32))
}

pub(crate) fn surface(mesh: &Mesh) -> Mesh3D {
    Mesh3D::new(mesh.positions.iter().copied())
        .with_vertex_normals(mesh.normals.iter().copied())
        .with_triangle_indices(mesh.triangles.iter().copied())
        .with_vertex_colors(
            mesh.colours.iter().map(|[red, green, blue]| Color::from_rgb(*red, *green, *blue)),
        )
}

/// Draws the vehicle of a run along its path, under a name.
pub(crate) fn drive(
    to: &Recorder,
    run: &str,
    who: Who,
    path: &Path,
    body: &Body,
    (name, colour): (&str, Colour),
) -> Result<(), ViewError> {
    let base = vehicle(run, who);
    let times = || path.poses.iter().map(|pose| pose.time_s);
    let each = || vec![1; path.poses.len()];
    let transforms = Transform3D::update_fields()
        .with_many_translation(path.poses.iter().map(|pose| single(pose.at)))
        .with_many_quaternion(path.poses.iter().map(quaternion));
    to.rows(&base, times(), transforms.columns(each()))?;
    let look = |mut mesh: Mesh| {
        if who == Who::Modelled {
            mesh.recolour(|part| if part == MODELLED { colour } else { part });
            return surface(&mesh);
        }
        mesh.recolour(|part| tinted(pale(colour), part));
        surface(&mesh).with_albedo_factor(Rgba32::from_unmultiplied_rgba(255, 255, 255, GHOST))
    };
    to.fixed(&part(&base, "body"), &look(tractor::body(body)))?;
    for (side, at) in tractor::wheels(body) {
        let wheel = part(&part(&base, "wheels"), side);
        to.fixed(&wheel, &look(tractor::wheel(body)))?;
        #[expect(clippy::cast_possible_truncation, reason = "pictures are drawn in single precision")]
        let angle = |pose: &Pose| Angle::from_radians(roll_rad(pose, body.wheel_radius_m) as f32);
        let turns = Transform3D::update_fields()
            .with_many_translation(path.poses.iter().map(|_| single(at)))
            .with_many_rotation_axis_angle(
                path.poses.iter().map(|pose| RotationAxisAngle::new([0.0, 1.0, 0.0], angle(pose))),
            );
        to.rows(&wheel, times(), turns.columns(each()))?;
    }
    if !name.is_empty() {
        let above = [0.0, 0.0, body.height_m * if who == Who::Modelled { 1.2 } else { 1.4 }];
        let label = Points3D::new([single(above)])
            .with_radii([0.01])
            .with_colors([Color::from_rgb(colour[0], colour[1], colour[2])])
            .with_labels([name]);
        to.fixed(&part(&base, "name"), &label)?;
    }
    if who == Who::Modelled {
        // The eye keeps one and a half times the extent of what it follows, 2 · 0.79 lengths here: as far as it starts.
        let reach_m = REACH * body.length_m.max(body.height_m);
        let ends = [-reach_m, reach_m].map(|ahead| single([ahead, 0.0, body.height_m / 2.0]));
        to.fixed(&entity::reach(run), &Points3D::new(ends).with_radii([1e-3]))?;
    }
    let [red, green, blue] = colour;
    let above_m = if who == Who::Modelled { 0.06 } else { 0.04 };
    let points = path.poses.iter().map(|pose| single([pose.at[0], pose.at[1], pose.at[2] + above_m]));
    let driven = LineStrips3D::new([points.collect::<Vec<_>>()])
        .with_radii([0.04])
        .with_colors([Color::from_rgb(red, green, blue)]);
    to.fixed(&line(run, who), &driven)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// v' = v + 2 u × (u × v + w v), the rotation of a vector by a unit quaternion.
    fn rotated([x, y, z, w]: [f64; 4], v: [f64; 3]) -> [f64; 3] {
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let u = [x, y, z];
        let inner = cross(u, v);
        let turned = cross(u, [0, 1, 2].map(|axis| inner[axis] + w * v[axis]));
        [0, 1, 2].map(|axis| v[axis] + 2.0 * turned[axis])
    }

    /// The nose points to (sin h cos p, cos h cos p, sin p), the left side stays level.
    #[test]
    fn the_nose_points_where_the_heading_and_the_pitch_say() {
        for (heading_rad, pitch_rad) in [(0.0f64, 0.0f64), (1.2, 0.3), (-2.0, -0.1), (3.0, 0.2)] {
            let pose = Pose { time_s: 0.0, travelled_m: 0.0, at: [0.0; 3], heading_rad, pitch_rad };
            let nose = rotated(turn(&pose), [1.0, 0.0, 0.0]);
            let level = pitch_rad.cos();
            let expected = [heading_rad.sin() * level, heading_rad.cos() * level, pitch_rad.sin()];
            assert!(nose.iter().zip(expected).all(|(nose, expected)| (nose - expected).abs() < 1e-12));
            let left = rotated(turn(&pose), [0.0, 1.0, 0.0]);
            let expected = [-heading_rad.cos(), heading_rad.sin(), 0.0];
            assert!(left.iter().zip(expected).all(|(left, expected)| (left - expected).abs() < 1e-12));
        }
    }

    #[test]
    fn a_wheel_turns_once_in_its_circumference() {
        let pose =
            |travelled_m| Pose { time_s: 0.0, travelled_m, at: [0.0; 3], heading_rad: 0.0, pitch_rad: 0.0 };
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!((roll_rad(&pose(quarter), 1.0) - quarter).abs() < 1e-12);
        assert!((roll_rad(&pose(5.0 * quarter), 1.0) - quarter).abs() < 1e-12);
        assert!((roll_rad(&pose(-quarter), 1.0) - 3.0 * quarter).abs() < 1e-12);
    }
}
