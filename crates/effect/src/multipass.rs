//! Ground that resists less each time it is driven over.
//!
//! F = c₁ (q^(N − 1) − 1) m g cos θ        N the number of the pass
//!
//! Source: Holm, *Journal of Terramechanics* 6 (1969), multi-pass behaviour: the increments of rut depth shrink from pass to
//! pass; here as a geometric sequence.
//! N is `pass` at the start, where it is left out that of a recorded run on its path, and grows by one with every lap where
//! `lap_length_m` is given. q above 1 is ground that breaks up.
//! Fingerprint: resistance falls from run to run in the same lane, and a fresh lane brings it back.

use crate::rolling_resistance::load_n;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// Repeated passes over the same lane.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Multipass {
    coefficient: f64,
    factor: f64,
    pass: Option<f64>,
    #[serde(default = "no_lap")]
    lap_length_m: f64,
}

const fn first() -> f64 {
    1.0
}

const fn no_lap() -> f64 {
    f64::INFINITY
}

impl Plugin for Multipass {
    const CARD: Card = Card {
        name: "multipass",
        about: "ground that resists less, or more, each time it is driven over",
        equation: "F = c₁ (q^(N − 1) − 1) m g cos θ",
        source: "Holm, Journal of Terramechanics 6 (1969), as a geometric sequence",
        validity: "passes in the same lane; leaves out rest and rain between them",
        parameters: &[
            parameter("coefficient", "1", "resistance per load on the first pass that passes change, c₁")
                .must_be(Bound::NotNegative)
                .usually(0.0, 0.2),
            parameter("factor", "1", "from one pass to the next, q")
                .must_be(Bound::Positive)
                .usually(0.4, 1.2),
            parameter(
                "pass",
                "1",
                "number of the pass at the start of the run, from 1, N; where it is left out, a replay counts the recorded \
                 runs of a path",
            )
                .must_be(Bound::Positive)
                .usually(1.0, 30.0)
                .or(first()),
            parameter(
                "lap_length_m",
                "m",
                "distance after which the next pass begins; endless where it is left out",
            )
            .must_be(Bound::Positive)
            .usually(10.0, 1e4)
            .or(no_lap()),
        ],
    };
}

impl Effect for Multipass {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let first = self.pass.map_or(at.passes_before as f64, |pass| pass - first());
        let before = first + (at.position_m / self.lap_length_m).floor().max(0.0);
        let change = self.factor.powf(before) - 1.0;
        Action { resistance_n: self.coefficient * change * load_n(at), ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// Third pass, q = 0.8: 0.02 · (0.64 − 1) · 20 kN = −144 N; the first changes nothing.
    #[test]
    fn the_third_pass_by_hand_and_the_first_by_definition() {
        let at = at_10_m_s();
        assert!(same(
            act::<Multipass>("(coefficient: 0.02, factor: 0.8, pass: 3)", &at).resistance_n,
            -144.0
        ));
        assert_eq!(act::<Multipass>("(coefficient: 0.02, factor: 0.8)", &at).resistance_n, 0.0);
    }

    /// After 120 m, laps of 50 m: the third pass.
    #[test]
    fn laps_count_as_passes() {
        let action = act::<Multipass>("(coefficient: 0.02, factor: 0.8, lap_length_m: 50.0)", &at_10_m_s());
        assert!(same(action.resistance_n, -144.0));
    }

    #[test]
    fn a_factor_has_to_be_given() {
        assert!(build::<Multipass>("(coefficient: 0.02)").is_err());
    }
}
