//! A constant power through the remote hydraulics.
//!
//! P = p Q = P₀
//!
//! Source: definition: pressure times flow.
//! Leaves out cycles, and the losses of pump and valves, which belong to the power stated.

use headland_plugin::{Bound, Card, Load, Plugin, Situation, Task, parameter};
use serde::Deserialize;

/// A consumer at the remote hydraulics.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hydraulic {
    power_w: f64,
}

impl Plugin for Hydraulic {
    const CARD: Card = Card {
        name: "Hydraulic",
        about: "a constant power through the remote hydraulics",
        equation: "P = p Q = P₀",
        source: "definition: pressure times flow",
        validity: "leaves out cycles; losses of pump and valves belong to the power stated",
        parameters: &[parameter("power_w", "W", "power at the pump shaft, P₀")
            .must_be(Bound::NotNegative)
            .usually(500.0, 80_000.0)],
    };
}

impl Task for Hydraulic {
    fn load(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        Load { hydraulic_power_w: self.power_w, ..Load::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_takes_what_it_says_at_any_speed_and_nothing_else() {
        let task = Hydraulic { power_w: 1234.5 };
        for speed_m_s in [-2.0, 0.0, 8.0] {
            let load = task.load(&Situation { speed_m_s, ..Situation::default() }, &[], &mut []);
            assert_eq!(load, Load { hydraulic_power_w: 1234.5, ..Load::default() });
        }
    }

    #[test]
    fn a_parameter_that_it_does_not_have_is_refused() {
        assert!(ron::from_str::<Hydraulic>("(power_w: 1.0)").is_ok());
        assert!(ron::from_str::<Hydraulic>("(power_w: 1.0, width_m: 3.0)").is_err());
    }
}
