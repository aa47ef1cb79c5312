//! What the ground does to a rolling vehicle: rolling-resistance laws of whole vehicles, traction and resistance of
//! single wheels, one file each.

mod bekker;
mod brixius;
mod bulldozing;
mod cone_index;
mod constant;
mod earth;
mod linear_speed_law;
mod mosaic;
mod pressure_speed_law;
mod quadratic_speed_law;
mod quadrature;
mod shear;
mod slip_sinkage;
mod soil_map;
#[cfg(test)]
mod testing;
mod wismer_luth;
mod wong_reece;
mod zones;

pub use bekker::Bekker;
pub use brixius::{Brixius, Construction};
pub use constant::Constant;
pub use earth::Earth;
pub use linear_speed_law::LinearSpeedLaw;
pub use pressure_speed_law::PressureSpeedLaw;
pub use quadratic_speed_law::QuadraticSpeedLaw;
pub use soil_map::SoilMap;
pub use wismer_luth::WismerLuth;
pub use wong_reece::WongReece;
pub use zones::Zones;

use headland_plugin::{Footing, Registry};

/// A wheel that has sunk to its hub: no number says what holds it.
const SUNK: Footing =
    Footing { gross_traction_n: f64::NAN, motion_resistance_n: f64::NAN, sinkage_m: f64::INFINITY };

/// Makes every soil model known, one line each.
pub fn register(registry: &mut Registry) {
    registry.soil::<Constant>();
    registry.soil::<LinearSpeedLaw>();
    registry.soil::<QuadraticSpeedLaw>();
    registry.soil::<PressureSpeedLaw>();
    registry.soil::<Brixius>();
    registry.soil::<WismerLuth>();
    registry.soil::<Bekker>();
    registry.soil::<WongReece>();
    registry.soil::<Zones>();
    registry.soil::<SoilMap>();
}
