//! What is left of a balance when nothing is missing: noise of the sensors and small unsteadiness of the world.
//!
//! Two parts, found by maximum likelihood: noise of the sensors, which the weak form gives a known covariance, and a
//! first-order autoregressive process for everything that is neither sensor nor model.
//! Source: Rasmussen and Williams, *Gaussian Processes for Machine Learning* (2006), section 5.4 and appendix B.

use crate::rows::Chunk;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// How the noise of the sensor comes through the weak form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Differences of block means: 1 on the diagonal and −½ beside it.
    Differenced,
    /// Hat-weighted means: 1 on the diagonal and ¼ beside it.
    Averaged,
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

/// Lower triangles by which chunks of each length are whitened.
pub struct Whitener {
    factors: BTreeMap<usize, (DMatrix<f64>, f64)>,
}

impl Noise {
    /// Standard deviation of a row.
    pub fn sd(&self) -> f64 {
        (self.sensor + self.process).sqrt()
    }

    fn covariance(&self, length: usize) -> DMatrix<f64> {
        let beside = match self.shape {
            Shape::Differenced => -0.5,
            Shape::Averaged => 0.25,
        };
        DMatrix::from_fn(length, length, |row, column| {
            let apart = row.abs_diff(column);
            let sensor = match apart {
                // A touch more on the diagonal keeps differences of ever more blocks apart.
                0 => 1.0 + 1e-3,
                1 => beside,
                _ => 0.0,
            };
            // Chunks are shorter than i32 reaches.
            let apart = i32::try_from(apart).unwrap_or(i32::MAX);
            self.sensor * sensor + self.process * self.persistence.powi(apart)
        })
    }

    /// The factors for these chunks; none where the covariance is not positive.
    pub fn whitener(&self, chunks: &[Chunk]) -> Option<Whitener> {
        let mut factors = BTreeMap::new();
        for chunk in chunks {
            let length = chunk.rows.len();
            if let std::collections::btree_map::Entry::Vacant(entry) = factors.entry(length) {
                let factor = self.covariance(length).cholesky()?.unpack();
                let log_determinant = 2.0 * factor.diagonal().iter().map(|value| value.ln()).sum::<f64>();
                entry.insert((factor, log_determinant));
            }
        }
        Some(Whitener { factors })
    }

    /// The noise that makes residuals (one vector a chunk) most likely.
    pub fn of(shape: Shape, chunks: &[Chunk], residuals: &[DVector<f64>]) -> Self {
        const SHARES: [f64; 8] = [0.0, 0.03, 0.1, 0.25, 0.5, 0.75, 0.93, 1.0];
        const PERSISTENCES: [f64; 6] = [0.0, 0.4, 0.7, 0.88, 0.96, 0.99];
        let count: usize = residuals.iter().map(DVector::len).sum();
        let mut best = Self { shape, sensor: 1.0, process: 0.0, persistence: 0.0 };
        let mut least = f64::INFINITY;
        for share in SHARES {
            for persistence in PERSISTENCES {
                if share == 0.0 && persistence > 0.0 {
                    continue;
                }
                let unit = Self { shape, sensor: 1.0 - share, process: share, persistence };
                let Some(whitener) = unit.whitener(chunks) else { continue };
                let mut sum = 0.0;
                let mut log_determinant = 0.0;
                for (chunk, residual) in chunks.iter().zip(residuals) {
                    sum += whitener.whiten(chunk, residual).norm_squared();
                    log_determinant += whitener.log_determinant(chunk);
                }
                let variance = (sum / count as f64).max(f64::MIN_POSITIVE);
                let deviance = count as f64 * variance.ln() + log_determinant;
                if deviance < least {
                    least = deviance;
                    best = Self {
                        shape,
                        sensor: variance * unit.sensor,
                        process: variance * unit.process,
                        persistence,
                    };
                }
            }
        }
        best
    }
}

impl Whitener {
    /// L⁻¹ x for one chunk.
    pub fn whiten(&self, chunk: &Chunk, values: &DVector<f64>) -> DVector<f64> {
        match self.factors.get(&chunk.rows.len()) {
            Some((factor, _)) => factor.solve_lower_triangular(values).unwrap_or_else(|| values.clone()),
            None => values.clone(),
        }
    }

    /// L⁻¹ X for one chunk.
    pub fn whiten_all(&self, chunk: &Chunk, values: &mut DMatrix<f64>) {
        if let Some((factor, _)) = self.factors.get(&chunk.rows.len()) {
            factor.solve_lower_triangular_mut(values);
        }
    }

    /// ln |Σ| of one chunk.
    pub fn log_determinant(&self, chunk: &Chunk) -> f64 {
        self.factors.get(&chunk.rows.len()).map_or(0.0, |(_, value)| *value)
    }
}
