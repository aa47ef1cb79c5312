//! Functions that stay and then jump: a consumer is switched, the ground changes at the edge of a field.
//!
//! The increments from knot to knot have Student's distribution instead of a normal one, each by a normal one of its own
//! width; the widths are found with the function, round after round.

use crate::outliers::student::Student;
use nalgebra::DVector;
use std::sync::Arc;

/// How free the increments of a function are, one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct Jumps {
    /// Distance between knots [m or s].
    pub step: f64,
    /// ξ of the increments of each group, in units of the usual variance.
    squares: Arc<Vec<Vec<f64>>>,
}

impl Jumps {
    /// Where nothing is known of any increment.
    pub fn unknown(step: f64) -> Self {
        Self { step, squares: Arc::new(Vec::new()) }
    }

    /// With the squares of increments as a round found them, in units of the usual variance.
    pub fn of(step: f64, squares: Vec<Vec<f64>>) -> Self {
        Self { step, squares: Arc::new(squares) }
    }

    fn square(&self, group: usize, increment: usize) -> f64 {
        self.squares.get(group).and_then(|group| group.get(increment)).copied().unwrap_or(1.0)
    }

    /// Factor w of the precision of an increment.
    pub fn weight(&self, group: usize, increment: usize) -> f64 {
        Student::JUMPING.weight(self.square(group, increment))
    }

    /// What the bound is above the normal distributions that stand for the increments of a group.
    pub fn bound(&self, group: usize, increments: usize) -> f64 {
        (0..increments).map(|increment| Student::JUMPING.bound(self.square(group, increment))).sum()
    }
}

/// ⟨e²⟩ of the increments e = x − φ x₋ of a group, by its values and the diagonals of their covariance.
pub fn squares(
    own: &DVector<f64>,
    beside: &DVector<f64>,
    values: &DVector<f64>,
    forgetting: f64,
) -> Vec<f64> {
    (1..values.len())
        .map(|knot| {
            let mean = values[knot] - forgetting * values[knot - 1];
            let variance =
                own[knot] + forgetting * forgetting * own[knot - 1] - 2.0 * forgetting * beside[knot];
            mean * mean + variance.max(0.0)
        })
        .collect()
}
