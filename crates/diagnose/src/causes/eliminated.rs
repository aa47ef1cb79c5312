//! A function eliminated: what the rows say of its knots, path by path or run by run, with what is known of it beforehand.
//!
//! The products are gathered once for as long as noise and knots stay; the factor of their sum with the prior's precision is made
//! once for all that is asked of it.

use crate::balances::gram::{Reduced, Whitened, right_side};
use crate::balances::rows::Chunk;
use crate::causes::band::{Band, Factor};
use crate::causes::jumps::squares;
use crate::causes::profile::{
    Function, Group, Profile, Spread, Widths, forgetting, innovation, log_precision, precision_entries,
};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// The products of the knots of one path or run.
#[derive(Clone)]
struct Products {
    /// Among themselves.
    matrix: Band,
    /// With the other columns, the residual last.
    cross: DMatrix<f64>,
}

/// What rows say of a function.
pub struct Gathered {
    groups: Vec<Group>,
    /// None where no row is of the group.
    products: Vec<Option<Products>>,
}

/// The same with what was known before.
pub struct Solved {
    groups: Vec<Group>,
    spread: Spread,
    of_groups: Vec<Option<OfGroup>>,
}

struct OfGroup {
    factor: Factor,
    cross: DMatrix<f64>,
    log_prior: f64,
}

impl Profile<'_> {
    /// The products over the runs that are `fit`.
    pub fn gathered(&self, whitened: &Whitened, chunks: &[Chunk], fit: &[bool], spread: &Spread) -> Gathered {
        let groups = self.groups(spread);
        let of_group = |(number, group)| self.products(whitened, chunks, fit, (number, group));
        let products = groups.par_iter().enumerate().map(of_group).collect();
        Gathered { groups, products }
    }

    fn products(
        &self,
        whitened: &Whitened,
        chunks: &[Chunk],
        fit: &[bool],
        (number, group): (usize, &Group),
    ) -> Option<Products> {
        let width = whitened.width();
        let own: Vec<usize> = (0..chunks.len())
            .filter(|index| fit[chunks[*index].run] && self.group_of[chunks[*index].run] == number)
            // Balances that the cause does not touch say nothing of it.
            .filter(|index| self.touches(*index))
            .collect();
        // Whitened rows know all knots of their chunk, so the widest chunk makes the band; the prior knows neighbours.
        let reach =
            own.iter().map(|index| self.touched(*index, group)).map(|(low, high)| high - low).max()?;
        let mut matrix = Band::zeros(group.count, reach.max(1));
        let mut cross = DMatrix::zeros(group.count, width + 1);
        for index in own {
            let (first, mut basis) = self.basis(index, &chunks[index], group);
            whitened.whiteners.whiten(index, &chunks[index], &mut basis);
            let transposed = basis.transpose();
            matrix.add_block(first, &(&transposed * &basis));
            let mut view = cross.view_mut((first, 0), (basis.ncols(), width + 1));
            view.gemm(1.0, &transposed, &whitened.chunks[index], 1.0);
        }
        Some(Products { matrix, cross })
    }
}

impl Gathered {
    /// With the prior of a spread that has the same knots; none where the sum is not positive definite.
    pub fn solved(&self, spread: &Spread) -> Option<Solved> {
        let of_group = |((number, group), products): ((usize, &Group), &Option<Products>)| {
            let Some(Products { mut matrix, cross }) = products.clone() else { return Ok(None) };
            for (row, column, value) in precision_entries(number, group, spread) {
                matrix.add(row, column, value);
            }
            let factor = matrix.cholesky().ok_or(())?;
            Ok(Some(OfGroup { factor, cross, log_prior: log_precision(number, group, spread) }))
        };
        let all: Result<_, ()> =
            self.groups.par_iter().enumerate().zip(&self.products).map(of_group).collect();
        Some(Solved { groups: self.groups.clone(), spread: spread.clone(), of_groups: all.ok()? })
    }
}

impl Solved {
    /// Eliminates the function from products that were made already. Functions that are eliminated one after the other
    /// must act on different rows; others are eliminated [`crate::causes::abreast`].
    pub fn take(&self, reduced: &mut Reduced) {
        let taken = |OfGroup { factor, cross, log_prior }: &OfGroup| {
            let mut half = cross.clone();
            factor.half_solve(&mut half);
            (half.transpose() * &half, factor.log_determinant() - log_prior)
        };
        let all: Vec<_> = self.of_groups.par_iter().flatten_iter().map(taken).collect();
        for (taken, log) in all {
            reduced.take(&taken, log);
        }
    }

    /// The function itself, once the other columns have the values `beta`.
    pub fn function(&self, beta: &DVector<f64>, widths: Widths) -> Function {
        let spread = &self.spread;
        let of_group = |(group, own): (&Group, &Option<OfGroup>)| {
            let Some(OfGroup { factor, cross, .. }) = own else {
                let size = DVector::from_element(group.count, spread.size);
                return ((DVector::zeros(group.count), size), vec![1.0; group.count - 1]);
            };
            let values = factor.solve(&right_side(cross, beta));
            if widths == Widths::Left && spread.jumps.is_none() {
                let unknown = DVector::from_element(group.count, f64::NAN);
                return ((values, unknown), Vec::new());
            }
            let usual = innovation(group, spread);
            let (own, beside) = factor.inverse_diagonals();
            let squares = squares(&own, &beside, &values, forgetting(group, spread));
            let squares = squares.into_iter().map(|square| square / usual).collect();
            ((values, own.map(f64::sqrt)), squares)
        };
        let (values, squares) = self.groups.par_iter().zip(&self.of_groups).map(of_group).unzip();
        Function { values, groups: self.groups.clone(), spread: spread.clone(), squares }
    }
}
