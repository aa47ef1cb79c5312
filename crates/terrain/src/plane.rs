//! A path in a plane, made of pieces whose curvature changes evenly: straights, arcs and the clothoids between them.
//!
//! κ(s) = κ₀ + σ s,  θ(s) = θ₀ + κ₀ s + ½ σ s²,  east′ = sin θ,  north′ = cos θ        clockwise from north
//!
//! Source: definition of the clothoid (Euler's spiral); its integrals by Gauss's quadrature with five nodes on pieces of at
//! most half a radian, which is exact to rounding.
//! The plane may be inclined: positions count along the path on the slope, the map shows it foreshortened.

use headland_plugin::{Place, Spot, Surface};

/// One piece.
#[derive(Clone, Copy, Debug)]
struct Piece {
    start_m: f64,
    length_m: f64,
    east_m: f64,
    north_m: f64,
    heading_rad: f64,
    curvature: f64,
    /// Change of curvature per metre, σ.
    rate: f64,
}

/// A path through pieces one after the other; before and behind them it goes on straight.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlanePath {
    pieces: Vec<Piece>,
    heading_rad: f64,
}

/// Where a path is, and which way it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    pub east_m: f64,
    pub north_m: f64,
    pub heading_rad: f64,
    pub curvature: f64,
}

/// How a plane lies.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Incline {
    /// Rise over horizontal distance in the direction in which the plane rises.
    pub grade: f64,
    /// That direction, clockwise from north [rad].
    pub uphill_rad: f64,
}

impl Incline {
    /// The place of a pose in the inclined plane.
    pub fn place(&self, pose: &Pose) -> Place {
        let flat = Place {
            heading_rad: pose.heading_rad,
            curvature_per_m: pose.curvature,
            east_m: pose.east_m,
            north_m: pose.north_m,
            ..Place::default()
        };
        if self.grade == 0.0 {
            return flat;
        }
        let cos_plane = 1.0 / self.grade.hypot(1.0);
        let sin_plane = self.grade * cos_plane;
        let (sin, cos) = self.uphill_rad.sin_cos();
        let up_m = pose.east_m * sin + pose.north_m * cos;
        let shortened_m = up_m * (cos_plane - 1.0);
        Place {
            elevation_m: up_m * sin_plane,
            sin_slope: sin_plane * (pose.heading_rad - self.uphill_rad).cos(),
            sin_roll: sin_plane * (pose.heading_rad - self.uphill_rad).sin(),
            east_m: pose.east_m + shortened_m * sin,
            north_m: pose.north_m + shortened_m * cos,
            ..flat
        }
    }
}

/// A plane through the origin, as the map shows it.
impl Surface for Incline {
    fn spot(&self, east_m: f64, north_m: f64) -> Option<Spot> {
        let (sin, cos) = self.uphill_rad.sin_cos();
        let (rise_east, rise_north) = (self.grade * sin, self.grade * cos);
        Some(Spot { height_m: rise_east * east_m + rise_north * north_m, rise_east, rise_north })
    }
}

impl PlanePath {
    /// A path that begins at the origin.
    pub fn heading(heading_rad: f64) -> Self {
        Self { pieces: Vec::new(), heading_rad }
    }

    /// Its length so far [m].
    pub fn length_m(&self) -> f64 {
        self.pieces.last().map_or(0.0, |last| last.start_m + last.length_m)
    }

    /// Goes on for a length, with a curvature that changes evenly from one value to another.
    pub fn go(&mut self, length_m: f64, from: f64, to: f64) {
        if length_m <= 0.0 {
            return;
        }
        let start_m = self.length_m();
        let Pose { east_m, north_m, heading_rad, .. } = self.at(start_m);
        let rate = (to - from) / length_m;
        self.pieces.push(Piece { start_m, length_m, east_m, north_m, heading_rad, curvature: from, rate });
    }

    /// Turns by an angle, clockwise where it is positive. The curvature rises and falls over `ramp_m` to that of the radius,
    /// or less far where the angle is small.
    pub fn bend(&mut self, angle_rad: f64, radius_m: f64, ramp_m: f64) {
        let (angle, way) = (angle_rad.abs(), angle_rad.signum());
        let rate = 1.0 / (radius_m * ramp_m);
        let peak = (angle * rate).sqrt().min(1.0 / radius_m);
        let rise_m = peak / rate;
        self.go(rise_m, 0.0, way * peak);
        self.go(angle / peak - rise_m, way * peak, way * peak);
        self.go(rise_m, way * peak, 0.0);
    }

    /// Where it is at a distance along it [m].
    pub fn at(&self, position_m: f64) -> Pose {
        let after = self.pieces.partition_point(|piece| piece.start_m <= position_m);
        let Some(piece) = after.checked_sub(1).map(|index| &self.pieces[index]) else {
            let (sin, cos) = self.heading_rad.sin_cos();
            return Pose {
                east_m: position_m * sin,
                north_m: position_m * cos,
                heading_rad: self.heading_rad,
                curvature: 0.0,
            };
        };
        let s = (position_m - piece.start_m).min(piece.length_m);
        let (mut east_m, mut north_m) = displacement(piece, s);
        let heading_rad = piece.heading_rad + (piece.curvature + 0.5 * piece.rate * s) * s;
        let beyond_m = position_m - piece.start_m - s;
        let mut curvature = piece.curvature + piece.rate * s;
        if beyond_m > 0.0 {
            east_m += beyond_m * heading_rad.sin();
            north_m += beyond_m * heading_rad.cos();
            curvature = 0.0;
        }
        Pose { east_m: piece.east_m + east_m, north_m: piece.north_m + north_m, heading_rad, curvature }
    }
}

/// Nodes and weights of Gauss's quadrature on −1 to 1.
const GAUSS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// A stretch that turns further is cut [rad].
const WIDEST_STRETCH_RAD: f64 = 0.5;

/// How far east and north a piece leads.
fn displacement(piece: &Piece, s: f64) -> (f64, f64) {
    let heading = |at: f64| piece.heading_rad + (piece.curvature + 0.5 * piece.rate * at) * at;
    if piece.curvature == 0.0 && piece.rate == 0.0 {
        let (sin, cos) = piece.heading_rad.sin_cos();
        return (s * sin, s * cos);
    }
    let sharpest = piece.curvature.abs().max((piece.curvature + piece.rate * piece.length_m).abs());
    let stretches = (sharpest * s.abs() / WIDEST_STRETCH_RAD).ceil().max(1.0);
    let half = 0.5 * s / stretches;
    let (mut east, mut north) = (0.0, 0.0);
    let mut middle = half;
    while middle.abs() < s.abs() {
        for (node, weight) in GAUSS {
            let (sin, cos) = heading(middle + node * half).sin_cos();
            east += weight * half * sin;
            north += weight * half * cos;
        }
        middle += 2.0 * half;
    }
    (east, north)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn an_arc_meets_its_circle() {
        let mut path = PlanePath::heading(0.0);
        path.go(30.0, 0.0, 0.0);
        path.go(1.5 * PI * 10.0, 0.1, 0.1);
        // Three quarters clockwise about (10, 30): it goes east along the circle's north, then south, then west.
        for (angle, east, north) in [(FRAC_PI_2, 10.0, 40.0), (PI, 20.0, 30.0), (1.5 * PI, 10.0, 20.0)] {
            let pose = path.at(30.0 + 10.0 * angle);
            assert!((pose.east_m - east).abs() < 1e-12 && (pose.north_m - north).abs() < 1e-12, "{pose:?}");
            assert!((pose.heading_rad - angle).abs() < 1e-12);
        }
    }

    /// Fresnel's integrals at √(2/π): of the clothoid κ = π s, S(1) = 0.438 259 147 390 and C(1) = 0.779 893 400 377.
    #[test]
    fn a_clothoid_meets_fresnels_integrals() {
        let mut path = PlanePath::heading(0.0);
        path.go(1.0, 0.0, PI);
        let pose = path.at(1.0);
        assert!((pose.east_m - 0.438_259_147_390_354_8).abs() < 1e-12);
        assert!((pose.north_m - 0.779_893_400_376_822_8).abs() < 1e-12);
    }

    #[test]
    fn a_bend_turns_by_its_angle_and_is_smooth_even_where_it_is_small() {
        for angle in [-PI, -0.05, 0.3, 4.0] {
            let mut path = PlanePath::heading(1.0);
            path.bend(angle, 6.0, 4.0);
            let end = path.at(path.length_m());
            assert!((end.heading_rad - 1.0 - angle).abs() < 1e-12, "{angle}");
            let mut before = 0.0;
            let mut s = 0.0;
            while s < path.length_m() + 1.0 {
                let curvature = path.at(s).curvature;
                assert!((curvature - before).abs() < 1e-3 && curvature.abs() <= 1.0 / 6.0 + 1e-12);
                (before, s) = (curvature, s + 0.01);
            }
        }
    }

    #[test]
    fn position_heading_and_slope_agree_with_each_other_on_an_inclined_plane() {
        let mut path = PlanePath::heading(0.4);
        path.bend(2.0, 8.0, 3.0);
        let plane = Incline { grade: 0.2, uphill_rad: 1.1 };
        let (step, s) = (1e-4, 9.0);
        let (one, two) = (plane.place(&path.at(s)), plane.place(&path.at(s + step)));
        let rise = two.elevation_m - one.elevation_m;
        assert!((rise / step - one.sin_slope).abs() < 1e-4);
        let moved = (two.east_m - one.east_m).hypot(two.north_m - one.north_m).hypot(rise);
        assert!((moved / step - 1.0).abs() < 1e-6, "{moved}");
    }

    /// Northward along a slope that rises to the east the left side is lower; aslant, the parts along and across make the slope.
    #[test]
    fn a_path_along_a_slope_leans_away_from_where_it_rises() {
        let plane = Incline { grade: 0.75, uphill_rad: FRAC_PI_2 };
        let lean = |heading: f64| {
            let place = plane.place(&PlanePath::heading(heading).at(5.0));
            (place.sin_slope, place.sin_roll)
        };
        for (heading, along, across) in [(0.0, 0.0, -0.6), (PI, 0.0, 0.6), (FRAC_PI_2, 0.6, 0.0)] {
            let found = lean(heading);
            assert!((found.0 - along).abs() < 1e-12 && (found.1 - across).abs() < 1e-12, "{found:?}");
        }
        let (along, across) = lean(0.3);
        assert!((along.hypot(across) - 0.6).abs() < 1e-12);
    }

    #[test]
    fn the_path_lies_on_the_surface() {
        let mut path = PlanePath::heading(0.4);
        path.bend(2.0, 8.0, 3.0);
        let plane = Incline { grade: 0.2, uphill_rad: 1.1 };
        for s in [0.0, 4.0, 9.0, 15.0] {
            let place = plane.place(&path.at(s));
            let spot = plane.spot(place.east_m, place.north_m).unwrap();
            assert!((spot.height_m - place.elevation_m).abs() < 1e-12, "{spot:?} {place:?}");
            assert!((spot.rise_east.hypot(spot.rise_north) - 0.2).abs() < 1e-12);
        }
    }
}
