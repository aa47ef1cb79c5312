//! Sharing of power between an engine and a second store: one file each, and the optimum that they are measured against.

mod adaptive_ecms;
mod demanded;
mod ecms;
mod least;
mod load_levelling;
mod optimum;
#[cfg(test)]
mod plant;
mod thresholds;

pub use adaptive_ecms::AdaptiveEcms;
pub use demanded::{Demanded, Fineness, NotShared};
pub use ecms::Ecms;
pub use load_levelling::LoadLevelling;
pub use optimum::{Course, Grid, Sharing, Unreachable, optimum};
pub use thresholds::Thresholds;

use headland_plugin::Registry;

/// Makes every management known, one line each.
pub fn register(registry: &mut Registry) {
    registry.management::<Thresholds>();
    registry.management::<LoadLevelling>();
    registry.management::<Ecms>();
    registry.management::<AdaptiveEcms>();
}
