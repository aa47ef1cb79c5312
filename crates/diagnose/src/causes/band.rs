//! Symmetric matrices whose entries lie in a band beside the diagonal: their Cholesky factor keeps the band, so that
//! thousands of unknowns cost no more than their neighbours.
//!
//! The diagonal of the inverse follows from the factor alone, without the inverse.
//! Source: Golub and Van Loan, *Matrix Computations* (2013), section 4.3; Takahashi, Fagan and Chen, *Proc. 8th PICA
//! Conference* (1973), for the inverse within the band.

use nalgebra::{DMatrix, DVector};

/// A symmetric matrix, its lower half row by row: row i holds the columns i − width ..= i.
#[derive(Clone, Debug)]
pub struct Band {
    size: usize,
    width: usize,
    entries: Vec<f64>,
}

/// Rows and columns that are taken at once where a band is wide.
const BLOCK: usize = 16;

/// The lower Cholesky factor of such a matrix, in the same order.
pub struct Factor(Band);

impl Band {
    /// A matrix of zeros with so many rows and so many entries beside the diagonal.
    pub fn zeros(size: usize, width: usize) -> Self {
        let width = width.min(size.saturating_sub(1));
        Self { size, width, entries: vec![0.0; size * (width + 1)] }
    }

    fn place(&self, row: usize, column: usize) -> usize {
        row * (self.width + 1) + self.width + column - row
    }

    /// Adds to an entry of the lower half, which has to lie in the band.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let place = self.place(row, column);
        self.entries[place] += value;
    }

    /// Adds a square block whose first row and column is `first`; its upper half is not looked at.
    pub fn add_block(&mut self, first: usize, block: &DMatrix<f64>) {
        for row in 0..block.nrows() {
            for column in 0..=row {
                self.add(first + row, first + column, block[(row, column)]);
            }
        }
    }

    /// Adds a block whose first row and column are these, all of it left of the diagonal.
    pub fn add_beside(&mut self, first_row: usize, first_column: usize, block: &DMatrix<f64>) {
        for row in 0..block.nrows() {
            for column in 0..block.ncols() {
                self.add(first_row + row, first_column + column, block[(row, column)]);
            }
        }
    }

    /// Entries `from..to` of a row, which lie in the band and not above the diagonal.
    fn row(&self, row: usize, from: usize, to: usize) -> &[f64] {
        &self.entries[self.place(row, from)..self.place(row, to)]
    }

    fn first(&self, row: usize) -> usize {
        row.saturating_sub(self.width)
    }

    /// Its factor; none where it is not positive definite.
    pub fn cholesky(self) -> Option<Factor> {
        if self.is_wide() { self.by_blocks() } else { self.by_entries() }
    }

    /// Whether blocks are faster than entries.
    fn is_wide(&self) -> bool {
        self.width > 2 * BLOCK
    }

    fn by_entries(mut self) -> Option<Factor> {
        for row in 0..self.size {
            for column in self.first(row)..=row {
                let from = self.first(row).max(self.first(column));
                let sum = dot(self.row(row, from, column), self.row(column, from, column));
                let place = self.place(row, column);
                let left = self.entries[place] - sum;
                self.entries[place] = if row == column {
                    if left <= 0.0 || !left.is_finite() {
                        return None;
                    }
                    left.sqrt()
                } else {
                    left / self.entries[self.place(column, column)]
                };
            }
        }
        Some(Factor(self))
    }

    /// The same in blocks, of which all but the diagonal ones take products of matrices alone.
    fn by_blocks(mut self) -> Option<Factor> {
        let mut done: Vec<BlockRow> = Vec::with_capacity(self.size.div_ceil(BLOCK));
        for begin in (0..self.size).step_by(BLOCK) {
            let end = (begin + BLOCK).min(self.size);
            let first = self.first(begin) / BLOCK * BLOCK;
            let mut own = DMatrix::zeros(end - begin, end - first);
            for row in begin..end {
                for column in self.first(row)..=row {
                    own[(row - begin, column - first)] = self.entries[self.place(row, column)];
                }
            }
            for other in &done[first / BLOCK..] {
                let known = other.begin - first;
                let (left, mut target) =
                    own.columns_range_pair_mut(..known, known..known + other.inverse_transposed.nrows());
                if known > 0 {
                    let beside = other.factor.columns(first - other.first, known).transpose();
                    target.gemm(-1.0, &left, &beside, 1.0);
                }
                let solved = &target * &other.inverse_transposed;
                target.copy_from(&solved);
            }
            let known = begin - first;
            let (left, mut target) = own.columns_range_pair_mut(..known, known..);
            if known > 0 {
                target.gemm(-1.0, &left, &left.transpose(), 1.0);
            }
            let lower = target.clone_owned().cholesky()?.unpack();
            if !lower.diagonal().iter().all(|pivot| pivot.is_finite()) {
                return None;
            }
            target.copy_from(&lower);
            let inverse = lower.solve_lower_triangular(&DMatrix::identity(end - begin, end - begin))?;
            for row in begin..end {
                for column in self.first(row)..=row {
                    let place = self.place(row, column);
                    self.entries[place] = own[(row - begin, column - first)];
                }
            }
            done.push(BlockRow { begin, first, factor: own, inverse_transposed: inverse.transpose() });
        }
        Some(Factor(self))
    }
}

/// Some rows of a factor.
struct BlockRow {
    /// The first of them.
    begin: usize,
    /// The column that they begin with.
    first: usize,
    factor: DMatrix<f64>,
    /// Of their square on the diagonal.
    inverse_transposed: DMatrix<f64>,
}

impl Factor {
    fn diagonal(&self, row: usize) -> f64 {
        self.0.entries[self.0.place(row, row)]
    }

    /// ln of the determinant of the matrix.
    pub fn log_determinant(&self) -> f64 {
        2.0 * (0..self.0.size).map(|row| self.diagonal(row).ln()).sum::<f64>()
    }

    /// Solves L x = b for every column of `right`, in place.
    pub fn half_solve(&self, right: &mut DMatrix<f64>) {
        for mut column in right.column_iter_mut() {
            let values = column.as_mut_slice();
            for row in 0..self.0.size {
                let from = self.0.first(row);
                let sum = dot(self.0.row(row, from, row), &values[from..row]);
                values[row] = (values[row] - sum) / self.diagonal(row);
            }
        }
    }

    /// Solves for one right side.
    pub fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut solved = DMatrix::from_column_slice(right.len(), 1, right.as_slice());
        self.half_solve(&mut solved);
        let values = solved.as_mut_slice();
        for row in (0..self.0.size).rev() {
            values[row] /= self.diagonal(row);
            let value = values[row];
            let from = self.0.first(row);
            for (left, factor) in values[from..row].iter_mut().zip(self.0.row(row, from, row)) {
                *left -= factor * value;
            }
        }
        DVector::from_column_slice(values)
    }

    /// The diagonal of the inverse, and what stands to the left of it; of the first row nothing does.
    pub fn inverse_diagonals(&self) -> (DVector<f64>, DVector<f64>) {
        if self.0.is_wide() {
            self.inverse_diagonals_by_blocks()
        } else {
            self.inverse_diagonals_by_entries()
        }
    }

    /// The rows of the factor from `row` and its columns from `column`.
    fn part(&self, (row, rows): (usize, usize), (column, columns): (usize, usize)) -> DMatrix<f64> {
        let Self(factor) = self;
        DMatrix::from_fn(rows, columns, |one, other| {
            let (row, column) = (row + one, column + other);
            let held = column <= row && column >= factor.first(row);
            if held { factor.entries[factor.place(row, column)] } else { 0.0 }
        })
    }

    /// In blocks from the last up: with G = L_below L_own⁻¹, Z beside is −Z_below G and Z of its own L_own⁻ᵀ L_own⁻¹ − Gᵀ Z beside.
    /// Of the inverse only what a band reaches below a block is kept.
    fn inverse_diagonals_by_blocks(&self) -> (DVector<f64>, DVector<f64>) {
        let Band { size, width, .. } = self.0;
        let (mut own, mut beside) = (DVector::zeros(size), DVector::zeros(size));
        let mut below = DMatrix::zeros(0, 0);
        for begin in (0..size).step_by(BLOCK).rev() {
            let count = BLOCK.min(size - begin);
            let end = begin + count;
            let reach = width.min(size - end);
            let mut inverse = DMatrix::identity(count, count);
            // A factor's diagonal is positive.
            self.part((begin, count), (begin, count)).solve_lower_triangular_mut(&mut inverse);
            let g = self.part((end, reach), (begin, count)) * &inverse;
            let mut all = DMatrix::zeros(count + reach, count + reach);
            let mut part = all.view_mut((count, count), (reach, reach));
            part.copy_from(&below.view((0, 0), (reach, reach)));
            let left = -(&part * &g);
            all.view_mut((0, 0), (count, count))
                .copy_from(&(inverse.transpose() * &inverse - g.transpose() * &left));
            all.view_mut((0, count), (count, reach)).copy_from(&left.transpose());
            all.view_mut((count, 0), (reach, count)).copy_from(&left);
            for row in 0..count {
                own[begin + row] = all[(row, row)];
            }
            for row in 1..(count + 1).min(all.nrows()) {
                beside[begin + row] = all[(row, row - 1)];
            }
            below = all;
        }
        (own, beside)
    }

    fn inverse_diagonals_by_entries(&self) -> (DVector<f64>, DVector<f64>) {
        let Self(factor) = self;
        // Z = D⁻¹ + (I − Lᵀ/d) Z within the band, from the last row up. Both halves are kept, so that rows lie in one piece:
        // row i holds the columns i − width ..= i + width.
        let width = factor.width;
        let place = |row: usize, column: usize| row * (2 * width + 1) + width + column - row;
        let mut inverse = vec![0.0; factor.size * (2 * width + 1)];
        let mut below = vec![0.0; width];
        for column in (0..factor.size).rev() {
            let last = (column + factor.width).min(factor.size - 1);
            let own = self.diagonal(column);
            for (entry, row) in below.iter_mut().zip(column + 1..=last) {
                *entry = factor.entries[factor.place(row, column)];
            }
            let below = &below[..last - column];
            for row in (column..=last).rev() {
                let first = place(row, column + 1);
                let sum = dot(below, &inverse[first..first + below.len()]);
                let lone = if row == column { own.recip() } else { 0.0 };
                let value = (lone - sum) / own;
                inverse[place(row, column)] = value;
                inverse[place(column, row)] = value;
            }
        }
        let own = DVector::from_fn(factor.size, |row, _| inverse[place(row, row)]);
        let beside = |row: usize| if row == 0 || width == 0 { 0.0 } else { inverse[place(row, row - 1)] };
        (own, DVector::from_fn(factor.size, |row, _| beside(row)))
    }
}

/// Product of two slices in sixteen sums, which is the same bits everywhere and keeps the processor's lanes busy: a sum waits
/// for the one before it, others do not.
#[inline]
fn dot(one: &[f64], other: &[f64]) -> f64 {
    const LANES: usize = 16;
    let (left, left_rest) = one.as_chunks::<LANES>();
    let (right, right_rest) = other.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in left.iter().zip(right) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let mut rest = 0.0;
    for (a, b) in left_rest.iter().zip(right_rest) {
        rest += a * b;
    }
    for half in [8, 4, 2, 1] {
        for lane in 0..half {
            sums[lane] += sums[lane + half];
        }
    }
    sums[0] + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nine unknowns with neighbours up to three apart, and the same as a full matrix.
    fn example() -> (Band, DMatrix<f64>) {
        let (size, width) = (9, 3);
        let mut band = Band::zeros(size, width);
        let mut full = DMatrix::zeros(size, size);
        for row in 0..size {
            for column in row.saturating_sub(width)..=row {
                let value =
                    if row == column { 5.0 + row as f64 } else { ((row * 7 + column * 3) % 5) as f64 - 1.7 };
                band.add(row, column, value);
                full[(row, column)] = value;
                full[(column, row)] = value;
            }
        }
        (band, full)
    }

    #[test]
    fn it_solves_as_the_full_matrix_does() {
        let (band, full) = example();
        let right = DVector::from_fn(9, |row, _| (row as f64).sin());
        let solved = band.cholesky().unwrap().solve(&right);
        assert!((full * solved - right).norm() < 1e-12);
    }

    #[test]
    fn a_wide_one_has_the_same_factor_by_blocks() {
        for (size, width) in
            [(3 * BLOCK + 5, 2 * BLOCK + 1), (4 * BLOCK, BLOCK + 7), (2 * BLOCK + 1, 2 * BLOCK)]
        {
            let mut band = Band::zeros(size, width);
            for row in 0..size {
                for column in row.saturating_sub(width)..=row {
                    let apart = (row - column) as f64;
                    let own = if row == column { 3.0 + (row % 7) as f64 } else { 0.0 };
                    band.add(row, column, own + (-apart / 40.0).exp() * (0.3 * apart).cos());
                }
            }
            let (one, other) = (band.clone().by_entries().unwrap(), band.clone().by_blocks().unwrap());
            let apart = one.0.entries.iter().zip(&other.0.entries).map(|(one, other)| (one - other).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-12, "{size}, {width}");
            let (own, beside) = one.inverse_diagonals_by_entries();
            let by_blocks = one.inverse_diagonals_by_blocks();
            assert!((own - by_blocks.0).amax() < 1e-12 && (beside - by_blocks.1).amax() < 1e-12);
            band.add(size / 2, size / 2, -50.0);
            assert!(band.clone().by_entries().is_none() && band.by_blocks().is_none());
        }
    }

    #[test]
    fn its_determinant_and_the_diagonals_of_its_inverse_are_those_of_the_full_matrix() {
        let (band, full) = example();
        let factor = band.cholesky().unwrap();
        assert!((factor.log_determinant() - full.determinant().ln()).abs() < 1e-12);
        let inverse = full.try_inverse().unwrap();
        let (own, beside) = factor.inverse_diagonals();
        assert!((own - inverse.diagonal()).norm() < 1e-14);
        assert!((1..9).all(|row| (beside[row] - inverse[(row, row - 1)]).abs() < 1e-14));
    }

    #[test]
    fn a_half_solved_side_has_the_square_of_the_inverse() {
        let (band, full) = example();
        let mut right = DMatrix::from_fn(9, 2, |row, column| (row + 2 * column) as f64 - 3.0);
        let expected = right.transpose() * full.try_inverse().unwrap() * &right;
        band.cholesky().unwrap().half_solve(&mut right);
        assert!((right.transpose() * right - expected).norm() < 1e-10);
    }

    #[test]
    fn blocks_add_up_and_what_is_not_positive_has_no_factor() {
        let mut band = Band::zeros(3, 1);
        band.add_block(0, &DMatrix::from_row_slice(2, 2, &[2.0, 9.0, 1.0, 2.0]));
        band.add_block(1, &DMatrix::from_row_slice(2, 2, &[2.0, 9.0, 1.0, 2.0]));
        let solved = band.clone().cholesky().unwrap().solve(&DVector::from_column_slice(&[3.0, 6.0, 3.0]));
        assert!((solved - DVector::from_element(3, 1.0)).norm() < 1e-12);
        band.add(2, 2, -5.0);
        assert!(band.cholesky().is_none());
    }
}
