//! Generalised least squares with priors: evidence, estimates, and what each run says of the others.
//!
//! With columns X, residual r, noise Σ and prior precision P: β = (XᵀΣ⁻¹X + P)⁻¹ XᵀΣ⁻¹r, and
//! −2 ln p(r) = rᵀΣ⁻¹r − βᵀ(XᵀΣ⁻¹X + P)β + ln|Σ| + ln|XᵀΣ⁻¹X + P| − ln|P| + n ln 2π.
//! Source: Bishop, *Pattern Recognition and Machine Learning* (2006), section 3.5.

use crate::balances::noise::{Noises, Whiteners};
use crate::balances::rows::Chunk;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::borrow::Cow;

/// A regressor: one vector for each chunk.
pub type Column = Vec<DVector<f64>>;

/// Columns and residual, whitened.
pub struct Whitened {
    /// One matrix for each chunk; the residual is its last column.
    pub chunks: Vec<DMatrix<f64>>,
    /// What whitened them.
    pub whiteners: Whiteners,
    width: usize,
}

/// Products of all columns and the residual.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// XᵀΣ⁻¹X.
    pub matrix: DMatrix<f64>,
    /// XᵀΣ⁻¹r.
    pub vector: DVector<f64>,
    /// rᵀΣ⁻¹r.
    pub scalar: f64,
    /// ln|Σ|, and what eliminated functions add.
    pub log_determinant: f64,
    /// Number of rows.
    pub rows: usize,
}

/// An estimate with some of the columns.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// One for each column used.
    pub beta: DVector<f64>,
    /// (XᵀΣ⁻¹X + P)⁻¹.
    pub covariance: DMatrix<f64>,
    /// ln p(r).
    pub log_evidence: f64,
}

impl Estimate {
    /// What all else is estimated to be where the columns at some positions are known to be nought; the covariance stays as it is.
    /// Source: the conditional mean of a normal distribution; Bishop, *Pattern Recognition and Machine Learning* (2006), (2.81).
    pub fn without(&self, positions: &[usize]) -> Option<Self> {
        let (count, own) = (positions.len(), &self.covariance);
        let among = DMatrix::from_fn(count, count, |row, column| own[(positions[row], positions[column])]);
        let values = DVector::from_fn(count, |row, _| self.beta[positions[row]]);
        let weights = among.cholesky()?.solve(&values);
        let moved = |index: usize| -> f64 {
            positions
                .iter()
                .zip(weights.iter())
                .map(|(position, weight)| own[(index, *position)] * weight)
                .sum()
        };
        let beta = DVector::from_fn(self.beta.len(), |index, _| self.beta[index] - moved(index));
        Some(Self { beta, ..self.clone() })
    }
}

impl Whitened {
    /// Whitens residual and columns.
    pub fn new(chunks: &[Chunk], residual: &Column, columns: &[&Column], noise: &Noises) -> Option<Self> {
        let whiteners = noise.whiteners(chunks)?;
        let width = columns.len();
        let whiten = |(index, chunk): (usize, &Chunk)| {
            let mut x = DMatrix::zeros(chunk.rows.len(), width + 1);
            for (column, values) in columns.iter().enumerate() {
                x.set_column(column, &values[index]);
            }
            x.set_column(width, &residual[index]);
            whiteners.whiten(index, chunk, &mut x);
            x
        };
        let all = chunks.par_iter().enumerate().map(whiten).collect();
        Some(Self { chunks: all, whiteners, width })
    }

    /// Number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The products over the runs that are `fit`.
    pub fn reduced(&self, chunks: &[Chunk], fit: &[bool]) -> Reduced {
        let used: Vec<usize> = (0..chunks.len()).filter(|index| fit[chunks[*index].run]).collect();
        let product = |batch: &Vec<usize>| {
            let x = self.stacked(batch);
            x.transpose() * &*x
        };
        let products: Vec<DMatrix<f64>> = self.batches(&used).par_iter().map(product).collect();
        let mut sum = DMatrix::zeros(self.width + 1, self.width + 1);
        for product in products {
            sum += product;
        }
        let log_determinant =
            used.iter().map(|index| self.whiteners.log_determinant(*index, &chunks[*index])).sum();
        let rows = used.iter().map(|index| chunks[*index].rows.len()).sum();
        Reduced {
            matrix: sum.view((0, 0), (self.width, self.width)).into_owned(),
            vector: sum.view((0, self.width), (self.width, 1)).column(0).into_owned(),
            scalar: sum[(self.width, self.width)],
            log_determinant,
            rows,
        }
    }
}

impl Whitened {
    /// Chunks side by side whose products are made at once: those of a few rows each take as long as those of many.
    fn batches(&self, chunks: &[usize]) -> Vec<Vec<usize>> {
        /// More rows gain nothing.
        const ROWS: usize = 200;
        let mut batches: Vec<Vec<usize>> = Vec::new();
        let mut rows = 0;
        for chunk in chunks {
            let own = self.chunks[*chunk].nrows();
            match batches.last_mut() {
                Some(last) if rows + own <= ROWS => last.push(*chunk),
                _ => {
                    batches.push(vec![*chunk]);
                    rows = 0;
                }
            }
            rows += own;
        }
        batches
    }

    /// The rows of some chunks, one chunk below the other.
    fn stacked(&self, chunks: &[usize]) -> Cow<'_, DMatrix<f64>> {
        if let [chunk] = chunks {
            return Cow::Borrowed(&self.chunks[*chunk]);
        }
        let rows = chunks.iter().map(|chunk| self.chunks[*chunk].nrows()).sum();
        let mut all = DMatrix::zeros(rows, self.width + 1);
        let mut first = 0;
        for chunk in chunks {
            let own = &self.chunks[*chunk];
            all.rows_mut(first, own.nrows()).copy_from(own);
            first += own.nrows();
        }
        Cow::Owned(all)
    }
}

/// A right side without what other columns of these values make of it; it is the last column of the products.
pub fn right_side(cross: &DMatrix<f64>, beta: &DVector<f64>) -> DVector<f64> {
    let mut right = cross.column(cross.ncols() - 1).into_owned();
    for (column, value) in beta.iter().enumerate() {
        right -= cross.column(column) * *value;
    }
    right
}

impl Reduced {
    /// Takes products out that belong to what was eliminated, the residual's last, with what it adds to ln |Σ|.
    pub fn take(&mut self, taken: &DMatrix<f64>, log_determinant: f64) {
        let width = self.matrix.nrows();
        self.matrix -= taken.view((0, 0), (width, width));
        self.vector -= taken.view((0, width), (width, 1)).column(0);
        self.scalar -= taken[(width, width)];
        self.log_determinant += log_determinant;
    }

    /// −2 ln p of the rows with these values of all columns, but for what goes with the number of rows.
    pub fn deviance_at(&self, beta: &DVector<f64>) -> f64 {
        let square = beta.dot(&(&self.matrix * beta));
        self.scalar - 2.0 * beta.dot(&self.vector) + square + self.log_determinant
    }

    fn chosen(&self, used: &[usize]) -> (DMatrix<f64>, DVector<f64>) {
        let matrix =
            DMatrix::from_fn(used.len(), used.len(), |row, column| self.matrix[(used[row], used[column])]);
        (matrix, DVector::from_iterator(used.len(), used.iter().map(|index| self.vector[*index])))
    }

    /// Estimates with the columns `used`, each with its prior standard deviation (zero mean).
    pub fn estimate(&self, used: &[usize], sd: &[f64]) -> Option<Estimate> {
        let (matrix, vector) = self.chosen(used);
        let mut information = matrix;
        for (row, index) in used.iter().enumerate() {
            information[(row, row)] += sd[*index].powi(-2);
        }
        let cholesky = information.cholesky()?;
        let beta = cholesky.solve(&vector);
        if !beta.iter().all(|value| value.is_finite()) {
            return None;
        }
        let log = 2.0 * cholesky.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>();
        let prior: f64 = used.iter().map(|index| -2.0 * sd[*index].ln()).sum();
        let explained = beta.dot(&vector);
        let deviance = self.scalar - explained + self.log_determinant + log - prior
            + self.rows as f64 * (2.0 * std::f64::consts::PI).ln();
        Some(Estimate { beta, covariance: cholesky.inverse(), log_evidence: -0.5 * deviance })
    }

    /// Squared correlation of two groups of columns, once `nuisance` is projected out: the largest canonical one. What does
    /// not show in the rows at its usual size is like nothing.
    pub fn squared_correlation(&self, one: &[usize], other: &[usize], nuisance: &[usize], sd: &[f64]) -> f64 {
        /// Evidence of a column of its usual size below which it says nothing.
        const NOTHING: f64 = 1e-6;
        let shows = |column: &usize| self.matrix[(*column, *column)] * sd[*column].powi(2) > NOTHING;
        let [one, other]: [Vec<usize>; 2] =
            [one, other].map(|group| group.iter().copied().filter(shows).collect());
        if one.is_empty() || other.is_empty() {
            return 0.0;
        }
        let all: Vec<usize> = nuisance.iter().chain(&one).chain(&other).copied().collect();
        let sum = self.chosen(&all).0;
        let (n, p, q) = (nuisance.len(), one.len(), other.len());
        let mut inner = sum.view((0, 0), (n, n)).into_owned();
        for (row, index) in nuisance.iter().enumerate() {
            inner[(row, row)] += sd[*index].powi(-2);
        }
        let inverse = if n > 0 { inner.try_inverse() } else { Some(DMatrix::zeros(0, 0)) };
        let Some(inverse) = inverse else { return 1.0 };
        let rest = |row: usize, column: usize, height: usize, width: usize| {
            let left = sum.view((0, row), (n, height)).transpose();
            let right = sum.view((0, column), (n, width));
            sum.view((row, column), (height, width)).into_owned() - left * &inverse * right
        };
        let solve = |mut matrix: DMatrix<f64>, right: &DMatrix<f64>| {
            for index in 0..matrix.nrows() {
                matrix[(index, index)] *= 1.0 + 1e-9;
            }
            matrix.cholesky().map(|cholesky| cholesky.solve(right))
        };
        let cross = rest(n, n + p, p, q);
        let left = solve(rest(n, n, p, p), &cross);
        let right = solve(rest(n + p, n + p, q, q), &cross.transpose());
        let (Some(left), Some(right)) = (left, right) else { return 1.0 };
        let product = left * right;
        let largest = product.complex_eigenvalues().iter().map(|value| value.re).fold(0.0, f64::max);
        largest.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products of columns of four rows with noise of one.
    fn reduced(columns: &[[f64; 4]]) -> Reduced {
        let x = DMatrix::from_fn(4, columns.len(), |row, column| columns[column][row]);
        Reduced {
            matrix: x.transpose() * &x,
            vector: DVector::zeros(columns.len()),
            scalar: 0.0,
            log_determinant: 0.0,
            rows: 4,
        }
    }

    /// Beside a level, (0, 1, 0, 1) is (−1, 1, −1, 1)/2 and (0, 0, 0, 1) is (−1, −1, −1, 3)/4: cos² = (4/8)²/(1 · 12/16) = 1/3.
    #[test]
    fn a_correlation_is_that_beside_what_is_projected_out() {
        let reduced = reduced(&[[1.0; 4], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]]);
        let r2 = reduced.squared_correlation(&[1], &[2], &[0], &[1e6, 1.0, 1.0]);
        assert!((r2 - 1.0 / 3.0).abs() < 1e-6, "{r2}");
    }

    /// Where the slope beside a level is known to be nought, the level is what it is by itself.
    #[test]
    fn what_is_left_without_a_column_is_what_the_others_say_alone() {
        let mut both = reduced(&[[1.0; 4], [0.0, 1.0, 2.0, 4.0]]);
        both.vector = DVector::from_vec(vec![10.0, 27.0]);
        let sd = [3.0, 2.0];
        let alone = both.estimate(&[0], &sd).unwrap().beta[0];
        let told = both.estimate(&[0, 1], &sd).unwrap().without(&[1]).unwrap();
        assert!((told.beta[0] - alone).abs() < 1e-12 && told.beta[1].abs() < 1e-12, "{}", told.beta);
    }

    /// Rows 1, 2, 3, 4 less twice the ones: 1 + 0 + 1 + 4.
    #[test]
    fn a_deviance_at_some_values_is_that_of_what_they_leave() {
        let mut reduced = reduced(&[[1.0; 4]]);
        (reduced.vector, reduced.scalar) = (DVector::from_element(1, 10.0), 30.0);
        assert!((reduced.deviance_at(&DVector::from_element(1, 2.0)) - 6.0).abs() < 1e-12);
    }

    /// A bell between two samples is nought in every row: nothing says the same as it.
    #[test]
    fn what_shows_in_no_row_is_like_nothing() {
        let reduced = reduced(&[[1.0, 2.0, 3.0, 5.0], [0.0; 4], [2.0, 4.0, 6.0, 10.0]]);
        assert_eq!(reduced.squared_correlation(&[0], &[1], &[], &[1.0; 3]), 0.0);
        assert!(reduced.squared_correlation(&[0], &[1, 2], &[], &[1.0; 3]) > 0.999);
    }
}
