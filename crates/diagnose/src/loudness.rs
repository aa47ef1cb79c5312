//! Noise that grows with power.
//!
//! What a line between fuel and work leaves of a real engine is a share of its power rather than so many watts: at full load it
//! is many times what it is at idle. Where rows show that, each is measured by its own noise; a few rows of high power would
//! otherwise outweigh all others, and what idling tells, as of an engine that is cold, would drown.
//!
//! Whether they show it is asked of second differences between rows, in which nothing that lasts is left, by how likely they are
//! with Laplace's distribution, whose width a few large ones do not make.
//!
//! Source: variance functions, Carroll and Ruppert, *Transformation and Weighting in Regression* (1988), section 2.2; Willans lines
//! and what they leave: Guzzella and Onder, *Introduction to Modeling and Control of Internal Combustion Engine Systems* (2010),
//! section 2.5.

use crate::rows::Chunk;
use nalgebra::DVector;

/// Rows that share no block lie so far apart.
const APART: usize = 2;
/// Powers at which the noise has grown by √2 that are tried, as shares of the usual power.
const KNEES: [f64; 4] = [0.2, 0.4, 0.8, 1.6];
/// Growth of ln p for each second difference that is independent of others, of which every third is: one of many models that no
/// chance should make.
const CLEARLY: f64 = 20.0;
const INDEPENDENT: f64 = 1.0 / 3.0;
/// Less than this share of the usual power is that of an engine that idles or is cut off.
const CUT_OFF: f64 = 0.1;
/// Fewer rows tell nothing of how noise grows.
const LEAST_ROWS: usize = 100;

/// Sets how loud each row of these chunks is, with the residual and the modelled power of their rows, where they are not all
/// alike.
pub fn set(chunks: &mut [Chunk], fit: &[bool], residual: &[DVector<f64>], power: &[DVector<f64>]) {
    let fitted = |chunk: &Chunk| fit[chunk.run];
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for ((chunk, left), power) in chunks.iter().zip(residual).zip(power) {
        if fitted(chunk) {
            let last = left.len().saturating_sub(2 * APART);
            pairs.extend((0..last).map(|row| {
                let second = left[row] - 2.0 * left[row + APART] + left[row + 2 * APART];
                let powers = [power[row], power[row + APART], power[row + 2 * APART]];
                let square = (powers[0].powi(2) + 4.0 * powers[1].powi(2) + powers[2].powi(2)) / 6.0;
                (second.abs(), square)
            }));
        }
    }
    if pairs.len() < LEAST_ROWS {
        return;
    }
    let whole_w = (pairs.iter().map(|(_, square)| square).sum::<f64>() / pairs.len() as f64).sqrt();
    // An engine that is cut off has no noise at all, and is none that is quiet.
    pairs.retain(|(_, square)| square.sqrt() > CUT_OFF * whole_w);
    let usual_w = (pairs.iter().map(|(_, square)| square).sum::<f64>() / pairs.len() as f64).sqrt();
    let grown =
        |knee: f64| (knee, likelihood(&pairs, |square| (1.0 + square / (knee * usual_w).powi(2)).sqrt()));
    let alike = likelihood(&pairs, |_| 1.0);
    let best = KNEES.into_iter().map(grown).max_by(|one, other| one.1.total_cmp(&other.1));
    let Some((knee, grown)) = best else { return };
    if INDEPENDENT * (grown - alike) < CLEARLY {
        return;
    }
    for (chunk, power) in chunks.iter_mut().zip(power) {
        let loud = |power: &f64| (1.0 + (power / (knee * usual_w)).powi(2)).sqrt();
        chunk.loudness = power.iter().map(loud).collect();
    }
    let count: usize = chunks.iter().map(|chunk| chunk.loudness.len()).sum();
    // By the mean of their squares, so that the noise of all stays what it is in watts.
    let square: f64 = chunks.iter().flat_map(|chunk| &chunk.loudness).map(|one| one * one).sum();
    let usual = (square / count.max(1) as f64).sqrt();
    for loud in chunks.iter_mut().flat_map(|chunk| &mut chunk.loudness) {
        *loud /= usual;
    }
}

/// ln p of sizes by Laplace's distribution at the likeliest width, with what makes each wider.
fn likelihood(pairs: &[(f64, f64)], wider: impl Fn(f64) -> f64) -> f64 {
    let count = pairs.len() as f64;
    let width = pairs.iter().map(|(size, square)| size / wider(*square)).sum::<f64>() / count;
    let widths: f64 = pairs.iter().map(|(_, square)| wider(*square).ln()).sum();
    -count * (2.0 * width).ln() - widths - count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::chunks;
    use headland_calibrate::statistics::Draws;

    /// Rows of one run, whose noise is 100 W and `share` of the power.
    fn told(share: f64) -> Vec<f64> {
        const ROWS: usize = 600;
        let time_s: Vec<f64> = (0..=ROWS * 10).map(|index| 0.1 * index as f64).collect();
        let mut all = chunks(0, 0, &time_s, &vec![true; time_s.len()], 1.0);
        let mut draws = Draws::new(3, 0);
        let power: Vec<DVector<f64>> = all
            .iter()
            .map(|chunk| DVector::from_fn(chunk.rows.len(), |row, _| 5e4 * (1.0 + (0.07 * row as f64).sin())))
            .collect();
        let residual: Vec<DVector<f64>> =
            power.iter().map(|power| power.map(|power| (100.0 + share * power) * draws.normal())).collect();
        set(&mut all, &[true], &residual, &power);
        all.iter().flat_map(|chunk| chunk.loudness.clone()).collect()
    }

    #[test]
    fn noise_that_grows_is_seen_and_noise_that_does_not_is_left_alone() {
        assert!(told(0.0).is_empty());
        let loud = told(0.05);
        let (least, most) =
            loud.iter().fold((f64::INFINITY, 0.0f64), |(least, most), one| (least.min(*one), most.max(*one)));
        assert!(most > 8.0 * least, "{least} to {most}");
        let square = loud.iter().map(|one| one * one).sum::<f64>() / loud.len() as f64;
        assert!((square - 1.0).abs() < 1e-12);
    }
}
