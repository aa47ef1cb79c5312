//! The ground's resistance to rolling, and what a wheel finds there.

use crate::tyre::Tyre;
use crate::{Place, Refusal};
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

/// One wheel pressing on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelContact<'a> {
    /// What it rolls on.
    pub tyre: &'a Tyre,
    /// Force normal to the ground [N], 0 or more.
    pub load_n: f64,
    /// 1 − speed over ground / speed at which it rolls: positive where it drives, negative where it brakes, above −1 and
    /// below 1. Zero is where it pulls nothing on a hard surface.
    pub slip: f64,
    /// Speed over ground, without its sign [m/s].
    pub speed_m_s: f64,
    /// Wheels that went before it in the same rut.
    pub earlier_passes: u32,
    /// Where along the path [m].
    pub position_m: f64,
    /// The place on the map.
    pub place: Place,
}

/// What the ground does to one wheel.
///
/// The force on the vehicle is `gross_traction_n − motion_resistance_n`; the torque at the wheel is that of the gross
/// traction at its rolling radius.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footing {
    /// Torque at the wheel per rolling radius [N], positive where it drives. It grows with slip until the ground has no
    /// more to give.
    pub gross_traction_n: f64,
    /// Motion resistance [N], 0 or more.
    pub motion_resistance_n: f64,
    /// Depth of the rut [m]; NaN where the model does not know it.
    pub sinkage_m: f64,
}

/// What the ground does to a rolling vehicle.
pub trait Soil: Debug + Send + Sync {
    /// Motion resistance of a whole vehicle [N], 0 or more; it acts against the motion.
    ///
    /// NaN where the model speaks of single wheels only ([`Soil::needs_axles`]).
    fn resistance_n(&self, contact: &Contact) -> f64;

    /// As [`Soil::resistance_n`], for a soil that varies over the map.
    fn resistance_at_n(&self, contact: &Contact, place: &Place) -> f64 {
        let _ = place;
        self.resistance_n(contact)
    }

    /// What one wheel finds; `None` where the model knows whole vehicles only, which then do not slip.
    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        let _ = contact;
        None
    }

    /// Whether it speaks of single wheels only, so that a vehicle without axles cannot roll on it.
    fn needs_axles(&self) -> bool {
        false
    }

    /// What the ground is called at a place; `None` where it is the same everywhere.
    fn called(&self, place: &Place) -> Option<&str> {
        let _ = place;
        None
    }

    /// Whether it is made of other soils, which `ground.soils` names.
    fn needs_soils(&self) -> bool {
        false
    }

    /// Takes the soils that it is made of, by their names.
    ///
    /// # Errors
    /// [`Refusal`] where it is made of none, or of others.
    fn adopt(&mut self, soils: Vec<(String, Box<dyn Soil>)>) -> Result<(), Refusal> {
        let names: Vec<String> = soils.into_iter().map(|(name, _)| name).collect();
        Err(Refusal {
            parameter: "soils".to_owned(),
            found: names.join(", "),
            expected: "none: this soil is the same everywhere".to_owned(),
        })
    }
}
