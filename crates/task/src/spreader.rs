//! A machine that spreads what it carries, and is filled again.
//!
//! dm/dt = −d W v        while it works, d dose [kg/m²]; +r while it is filled
//! P = a + b W + c F     F = 3.6 d W v [t/h]
//!
//! Source: ASABE D497, *Agricultural Machinery Management Data*, clause 5 and table 2 (from memory), for the power.
//! What is spread leaves with the speed of the machine, so that it pushes neither way. A drill's tank, a sprayer and a
//! fertiliser or manure spreader are such machines.

use crate::carriage::{self, Carriage};
use crate::payload;
use crate::power_table::{RotaryPower, choose};
use headland_plugin::{Bound, Card, Load, Mode, Plugin, Refusal, Situation, State, Task, parameter};
use serde::Deserialize;
use std::path::Path;

/// A spreader, a sprayer, a tank of seed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spreader {
    #[serde(default)]
    machine: Option<String>,
    #[serde(default)]
    power: Option<RotaryPower>,
    width_m: f64,
    dose_kg_per_m2: f64,
    capacity_kg: f64,
    initial_kg: f64,
    fill_rate_kg_s: f64,
    #[serde(default)]
    carriage: Option<Carriage>,
    #[serde(skip)]
    row: RotaryPower,
}

impl Plugin for Spreader {
    const CARD: Card = Card {
        name: "Spreader",
        about: "a machine that spreads what it carries: spreader, sprayer, tank of a drill",
        equation: "dm/dt = −d W v; P = a + b W + c 3.6 d W v",
        source: "ASABE D497, Agricultural Machinery Management Data, clause 5, its table 2 from memory",
        validity: "an even dose at every speed; leaves out overlap and what the throw pushes back",
        parameters: &[
            parameter(
                "machine",
                "name",
                "by name; a wrong one is answered with all that are known; or `power`",
            ),
            parameter("power", "(a, b, c)", "coefficients of your own in kW, kW/m and kW h/t; or `machine`"),
            parameter("width_m", "m", "working width, W").must_be(Bound::Positive).usually(1.0, 48.0),
            parameter("dose_kg_per_m2", "kg/m²", "what is spread on each area, d; 1 kg/m² is 10 t/ha")
                .must_be(Bound::NotNegative)
                .usually(0.001, 10.0),
            parameter("capacity_kg", "kg", "what it holds").must_be(Bound::Positive).usually(100.0, 40_000.0),
            parameter("initial_kg", "kg", "payload where a run begins")
                .must_be(Bound::NotNegative)
                .usually(0.0, 40_000.0),
            parameter("fill_rate_kg_s", "kg/s", "how fast it is filled, r")
                .must_be(Bound::Positive)
                .usually(1.0, 300.0),
            parameter(
                "carriage",
                "(mass_kg, carried_share, rolling_coefficient, drag_area_m2)",
                "its mass without payload, the share of both that the vehicle carries, and what its own wheels and the \
                 air take; left out: the vehicle carries the payload and the machine is part of it",
            ),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.row = choose(self.machine.as_deref(), self.power)?;
        payload::check_initial(self.initial_kg, self.capacity_kg)?;
        self.carriage.iter().try_for_each(Carriage::check)
    }
}

const PAYLOAD: usize = 0;
const AREA: usize = 1;

impl Spreader {
    fn payload_rate_kg_s(&self, mode: Mode, speed_m_s: f64) -> f64 {
        match mode {
            Mode::Work => -self.dose_kg_per_m2 * self.width_m * speed_m_s.abs(),
            Mode::Fill => self.fill_rate_kg_s,
            Mode::Idle | Mode::Rest | Mode::Empty => 0.0,
        }
    }
}

impl Task for Spreader {
    fn states(&self) -> Vec<State> {
        vec![State { name: "payload_kg", initial: self.initial_kg }, State { name: "area_m2", initial: 0.0 }]
    }

    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load_in(Mode::Work, at, states, rates)
    }

    fn load_in(&self, mode: Mode, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        let m = states[PAYLOAD];
        let mut load = carriage::load(self.carriage.as_ref(), at, m);
        rates[PAYLOAD] = self.payload_rate_kg_s(mode, at.speed_m_s);
        rates[AREA] = 0.0;
        match mode {
            Mode::Work => {
                rates[AREA] = self.width_m * at.speed_m_s.abs();
                load.pto_power_w = self.row.power_w(self.width_m, -rates[PAYLOAD]);
            }
            Mode::Idle => load.pto_power_w = self.row.power_w(self.width_m, 0.0),
            Mode::Rest | Mode::Fill | Mode::Empty => {}
        }
        load
    }

    fn trouble(&self, mode: Mode, at: &Situation, states: &[f64]) -> Option<String> {
        if mode == Mode::Empty {
            return Some("it is emptied by its work alone".to_owned());
        }
        payload::trouble(states[PAYLOAD], self.payload_rate_kg_s(mode, at.speed_m_s), self.capacity_kg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build(text: &str) -> Spreader {
        let mut task: Spreader = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_str(text)
            .unwrap();
        task.settle(Path::new(".")).unwrap();
        task
    }

    const MANURE: &str = "(machine: \"manure spreader\", width_m: 10, dose_kg_per_m2: 2.5, capacity_kg: 16000, \
                          initial_kg: 12000, fill_rate_kg_s: 60)";

    /// 25 t/ha over 10 m at 2 m/s are 50 kg/s, 180 t/h, 0.2 · 180 = 36 kW.
    #[test]
    fn a_manure_spreader_by_hand() {
        let at = Situation { speed_m_s: 2.0, ..Situation::default() };
        let mut rates = [0.0; 2];
        let load = build(MANURE).load(&at, &[12_000.0, 0.0], &mut rates);
        assert!((load.pto_power_w / 36_000.0 - 1.0).abs() < 1e-12);
        assert_eq!((rates, load.mass_kg), ([-50.0, 20.0], 12_000.0));
        build(MANURE).load_in(Mode::Fill, &at, &[0.0, 0.0], &mut rates);
        assert_eq!(rates, [60.0, 0.0]);
    }

    #[test]
    fn an_empty_spreader_cannot_spread_and_a_full_one_cannot_be_filled() {
        let (task, at) = (build(MANURE), Situation { speed_m_s: 2.0, ..Situation::default() });
        assert!(task.trouble(Mode::Work, &at, &[-1.0, 0.0]).unwrap().contains("empty"));
        assert!(task.trouble(Mode::Fill, &at, &[16_001.0, 0.0]).unwrap().contains("full"));
        assert!(task.trouble(Mode::Empty, &at, &[5.0, 0.0]).is_some());
        assert_eq!(task.trouble(Mode::Rest, &at, &[-1.0, 0.0]), None);
    }
}
