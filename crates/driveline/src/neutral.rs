//! No drive at all: a vehicle that only rolls.
//!
//! F = 0
//!
//! Source: definition.
//! For coast-downs. Other consumers, if there are any, are served without loss from a store that is not modelled.

use headland_plugin::{Card, Delivery, Demand, Driveline, Plugin};
use serde::Deserialize;

/// A driveline that never drives.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Neutral {}

impl Plugin for Neutral {
    const CARD: Card = Card {
        name: "Neutral",
        about: "no drive at all: a vehicle that only rolls",
        equation: "F = 0",
        source: "definition",
        validity: "coast-downs; leaves out drag and inertia of the driveline, which are effects",
        parameters: &[],
    };
}

impl Driveline for Neutral {
    fn losses(&self) -> &'static [&'static str] {
        &[]
    }

    fn source(&self) -> &'static str {
        "none"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        0.0
    }

    fn drives(&self) -> bool {
        false
    }

    fn deliver(&self, demand: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
        Delivery { source_power_w: demand.auxiliary_power_w + demand.shaft_power_w, ..Delivery::NOTHING }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_drives_nothing_whatever_is_asked() {
        let neutral: Neutral = ron::from_str("()").unwrap();
        let demand = Demand { speed_m_s: 5.0, force_n: 1e4, auxiliary_power_w: 200.0, ..Demand::default() };
        let delivery = neutral.deliver(&demand, &[], &mut []);
        assert_eq!((delivery.force_n, delivery.source_power_w), (0.0, 200.0));
        assert_eq!(neutral.force_of_torque_n(100.0, 5.0), None);
        assert!(!neutral.drives());
    }

    #[test]
    fn it_has_no_parameters() {
        assert!(ron::from_str::<Neutral>("(gear_ratio: 1.0)").is_err());
    }
}
