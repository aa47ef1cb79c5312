//! Where the wheels of a vehicle are, for those who draw it.

use crate::BodyError;
use crate::chassis::Chassis;
use crate::rig::{Towed, wheels};
use crate::wheel::Wheel;
use headland_sim::Model;

/// A wheel, or tyres side by side, at rest on level ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Hub {
    /// As its channels begin: `axle_1_left`.
    pub name: String,
    /// Ahead and to the left of the vehicle's own centre of gravity, and above the ground [m].
    pub place_m: [f64; 3],
    /// Radius without load [m].
    pub radius_m: f64,
    /// Of all its tyres together [m].
    pub width_m: f64,
    /// How far its suspension is squeezed [m]; 0 where it has none.
    pub squeezed_m: f64,
}

/// A trailer at rest on level ground.
#[derive(Clone, Debug, PartialEq)]
pub struct TrailerHubs {
    /// Its wheels, from its own centre of gravity.
    pub hubs: Vec<Hub>,
    /// Height of that above the ground [m].
    pub centre_height_m: f64,
    /// The coupling: ahead of its centre of gravity, and above the ground [m].
    pub coupling_m: [f64; 2],
}

/// The trailer of a vehicle; `None` where it has none.
///
/// # Errors
/// [`BodyError`] for a trailer that cannot be, or that no task tows.
pub fn trailer_hubs(model: &Model, chassis: &Chassis) -> Result<Option<TrailerHubs>, BodyError> {
    let axles = model.axles.as_ref().ok_or(BodyError::NoAxles)?;
    let Some(towed) = Towed::of(model, chassis, axles.hitch_height_m)? else { return Ok(None) };
    let centre = towed.centre();
    let hubs = towed.wheels.iter().map(|wheel| {
        let place_m = [wheel.arm.x - centre.x, wheel.arm.y, wheel.arm.z + axles.hitch_height_m];
        of_wheel(wheel, place_m)
    });
    Ok(Some(TrailerHubs {
        hubs: hubs.collect(),
        centre_height_m: centre.z + axles.hitch_height_m,
        coupling_m: [-centre.x, axles.hitch_height_m],
    }))
}

fn of_wheel(wheel: &Wheel, place_m: [f64; 3]) -> Hub {
    Hub {
        name: wheel.name.clone(),
        place_m,
        radius_m: 0.5 * wheel.tyre.diameter_m,
        width_m: wheel.tyres * wheel.tyre.width_m,
        squeezed_m: wheel.strut.map_or(0.0, |strut| strut.squeezed_m),
    }
}

/// All wheels of a vehicle, in the order of its axles.
///
/// # Errors
/// [`BodyError`] for a vehicle without axles, or a chassis that does not suit them.
pub fn hubs(model: &Model, chassis: &Chassis) -> Result<Vec<Hub>, BodyError> {
    let axles = model.axles.as_ref().ok_or(BodyError::NoAxles)?;
    chassis.check(axles)?;
    let mass = (model.vehicle.mass_kg, model.gravity_m_s2);
    let hub = |wheel: &Wheel| {
        of_wheel(wheel, [wheel.arm.x, wheel.arm.y, wheel.arm.z + axles.centre_of_gravity_height_m])
    };
    Ok(wheels(axles, chassis, mass).iter().map(hub).collect())
}
