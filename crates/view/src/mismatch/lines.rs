//! Lines over time: the signal before and after, what is left over of the balance, and the effects with their bands.

use super::scale::smoothed;
use super::{Diagnosis, Shown, Stage};
use crate::ViewError;
use crate::colour::{Colour, GREEN, MEASURED, MODELLED, PURPLE, SKY_BLUE, YELLOW, pale};
use crate::entity;
use crate::plots::line;
use crate::recorder::Recorder;
use rerun::EntityPath;

/// The model with what was found, in every plot.
const AFTER: Colour = GREEN;
/// The effects, one after another.
const EFFECTS: [Colour; 3] = [PURPLE, YELLOW, SKY_BLUE];

/// The line of the signal, of a stage or as it was measured.
pub(crate) fn signal(shown: &Shown) -> EntityPath {
    entity::diagnosed(shown.run, "signal", "all")
}

/// The lines of its error.
pub(crate) fn error(shown: &Shown) -> EntityPath {
    entity::diagnosed(shown.run, "error", "all")
}

/// The lines of what is left over.
pub(crate) fn left_over(shown: &Shown) -> EntityPath {
    entity::diagnosed(shown.run, "left", "all")
}

/// The lines of an effect.
pub(crate) fn effect(shown: &Shown, index: usize) -> EntityPath {
    entity::diagnosed(shown.run, "effect", &index.to_string())
}

/// A line of a plot: the viewer draws them in the order of their names.
fn layered(plot: &EntityPath, layer: usize) -> EntityPath {
    entity::part(plot, &layer.to_string())
}

/// Draws all lines of a run.
pub(crate) fn draw(to: &Recorder, diagnosis: &Diagnosis, shown: &Shown) -> Result<(), ViewError> {
    let stages = [("before", shown.before, MODELLED), ("after", shown.after, AFTER)];
    let at = signal(shown);
    let measured = [("measured", shown.measured, MEASURED)];
    for (layer, (name, values, colour)) in measured.into_iter().chain(stages).enumerate() {
        let width = if layer == 0 { 1.2 } else { 2.0 };
        line(to, &layered(&at, layer), name, colour, width, shown.time_s, values)?;
    }
    let at = error(shown);
    for (layer, (name, values, colour)) in stages.into_iter().enumerate() {
        let error: Vec<f64> = shown.measured.iter().zip(values).map(|(one, other)| one - other).collect();
        line(to, &layered(&at, layer), name, colour, 1.5, shown.time_s, &error)?;
    }
    if let Some(left) = diagnosis.left.iter().find(|left| left.run.id == shown.run) {
        let at = left_over(shown);
        for (layer, (stage, colour)) in
            [(Stage::Before, MODELLED), (Stage::After, AFTER)].into_iter().enumerate()
        {
            let values = smoothed(left, stage);
            line(to, &layered(&at, layer), stage.name(), colour, 2.0, left.time_s, &values)?;
        }
    }
    for (index, one) in shown.effects.iter().enumerate() {
        let at = effect(shown, index);
        let colour = EFFECTS[index % EFFECTS.len()];
        let lines = [
            ("_low", "95 % band, low", pale(colour), 1.0),
            ("_high", "95 % band, high", pale(colour), 1.0),
            ("", one.name.as_str(), colour, 2.0),
        ];
        for (layer, (end, name, colour, width)) in lines.into_iter().enumerate() {
            let Some(values) = one.trace.get(&format!("{}{end}", one.channel)) else { continue };
            line(to, &layered(&at, layer), name, colour, width, one.trace.time_s(), values)?;
        }
    }
    Ok(())
}
