//! What is left of a balance when nothing is missing: noise of the sensors and small unsteadiness of the world.
//!
//! Two parts, found by maximum likelihood (likeliest.rs): noise of the sensors, which the weak form gives a known covariance, and a
//! first-order autoregressive process for everything that is neither sensor nor model.
//! Source: Rasmussen and Williams, *Gaussian Processes for Machine Learning* (2006), section 5.4 and appendix B.
//!
//! Whitening takes time in proportion to the rows. With T subtracting ρ times the row before, T Σ Tᵀ is zero beyond the
//! second off-diagonal, because that turns the process into white noise; so Σ = T⁻¹ L Lᵀ T⁻ᵀ with L of three diagonals.
//! Source: Brockwell and Davis, *Time Series: Theory and Methods* (1991), section 5.3, the innovations of an ARMA process.

use crate::balances::rows::Chunk;
use crate::outliers::tails::Tails;
use nalgebra::{DMatrix, DVector};

/// How the noise of the sensor comes through the weak form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Differences of block means: 1 on the diagonal and −½ beside it.
    Differenced,
    /// Hat-weighted means: 1 on the diagonal and ¼ beside it.
    Averaged,
}

impl Shape {
    /// Correlation of neighbouring rows by the sensor.
    fn beside(self) -> f64 {
        match self {
            Self::Differenced => -0.5,
            Self::Averaged => 0.25,
        }
    }
}

/// The noise of one balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// How the sensor's part is correlated.
    pub shape: Shape,
    /// Variance of a row by the sensors.
    pub sensor: f64,
    /// Variance of a row by the process.
    pub process: f64,
    /// Correlation of the process between neighbouring rows.
    pub persistence: f64,
}

/// What turns the rows of a chunk, of any length up to the longest, into white noise of unit variance.
#[derive(Clone, Debug)]
pub struct Whitener {
    pub persistence: f64,
    /// Diagonals of L, row by row: two to the left, one to the left, its own. From the last on they stay as they are.
    pub factor: Vec<[f64; 3]>,
    /// ln |Σ| of the first rows: of none, of one, of two, …
    log_determinants: Vec<f64>,
}

/// A touch more on the diagonal keeps differences of ever more blocks apart.
const APART: f64 = 1e-3;
impl Noise {
    /// Standard deviation of a row.
    pub fn sd(&self) -> f64 {
        (self.sensor + self.process).sqrt()
    }

    /// ln of how likely a world is from the start that is as unsteady as the process makes it, where `usual` is the variance
    /// that lasting unsteadiness usually has in the mean of a row: by heavy tails, so that a large one costs little.
    pub fn prior(&self, usual: Option<f64>) -> f64 {
        usual.map_or(0.0, |usual| -(self.lasting() / usual).ln_1p())
    }

    /// Variance that what lasts has in the mean of a row.
    pub fn lasting(&self) -> f64 {
        self.process * (1.0 + self.persistence) / (1.0 - self.persistence)
    }

    /// Covariance of so many rows that follow each other.
    pub fn covariance(&self, rows: usize) -> DMatrix<f64> {
        let beside = self.shape.beside();
        DMatrix::from_fn(rows, rows, |row, column| {
            let apart = row.abs_diff(column);
            let sensor = [1.0 + APART, beside].get(apart).copied().unwrap_or(0.0);
            self.sensor * sensor + self.process * self.persistence.powf(apart as f64)
        })
    }

    /// What whitens chunks of up to so many rows; none where the covariance is not positive.
    pub fn whitener(&self, longest: usize) -> Option<Whitener> {
        let beside = self.shape.beside();
        let (rho, s0, s1) = (self.persistence, self.sensor * (1.0 + APART), self.sensor * beside);
        // Diagonals of T Σ Tᵀ; its first row has nothing to subtract.
        let inner = [-rho * s1, s1 * (1.0 + rho * rho) - rho * s0, s0 * (1.0 + rho * rho) - 2.0 * rho * s1];
        let own = inner[2] + self.process * (1.0 - rho * rho);
        let mut factor: Vec<[f64; 3]> = Vec::with_capacity(longest);
        let mut log_determinants = vec![0.0];
        let mut log = 0.0;
        for row in 0..longest {
            let (far, near, own) = match row {
                0 => (0.0, 0.0, s0 + self.process),
                1 => (0.0, s1 - rho * s0, own),
                _ => (inner[0], inner[1], own),
            };
            let before = |back: usize| row.checked_sub(back).map_or([0.0, 0.0, 1.0], |place| factor[place]);
            let (one, two) = (before(1), before(2));
            let left2 = far / two[2];
            let left1 = (near - left2 * one[1]) / one[2];
            let square = own - left1 * left1 - left2 * left2;
            if square.is_nan() || square <= 0.0 {
                return None;
            }
            let next = [left2, left1, square.sqrt()];
            let ln = square.ln();
            log += ln;
            log_determinants.push(log);
            let settled = row > 3 && one == next && two == next;
            if settled {
                log_determinants.extend((row + 1..longest).map(|_| {
                    log += ln;
                    log
                }));
                break;
            }
            factor.push(next);
        }
        Some(Whitener { persistence: rho, factor, log_determinants })
    }
}

/// Rows on their way through a whitener, one by one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Passing {
    /// How many came before.
    rows: usize,
    before: f64,
    /// The last and the last but one, white.
    white: [f64; 2],
}

impl Passing {
    /// As far as another, and nothing but zeros so far.
    pub fn behind(other: Self) -> Self {
        Self { rows: other.rows, ..Self::default() }
    }
}

impl Whitener {
    /// Diagonals of L in one row.
    pub fn row(&self, row: usize) -> [f64; 3] {
        self.factor[row.min(self.factor.len() - 1)]
    }

    /// One more row, white. There must not be more than it was made for.
    pub fn step(&self, passing: &mut Passing, value: f64) -> f64 {
        let [left2, left1, own] = self.row(passing.rows);
        let [one, two] = passing.white;
        let white = (value - self.persistence * passing.before - left1 * one - left2 * two) / own;
        *passing = Passing { rows: passing.rows + 1, before: value, white: [white, one] };
        white
    }

    fn each(&self, values: &[f64], mut take: impl FnMut(usize, f64)) {
        let mut passing = Passing::default();
        for (row, value) in values.iter().enumerate() {
            take(row, self.step(&mut passing, *value));
        }
    }

    /// L⁻¹ T x.
    pub fn whiten(&self, values: &DVector<f64>) -> DVector<f64> {
        let mut all = DVector::zeros(values.len());
        self.each(values.as_slice(), |row, white| all[row] = white);
        all
    }

    /// L⁻¹ T X, column by column; several side by side, since each row waits for the one before it.
    pub fn whiten_all(&self, values: &mut DMatrix<f64>) {
        const LANES: usize = 8;
        let rows = values.nrows();
        for block in values.as_mut_slice().chunks_mut((LANES * rows).max(1)) {
            let lanes = block.len() / rows;
            let (mut before, mut one, mut two) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for row in 0..rows {
                let [left2, left1, own] = self.row(row);
                for lane in 0..lanes {
                    let entry = &mut block[lane * rows + row];
                    let value = *entry;
                    *entry =
                        (value - self.persistence * before[lane] - left1 * one[lane] - left2 * two[lane])
                            / own;
                    (before[lane], two[lane], one[lane]) = (value, one[lane], *entry);
                }
            }
        }
    }

    /// tr Σ⁻¹S: the square that whitened noise of another kind is expected to have over so many rows.
    pub fn trace(&self, rows: usize, noise: &Noise) -> f64 {
        let mut once = noise.covariance(rows);
        self.whiten_all(&mut once);
        let mut twice = once.transpose();
        self.whiten_all(&mut twice);
        twice.trace()
    }

    /// ln |Σ| of so many rows.
    pub fn log_determinant(&self, rows: usize) -> f64 {
        self.log_determinants[rows.min(self.log_determinants.len() - 1)]
    }
}

/// The noise of several balances side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Noises {
    /// In the order of the balances' numbers.
    pub each: Vec<Noise>,
    /// Where rows may stray further than a normal distribution lets them.
    pub tails: Option<Tails>,
    /// Balances in which nothing that lasts is noise: a function takes it.
    pub brief: Vec<bool>,
}

/// What whitens the chunks of several balances.
#[derive(Clone, Debug)]
pub struct Whiteners {
    each: Vec<Whitener>,
    tails: Option<Tails>,
}

impl Noises {
    /// Normal noise.
    pub fn normal(each: Vec<Noise>) -> Self {
        Self { brief: vec![false; each.len()], each, tails: None }
    }

    /// What whitens these chunks.
    pub fn whiteners(&self, chunks: &[Chunk]) -> Option<Whiteners> {
        let longest = chunks.iter().map(|chunk| chunk.rows.len()).max().unwrap_or(0);
        let each = self.each.iter().map(|noise| noise.whitener(longest)).collect::<Option<_>>()?;
        Some(Whiteners { each, tails: self.tails.clone() })
    }
}

impl Whiteners {
    /// That of a chunk's balance, every row counting alike.
    pub fn of(&self, chunk: &Chunk) -> &Whitener {
        &self.each[chunk.balance]
    }

    /// Whitens the rows of a chunk of this number, column by column, and makes each count as much as it should.
    pub fn whiten(&self, number: usize, chunk: &Chunk, values: &mut DMatrix<f64>) {
        for (row, loud) in chunk.loudness.iter().enumerate() {
            values.row_mut(row).unscale_mut(*loud);
        }
        self.of(chunk).whiten_all(values);
        let Some(tails) = &self.tails else { return };
        for (row, weight) in tails.weights(number).iter().enumerate() {
            values.row_mut(row).scale_mut(weight.sqrt());
        }
    }

    /// As [`Whiteners::whiten`], of one column.
    pub fn white(&self, number: usize, chunk: &Chunk, values: &DVector<f64>) -> DVector<f64> {
        let white = self.of(chunk).whiten(&chunk.alike(values));
        match &self.tails {
            Some(tails) => white.zip_map(tails.weights(number), |white, weight| weight.sqrt() * white),
            None => white,
        }
    }

    /// ln |Σ| of a chunk of this number, less what a bound of the density takes, twice.
    pub fn log_determinant(&self, number: usize, chunk: &Chunk) -> f64 {
        let tails = self.tails.as_ref().map_or(0.0, |tails| tails.log_determinant(number));
        let loud: f64 = chunk.loudness.iter().map(|loud| 2.0 * loud.ln()).sum();
        self.of(chunk).log_determinant(chunk.rows.len()) + loud + tails
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_diagonals_whiten_as_the_dense_covariance_does() {
        for shape in [Shape::Differenced, Shape::Averaged] {
            for (sensor, process, persistence) in [(2.0, 0.0, 0.0), (1.0, 0.7, 0.9), (0.0, 3.0, 0.6)] {
                let noise = Noise { shape, sensor, process, persistence };
                let dense = noise.covariance(9);
                let values = DVector::from_fn(9, |row, _| (1.7 * row as f64).sin() + 0.3);
                let expected = (values.transpose() * dense.clone().try_inverse().unwrap() * &values)[(0, 0)];
                let whitener = noise.whitener(20).unwrap();
                let white = whitener.whiten(&values).norm_squared();
                assert!((white / expected - 1.0).abs() < 1e-9, "{white} against {expected}");
                assert!((whitener.log_determinant(9) - dense.determinant().ln()).abs() < 1e-9);
            }
        }
    }
}
