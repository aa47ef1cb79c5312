//! What the best of all terms reaches where there is nothing to find.
//!
//! Residuals of noise go through the same screening: white, or as persistent from row to row as what the law with that term leaves,
//! where the caller's whitening was not perfect. Statistic: n g / (S − g), with g the growth of the explained
//! sum of squares and S what was left; the scale of the noise cancels. The best of many follows Gumbel's law
//! p = 1 − exp(−exp(−(z − μ)/β)), whose μ and β come from the mean and the standard deviation of the draws.
//! Source: Gumbel, *Statistics of Extremes* (1958); the test of the largest step is that of forward selection with the
//! null of the maximum, Buja and Brown, *Ann. Statist.* 42 (2014), discussion.

use crate::problem::Bench;
use crate::screen::Screen;
use crate::vector::dot;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::f64::consts::{PI, TAU};

/// How the terms of a law compare with the best of chance.
#[derive(Clone, Debug)]
pub struct Chance {
    /// Statistics of the best term in white noise, in ascending order.
    pub draws: Vec<f64>,
    /// Statistic of the best first, second, ... term, each beside the best law of the terms before it.
    pub steps: Vec<f64>,
    /// How probable it is that chance alone makes such a step or a larger one.
    pub p_values: Vec<f64>,
    /// Correlation of neighbouring rows in the draws that each step was held against: 0 where what the best law with that
    /// step leaves is white.
    pub persistence: Vec<f64>,
    /// How many terms, from the first on, are all less probable than the significance that was asked for.
    pub terms: usize,
}

/// Gumbel's law of the best of many.
#[derive(Clone, Debug)]
pub(crate) struct Null {
    pub draws: Vec<f64>,
    location: f64,
    scale: f64,
}

/// Euler's constant, the mean of the standard Gumbel law.
const EULER: f64 = 0.577_215_664_901_532_9;

impl Null {
    /// The best of all terms for so many residuals of noise.
    pub fn new(bench: &Bench, screen: &Screen, draws: usize, seed: u64, persistence: f64) -> Self {
        let residuals: Vec<Vec<f64>> = (0..draws as u64)
            .map(|stream| {
                let mut rows = white(bench.rows, seed, stream);
                persist(bench, &mut rows, persistence);
                screen.thin(bench, &bench.project(&rows))
            })
            .collect();
        let best = screen.best_gains(&residuals);
        let mut draws: Vec<f64> = best
            .iter()
            .zip(&residuals)
            .map(|(gain, left)| statistic(*gain, dot(left, left), left.len()))
            .collect();
        draws.sort_by(f64::total_cmp);
        let count = draws.len().max(1) as f64;
        let mean = draws.iter().sum::<f64>() / count;
        let variance = draws.iter().map(|draw| (draw - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        let scale = (6.0 * variance).sqrt() / PI;
        Self { draws, location: mean - EULER * scale, scale }
    }

    /// How probable a statistic at least as large is.
    pub fn p_value(&self, statistic: f64) -> f64 {
        let standard = (statistic - self.location) / self.scale.max(f64::MIN_POSITIVE);
        -(-(-standard).exp()).exp_m1()
    }
}

/// Growth of the explained sum of squares in units of the noise that is left beside it.
pub(crate) fn statistic(gain: f64, cost: f64, rows: usize) -> f64 {
    rows as f64 * gain / (cost - gain).max(f64::MIN_POSITIVE)
}

/// Makes white rows persistent, each run from its own start: a first-order autoregressive process of variance 1.
fn persist(bench: &Bench, rows: &mut [f64], persistence: f64) {
    let fresh = (1.0 - persistence * persistence).sqrt();
    let mut begin = 0;
    for (_, count) in &bench.fitted {
        for at in begin + 1..begin + count {
            rows[at] = persistence * rows[at - 1] + fresh * rows[at];
        }
        begin += count;
    }
}

/// Correlation of neighbouring rows of the first-order process that is as strong at low frequency as these rows,
/// (1 + φ)/(1 − φ) = 1 + 2 Σ ρ, summed as long as ρ is more than white rows have by chance; 0 where none is.
pub(crate) fn persistence(bench: &Bench, rows: &[f64]) -> f64 {
    /// Standard deviations of ρ, which is 1/√n for white rows (Bartlett, *J. R. Stat. Soc.* Suppl. 8, 1946).
    const SURE: f64 = 2.0;
    /// Beyond it draws are no noise any more.
    const MOST: f64 = 0.95;
    /// Lags that are looked at.
    const LAGS: usize = 30;
    let own = dot(&rows[..bench.rows], &rows[..bench.rows]).max(f64::MIN_POSITIVE);
    let correlation = |lag: usize| {
        let (mut sum, mut begin) = (0.0, 0);
        for (_, count) in &bench.fitted {
            let run = &rows[begin..begin + count];
            sum += dot(&run[..count.saturating_sub(lag)], &run[lag.min(*count)..]);
            begin += count;
        }
        sum / own
    };
    let sure = SURE / (bench.rows as f64).sqrt();
    let first = correlation(1);
    if first < -sure {
        return first.max(-MOST);
    }
    let sum: f64 = (1..=LAGS).map(correlation).take_while(|one| *one > sure).sum();
    (sum / (1.0 + sum)).min(MOST)
}

/// Standard normal numbers, by the method of Box and Muller (*Ann. Math. Statist.* 29, 1958).
fn white(count: usize, seed: u64, stream: u64) -> Vec<f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream);
    let mut uniform = || ((generator.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64;
    let normal = |_| (-2.0 * uniform().ln()).sqrt() * (TAU * uniform()).cos();
    (0..count).map(normal).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_standard_normal_and_repeat() {
        let draws = white(20_000, 1, 0);
        let mean = draws.iter().sum::<f64>() / 2e4;
        let variance = draws.iter().map(|draw| (draw - mean).powi(2)).sum::<f64>() / 2e4;
        assert!(mean.abs() < 0.03 && (variance - 1.0).abs() < 0.05, "{mean} {variance}");
        assert_eq!(draws[7].to_bits(), white(8, 1, 0)[7].to_bits());
        assert_ne!(draws[7].to_bits(), white(8, 1, 1)[7].to_bits());
    }

    /// By hand: at the location p = 1 − 1/e, far above it the tail is exponential.
    #[test]
    fn probabilities_are_those_of_gumbel() {
        let null = Null { draws: Vec::new(), location: 10.0, scale: 2.0 };
        assert!((null.p_value(10.0) - (1.0 - (-1f64).exp())).abs() < 1e-12);
        assert!((null.p_value(50.0) / (-20f64).exp() - 1.0).abs() < 1e-6);
    }
}
