//! Interpolation of elevation whose slope has no steps and that makes no hills of its own.
//!
//! Source: Fritsch and Carlson, "Monotone piecewise cubic interpolation", SIAM J. Numer. Anal. 17 (1980), 238-246;
//! the tangents start from the mean of the neighbouring secants and are shortened into the circle α² + β² ≤ 9.

/// A monotone cubic Hermite curve.
#[derive(Clone, Debug, Default)]
pub(crate) struct Curve {
    knots: Vec<Knot>,
}

#[derive(Clone, Copy, Debug)]
struct Knot {
    position: f64,
    value: f64,
    slope: f64,
    /// Horizontal distance from the first knot.
    horizontal: f64,
}

/// A point of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub value: f64,
    pub slope: f64,
    /// Horizontal distance from the first knot, where positions count along the curve.
    pub horizontal: f64,
}

impl Curve {
    /// The curve through these points: at least two, at strictly increasing positions.
    pub(crate) fn through(points: &[(f64, f64)]) -> Self {
        let slopes = tangents(points);
        let mut knots: Vec<Knot> = Vec::with_capacity(points.len());
        for (&(position, value), slope) in points.iter().zip(slopes) {
            let mut knot = Knot { position, value, slope, horizontal: 0.0 };
            if let Some(before) = knots.last() {
                knot.horizontal = before.horizontal + horizontal(before, &knot, position);
            }
            knots.push(knot);
        }
        Self { knots }
    }

    /// First and last position.
    pub(crate) fn extent(&self) -> Option<(f64, f64)> {
        Some((self.knots.first()?.position, self.knots.last()?.position))
    }

    /// Where the curve is steepest, and how steep it is there.
    pub(crate) fn steepest(&self) -> Option<(f64, f64)> {
        self.knots
            .windows(2)
            .flat_map(|pair| {
                let (one, two) = (&pair[0], &pair[1]);
                extremes(one, two).map(|position| (position, slope(one, two, position)))
            })
            .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    }

    /// The curve at `position`; beyond its ends it goes on straight.
    pub(crate) fn at(&self, position: f64) -> Point {
        let next = self.knots.partition_point(|knot| knot.position <= position);
        match (next.checked_sub(1).and_then(|index| self.knots.get(index)), self.knots.get(next)) {
            (Some(one), Some(two)) => Point {
                value: value(one, two, position),
                slope: slope(one, two, position),
                horizontal: one.horizontal + horizontal(one, two, position),
            },
            (Some(end), None) | (None, Some(end)) => end.straight_on(position),
            (None, None) => Point { value: 0.0, slope: 0.0, horizontal: position },
        }
    }
}

impl Knot {
    fn straight_on(&self, position: f64) -> Point {
        let (beyond, slope) = (position - self.position, self.slope);
        Point {
            value: self.value + beyond * slope,
            slope,
            horizontal: self.horizontal + beyond * cosine(slope),
        }
    }
}

/// Cosine of a slope whose sine is `slope`.
fn cosine(slope: f64) -> f64 {
    (1.0 - slope * slope).max(0.0).sqrt()
}

fn tangents(points: &[(f64, f64)]) -> Vec<f64> {
    let secants: Vec<f64> =
        points.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).collect();
    let mut slopes = Vec::with_capacity(points.len());
    slopes.extend(secants.first());
    slopes.extend(secants.windows(2).map(|d| if d[0] * d[1] > 0.0 { 0.5 * (d[0] + d[1]) } else { 0.0 }));
    slopes.extend(secants.last());
    for (index, &secant) in secants.iter().enumerate() {
        if secant == 0.0 {
            (slopes[index], slopes[index + 1]) = (0.0, 0.0);
            continue;
        }
        let length = (slopes[index] / secant).hypot(slopes[index + 1] / secant);
        if length > 3.0 {
            slopes[index] *= 3.0 / length;
            slopes[index + 1] *= 3.0 / length;
        }
    }
    slopes
}

fn value(one: &Knot, two: &Knot, position: f64) -> f64 {
    let h = two.position - one.position;
    let t = (position - one.position) / h;
    let u = 1.0 - t;
    // Hermite's basis, written so that it gives the knots' values exactly at t = 0 and t = 1.
    u * u * (1.0 + 2.0 * t) * one.value
        + t * t * (1.0 + 2.0 * u) * two.value
        + h * t * u * (u * one.slope - t * two.slope)
}

fn slope(one: &Knot, two: &Knot, position: f64) -> f64 {
    let h = two.position - one.position;
    let t = (position - one.position) / h;
    let u = 1.0 - t;
    let secant = (two.value - one.value) / h;
    6.0 * t * u * secant + u * (1.0 - 3.0 * t) * one.slope + t * (1.0 - 3.0 * u) * two.slope
}

/// Both ends of the segment, and the place between them where its slope is greatest or least.
fn extremes(one: &Knot, two: &Knot) -> impl Iterator<Item = f64> {
    let h = two.position - one.position;
    let secant = (two.value - one.value) / h;
    // The slope is m₀ + 2 b t + 3 a t².
    let a = one.slope + two.slope - 2.0 * secant;
    let b = 3.0 * secant - 2.0 * one.slope - two.slope;
    let t = if a == 0.0 { 0.0 } else { (-b / (3.0 * a)).clamp(0.0, 1.0) };
    [one.position, one.position + t * h, two.position].into_iter()
}

/// Horizontal distance from `one` to `position`: ∫ cos θ ds by Gauss and Legendre's rule with four points.
fn horizontal(one: &Knot, two: &Knot, position: f64) -> f64 {
    const RULE: [(f64, f64); 2] = [
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    ];
    let half = 0.5 * (position - one.position);
    let middle = one.position + half;
    RULE.iter()
        .map(|(x, weight)| {
            weight * (cosine(slope(one, two, middle - half * x)) + cosine(slope(one, two, middle + half * x)))
        })
        .sum::<f64>()
        * half
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn hill() -> Curve {
        Curve::through(&[(0.0, 0.0), (10.0, 1.0), (30.0, 1.5), (40.0, 1.5), (70.0, -0.5)])
    }

    #[test]
    fn the_curve_goes_through_its_points() {
        for (position, height) in [(0.0, 0.0), (10.0, 1.0), (30.0, 1.5), (40.0, 1.5), (70.0, -0.5)] {
            assert!((hill().at(position).value - height).abs() < 1e-12);
        }
    }

    /// Between equal heights the curve is level; across a top it is level at the top.
    #[test]
    fn a_plateau_stays_a_plateau() {
        assert_eq!(hill().at(35.0).value, 1.5);
        assert_eq!(hill().at(30.0).slope, 0.0);
    }

    /// Secants 0.1 and 0.025 meet at 10 m: the tangent there is their mean, 0.0625, within the circle (0.625² + 1 < 9).
    #[test]
    fn tangents_are_the_mean_of_their_secants() {
        assert!((hill().at(10.0).slope - 0.0625).abs() < 1e-12);
    }

    /// Secants 1e-3 and 1e-1: mean 0.0505 is 50.5 times the first, so it is shortened to 3/√(1 + 50.5²) of that.
    #[test]
    fn a_tangent_that_would_overshoot_is_shortened() {
        let bend = Curve::through(&[(0.0, 0.0), (1.0, 1e-3), (2.0, 0.101)]);
        let expected = 0.0505 * 3.0 / 1f64.hypot(50.5);
        assert!((bend.at(1.0).slope - expected).abs() < 1e-12);
    }

    #[test]
    fn slope_is_the_derivative_of_height_by_differences() {
        for step in 0..69 {
            let x = f64::from(step) + 0.5;
            let difference = (hill().at(x + 1e-5).value - hill().at(x - 1e-5).value) / 2e-5;
            assert!((difference - hill().at(x).slope).abs() < 1e-9, "at {x}");
        }
    }

    #[test]
    fn a_straight_slope_is_kept_within_and_beyond_its_ends() {
        let line = Curve::through(&[(0.0, 0.0), (4.0, 2.4), (5.0, 3.0)]);
        for x in [-5.0, 0.0, 2.0, 5.0, 10.0] {
            let point = line.at(x);
            assert!((point.value - 0.6 * x).abs() < 1e-12 && (point.slope - 0.6).abs() < 1e-12);
            assert!((point.horizontal - 0.8 * x).abs() < 1e-12);
        }
    }

    /// Against the trapezoidal rule with 20 000 steps.
    #[test]
    fn horizontal_distance_is_the_integral_of_the_cosine() {
        let steep = Curve::through(&[(0.0, 0.0), (10.0, 3.0), (20.0, 8.0), (30.0, 8.0)]);
        let (steps, width) = (20_000, 25.0 / 20_000.0);
        let sum: f64 = (0..steps)
            .map(|i| f64::from(i) * width)
            .map(|x| 0.5 * width * (cosine(steep.at(x).slope) + cosine(steep.at(x + width).slope)))
            .sum();
        assert!((steep.at(25.0).horizontal - sum).abs() < 1e-4 * sum);
    }

    proptest! {
        /// No point between two knots lies outside their heights, and neither height nor slope has a step.
        #[test]
        fn it_makes_no_hills_of_its_own(
            steps in prop::collection::vec((0.1f64..50.0, -0.2f64..0.2), 2..12),
            share in 0.0f64..1.0,
        ) {
            let mut points = vec![(0.0, 0.0)];
            for (length, grade) in steps {
                let (x, y) = points[points.len() - 1];
                points.push((x + length, y + grade * length));
            }
            let curve = Curve::through(&points);
            for pair in points.windows(2) {
                let (low, high) = (pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1));
                let value = curve.at(pair[0].0 + share * (pair[1].0 - pair[0].0)).value;
                prop_assert!(value >= low - 1e-9 && value <= high + 1e-9, "{value} is not in {low}..{high}");
                let (before, after) = (curve.at(pair[1].0 - 1e-9), curve.at(pair[1].0 + 1e-9));
                prop_assert!((before.value - after.value).abs() < 1e-8);
                prop_assert!((before.slope - after.slope).abs() < 1e-6);
            }
            let (_, steepest) = curve.steepest().unwrap();
            for index in 0..=100 {
                let x = points[points.len() - 1].0 * f64::from(index) / 100.0;
                prop_assert!(curve.at(x).slope.abs() <= steepest.abs() + 1e-12);
            }
        }
    }
}
