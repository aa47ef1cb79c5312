//! The branch of a power-split transmission that loses more, by how much power goes through it.
//!
//! F_lost = ε h |F|,   h = min(1, min over nodes |1 − |v| / v_i|)        v_i the speeds at which the variator stands still
//!
//! Source: share of variator power in output-coupled transmissions; Renius, *Fundamentals of Tractor Design* (2020), chapter 5.
//! Leaves out the change of the variator's own efficiency with pressure and speed.
//! Fingerprint: a loss in proportion to the drive force that vanishes at the nodes and rises between them: a saw-tooth over
//! speed.

use crate::series::refuse;
use crate::upstream::UPSTREAM;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// A loss that depends on the ratio.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VariatorLoss {
    loss: f64,
    node_speeds_m_s: Vec<f64>,
    #[serde(default)]
    upstream: bool,
}

impl Plugin for VariatorLoss {
    const CARD: Card = Card {
        name: "variator_loss",
        about: "a loss that depends on the ratio of a power-split transmission",
        equation: "F_lost = ε h |F|, h = min(1, minᵢ |1 − |v|/vᵢ|)",
        source: "variator power of output-coupled transmissions; Renius, Fundamentals of Tractor Design (2020), chapter 5",
        validity: "one engine speed, so that ratio goes with speed; leaves out pressure",
        parameters: &[
            parameter(
                "loss",
                "1",
                "share of the force at the wheels where all power goes through the variator, ε",
            )
            .must_be(Bound::Within(-0.4, 0.4))
            .usually(0.0, 0.3),
            parameter("node_speeds_m_s", "[m/s]", "speeds at which all power goes the mechanical way, vᵢ")
                .must_be(Bound::Positive)
                .usually(0.5, 20.0),
            UPSTREAM,
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        if let Some(node) = self.node_speeds_m_s.iter().find(|node| !Bound::Positive.holds(**node)) {
            return Err(refuse("node_speeds_m_s", &node.to_string(), &Bound::Positive.in_words()));
        }
        if self.node_speeds_m_s.is_empty() {
            return Err(refuse("node_speeds_m_s", "empty", "one speed or more"));
        }
        Ok(())
    }
}

impl Effect for VariatorLoss {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let v = at.speed_m_s.abs();
        let share = self.node_speeds_m_s.iter().map(|node| (1.0 - v / node).abs()).fold(1.0, f64::min);
        if self.upstream {
            return Action { upstream_share: self.loss * share, ..Action::default() };
        }
        Action { loss_share: self.loss * share, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    #[test]
    fn it_is_full_at_rest_nothing_at_the_nodes_and_partial_between() {
        for (speed_m_s, expected) in
            [(0.0, 0.2), (4.0, 0.0), (5.0, 0.05), (6.0, 0.05), (8.0, 0.0), (40.0, 0.2)]
        {
            let at = Situation { speed_m_s, ..at_10_m_s() };
            let action = act::<VariatorLoss>("(loss: 0.2, node_speeds_m_s: [4.0, 8.0])", &at);
            assert!(same(action.loss_share, expected), "{speed_m_s}: {}", action.loss_share);
        }
    }

    #[test]
    fn upstream_it_asks_more_of_what_drives_instead() {
        let at = Situation { speed_m_s: 5.0, ..at_10_m_s() };
        let action = act::<VariatorLoss>("(loss: 0.2, node_speeds_m_s: [4.0, 8.0], upstream: true)", &at);
        assert!(same(action.upstream_share, 0.05) && action.loss_share == 0.0);
    }

    #[test]
    fn nodes_have_to_be_speeds() {
        assert!(build::<VariatorLoss>("(loss: 0.2, node_speeds_m_s: [])").is_err());
        assert!(
            build::<VariatorLoss>("(loss: 0.2, node_speeds_m_s: [0.0])").unwrap_err().contains("more than 0")
        );
    }
}
