//! Dynamic time warping: the pairing of two signals that makes them most alike without running backwards.
//!
//! D(i, j) = (a_i - b_j)² + min(D(i-1, j-1), D(i-1, j), D(i, j-1)),   |i - j| ≤ window
//!
//! Of predecessors that cost the same, the diagonal one is taken, then the one that holds `b`; so equal signals are paired
//! one to one.
//!
//! Source: Sakoe and Chiba, *Dynamic programming algorithm optimization for spoken word recognition*, IEEE Trans. ASSP 26
//! (1978), with unit weights.

/// The step that led to a cell.
#[derive(Clone, Copy)]
enum From {
    Both,
    A,
    B,
}

/// Pairs of indices along the cheapest path from the first samples to the last.
///
/// Empty where either signal is empty, or where the window is narrower than the difference of their lengths. Takes time
/// and memory of the length times the window.
pub fn warping_path(a: &[f64], b: &[f64], window: usize) -> Vec<(usize, usize)> {
    if a.is_empty() || b.is_empty() || a.len().abs_diff(b.len()) > window {
        return Vec::new();
    }
    let mut rows: Vec<(usize, Vec<From>)> = Vec::with_capacity(a.len());
    let mut above = vec![f64::INFINITY; b.len()];
    for (i, value) in a.iter().enumerate() {
        let (first, last) = (i.saturating_sub(window), (i + window).min(b.len() - 1));
        let mut costs = vec![f64::INFINITY; b.len()];
        let mut steps = Vec::with_capacity(last - first + 1);
        for j in first..=last {
            let (mut best, mut step) = match (i, j) {
                (0, 0) => (0.0, From::Both),
                (_, 0) | (0, _) => (f64::INFINITY, From::Both),
                _ => (above[j - 1], From::Both),
            };
            if above[j] < best {
                (best, step) = (above[j], From::A);
            }
            if j > first && costs[j - 1] < best {
                (best, step) = (costs[j - 1], From::B);
            }
            costs[j] = best + (value - b[j]).powi(2);
            steps.push(step);
        }
        rows.push((first, steps));
        above = costs;
    }
    let (mut i, mut j) = (a.len() - 1, b.len() - 1);
    let mut path = vec![(i, j)];
    while (i, j) != (0, 0) {
        match rows[i].1[j - rows[i].0] {
            From::Both => (i, j) = (i - 1, j - 1),
            From::A => i -= 1,
            From::B => j -= 1,
        }
        path.push((i, j));
    }
    path.reverse();
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cost(a: &[f64], b: &[f64], path: &[(usize, usize)]) -> f64 {
        path.iter().map(|(i, j)| (a[*i] - b[*j]).powi(2)).sum()
    }

    /// a = 0, 0, 1, 3 and b = 0, 1, 3, 3: both zeros pair with the zero, and both threes with the three, at no cost.
    #[test]
    fn a_shift_by_one_sample_costs_nothing() {
        let (a, b) = ([0.0, 0.0, 1.0, 3.0], [0.0, 1.0, 3.0, 3.0]);
        assert_eq!(warping_path(&a, &b, 1), [(0, 0), (1, 0), (2, 1), (3, 2), (3, 3)]);
    }

    /// Without a window the pairs are one to one: 0 + 1 + 4 + 0.
    #[test]
    fn a_window_of_zero_is_the_plain_pairing() {
        let (a, b) = ([0.0, 0.0, 1.0, 3.0], [0.0, 1.0, 3.0, 3.0]);
        let path = warping_path(&a, &b, 0);
        assert_eq!(path, [(0, 0), (1, 1), (2, 2), (3, 3)]);
        assert_eq!(cost(&a, &b, &path), 5.0);
    }

    #[test]
    fn equal_signals_are_paired_one_to_one() {
        let a = [1.0, 1.0, 2.0, 2.0, 2.0, 0.0];
        assert!(warping_path(&a, &a, 3).iter().all(|(i, j)| i == j));
    }

    #[test]
    fn the_cheapest_of_all_paths_is_found() {
        /// Every path, by recursion.
        fn least(a: &[f64], b: &[f64]) -> f64 {
            let here = (a[a.len() - 1] - b[b.len() - 1]).powi(2);
            let (shorter_a, shorter_b) = (&a[..a.len() - 1], &b[..b.len() - 1]);
            here + match (a.len(), b.len()) {
                (1, 1) => 0.0,
                (1, _) => least(a, shorter_b),
                (_, 1) => least(shorter_a, b),
                _ => least(shorter_a, shorter_b).min(least(a, shorter_b)).min(least(shorter_a, b)),
            }
        }
        let (a, b) = ([0.3, 1.0, -2.0, 0.7, 4.0, 2.0], [0.0, -1.0, 0.5, 3.0, 3.5, 1.0]);
        assert!((cost(&a, &b, &warping_path(&a, &b, 6)) - least(&a, &b)).abs() < 1e-12);
    }

    #[test]
    fn nothing_and_a_window_too_narrow_have_no_path() {
        assert!(warping_path(&[], &[1.0], 3).is_empty());
        assert!(warping_path(&[1.0; 5], &[1.0; 2], 2).is_empty());
        assert_eq!(warping_path(&[1.0; 2], &[1.0; 3], 1).len(), 3);
    }
}
