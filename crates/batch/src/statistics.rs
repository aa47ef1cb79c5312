//! Statistics that take one value after the other and keep none.
//!
//! Source: Welford, "Note on a method for calculating corrected sums of squares and products" (1962).

use nalgebra::{DMatrix, DVector};

/// Number, mean, spread and ends of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// How many values there were; what is not a number is none.
    pub count: u64,
    /// Their mean; NaN where there is none.
    pub mean: f64,
    squares: f64,
    /// The least.
    pub least: f64,
    /// The greatest.
    pub greatest: f64,
}

impl Default for Statistics {
    fn default() -> Self {
        Self { count: 0, mean: f64::NAN, squares: 0.0, least: f64::NAN, greatest: f64::NAN }
    }
}

impl Statistics {
    /// Takes a value.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.count += 1;
        if self.count == 1 {
            (self.mean, self.least, self.greatest) = (value, value, value);
            return;
        }
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
        (self.least, self.greatest) = (self.least.min(value), self.greatest.max(value));
    }

    /// Takes every value as so many times itself.
    pub fn scale(&mut self, factor: f64) {
        self.mean *= factor;
        self.squares *= factor * factor;
        let ends = (self.least * factor, self.greatest * factor);
        (self.least, self.greatest) = (ends.0.min(ends.1), ends.0.max(ends.1));
    }

    /// Standard deviation with n − 1; NaN for fewer than two values.
    pub fn deviation(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { (self.squares / (self.count - 1) as f64).sqrt() }
    }
}

/// A straight line through points, by least squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Line {
    /// Points.
    pub count: u64,
    means: (f64, f64),
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Line {
    /// Takes a point.
    pub fn add(&mut self, x: f64, y: f64) {
        if !(x.is_finite() && y.is_finite()) {
            return;
        }
        self.count += 1;
        let count = self.count as f64;
        let (dx, dy) = (x - self.means.0, y - self.means.1);
        self.means.0 += dx / count;
        self.means.1 += dy / count;
        self.xx += dx * (x - self.means.0);
        self.xy += dx * (y - self.means.1);
        self.yy += dy * (y - self.means.1);
    }

    /// Value at x = 0, slope, and share of the variance that the line explains; `None` where points do not span one.
    pub fn fit(&self) -> Option<(f64, f64, f64)> {
        if self.count < 3 || self.xx <= 0.0 {
            return None;
        }
        let slope = self.xy / self.xx;
        let share = if self.yy > 0.0 { self.xy * self.xy / (self.xx * self.yy) } else { 1.0 };
        Some((self.means.1 - slope * self.means.0, slope, share))
    }
}

/// Means and products of several quantities, for regressions of one on others.
#[derive(Clone, Debug, PartialEq)]
pub struct Products {
    count: f64,
    means: DVector<f64>,
    sums: DMatrix<f64>,
}

impl Products {
    /// Of this many quantities.
    pub fn new(quantities: usize) -> Self {
        Self { count: 0.0, means: DVector::zeros(quantities), sums: DMatrix::zeros(quantities, quantities) }
    }

    /// Takes the quantities of one run.
    pub fn add(&mut self, values: &[f64]) {
        if values.len() != self.means.len() || values.iter().any(|value| !value.is_finite()) {
            return;
        }
        self.count += 1.0;
        let values = DVector::from_column_slice(values);
        let before = &values - &self.means;
        self.means += &before / self.count;
        self.sums += before * (values - &self.means).transpose();
    }

    /// The slopes of the last quantity over the others, with theirs; `None` where they cannot be told apart.
    pub fn slopes(&self) -> Option<Vec<f64>> {
        let known = self.means.len() - 1;
        if self.count < known as f64 + 2.0 {
            return None;
        }
        let scales: Vec<f64> = (0..known).map(|index| self.sums[(index, index)].sqrt()).collect();
        if scales.iter().any(|scale| *scale <= 0.0) {
            return None;
        }
        let matrix = DMatrix::from_fn(known, known, |row, column| {
            self.sums[(row, column)] / scales[row] / scales[column]
        });
        let right = DVector::from_fn(known, |row, _| self.sums[(row, known)] / scales[row]);
        let solved = matrix.cholesky()?.solve(&right);
        Some(solved.iter().zip(&scales).map(|(slope, scale)| slope / scale).collect())
    }

    /// Mean of the last quantity.
    pub fn mean(&self) -> f64 {
        self.means[self.means.len() - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2, 4, 4, 4, 5, 5, 7, 9: mean 5, sum of squares 32, so √(32/7).
    #[test]
    fn mean_and_deviation_by_hand() {
        let mut statistics = Statistics::default();
        for value in [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0, f64::NAN] {
            statistics.add(value);
        }
        assert_eq!((statistics.count, statistics.mean), (8, 5.0));
        assert!((statistics.deviation() - (32.0f64 / 7.0).sqrt()).abs() < 1e-14);
        assert_eq!((statistics.least, statistics.greatest), (2.0, 9.0));
        assert!(Statistics::default().mean.is_nan() && Statistics::default().deviation().is_nan());
    }

    #[test]
    fn a_line_is_found_with_its_value_at_zero() {
        let mut line = Line::default();
        for x in [-2.0, 1.0, 5.0, 6.0] {
            line.add(x, 3.0 - 0.5 * x);
        }
        let (at_zero, slope, share) = line.fit().unwrap();
        assert!((at_zero - 3.0).abs() < 1e-12 && (slope + 0.5).abs() < 1e-12 && (share - 1.0).abs() < 1e-12);
        let mut upright = Line::default();
        (0..4).for_each(|y| upright.add(1.0, f64::from(y)));
        assert_eq!(upright.fit(), None);
    }

    #[test]
    fn slopes_of_a_plane_are_told_apart_and_of_one_direction_are_not() {
        let mut plane = Products::new(3);
        let mut ridge = Products::new(3);
        for step in 0..20 {
            let (x, y) = (f64::from(step), f64::from(step * step % 7));
            plane.add(&[x, y, 2.0 * x - 3.0 * y + 1.0]);
            ridge.add(&[x, 2.0 * x, x]);
        }
        let slopes = plane.slopes().unwrap();
        assert!((slopes[0] - 2.0).abs() < 1e-10 && (slopes[1] + 3.0).abs() < 1e-10, "{slopes:?}");
        assert_eq!(ridge.slopes(), None);
    }
}
