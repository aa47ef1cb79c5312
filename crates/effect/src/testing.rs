//! What the tests of the effects share.

use headland_plugin::{Action, Air, Effect, Place, Plugin, Registry, Situation};
use std::path::Path;

/// 2000 kg at 10 m/s on level ground, northward, in still air; one m² of drag area, and a gravity easy to reckon with.
pub(crate) fn at_10_m_s() -> Situation {
    Situation {
        time_s: 50.0,
        position_m: 120.0,
        speed_m_s: 10.0,
        mass_kg: 2000.0,
        gravity_m_s2: 10.0,
        place: Place::default(),
        air: Air { density_kg_m3: 1.2, wind_speed_m_s: 0.0, wind_from_rad: 0.0, temperature_c: 5.0 },
        drag_area_m2: 1.0,
        ..Situation::default()
    }
}

/// Reads an effect as a scenario does.
pub(crate) fn build<P: Plugin + Effect>(parameters: &str) -> Result<Box<dyn Effect>, String> {
    let mut registry = Registry::new();
    registry.effect::<P>();
    registry.effects.build(P::CARD.name, parameters, Path::new(".")).map_err(|error| error.to_string())
}

/// What an effect with fresh states does.
pub(crate) fn act<P: Plugin + Effect>(parameters: &str, at: &Situation) -> Action {
    let effect = build::<P>(parameters).unwrap();
    let states: Vec<f64> = effect.states().iter().map(|state| state.initial).collect();
    effect.act(at, &states, &mut vec![0.0; states.len()])
}

/// Rates of the states of an effect.
pub(crate) fn rates<P: Plugin + Effect>(parameters: &str, at: &Situation, states: &[f64]) -> Vec<f64> {
    let effect = build::<P>(parameters).unwrap();
    let mut rates = vec![f64::NAN; states.len()];
    effect.act(at, states, &mut rates);
    effect.follow(at, states, &mut rates);
    rates
}

/// Whether two numbers are the same but for rounding.
pub(crate) fn same(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-9 * one.abs().max(other.abs())
}
