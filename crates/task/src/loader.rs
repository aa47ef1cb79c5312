//! A front loader: digging, lifting, carrying and dumping.
//!
//! F = F_dig m / M                          while the bucket is pushed into the heap and fills at its rate
//! dh/dt = ±h_max / T towards its end       up while it works, down while it rests
//! P = (m_arm + m) g (dh/dt) / η            while it lifts; lowering takes nothing
//!
//! Source: definition: work of lifting; that the force of digging grows with what is in the bucket is an estimate. A cycle of
//! 25 to 45 s with digging at 60 to 100 % of traction for 3 to 5 s and lifting at 20 to 40 kW is usual, from memory.
//! The heap does not run out. While it idles, is filled or emptied, the bucket keeps its height.

use crate::payload;
use headland_plugin::{Bound, Card, Load, Mode, Plugin, Refusal, Situation, State, Task, parameter};
use serde::Deserialize;
use std::path::Path;

/// A front loader with a bucket.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Loader {
    capacity_kg: f64,
    fill_rate_kg_s: f64,
    empty_rate_kg_s: f64,
    dig_force_n: f64,
    arm_mass_kg: f64,
    height_m: f64,
    lift_time_s: f64,
    efficiency: f64,
}

impl Plugin for Loader {
    const CARD: Card = Card {
        name: "Loader",
        about: "a front loader that digs, lifts, carries and dumps",
        equation: "F = F_dig m / M; P = (m_arm + m) g (dh/dt) / η; dm/dt = r_f, −r_e",
        source: "definition: work of lifting; the growth of the digging force is an estimate",
        validity: "one bucket after the other; leaves out curling and what lowering gives back",
        parameters: &[
            parameter("capacity_kg", "kg", "a full bucket, M")
                .must_be(Bound::Positive)
                .usually(200.0, 8000.0),
            parameter("fill_rate_kg_s", "kg/s", "how fast it fills in the heap, r_f")
                .must_be(Bound::Positive)
                .usually(50.0, 2000.0),
            parameter("empty_rate_kg_s", "kg/s", "how fast it is dumped, r_e")
                .must_be(Bound::Positive)
                .usually(100.0, 4000.0),
            parameter("dig_force_n", "N", "force of the heap on the full bucket, F_dig")
                .must_be(Bound::NotNegative)
                .usually(2e3, 150e3),
            parameter(
                "arm_mass_kg",
                "kg",
                "mass of arms and bucket that is lifted, m_arm; the vehicle's mass holds it",
            )
            .must_be(Bound::NotNegative)
            .usually(200.0, 5000.0),
            parameter("height_m", "m", "how high it lifts, h_max").must_be(Bound::Positive).usually(1.0, 5.0),
            parameter("lift_time_s", "s", "how long that takes, T")
                .must_be(Bound::Positive)
                .usually(2.0, 12.0),
            parameter("efficiency", "1", "pump to lifted mass, η")
                .must_be(Bound::Efficiency)
                .usually(0.4, 0.9),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        Ok(())
    }
}

const PAYLOAD: usize = 0;
const HEIGHT: usize = 1;

/// Within this share of its way the arm slows down.
const SOFT_END: f64 = 0.1;

impl Loader {
    fn rate_kg_s(&self, mode: Mode) -> f64 {
        match mode {
            Mode::Fill => self.fill_rate_kg_s,
            Mode::Empty => -self.empty_rate_kg_s,
            Mode::Work | Mode::Idle | Mode::Rest => 0.0,
        }
    }
}

impl Task for Loader {
    fn states(&self) -> Vec<State> {
        vec![State { name: "payload_kg", initial: 0.0 }, State { name: "height_m", initial: 0.0 }]
    }

    fn load(&self, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        self.load_in(Mode::Work, at, states, rates)
    }

    fn load_in(&self, mode: Mode, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        let (m, h) = (states[PAYLOAD], states[HEIGHT]);
        let target = match mode {
            Mode::Work => Some(self.height_m),
            Mode::Rest => Some(0.0),
            Mode::Idle | Mode::Fill | Mode::Empty => None,
        };
        let most = self.height_m / self.lift_time_s;
        rates[PAYLOAD] = self.rate_kg_s(mode);
        rates[HEIGHT] =
            target.map_or(0.0, |end| ((end - h) / (SOFT_END * self.lift_time_s)).clamp(-most, most));
        let drawbar_force_n = if mode == Mode::Fill { self.dig_force_n * m / self.capacity_kg } else { 0.0 };
        Load {
            drawbar_force_n,
            hydraulic_power_w: (self.arm_mass_kg + m) * at.gravity_m_s2 * rates[HEIGHT].max(0.0)
                / self.efficiency,
            mass_kg: m,
            ..Load::default()
        }
    }

    fn trouble(&self, mode: Mode, _: &Situation, states: &[f64]) -> Option<String> {
        payload::trouble(states[PAYLOAD], self.rate_kg_s(mode), self.capacity_kg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "(capacity_kg: 1500, fill_rate_kg_s: 400, empty_rate_kg_s: 750, dig_force_n: 30e3, \
                        arm_mass_kg: 900, height_m: 3, lift_time_s: 5, efficiency: 0.6)";

    fn load(mode: Mode, states: [f64; 2]) -> (Load, [f64; 2]) {
        let mut rates = [f64::NAN; 2];
        let loader: Loader = ron::from_str(TEXT).unwrap();
        let at = Situation { gravity_m_s2: 10.0, ..Situation::default() };
        (loader.load_in(mode, &at, &states, &mut rates), rates)
    }

    /// (900 + 1500) kg · 10 m/s² · 0.6 m/s / 0.6 = 24 kW; half a bucket is dug against 15 kN.
    #[test]
    fn lifting_and_digging_by_hand() {
        let (lifting, rates) = load(Mode::Work, [1500.0, 1.0]);
        assert!((lifting.hydraulic_power_w - 24_000.0).abs() < 1e-9 && rates == [0.0, 0.6]);
        let (digging, rates) = load(Mode::Fill, [750.0, 0.0]);
        assert_eq!((digging.drawbar_force_n, digging.hydraulic_power_w, rates), (15e3, 0.0, [400.0, 0.0]));
    }

    #[test]
    fn lowering_gives_nothing_back_and_dumping_keeps_the_height() {
        let (lowering, rates) = load(Mode::Rest, [0.0, 3.0]);
        assert_eq!((lowering.hydraulic_power_w, rates[HEIGHT]), (0.0, -0.6));
        let (_, rates) = load(Mode::Empty, [1500.0, 3.0]);
        assert_eq!(rates, [-750.0, 0.0]);
    }

    #[test]
    fn a_bucket_that_runs_over_is_told() {
        let loader: Loader = ron::from_str(TEXT).unwrap();
        assert!(loader.trouble(Mode::Fill, &Situation::default(), &[1500.1, 0.0]).is_some());
        assert!(loader.trouble(Mode::Empty, &Situation::default(), &[-0.1, 0.0]).is_some());
    }
}
