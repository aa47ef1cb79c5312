//! Gauss-Legendre quadrature.
//!
//! Source: Abramowitz and Stegun, *Handbook of Mathematical Functions* (1964), 25.4.29; nodes by Newton's method on the
//! recurrence of the polynomials (22.7.10).

/// Nodes between 0 and 1, and their weights, which add up to 1.
pub fn nodes(count: usize) -> Vec<(f64, f64)> {
    (0..count).map(|index| node(count, index)).collect()
}

fn node(count: usize, index: usize) -> (f64, f64) {
    /// Newton's method doubles the digits; it begins with two.
    const MOST_ITERATIONS: usize = 8;
    let n = count as f64;
    let mut x = (std::f64::consts::PI * (index as f64 + 0.75) / (n + 0.5)).cos();
    for _ in 0..MOST_ITERATIONS {
        let (value, slope) = legendre(count, x);
        x -= value / slope;
    }
    let (_, slope) = legendre(count, x);
    (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
}

/// The polynomial of degree `count` and its slope.
fn legendre(count: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for degree in 2..=count {
        let k = degree as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    (value, count as f64 * (x * value - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::nodes;

    /// Two nodes lie at ½ ∓ ½/√3 and weigh the same.
    #[test]
    fn two_nodes_are_those_of_the_tables() {
        let two = nodes(2);
        assert!((two[0].0 - (0.5 - 0.5 / 3f64.sqrt())).abs() < 1e-15 && (two[1].1 - 0.5).abs() < 1e-15);
    }

    /// Twelve nodes integrate polynomials up to degree 23.
    #[test]
    fn polynomials_are_integrated_exactly() {
        for degree in [0, 1, 7, 22, 23] {
            let sum: f64 = nodes(12).iter().map(|(x, weight)| weight * x.powi(degree)).sum();
            assert!((sum * f64::from(degree + 1) - 1.0).abs() < 1e-13, "{degree}: {sum}");
        }
        let coarse: f64 = nodes(12).iter().map(|(x, weight)| weight * x.powi(24)).sum();
        assert!((coarse * 25.0 - 1.0).abs() > 1e-14);
    }
}
