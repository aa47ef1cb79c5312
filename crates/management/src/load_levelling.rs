//! Load levelling: the engine gives what is wanted on average, the store what varies about it.
//!
//! τ dP̄/dt = max(0, P) − P̄
//! P_e = P̄ + g (S_t − S)
//!
//! Source: frequency separation by a first-order filter; Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013),
//! section 7.3. The filter of 5 to 20 s that fits tillage is a default from memory.
//!
//! The engine never stops. Overrun charges the store and does not lower the average.

use headland_plugin::{Bound, Card, Management, Outlook, Plugin, Share, State, Stores, parameter};
use serde::Deserialize;

/// An engine that gives the average.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadLevelling {
    time_constant_s: f64,
    target_charge: f64,
    charge_gain_w: f64,
    initial_power_w: f64,
}

impl Plugin for LoadLevelling {
    const CARD: Card = Card {
        name: "LoadLevelling",
        about: "the engine gives the power that is wanted on average, the store what varies about it",
        equation: "τ dP̄/dt = max(0, P) − P̄; P_e = P̄ + g (S_t − S)",
        source: "frequency separation; Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), section 7.3; \
                 the filter of 5 to 20 s that fits tillage, and usual values, from memory",
        validity: "loads that vary about a mean, such as tillage; the engine never stops",
        parameters: &[
            parameter("time_constant_s", "s", "of the average, τ")
                .must_be(Bound::Positive)
                .usually(2.0, 120.0),
            parameter("target_charge", "1", "charge that is kept, S_t")
                .must_be(Bound::Within(0.0, 1.0))
                .usually(0.3, 0.9),
            parameter("charge_gain_w", "W", "power for a missing charge of 1, g")
                .must_be(Bound::NotNegative)
                .usually(0.0, 5e6),
            parameter("initial_power_w", "W", "the average at the start of a run")
                .must_be(Bound::NotNegative)
                .usually(0.0, 5e5),
        ],
    };
}

impl Management for LoadLevelling {
    fn states(&self) -> Vec<State> {
        vec![State { name: "levelled_power_w", initial: self.initial_power_w }]
    }

    fn share(&self, at: &dyn Stores, states: &mut [f64]) -> Share {
        let outlook = at.outlook();
        let missing = self.target_charge - outlook.state_of_charge;
        Share { engine_runs: true, engine_w: (states[0] + self.charge_gain_w * missing).max(0.0) }
    }

    fn flow(&self, outlook: &Outlook, states: &[f64], rates: &mut [f64]) {
        rates[0] = (outlook.power_w.max(0.0) - states[0]) / self.time_constant_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Plant;

    /// Average 80 kW, charge 0.55 for a target of 0.6: 80 + 1000 · 0.05 = 130 kW. At 150 kW the average rises by 7 kW/s.
    #[test]
    fn the_engine_gives_the_average_and_what_the_charge_misses() {
        let levelling: LoadLevelling = ron::from_str(
            "(time_constant_s: 10, target_charge: 0.6, charge_gain_w: 1e6, initial_power_w: 0)",
        )
        .unwrap();
        let plant = Plant { power_w: 150e3, state_of_charge: 0.55, ..Plant::default() };
        let share = levelling.share(&plant, &mut [80e3]);
        assert!(share.engine_runs && (share.engine_w - 130e3).abs() < 1e-6);
        let mut rates = [0.0];
        levelling.flow(&plant.outlook(), &[80e3], &mut rates);
        assert!((rates[0] - 7e3).abs() < 1e-9);
        // Full above its target, it relieves the engine, which never drives backwards.
        let full = Plant { state_of_charge: 0.9, ..plant };
        assert_eq!(levelling.share(&full, &mut [80e3]).engine_w, 0.0);
    }
}
