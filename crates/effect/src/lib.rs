//! Physics that a scenario adds to the bare vehicle, one effect at a time: one file each.

use headland_plugin::Registry;

/// Makes every effect known, one line each.
pub fn register(_: &mut Registry) {}
