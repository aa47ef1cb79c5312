//! A power through the power take-off.
//!
//! P = P₀ φ(s)        φ the fluctuation along the path, 1 where none is given
//!
//! Source: definition; OECD Code 2 measures tractors against such powers.
//! Leaves out the change of power with crop flow and shaft speed.

use crate::fluctuation::Fluctuation;
use headland_plugin::{Bound, Card, Load, Plugin, Refusal, Situation, Task, parameter};
use serde::Deserialize;
use std::path::Path;

/// A machine that is driven through the power take-off.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PtoPower {
    power_w: f64,
    #[serde(default)]
    fluctuation: Option<Fluctuation>,
}

impl Plugin for PtoPower {
    const CARD: Card = Card {
        name: "PtoPower",
        about: "a power through the power take-off, constant or fluctuating along the path",
        equation: "P = P₀ (1 + σ x(s) + σ_t y(s))",
        source: "definition; OECD Code 2 measures tractors against such powers",
        validity: "leaves out the change of power with crop flow and shaft speed",
        parameters: &[
            parameter("power_w", "W", "power at the shaft, P₀")
                .must_be(Bound::NotNegative)
                .usually(1_000.0, 300_000.0),
            parameter(
                "fluctuation",
                "(sd, length_m, trend_sd, trend_length_m, seed)",
                "spread along the path as shares of the mean, and lengths of correlation; left out: none",
            ),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.fluctuation.iter().try_for_each(Fluctuation::check)
    }
}

impl Task for PtoPower {
    fn load(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        let factor = self.fluctuation.map_or(1.0, |fluctuation| fluctuation.factor(at.position_m));
        Load { pto_power_w: factor * self.power_w, ..Load::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_takes_what_it_says_at_any_speed_and_nothing_else() {
        let task = PtoPower { power_w: 1234.5, fluctuation: None };
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
