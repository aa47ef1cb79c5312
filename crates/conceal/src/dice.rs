//! Numbers drawn at random, the same for the same seed.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::f64::consts::TAU;

/// A seeded source of numbers.
#[derive(Clone, Debug)]
pub struct Dice(ChaCha8Rng);

impl Dice {
    /// One source for each pair of seed and stream.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// A source of its own, so that what is drawn from it moves nothing else.
    #[must_use]
    pub fn fork(&mut self) -> Self {
        let seed = self.0.next_u64();
        Self::new(seed, 0)
    }

    /// Even over 0 to 1, 1 not included.
    pub fn share(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Even over an interval.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// Even over the logarithm of a positive interval.
    pub fn log_within(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.share())
    }

    /// Standard normal: G. E. P. Box and M. E. Muller, *Annals of Mathematical Statistics* 29 (1958) 610.
    pub fn normal(&mut self) -> f64 {
        let (radius, turn) = (1.0 - self.share(), self.share());
        (-2.0 * radius.ln()).sqrt() * (TAU * turn).cos()
    }

    /// Standard normal, drawn again beyond `most` standard deviations.
    pub fn normal_within(&mut self, most: f64) -> f64 {
        loop {
            let value = self.normal();
            if value.abs() <= most {
                return value;
            }
        }
    }

    /// True in this share of the throws.
    pub fn chance(&mut self, share: f64) -> bool {
        self.share() < share
    }

    /// 1 or −1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// A whole number below `end`, which is at least 1.
    pub fn below(&mut self, end: usize) -> usize {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to end, which is small"
        )]
        let index = (self.share() * end as f64) as usize;
        index.min(end.saturating_sub(1))
    }

    /// Shuffles: R. A. Fisher and F. Yates, *Statistical Tables* (1938).
    pub fn shuffle<T>(&mut self, values: &mut [T]) {
        for end in (1..values.len()).rev() {
            values.swap(end, self.below(end + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_and_a_stream_say_it_all() {
        let draw = |seed, stream| Dice::new(seed, stream).share();
        assert_eq!(draw(3, 1), draw(3, 1));
        assert_ne!(draw(3, 1), draw(3, 2));
        assert_ne!(draw(3, 1), draw(4, 1));
    }

    /// Ten thousand draws: mean within 4/√n, variance within 4 √(2/n).
    #[test]
    fn the_normal_has_mean_0_and_variance_1() {
        let mut dice = Dice::new(1, 0);
        let draws: Vec<f64> = (0..10_000).map(|_| dice.normal()).collect();
        let mean = draws.iter().sum::<f64>() / 1e4;
        let variance = draws.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 1e4;
        assert!(mean.abs() < 0.04 && (variance - 1.0).abs() < 0.06, "{mean} {variance}");
    }

    #[test]
    fn a_shuffle_keeps_every_card() {
        let mut cards: Vec<usize> = (0..20).collect();
        Dice::new(7, 0).shuffle(&mut cards);
        assert_ne!(cards, (0..20).collect::<Vec<_>>());
        cards.sort_unstable();
        assert_eq!(cards, (0..20).collect::<Vec<_>>());
    }
}
