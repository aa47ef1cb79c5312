//! Nonlinear least squares by the Levenberg–Marquardt method.
//!
//! Minimises S(x) = Σ r(x)². A step solves (H + λ diag H) δ = g, with H = JᵀJ and g = Jᵀ(y − f).
//! Source: Marquardt, *SIAM J. Appl. Math.* 11 (1963), with the gain-ratio damping of Nielsen,
//! *Damping parameter in Marquardt's method*, IMM-REP-1999-05, Technical University of Denmark.
//!
//! Problems hand over H and g instead of J, so that recordings of any length cost the memory of one sample.

use nalgebra::{DMatrix, DVector};

/// A problem, linearised at a point.
#[derive(Clone, Debug)]
pub struct Linearised {
    /// Sum of squared residuals.
    pub cost: f64,
    /// Jᵀ(y − f): points downhill.
    pub gradient: DVector<f64>,
    /// JᵀJ.
    pub information: DMatrix<f64>,
}

/// Something to be minimised.
pub trait Problem {
    /// Residuals, summed up, at `x`. A point that has no answer gives an infinite or NaN cost.
    fn linearise(&self, x: &DVector<f64>) -> Linearised;
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// At most so many linearisations.
    pub linearisations: usize,
    /// Where an undamped step would lower the cost by less than this share of it.
    pub relative_decrease: f64,
}

impl Default for Stop {
    fn default() -> Self {
        Self { linearisations: 60, relative_decrease: 1e-10 }
    }
}

/// Where the search ended.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The point.
    pub x: DVector<f64>,
    /// The problem there.
    pub at: Linearised,
    /// Whether the stopping rule was met, rather than the number of linearisations.
    pub converged: bool,
    /// Linearisations used.
    pub linearisations: usize,
}

/// Searches from `start`.
pub fn minimise<P: Problem + ?Sized>(problem: &P, start: DVector<f64>, stop: &Stop) -> Solution {
    let mut x = start;
    let mut at = problem.linearise(&x);
    let mut linearisations = 1;
    let (mut damping, mut raise) = (1e-4, 2.0);
    while linearisations < stop.linearisations {
        let Some(step) = damped_step(&at, damping) else {
            damping *= raise;
            raise *= 2.0;
            if damping > 1e12 {
                break;
            }
            continue;
        };
        let predicted = predicted_decrease(&at, &step);
        let standing_still = step.amax() <= 1e-13 * x.amax();
        if predicted.is_nan() || predicted <= stop.relative_decrease * at.cost || standing_still {
            return Solution { x, at, converged: true, linearisations };
        }
        let next = &x + &step;
        let there = problem.linearise(&next);
        linearisations += 1;
        let gain = (at.cost - there.cost) / predicted;
        if gain > 0.0 {
            (x, at) = (next, there);
            damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            damping = damping.max(1e-15);
            raise = 2.0;
        } else {
            damping *= raise;
            raise *= 2.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    Solution { x, at, converged: false, linearisations }
}

fn damped_step(at: &Linearised, damping: f64) -> Option<DVector<f64>> {
    let mut matrix = at.information.clone();
    for index in 0..matrix.nrows() {
        matrix[(index, index)] *= 1.0 + damping;
    }
    let step = matrix.cholesky()?.solve(&at.gradient);
    step.iter().all(|value| value.is_finite()).then_some(step)
}

/// What the linear model promises: 2 δᵀg − δᵀHδ.
fn predicted_decrease(at: &Linearised, step: &DVector<f64>) -> f64 {
    2.0 * step.dot(&at.gradient) - step.dot(&(&at.information * step))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as residuals 10(y − x²) and 1 − x; the minimum is at (1, 1).
    struct Valley;

    impl Problem for Valley {
        fn linearise(&self, x: &DVector<f64>) -> Linearised {
            let residuals = DVector::from(vec![10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]]);
            let jacobian = DMatrix::from_row_slice(2, 2, &[-20.0 * x[0], 10.0, -1.0, 0.0]);
            Linearised {
                cost: residuals.norm_squared(),
                gradient: -&jacobian.transpose() * &residuals,
                information: jacobian.transpose() * jacobian,
            }
        }
    }

    #[test]
    fn rosenbrocks_valley_is_followed_to_its_end() {
        let solution = minimise(&Valley, DVector::from(vec![-1.2, 1.0]), &Stop::default());
        assert!((solution.x[0] - 1.0).abs() < 1e-6 && (solution.x[1] - 1.0).abs() < 1e-6, "{}", solution.x);
    }

    #[test]
    fn a_search_cut_short_says_so() {
        let stop = Stop { linearisations: 3, ..Stop::default() };
        assert!(!minimise(&Valley, DVector::from(vec![-1.2, 1.0]), &stop).converged);
    }

    /// Where residuals do not depend on a parameter, H is singular and no step exists: the search ends.
    #[test]
    fn a_parameter_without_influence_ends_the_search() {
        struct Blind;
        impl Problem for Blind {
            fn linearise(&self, _: &DVector<f64>) -> Linearised {
                Linearised {
                    cost: 1.0,
                    gradient: DVector::from(vec![0.0]),
                    information: DMatrix::zeros(1, 1),
                }
            }
        }
        assert!(!minimise(&Blind, DVector::from(vec![0.0]), &Stop::default()).converged);
    }
}
