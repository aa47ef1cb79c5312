//! A constant power through the power take-off.
//!
//! P = P₀
//!
//! Source: definition; OECD Code 2 measures tractors against such powers.
//! Leaves out the change of power with crop flow and shaft speed.

use headland_plugin::{Bound, Card, Load, Plugin, Situation, Task, parameter};
use serde::Deserialize;

/// A machine that is driven through the power take-off.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PtoPower {
    power_w: f64,
}

impl Plugin for PtoPower {
    const CARD: Card = Card {
        name: "PtoPower",
        about: "a constant power through the power take-off",
        equation: "P = P₀",
        source: "definition; OECD Code 2 measures tractors against such powers",
        validity: "leaves out the change of power with crop flow and shaft speed",
        parameters: &[parameter("power_w", "W", "power at the shaft, P₀")
            .must_be(Bound::NotNegative)
            .usually(1_000.0, 300_000.0)],
    };
}

impl Task for PtoPower {
    fn load(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        Load { pto_power_w: self.power_w, ..Load::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_takes_what_it_says_at_any_speed_and_nothing_else() {
        let task = PtoPower { power_w: 1234.5 };
        for speed_m_s in [-2.0, 0.0, 8.0] {
            let load = task.load(&Situation { speed_m_s, ..Situation::default() }, &[], &mut []);
            assert_eq!(load, Load { pto_power_w: 1234.5, ..Load::default() });
        }
    }

    #[test]
    fn a_parameter_that_it_does_not_have_is_refused() {
        assert!(ron::from_str::<PtoPower>("(power_w: 1.0)").is_ok());
        assert!(ron::from_str::<PtoPower>("(power_w: 1.0, width_m: 3.0)").is_err());
    }
}
