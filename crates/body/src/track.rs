//! Where a vehicle is along its path.

use crate::steer::Aim;
use headland_plugin::{Place, Terrain};
use rapier3d_f64::prelude::Vector;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The path, and how far along it the vehicle is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Track<'a> {
    terrain: &'a dyn Terrain,
    pub position_m: f64,
    /// Place on the path nearest to the vehicle.
    pub place: Place,
    /// How far left of the path it is [m].
    pub left_m: f64,
}

impl<'a> Track<'a> {
    pub fn at(terrain: &'a dyn Terrain, position_m: f64) -> Self {
        Self { terrain, position_m, place: terrain.at(position_m), left_m: 0.0 }
    }

    /// Follows the vehicle to a point of the map: the foot of the perpendicular to the path.
    pub fn follow(&mut self, point: Vector) {
        /// A step leads some millimetres on: the second iteration is the rounding of the first.
        const ITERATIONS: usize = 2;
        for _ in 0..ITERATIONS {
            let (sin, cos) = self.place.heading_rad.sin_cos();
            let (east_m, north_m) = (point.x - self.place.east_m, point.y - self.place.north_m);
            self.left_m = north_m * sin - east_m * cos;
            let ahead_m = east_m * sin + north_m * cos;
            // A point beside a bend moves by other ways than the path below it; curvature counts clockwise.
            let bent = 1.0 + self.place.curvature_per_m * self.left_m;
            self.position_m += ahead_m / (self.place.cos_slope() * bent.max(0.1));
            self.place = self.terrain.at(self.position_m);
        }
    }

    /// The point that the driver aims at, `far_m` ahead, or behind where that is less than 0, seen from a point of the vehicle.
    pub fn aim(&self, from: Vector, (ahead, left): (Vector, Vector), far_m: f64, aslant_rad: f64) -> Aim {
        let wanted_m = self.position_m + far_m;
        let known_m = self.terrain.extent_m().map_or(wanted_m, |(from_m, to_m)| wanted_m.clamp(from_m, to_m));
        let place = self.terrain.at(known_m);
        // Beyond its ends the path goes on straight.
        let beyond_m = wanted_m - known_m;
        let (sin, cos) = place.heading_rad.sin_cos();
        let to =
            Vector::new(place.east_m + beyond_m * sin - from.x, place.north_m + beyond_m * cos - from.y, 0.0);
        let yaw_rad = ahead.y.atan2(ahead.x);
        let off_rad = yaw_of(place.heading_rad) + aslant_rad - yaw_rad;
        Aim { ahead_m: to.dot(ahead), left_m: to.dot(left), off_rad: (off_rad + PI).rem_euclid(TAU) - PI }
    }
}

/// Headings count clockwise from north, yaw counterclockwise from east.
pub(crate) fn yaw_of(heading_rad: f64) -> f64 {
    FRAC_PI_2 - heading_rad
}

/// The heading of a direction, nearest to one that is known.
pub(crate) fn heading_of(ahead: Vector, near_rad: f64) -> f64 {
    let heading_rad = ahead.x.atan2(ahead.y);
    near_rad + (heading_rad - near_rad + PI).rem_euclid(TAU) - PI
}
