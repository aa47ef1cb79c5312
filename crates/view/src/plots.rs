//! Channels as lines over time.

use crate::axis::Span;
use crate::colour::{Colour, RESIDUAL, pale};
use crate::entity::{self, Who};
use crate::groups::{self, Group};
use crate::lanes::Lane;
use crate::recorder::Recorder;
use crate::thin::{MOST, thin};
use crate::wheel_channel::of_wheel;
use crate::{Scene, ViewError};
use headland_trace::{Origin, Run};
use rerun::{Color, EntityPath, Scalars, SeriesLines};

/// The channel whose difference gets a line of its own.
pub(crate) const COMPARED: &str = "speed_m_s";

/// Channels by which several runs are held beside one another: channel, title with its unit, and the factor to that unit.
pub(crate) const BESIDE: [(&str, &str, f64); 3] = [
    (COMPARED, "Speed of all runs [m/s]", 1.0),
    ("fuel_m3", "Fuel of all runs [L]", 1e3),
    ("state_of_charge", "State of charge of all runs [1]", 1.0),
];

/// Draws the channels by which several runs are held beside one another, each run in its colour.
pub(crate) fn beside(to: &Recorder, lane: &Lane) -> Result<(), ViewError> {
    for (channel, _, factor) in BESIDE.iter().skip(1) {
        let Some(values) = lane.run.trace.get(channel) else { continue };
        let values: Vec<f64> = values.iter().map(|value| factor * value).collect();
        let id = &lane.run.id;
        line(to, &entity::beside(channel, id), id, lane.colour, 2.0, lane.run.trace.time_s(), &values)?;
    }
    Ok(())
}

/// Draws every channel of a run and of its recording.
pub(crate) fn draw(to: &Recorder, scene: &Scene, groups: &[Group], lane: &Lane) -> Result<(), ViewError> {
    let id = &lane.run.id;
    let force = |name: &str| scene.forces.iter().find(|force| force.channel == name).map(|force| force.label);
    let words = |name: &str| {
        of_wheel(name).filter(|own| own.single).map_or(groups::words(name), |own| own.part.replace('_', " "))
    };
    let of_run = |channel: &str, name: String| {
        if channel == COMPARED && scene.runs.len() > 1 { format!("{id}: {name}") } else { name }
    };
    for channel in lane.run.trace.channels() {
        let words = force(&channel.name).map_or_else(|| words(&channel.name), str::to_owned);
        let driven = channel.origin == Origin::Driven;
        let paired = lane.recording.is_some_and(|recording| recording.trace.channel(&channel.name).is_some());
        let name = match (driven, paired) {
            (true, _) => format!("{words}, input"),
            (false, true) => format!("{words}, modelled"),
            (false, false) => words,
        };
        let name = of_run(&channel.name, name);
        let colour =
            if channel.name == COMPARED { lane.colour } else { groups::colour(groups, &channel.name) };
        let at = entity::channel(id, &channel.name, Who::Modelled);
        line(to, &at, &name, colour, 2.0, lane.run.trace.time_s(), &channel.values)?;
    }
    let Some(recording) = lane.recording else { return Ok(()) };
    for channel in recording.trace.channels() {
        if lane.run.trace.channel(&channel.name).is_some_and(|modelled| modelled.origin == Origin::Driven) {
            continue;
        }
        let words = force(&channel.name).map_or_else(|| words(&channel.name), str::to_owned);
        let colour = groups::colour(groups, &channel.name);
        let colour = if channel.name == COMPARED { lane.pale } else { pale(colour) };
        let at = entity::channel(id, &channel.name, Who::Measured);
        let name = of_run(&channel.name, format!("{words}, measured"));
        line(to, &at, &name, colour, 1.2, recording.trace.time_s(), &channel.values)?;
    }
    if let Some(residual) = residual(lane.run, recording) {
        let at = entity::channel(id, COMPARED, Who::Residual);
        line(to, &at, "measured − modelled", RESIDUAL, 1.5, recording.trace.time_s(), &residual)?;
    }
    Ok(())
}

/// Measured less modelled at the samples of the recording; `None` where one is missing, or the model was told.
pub(crate) fn residual(run: &Run, recording: &Run) -> Option<Vec<f64>> {
    let modelled = run.trace.channel(COMPARED)?;
    let measured = recording.trace.get(COMPARED)?;
    if modelled.origin == Origin::Driven {
        return None;
    }
    let at = |time_s: f64| run.trace.at(COMPARED, time_s).unwrap_or(f64::NAN);
    let times = recording.trace.time_s();
    let residual: Vec<f64> = times.iter().zip(measured).map(|(time_s, value)| value - at(*time_s)).collect();
    residual.iter().any(|value| value.is_finite()).then_some(residual)
}

/// One line, with its name, colour and width in points.
pub(crate) fn line(
    to: &Recorder,
    at: &EntityPath,
    name: &str,
    [red, green, blue]: Colour,
    width: f32,
    times_s: &[f64],
    values: &[f64],
) -> Result<(), ViewError> {
    let thinned = thin(times_s, values, MOST);
    if thinned.values.is_empty() {
        return Ok(());
    }
    let look = SeriesLines::new()
        .with_names([name])
        .with_colors([Color::from_rgb(red, green, blue)])
        .with_widths([width]);
    to.fixed(at, &look)?;
    to.note(at, Span::of(values));
    let columns = Scalars::update_fields().with_scalars(thinned.values).columns(thinned.lengths);
    to.rows(at, thinned.times_s, columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::run;

    #[test]
    fn a_residual_is_measured_less_modelled_where_both_are() {
        let modelled = run("r1", &[("speed_m_s", &[1.0, 2.0, 3.0])]);
        let measured = run("r1", &[("speed_m_s", &[1.5, f64::NAN, 2.0, 9.0])]);
        let residual = residual(&modelled, &measured).unwrap();
        assert_eq!([residual[0], residual[2]], [0.5, -1.0]);
        assert!(residual[1].is_nan() && residual[3].is_nan());
    }

    #[test]
    fn a_model_that_was_told_its_speed_has_no_residual() {
        let mut modelled = run("r1", &[("position_m", &[1.0, 2.0])]);
        modelled.trace.push(COMPARED, vec![1.0, 1.0], Origin::Driven).unwrap();
        let measured = run("r1", &[(COMPARED, &[1.5, 2.0])]);
        assert!(residual(&modelled, &measured).is_none());
    }
}
