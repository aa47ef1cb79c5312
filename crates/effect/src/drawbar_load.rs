//! An implement or trailer that was not recorded.
//!
//! F = φ(t) (D₀ + D₁ |v| + D₂ v² + F(t))        from one time to another; F(t) constant between its edges, 0 outside
//! φ(t) = r((t − t₁)/τ) − r((t − t₂)/τ),  r(x) = min(max(x + ½, 0), 1)        1 between the times and 0 outside where τ is 0
//!
//! Source: draft as a polynomial of speed, ASABE D497 clause 4 (there for each width and depth of an implement).
//! Leaves out slope and inertia of a trailer, which are `mass`, and the weight that an implement transfers; how deep an implement is
//! while it goes down or comes up is a straight line of time.
//! Fingerprint: a force against the motion that steps in and out in time, as when an implement is lowered and lifted.

use crate::series::{check_steps, refuse, step};
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Refusal, Situation, parameter};
use serde::Deserialize;
use std::path::Path;

/// Draft by speed within an interval.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawbarLoad {
    #[serde(default)]
    force_n: f64,
    #[serde(default)]
    linear_n_s_m: f64,
    #[serde(default)]
    quadratic_n_s2_m2: f64,
    #[serde(default = "always_before")]
    from_s: f64,
    #[serde(default = "always_after")]
    to_s: f64,
    #[serde(default)]
    ramp_s: f64,
    #[serde(default)]
    times_s: Vec<f64>,
    #[serde(default)]
    forces_n: Vec<f64>,
}

const fn always_before() -> f64 {
    f64::NEG_INFINITY
}

const fn always_after() -> f64 {
    f64::INFINITY
}

impl Plugin for DrawbarLoad {
    const CARD: Card = Card {
        name: "drawbar_load",
        about: "an implement or trailer that was not recorded",
        equation: "F = D₀ + D₁ |v| + D₂ v² + F(t) from one time to another",
        source: "draft as a polynomial of speed, ASABE D497 clause 4",
        validity: "one depth, width and soil; leaves out slope and inertia of a trailer",
        parameters: &[
            parameter("force_n", "N", "constant part, backward, D₀")
                .must_be(Bound::NotNegative)
                .usually(0.0, 150_000.0)
                .or(0.0),
            parameter("linear_n_s_m", "N s/m", "part in proportion to speed, D₁")
                .usually(-2000.0, 20_000.0)
                .or(0.0),
            parameter("quadratic_n_s2_m2", "N s²/m²", "part in proportion to the square of speed, D₂")
                .usually(-500.0, 10_000.0)
                .or(0.0),
            parameter("from_s", "s", "time since the start of the run at which it begins")
                .usually(0.0, 1e5)
                .or(always_before()),
            parameter("to_s", "s", "time at which it ends").usually(0.0, 1e5).or(always_after()),
            parameter(
                "ramp_s",
                "s",
                "how long it takes to begin, half of it before that time, and to end, τ",
            )
            .must_be(Bound::NotNegative)
            .usually(0.0, 10.0)
            .or(0.0),
            parameter(
                "times_s",
                "[s]",
                "edges of spells since the start of the run, increasing; none where left out, t",
            )
            .usually(0.0, 1e5),
            parameter("forces_n", "[N]", "pull in each spell beside that, one less than edges, F")
                .usually(0.0, 150_000.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        if self.to_s > self.from_s {
            check_steps(("times_s", &self.times_s), ("forces_n", &self.forces_n))
        } else {
            Err(refuse(
                "to_s",
                &self.to_s.to_string(),
                &format!("more than `from_s`, which is {}", self.from_s),
            ))
        }
    }
}

/// Straight from 0 to 1 within so long about nought, or at once.
fn ramp(from_middle_s: f64, ramp_s: f64) -> f64 {
    if ramp_s > 0.0 {
        (from_middle_s / ramp_s + 0.5).clamp(0.0, 1.0)
    } else {
        f64::from(u8::from(from_middle_s >= 0.0))
    }
}

impl Effect for DrawbarLoad {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let v = at.speed_m_s.abs();
        let draft_n = self.force_n
            + v * (self.linear_n_s_m + v * self.quadratic_n_s2_m2)
            + step(&self.times_s, &self.forces_n, at.time_s);
        let pulls = ramp(at.time_s - self.from_s, self.ramp_s) - ramp(at.time_s - self.to_s, self.ramp_s);
        Action { resistance_n: pulls * draft_n, ..Action::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{act, at_10_m_s, build, same};

    /// 500 + 20 · 10 + 3 · 100 = 1000 N.
    #[test]
    fn draft_is_a_polynomial_of_speed() {
        let draft = "(force_n: 500.0, linear_n_s_m: 20.0, quadratic_n_s2_m2: 3.0)";
        assert!(same(act::<DrawbarLoad>(draft, &at_10_m_s()).resistance_n, 1000.0));
    }

    /// The situation is at 50 s.
    #[test]
    fn it_pulls_between_its_times_alone() {
        let pull = |interval: &str| {
            act::<DrawbarLoad>(&format!("(force_n: 500.0, {interval})"), &at_10_m_s()).resistance_n
        };
        assert_eq!((pull("from_s: 40.0"), pull("from_s: 51.0"), pull("to_s: 50.0")), (500.0, 0.0, 0.0));
    }

    /// Half of it at its times, all of it after half a ramp; what is shorter than its ramps pulls as long all the same.
    #[test]
    fn it_takes_its_time_to_begin_and_to_end() {
        let pull = |interval: &str| {
            act::<DrawbarLoad>(&format!("(force_n: 500.0, ramp_s: 4.0, {interval})"), &at_10_m_s())
                .resistance_n
        };
        assert!(same(pull("from_s: 50.0"), 250.0) && same(pull("from_s: 47.0"), 500.0));
        assert!(same(pull("from_s: 51.0"), 125.0) && same(pull("from_s: 30.0, to_s: 49.0"), 125.0));
        assert!(same(pull("from_s: 49.0, to_s: 51.0"), 250.0));
    }

    #[test]
    fn it_pulls_in_spells_beside_what_is_constant() {
        let pull = |spells: &str| act::<DrawbarLoad>(&format!("({spells})"), &at_10_m_s()).resistance_n;
        let spells = "times_s: [20.0, 45.0, 60.0], forces_n: [100.0, 2500.0]";
        assert!(same(pull(spells), 2500.0) && same(pull(&format!("force_n: 500.0, {spells}")), 3000.0));
        assert!(build::<DrawbarLoad>("(times_s: [20.0, 45.0], forces_n: [])").is_err());
    }

    #[test]
    fn an_interval_that_ends_before_it_begins_is_refused() {
        let message = build::<DrawbarLoad>("(force_n: 500.0, from_s: 4.0, to_s: 3.0)").unwrap_err();
        assert!(message.contains("`to_s` is 3, expected more than `from_s`, which is 4"), "{message}");
    }
}
