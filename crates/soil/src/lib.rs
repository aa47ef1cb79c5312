//! What the ground does to a rolling vehicle: rolling-resistance laws, one file each.

mod constant;
mod linear_speed_law;
mod pressure_speed_law;
mod quadratic_speed_law;

pub use constant::Constant;
pub use linear_speed_law::LinearSpeedLaw;
pub use pressure_speed_law::PressureSpeedLaw;
pub use quadratic_speed_law::QuadraticSpeedLaw;

use headland_plugin::Registry;

/// Makes every soil model known, one line each.
pub fn register(registry: &mut Registry) {
    registry.soil::<Constant>();
    registry.soil::<LinearSpeedLaw>();
    registry.soil::<QuadraticSpeedLaw>();
    registry.soil::<PressureSpeedLaw>();
}
