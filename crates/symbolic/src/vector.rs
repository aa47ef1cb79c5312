//! Columns of numbers: products, and what is left of one beside others.

/// Scalar product.
pub(crate) fn dot(one: &[f64], other: &[f64]) -> f64 {
    // Four sums at once: a fixed order that the processor can overlap.
    let mut sums = [0.0; 4];
    let (ones, others) = (one.chunks_exact(4), other.chunks_exact(4));
    let rest: f64 = ones.remainder().iter().zip(others.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in ones.zip(others) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// Adds so much of another column.
pub(crate) fn add(column: &mut [f64], share: f64, other: &[f64]) {
    for (value, other) in column.iter_mut().zip(other) {
        *value += share * other;
    }
}

/// Multiplies by another column, value by value.
pub(crate) fn times(column: &mut [f64], other: &[f64]) {
    for (value, other) in column.iter_mut().zip(other) {
        *value *= other;
    }
}

/// Takes out of a column what orthonormal ones hold of it.
pub(crate) fn take_out(column: &mut [f64], basis: &[Vec<f64>]) {
    for q in basis {
        let share = dot(q, column);
        add(column, -share, q);
    }
}

/// Makes a column as long as 1; tells how long it was, and leaves one of no length as it is.
pub(crate) fn normalise(column: &mut [f64]) -> f64 {
    let size = dot(column, column).sqrt();
    if size > 0.0 && size.is_finite() {
        for value in column {
            *value /= size;
        }
    }
    size
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3, 4 beside the first axis is 0, 4; made as long as 1 it is the second axis.
    #[test]
    fn what_is_left_beside_an_axis_is_the_other() {
        let mut column = vec![3.0, 4.0];
        take_out(&mut column, &[vec![1.0, 0.0]]);
        assert_eq!(normalise(&mut column), 4.0);
        assert_eq!(column, [0.0, 1.0]);
        let long: Vec<f64> = (1..=7).map(f64::from).collect();
        assert_eq!(dot(&long, &long), 140.0);
    }
}
