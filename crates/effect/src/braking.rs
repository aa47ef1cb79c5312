//! Service brakes whose force was not recorded.
//!
//! F = F_b while the recording says that it brakes, + F(t) constant between its edges, 0 outside
//!
//! Source: Coulomb friction; Breuer and Bill, *Bremsenhandbuch* (2017), chapter on brake force.
//! Leaves out the change of friction with speed and temperature.
//! Fingerprint: spells of strong force against the motion that begin and end in time, mostly before a stop, whatever the
//! place; the drive gives nothing or brakes meanwhile.

use crate::series::{check_steps, step};
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// Brake force by the brake switch, by time, or both.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Braking {
    #[serde(default)]
    force_n: f64,
    #[serde(default)]
    times_s: Vec<f64>,
    #[serde(default)]
    forces_n: Vec<f64>,
}

impl Plugin for Braking {
    const CARD: Card = Card {
        name: "braking",
        about: "service brakes whose force was not recorded",
        equation: "F = F_b while braked + F(t)",
        source: "Coulomb friction; Breuer and Bill, Bremsenhandbuch (2017)",
        validity: "steady force in each spell",
        parameters: &[
            parameter("force_n", "N", "while the channel `brake` says so, F_b")
                .must_be(Bound::NotNegative)
                .usually(0.0, 100_000.0)
                .or(0.0),
            parameter(
                "times_s",
                "[s]",
                "edges of spells since the start of the run, increasing; none where left out, t",
            )
            .usually(0.0, 1e5),
            parameter("forces_n", "[N]", "force in each spell, one less than edges, F")
                .must_be(Bound::NotNegative)
                .usually(0.0, 100_000.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        check_steps(("times_s", &self.times_s), ("forces_n", &self.forces_n))
    }
}

impl Effect for Braking {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let switched_n = if at.braking { self.force_n } else { 0.0 };
        let resistance_n = switched_n + step(&self.times_s, &self.forces_n, at.time_s);
        Action { resistance_n, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build};

    #[test]
    fn it_follows_the_brake_switch() {
        let braked = Situation { braking: true, ..at_10_m_s() };
        assert_eq!(act::<Braking>("(force_n: 3000.0)", &braked).resistance_n, 3000.0);
        assert_eq!(act::<Braking>("(force_n: 3000.0)", &at_10_m_s()).resistance_n, 0.0);
    }

    /// The situation is at 50 s.
    #[test]
    fn it_follows_the_clock() {
        let spells = "(times_s: [40.0, 45.0, 60.0], forces_n: [100.0, 2500.0])";
        assert_eq!(act::<Braking>(spells, &at_10_m_s()).resistance_n, 2500.0);
        let later = Situation { time_s: 60.0, ..at_10_m_s() };
        assert_eq!(act::<Braking>(spells, &later).resistance_n, 0.0);
    }

    #[test]
    fn a_force_without_its_spell_is_refused() {
        assert!(build::<Braking>("(times_s: [40.0], forces_n: [100.0])").is_err());
    }
}
