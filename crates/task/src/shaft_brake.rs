//! A brake at the shaft of the engine, by torque and speed over time.
//!
//! P(t) = T(t) ω(t)        T and ω straight between their points
//!
//! Source: definition; ISO 8178-4 and 40 CFR 1039 test engines so, in steady modes and in ramps between them.
//! Times count from the start of the run. The cycle keeps the engine at the speed; the brake asks for the power alone.

use headland_plugin::{Bound, Card, Load, Mode, Plugin, Refusal, Situation, Task, parameter};
use serde::Deserialize;
use std::path::Path;

/// A brake with a programme.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShaftBrake {
    times_s: Vec<f64>,
    speeds_rad_s: Vec<f64>,
    torques_n_m: Vec<f64>,
}

impl Plugin for ShaftBrake {
    const CARD: Card = Card {
        name: "ShaftBrake",
        about: "a brake at the shaft of the engine, by torque and speed over time",
        equation: "P = T(t) ω(t)",
        source: "definition; ISO 8178-4 and 40 CFR 1039 test engines so",
        validity: "before its first and after its last point these hold; the engine has to be kept at the speed",
        parameters: &[
            parameter(
                "times_s",
                "[s]",
                "points in time since the start of the run, increasing; one point is a steady brake",
            )
            .usually(0.0, 1e5),
            parameter("speeds_rad_s", "[rad/s]", "speed at each point, ω")
                .must_be(Bound::NotNegative)
                .usually(0.0, 700.0),
            parameter("torques_n_m", "[N m]", "torque at each point, T")
                .must_be(Bound::NotNegative)
                .usually(0.0, 5000.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        let refuse = |parameter: &str, found: String, expected: String| Refusal {
            parameter: parameter.to_owned(),
            found,
            expected,
        };
        let points = self.times_s.len();
        if points == 0 {
            return Err(refuse("times_s", "empty".to_owned(), "one point or more".to_owned()));
        }
        for (name, list) in [("speeds_rad_s", &self.speeds_rad_s), ("torques_n_m", &self.torques_n_m)] {
            if list.len() != points {
                let expected = format!("as many as times, {points}");
                return Err(refuse(name, format!("a list of {}", list.len()), expected));
            }
        }
        match self.times_s.windows(2).find(|pair| pair[1] <= pair[0]) {
            Some(pair) => {
                let found = format!("{} after {}", pair[1], pair[0]);
                Err(refuse("times_s", found, "increasing times".to_owned()))
            }
            None => Ok(()),
        }
    }
}

impl Task for ShaftBrake {
    fn load(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        let next = self.times_s.partition_point(|time| *time <= at.time_s);
        let last = self.times_s.len() - 1;
        let (one, two) = (next.saturating_sub(1), next.min(last));
        let share = if one == two {
            0.0
        } else {
            (at.time_s - self.times_s[one]) / (self.times_s[two] - self.times_s[one])
        };
        let between = |list: &[f64]| list[one] + share * (list[two] - list[one]);
        Load { pto_power_w: between(&self.torques_n_m) * between(&self.speeds_rad_s), ..Load::default() }
    }

    fn load_in(&self, mode: Mode, at: &Situation, states: &[f64], rates: &mut [f64]) -> Load {
        if mode == Mode::Work { self.load(at, states, rates) } else { Load::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power_w(text: &str, time_s: f64) -> f64 {
        let mut brake: ShaftBrake = ron::from_str(text).unwrap();
        brake.settle(Path::new(".")).unwrap();
        brake.load(&Situation { time_s, ..Situation::default() }, &[], &mut []).pto_power_w
    }

    /// Half of the way from 100 rad/s and no torque to 200 rad/s and 1000 N m: 150 · 500 W.
    #[test]
    fn speed_and_torque_go_straight_from_mode_to_mode() {
        let ramp = "(times_s: [0, 10, 30], speeds_rad_s: [100, 100, 200], torques_n_m: [0, 0, 1000])";
        for (time_s, expected) in
            [(-1.0, 0.0), (5.0, 0.0), (20.0, 75_000.0), (30.0, 200_000.0), (99.0, 200_000.0)]
        {
            assert_eq!(power_w(ramp, time_s), expected, "{time_s}");
        }
        assert_eq!(power_w("(times_s: [0], speeds_rad_s: [200], torques_n_m: [800])", 7.0), 160_000.0);
    }

    #[test]
    fn lists_that_do_not_fit_are_refused() {
        let refused =
            |text: &str| ron::from_str::<ShaftBrake>(text).unwrap().settle(Path::new(".")).unwrap_err();
        let short = refused("(times_s: [0, 1], speeds_rad_s: [1], torques_n_m: [1, 1])");
        assert_eq!(short.to_string(), "`speeds_rad_s` is a list of 1, expected as many as times, 2");
        assert_eq!(
            refused("(times_s: [0, 0], speeds_rad_s: [1, 1], torques_n_m: [1, 1])").parameter,
            "times_s"
        );
        assert_eq!(refused("(times_s: [], speeds_rad_s: [], torques_n_m: [])").parameter, "times_s");
    }
}
