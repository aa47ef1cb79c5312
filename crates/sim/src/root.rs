//! Where a function of one number that rises at first reaches zero.

/// What a search came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Root {
    /// The root, or where the function comes nearest to it within its bounds.
    pub at: f64,
    /// Whether there is one.
    pub reached: bool,
}

/// Growth of the bracket: a function that flattens is met before it is passed by much.
const REACH: f64 = 1.5;
const MOST_ITERATIONS: usize = 80;
/// Nearer than this two abscissae are one.
const FINEST: f64 = 1e-15;

/// The root nearest to `start` of a function that rises from `lowest` on, perhaps to a peak before `highest`.
///
/// `step` is about how far the root lies; `tolerance` is what the function may miss zero by.
pub(crate) fn rising(
    mut f: impl FnMut(f64) -> f64,
    start: f64,
    step: f64,
    (lowest, highest): (f64, f64),
    tolerance: f64,
) -> Root {
    let mut known = (start, f(start));
    if known.1.abs() <= tolerance || known.1.is_nan() {
        return Root { at: start, reached: true };
    }
    let upward = known.1 < 0.0;
    let mut before = known;
    let mut next = if upward { start + step } else { start - step };
    loop {
        let at = next.clamp(lowest, highest);
        let found = (at, f(at));
        if found.1.is_nan() {
            return Root { at, reached: true };
        }
        if (found.1 >= 0.0) == upward {
            let (low, high) = if upward { (known, found) } else { (found, known) };
            return Root { at: between(&mut f, low, high, tolerance), reached: true };
        }
        if upward && found.1 < known.1 {
            return about_the_peak(&mut f, before, found, tolerance);
        }
        if at == lowest || at == highest {
            return if upward {
                about_the_peak(&mut f, known, found, tolerance)
            } else {
                Root { at, reached: false }
            };
        }
        // As far as the chord points, and a little further; not less than before, and not beyond four times as far.
        let went = at - known.0;
        let chord = found.1 * (at - known.0) / (found.1 - known.1);
        (before, known) = (known, found);
        next = at - (REACH * chord.abs()).clamp(went.abs(), 4.0 * went.abs()).copysign(-went);
    }
}

/// Looks for the peak of a function below zero at both ends, and for the root before it.
fn about_the_peak(f: &mut impl FnMut(f64) -> f64, low: (f64, f64), high: (f64, f64), tolerance: f64) -> Root {
    /// Part of an interval that the golden section keeps.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    /// The peak is flat: to know it by its value takes half of the digits of its place.
    const NEAR: f64 = 1e-8;
    let (mut a, mut b) = (low.0, high.0);
    let (mut c, mut d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut at_c, mut at_d) = (f(c), f(d));
    while b - a > NEAR {
        for (x, value) in [(c, at_c), (d, at_d)] {
            if value >= 0.0 {
                return Root { at: between(f, low, (x, value), tolerance), reached: true };
            }
        }
        if at_c > at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - GOLDEN * (b - a);
            at_c = f(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + GOLDEN * (b - a);
            at_d = f(d);
        }
    }
    let peak = 0.5 * (a + b);
    let at = if high.1 >= f(peak) { high.0 } else { peak };
    Root { at, reached: false }
}

/// The root between a value below zero and one at or above it.
///
/// Source: Chandrupatla, "A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear function without
/// using derivatives", Advances in Engineering Software 28 (1997), 145-149.
fn between(f: &mut impl FnMut(f64) -> f64, low: (f64, f64), high: (f64, f64), tolerance: f64) -> f64 {
    let ((mut b, mut fb), (mut a, mut fa)) = (low, high);
    let (mut c, mut fc);
    let mut share = 0.5;
    for _ in 0..MOST_ITERATIONS {
        let x = a + share * (b - a);
        let value = f(x);
        if (value >= 0.0) == (fa >= 0.0) {
            (c, fc) = (a, fa);
        } else {
            (c, fc, b, fb) = (b, fb, a, fa);
        }
        (a, fa) = (x, value);
        let (best, at_best) = if fa.abs() < fb.abs() { (a, fa) } else { (b, fb) };
        if at_best.abs() <= tolerance || (b - a).abs() <= FINEST {
            return best;
        }
        let (xi, phi) = ((a - b) / (c - b), (fa - fb) / (fc - fb));
        share = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        } else {
            0.5
        };
        let least = 0.5 * FINEST / (b - a).abs();
        share = share.clamp(least, 1.0 - least);
    }
    if fa.abs() < fb.abs() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: (f64, f64) = (-0.9, 0.9);

    #[test]
    fn roots_on_either_side_of_the_start_are_found_with_few_calls() {
        for (target, root) in [(0.5, -(0.5f64).ln_1p() / -1.0), (-0.4, (0.6f64).ln())] {
            // 1 − e^(−x) meets 1 − e^(−root).
            let goal = -(-root).exp_m1();
            let mut calls = 0;
            let f = |x: f64| {
                calls += 1;
                -(-x).exp_m1() - goal
            };
            let found = rising(f, 0.0, 0.02, BOUNDS, 1e-14);
            assert!(found.reached && (found.at - root).abs() < 1e-13, "{target}: {found:?} {root}");
            assert!(calls < 16, "{calls}");
        }
    }

    /// x (1 − x) has its peak of 0.25 at 0.5.
    #[test]
    fn the_root_before_a_peak_is_found_and_a_goal_above_it_is_not_reached() {
        let just = rising(|x| x * (1.0 - x) - 0.249_999, 0.0, 0.02, BOUNDS, 1e-15);
        assert!(just.reached && (just.at - 0.499).abs() < 1e-9, "{just:?}");
        let above = rising(|x| x * (1.0 - x) - 0.250_001, 0.0, 0.02, BOUNDS, 1e-15);
        assert!(!above.reached && (above.at - 0.5).abs() < 1e-6, "{above:?}");
    }

    #[test]
    fn a_goal_beyond_the_bounds_ends_at_them() {
        assert_eq!(rising(|x| x - 2.0, 0.0, 0.02, BOUNDS, 1e-15), Root { at: 0.9, reached: false });
        assert_eq!(rising(|x| x + 2.0, 0.0, 0.02, BOUNDS, 1e-15), Root { at: -0.9, reached: false });
    }

    #[test]
    fn what_is_no_number_ends_the_search() {
        assert!(rising(|_| f64::NAN, 0.1, 0.02, BOUNDS, 1e-15).reached);
    }
}
