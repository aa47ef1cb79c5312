//! The ground that everything drives over.

use crate::ViewError;
use crate::entity;
use crate::lanes::{LANE, Lane};
use crate::mesh::single;
use crate::path::Pose;
use crate::recorder::Recorder;
use crate::relief::survey;
use crate::scene::Scene;
use crate::strip::{Strip, strip, surface};
use crate::summary::Grounds;
use crate::vehicle;
use rerun::{Color, EntityPath, Points3D};

/// Strips that lie on one another are kept apart by this [m].
const LAYER_M: f64 = 0.02;
/// How far to both sides of a path its ground is drawn, in lengths of the vehicle; of several runs, half of a lane.
const REACH: f64 = 3.0;

/// Draws the ground of all runs, and says what was drawn.
pub(crate) fn draw(to: &Recorder, scene: &Scene, lanes: &[Lane]) -> Result<Grounds, ViewError> {
    let shift = lanes.first().map_or([0.0; 3], |lane| lane.shift);
    if let Some(mesh) = scene.ground.as_ref().and_then(|ground| surface(ground, shift)) {
        to.fixed(&entity::ground("surface"), &vehicle::surface(&mesh))?;
        return Ok(Grounds::default());
    }
    let mut grounds = Grounds::default();
    let body = &scene.vehicle;
    let relief_of = |lane: &Lane| scene.setting(&lane.run.id).and_then(|setting| setting.relief);
    for (layer, lane) in lanes.iter().enumerate() {
        let at = entity::ground(&lane.run.id);
        let mut strip = strip(&lane.path, LANE * body.width_m, 3.0 * body.length_m);
        if let Some(relief) = relief_of(lane) {
            let poses = poses_on(lanes, lane, |other| relief_of(other).is_some());
            if let Some(poses) = poses {
                let reach_m = if lanes.len() > 1 { 0.5 * LANE * body.width_m } else { REACH * body.length_m };
                if let Some(ground) = survey(relief, &poses, reach_m, lane.shift) {
                    to.fixed(&entity::part(&at, "surface"), &vehicle::surface(&ground.mesh))?;
                    grounds.surveyed.push(ground);
                }
            }
        } else {
            for position in &mut strip.mesh.positions {
                position[2] -= single([0.0, 0.0, LAYER_M * (layer + 1) as f64])[2];
            }
            to.fixed(&at, &vehicle::surface(&strip.mesh))?;
            grounds.stripe_m = grounds.stripe_m.or(Some(strip.stripe_m));
        }
        if let Some(relief) = relief_of(lane) {
            for (at, _) in &mut strip.marks {
                let [east_m, north_m] = [0, 1].map(|axis| at[axis] - lane.shift[axis]);
                at[2] = relief.height_m(east_m, north_m).map_or(at[2], |height_m| height_m + lane.shift[2]);
            }
        }
        marks(to, &at, &strip, layer == 0)?;
    }
    Ok(grounds)
}

/// The places of all runs that were moved as this one was, if it is the first of them: they share one surface.
fn poses_on(lanes: &[Lane], lane: &Lane, with: impl Fn(&Lane) -> bool) -> Option<Vec<Pose>> {
    let mut alike = lanes.iter().filter(|other| other.shift == lane.shift && with(other)).peekable();
    let first = alike.peek().is_some_and(|first| first.run.id == lane.run.id);
    first.then(|| alike.flat_map(|other| other.path.poses.iter().copied()).collect())
}

/// How far along the path a place is.
fn marks(to: &Recorder, at: &EntityPath, strip: &Strip, labelled: bool) -> Result<(), ViewError> {
    let marks = Points3D::new(strip.marks.iter().map(|(at, _)| single(*at)))
        .with_radii([0.12])
        .with_colors([Color::from_rgb(235, 235, 235)])
        .with_labels(strip.marks.iter().map(|(_, from_start_m)| format!("{from_start_m:.0} m")))
        .with_show_labels(labelled);
    to.fixed(&entity::part(at, "distance"), &marks)
}
