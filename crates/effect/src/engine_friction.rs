//! An engine that rubs more than the scenario says.
//!
//! P_f = T_f ω        of fuel P_f / e, with the efficiency e of the driveline's Willans line
//!
//! Source: Willans line; Guzzella and Onder, *Introduction to Modeling and Control of Internal Combustion Engine Systems* (2010),
//! section 2.5; T_f = Δp_me0 V_d / 4π for four strokes.
//! Negative where the scenario counts too much. Leaves out the change of friction with speed and temperature.
//! Fingerprint: fuel that is missing in proportion to engine speed, at idle as under load.

use headland_plugin::{Action, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// A friction torque beside that of the engine model.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineFriction {
    torque_n_m: f64,
}

impl Plugin for EngineFriction {
    const CARD: Card = Card {
        name: "engine_friction",
        about: "an engine that rubs more than stated",
        equation: "P_f = T_f ω",
        source: "Willans line; Guzzella and Onder, Introduction to Modeling and Control of Internal Combustion Engine Systems \
                 (2010), section 2.5",
        validity: "a driveline with a combustion engine; nothing to any other",
        parameters: &[parameter("torque_n_m", "N m", "friction beside that stated, at the crankshaft, T_f")
            .usually(-50.0, 300.0)],
    };
}

impl Effect for EngineFriction {
    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        Action { engine_friction_n_m: self.torque_n_m, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build};

    #[test]
    fn it_adds_friction_to_the_engine_and_nothing_else() {
        let action = act::<EngineFriction>("(torque_n_m: 25.0)", &at_10_m_s());
        assert_eq!(action, Action { engine_friction_n_m: 25.0, ..Action::default() });
    }

    #[test]
    fn a_pressure_is_refused_in_place_of_a_torque() {
        assert!(build::<EngineFriction>("(pressure_pa: 1e5)").is_err());
    }
}
