//! A load that fluctuates along the path: a first-order Markov process and a slow trend.
//!
//! L(s) = L₀ (1 + σ x(s) + σ_t y(s))
//! E x(s) x(s + d) = e^(−d / λ),  E y(s) y(s + d) = e^(−d / λ_t),  each nearly normal with variance 1
//!
//! The field is fixed in space: it depends on the seed and on the position and on nothing that was asked before, so that
//! half a step finds the same ground, and a second pass finds it again. Its values at the ends of blocks of 64 λ are
//! drawn from the seed and the number of the block; between them the process is halved over and over, each middle drawn
//! from its distribution between its neighbours (a bridge), down to λ/16. There the autocorrelation is exact; between, the
//! field is straight.
//!
//! Source: Uhlenbeck and Ornstein, *Physical Review* 36 (1930) 823, for the process; ASABE D497 for the spread of drafts
//! about its means. The usual values, 10 to 20 % and 0.3 to 1 m with a trend over 10 to 50 m, are from memory.

use headland_plugin::Refusal;
use serde::Deserialize;
use std::sync::LazyLock;

/// How a load fluctuates, as scenarios write it.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fluctuation {
    sd: f64,
    length_m: f64,
    trend_sd: f64,
    trend_length_m: f64,
    seed: f64,
}

/// A block is this many lengths of correlation; its ends know nothing of each other, e^(−64).
const BLOCK_LENGTHS: f64 = 64.0;

/// A block is halved this often: 1024 pieces of λ/16.
const HALVINGS: usize = 10;

impl Fluctuation {
    /// Checks what it was read as.
    ///
    /// # Errors
    /// [`Refusal`] names the parameter.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let refuse = |name: &str, found: f64, expected: &str| Refusal {
            parameter: format!("fluctuation.{name}"),
            found: found.to_string(),
            expected: expected.to_owned(),
        };
        for (name, value) in [("sd", self.sd), ("trend_sd", self.trend_sd)] {
            if !(0.0..1.0).contains(&value) {
                return Err(refuse(name, value, "0 or more and less than 1"));
            }
        }
        for (name, value) in [("length_m", self.length_m), ("trend_length_m", self.trend_length_m)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(refuse(name, value, "more than 0"));
            }
        }
        if self.seed < 0.0 || self.seed.fract() != 0.0 || self.seed > LARGEST_SEED {
            return Err(refuse("seed", self.seed, "a whole number, 0 or more"));
        }
        Ok(())
    }

    /// By what the load at a position is to be multiplied; 0 or more.
    pub(crate) fn factor(&self, position_m: f64) -> f64 {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "it was checked to be whole and small enough"
        )]
        let seed = self.seed as u64;
        let part = |sd: f64, seed: u64, length_m: f64| {
            if sd == 0.0 { 0.0 } else { sd * markov(seed, position_m / length_m) }
        };
        let fast = part(self.sd, seed, self.length_m);
        let slow = part(self.trend_sd, !seed, self.trend_length_m);
        (1.0 + fast + slow).max(0.0)
    }
}

/// The largest whole number below which a float has no gaps.
const LARGEST_SEED: f64 = 9_007_199_254_740_992.0;

/// Weight of the two neighbours and spread of a middle that is half, a quarter, ... of a block away from them.
static BRIDGES: LazyLock<[(f64, f64); HALVINGS]> = LazyLock::new(|| {
    let mut away = BLOCK_LENGTHS;
    std::array::from_fn(|_| {
        away *= 0.5;
        let rho = (-away).exp();
        (rho / (1.0 + rho * rho), ((1.0 - rho * rho) / (1.0 + rho * rho)).sqrt())
    })
});

/// The process at a distance in lengths of correlation.
fn markov(seed: u64, lengths: f64) -> f64 {
    let along = lengths / BLOCK_LENGTHS;
    let block = along.floor();
    #[allow(clippy::cast_possible_truncation, reason = "no path has so many blocks")]
    let number = block as i64;
    let mut share = along - block;
    let (mut left, mut right) = (normal(seed, number, 0), normal(seed, number.wrapping_add(1), 0));
    // The middles of a block are numbered as in a heap, from 1.
    let mut place = 1;
    for (weight, spread) in &*BRIDGES {
        let middle = weight * (left + right) + spread * normal(seed, number, place);
        share *= 2.0;
        if share < 1.0 {
            right = middle;
            place *= 2;
        } else {
            left = middle;
            share -= 1.0;
            place = 2 * place + 1;
        }
    }
    left + share * (right - left)
}

/// A number of mean 0 and variance 1 that belongs to a seed, a block and a place in it: the sum of eight even ones, which
/// is normal but for its far tails (kurtosis 2.85, none beyond 4.9) and much quicker to draw.
fn normal(seed: u64, block: i64, place: u64) -> f64 {
    /// Every second 16 bits.
    const EVEN: u64 = 0x0000_ffff_0000_ffff;
    /// Mean and spread of the sum of eight whole numbers from 0 to 65 535: 8 · 65 535 / 2, and √(8 (65 536² − 1) / 12).
    const MEAN: f64 = 262_140.0;
    const SPREAD: f64 = 53_509.919_921_45;
    let one = mix(seed ^ mix(block.cast_unsigned() ^ mix(place)));
    let two = mix(one);
    let pairs = (one & EVEN) + ((one >> 16) & EVEN) + (two & EVEN) + ((two >> 16) & EVEN);
    #[allow(clippy::cast_precision_loss, reason = "it is less than 2^20")]
    let sum = ((pairs & 0xffff_ffff) + (pairs >> 32)) as f64;
    (sum - MEAN) / SPREAD
}

/// Mixes bits: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA (2014).
fn mix(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Fluctuation {
        ron::from_str(text).unwrap()
    }

    const ROUGH: &str = "(sd: 0.15, length_m: 0.5, trend_sd: 0.0, trend_length_m: 30, seed: 7)";

    /// Mean, and mean of the product with itself some way ahead, on a grid of the nodes.
    fn moments(field: &Fluctuation, ahead_m: f64, step_m: f64) -> (f64, f64) {
        let samples = 100_000;
        let (mut sum, mut product) = (0.0, 0.0);
        for index in 0..samples {
            let s = f64::from(index) * step_m;
            let value = field.factor(s) - 1.0;
            sum += value;
            product += value * (field.factor(s + ahead_m) - 1.0);
        }
        (sum / f64::from(samples), product / f64::from(samples))
    }

    /// 100 000 samples 0.5 m apart are worth some 80 000 that know nothing of each other: the variance is known to
    /// √(2/80 000) = 0.5 % and the spread to half of that. Four times that is allowed.
    #[test]
    fn its_spread_and_its_length_of_correlation_are_those_that_were_asked_for() {
        let field = of(ROUGH);
        let (mean, variance) = moments(&field, 0.0, 0.5);
        assert!(mean.abs() < 0.004, "{mean}");
        assert!((variance.sqrt() / 0.15 - 1.0).abs() < 0.012, "{}", variance.sqrt());
        for ahead_m in [0.25, 0.5, 1.0] {
            let (_, covariance) = moments(&field, ahead_m, 0.5);
            let expected = (-ahead_m / 0.5_f64).exp();
            assert!((covariance / variance - expected).abs() < 0.02, "{ahead_m}: {}", covariance / variance);
        }
    }

    #[test]
    fn the_numbers_it_is_drawn_from_are_nearly_normal() {
        let draws: Vec<f64> = (0..200_000).map(|place| normal(5, 3, place)).collect();
        let mean_of = |power: i32| draws.iter().map(|x| x.powi(power)).sum::<f64>() / 200_000.0;
        // Spread of the mean, of the variance and of the fourth moment: 0.0022, 0.0032 and 0.022.
        assert!(mean_of(1).abs() < 0.007 && (mean_of(2) - 1.0).abs() < 0.01, "{} {}", mean_of(1), mean_of(2));
        assert!((mean_of(4) - 2.85).abs() < 0.07, "{}", mean_of(4));
    }

    #[test]
    fn the_trend_is_slow_and_adds_its_own_spread() {
        let field = of("(sd: 0.0, length_m: 0.5, trend_sd: 0.1, trend_length_m: 30, seed: 7)");
        let (_, variance) = moments(&field, 0.0, 30.0);
        assert!((variance.sqrt() / 0.1 - 1.0).abs() < 0.012, "{}", variance.sqrt());
        let (_, covariance) = moments(&field, 15.0, 30.0);
        assert!((covariance / variance - (-0.5_f64).exp()).abs() < 0.02);
        let both = of("(sd: 0.15, length_m: 0.5, trend_sd: 0.1, trend_length_m: 30, seed: 7)");
        let (_, sum) = moments(&both, 0.0, 3.7);
        assert!((sum / (0.15_f64.powi(2) + 0.1_f64.powi(2)) - 1.0).abs() < 0.03, "{sum}");
    }

    #[test]
    fn a_place_has_its_value_whatever_was_asked_before_and_another_seed_has_others() {
        let (field, other) = (of(ROUGH), of(&ROUGH.replace("seed: 7", "seed: 8")));
        let there = field.factor(123.456);
        let _ = field.factor(1e5);
        assert_eq!(field.factor(123.456), there);
        assert_ne!(other.factor(123.456), there);
        // It goes on behind its origin, and has no steps: 1 mm is 1/500 of the length of correlation.
        let jump = |s: f64| (field.factor(s + 1e-3) - field.factor(s)).abs();
        let worst = (-40_000..40_000).map(|index| jump(f64::from(index) * 1e-3)).fold(0.0, f64::max);
        assert!(worst < 0.15 * 0.15, "{worst}");
    }

    #[test]
    fn what_cannot_be_is_refused_by_name() {
        let refused =
            |change: (&str, &str)| of(&ROUGH.replace(change.0, change.1)).check().unwrap_err().parameter;
        assert_eq!(refused(("sd: 0.15", "sd: -0.1")), "fluctuation.sd");
        assert_eq!(refused(("length_m: 0.5", "length_m: 0")), "fluctuation.length_m");
        assert_eq!(refused(("seed: 7", "seed: 1.5")), "fluctuation.seed");
        assert!(of(ROUGH).check().is_ok());
    }
}
