//! What ends a phase, or lets it begin, as scenarios write it.

use crate::error::ScenarioError;
use crate::piece::Piece;
use headland_plugin::Bound;
use headland_sim::{Model, Until};
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "end of a phase")]
pub enum UntilFile {
    Stopped,
    SpeedBelow { speed_m_s: f64 },
    SpeedAbove { speed_m_s: f64 },
    Elapsed { for_s: f64 },
    Time { time_s: f64 },
    Travelled { distance_m: f64 },
    Position { position_m: f64 },
    Mark { name: String },
    PathEnd,
    PayloadAbove { task: String, mass_kg: f64 },
    PayloadBelow { task: String, mass_kg: f64 },
    ChargeAbove { state_of_charge: f64 },
    ChargeBelow { state_of_charge: f64 },
    StateAbove { state: String, value: f64 },
    StateBelow { state: String, value: f64 },
}

/// One end, or a list of which the first counts.
///
/// # Errors
/// [`ScenarioError`] where it does not fit, or names what the model does not have.
pub fn until(piece: Piece, model: &Model) -> Result<Until, ScenarioError> {
    let Some(values) = piece.elements() else { return one(piece, model) };
    if values.is_empty() {
        return Err(piece.refuse("until", "an empty list", "one end or more"));
    }
    let ends: Result<Vec<Until>, _> = values.iter().map(|node| one(piece.at(node), model)).collect();
    ends.map(Until::Any)
}

/// Conditions of entry: only what can be true at an instant.
///
/// # Errors
/// As [`until`].
pub fn when(piece: Piece, model: &Model) -> Result<Vec<Until>, ScenarioError> {
    let conditions = match until(piece, model)? {
        Until::Any(all) => all,
        single => vec![single],
    };
    let passing = |condition: &Until| {
        matches!(
            condition,
            Until::Elapsed(_) | Until::Travelled(_) | Until::Mark(_) | Until::PathEnd | Until::Any(_)
        )
    };
    if conditions.iter().any(passing) {
        return Err(piece.refuse(
            "when",
            "an end that counts from where a phase begins",
            "what is so at an instant: a time, a position, a speed, a payload, a charge or a state",
        ));
    }
    Ok(conditions)
}

fn one(piece: Piece, model: &Model) -> Result<Until, ScenarioError> {
    let positive = |field: &str, value: f64| piece.bounded(field, value, Bound::NotNegative);
    Ok(match piece.read::<UntilFile>("end of a phase")? {
        UntilFile::Stopped => Until::Stopped,
        UntilFile::SpeedBelow { speed_m_s } => {
            positive("speed_m_s", speed_m_s)?;
            Until::SpeedBelow(speed_m_s)
        }
        UntilFile::SpeedAbove { speed_m_s } => {
            positive("speed_m_s", speed_m_s)?;
            Until::SpeedAbove(speed_m_s)
        }
        UntilFile::Elapsed { for_s } => {
            positive("for_s", for_s)?;
            Until::Elapsed(for_s)
        }
        UntilFile::Time { time_s } => {
            positive("time_s", time_s)?;
            Until::Time(time_s)
        }
        UntilFile::Travelled { distance_m } => {
            positive("distance_m", distance_m)?;
            Until::Travelled(distance_m)
        }
        UntilFile::Position { position_m } => {
            piece.bounded("position_m", position_m, Bound::Finite)?;
            Until::Position(position_m)
        }
        UntilFile::Mark { name } => {
            let known: Vec<String> = model.terrain.marks().into_iter().map(str::to_owned).collect();
            if !known.contains(&name) {
                return Err(piece.field("name").unwrap_or(piece).unknown(
                    "mark of the terrain",
                    &name,
                    &known,
                ));
            }
            Until::Mark(name)
        }
        UntilFile::PathEnd => {
            if model.terrain.extent_m().is_none() {
                return Err(piece.refuse(
                    "until",
                    "PathEnd",
                    "another end: the path of this terrain never ends",
                ));
            }
            Until::PathEnd
        }
        UntilFile::PayloadAbove { task, mass_kg } => {
            positive("mass_kg", mass_kg)?;
            Until::StateAbove { state: payload(piece, model, &task)?, value: mass_kg }
        }
        UntilFile::PayloadBelow { task, mass_kg } => {
            positive("mass_kg", mass_kg)?;
            Until::StateBelow { state: payload(piece, model, &task)?, value: mass_kg }
        }
        UntilFile::ChargeAbove { state_of_charge } => {
            piece.bounded("state_of_charge", state_of_charge, Bound::Within(0.0, 1.0))?;
            Until::StateAbove { state: charge(piece, model)?, value: state_of_charge }
        }
        UntilFile::ChargeBelow { state_of_charge } => {
            piece.bounded("state_of_charge", state_of_charge, Bound::Within(0.0, 1.0))?;
            Until::StateBelow { state: charge(piece, model)?, value: state_of_charge }
        }
        UntilFile::StateAbove { state, value } => {
            piece.bounded("value", value, Bound::Finite)?;
            Until::StateAbove { state: known(piece, model, state)?, value }
        }
        UntilFile::StateBelow { state, value } => {
            piece.bounded("value", value, Bound::Finite)?;
            Until::StateBelow { state: known(piece, model, state)?, value }
        }
    })
}

const PAYLOAD: &str = "_payload_kg";

fn payload(piece: Piece, model: &Model, task: &str) -> Result<String, ScenarioError> {
    let states = model.states();
    let state = format!("{task}{PAYLOAD}");
    if states.contains(&state) {
        return Ok(state);
    }
    let carriers: Vec<String> =
        states.iter().filter_map(|name| name.strip_suffix(PAYLOAD)).map(str::to_owned).collect();
    Err(piece.field("task").unwrap_or(piece).unknown("task with a payload", task, &carriers))
}

fn charge(piece: Piece, model: &Model) -> Result<String, ScenarioError> {
    let name = "state_of_charge";
    if model.states().iter().any(|state| state == name) {
        return Ok(name.to_owned());
    }
    Err(piece.refuse("until", "a state of charge", "another end: this vehicle has no battery"))
}

fn known(piece: Piece, model: &Model, name: String) -> Result<String, ScenarioError> {
    let states = model.states();
    if states.contains(&name) {
        return Ok(name);
    }
    Err(piece.field("state").unwrap_or(piece).unknown("state", &name, &states))
}
