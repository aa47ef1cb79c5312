//! From the store of energy to the wheels: one file each.

mod electric_single_speed;
mod engine_cvt;
mod full_load;
mod neutral;

pub use electric_single_speed::ElectricSingleSpeed;
pub use engine_cvt::EngineCvt;
pub use neutral::Neutral;

use headland_plugin::Registry;

/// Makes every driveline known, one line each.
pub fn register(registry: &mut Registry) {
    registry.driveline::<Neutral>();
    registry.driveline::<EngineCvt>();
    registry.driveline::<ElectricSingleSpeed>();
}
