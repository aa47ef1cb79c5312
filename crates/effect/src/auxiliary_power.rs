//! Electric consumers that were not recorded: fan, heater, air conditioning, lights.
//!
//! P = P₀ + P(t) + P_c max(0, 1 − T / T_b)        P(t) constant between its edges, 0 outside; T the temperature of the air [°C]
//!
//! Source: heat balance of a cabin: heating power in proportion to what the air is colder than a balance temperature.
//! Without a known temperature the last term is 0. Leaves out the warm-up of the cabin, which P(t) can hold.
//! Fingerprint: power that is missing from the balance of the battery (or fuel) at rest as in motion, and not from the balance of
//! forces; switched with time, or larger on cold days.

use crate::series::{check_steps, step};
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// Power beside the drive.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AuxiliaryPower {
    #[serde(default)]
    power_w: f64,
    #[serde(default)]
    times_s: Vec<f64>,
    #[serde(default)]
    powers_w: Vec<f64>,
    #[serde(default)]
    freezing_power_w: f64,
    #[serde(default = "balance_c")]
    balance_temperature_c: f64,
}

const fn balance_c() -> f64 {
    18.0
}

impl Plugin for AuxiliaryPower {
    const CARD: Card = Card {
        name: "auxiliary_power",
        about: "electric consumers that were not recorded: constant, switched, or by temperature",
        equation: "P = P₀ + P(t) + P_c max(0, 1 − T/T_b)",
        source: "heat balance of a cabin, linear in the temperature of the air; Incropera and DeWitt, Fundamentals of Heat and \
                 Mass Transfer (2007), chapter 1",
        validity: "consumers that do not depend on the drive",
        parameters: &[
            parameter("power_w", "W", "at all times, P₀").usually(-500.0, 20_000.0).or(0.0),
            parameter(
                "times_s",
                "[s]",
                "edges of spells since the start of the run, increasing; none where left out, t",
            )
            .usually(0.0, 1e5),
            parameter("powers_w", "[W]", "power in each spell, one less than edges, P")
                .usually(-500.0, 30_000.0),
            parameter("freezing_power_w", "W", "that temperature asks for in air of 0 °C, P_c")
                .usually(0.0, 10_000.0)
                .or(0.0),
            parameter("balance_temperature_c", "°C", "above which temperature asks for nothing, T_b")
                .must_be(Bound::Positive)
                .usually(10.0, 25.0)
                .or(balance_c()),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        check_steps(("times_s", &self.times_s), ("powers_w", &self.powers_w))
    }
}

impl Effect for AuxiliaryPower {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let colder = 1.0 - at.air.temperature_c / self.balance_temperature_c;
        // NaN, an unknown temperature, loses against 0.
        let heating_w = self.freezing_power_w * colder.max(0.0);
        let spell_w = step(&self.times_s, &self.powers_w, at.time_s);
        Action { auxiliary_power_w: self.power_w + spell_w + heating_w, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// 300 W, 2000 W in the spell around 50 s, and at 5 °C three quarters of 4000 W.
    #[test]
    fn three_kinds_of_consumers_add_up() {
        let all = "(power_w: 300.0, times_s: [20.0, 60.0], powers_w: [2000.0], freezing_power_w: 4000.0, \
                    balance_temperature_c: 20.0)";
        assert!(same(act::<AuxiliaryPower>(all, &at_10_m_s()).auxiliary_power_w, 5300.0));
        let mut later = at_10_m_s();
        (later.time_s, later.air.temperature_c) = (60.0, f64::NAN);
        assert!(same(act::<AuxiliaryPower>(all, &later).auxiliary_power_w, 300.0));
        later.air.temperature_c = 30.0;
        assert!(same(act::<AuxiliaryPower>(all, &later).auxiliary_power_w, 300.0));
    }

    #[test]
    fn a_power_without_its_spell_is_refused() {
        assert!(build::<AuxiliaryPower>("(powers_w: [100.0])").is_err());
    }
}
