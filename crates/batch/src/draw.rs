//! Draws that depend on a seed and on what they are for, and on nothing else: not on order, not on threads.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use std::f64::consts::TAU;

/// The 64-bit hash of Fowler, Noll and Vo (variant 1a) of some bytes, going on from another hash.
pub fn hash(from: u64, bytes: &[u8]) -> u64 {
    /// The prime of the 64-bit variant.
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    bytes.iter().fold(from, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(PRIME))
}

/// Where a hash begins: the offset basis of the 64-bit variant.
pub const BASIS: u64 = 0xcbf2_9ce4_8422_2325;

/// A generator for one purpose: a seed, a name and a number.
pub fn generator(seed: u64, purpose: &str, number: u64) -> ChaCha8Rng {
    let mixed = hash(hash(hash(BASIS, &seed.to_le_bytes()), purpose.as_bytes()), &number.to_le_bytes());
    ChaCha8Rng::seed_from_u64(mixed)
}

/// A number from 0 on, below 1.
pub fn uniform(generator: &mut ChaCha8Rng) -> f64 {
    /// 2⁻⁵³: as many steps as a double resolves below 1.
    const STEP: f64 = 1.0 / 9_007_199_254_740_992.0;
    (generator.next_u64() >> 11) as f64 * STEP
}

/// A number of the standard normal distribution.
///
/// Source: Box and Muller, "A note on the generation of random normal deviates" (1958).
pub fn normal(generator: &mut ChaCha8Rng) -> f64 {
    let (radius, angle) = (1.0 - uniform(generator), uniform(generator));
    (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
}

/// The numbers below `count` in an order drawn at random.
///
/// Source: Fisher and Yates, *Statistical Tables* (1938), in the form of Durstenfeld (1964).
pub fn shuffled(count: u32, generator: &mut ChaCha8Rng) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count).collect();
    for last in (1..order.len()).rev() {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below last + 1")]
        let other = (uniform(generator) * (last + 1) as f64) as usize;
        order.swap(last, other.min(last));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_depend_on_seed_purpose_and_number_and_on_nothing_else() {
        let draw = |seed, purpose, number| generator(seed, purpose, number).next_u64();
        assert_eq!(draw(1, "a", 2), draw(1, "a", 2));
        for other in [draw(2, "a", 2), draw(1, "b", 2), draw(1, "a", 3)] {
            assert_ne!(draw(1, "a", 2), other);
        }
    }

    /// Mean and variance of 20 000 draws lie within five standard errors: 5/√20000 = 0.035, 5·√(2/20000) = 0.05.
    #[test]
    fn normal_draws_have_their_mean_and_variance() {
        let mut generator = generator(7, "test", 0);
        let all: Vec<f64> = (0..20_000).map(|_| normal(&mut generator)).collect();
        let mean = all.iter().sum::<f64>() / 2e4;
        let variance = all.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 2e4;
        assert!(mean.abs() < 0.035 && (variance - 1.0).abs() < 0.05, "{mean} {variance}");
    }

    #[test]
    fn a_shuffled_order_holds_every_number_once() {
        let order = shuffled(1000, &mut generator(3, "order", 0));
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert_eq!(sorted, (0..1000).collect::<Vec<u32>>());
        assert_ne!(order, sorted);
        assert!(shuffled(0, &mut generator(3, "order", 0)).is_empty());
    }

    /// The published value of the hash of the empty text and of "a".
    #[test]
    fn the_hash_has_its_published_values() {
        assert_eq!(hash(BASIS, b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(hash(BASIS, b"a"), 0xaf63_dc4c_8601_ec8c);
    }
}
