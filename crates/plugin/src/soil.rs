//! The ground's resistance to rolling.

use std::fmt::Debug;

/// A vehicle pressing on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Force normal to the ground [N].
    pub load_n: f64,
    /// Speed over ground, without its sign [m/s].
    pub speed_m_s: f64,
    /// Where along the path [m].
    pub position_m: f64,
}

/// What the ground does to a rolling vehicle.
pub trait Soil: Debug + Send + Sync {
    /// Motion resistance [N], 0 or more; it acts against the motion.
    fn resistance_n(&self, contact: &Contact) -> f64;
}
