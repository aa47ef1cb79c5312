//! Resistance that grows with the square of speed.
//!
//! F = c (1 + (v / v_s)²) N
//!
//! Source: the form f = f₀ (1 + (0.006 V)²) with V in km/h, of the Russian school of vehicle dynamics (so v_s is 46 m/s);
//! Wong, *Theory of Ground Vehicles* (2008), section 1.3, gives f₀ + k V² for car and truck tyres.
//! Holds for pneumatic tyres on roads below the speed of standing waves; leaves out pressure, sinkage and temperature.

use headland_plugin::{Bound, Card, Contact, Plugin, Soil, parameter};
use serde::Deserialize;

/// A coefficient of rolling resistance that rises with the square of speed and has doubled at the speed scale.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuadraticSpeedLaw {
    coefficient: f64,
    speed_scale_m_s: f64,
}

impl Plugin for QuadraticSpeedLaw {
    const CARD: Card = Card {
        name: "QuadraticSpeedLaw",
        about: "resistance that grows with the square of speed",
        equation: "F = c (1 + (v / v_s)²) N",
        source: "Wong, Theory of Ground Vehicles (2008), section 1.3",
        validity: "pneumatic tyres on roads below the speed of standing waves; leaves out pressure, sinkage, temperature",
        parameters: &[
            parameter("coefficient", "1", "resistance per load at rest, c")
                .must_be(Bound::NotNegative)
                .usually(0.005, 0.3),
            parameter("speed_scale_m_s", "m/s", "speed at which the resistance has doubled, v_s")
                .must_be(Bound::Positive)
                .usually(10.0, 110.0),
        ],
    };
}

impl Soil for QuadraticSpeedLaw {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        let (c, v_s) = (self.coefficient, self.speed_scale_m_s);
        let (v, n) = (contact.speed_m_s, contact.load_n);
        c * (1.0 + (v / v_s) * (v / v_s)) * n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resistance_n(speed_m_s: f64) -> f64 {
        let soil = QuadraticSpeedLaw { coefficient: 0.02, speed_scale_m_s: 40.0 };
        soil.resistance_n(&Contact { load_n: 5000.0, speed_m_s, position_m: 0.0 })
    }

    /// 0.02 · (1 + (10/40)²) · 5000 N = 106.25 N, by hand.
    #[test]
    fn a_quarter_of_the_scale_adds_a_sixteenth() {
        assert!((resistance_n(10.0) - 106.25).abs() < 1e-9);
    }

    #[test]
    fn it_doubles_at_the_scale_and_starts_level() {
        assert!((resistance_n(40.0) - 200.0).abs() < 1e-9);
        assert!((resistance_n(1e-3) - resistance_n(0.0)) < 1e-6);
    }

    #[test]
    fn a_missing_speed_scale_is_refused() {
        assert!(ron::from_str::<QuadraticSpeedLaw>("(coefficient: 0.07)").is_err());
    }
}
