//! Noise that grows with power or with speed.
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

use crate::balances::rows::Chunk;
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

/// How loud the rows of chunks are, that is their noise over the usual one, where it grows with a size of the rows; and how much more
/// likely that makes their residual than rows that are all alike. `power` tells where an engine is cut off.
pub fn grown(
    chunks: &[Chunk],
    fit: &[bool],
    residual: &[DVector<f64>],
    power: &[DVector<f64>],
    size: &[DVector<f64>],
) -> Option<(f64, Vec<Vec<f64>>)> {
    let mut seconds: Vec<Second> = Vec::new();
    for index in (0..chunks.len()).filter(|index| fit[chunks[*index].run]) {
        let (left, power, size) = (&residual[index], &power[index], &size[index]);
        let last = left.len().saturating_sub(2 * APART);
        seconds.extend((0..last).map(|row| {
            let three = |values: &DVector<f64>| [values[row], values[row + APART], values[row + 2 * APART]];
            let [one, two, last] = three(left);
            let square = |[one, two, last]: [f64; 3]| {
                (one.powi(2) + 4.0 * two.powi(2) + last.powi(2)) / (1.0 + 4.0 + 1.0)
            };
            Second {
                difference: (one - 2.0 * two + last).abs(),
                power: square(three(power)),
                size: square(three(size)),
            }
        }));
    }
    if seconds.len() < LEAST_ROWS {
        return None;
    }
    // An engine that is cut off has no noise at all, and is none that is quiet.
    let whole = seconds.iter().map(|one| one.power).sum::<f64>() / seconds.len() as f64;
    seconds.retain(|one| one.power > CUT_OFF * CUT_OFF * whole);
    let usual = (seconds.iter().map(|one| one.size).sum::<f64>() / seconds.len() as f64).sqrt();
    let wider = |knee: f64| move |square: f64| (1.0 + square / (knee * usual).powi(2)).sqrt();
    let tried = KNEES.into_iter().map(|knee| (knee, likelihood(&seconds, wider(knee))));
    let (knee, best) = tried.max_by(|one, other| one.1.total_cmp(&other.1))?;
    let gain = INDEPENDENT * (best - likelihood(&seconds, |_| 1.0));
    if gain.is_nan() || gain < CLEARLY {
        return None;
    }
    let loud = |size: &DVector<f64>| size.iter().map(|size| wider(knee)(size * size)).collect();
    let mut all: Vec<Vec<f64>> = size.iter().map(loud).collect();
    // By the mean of their squares, so that the noise of all stays what it is in watts.
    let count: usize = all.iter().map(Vec::len).sum();
    let square: f64 = all.iter().flatten().map(|one| one * one).sum();
    let usual = (square / count.max(1) as f64).sqrt();
    for loud in all.iter_mut().flatten() {
        *loud /= usual;
    }
    Some((gain, all))
}

/// A second difference of three rows, and mean squares of them.
struct Second {
    difference: f64,
    power: f64,
    size: f64,
}

/// ln p of differences by Laplace's distribution at the likeliest width, with what makes each wider.
fn likelihood(seconds: &[Second], wider: impl Fn(f64) -> f64) -> f64 {
    let count = seconds.len() as f64;
    let width = seconds.iter().map(|one| one.difference / wider(one.size)).sum::<f64>() / count;
    let widths: f64 = seconds.iter().map(|one| wider(one.size).ln()).sum();
    -count * (2.0 * width).ln() - widths - count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::balances::rows::chunks;
    use headland_calibrate::statistics::Draws;

    /// Rows of one run, whose noise is 100 W and `share` of the power.
    fn told(share: f64) -> Vec<f64> {
        const ROWS: usize = 600;
        let time_s: Vec<f64> = (0..=ROWS * 10).map(|index| 0.1 * index as f64).collect();
        let all = chunks(0, 0, &time_s, &vec![true; time_s.len()], 1.0);
        let mut draws = Draws::new(3, 0);
        let power: Vec<DVector<f64>> = all
            .iter()
            .map(|chunk| DVector::from_fn(chunk.rows.len(), |row, _| 5e4 * (1.0 + (0.07 * row as f64).sin())))
            .collect();
        let residual: Vec<DVector<f64>> =
            power.iter().map(|power| power.map(|power| (100.0 + share * power) * draws.normal())).collect();
        grown(&all, &[true], &residual, &power, &power).map_or_else(Vec::new, |(_, loud)| loud.concat())
    }

    #[test]
    fn noise_that_grows_is_seen_and_noise_that_does_not_is_left_alone() {
        assert!(told(0.0).is_empty());
        let loud = told(0.05);
        let (least, most) =
            loud.iter().fold((f64::INFINITY, 0.0f64), |(least, most), one| (least.min(*one), most.max(*one)));
        assert!(most > 5.0 * least, "{least} to {most}");
        let square = loud.iter().map(|one| one * one).sum::<f64>() / loud.len() as f64;
        assert!((square - 1.0).abs() < 1e-12);
    }
}
