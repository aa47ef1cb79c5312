//! From the store of energy to the wheels: one file each.

mod battery_electric;
mod electric_single_speed;
mod engine;
mod engine_by_power;
mod engine_cvt;
mod full_load;
mod hybrid;
mod hydromechanical;
mod hydromechanical_cvt;
mod mapped_cvt;
mod motor;
mod neutral;
mod parallel_hybrid;
mod parts;
mod power_split_hybrid;
mod powershift;
mod series_hybrid;
mod store;

pub use battery_electric::BatteryElectric;
pub use electric_single_speed::ElectricSingleSpeed;
pub use engine_by_power::EngineByPower;
pub use engine_cvt::EngineCvt;
pub use hybrid::Managed;
pub use hydromechanical_cvt::HydromechanicalCvt;
pub use mapped_cvt::MappedCvt;
pub use neutral::Neutral;
pub use powershift::Powershift;

/// Engine and motor on one shaft.
pub type ParallelHybrid = Managed<parallel_hybrid::Parallel>;
/// An engine that only generates.
pub type SeriesHybrid = Managed<series_hybrid::Series>;
/// Engine, generator and wheels at a planetary.
pub type PowerSplitHybrid = Managed<power_split_hybrid::PowerSplit>;

use headland_plugin::Registry;

/// Makes every driveline known, one line each.
pub fn register(registry: &mut Registry) {
    registry.driveline::<Neutral>();
    registry.driveline::<EngineCvt>();
    registry.driveline::<EngineByPower>();
    registry.driveline::<HydromechanicalCvt>();
    registry.driveline::<MappedCvt>();
    registry.driveline::<Powershift>();
    registry.driveline::<ElectricSingleSpeed>();
    registry.driveline::<BatteryElectric>();
    registry.driveline::<ParallelHybrid>();
    registry.driveline::<SeriesHybrid>();
    registry.driveline::<PowerSplitHybrid>();
}
