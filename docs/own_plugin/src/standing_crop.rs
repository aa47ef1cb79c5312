//! An effect: a standing crop that the vehicle bends on a stretch of its path, slowly springing into motion with it.
//!
//! F     = b h σ(x)                  where the crop stands, σ = 1, elsewhere 0
//! τ dF/dt = b h σ(x) − F            the bent stalks push back with a lag
//!
//! Source: empirical: force per frontal area of what is driven through.
//! Shows an effect that remembers: its state is integrated beside the motion and is a channel of the trace.

use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, State, parameter};
use serde::Deserialize;
use std::path::Path;

/// A crop between two positions.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StandingCrop {
    force_n: f64,
    from_m: f64,
    to_m: f64,
    lag_s: f64,
}

impl Plugin for StandingCrop {
    const CARD: Card = Card {
        name: "standing_crop",
        about: "a standing crop that is driven through on a stretch of the path",
        equation: "τ dF/dt = F₀ σ(x) − F",
        source: "empirical",
        validity: "one pass over a crop of one height; leaves out what stays behind bent",
        parameters: &[
            parameter("force_n", "N", "in the middle of the crop, F₀")
                .must_be(Bound::NotNegative)
                .usually(10.0, 5000.0),
            parameter("from_m", "m", "position at which it begins").usually(0.0, 1e5),
            parameter("to_m", "m", "position at which it ends").usually(0.0, 1e5),
            parameter("lag_s", "s", "time in which the force grows and dies away, τ")
                .must_be(Bound::Positive)
                .usually(0.05, 10.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        if self.to_m > self.from_m {
            return Ok(());
        }
        let expected = format!("more than `from_m`, {}", self.from_m);
        Err(Refusal { parameter: "to_m".to_owned(), found: self.to_m.to_string(), expected })
    }
}

impl Effect for StandingCrop {
    fn states(&self) -> Vec<State> {
        vec![State { name: "push_n", initial: 0.0 }]
    }

    fn act(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Action {
        let stands = (self.from_m..self.to_m).contains(&at.position_m);
        let target_n = if stands { self.force_n } else { 0.0 };
        rates[0] = (target_n - states[0]) / self.lag_s;
        Action { resistance_n: states[0], ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crop() -> StandingCrop {
        StandingCrop { force_n: 800.0, from_m: 10.0, to_m: 20.0, lag_s: 0.5 }
    }

    /// (800 − 200) / 0.5 = 1200 N/s in the crop, −200 / 0.5 behind it.
    #[test]
    fn the_push_grows_in_the_crop_and_dies_away_behind_it() {
        for (position_m, expected) in [(15.0, 1200.0), (25.0, -400.0)] {
            let mut rates = [0.0];
            let at = Situation { position_m, ..Situation::default() };
            assert_eq!(crop().act(&at, &[200.0], &mut rates).resistance_n, 200.0);
            assert_eq!(rates, [expected]);
        }
    }

    #[test]
    fn a_crop_that_ends_before_it_begins_is_refused() {
        let mut wrong = StandingCrop { to_m: 5.0, ..crop() };
        assert_eq!(wrong.settle(Path::new("")).unwrap_err().parameter, "to_m");
    }
}
