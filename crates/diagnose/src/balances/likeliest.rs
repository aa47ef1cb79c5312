//! The noise that makes residuals most likely: its shares and correlations are tried on a grid, and then closer.
//!
//! Each row of a whitener waits for the row before it, so that one noise after the other would leave most of a processor idle:
//! several are tried side by side.

use crate::balances::noise::{Noise, Shape, Whitener};
use nalgebra::DVector;

/// Shares of the process in the variance that are tried.
const SHARES: [f64; 8] = [0.0, 0.03, 0.1, 0.25, 0.5, 0.75, 0.93, 1.0];
/// Correlations of the process that are tried.
const PERSISTENCES: [f64; 6] = [0.0, 0.4, 0.7, 0.88, 0.96, 0.99];
/// A share or correlation is refined between those that were tried, so many times halving the way.
const REFINEMENTS: usize = 3;
/// So many noises are tried side by side.
const LANES: usize = 8;

/// Share of the process in the variance, and its correlation between neighbouring rows.
type Place = (f64, f64);

/// Residuals, one vector a chunk, whose rows count as much as their weights say, or all alike.
#[derive(Clone, Copy)]
pub struct Weighted<'a> {
    pub residuals: &'a [&'a DVector<f64>],
    pub weights: &'a [Option<&'a DVector<f64>>],
}

/// The noise that makes residuals most likely, of any of these shapes; the process correlates neighbouring rows by `most` at most,
/// and lasts with the variance that is `usual`, where any is.
pub fn likeliest(shapes: &[Shape], most: f64, usual: Option<f64>, rows: Weighted) -> Noise {
    let of = |shape: &Shape| of_shape(*shape, most, usual, rows);
    let best = shapes.iter().map(of).min_by(|one, other| one.0.total_cmp(&other.0));
    best.map_or(Noise { shape: Shape::Averaged, sensor: 1.0, process: 0.0, persistence: 0.0 }, |best| best.1)
}

/// The same of one shape, and its deviance.
fn of_shape(shape: Shape, most: f64, usual: Option<f64>, rows: Weighted) -> (f64, Noise) {
    let nothing = Noise { shape, sensor: 1.0, process: 0.0, persistence: 0.0 };
    let mut best = (f64::INFINITY, nothing, (0.0, 0.0));
    let mut consider = |places: &[Place]| {
        for (place, tried) in places.iter().zip(rows.tried(shape, places)) {
            let Some((deviance, noise)) = tried else { continue };
            let deviance = deviance - 2.0 * noise.prior(usual);
            if deviance < best.0 {
                best = (deviance, noise, *place);
            }
        }
        best.2
    };
    let grid = |share: f64| {
        let able = move |persistence: &f64| share > 0.0 || *persistence == 0.0;
        let persistences = PERSISTENCES.into_iter().map(|one| one.min(most));
        persistences.filter(able).map(move |persistence| (share, persistence))
    };
    let mut place = consider(&SHARES.into_iter().flat_map(grid).collect::<Vec<Place>>());
    // Half way to the neighbours, then a quarter of the way, …
    let near = |grid: &[f64], value: f64| {
        let above = grid.iter().copied().find(|one| *one > value).unwrap_or(value);
        let below = grid.iter().rev().copied().find(|one| *one < value).unwrap_or(value);
        [below - value, 0.0, above - value]
    };
    let mut ways = (near(&SHARES, place.0), near(&PERSISTENCES, place.1));
    for _ in 0..REFINEMENTS {
        ways = (ways.0.map(|way| 0.5 * way), ways.1.map(|way| 0.5 * way));
        let around = ways
            .0
            .iter()
            .flat_map(|share| ways.1.iter().map(move |persistence| (place.0 + share, place.1 + persistence)));
        let able = |(share, persistence): &Place| *share > 0.0 && *persistence <= most;
        place = consider(&around.filter(able).collect::<Vec<Place>>());
    }
    (best.0, best.1)
}

impl Weighted<'_> {
    /// Deviance at each place, and the noise of the variance that suits best there; none where it cannot be.
    fn tried(self, shape: Shape, places: &[Place]) -> Vec<Option<(f64, Noise)>> {
        places.chunks(LANES).flat_map(|places| self.side_by_side(shape, places)).collect()
    }

    /// The same of so many places at most as there are lanes.
    fn side_by_side(self, shape: Shape, places: &[Place]) -> Vec<Option<(f64, Noise)>> {
        let longest = self.residuals.iter().map(|one| one.len()).max().unwrap_or(0);
        let unit = |(share, persistence): &Place| Noise {
            shape,
            sensor: 1.0 - share,
            process: *share,
            persistence: *persistence,
        };
        let units: Vec<Noise> = places.iter().map(unit).collect();
        let whiteners: Vec<Option<Whitener>> = units.iter().map(|one| one.whitener(longest)).collect();
        let sums = self.norms_squared(&whiteners);
        let count: usize = self.residuals.iter().map(|one| one.len()).sum();
        let of = |((unit, whitener), sum): ((&Noise, &Option<Whitener>), f64)| {
            let whitener = whitener.as_ref().filter(|_| count > 0)?;
            let log_determinant: f64 =
                self.residuals.iter().map(|one| whitener.log_determinant(one.len())).sum();
            let variance = (sum / count as f64).max(f64::MIN_POSITIVE);
            let deviance = count as f64 * variance.ln() + log_determinant;
            let noise = Noise { sensor: variance * unit.sensor, process: variance * unit.process, ..*unit };
            deviance.is_finite().then_some((deviance, noise))
        };
        units.iter().zip(&whiteners).zip(sums).map(of).collect()
    }

    /// Sum of the squares of the rows as each whitener leaves them; nought where there is none.
    fn norms_squared(self, whiteners: &[Option<Whitener>]) -> [f64; LANES] {
        let rows = whiteners.iter().flatten().map(|one| one.factor.len()).max().unwrap_or(0);
        let mut persistence = [0.0; LANES];
        // Two to the left, one to the left, and one over its own.
        let mut factors = vec![[[0.0; LANES]; 3]; rows];
        for (lane, whitener) in whiteners.iter().enumerate() {
            let Some(whitener) = whitener else { continue };
            persistence[lane] = whitener.persistence;
            for (row, factor) in factors.iter_mut().enumerate() {
                let [left2, left1, own] = whitener.row(row);
                (factor[0][lane], factor[1][lane], factor[2][lane]) = (left2, left1, 1.0 / own);
            }
        }
        let mut sums = [0.0; LANES];
        for (residual, weights) in self.residuals.iter().zip(self.weights) {
            let (mut before, mut one, mut two) = (0.0, [0.0; LANES], [0.0; LANES]);
            for (row, value) in residual.iter().enumerate() {
                let [left2, left1, inverse] = &factors[row.min(rows - 1)];
                let weight = weights.map_or(1.0, |weights| weights[row]);
                for lane in 0..LANES {
                    let taken =
                        persistence[lane] * before + left1[lane] * one[lane] + left2[lane] * two[lane];
                    let white = (value - taken) * inverse[lane];
                    sums[lane] += weight * white * white;
                    (two[lane], one[lane]) = (one[lane], white);
                }
                before = *value;
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_calibrate::statistics::Draws;

    fn made(noise: Noise, chunks: usize, rows: usize) -> Vec<DVector<f64>> {
        let factor = noise.covariance(rows).cholesky().unwrap().unpack();
        let mut draws = Draws::new(5, 0);
        (0..chunks).map(|_| &factor * DVector::from_fn(rows, |_, _| draws.normal())).collect()
    }

    #[test]
    fn the_noise_that_made_a_residual_is_found_again() {
        let noise = Noise { shape: Shape::Differenced, sensor: 4.0, process: 1.0, persistence: 0.8 };
        let all = made(noise, 40, 140);
        let residuals: Vec<&DVector<f64>> = all.iter().collect();
        let rows = Weighted { residuals: &residuals, weights: &vec![None; residuals.len()] };
        let found = likeliest(&[Shape::Differenced], 1.0, None, rows);
        assert!((found.sensor / 4.0 - 1.0).abs() < 0.15, "{found:?}");
        assert!((found.process - 1.0).abs() < 0.4 && (found.persistence - 0.8).abs() < 0.12, "{found:?}");
    }

    #[test]
    fn noises_side_by_side_leave_what_each_leaves_alone() {
        let noise = Noise { shape: Shape::Averaged, sensor: 1.0, process: 2.0, persistence: 0.7 };
        let all = made(noise, 3, 90);
        let kept: Vec<DVector<f64>> =
            all.iter().map(|one| one.map(|value| 1.0 / (1.0 + value * value))).collect();
        let (residuals, weights): (Vec<_>, Vec<_>) = (all.iter().collect(), kept.iter().map(Some).collect());
        let rows = Weighted { residuals: &residuals, weights: &weights };
        let places = [
            (0.0, 0.0),
            (0.3, 0.5),
            (1.0, 0.9),
            (0.6, 0.96),
            (0.01, 0.99),
            (0.5, 0.0),
            (0.9, 0.1),
            (0.2, 0.7),
            (0.4, 0.8),
        ];
        for (place, tried) in places.iter().zip(rows.tried(Shape::Averaged, &places)) {
            let (_, found) = tried.unwrap();
            let unit = Noise { sensor: 1.0 - place.0, process: place.0, persistence: place.1, ..noise };
            let whitener = unit.whitener(90).unwrap();
            let square = |(one, weight): (&DVector<f64>, &DVector<f64>)| {
                whitener.whiten(one).component_mul(weight).dot(&whitener.whiten(one))
            };
            let expected: f64 = all.iter().zip(&kept).map(square).sum::<f64>() / 270.0;
            assert!(((found.sensor + found.process) / expected - 1.0).abs() < 1e-12, "{found:?}, {expected}");
        }
    }
}
