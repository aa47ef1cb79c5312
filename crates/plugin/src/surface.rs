//! The ground as a surface over the map.

use std::fmt::Debug;

/// A point of the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spot {
    /// Height above the origin [m].
    pub height_m: f64,
    /// Rise per metre to the east.
    pub rise_east: f64,
    /// Rise per metre to the north.
    pub rise_north: f64,
}

/// What the map covers [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// From west to east.
    pub east_m: [f64; 2],
    /// From south to north.
    pub north_m: [f64; 2],
}

/// A height over every point of the map.
pub trait Surface: Debug + Send + Sync {
    /// Height and slope at a point [m]; `None` off the map.
    fn spot(&self, east_m: f64, north_m: f64) -> Option<Spot>;

    /// Where the map ends; `None` where it never does.
    fn bounds(&self) -> Option<Bounds> {
        None
    }
}
