//! An effect: a washboard lane that shakes the vehicle most at one speed.
//!
//! F = F₀ / (1 + (q (v/v₀ − 1))²)        v₀ speed of the resonance, q its sharpness
//!
//! Source: resonance curve of one body on springs; v₀ is the distance between ridges times the body's natural frequency.
//! One number has to be given, and what the effect does is in proportion to it. So a diagnosis can try it on a recording
//! without being asked.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

const RESONANCE_M_S: f64 = 5.0;
const SHARPNESS: f64 = 4.0;

/// Ridges at one distance.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Washboard {
    force_n: f64,
    #[serde(default = "resonance_m_s")]
    resonance_m_s: f64,
    #[serde(default = "sharpness")]
    sharpness: f64,
}

fn resonance_m_s() -> f64 {
    RESONANCE_M_S
}

fn sharpness() -> f64 {
    SHARPNESS
}

impl Plugin for Washboard {
    const CARD: Card = Card {
        name: "washboard",
        about: "a washboard that shakes the vehicle at one speed",
        equation: "F = F₀ / (1 + (q (v/v₀ − 1))²)",
        source: "resonance curve of one body on springs",
        validity: "ridges at one distance; leaves out that wheels leave the ground",
        parameters: &[
            parameter("force_n", "N", "at the resonance, F₀")
                .must_be(Bound::NotNegative)
                .usually(0.0, 4000.0),
            parameter("resonance_m_s", "m/s", "speed of the resonance, v₀")
                .must_be(Bound::Positive)
                .usually(0.5, 15.0)
                .or(RESONANCE_M_S),
            parameter("sharpness", "1", "of the resonance, q")
                .must_be(Bound::NotNegative)
                .usually(1.0, 20.0)
                .or(SHARPNESS),
        ],
    };
}

impl Effect for Washboard {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let off = self.sharpness * (at.speed_m_s / self.resonance_m_s - 1.0);
        Action { resistance_n: self.force_n / (1.0 + off * off), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the resonance F₀; a quarter above it, with q = 4, half of that.
    #[test]
    fn the_force_is_largest_at_the_resonance_and_falls_off_beside_it() {
        let washboard: Washboard = ron::from_str("(force_n: 800)").unwrap();
        for (speed_m_s, expected) in [(5.0, 800.0), (6.25, 400.0)] {
            let at = Situation { speed_m_s, ..Situation::default() };
            let force_n = washboard.act(&at, &[], &mut []).resistance_n;
            assert!((force_n - expected).abs() < 1e-9, "{force_n}");
        }
    }
}
