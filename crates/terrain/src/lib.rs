//! Height, slope and heading along a path: one file each.

mod ab_lines;
mod constant_grade;
mod curve;
mod draped;
mod file;
mod flat;
mod gpx;
mod heightmap;
mod laid;
mod map_path;
mod marks;
mod plane;
mod profile;
mod route;
mod spiral;
mod spline;

pub use ab_lines::AbLines;
pub use constant_grade::ConstantGrade;
pub use flat::Flat;
pub use heightmap::Heightmap;
pub use profile::Profile;
pub use route::Route;
pub use spiral::Spiral;

use headland_plugin::Registry;

/// Makes every terrain known, one line each.
pub fn register(registry: &mut Registry) {
    registry.terrain::<Flat>();
    registry.terrain::<ConstantGrade>();
    registry.terrain::<Profile>();
    registry.terrain::<AbLines>();
    registry.terrain::<Spiral>();
    registry.terrain::<Route>();
    registry.terrain::<Heightmap>();
}
