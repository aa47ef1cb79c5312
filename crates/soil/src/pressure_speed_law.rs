//! Resistance by inflation pressure and speed.
//!
//! c = 0.005 + (1 / p) (0.01 + 0.0095 (v / 100)²)      p in bar, v in km/h
//! F = c N
//!
//! Source: the empirical rule of vehicle handbooks, in Ehsani, Gao and Emadi, *Modern Electric, Hybrid Electric, and
//! Fuel Cell Vehicles* (2010), section 2.2, and its references.
//! Holds for car and truck tyres on paved roads: a lower bound for a farm tyre, and no model of soft ground, where a lower
//! pressure helps.

use headland_plugin::{Bound, Card, Contact, Plugin, Soil, parameter};
use serde::Deserialize;

const PA_PER_BAR: f64 = 1e5;
const KM_H_PER_M_S: f64 = 3.6;

/// Tyres of one inflation pressure on a paved road.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PressureSpeedLaw {
    pressure_pa: f64,
}

impl Plugin for PressureSpeedLaw {
    const CARD: Card = Card {
        name: "PressureSpeedLaw",
        about: "resistance of tyres on a paved road by inflation pressure and speed",
        equation: "F = (0.005 + (1/p)(0.01 + 0.0095 (v/100)²)) N, p in bar, v in km/h",
        source: "empirical rule of vehicle handbooks; Ehsani, Gao and Emadi, Modern Electric, Hybrid Electric, and Fuel \
                 Cell Vehicles (2010), section 2.2",
        validity: "car and truck tyres on paved roads; a lower bound for farm tyres, not for soft ground",
        parameters: &[parameter("pressure_pa", "Pa", "inflation pressure above ambient, p")
            .must_be(Bound::Positive)
            .usually(0.5e5, 9e5)],
    };
}

impl Soil for PressureSpeedLaw {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        let p = self.pressure_pa / PA_PER_BAR;
        let v = contact.speed_m_s * KM_H_PER_M_S;
        let c = 0.005 + (0.01 + 0.0095 * (v / 100.0) * (v / 100.0)) / p;
        c * contact.load_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coefficient(pressure_pa: f64, speed_km_h: f64) -> f64 {
        let contact = Contact { load_n: 1.0, speed_m_s: speed_km_h / 3.6, position_m: 0.0 };
        PressureSpeedLaw { pressure_pa }.resistance_n(&contact)
    }

    /// 1.5 bar, 30 km/h: 0.005 + (0.01 + 0.0095 · 0.09) / 1.5 = 0.012237, by hand.
    #[test]
    fn one_and_a_half_bar_at_30_km_h() {
        assert!((coefficient(1.5e5, 30.0) - 0.012_236_666_667).abs() < 1e-11);
    }

    #[test]
    fn a_tyre_of_infinite_pressure_keeps_its_constant_part_alone() {
        assert!((coefficient(1e15, 100.0) - 0.005).abs() < 1e-9);
    }

    #[test]
    fn at_100_km_h_and_1_bar_the_parts_add_up() {
        assert!((coefficient(1e5, 100.0) - (0.005 + 0.01 + 0.0095)).abs() < 1e-12);
    }

    #[test]
    fn a_pressure_in_bar_is_refused_by_its_name() {
        assert!(ron::from_str::<PressureSpeedLaw>("(pressure_bar: 1.5)").is_err());
    }
}
