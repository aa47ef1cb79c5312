//! What the vehicle works at: pulls and powers, one file each.

mod drawbar;
mod hydraulic;
mod pto_power;

pub use drawbar::Drawbar;
pub use hydraulic::Hydraulic;
pub use pto_power::PtoPower;

use headland_plugin::Registry;

/// Makes every task known, one line each.
pub fn register(registry: &mut Registry) {
    registry.task::<Drawbar>();
    registry.task::<PtoPower>();
    registry.task::<Hydraulic>();
}
