//! Equivalent consumption whose factor is led by the charge.
//!
//! min over P_e of  P_f + s P_b
//! s = s₀ + k_p (S_t − S) + k_i ∫(S_t − S) dt
//!
//! Source: adaptation from the state of charge by a PI law: Onori, Serrao and Rizzoni, *Hybrid Electric Vehicles: Energy
//! Management Strategies* (2016), chapter 6; Musardo et al., *A-ECMS* (2005), for the idea.
//!
//! P_f is the power of the fuel and P_b what is drawn from the store before its resistance. Needs no knowledge of the work
//! ahead: a charge that falls makes the store dearer until it stays.

use crate::least::{LEAST_TIME_S, LEVELS, TARGET_CHARGE, switched, usual_levels, whole_levels};
use headland_plugin::{
    Bound, Card, Consequence, Management, Outlook, Plugin, Refusal, Share, State, Stores, parameter,
};
use serde::Deserialize;
use std::path::Path;

/// Equivalent consumption minimisation with a factor that follows the charge.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AdaptiveEcms {
    equivalence: f64,
    proportional_gain: f64,
    integral_gain_per_s: f64,
    target_charge: f64,
    #[serde(default = "usual_levels")]
    levels: f64,
    least_time_s: f64,
}

impl Plugin for AdaptiveEcms {
    const CARD: Card = Card {
        name: "AdaptiveEcms",
        about: "equivalent consumption whose factor follows the charge",
        equation: "min P_f + s P_b over P_e; s = s₀ + k_p (S_t − S) + k_i ∫(S_t − S) dt",
        source: "Onori, Serrao and Rizzoni, Hybrid Electric Vehicles (2016), chapter 6; Musardo et al., A-ECMS (2005); usual \
                 values from memory",
        validity: "work that lasts longer than the charge takes to settle; costs a look at each level in every step",
        parameters: &[
            parameter("equivalence", "1", "fuel energy that stored energy is worth at the start, s₀")
                .must_be(Bound::Positive)
                .usually(1.5, 4.5),
            parameter("proportional_gain", "1", "change of the factor for a missing charge of 1, k_p")
                .must_be(Bound::NotNegative)
                .usually(0.0, 50.0),
            parameter("integral_gain_per_s", "1/s", "the same for each second that it is missing, k_i")
                .must_be(Bound::NotNegative)
                .usually(0.0, 1.0),
            TARGET_CHARGE,
            LEVELS,
            LEAST_TIME_S,
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        whole_levels(self.levels)
    }
}

const SINCE: usize = 0;
const MISSING: usize = 1;

impl AdaptiveEcms {
    /// s now.
    fn factor(&self, outlook: &Outlook, missing_s: f64) -> f64 {
        let missing = self.target_charge - outlook.state_of_charge;
        self.equivalence + self.proportional_gain * missing + self.integral_gain_per_s * missing_s
    }
}

impl Management for AdaptiveEcms {
    fn states(&self) -> Vec<State> {
        vec![
            State { name: "since_switch_s", initial: self.least_time_s },
            State { name: "charge_missing_s", initial: 0.0 },
        ]
    }

    fn share(&self, at: &dyn Stores, states: &mut [f64]) -> Share {
        let outlook = at.outlook();
        let factor = self.factor(&outlook, states[MISSING]);
        let price = |consequence: &Consequence| consequence.fuel_w + factor * consequence.store_w;
        switched(at, self.levels, self.least_time_s, &mut states[SINCE], price)
    }

    fn flow(&self, outlook: &Outlook, _: &[f64], rates: &mut [f64]) {
        rates[SINCE] = 1.0;
        rates[MISSING] = self.target_charge - outlook.state_of_charge;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Plant;

    fn adaptive() -> AdaptiveEcms {
        ron::from_str(
            "(equivalence: 2.6, proportional_gain: 2, integral_gain_per_s: 0.01, target_charge: 0.5, levels: 20, \
              least_time_s: 0)",
        )
        .unwrap()
    }

    /// At its target it is the constant factor; 10 % missing for 20 s make s = 2.6 + 0.2 + 0.02.
    #[test]
    fn the_factor_follows_the_charge() {
        let full = Plant::default().outlook();
        assert_eq!(adaptive().factor(&full, 0.0), 2.6);
        let low = Plant { state_of_charge: 0.4, ..Plant::default() }.outlook();
        assert!((adaptive().factor(&low, 2.0) - 2.82).abs() < 1e-12);
    }

    /// Closed loop on the plant: whatever the first factor, the charge comes back to its target.
    #[test]
    fn the_charge_settles_at_its_target_from_a_wrong_factor() {
        for equivalence in [2.35, 2.6, 3.2] {
            let adaptive = AdaptiveEcms { equivalence, ..adaptive() };
            let mut plant = Plant { power_w: 70e3, engine_runs: true, ..Plant::default() };
            let mut states = [0.0, 0.0];
            for _ in 0..4000 {
                let share = adaptive.share(&plant, &mut states);
                let mut rates = [0.0; 2];
                adaptive.flow(&plant.outlook(), &states, &mut rates);
                plant.engine_runs = share.engine_runs;
                plant.state_of_charge += plant.weigh(share).charge_per_s;
                states[SINCE] += rates[SINCE];
                states[MISSING] += rates[MISSING];
            }
            assert!((plant.state_of_charge - 0.5).abs() < 0.01, "{equivalence}: {}", plant.state_of_charge);
        }
    }
}
