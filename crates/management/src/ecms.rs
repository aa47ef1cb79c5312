//! Equivalent consumption: a joule of the store is worth s joules of fuel, and the cheapest sharing is taken.
//!
//! min over P_e of  P_f + s p(S) P_b     s = s_dis where P_b > 0, s_chg where P_b < 0
//! p(S) = 1 − (2 (S − S_t) / (S_max − S_min))³
//!
//! Source: Paganelli et al., *Equivalent consumption minimization strategy for parallel hybrid powertrains* (2002);
//! Onori, Serrao and Rizzoni, *Hybrid Electric Vehicles: Energy Management Strategies* (2016), chapter 6. The exponent of the
//! penalty is a default from memory.
//!
//! P_f is the power of the fuel and P_b what is drawn from the store before its resistance. The engine may stop; it runs
//! and rests at least for t_least unless the store cannot do it.

use crate::least::{LEAST_TIME_S, LEVELS, TARGET_CHARGE, switched, usual_levels, whole_levels};
use headland_plugin::{
    Bound, Card, Consequence, Management, Outlook, Plugin, Refusal, Share, State, Stores, parameter,
};
use serde::Deserialize;
use std::path::Path;

/// Power of the penalty of a charge that has gone astray.
const PENALTY_EXPONENT: i32 = 3;

/// Equivalent consumption minimisation with constant factors.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ecms {
    equivalence_discharge: f64,
    equivalence_charge: f64,
    target_charge: f64,
    #[serde(default = "usual_levels")]
    levels: f64,
    least_time_s: f64,
}

impl Plugin for Ecms {
    const CARD: Card = Card {
        name: "Ecms",
        about: "equivalent consumption: the sharing is taken that costs least with a price on what the store gives",
        equation: "min P_f + s p(S) P_b over P_e; p(S) = 1 − (2 (S − S_t) / (S_max − S_min))³",
        source: "Paganelli et al., Equivalent consumption minimization strategy for parallel hybrid powertrains (2002); \
                 Onori, Serrao and Rizzoni, Hybrid Electric Vehicles (2016), chapter 6; \
                 the exponent of the penalty, and usual values, from memory",
        validity: "charge stays about its target only where the factors fit the work; costs a look at each level in every step",
        parameters: &[
            parameter("equivalence_discharge", "1", "fuel energy that drawn energy is worth, s_dis")
                .must_be(Bound::Positive)
                .usually(1.5, 4.5),
            parameter("equivalence_charge", "1", "fuel energy that stored energy is worth, s_chg")
                .must_be(Bound::Positive)
                .usually(1.5, 4.5),
            TARGET_CHARGE,
            LEVELS,
            LEAST_TIME_S,
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        if self.equivalence_charge > self.equivalence_discharge {
            return Err(Refusal {
                parameter: "equivalence_charge".to_owned(),
                found: self.equivalence_charge.to_string(),
                expected: format!(
                    "at most `equivalence_discharge`, {}: what goes in cannot be worth more than what comes out",
                    self.equivalence_discharge
                ),
            });
        }
        whole_levels(self.levels)
    }
}

/// p(S): above 1 where charge is missing.
fn penalty(outlook: &Outlook, target: f64) -> f64 {
    let (least, most) = outlook.window;
    1.0 - (2.0 * (outlook.state_of_charge - target) / (most - least)).powi(PENALTY_EXPONENT)
}

impl Ecms {
    fn price(&self, outlook: &Outlook, consequence: &Consequence) -> f64 {
        let store_w = consequence.store_w;
        let worth = if store_w > 0.0 { self.equivalence_discharge } else { self.equivalence_charge };
        consequence.fuel_w + worth * penalty(outlook, self.target_charge) * store_w
    }
}

impl Management for Ecms {
    fn states(&self) -> Vec<State> {
        vec![State { name: "since_switch_s", initial: self.least_time_s }]
    }

    fn share(&self, at: &dyn Stores, states: &mut [f64]) -> Share {
        let outlook = at.outlook();
        let price = |consequence: &Consequence| self.price(&outlook, consequence);
        switched(at, self.levels, self.least_time_s, &mut states[0], price)
    }

    fn flows_by_outlook(&self) -> bool {
        false
    }

    fn flow(&self, _: &Outlook, _: &[f64], rates: &mut [f64]) {
        rates[0] = 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Plant;

    fn ecms(discharge: f64, charge: f64) -> Ecms {
        ron::from_str(&format!(
            "(equivalence_discharge: {discharge}, equivalence_charge: {charge}, target_charge: 0.5, levels: 20, \
              least_time_s: 10)"
        ))
        .unwrap()
    }

    /// The plant burns 8 kW + 2.2 P + P²/400 kW and loses nothing in its store: dP_f/dP = s where P = 200 (s − 2.2) kW.
    #[test]
    fn the_engine_works_where_its_last_watt_costs_what_the_store_is_worth() {
        let plant = Plant { power_w: 60e3, engine_runs: true, ..Plant::default() };
        let share = ecms(2.6, 2.6).share(&plant, &mut [100.0]);
        assert!(share.engine_runs && (share.engine_w - 80e3).abs() < 150.0, "{share:?}");
    }

    /// Between what charging brings and what discharging costs, the store is left alone.
    #[test]
    fn between_the_two_factors_the_store_rests() {
        let plant = Plant { power_w: 80e3, engine_runs: true, ..Plant::default() };
        assert_eq!(ecms(3.0, 2.4).share(&plant, &mut [100.0]).engine_w, 80e3);
    }

    /// 10 kW from the engine burn 30 kW; from a store at 2.6 they are worth 26: the engine stops, once it may.
    #[test]
    fn an_engine_that_idles_dearly_is_stopped() {
        let plant = Plant { power_w: 10e3, engine_runs: true, ..Plant::default() };
        let mut states = [100.0];
        assert!(!ecms(2.6, 1.9).share(&plant, &mut states).engine_runs);
        assert_eq!(states[0], 0.0);
        assert!(ecms(2.6, 1.9).share(&plant, &mut [5.0]).engine_runs);
    }

    /// 10 % of charge missing in a window of 60 %: p = 1 + (1/3)³.
    #[test]
    fn missing_charge_makes_the_store_dear() {
        let outlook = Plant { state_of_charge: 0.4, ..Plant::default() }.outlook();
        assert!((penalty(&outlook, 0.5) - (1.0 + 1.0 / 27.0)).abs() < 1e-12);
    }

    #[test]
    fn charge_dearer_than_discharge_is_refused() {
        let mut wrong = ecms(2.0, 2.5);
        assert_eq!(wrong.settle(Path::new(".")).unwrap_err().parameter, "equivalence_charge");
        let mut odd = Ecms { levels: 2.5, ..ecms(2.5, 2.0) };
        assert!(odd.settle(Path::new(".")).unwrap_err().to_string().contains("whole"));
    }
}
