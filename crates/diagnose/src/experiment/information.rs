//! What a run is expected to tell, from the normal equations alone.
//!
//! With the products G of the columns over the runs at hand and ΔG over the proposed one, a cause A of the size β that
//! the data give it would add ΔG β to XᵀΣ⁻¹r and βᵀΔGβ to rᵀΣ⁻¹r. The evidence of A and of its rival B is taken of the sums;
//! with all other parameters free, half the squared length of what B cannot imitate is what their ln p differ by.
//! Source: Lindley, *Ann. Math. Statist.* 27 (1956), and Box and Hill, *Technometrics* 9 (1967), on choosing experiments
//! between models; the evidence is that of the search.

use crate::balances::gram::{Estimate, Reduced};
use crate::proof::refine::HALF_95;
use nalgebra::{DMatrix, DVector};

/// What is known of two causes, and would be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odds {
    /// ln p of the one less ln p of the other, on the runs at hand.
    pub now: f64,
    /// By how much this would grow with the proposed run, were it the one.
    pub if_one: f64,
    /// By how much it would fall, were it the other.
    pub if_other: f64,
}

impl Odds {
    /// What the proposed run brings in the worse case, ln p of the true cause over that of the other after it.
    ///
    /// `now` is what the runs at hand give, for the one.
    pub fn expected(&self, now: f64) -> f64 {
        (now + self.if_one).min(self.if_other - now)
    }
}

/// Which columns are what.
pub struct Sides<'a> {
    /// Columns that either has.
    pub common: &'a [usize],
    /// Columns of the one.
    pub one: &'a [usize],
    /// Columns of the other.
    pub other: &'a [usize],
    /// Prior standard deviations of all.
    pub sd: &'a [f64],
}

/// The runs at hand and a further one as they look with noise of one kind.
#[derive(Clone, Copy)]
pub struct World<'a> {
    /// Products over the runs at hand.
    pub now: &'a Reduced,
    /// Over the further run; its scalar is the square that the noise alone is expected to have.
    pub more: &'a Reduced,
}

/// The odds between two causes, now and with a further run.
///
/// The first world has the noise that was found. The others have more of it: a cause that fails to explain a run can put
/// the blame on an unsteady world, so each cause is judged in the world that is kindest to it.
pub fn odds(worlds: &[World], sides: &Sides) -> Option<Odds> {
    let with = |own: &[usize]| -> Vec<usize> { sides.common.iter().chain(own).copied().collect() };
    let (one, other) = (with(sides.one), with(sides.other));
    let difference = |problem: &dyn Fn(&World) -> Reduced| {
        let evidence = |used: &[usize]| {
            let in_world = |world| Some(problem(world).estimate(used, sides.sd)?.log_evidence);
            worlds.iter().filter_map(in_world).reduce(f64::max)
        };
        Some(evidence(&one)? - evidence(&other)?)
    };
    let here = difference(&|world| world.now.clone())?;
    let after = |used: &[usize]| {
        let first = worlds.first()?.now;
        let estimate = first.estimate(used, sides.sd)?;
        let mut truth = DVector::zeros(first.vector.len());
        for (value, column) in estimate.beta.iter().zip(used) {
            truth[*column] = *value;
        }
        difference(&|World { now, more }| {
            let said = &more.matrix * &truth;
            Reduced {
                matrix: &now.matrix + &more.matrix,
                scalar: now.scalar + truth.dot(&said) + more.scalar,
                vector: &now.vector + said,
                log_determinant: now.log_determinant + more.log_determinant,
                rows: now.rows + more.rows,
            }
        })
    };
    Some(Odds { now: here, if_one: after(&one)? - here, if_other: here - after(&other)? })
}

/// By which factor the standard deviation of a cause's size falls with a further run. The last `own` of the columns are the
/// cause's; its size is told in the direction in which they were found.
pub fn narrowing(now: &Reduced, more: &DMatrix<f64>, used: &[usize], own: usize, sd: &[f64]) -> Option<f64> {
    let (_, along, before) = size(now, used, own, sd)?;
    let after = Reduced { matrix: &now.matrix + more, ..now.clone() }.estimate(used, sd)?;
    Some((before / variance(&after, &along)).sqrt())
}

/// Half the 95 % interval of a cause's size, over the size.
pub fn known(now: &Reduced, used: &[usize], own: usize, sd: &[f64]) -> Option<f64> {
    let (size, _, variance) = size(now, used, own, sd)?;
    Some(HALF_95 * variance.sqrt() / size).filter(|share| share.is_finite())
}

/// Size, direction and variance along it.
fn size(now: &Reduced, used: &[usize], own: usize, sd: &[f64]) -> Option<(f64, DVector<f64>, f64)> {
    let estimate = now.estimate(used, sd)?;
    let beta = estimate.beta.rows(used.len() - own, own).into_owned();
    let size = beta.norm();
    let along = beta / size;
    let variance = variance(&estimate, &along);
    Some((size, along, variance))
}

fn variance(estimate: &Estimate, along: &DVector<f64>) -> f64 {
    let first = estimate.beta.len() - along.len();
    let covariance = estimate.covariance.view((first, first), (along.len(), along.len()));
    (along.transpose() * covariance * along)[(0, 0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Products of two columns and a residual over rows of unit noise.
    fn reduced(rows: &[[f64; 3]]) -> Reduced {
        let sum = |one: usize, other: usize| rows.iter().map(|row| row[one] * row[other]).sum::<f64>();
        Reduced {
            matrix: DMatrix::from_fn(2, 2, sum),
            vector: DVector::from_fn(2, |row, _| sum(row, 2)),
            scalar: sum(2, 2),
            log_determinant: 0.0,
            rows: rows.len(),
        }
    }

    const SIDES: Sides = Sides { common: &[], one: &[0], other: &[1], sd: &[1e3, 1e3] };

    /// Two columns that are the same at hand and opposite in the further run: of 2 in each of four rows the other cause
    /// can explain nothing on eight rows, so half of 8 · 2² is left; the share that the prior takes is the same for both.
    #[test]
    fn a_run_that_turns_one_column_around_brings_half_the_squared_length() {
        let now = reduced(&[[1.0, 1.0, 2.0]; 4]);
        let more = reduced(&[[1.0, -1.0, 0.0]; 4]);
        let odds = odds(&[World { now: &now, more: &more }], &SIDES).unwrap();
        assert!(odds.now.abs() < 1e-9 && (odds.if_one - 16.0).abs() < 1e-3, "{odds:?}");
        assert!((odds.if_other - 16.0).abs() < 1e-3 && (odds.expected(0.5) - 15.5).abs() < 1e-3);
    }

    #[test]
    fn a_run_in_which_both_columns_stay_the_same_brings_nothing() {
        let now = reduced(&[[1.0, 1.0, 2.0]; 4]);
        let odds = odds(&[World { now: &now, more: &now }], &SIDES).unwrap();
        assert!(odds.if_one.abs() < 1e-9 && odds.if_other.abs() < 1e-9);
    }

    /// With a variance of 4 in place of 1, ln p of 8 rows falls by 4 ln 4 and rises by 3/8 of the square that was not
    /// explained: of 32 for the wrong cause, and of the square 8 of the noise alone.
    #[test]
    fn a_wrong_cause_puts_the_blame_on_the_noise() {
        let scaled = |products: &Reduced, noise: f64| Reduced {
            matrix: &products.matrix / 4.0,
            vector: &products.vector / 4.0,
            scalar: (products.scalar + noise) / 4.0,
            log_determinant: products.rows as f64 * 4f64.ln(),
            rows: products.rows,
        };
        let now = reduced(&[[1.0, 1.0, 10.0]; 4]);
        let more = reduced(&[[1.0, -1.0, 0.0]; 4]);
        let (now_4, more_4) = (scaled(&now, 4.0), scaled(&more, 4.0));
        let (now, more) = (Reduced { scalar: now.scalar + 4.0, ..now }, Reduced { scalar: 4.0, ..more });
        let plain = odds(&[World { now: &now, more: &more }], &SIDES).unwrap();
        let worlds = [World { now: &now, more: &more }, World { now: &now_4, more: &more_4 }];
        let kind = odds(&worlds, &SIDES).unwrap();
        assert!((plain.if_one - 400.0).abs() < 1e-2, "{plain:?}");
        // What is left is 8 · 10² + 8, of which the noise takes three quarters away; it costs 4 ln 4, less what a parameter
        // gains that is known half as well.
        let expected = 400.0 - (0.375 * 808.0 - 4.0 * 4f64.ln() + 0.5 * 4f64.ln());
        assert!((kind.if_one - expected).abs() < 0.1, "{kind:?} against {expected}");
    }

    /// Four times the rows halve the standard deviation.
    #[test]
    fn three_more_runs_of_the_same_halve_an_interval() {
        let now = reduced(&[[1.0, 0.0, 2.0]; 4]);
        let more = 3.0 * &now.matrix;
        assert!((narrowing(&now, &more, &[0], 1, &[1e6, 1.0]).unwrap() - 2.0).abs() < 1e-6);
        // Four rows of 2 with noise of 1: a standard deviation of ½ on 2.
        assert!((known(&now, &[0], 1, &[1e6, 1.0]).unwrap() - 1.96 * 0.25).abs() < 1e-6);
    }
}
