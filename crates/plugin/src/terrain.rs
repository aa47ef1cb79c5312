//! The shape of the ground along the path.

use crate::Surface;
use std::fmt::Debug;

/// A place on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Height above the origin [m].
    pub elevation_m: f64,
    /// Sine of the slope: rise per metre of path, positive uphill.
    pub sin_slope: f64,
    /// Sine of the slope across the path: fall per metre to the right. 0 where only the path itself is known.
    pub sin_roll: f64,
    /// Direction of travel, clockwise from north [rad].
    pub heading_rad: f64,
    /// Turn per metre of path, clockwise [1/m].
    pub curvature_per_m: f64,
    /// Position east of the origin [m].
    pub east_m: f64,
    /// Position north of the origin [m].
    pub north_m: f64,
}

impl Place {
    /// Cosine of the slope.
    pub fn cos_slope(&self) -> f64 {
        (1.0 - self.sin_slope * self.sin_slope).max(0.0).sqrt()
    }

    /// Rise over horizontal distance.
    pub fn grade(&self) -> f64 {
        self.sin_slope / self.cos_slope()
    }
}

/// A path over ground.
pub trait Terrain: Debug + Send + Sync {
    /// The place at a distance along the path [m].
    fn at(&self, position_m: f64) -> Place;

    /// Where the path begins and ends [m]; `None` where it never ends.
    fn extent_m(&self) -> Option<(f64, f64)> {
        None
    }

    /// Names of the marks that stand along the path, as `turn` where a lane ends.
    fn marks(&self) -> Vec<&str> {
        Vec::new()
    }

    /// Where the next mark of this name stands beyond a position, both along the path [m]; `None` where there is none.
    fn next_mark_m(&self, name: &str, position_m: f64) -> Option<f64> {
        let _ = (name, position_m);
        None
    }

    /// The ground beside the path; `None` where only the path itself is known.
    fn surface(&self) -> Option<&dyn Surface> {
        None
    }
}
