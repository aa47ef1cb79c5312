//! A battery that resists more than the scenario says.
//!
//! P_loss = ΔR I²,   U = U₀ − (R + ΔR) I
//!
//! Source: internal-resistance model; Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.5.
//! Negative where the scenario counts too much. Leaves out its rise with cold and its time constants.
//! Fingerprint: a voltage that sags in proportion to current, and a loss with its square, whether driving or braking.

use headland_plugin::{Action, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// A resistance beside that of the battery model.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatteryResistance {
    resistance_ohm: f64,
}

impl Plugin for BatteryResistance {
    const CARD: Card = Card {
        name: "battery_resistance",
        about: "a battery that resists more than stated",
        equation: "P_loss = ΔR I², U = U₀ − (R + ΔR) I",
        source: "internal-resistance model; Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), section 4.5",
        validity: "a driveline with a battery; nothing to any other; leaves out cold and transients",
        parameters: &[parameter("resistance_ohm", "ohm", "beside that stated, ΔR").usually(-0.1, 0.5)],
    };
}

impl Effect for BatteryResistance {
    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { battery_resistance_ohm: self.resistance_ohm, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build};

    #[test]
    fn it_adds_resistance_to_the_battery_and_nothing_else() {
        let action = act::<BatteryResistance>("(resistance_ohm: 0.05)", &at_10_m_s());
        assert_eq!(action, Action { battery_resistance_ohm: 0.05, ..Action::default() });
    }

    #[test]
    fn a_resistance_has_to_be_given() {
        assert!(build::<BatteryResistance>("()").is_err());
    }
}
