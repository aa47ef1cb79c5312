//! A machine that gathers a crop, carries it and is emptied.
//!
//! q̇ = q W v                      flow of crop [kg/s]
//! dm/dt = κ q̇                    payload while it works; −r while it is emptied
//! P = a + b W + c F g(m)         F = 3.6 q̇ [t/h]; g = 1, or ½ + 3/2 (m/M)² where a bale grows in a chamber
//! D = κ q̇ v                      what brings the standing crop up to speed
//!
//! Source: ASABE D497, *Agricultural Machinery Management Data*, clause 5 and table 2 (from memory), for the power;
//! Newton's second law for the crop. That the power of a round baler rises with the square of the bale is an estimate;
//! g has the mean 1 over a bale, so that the table holds for the whole of it.
//! It is filled by its work alone. A bale is let go by emptying.

use crate::carriage::{self, Carriage};
use crate::payload;
use crate::power_table::{RotaryPower, choose};
use headland_plugin::{
    Bound, Card, Implement, Load, Mode, Plugin, Refusal, Situation, State, Task, parameter,
};
use serde::Deserialize;
use std::path::Path;

/// A harvester with its tank, a baler with its chamber, a self-loading wagon.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Harvester {
    #[serde(default)]
    machine: Option<String>,
    #[serde(default)]
    power: Option<RotaryPower>,
    width_m: f64,
    crop_kg_per_m2: f64,
    kept_share: f64,
    capacity_kg: f64,
    #[serde(default)]
    initial_kg: f64,
    empty_rate_kg_s: f64,
    empty_power_w: f64,
    #[serde(default)]
    bale: bool,
    #[serde(default)]
    carriage: Option<Carriage>,
    #[serde(skip)]
    row: RotaryPower,
}

impl Plugin for Harvester {
    const CARD: Card = Card {
        name: "Harvester",
        about: "a machine that gathers a crop and carries it until it is emptied: harvester, baler, loading wagon",
        equation: "dm/dt = κ q W v; P = a + b W + c 3.6 q W v g(m), g = 1 or ½ + 3/2 (m/M)²; D = κ q W v²",
        source: "ASABE D497, Agricultural Machinery Management Data, clause 5, its table 2 from memory; Newton's second \
                 law for the crop; the growth of a bale is an estimate",
        validity: "an even crop; leaves out starting, blocking and losses",
        parameters: &[
            parameter(
                "machine",
                "name",
                "by name; a wrong one is answered with all that are known; or `power`",
            ),
            parameter("power", "(a, b, c)", "coefficients of your own in kW, kW/m and kW h/t; or `machine`"),
            parameter("width_m", "m", "width of the crop that is taken in, W")
                .must_be(Bound::Positive)
                .usually(1.0, 18.0),
            parameter(
                "crop_kg_per_m2",
                "kg/m²",
                "crop that is taken in for each area, q; 1 kg/m² is 10 t/ha",
            )
            .must_be(Bound::NotNegative)
            .usually(0.1, 10.0),
            parameter("kept_share", "1", "share of it that stays aboard, κ")
                .must_be(Bound::Within(0.0, 1.0))
                .usually(0.0, 1.0),
            parameter("capacity_kg", "kg", "what the tank, the chamber or the body holds, M")
                .must_be(Bound::Positive)
                .usually(100.0, 40_000.0),
            parameter("initial_kg", "kg", "payload where a run begins")
                .must_be(Bound::NotNegative)
                .usually(0.0, 40_000.0)
                .or(0.0),
            parameter("empty_rate_kg_s", "kg/s", "how fast it is emptied, r")
                .must_be(Bound::Positive)
                .usually(5.0, 500.0),
            parameter("empty_power_w", "W", "power at the shaft that emptying takes")
                .must_be(Bound::NotNegative)
                .usually(0.0, 80_000.0),
            parameter(
                "bale",
                "true or false",
                "whether the power grows with a bale in its chamber; left out: false",
            ),
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
const GATHERED: usize = 2;

impl Harvester {
    fn payload_rate_kg_s(&self, mode: Mode, speed_m_s: f64) -> f64 {
        match mode {
            Mode::Work => self.kept_share * self.crop_kg_per_m2 * self.width_m * speed_m_s.abs(),
            Mode::Empty => -self.empty_rate_kg_s,
            Mode::Idle | Mode::Rest | Mode::Fill => 0.0,
        }
    }
}

impl Task for Harvester {
    fn states(&self) -> Vec<State> {
        vec![
            State { name: "payload_kg", initial: self.initial_kg },
            State { name: "area_m2", initial: 0.0 },
            State { name: "gathered_kg", initial: 0.0 },
        ]
    }

    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load_in(Mode::Work, at, states, rates)
    }

    fn load_in(&self, mode: Mode, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        let m = states[PAYLOAD];
        let mut load = carriage::load(self.carriage.as_ref(), at, m);
        let v = at.speed_m_s.abs();
        rates.fill(0.0);
        rates[PAYLOAD] = self.payload_rate_kg_s(mode, v);
        match mode {
            Mode::Work => {
                rates[AREA] = self.width_m * v;
                rates[GATHERED] = self.crop_kg_per_m2 * rates[AREA];
                let fullness = m / self.capacity_kg;
                let growth = if self.bale { 0.5 + 1.5 * fullness * fullness } else { 1.0 };
                load.pto_power_w = self.row.power_w(self.width_m, growth * rates[GATHERED]);
                load.drawbar_force_n += rates[PAYLOAD] * v;
            }
            Mode::Empty => load.pto_power_w = self.row.power_w(self.width_m, 0.0) + self.empty_power_w,
            Mode::Idle => load.pto_power_w = self.row.power_w(self.width_m, 0.0),
            Mode::Rest | Mode::Fill => {}
        }
        load
    }

    fn implement(&self) -> Option<Implement> {
        carriage::mounted(self.carriage.as_ref(), self.width_m)
    }

    fn trouble(&self, mode: Mode, at: &Situation, states: &[f64]) -> Option<String> {
        if mode == Mode::Fill {
            return Some("it is filled by its work alone".to_owned());
        }
        payload::trouble(states[PAYLOAD], self.payload_rate_kg_s(mode, at.speed_m_s), self.capacity_kg)
    }
}

#[cfg(test)]
#[path = "harvester_tests.rs"]
mod tests;
