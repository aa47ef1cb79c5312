//! Height, slope and heading along a path: one file each.

mod constant_grade;
mod curve;
mod file;
mod flat;
mod profile;

pub use constant_grade::ConstantGrade;
pub use flat::Flat;
pub use profile::Profile;

use headland_plugin::Registry;

/// Makes every terrain known, one line each.
pub fn register(registry: &mut Registry) {
    registry.terrain::<Flat>();
    registry.terrain::<ConstantGrade>();
    registry.terrain::<Profile>();
}
