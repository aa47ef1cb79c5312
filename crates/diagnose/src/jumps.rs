//! Functions that stay and then jump: a consumer is switched, the ground changes at the edge of a field.
//!
//! The increments from knot to knot have Student's distribution with two degrees of freedom instead of a normal one. It is a
//! normal one of its own width for each increment, and the widths are found with the function, round after round; what is
//! lost by that is a lower bound of the evidence, so the likelihood stays comparable.
//!
//! ln t(e) ≥ ln t(√ξ) − w (e² − ξ)/2,  w = (ν + 1)/(ν + ξ),  ξ = ⟨e²⟩
//!
//! Source: Jaakkola and Jordan, *Statistics and Computing* 10 (2000) 25, for bounds of this kind; Lange, Little and
//! Taylor, *J. Am. Stat. Assoc.* 84 (1989) 881, for Student's distribution by weights.

use crate::band::Factor;
use nalgebra::DVector;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Degrees of freedom ν: jumps of any size, and no variance.
const FREEDOM: f64 = 2.0;
/// Γ((ν + 1)/2) / (Γ(ν/2) √(νπ)), the density at 0: Γ(3/2) = √π/2, so 1/√8.
const HEIGHT: f64 = 0.353_553_390_593_273_8;

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
        (FREEDOM + 1.0) / (FREEDOM + self.square(group, increment))
    }

    /// What the bound is below the normal distributions that stand for the increments of a group.
    pub fn bound(&self, group: usize, increments: usize) -> f64 {
        // ln t(√ξ) + w ξ/2 − ln of the normal density's factor.
        let one = |increment: usize| {
            let (square, weight) = (self.square(group, increment), self.weight(group, increment));
            HEIGHT.ln() - 0.5 * (FREEDOM + 1.0) * (square / FREEDOM).ln_1p() + 0.5 * weight * square
                - 0.5 * (weight / TAU).ln()
        };
        (0..increments).map(one).sum()
    }
}

/// ⟨e²⟩ of the increments e = x − φ x₋ of a group.
pub fn squares(factor: &Factor, values: &DVector<f64>, forgetting: f64) -> Vec<f64> {
    let (own, beside) = factor.inverse_diagonals();
    (1..values.len())
        .map(|knot| {
            let mean = values[knot] - forgetting * values[knot - 1];
            let variance =
                own[knot] + forgetting * forgetting * own[knot - 1] - 2.0 * forgetting * beside[knot];
            mean * mean + variance.max(0.0)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At e² = ξ the bound touches: ln t(e) = −ln √8 − 3/2 ln(1 + e²/2).
    #[test]
    fn the_bound_touches_the_density_where_it_was_made_and_lies_below_elsewhere() {
        for square in [0.0, 0.3, 4.0, 90.0] {
            let jumps = Jumps::of(1.0, vec![vec![square]]);
            let (weight, bound) = (jumps.weight(0, 0), jumps.bound(0, 1));
            let below = |e2: f64| 0.5 * (weight / TAU).ln() - 0.5 * weight * e2 + bound;
            let density = |e2: f64| -0.5 * 8f64.ln() - 1.5 * (0.5 * e2).ln_1p();
            assert!((below(square) - density(square)).abs() < 1e-12);
            assert!([0.0, 1.0, 10.0].iter().all(|e2| below(*e2) <= density(*e2) + 1e-12));
        }
    }
}
