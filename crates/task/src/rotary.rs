//! A machine driven by the power take-off.
//!
//! P = a + b W + c F,  F = 3.6 q W v        P [kW], W [m], F [t/h], q crop or material per area [kg/m²]
//!
//! Source: ASABE D497, *Agricultural Machinery Management Data*, clause 5 and table 2; the table is from memory, each row
//! a default to be overridden by what was measured.
//! The standard's own spread is ±25 to ±50 %. A machine that idles takes a + b W. Leaves out starting and what blocks.

use crate::carriage::{self, Carriage};
use crate::power_table::{RotaryPower, choose};
use headland_plugin::{
    Bound, Card, Implement, Load, Mode, Plugin, Refusal, Situation, State, Task, parameter,
};
use serde::Deserialize;
use std::path::Path;

/// A mower, a tedder, a rake, a harrow.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rotary {
    #[serde(default)]
    machine: Option<String>,
    #[serde(default)]
    power: Option<RotaryPower>,
    width_m: f64,
    #[serde(default)]
    crop_kg_per_m2: f64,
    #[serde(default)]
    carriage: Option<Carriage>,
    #[serde(skip)]
    row: RotaryPower,
}

impl Default for RotaryPower {
    fn default() -> Self {
        Self { a: 0.0, b: 0.0, c: 0.0 }
    }
}

impl Plugin for Rotary {
    const CARD: Card = Card {
        name: "Rotary",
        about: "power of a machine at the power take-off by its width and by what flows through it",
        equation: "P = a + b W + c F; P kW, W m, F = 3.6 q W v in t/h",
        source: "ASABE D497, Agricultural Machinery Management Data, clause 5; its table 2 from memory",
        validity: "within the standard's ±25 to ±50 %; leaves out starting",
        parameters: &[
            parameter(
                "machine",
                "name",
                "by name; a wrong one is answered with all that are known; or `power`",
            ),
            parameter("power", "(a, b, c)", "coefficients of your own in kW, kW/m and kW h/t; or `machine`"),
            parameter("width_m", "m", "working width, W").must_be(Bound::Positive).usually(1.0, 24.0),
            parameter(
                "crop_kg_per_m2",
                "kg/m²",
                "what flows through it for each area worked, q; 1 kg/m² is 10 t/ha",
            )
            .must_be(Bound::NotNegative)
            .usually(0.0, 10.0)
            .or(0.0),
            parameter(
                "carriage",
                "(mass_kg, carried_share, rolling_coefficient, drag_area_m2)",
                "its mass, the share of it that the vehicle carries, and what its own wheels and the air take; left \
                 out: it weighs nothing",
            ),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.row = choose(self.machine.as_deref(), self.power)?;
        self.carriage.iter().try_for_each(Carriage::check)
    }
}

impl Task for Rotary {
    fn states(&self) -> Vec<State> {
        vec![State { name: "area_m2", initial: 0.0 }]
    }

    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load_in(Mode::Work, at, states, rates)
    }

    fn load_in(&self, mode: Mode, at: &Situation, _: &[f64], rates: &mut [f64]) -> Load {
        let mut load = self.carriage.map_or_else(Load::default, |carriage| carriage.load(at, 0.0));
        rates[0] = if mode == Mode::Work { self.width_m * at.speed_m_s.abs() } else { 0.0 };
        if matches!(mode, Mode::Work | Mode::Idle) {
            load.pto_power_w = self.row.power_w(self.width_m, self.crop_kg_per_m2 * rates[0]);
        }
        load
    }

    fn implement(&self) -> Option<Implement> {
        carriage::mounted(self.carriage.as_ref(), self.width_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build(text: &str) -> Rotary {
        let mut task: Rotary = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_str(text)
            .unwrap();
        task.settle(Path::new(".")).unwrap();
        task
    }

    /// 9 m of mower-conditioner: 8 · 9 = 72 kW, at work and idling alike; none at rest.
    #[test]
    fn a_mower_takes_its_power_as_long_as_it_turns() {
        let mower = build("(machine: \"mower-conditioner, disk\", width_m: 9)");
        let at = Situation { speed_m_s: 4.0, ..Situation::default() };
        let power = |mode, rates: &mut [f64]| mower.load_in(mode, &at, &[0.0], rates).pto_power_w;
        let mut rates = [0.0];
        assert_eq!((power(Mode::Work, &mut rates), rates[0]), (72_000.0, 36.0));
        assert_eq!((power(Mode::Idle, &mut rates), rates[0]), (72_000.0, 0.0));
        assert_eq!(power(Mode::Rest, &mut rates), 0.0);
    }

    #[test]
    fn a_machine_hangs_on_the_hitch_unless_it_rolls_on_wheels_of_its_own() {
        let mower = "(machine: \"mower-conditioner, disk\", width_m: 9";
        let carried = |share: f64| {
            let carriage =
                format!("(mass_kg: 900, carried_share: {share}, rolling_coefficient: 0.05, drag_area_m2: 0)");
            build(&format!("{mower}, carriage: {carriage})")).implement()
        };
        let hangs = Some(Implement { width_m: 9.0, depth_m: None, tools: None, lift_m: None });
        assert_eq!(
            (build(&format!("{mower})")).implement(), carried(1.0), carried(0.3)),
            (hangs, hangs, None)
        );
    }

    /// 2 kg/m² · 6 m · 2.5 m/s = 30 kg/s = 108 t/h: 10 + 0.5 · 6 + 0.25 · 108 = 40 kW.
    #[test]
    fn power_grows_with_what_flows_through() {
        let own = build("(power: (a: 10, b: 0.5, c: 0.25), width_m: 6, crop_kg_per_m2: 2)");
        let at = Situation { speed_m_s: 2.5, ..Situation::default() };
        let load = own.load(&at, &[0.0], &mut [0.0]);
        assert!((load.pto_power_w / 40_000.0 - 1.0).abs() < 1e-12);
    }
}
