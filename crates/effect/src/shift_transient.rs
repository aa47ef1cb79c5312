//! Drive force that is lost where the transmission changes its range.
//!
//! F = F₀ Σ exp(−½ ((|v| − v_i) / w)²)        unless it coasts in neutral, whichever way the drive pulls
//!
//! Source: empirical, a bell at each speed of change; Renius, *Fundamentals of Tractor Design* (2020), chapter 5, shows the clutch
//! energy of range changes.
//! Leaves out the shock of the shaft and hysteresis between shifting up and down.
//! Fingerprint: narrow dips of the drive force at the same few speeds, in every run, and none while coasting.

use crate::series::refuse;
use crate::upstream::UPSTREAM;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// Force lost around the speeds of range changes.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShiftTransient {
    force_n: f64,
    speeds_m_s: Vec<f64>,
    width_m_s: f64,
    #[serde(default)]
    upstream: bool,
}

impl Plugin for ShiftTransient {
    const CARD: Card = Card {
        name: "shift_transient",
        about: "drive force that is lost where the transmission changes its range",
        equation: "F = F₀ Σ exp(−½ ((|v| − vᵢ)/w)²) unless it coasts in neutral",
        source: "empirical bell; Renius, Fundamentals of Tractor Design (2020), chapter 5",
        validity: "changes at the same speeds up and down; leaves out the shock of the shaft",
        parameters: &[
            parameter("force_n", "N", "lost at the middle of a change, F₀")
                .must_be(Bound::NotNegative)
                .usually(0.0, 30_000.0),
            parameter("speeds_m_s", "[m/s]", "speeds of the changes, vᵢ")
                .must_be(Bound::NotNegative)
                .usually(0.5, 20.0),
            parameter("width_m_s", "m/s", "of the bell, w").must_be(Bound::Positive).usually(0.05, 1.0),
            UPSTREAM,
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        if self.speeds_m_s.is_empty() {
            return Err(refuse("speeds_m_s", "empty", "one speed or more"));
        }
        match self.speeds_m_s.iter().find(|speed| !Bound::NotNegative.holds(**speed)) {
            Some(speed) => Err(refuse("speeds_m_s", &speed.to_string(), &Bound::NotNegative.in_words())),
            None => Ok(()),
        }
    }
}

impl Effect for ShiftTransient {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        if at.coasting {
            return Action::default();
        }
        let bell = |speed: &f64| {
            let away = (at.speed_m_s.abs() - speed) / self.width_m_s;
            (-0.5 * away * away).exp()
        };
        let bells: f64 = self.speeds_m_s.iter().map(bell).sum();
        if self.upstream {
            return Action { upstream_n: self.force_n * bells, ..Action::default() };
        }
        Action { resistance_n: self.force_n * bells, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    const SHIFT: &str = "(force_n: 1000.0, speeds_m_s: [3.0, 10.0], width_m_s: 0.2)";

    /// In the middle all of it, two widths away e^−2 of it, in neutral nothing.
    #[test]
    fn a_bell_around_each_speed() {
        assert!(same(act::<ShiftTransient>(SHIFT, &at_10_m_s()).resistance_n, 1000.0));
        let beside = Situation { speed_m_s: 3.4, ..at_10_m_s() };
        assert!(same(act::<ShiftTransient>(SHIFT, &beside).resistance_n, 1000.0 * (-2f64).exp()));
        let coasting = Situation { coasting: true, ..at_10_m_s() };
        assert_eq!(act::<ShiftTransient>(SHIFT, &coasting).resistance_n, 0.0);
    }

    #[test]
    fn upstream_it_asks_more_of_what_drives_instead() {
        let upstream = SHIFT.replace("(force_n", "(upstream: true, force_n");
        let action = act::<ShiftTransient>(&upstream, &at_10_m_s());
        assert!(same(action.upstream_n, 1000.0) && action.resistance_n == 0.0);
    }

    #[test]
    fn speeds_have_to_be_given() {
        assert!(build::<ShiftTransient>("(force_n: 1.0, speeds_m_s: [], width_m_s: 0.2)").is_err());
    }
}
