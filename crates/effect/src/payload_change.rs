//! A payload that is filled or emptied on the way.
//!
//! m = m₀ + Δm(t)        Δm straight between its points
//!
//! Source: Newton's second law for a mass that comes and goes at the vehicle's own speed.
//! Beyond its ends the last payload stays. Leaves out the force that brings standing material up to speed, ṁ v.
//! Fingerprint: inertia, rolling resistance and slope force change together and gradually, over time and not over place.

use crate::series::{check_line, linear};
use headland_plugin::{Action, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// Mass by time.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PayloadChange {
    times_s: Vec<f64>,
    masses_kg: Vec<f64>,
}

impl Plugin for PayloadChange {
    const CARD: Card = Card {
        name: "payload_change",
        about: "a payload that is filled or emptied on the way",
        equation: "m = m₀ + Δm(t)",
        source: "Newton's second law for a mass that comes and goes at the vehicle's own speed",
        validity: "slow filling and emptying; leaves out the force ṁ v on material that stood",
        parameters: &[
            parameter("times_s", "[s]", "points in time since the start of the run, increasing, t")
                .usually(0.0, 1e5),
            parameter("masses_kg", "[kg]", "payload beside the mass stated at each point, Δm")
                .usually(-20_000.0, 40_000.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        check_line(("times_s", &self.times_s), ("masses_kg", &self.masses_kg))
    }
}

impl Effect for PayloadChange {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { mass_kg: linear(&self.times_s, &self.masses_kg, at.time_s), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// At 50 s, a quarter of the way from 40 s to 80 s.
    #[test]
    fn a_tank_runs_empty_in_proportion_to_time() {
        let action = act::<PayloadChange>("(times_s: [40.0, 80.0], masses_kg: [800.0, 0.0])", &at_10_m_s());
        assert!(same(action.mass_kg, 600.0));
    }

    #[test]
    fn times_that_do_not_increase_are_refused() {
        let message = build::<PayloadChange>("(times_s: [40.0, 30.0], masses_kg: [800.0, 0.0])").unwrap_err();
        assert!(message.contains("`times_s` is 30 after 40"), "{message}");
    }
}
