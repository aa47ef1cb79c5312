//! Thresholds with hysteresis: when the engine runs, and how much of the power it gives.
//!
//! on:       P > P_start, or the store cannot give P, or charging
//! off:      P < P_stop, not charging, and the engine has run for t_least
//! charging: from S < S_below until S ≥ S_until
//! P_e     = P + P_charge   while charging
//! P_e     = min(P, P_assist) otherwise; the store assists beyond
//!
//! Source: rule-based strategies as in Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 7.3.
//!
//! In overrun the engine gives nothing and the store takes what it can. An engine that was stopped stays so for t_least
//! as long as the store can do without it.

use headland_plugin::{Bound, Card, Management, Outlook, Plugin, Refusal, Share, State, Stores, parameter};
use serde::Deserialize;
use std::path::Path;

/// Thresholds with hysteresis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thresholds {
    start_power_w: f64,
    stop_power_w: f64,
    assist_power_w: f64,
    charge_below: f64,
    charge_until: f64,
    charging_power_w: f64,
    least_time_s: f64,
}

impl Plugin for Thresholds {
    const CARD: Card = Card {
        name: "Thresholds",
        about: "thresholds of power and charge with hysteresis: when the engine runs, and when the store assists",
        equation: "on where P > P_start or S < S_below, off where P < P_stop; P_e = min(P, P_assist), \
                   P + P_charge from S < S_below until S ≥ S_until",
        source: "rule-based strategies; Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), section 7.3; \
                 usual values from memory",
        validity: "any driveline with an engine and a second store; does not know what its choices cost",
        parameters: &[
            parameter("start_power_w", "W", "the engine starts above this, P_start")
                .must_be(Bound::Finite)
                .usually(0.0, 1.5e5),
            parameter("stop_power_w", "W", "the engine stops below this, P_stop")
                .must_be(Bound::Finite)
                .usually(-1e4, 1e5),
            parameter("assist_power_w", "W", "the store gives what is wanted beyond this, P_assist")
                .must_be(Bound::Positive)
                .usually(5e3, 5e5),
            parameter("charge_below", "1", "charge at which the engine begins to charge, S_below")
                .must_be(Bound::Within(0.0, 1.0))
                .usually(0.1, 0.9),
            parameter("charge_until", "1", "charge at which it ends, S_until")
                .must_be(Bound::Within(0.0, 1.0))
                .usually(0.2, 0.95),
            parameter("charging_power_w", "W", "what the engine gives more while it charges, P_charge")
                .must_be(Bound::Positive)
                .usually(1e3, 1.5e5),
            parameter("least_time_s", "s", "the engine runs and rests at least so long, t_least")
                .must_be(Bound::NotNegative)
                .usually(0.0, 120.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        let refuse = |parameter: &str, found: f64, expected: String| Refusal {
            parameter: parameter.to_owned(),
            found: found.to_string(),
            expected,
        };
        if self.stop_power_w > self.start_power_w {
            let expected = format!("at most `start_power_w`, {}", self.start_power_w);
            return Err(refuse("stop_power_w", self.stop_power_w, expected));
        }
        if self.charge_until < self.charge_below {
            let expected = format!("at least `charge_below`, {}", self.charge_below);
            return Err(refuse("charge_until", self.charge_until, expected));
        }
        Ok(())
    }
}

const CHARGING: usize = 0;
const SINCE: usize = 1;

impl Management for Thresholds {
    fn states(&self) -> Vec<State> {
        vec![
            State { name: "charging", initial: 0.0 },
            State { name: "since_switch_s", initial: self.least_time_s },
        ]
    }

    fn share(&self, at: &dyn Stores, states: &mut [f64]) -> Share {
        let Outlook { power_w, state_of_charge, most_store_w, engine_runs, .. } = at.outlook();
        let limit = if states[CHARGING] > 0.5 { self.charge_until } else { self.charge_below };
        let charging = state_of_charge < limit;
        states[CHARGING] = f64::from(u8::from(charging));

        let needed = power_w > most_store_w.0;
        let wanted = charging || power_w > if engine_runs { self.stop_power_w } else { self.start_power_w };
        let settled = states[SINCE] >= self.least_time_s;
        let runs = needed || if settled { wanted } else { engine_runs };
        if runs != engine_runs {
            states[SINCE] = 0.0;
        }
        let engine_w = if charging && power_w > 0.0 {
            power_w + self.charging_power_w
        } else if charging {
            self.charging_power_w
        } else {
            power_w.clamp(0.0, self.assist_power_w)
        };
        Share { engine_runs: runs, engine_w }
    }

    fn flows_by_outlook(&self) -> bool {
        false
    }

    fn flow(&self, _: &Outlook, _: &[f64], rates: &mut [f64]) {
        rates[CHARGING] = 0.0;
        rates[SINCE] = 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Plant;

    fn thresholds() -> Thresholds {
        ron::from_str(
            "(start_power_w: 30e3, stop_power_w: 10e3, assist_power_w: 100e3, charge_below: 0.4, charge_until: 0.6, \
              charging_power_w: 20e3, least_time_s: 20)",
        )
        .unwrap()
    }

    fn shared(plant: &Plant, states: &mut [f64]) -> Share {
        thresholds().share(plant, states)
    }

    #[test]
    fn the_engine_starts_above_one_power_and_stops_below_another() {
        let plant = |power_w, engine_runs| Plant { power_w, engine_runs, ..Plant::default() };
        let runs = |plant: Plant| shared(&plant, &mut [0.0, 100.0]).engine_runs;
        assert!(runs(plant(31e3, false)) && !runs(plant(29e3, false)));
        assert!(runs(plant(11e3, true)) && !runs(plant(9e3, true)));
    }

    #[test]
    fn it_does_not_switch_within_the_least_time_unless_the_store_cannot_do_it() {
        let plant = Plant { power_w: 31e3, ..Plant::default() };
        assert!(!shared(&plant, &mut [0.0, 19.0]).engine_runs);
        let mut states = [0.0, 20.0];
        assert!(shared(&plant, &mut states).engine_runs);
        assert_eq!(states[SINCE], 0.0);
        let heavy = Plant { power_w: 150e3, ..Plant::default() };
        assert!(shared(&heavy, &mut [0.0, 0.0]).engine_runs);
    }

    /// 150 kW wanted: the engine gives 100, the store 50; from 40 % charge on down the engine gives 20 kW more instead.
    #[test]
    fn the_store_assists_until_it_has_to_be_charged() {
        let plant = Plant { power_w: 150e3, engine_runs: true, ..Plant::default() };
        assert_eq!(shared(&plant, &mut [0.0, 100.0]).engine_w, 100e3);
        let low = Plant { state_of_charge: 0.39, ..plant };
        let mut states = [0.0, 100.0];
        assert_eq!(shared(&low, &mut states).engine_w, 170e3);
        let recovering = Plant { state_of_charge: 0.59, ..plant };
        assert_eq!(shared(&recovering, &mut states).engine_w, 170e3);
        let recovered = Plant { state_of_charge: 0.61, ..plant };
        assert_eq!(shared(&recovered, &mut states).engine_w, 100e3);
    }

    #[test]
    fn thresholds_in_the_wrong_order_are_refused() {
        let mut wrong = Thresholds { stop_power_w: 40e3, ..thresholds() };
        assert_eq!(wrong.settle(Path::new(".")).unwrap_err().parameter, "stop_power_w");
        let mut wrong = Thresholds { charge_until: 0.3, ..thresholds() };
        assert_eq!(wrong.settle(Path::new(".")).unwrap_err().parameter, "charge_until");
    }
}
