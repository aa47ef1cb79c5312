//! The ground below a wheel.
//!
//! A terrain with a surface is asked for it. One without knows its path only: where that is straight, its profile is drawn
//! out to both sides, h(east, north) = h(s) with s below the foot of the perpendicular; where it turns, nothing is known.
//! Behind its ends the ground goes on as it begins and ends.

use crate::BodyError;
use headland_plugin::{Place, Spot, Surface, Terrain};

/// The ground of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Ground<'a> {
    Known(&'a dyn Surface),
    Drawn(Drawn<'a>),
}

/// A straight path, drawn out to both sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn<'a> {
    terrain: &'a dyn Terrain,
    from: Place,
    from_m: f64,
    /// Sine and cosine of the heading.
    ahead: (f64, f64),
    extent_m: (f64, f64),
}

/// Headings that differ by less than this are the rounding of one [rad].
const STRAIGHT_RAD: f64 = 1e-9;
/// An endless path is looked at so far ahead of the start [m]; what comes behind is noticed on the way.
const LOOK_M: f64 = 1000.0;
/// At so many places.
const LOOKS: u32 = 1000;

impl<'a> Ground<'a> {
    /// The ground of a terrain about the start of a run.
    pub fn of(terrain: &'a dyn Terrain, from_m: f64) -> Result<Self, BodyError> {
        if let Some(surface) = terrain.surface() {
            return Ok(Self::Known(surface));
        }
        let from = terrain.at(from_m);
        let (begin_m, end_m) = terrain.extent_m().unwrap_or((from_m, from_m + LOOK_M));
        for look in 0..=LOOKS {
            let position_m = begin_m + (end_m - begin_m) * f64::from(look) / f64::from(LOOKS);
            if (terrain.at(position_m).heading_rad - from.heading_rad).abs() > STRAIGHT_RAD {
                return Err(BodyError::NoSurface { position_m });
            }
        }
        let extent_m = terrain.extent_m().unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        Ok(Self::Drawn(Drawn { terrain, from, from_m, ahead: from.heading_rad.sin_cos(), extent_m }))
    }

    /// Height and slope at a point [m]; `None` off the map.
    pub fn spot(&self, east_m: f64, north_m: f64) -> Option<Spot> {
        match self {
            Self::Known(surface) => surface.spot(east_m, north_m),
            Self::Drawn(drawn) => Some(drawn.spot(east_m, north_m)),
        }
    }

    /// Whether the path has left the straight line that the ground was drawn from.
    pub fn turned(&self, place: &Place) -> bool {
        matches!(self, Self::Drawn(drawn) if (place.heading_rad - drawn.from.heading_rad).abs() > STRAIGHT_RAD)
    }
}

impl Drawn<'_> {
    fn spot(&self, east_m: f64, north_m: f64) -> Spot {
        /// Positions along the path are found to this [m].
        const FOUND_M: f64 = 1e-10;
        const MOST_ITERATIONS: usize = 30;
        let (sin, cos) = self.ahead;
        let along = |east_m: f64, north_m: f64| {
            (east_m - self.from.east_m) * sin + (north_m - self.from.north_m) * cos
        };
        let wanted_m = along(east_m, north_m);
        let mut s = (self.from_m + wanted_m).clamp(self.extent_m.0, self.extent_m.1);
        let mut place = self.terrain.at(s);
        let mut left_m = wanted_m - along(place.east_m, place.north_m);
        for _ in 0..MOST_ITERATIONS {
            let next = (s + left_m / place.cos_slope()).clamp(self.extent_m.0, self.extent_m.1);
            if left_m.abs() <= FOUND_M || next == s {
                break;
            }
            s = next;
            place = self.terrain.at(s);
            left_m = wanted_m - along(place.east_m, place.north_m);
        }
        let grade = place.grade();
        Spot { height_m: place.elevation_m + left_m * grade, rise_east: grade * sin, rise_north: grade * cos }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3-4-5: 4 m ahead on the map the ground is 3 m higher, however far to the side.
    #[derive(Debug)]
    struct Slope;
    impl Terrain for Slope {
        fn at(&self, position_m: f64) -> Place {
            Place {
                elevation_m: 0.6 * position_m,
                sin_slope: 0.6,
                heading_rad: 0.0,
                north_m: 0.8 * position_m,
                ..Place::default()
            }
        }
    }

    #[test]
    fn a_straight_path_is_drawn_out_to_both_sides() {
        let ground = Ground::of(&Slope, 1.0).unwrap();
        let spot = ground.spot(-7.0, 4.0).unwrap();
        assert!((spot.height_m - 3.0).abs() < 1e-9, "{spot:?}");
        assert!((spot.rise_north - 0.75).abs() < 1e-12 && spot.rise_east.abs() < 1e-12);
    }

    #[derive(Debug)]
    struct Bend;
    impl Terrain for Bend {
        fn at(&self, position_m: f64) -> Place {
            Place { heading_rad: (position_m - 100.0).max(0.0) * 0.1, ..Place::default() }
        }
    }

    #[test]
    fn a_path_that_turns_is_refused_where_it_turns() {
        let told = Ground::of(&Bend, 0.0).unwrap_err().to_string();
        assert!(told.contains("turns at 101.0 m") && told.contains("a surface"), "{told}");
    }
}
