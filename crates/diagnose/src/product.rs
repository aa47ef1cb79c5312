//! Products of tall matrices with their likes, of which none is turned over in memory first.

use nalgebra::{DMatrix, DMatrixView, Dyn, MatrixView};

/// Aᵀ B, of two matrices with as many rows.
pub fn turned_times(left: &DMatrix<f64>, right: &DMatrix<f64>) -> DMatrix<f64> {
    let mut product = DMatrix::zeros(left.ncols(), right.ncols());
    product.gemm(1.0, &turned(left), right, 0.0);
    product
}

/// A matrix read along its columns, so that they are rows.
fn turned(matrix: &DMatrix<f64>) -> MatrixView<'_, f64, Dyn, Dyn, Dyn, Dyn> {
    let (rows, columns) = matrix.shape();
    DMatrixView::from_slice_with_strides(matrix.as_slice(), columns, rows, rows, 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_product_is_that_of_the_matrix_turned_over() {
        for (rows, columns, others) in [(7, 3, 2), (300, 12, 31), (1, 9, 9), (4, 0, 3), (0, 3, 3)] {
            let entry = |row: usize, column: usize| ((row * 31 + column * 17) % 23) as f64 - 11.0;
            let left = DMatrix::from_fn(rows, columns, entry);
            let right = DMatrix::from_fn(rows, others, |row, column| entry(column, row + 5));
            assert_eq!(turned_times(&left, &right), left.transpose() * &right);
        }
    }
}
