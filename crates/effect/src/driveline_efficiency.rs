//! A driveline that loses more of what it transmits than the scenario says.
//!
//! F_lost = ε |F|        F the force at the wheels without this loss
//!
//! Source: efficiency of gears; Niemann and Winter, *Maschinenelemente* II (2003), section 21.
//! The loss acts against the motion whether the drive pulls or brakes. Negative where the scenario loses too much. Where it lies
//! upstream of the place at which the force at the wheels is told, F is the force before it.
//! Fingerprint: a mismatch in proportion to the magnitude of the drive force, gone while coasting.

use crate::upstream::UPSTREAM;
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Situation, parameter};
use serde::Deserialize;

/// A share of the transmitted force.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivelineEfficiency {
    loss: f64,
    #[serde(default)]
    upstream: bool,
}

impl Plugin for DrivelineEfficiency {
    const CARD: Card = Card {
        name: "driveline_efficiency",
        about: "a loss in proportion to the force that is transmitted",
        equation: "F_lost = ε |F|",
        source: "efficiency of gears; Niemann and Winter, Maschinenelemente II (2003), section 21",
        validity: "losses of load, against the motion whether the drive pulls or brakes; those without load are drags; F is the force without this loss",
        parameters: &[
            parameter("loss", "1", "share of the force at the wheels, beside the losses stated, ε")
                .must_be(Bound::Within(-0.4, 0.4))
                .usually(-0.1, 0.3),
            UPSTREAM,
        ],
    };
}

impl Effect for DrivelineEfficiency {
    fn act(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        if self.upstream {
            return Action { upstream_share: self.loss, ..Action::default() };
        }
        Action { loss_share: self.loss, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build};

    #[test]
    fn it_takes_its_share_and_nothing_else() {
        let action = act::<DrivelineEfficiency>("(loss: 0.08)", &at_10_m_s());
        assert_eq!(action, Action { loss_share: 0.08, ..Action::default() });
    }

    #[test]
    fn upstream_it_asks_more_of_what_drives_instead() {
        let action = act::<DrivelineEfficiency>("(loss: 0.08, upstream: true)", &at_10_m_s());
        assert_eq!(action, Action { upstream_share: 0.08, ..Action::default() });
    }

    #[test]
    fn a_loss_has_to_be_given() {
        assert!(build::<DrivelineEfficiency>("()").is_err());
    }
}
