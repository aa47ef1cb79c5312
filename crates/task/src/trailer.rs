//! A trailer: its mass, its wheels, the air, and what it carries.
//!
//! R = c_r (1 − k) (m₀ + m) g cos θ,  dm/dt = +r_f or −r_e while it stands to be filled or emptied
//!
//! Source: definition of the rolling coefficient; the drag equation; usual values from memory.
//! Its brakes are those of the vehicle. It comes along whatever the phase is; unhitch it by leaving it out of the cycle.

use crate::carriage::Carriage;
use crate::payload;
use headland_plugin::{Bound, Card, Load, Mode, Plugin, Refusal, Situation, State, Task, parameter};
use serde::Deserialize;
use std::path::Path;

/// A trailer with a load.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trailer {
    carriage: Carriage,
    capacity_kg: f64,
    initial_kg: f64,
    fill_rate_kg_s: f64,
    empty_rate_kg_s: f64,
    tipping_power_w: f64,
}

impl Plugin for Trailer {
    const CARD: Card = Card {
        name: "Trailer",
        about: "a trailer with its wheels, its drag and a load that is filled and tipped",
        equation: "R = c_r (1 − k)(m₀ + m) g cos θ; F_air = −½ ρ C_d A |v − w| (v − w)ₓ; dm/dt = r_f, −r_e",
        source: "definition of the rolling coefficient; the drag equation; usual values from memory",
        validity: "one rolling coefficient on every ground; brakes are those of the vehicle",
        parameters: &[
            parameter(
                "carriage",
                "(mass_kg, carried_share, rolling_coefficient, drag_area_m2)",
                "its mass without load, the share of both that the vehicle carries, and what its own wheels and the air \
                 take; 0.012 to 0.02 rolling on roads and 6 to 8 m² are usual",
            ),
            parameter("capacity_kg", "kg", "what it holds").must_be(Bound::Positive).usually(500.0, 40_000.0),
            parameter("initial_kg", "kg", "load where a run begins")
                .must_be(Bound::NotNegative)
                .usually(0.0, 40_000.0),
            parameter("fill_rate_kg_s", "kg/s", "how fast it is filled")
                .must_be(Bound::Positive)
                .usually(5.0, 500.0),
            parameter("empty_rate_kg_s", "kg/s", "how fast it is emptied")
                .must_be(Bound::Positive)
                .usually(5.0, 1000.0),
            parameter("tipping_power_w", "W", "hydraulic power while it is emptied")
                .must_be(Bound::NotNegative)
                .usually(0.0, 60_000.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        payload::check_initial(self.initial_kg, self.capacity_kg)?;
        self.carriage.check()
    }
}

impl Trailer {
    fn rate_kg_s(&self, mode: Mode) -> f64 {
        match mode {
            Mode::Fill => self.fill_rate_kg_s,
            Mode::Empty => -self.empty_rate_kg_s,
            Mode::Work | Mode::Idle | Mode::Rest => 0.0,
        }
    }
}

impl Task for Trailer {
    fn states(&self) -> Vec<State> {
        vec![State { name: "payload_kg", initial: self.initial_kg }]
    }

    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load_in(Mode::Work, at, states, rates)
    }

    fn load_in(&self, mode: Mode, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        rates[0] = self.rate_kg_s(mode);
        let hydraulic_power_w = if mode == Mode::Empty { self.tipping_power_w } else { 0.0 };
        Load { hydraulic_power_w, ..self.carriage.load(at, states[0]) }
    }

    fn trouble(&self, mode: Mode, _: &Situation, states: &[f64]) -> Option<String> {
        payload::trouble(states[0], self.rate_kg_s(mode), self.capacity_kg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "(carriage: (mass_kg: 4000, carried_share: 0.1, rolling_coefficient: 0.015, drag_area_m2: 0), \
                        capacity_kg: 14000, initial_kg: 6000, fill_rate_kg_s: 50, empty_rate_kg_s: 200, \
                        tipping_power_w: 15e3)";

    /// 10 t, 9 t of them on its own wheels: 0.015 · 9000 · 10 = 1350 N.
    #[test]
    fn it_comes_along_and_is_filled_and_tipped() {
        let trailer: Trailer = ron::from_str(TEXT).unwrap();
        let at = Situation { gravity_m_s2: 10.0, ..Situation::default() };
        let mut rates = [0.0];
        let load = trailer.load(&at, &[6000.0], &mut rates);
        assert!((load.drawbar_force_n - 1350.0).abs() < 1e-9 && load.mass_kg == 1000.0 && rates == [0.0]);
        assert_eq!(trailer.load_in(Mode::Rest, &at, &[6000.0], &mut rates), load);
        assert_eq!(trailer.load_in(Mode::Empty, &at, &[6000.0], &mut rates).hydraulic_power_w, 15e3);
        assert_eq!(rates, [-200.0]);
        assert!(trailer.trouble(Mode::Fill, &at, &[14_001.0]).is_some());
    }

    #[test]
    fn a_load_above_its_capacity_is_refused() {
        let mut heavy: Trailer =
            ron::from_str(&TEXT.replace("initial_kg: 6000", "initial_kg: 15000")).unwrap();
        assert_eq!(heavy.settle(Path::new(".")).unwrap_err().parameter, "initial_kg");
    }
}
