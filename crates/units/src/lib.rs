//! Physical constants with their source, and conversions.
//!
//! Inside Headland every quantity is an SI number whose unit ends its name (`speed_m_s`). Text with another unit
//! (`"30 km/h"`, a log's `[mph]`) is converted once, at the edge, by this crate.

pub mod constants;
mod dimension;
mod quantity;
mod suffix;
mod unit;

pub use dimension::Dimension;
pub use quantity::{QuantityError, convert, parse_difference, parse_quantity};
pub use suffix::{stem, unit_of_name};
pub use unit::{Unit, UnitError, parse_unit};
