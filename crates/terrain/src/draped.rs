//! A line of the map laid over a surface: positions count along the ground.
//!
//! s(u) = ∫ √(1 + p²) du,  p = h_x sin θ + h_y cos θ        u along the map, θ its heading
//!
//! Source: definition of the length of a curve; Gauss's quadrature with two points between knots, and the cubic of Hermite
//! through u and du/ds = 1/√(1 + p²) at the knots for the inverse.

use crate::map_path::{Corner, MapLine, on_ground};
use headland_plugin::{Place, Spot, Surface};

/// A path over a surface.
#[derive(Clone, Debug)]
pub(crate) struct Draped {
    line: MapLine,
    knots: Vec<Knot>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    /// Along the map [m].
    u: f64,
    /// Along the ground [m].
    s: f64,
    /// du/ds.
    share: f64,
}

/// Where a line leaves what the surface knows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OffMap {
    /// How far along the map [m].
    pub along: f64,
    pub at: Corner,
}

impl Draped {
    /// Lays a line over a surface, with knots at most `spacing_m` apart.
    ///
    /// # Errors
    /// [`OffMap`]: the first place where the surface knows no height.
    pub fn over(line: MapLine, surface: &dyn Surface, spacing_m: f64) -> Result<Self, OffMap> {
        let length_m = line.length_m();
        let pieces = (length_m / spacing_m).ceil().max(1.0);
        let step = length_m / pieces;
        // Metres of ground for each metre of the map.
        let stretch = |u: f64| rise(&line, surface, u).map(|rise| rise.hypot(1.0));
        let mut knots = vec![Knot { u: 0.0, s: 0.0, share: 1.0 / stretch(0.0)? }];
        let mut number = 1.0;
        while number <= pieces {
            let last = knots[knots.len() - 1];
            let u = if number == pieces { length_m } else { number * step };
            let (middle, away) = (0.5 * (last.u + u), 0.5 * (u - last.u) / f64::sqrt(3.0));
            let mean = 0.5 * (stretch(middle - away)? + stretch(middle + away)?);
            knots.push(Knot { u, s: last.s + mean * (u - last.u), share: 1.0 / stretch(u)? });
            number += 1.0;
        }
        Ok(Self { line, knots })
    }

    /// Its length over the ground [m].
    pub fn length_m(&self) -> f64 {
        self.knots[self.knots.len() - 1].s
    }

    /// How far along the map a place lies that is so far along the ground [m]; beyond its ends the ground goes on straight.
    fn along_map_m(&self, s: f64) -> f64 {
        let after = self.knots.partition_point(|knot| knot.s <= s);
        let (Some(one), Some(two)) = (after.checked_sub(1).map(|at| self.knots[at]), self.knots.get(after))
        else {
            let end = self.knots[after.saturating_sub(1)];
            return end.u + (s - end.s) * end.share;
        };
        let h = two.s - one.s;
        let t = (s - one.s) / h;
        let v = 1.0 - t;
        v * v * (1.0 + 2.0 * t) * one.u
            + t * t * (1.0 + 2.0 * v) * two.u
            + h * t * v * (v * one.share - t * two.share)
    }

    /// How far along the ground a place lies that is so far along the map [m], to a thousandth of a knot's step.
    pub fn along_ground_m(&self, u: f64) -> f64 {
        let after = self.knots.partition_point(|knot| knot.u <= u).clamp(1, self.knots.len() - 1);
        let (one, two) = (self.knots[after - 1], self.knots[after]);
        let (mut low, mut high) = (one.s, two.s);
        while high - low > 1e-9 * (two.s - one.s) {
            let middle = 0.5 * (low + high);
            if middle == low || middle == high {
                break;
            }
            if self.along_map_m(middle) < u {
                low = middle;
            } else {
                high = middle;
            }
        }
        high
    }

    /// The place at a distance along the ground [m]; beyond its ends the ground goes on as it ended.
    pub fn at(&self, surface: &dyn Surface, s: f64) -> Place {
        let u = self.along_map_m(s);
        let pose = self.line.at(u);
        if let Some(spot) = surface.spot(pose.east_m, pose.north_m) {
            return on_ground(&pose, spot.height_m, slopes(&spot, pose.heading_rad));
        }
        let end = u.clamp(0.0, self.line.length_m());
        let last = self.line.at(end);
        let spot = surface.spot(last.east_m, last.north_m).unwrap_or_default();
        let (rise, fall) = slopes(&spot, last.heading_rad);
        on_ground(&pose, spot.height_m + (u - end) * rise, (rise, fall))
    }
}

/// Rise along a heading and fall to its right, per metre of the map.
fn slopes(spot: &Spot, heading_rad: f64) -> (f64, f64) {
    let (sin, cos) = heading_rad.sin_cos();
    (along(spot, heading_rad), spot.rise_north * sin - spot.rise_east * cos)
}

/// Rise per metre of the map in a direction.
fn along(spot: &Spot, heading_rad: f64) -> f64 {
    let (sin, cos) = heading_rad.sin_cos();
    spot.rise_east * sin + spot.rise_north * cos
}

fn rise(line: &MapLine, surface: &dyn Surface, u: f64) -> Result<f64, OffMap> {
    let pose = line.at(u);
    let spot = surface.spot(pose.east_m, pose.north_m);
    let off = OffMap { along: u, at: Corner { east_m: pose.east_m, north_m: pose.north_m } };
    spot.map(|spot| along(&spot, pose.heading_rad)).ok_or(off)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::Incline;
    use crate::plane::PlanePath;
    use headland_plugin::Bounds;

    /// h = a sin(k east), up to 100 m east.
    #[derive(Debug)]
    struct Waves;

    const A: f64 = 2.0;
    const K: f64 = 0.1;

    impl Surface for Waves {
        fn spot(&self, east_m: f64, _: f64) -> Option<Spot> {
            let height_m = A * (K * east_m).sin();
            (east_m <= 100.0).then(|| Spot {
                height_m,
                rise_east: A * K * (K * east_m).cos(),
                rise_north: 0.0,
            })
        }

        fn bounds(&self) -> Option<Bounds> {
            None
        }
    }

    fn bent(length_m: f64) -> MapLine {
        let mut path = PlanePath::heading(1.2);
        path.go(10.0, 0.0, 0.0);
        path.bend(0.5, 20.0, 10.0);
        path.go(length_m, 0.0, 0.0);
        MapLine::Plane(path, Corner { east_m: 3.0, north_m: -7.0 })
    }

    #[test]
    fn positions_are_distances_over_the_ground_and_slopes_those_of_the_heights() {
        let path = Draped::over(bent(50.0), &Waves, 0.5).unwrap();
        let h = 1e-3;
        let mut s = 0.0;
        while s + h < path.length_m() {
            let (one, two) = (path.at(&Waves, s), path.at(&Waves, s + h));
            let rise = two.elevation_m - one.elevation_m;
            let moved = (two.east_m - one.east_m).hypot(two.north_m - one.north_m).hypot(rise);
            assert!((moved / h - 1.0).abs() < 1e-6, "{s}: {moved}");
            assert!((rise / h - 0.5 * (one.sin_slope + two.sin_slope)).abs() < 1e-6, "{s}");
            let turned = (two.heading_rad - one.heading_rad) / h;
            assert!((turned - one.curvature_per_m).abs() < 1e-4, "{s}");
            s += 0.37;
        }
    }

    /// On a plane both know: headings of the map are not those of the plane, slopes are the same.
    #[test]
    fn a_line_over_a_plane_leans_as_the_plane_does() {
        let plane = Incline { grade: 0.75, uphill_rad: 1.1 };
        for heading in [0.2, 1.4, 3.0] {
            let mut path = PlanePath::heading(heading);
            path.go(10.0, 0.0, 0.0);
            let draped =
                Draped::over(MapLine::Plane(path, Corner { east_m: 0.0, north_m: 0.0 }), &plane, 1.0)
                    .unwrap();
            let place = draped.at(&plane, 4.0);
            // Along a plane of sin ψ = 0.6 the whole of it is in the two slopes; across, it falls to the right left of uphill.
            assert!((place.sin_slope.hypot(place.sin_roll) - 0.6).abs() < 1e-12, "{place:?}");
            assert_eq!(place.sin_roll > 0.0, heading > 1.1, "{place:?}");
        }
    }

    /// A quarter of a wave: ∫ √(1 + a²k² cos²(k x)) dx is the elliptic integral √(1 + a²k²)/k E(a²k²/(1 + a²k²)), by its
    /// series E(m) = π/2 (1 − m/4 − 3 m²/64 − 5 m³/256 − 175 m⁴/16384 − ...).
    #[test]
    fn a_wave_is_as_long_as_its_elliptic_integral_and_the_error_falls_with_the_fourth_power() {
        let quarter_m = 0.5 * std::f64::consts::PI / K;
        let m = A * A * K * K / (1.0 + A * A * K * K);
        let series = 1.0
            - m / 4.0
            - 3.0 * m * m / 64.0
            - 5.0 * m.powi(3) / 256.0
            - 175.0 * m.powi(4) / 16_384.0
            - 441.0 * m.powi(5) / 65_536.0;
        let exact = (1.0 + A * A * K * K).sqrt() / K * 0.5 * std::f64::consts::PI * series;
        let length = |map_m: f64, pieces: f64| {
            let mut path = PlanePath::heading(0.5 * std::f64::consts::PI);
            path.go(map_m, 0.0, 0.0);
            let line = MapLine::Plane(path, Corner { east_m: 0.0, north_m: 0.0 });
            Draped::over(line, &Waves, map_m / pieces).unwrap().length_m()
        };
        // The series is cut off after 10⁻⁸ of the whole.
        assert!((length(quarter_m, 64.0) / exact - 1.0).abs() < 1e-7);
        let error = |pieces: f64| length(23.0, pieces) - length(23.0, 1000.0);
        let order = (error(8.0) / error(16.0)).log2();
        assert!((order - 4.0).abs() < 0.2, "observed order {order}");
    }

    #[test]
    fn a_path_that_leaves_the_map_is_told_with_its_place() {
        let off = Draped::over(bent(200.0), &Waves, 1.0).unwrap_err();
        assert!(off.at.east_m > 100.0 && off.at.east_m < 101.0, "{off:?}");
        assert!(off.along > 90.0 && off.along < 120.0, "{off:?}");
    }

    #[test]
    fn ways_along_the_map_and_along_the_ground_are_inverse() {
        let path = Draped::over(bent(50.0), &Waves, 0.5).unwrap();
        for u in [0.0, 0.1, 17.3, 42.0] {
            assert!((path.along_map_m(path.along_ground_m(u)) - u).abs() < 1e-8, "{u}");
        }
        let beyond = path.at(&Waves, path.length_m() + 1.0);
        assert!(beyond.sin_slope.is_finite() && beyond.elevation_m.is_finite());
    }
}
