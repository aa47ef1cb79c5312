//! Where the wheels of a vehicle are, for those who draw it.

use crate::BodyError;
use crate::chassis::Chassis;
use crate::rig::wheels;
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

/// All wheels of a vehicle, in the order of its axles.
///
/// # Errors
/// [`BodyError`] for a vehicle without axles, or a chassis that does not suit them.
pub fn hubs(model: &Model, chassis: &Chassis) -> Result<Vec<Hub>, BodyError> {
    let axles = model.axles.as_ref().ok_or(BodyError::NoAxles)?;
    chassis.check(axles)?;
    let of_wheel = |wheel: &Wheel| Hub {
        name: wheel.name.clone(),
        place_m: [wheel.arm.x, wheel.arm.y, wheel.arm.z + axles.centre_of_gravity_height_m],
        radius_m: 0.5 * wheel.tyre.diameter_m,
        width_m: wheel.tyres * wheel.tyre.width_m,
        squeezed_m: wheel.strut.map_or(0.0, |strut| strut.squeezed_m),
    };
    Ok(wheels(axles, chassis, model.vehicle.mass_kg * model.gravity_m_s2).iter().map(of_wheel).collect())
}
