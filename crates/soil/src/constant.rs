//! Resistance in proportion to the load, the same at every speed.
//!
//! F = c N
//!
//! Source: Wong, *Theory of Ground Vehicles* (2008), section 1.3.
//! Holds at low speeds on firm ground; leaves out speed, inflation pressure, sinkage and temperature.

use headland_plugin::{Bound, Card, Contact, Plugin, Soil, parameter};
use serde::Deserialize;

/// A coefficient of rolling resistance, and nothing else.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constant {
    coefficient: f64,
}

impl Plugin for Constant {
    const CARD: Card = Card {
        name: "Constant",
        about: "resistance in proportion to the load, the same at every speed",
        equation: "F = c N",
        source: "Wong, Theory of Ground Vehicles (2008), section 1.3",
        validity: "low speeds on firm ground; leaves out speed, inflation pressure, sinkage and temperature",
        parameters: &[parameter("coefficient", "1", "resistance per load, c")
            .must_be(Bound::NotNegative)
            .usually(0.005, 0.3)],
    };
}

impl Soil for Constant {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        let (c, n) = (self.coefficient, contact.load_n);
        c * n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(speed_m_s: f64) -> Contact {
        Contact { load_n: 10_000.0, speed_m_s, position_m: 3.0 }
    }

    #[test]
    fn ten_kilonewtons_at_seven_hundredths_resist_with_700_n_at_any_speed() {
        let soil = Constant { coefficient: 0.07 };
        assert!((soil.resistance_n(&contact(0.0)) - 700.0).abs() < 1e-9);
        assert!((soil.resistance_n(&contact(30.0)) - 700.0).abs() < 1e-9);
    }

    #[test]
    fn a_parameter_that_it_does_not_have_is_refused() {
        assert!(ron::from_str::<Constant>("(coefficient: 0.07)").is_ok());
        assert!(ron::from_str::<Constant>("(coefficient: 0.07, speed_scale_m_s: 1.0)").is_err());
        assert!(ron::from_str::<Constant>("()").is_err());
    }
}
