//! A smooth path through points of a map: a natural cubic spline over the chord, and the distance along it.
//!
//! x(u), y(u) piecewise cubic with two continuous derivatives, so that the curvature
//! κ = (x″ y′ − y″ x′) / (x′² + y′²)^(3/2) has no steps        x east, y north, clockwise positive
//! s(u) = ∫ √(x′² + y′²) du
//!
//! Source: de Boor, *A Practical Guide to Splines* (1978), chapter IV; the arc length by Gauss's quadrature on halves of
//! each piece, inverted by Newton's method within brackets.

use crate::plane::Pose;

/// A smooth path.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spline {
    knots: Vec<Knot>,
}

#[derive(Clone, Copy, Debug)]
struct Knot {
    /// Length of the chords so far.
    u: f64,
    point: [f64; 2],
    /// Second derivatives.
    bend: [f64; 2],
    /// Distance along the path [m].
    s: f64,
}

/// Nodes and weights of Gauss's quadrature on 0 to 1.
const GAUSS: [(f64, f64); 5] = [
    (0.5, 0.284_444_444_444_444_4),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_24),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_24),
    (0.046_910_077_030_668_0, 0.118_463_442_528_094_54),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Pieces of a knot's interval on which the quadrature is taken.
const PARTS: u32 = 4;

impl Spline {
    /// Through two or more points, no two of which in a row are the same.
    pub fn through(points: &[[f64; 2]]) -> Self {
        let mut knots: Vec<Knot> = Vec::with_capacity(points.len());
        for point in points {
            let u = knots.last().map_or(0.0, |last: &Knot| {
                last.u + (point[0] - last.point[0]).hypot(point[1] - last.point[1])
            });
            knots.push(Knot { u, point: *point, bend: [0.0; 2], s: 0.0 });
        }
        for axis in 0..2 {
            for (knot, bend) in knots.iter_mut().zip(bends(points, axis)) {
                knot.bend[axis] = bend;
            }
        }
        let mut spline = Self { knots };
        for index in 1..spline.knots.len() {
            let before = spline.knots[index - 1];
            spline.knots[index].s = before.s + spline.length(index - 1, spline.knots[index].u - before.u);
        }
        spline
    }

    /// Its length [m].
    pub fn length_m(&self) -> f64 {
        self.knots.last().map_or(0.0, |last| last.s)
    }

    /// Distances along it of the points that it was made of [m].
    pub fn knots_m(&self) -> impl Iterator<Item = f64> {
        self.knots.iter().map(|knot| knot.s)
    }

    /// The point, its first and its second derivative at a way `t` after a knot.
    fn derivatives(&self, index: usize, t: f64) -> [[f64; 2]; 3] {
        let (one, two) = (&self.knots[index], &self.knots[index + 1]);
        let h = two.u - one.u;
        let (a, b) = ((h - t) / h, t / h);
        let mut all = [[0.0; 2]; 3];
        let [place, first, second] = &mut all;
        for (axis, ((place, first), second)) in place.iter_mut().zip(first).zip(second).enumerate() {
            let (p, q, m, n) = (one.point[axis], two.point[axis], one.bend[axis], two.bend[axis]);
            *place = a * p + b * q + ((a * a * a - a) * m + (b * b * b - b) * n) * h * h / 6.0;
            *first = (q - p) / h + ((3.0 * b * b - 1.0) * n - (3.0 * a * a - 1.0) * m) * h / 6.0;
            *second = a * m + b * n;
        }
        all
    }

    /// Length of the path from a knot to a way `t` after it.
    fn length(&self, index: usize, t: f64) -> f64 {
        let part = t / f64::from(PARTS);
        let mut length = 0.0;
        for number in 0..PARTS {
            for (node, weight) in GAUSS {
                let [_, first, _] = self.derivatives(index, (f64::from(number) + node) * part);
                length += weight * part * first[0].hypot(first[1]);
            }
        }
        length
    }

    /// The pose at a distance along the path [m]; beyond its ends it goes on straight.
    pub fn at(&self, s: f64) -> Pose {
        const MOST_ITERATIONS: usize = 30;
        let within = s.clamp(0.0, self.length_m());
        let last = self.knots.len() - 2;
        let index = (self.knots.partition_point(|knot| knot.s <= within).max(1) - 1).min(last);
        let (one, two) = (&self.knots[index], &self.knots[index + 1]);
        let (mut low, mut high) = (0.0, two.u - one.u);
        let mut t = high * ((within - one.s) / (two.s - one.s)).clamp(0.0, 1.0);
        for _ in 0..MOST_ITERATIONS {
            let short = within - one.s - self.length(index, t);
            if short > 0.0 {
                low = t;
            } else {
                high = t;
            }
            let [_, first, _] = self.derivatives(index, t);
            let next = t + short / first[0].hypot(first[1]);
            let next = if (low..=high).contains(&next) { next } else { 0.5 * (low + high) };
            let moved = (next - t).abs();
            t = next;
            if moved <= 1e-13 * two.u {
                break;
            }
        }
        let [point, first, second] = self.derivatives(index, t);
        let speed = first[0].hypot(first[1]);
        let (sin, cos) = (first[0] / speed, first[1] / speed);
        let beyond_m = s - within;
        let curvature = (second[0] * first[1] - second[1] * first[0]) / (speed * speed * speed);
        Pose {
            east_m: point[0] + beyond_m * sin,
            north_m: point[1] + beyond_m * cos,
            heading_rad: first[0].atan2(first[1]),
            curvature: if beyond_m == 0.0 { curvature } else { 0.0 },
        }
    }
}

/// Second derivatives at the points, none at the ends: Thomas's algorithm on the tridiagonal system.
fn bends(points: &[[f64; 2]], axis: usize) -> Vec<f64> {
    let n = points.len();
    let h: Vec<f64> =
        points.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).collect();
    let rise: Vec<f64> =
        points.windows(2).zip(&h).map(|(pair, h)| (pair[1][axis] - pair[0][axis]) / h).collect();
    let (mut factor, mut value) = (vec![0.0; n], vec![0.0; n]);
    for i in 1..n.saturating_sub(1) {
        let pivot = 2.0 * (h[i - 1] + h[i]) - h[i - 1] * factor[i - 1];
        factor[i] = h[i] / pivot;
        value[i] = (6.0 * (rise[i] - rise[i - 1]) - h[i - 1] * value[i - 1]) / pivot;
    }
    for i in (1..n.saturating_sub(1)).rev() {
        value[i] -= factor[i] * value[i + 1];
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 61 points of a circle of 50 m, clockwise from its west: 1 m of path turns by 1/50. The ends of a natural spline are
    /// straight, so only the middle is looked at.
    #[test]
    fn points_of_a_circle_give_its_curvature_and_its_length() {
        let points: Vec<[f64; 2]> = (0..=60)
            .map(|i| {
                let angle = f64::from(i) * 3.0_f64.to_radians();
                [-50.0 * angle.cos(), 50.0 * angle.sin()]
            })
            .collect();
        let path = Spline::through(&points);
        assert!((path.length_m() / (50.0 * std::f64::consts::PI) - 1.0).abs() < 1e-4, "{}", path.length_m());
        let middle = path.at(0.5 * path.length_m());
        assert!((middle.curvature * 50.0 - 1.0).abs() < 1e-3, "{middle:?}");
        assert!((middle.east_m.hypot(middle.north_m) - 50.0).abs() < 1e-3);
        assert!((middle.heading_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    }

    #[test]
    fn positions_are_distances_along_the_path_and_curvature_has_no_steps() {
        let path = Spline::through(&[[0.0, 0.0], [40.0, 10.0], [60.0, 60.0], [140.0, 70.0], [150.0, 160.0]]);
        let (step, mut s) = (0.01, 0.0);
        while s + step < path.length_m() {
            let (one, two) = (path.at(s), path.at(s + step));
            let moved = (two.east_m - one.east_m).hypot(two.north_m - one.north_m);
            assert!((moved / step - 1.0).abs() < 1e-6, "{s}: {moved}");
            assert!((two.curvature - one.curvature).abs() < 1e-4, "{s}");
            let turned = two.heading_rad - one.heading_rad;
            assert!((turned / step - one.curvature).abs() < 1e-4, "{s}");
            s += 0.37;
        }
    }

    #[test]
    fn two_points_are_a_straight_and_it_goes_on_beyond_them() {
        let path = Spline::through(&[[0.0, 0.0], [30.0, 40.0]]);
        let pose = path.at(60.0);
        assert!((pose.east_m - 36.0).abs() < 1e-9 && (pose.north_m - 48.0).abs() < 1e-9);
        assert_eq!(pose.curvature, 0.0);
    }
}
