//! A mean wind that the scenario does not know.
//!
//! F = −½ ρ C_d A (|v − w| (v − w)ₓ − |v − w₀| (v − w₀)ₓ)        w₀ the wind that the scenario knows, w with this one
//!
//! Source: vector form of the drag equation; Hucho, *Aerodynamics of Road Vehicles* (1998), chapter 4.
//! Drag area is the same from every side. Leaves out gusts, shelter and the profile of wind over height.
//! Fingerprint: a force that turns its sign with the heading, and grows with speed as 2 w v.

use headland_plugin::{Action, Air, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// A wind that is the same everywhere and at all times.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wind {
    speed_m_s: f64,
    from_rad: f64,
}

impl Plugin for Wind {
    const CARD: Card = Card {
        name: "wind",
        about: "a mean wind, added to the one that is known",
        equation: "F = −½ ρ C_d A (|v − w| (v − w)ₓ − |v − w₀| (v − w₀)ₓ)",
        source: "vector form of the drag equation; Hucho, Aerodynamics of Road Vehicles (1998), chapter 4",
        validity: "steady wind, the same drag area from every side; leaves out gusts and shelter",
        parameters: &[
            parameter("speed_m_s", "m/s", "over ground, w").must_be(Bound::NotNegative).usually(0.0, 15.0),
            parameter("from_rad", "rad", "where it blows from, clockwise from north")
                .usually(-std::f64::consts::TAU, std::f64::consts::TAU),
        ],
    };
}

impl Wind {
    /// The known wind and this one together.
    fn on(&self, air: &Air) -> Air {
        let (south, west) = (self.from_rad.cos() * self.speed_m_s, self.from_rad.sin() * self.speed_m_s);
        if air.wind_speed_m_s == 0.0 {
            return Air { wind_speed_m_s: self.speed_m_s, wind_from_rad: self.from_rad, ..*air };
        }
        let south = south + air.wind_from_rad.cos() * air.wind_speed_m_s;
        let west = west + air.wind_from_rad.sin() * air.wind_speed_m_s;
        Air { wind_speed_m_s: south.hypot(west), wind_from_rad: west.atan2(south), ..*air }
    }
}

impl Effect for Wind {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let drag_n = |air: &Air| air.drag_n(at.drag_area_m2, at.speed_m_s, at.place.heading_rad);
        Action { force_n: drag_n(&self.on(&at.air)) - drag_n(&at.air), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};
    use std::f64::consts::FRAC_PI_2;

    const NORTH: &str = "(speed_m_s: 2.0, from_rad: 0.0)";

    /// Northward at 10 m/s: 0.6 · (12² − 10²) = 26.4 N against, southward 0.6 · (10² − 8²) = 21.6 N along.
    #[test]
    fn it_hinders_one_way_and_helps_the_other() {
        let mut at = at_10_m_s();
        assert!(same(act::<Wind>(NORTH, &at).force_n, -26.4));
        at.place.heading_rad = std::f64::consts::PI;
        assert!(same(act::<Wind>(NORTH, &at).force_n, 21.6));
    }

    /// Two winds of 3 and 4 m/s at right angles are one of 5 m/s.
    #[test]
    fn it_adds_to_the_known_wind_as_a_vector() {
        let mut at = at_10_m_s();
        at.air.wind_speed_m_s = 3.0;
        let known = at.air.drag_n(1.0, 10.0, 0.0);
        let east = act::<Wind>(&format!("(speed_m_s: 4.0, from_rad: {FRAC_PI_2})"), &at);
        let together = Air { wind_speed_m_s: 5.0, wind_from_rad: 4f64.atan2(3.0), ..at.air };
        assert!(same(east.force_n + known, together.drag_n(1.0, 10.0, 0.0)));
    }

    #[test]
    fn it_pushes_a_vehicle_that_stands() {
        let at = Situation { speed_m_s: 0.0, ..at_10_m_s() };
        assert!(same(act::<Wind>(NORTH, &at).force_n, -0.6 * 4.0));
    }

    #[test]
    fn a_wind_without_direction_is_refused() {
        assert!(build::<Wind>("(speed_m_s: 2.0)").is_err());
    }
}
