//! A vehicle that moves.

use crate::ViewError;
use crate::colour::{Colour, MODELLED, pale};
use crate::entity::{self, Who, line, part, vehicle};
use crate::mesh::{Mesh, single};
use crate::path::{Path, Pose};
use crate::recorder::Recorder;
use crate::scene::Body;
use crate::setting::Rig;
use crate::turn::{self, quaternion};
use crate::{tractor, wheels};
use headland_trace::Run;
use rerun::{Angle, Color, LineStrips3D, Mesh3D, Points3D, Rgba32, RotationAxisAngle, Transform3D};

/// How much of what lies behind a recorded vehicle it hides, out of 255.
const GHOST: u8 = 110;

/// How far around the vehicle's middle there has to be something to see, in its lengths.
const REACH: f64 = 0.79;

/// A colour as light as a part of the vehicle, or half as dark.
fn tinted(colour: Colour, [red, green, blue]: Colour) -> Colour {
    let light = (u16::from(red) + u16::from(green) + u16::from(blue)) / 6 + 127;
    colour.map(|part| u8::try_from(u16::from(part) * light / 255).unwrap_or(u8::MAX))
}

/// How far a wheel has turned [rad], kept within one turn.
fn roll_rad(pose: &Pose, radius_m: f64) -> f64 {
    (pose.travelled_m / radius_m).rem_euclid(std::f64::consts::TAU)
}

pub(crate) fn surface(mesh: &Mesh) -> Mesh3D {
    Mesh3D::new(mesh.positions.iter().copied())
        .with_vertex_normals(mesh.normals.iter().copied())
        .with_triangle_indices(mesh.triangles.iter().copied())
        .with_vertex_colors(
            mesh.colours.iter().map(|[red, green, blue]| Color::from_rgb(*red, *green, *blue)),
        )
}

/// Draws the vehicle of a run along its path, under a name; on a rig, with the wheels of that.
pub(crate) fn drive(
    to: &Recorder,
    (run, rig): (&Run, Option<&Rig>),
    who: Who,
    path: &Path,
    body: &Body,
    (name, colour): (&str, Colour),
) -> Result<(), ViewError> {
    let base = vehicle(&run.id, who);
    let times = || path.poses.iter().map(|pose| pose.time_s);
    let each = || vec![1; path.poses.len()];
    let transforms = Transform3D::update_fields()
        .with_many_translation(
            path.poses.iter().map(|pose| single([pose.at[0], pose.at[1], pose.at[2] + pose.lift_m])),
        )
        .with_many_quaternion(path.poses.iter().map(|pose| quaternion(turn::of(pose))));
    to.rows(&base, times(), transforms.columns(each()))?;
    let look = |mut mesh: Mesh| -> Mesh3D {
        if who == Who::Modelled {
            mesh.recolour(|part| if part == MODELLED { colour } else { part });
            return surface(&mesh);
        }
        mesh.recolour(|part| tinted(pale(colour), part));
        surface(&mesh).with_albedo_factor(Rgba32::from_unmultiplied_rgba(255, 255, 255, GHOST))
    };
    to.fixed(&part(&base, "body"), &look(tractor::body(body)))?;
    if let Some(rig) = rig {
        let seat = Transform3D::from_translation(single(rig.seat_m(body.wheel_radius_m)));
        to.fixed(&part(&base, "body"), &seat)?;
        wheels::draw(to, &base, run, path, rig, look)?;
    }
    for (side, at) in tractor::wheels(body).into_iter().filter(|_| rig.is_none()) {
        let wheel = part(&part(&base, "wheels"), side);
        to.fixed(&wheel, &look(tractor::wheel(body.wheel_radius_m, tractor::tyre_width_m(body))))?;
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
        to.fixed(&entity::reach(&run.id), &Points3D::new(ends).with_radii([1e-3]))?;
    }
    let [red, green, blue] = colour;
    let above_m = if who == Who::Modelled { 0.06 } else { 0.04 };
    let points = path.poses.iter().map(|pose| single([pose.at[0], pose.at[1], pose.at[2] + above_m]));
    let driven = LineStrips3D::new([points.collect::<Vec<_>>()])
        .with_radii([0.04])
        .with_colors([Color::from_rgb(red, green, blue)]);
    to.fixed(&line(&run.id, who), &driven)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// v' = v + 2 u × (u × v + w v), the rotation of a vector by a unit quaternion.
    #[test]
    fn a_wheel_turns_once_in_its_circumference() {
        let pose = |travelled_m| Pose { travelled_m, ..Pose::default() };
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!((roll_rad(&pose(quarter), 1.0) - quarter).abs() < 1e-12);
        assert!((roll_rad(&pose(5.0 * quarter), 1.0) - quarter).abs() < 1e-12);
        assert!((roll_rad(&pose(-quarter), 1.0) - 3.0 * quarter).abs() < 1e-12);
    }
}
