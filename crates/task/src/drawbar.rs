//! A pull at the hitch.
//!
//! D = D₀ φ(s)        φ the fluctuation along the path, 1 where none is given
//!
//! Source: definition; OECD Code 2 measures tractors against such pulls.
//! Leaves out depth, speed and soil of an implement, and the weight that it transfers.

use crate::fluctuation::Fluctuation;
use headland_plugin::{Bound, Card, Load, Plugin, Refusal, Situation, Task, parameter};
use serde::Deserialize;
use std::path::Path;

/// A trailer or implement that pulls back with a constant force.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drawbar {
    force_n: f64,
    #[serde(default)]
    fluctuation: Option<Fluctuation>,
}

impl Plugin for Drawbar {
    const CARD: Card = Card {
        name: "Drawbar",
        about: "a pull at the hitch, constant or fluctuating along the path",
        equation: "D = D₀ (1 + σ x(s) + σ_t y(s))",
        source: "definition; OECD Code 2 measures tractors against such pulls",
        validity: "leaves out depth, speed and soil of an implement, and the weight that it transfers",
        parameters: &[
            parameter("force_n", "N", "pull, backward, D₀")
                .must_be(Bound::NotNegative)
                .usually(500.0, 150_000.0),
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

impl Task for Drawbar {
    fn load(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        let factor = self.fluctuation.map_or(1.0, |fluctuation| fluctuation.factor(at.position_m));
        Load { drawbar_force_n: factor * self.force_n, ..Load::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_takes_what_it_says_at_any_speed_and_nothing_else() {
        let task = Drawbar { force_n: 1234.5, fluctuation: None };
        for speed_m_s in [-2.0, 0.0, 8.0] {
            let load = task.load(&Situation { speed_m_s, ..Situation::default() }, &[], &mut []);
            assert_eq!(load, Load { drawbar_force_n: 1234.5, ..Load::default() });
        }
    }

    #[test]
    fn a_parameter_that_it_does_not_have_is_refused() {
        assert!(ron::from_str::<Drawbar>("(force_n: 1.0)").is_ok());
        assert!(ron::from_str::<Drawbar>("(force_n: 1.0, width_m: 3.0)").is_err());
    }
}
