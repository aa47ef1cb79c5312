//! Resistance that grows in proportion to speed.
//!
//! F = c (1 + v / v_s) N
//!
//! Source: Ehsani, Gao and Emadi, *Modern Electric, Hybrid Electric, and Fuel Cell Vehicles* (2010), section 2.2, where
//! v_s is 100 km/h; the coast-down study of a Claas Xerion 3800 (Applied Sciences 2026, 16(4), 1814), equation 4, writes
//! 100 and leaves its unit open. So v_s is always given with its unit.
//! Holds to about 130 km/h on firm ground; leaves out inflation pressure, sinkage and temperature.

use headland_plugin::{Bound, Card, Contact, Plugin, Soil, parameter};
use serde::Deserialize;

/// A coefficient of rolling resistance that has doubled at the speed scale.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearSpeedLaw {
    coefficient: f64,
    speed_scale_m_s: f64,
}

impl Plugin for LinearSpeedLaw {
    const CARD: Card = Card {
        name: "LinearSpeedLaw",
        about: "resistance that grows in proportion to speed",
        equation: "F = c (1 + v / v_s) N",
        source: "Ehsani, Gao and Emadi, Modern Electric, Hybrid Electric, and Fuel Cell Vehicles (2010), section 2.2; \
                 Applied Sciences 2026, 16(4), 1814, equation 4",
        validity: "to about 130 km/h on firm ground; leaves out inflation pressure, sinkage and temperature",
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

impl Soil for LinearSpeedLaw {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        let (c, v_s) = (self.coefficient, self.speed_scale_m_s);
        let (v, n) = (contact.speed_m_s, contact.load_n);
        c * (1.0 + v / v_s) * n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tractor of the coast-down study: 13 019.3 kg at 9.81 m/s².
    const LOAD_N: f64 = 13_019.3 * 9.81;
    const KM_H: f64 = 1.0 / 3.6;

    fn resistance_n(speed_scale_m_s: f64, speed_m_s: f64) -> f64 {
        let soil = LinearSpeedLaw { coefficient: 0.069, speed_scale_m_s };
        soil.resistance_n(&Contact { load_n: LOAD_N, speed_m_s, position_m: 0.0 })
    }

    /// 0.069 · 127 719 N · (1 + 8.333 / v_s): by hand for the three readings of the unit of v.
    #[test]
    fn the_three_readings_of_the_unit_differ_at_30_km_h() {
        assert!((resistance_n(100.0 * KM_H, 30.0 * KM_H) - 11_456.4).abs() < 0.1);
        assert!((resistance_n(100.0 * 0.447_04, 30.0 * KM_H) - 10_455.4).abs() < 0.1);
        assert!((resistance_n(100.0, 30.0 * KM_H) - 9_547.1).abs() < 0.1);
    }

    #[test]
    fn at_the_speed_scale_it_has_doubled() {
        assert!((resistance_n(20.0, 20.0) / resistance_n(20.0, 0.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_missing_speed_scale_is_refused() {
        assert!(ron::from_str::<LinearSpeedLaw>("(coefficient: 0.07)").is_err());
        assert!(ron::from_str::<LinearSpeedLaw>("(coefficient: 0.07, speed_scale: 1.0)").is_err());
    }
}
