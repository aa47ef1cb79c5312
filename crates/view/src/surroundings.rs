//! The ground that everything drives over.

use crate::ViewError;
use crate::entity;
use crate::lanes::{LANE, Lane};
use crate::mesh::single;
use crate::recorder::Recorder;
use crate::scene::Scene;
use crate::strip::{strip, surface};
use crate::vehicle;
use rerun::{Color, Points3D};

/// Strips that lie on one another are kept apart by this [m].
const LAYER_M: f64 = 0.02;

/// Draws the ground; gives the length of the light and dark pieces below the first run, where there are any [m].
pub(crate) fn draw(
    to: &Recorder,
    scene: &Scene,
    lanes: &[Lane],
    shift: [f64; 3],
) -> Result<Option<f64>, ViewError> {
    if let Some(mesh) = scene.ground.as_ref().and_then(|ground| surface(ground, shift)) {
        to.fixed(&entity::ground("surface"), &vehicle::surface(&mesh))?;
        return Ok(None);
    }
    let mut stripe_m = None;
    for (layer, lane) in lanes.iter().enumerate() {
        let body = &scene.vehicle;
        let mut strip = strip(&lane.path, LANE * body.width_m, 3.0 * body.length_m);
        for position in &mut strip.mesh.positions {
            position[2] -= single([0.0, 0.0, LAYER_M * (layer + 1) as f64])[2];
        }
        let at = entity::ground(&lane.run.id);
        to.fixed(&at, &vehicle::surface(&strip.mesh))?;
        let marks = Points3D::new(strip.marks.iter().map(|(at, _)| single(*at)))
            .with_radii([0.12])
            .with_colors([Color::from_rgb(235, 235, 235)])
            .with_labels(strip.marks.iter().map(|(_, from_start_m)| format!("{from_start_m:.0} m")))
            .with_show_labels(true);
        to.fixed(&entity::part(&at, "distance"), &marks)?;
        stripe_m = stripe_m.or(Some(strip.stripe_m));
    }
    Ok(stripe_m)
}
