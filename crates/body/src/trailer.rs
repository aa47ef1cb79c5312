//! What a towed machine needs to be told beside the mass and the resistance that its task knows.
//!
//! x_g = −(1 − k) x_a        the centre of gravity behind the coupling, for axles whose mean is x_a behind it
//!
//! Source: statics; the task says which share k of its mass the vehicle carries, so the place follows and nothing is said twice.

use crate::chassis::AxleBody;
use headland_plugin::{Refusal, Tyre};

/// A trailer as a body of its own, coupled to the vehicle where tasks pull.
#[derive(Clone, Debug, PartialEq)]
pub struct Trailer {
    /// Height of its centre of gravity above level ground, with and without load [m].
    pub centre_of_gravity_height_m: f64,
    /// Radius of gyration about the axis ahead, through its centre of gravity [m].
    pub roll_radius_m: f64,
    /// About the axis to the left.
    pub pitch_radius_m: f64,
    /// About the upright axis.
    pub yaw_radius_m: f64,
    /// What its wheels add to inertia, more than 0 [kg].
    pub rotating_mass_kg: f64,
    /// Its axles, from the coupling backward.
    pub axles: Vec<TrailerAxle>,
}

/// An axle of a trailer.
#[derive(Clone, Debug, PartialEq)]
pub struct TrailerAxle {
    /// Ahead of the coupling, and so less than 0 [m].
    pub position_m: f64,
    /// Distance of left and right wheels [m].
    pub track_m: f64,
    /// Number of its wheels.
    pub wheels: u32,
    /// What it rolls on.
    pub tyre: Tyre,
    /// Its tyres and its suspension.
    pub body: AxleBody,
}

impl Trailer {
    /// Stiffness of all tyres of an axle [N/m].
    pub(crate) fn stiffness_n_m(axle: &TrailerAxle) -> f64 {
        f64::from(axle.wheels) * axle.tyre.stiffness_n_per_m()
    }

    /// How far the mean of its axles is behind the coupling, stiffer ones counting more [m].
    pub(crate) fn behind_m(&self) -> f64 {
        let whole: f64 = self.axles.iter().map(Self::stiffness_n_m).sum();
        self.axles.iter().map(|axle| -axle.position_m * Self::stiffness_n_m(axle)).sum::<f64>() / whole
    }

    /// Whether it can be.
    ///
    /// # Errors
    /// [`Refusal`] names the parameter, as `trailer.axles.0.position_m`.
    pub(crate) fn check(&self) -> Result<(), Refusal> {
        let refuse = |parameter: String, found: String, expected: &str| {
            Err(Refusal { parameter: format!("trailer.{parameter}"), found, expected: expected.to_owned() })
        };
        if self.axles.is_empty() {
            return refuse("axles".to_owned(), "a list of 0".to_owned(), "one axle or more");
        }
        for (index, axle) in self.axles.iter().enumerate() {
            if axle.position_m >= 0.0 {
                let found = axle.position_m.to_string();
                return refuse(
                    format!("axles.{index}.position_m"),
                    found,
                    "less than 0: behind the coupling",
                );
            }
            if axle.wheels < 2 || axle.wheels % 2 == 1 {
                return refuse(
                    format!("axles.{index}.wheels"),
                    axle.wheels.to_string(),
                    "as many left as right",
                );
            }
            if 2.0 * axle.tyre.section_height_m >= axle.tyre.diameter_m {
                let found = axle.tyre.section_height_m.to_string();
                return refuse(
                    format!("axles.{index}.tyre.section_height_m"),
                    found,
                    "less than half of `diameter_m`",
                );
            }
        }
        let positive = [
            ("centre_of_gravity_height_m", self.centre_of_gravity_height_m),
            ("roll_radius_m", self.roll_radius_m),
            ("pitch_radius_m", self.pitch_radius_m),
            ("yaw_radius_m", self.yaw_radius_m),
            ("rotating_mass_kg", self.rotating_mass_kg),
        ];
        match positive.into_iter().find(|(_, found)| found.is_nan() || *found <= 0.0) {
            Some((name, found)) => refuse(name.to_owned(), found.to_string(), "more than 0"),
            None => Ok(()),
        }
    }
}
