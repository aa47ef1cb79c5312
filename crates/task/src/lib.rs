//! What the vehicle works at: pulls, powers and payloads, one file each.

mod carriage;
mod draft_table;
mod drawbar;
mod fluctuation;
mod harvester;
mod hitch;
mod hydraulic;
mod load_sensing;
mod loader;
mod payload;
mod power_table;
mod pto_power;
mod rotary;
mod shaft_brake;
mod spreader;
mod tillage;
mod trailer;

pub use draft_table::{IMPLEMENTS, Implement, Per};
pub use drawbar::Drawbar;
pub use fluctuation::Fluctuation;
pub use harvester::Harvester;
pub use hydraulic::Hydraulic;
pub use load_sensing::LoadSensing;
pub use loader::Loader;
pub use power_table::{MACHINES, MACHINES_SOURCE, RotaryPower};
pub use pto_power::PtoPower;
pub use rotary::Rotary;
pub use shaft_brake::ShaftBrake;
pub use spreader::Spreader;
pub use tillage::Tillage;
pub use trailer::Trailer;

use headland_plugin::Registry;

/// Makes every task known, one line each.
pub fn register(registry: &mut Registry) {
    registry.task::<Drawbar>();
    registry.task::<PtoPower>();
    registry.task::<Hydraulic>();
    registry.task::<Tillage>();
    registry.task::<Rotary>();
    registry.task::<Harvester>();
    registry.task::<Spreader>();
    registry.task::<Trailer>();
    registry.task::<Loader>();
    registry.task::<LoadSensing>();
    registry.task::<ShaftBrake>();
}
