//! Rows that stray: a sensor that was late for a second, a kerb, a driver on both pedals.
//!
//! What is left of a row, whitened, has Student's distribution instead of a normal one. A row far outside then counts
//! little, where a normal distribution would bend everything else to it.

use crate::balances::gram::Column;
use crate::balances::noise::Noises;
use crate::balances::rows::Chunk;
use crate::outliers::student::Student;
use nalgebra::DVector;
use std::sync::Arc;

/// How much every row counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Tails(Arc<Vec<Own>>);

/// The rows of one chunk.
#[derive(Clone, Debug, PartialEq)]
struct Own {
    weights: DVector<f64>,
    log_determinant: f64,
}

impl Own {
    fn of(white: &DVector<f64>) -> Self {
        let student = Student::STRAYING;
        let weights = white.map(|value| student.weight(value * value));
        let logs = white.iter().zip(&weights);
        let log = |(value, weight): (&f64, &f64)| -weight.ln() - 2.0 * student.bound(value * value);
        Self { log_determinant: logs.map(log).sum(), weights }
    }
}

impl Tails {
    /// As the rows ask for it that a set of causes leaves.
    pub fn of(chunks: &[Chunk], noises: &Noises, left: &Column) -> Option<Self> {
        let whiteners = noises.whiteners(chunks)?;
        let of_chunk =
            |(chunk, left): (&Chunk, &DVector<f64>)| Own::of(&whiteners.of(chunk).whiten(&chunk.alike(left)));
        Some(Self(Arc::new(chunks.iter().zip(left).map(of_chunk).collect())))
    }

    /// Factors of the precision of a chunk's rows.
    pub fn weights(&self, chunk: usize) -> &DVector<f64> {
        &self.0[chunk].weights
    }

    /// What they add to ln |Σ| of a chunk, less what the bound takes, twice.
    pub fn log_determinant(&self, chunk: usize) -> f64 {
        self.0[chunk].log_determinant
    }
}
