//! The trailer of a vehicle as a rigid body, as a scenario writes it.

use crate::axles::{TyreFile, tyre};
use crate::body::{SuspensionFile, suspension};
use headland_body::{AxleBody, Differential, Trailer, TrailerAxle};
use headland_plugin::Bound;
use serde::Deserialize;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "trailer")]
pub struct TrailerFile {
    pub centre_of_gravity_height_m: f64,
    pub roll_radius_m: f64,
    pub pitch_radius_m: f64,
    pub yaw_radius_m: f64,
    pub rotating_mass_kg: f64,
    pub axles: Vec<TrailerAxleFile>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "axle of the trailer")]
pub struct TrailerAxleFile {
    pub position_m: f64,
    pub track_m: f64,
    pub wheels: u32,
    pub tyre: TyreFile,
    pub damping_n_s_m: f64,
    pub friction: f64,
    pub side_friction: Option<f64>,
    pub slip_stiffness: f64,
    pub cornering_stiffness_per_rad: f64,
    pub relaxation_length_m: f64,
    pub suspension: Option<SuspensionFile>,
}

/// Bounds of the numbers of a trailer.
pub const TRAILER_BOUNDS: [(&str, Bound); 5] = [
    ("centre_of_gravity_height_m", Bound::Positive),
    ("roll_radius_m", Bound::Positive),
    ("pitch_radius_m", Bound::Positive),
    ("yaw_radius_m", Bound::Positive),
    ("rotating_mass_kg", Bound::Positive),
];

/// Bounds of those of each of its axles, beside what holds for any.
pub const TRAILER_AXLE_BOUNDS: [(&str, Bound); 2] =
    [("position_m", Bound::Within(-50.0, 0.0)), ("track_m", Bound::Within(0.1, 20.0))];

/// The trailer that a file says.
pub fn trailer(file: &TrailerFile) -> Trailer {
    let axle = |axle: &TrailerAxleFile| TrailerAxle {
        position_m: axle.position_m,
        track_m: axle.track_m,
        wheels: axle.wheels,
        tyre: tyre(&axle.tyre),
        body: AxleBody {
            damping_n_s_m: axle.damping_n_s_m,
            friction: axle.friction,
            side_friction: axle.side_friction.unwrap_or(axle.friction),
            slip_stiffness: axle.slip_stiffness,
            cornering_stiffness_per_rad: axle.cornering_stiffness_per_rad,
            relaxation_length_m: axle.relaxation_length_m,
            differential: Differential::Open,
            suspension: suspension(axle.suspension.as_ref()),
        },
    };
    Trailer {
        centre_of_gravity_height_m: file.centre_of_gravity_height_m,
        roll_radius_m: file.roll_radius_m,
        pitch_radius_m: file.pitch_radius_m,
        yaw_radius_m: file.yaw_radius_m,
        rotating_mass_kg: file.rotating_mass_kg,
        axles: file.axles.iter().map(axle).collect(),
    }
}
