//! A drive that gives back less, when braking, than the scenario allows.
//!
//! −F v ≤ P_r r,   r = 0 up to v₀, 1 from v₁ on, straight between
//!
//! Source: limits of battery power, and blending-out at walking pace; Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013),
//! section 4.3.
//! Friction brakes take over what the drive may not. Limits the drive, not a recorded force. Leaves out state of charge.
//! Fingerprint: less power comes back to the battery in strong or slow braking than the motion could have given.

use crate::series::refuse;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// A limit of the power that is given back.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegenerationLimit {
    power_w: f64,
    #[serde(default)]
    no_speed_m_s: f64,
    #[serde(default)]
    full_speed_m_s: f64,
}

impl Plugin for RegenerationLimit {
    const CARD: Card = Card {
        name: "regeneration_limit",
        about: "a drive that gives back less, when braking, than stated",
        equation: "−F v ≤ P_r r, r = 0 up to v₀, 1 from v₁ on, straight between",
        source: "Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), section 4.3",
        validity: "limits what a driver asks for, not a recorded force; leaves out state of charge",
        parameters: &[
            parameter("power_w", "W", "most that the wheels may give back, P_r")
                .must_be(Bound::NotNegative)
                .usually(0.0, 200_000.0),
            parameter("no_speed_m_s", "m/s", "up to which nothing is given back, v₀")
                .must_be(Bound::NotNegative)
                .usually(0.0, 4.0)
                .or(0.0),
            parameter("full_speed_m_s", "m/s", "from which all of it is given back, v₁")
                .must_be(Bound::NotNegative)
                .usually(0.0, 8.0)
                .or(0.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        if self.full_speed_m_s >= self.no_speed_m_s {
            return Ok(());
        }
        let expected = format!("at least `no_speed_m_s`, which is {}", self.no_speed_m_s);
        Err(refuse("full_speed_m_s", &self.full_speed_m_s.to_string(), &expected))
    }
}

impl Effect for RegenerationLimit {
    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action::default()
    }

    fn limits_n(&self, at: &Situation, _: &[f64]) -> (f64, f64) {
        let v = at.speed_m_s;
        if v <= 0.0 {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let share = if v >= self.full_speed_m_s {
            1.0
        } else {
            ((v - self.no_speed_m_s) / (self.full_speed_m_s - self.no_speed_m_s)).max(0.0)
        };
        (-self.power_w * share / v, f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{at_10_m_s, build, same};

    const LIMIT: &str = "(power_w: 30000.0, no_speed_m_s: 2.0, full_speed_m_s: 4.0)";

    /// 30 kW at 10 m/s are 3 kN, half of 30 kW at 3 m/s 5 kN, and at 1 m/s nothing comes back.
    #[test]
    fn by_power_at_speed_and_blended_out_at_walking_pace() {
        let limit = build::<RegenerationLimit>(LIMIT).unwrap();
        for (speed_m_s, expected) in [(10.0, -3000.0), (3.0, -5000.0), (1.0, 0.0)] {
            let (least, most) = limit.limits_n(&Situation { speed_m_s, ..at_10_m_s() }, &[]);
            assert!(same(least, expected) && most == f64::INFINITY, "{speed_m_s}: {least}");
        }
    }

    #[test]
    fn speeds_in_the_wrong_order_are_refused() {
        let message = build::<RegenerationLimit>("(power_w: 1.0, no_speed_m_s: 2.0)").unwrap_err();
        assert!(message.contains("at least `no_speed_m_s`"), "{message}");
    }
}
