//! Physics that a scenario adds to the bare vehicle, one effect at a time: one file each.

mod aerodynamic_drag;
mod auxiliary_power;
mod battery_resistance;
mod brake_drag;
mod braking;
mod cold_start;
mod cornering_drag;
mod drawbar_load;
mod driveline_efficiency;
mod driveline_temperature;
mod engine_friction;
mod expression;
mod grade;
mod grade_constant;
mod load_dependence;
mod mass;
mod multipass;
mod neutral_drag;
mod payload_change;
mod regeneration_limit;
mod rolling_resistance;
mod rolling_speed_law;
mod rolling_temperature;
mod rotating_inertia;
mod roughness;
mod series;
mod shift_transient;
mod side_slope;
mod soft_ground;
mod speed_threshold;
#[cfg(test)]
mod testing;
mod turbo_lag;
mod upstream;
mod variator_loss;
mod wheel_slip;
mod wind;

pub use aerodynamic_drag::AerodynamicDrag;
pub use auxiliary_power::AuxiliaryPower;
pub use battery_resistance::BatteryResistance;
pub use brake_drag::BrakeDrag;
pub use braking::Braking;
pub use cold_start::ColdStart;
pub use cornering_drag::CorneringDrag;
pub use drawbar_load::DrawbarLoad;
pub use driveline_efficiency::DrivelineEfficiency;
pub use driveline_temperature::DrivelineTemperature;
pub use engine_friction::EngineFriction;
pub use expression::Expression;
pub use grade::Grade;
pub use grade_constant::GradeConstant;
pub use load_dependence::LoadDependence;
pub use mass::Mass;
pub use multipass::Multipass;
pub use neutral_drag::NeutralDrag;
pub use payload_change::PayloadChange;
pub use regeneration_limit::RegenerationLimit;
pub use rolling_resistance::RollingResistance;
pub use rolling_speed_law::RollingSpeedLaw;
pub use rolling_temperature::RollingTemperature;
pub use rotating_inertia::RotatingInertia;
pub use roughness::Roughness;
pub use shift_transient::ShiftTransient;
pub use side_slope::SideSlope;
pub use soft_ground::SoftGround;
pub use speed_threshold::SpeedThreshold;
pub use turbo_lag::TurboLag;
pub use variator_loss::VariatorLoss;
pub use wheel_slip::WheelSlip;
pub use wind::Wind;

use headland_plugin::Registry;

/// Makes every effect known, one line each.
pub fn register(registry: &mut Registry) {
    // Motion.
    registry.effect::<Wind>();
    registry.effect::<Grade>();
    registry.effect::<GradeConstant>();
    registry.effect::<RotatingInertia>();
    registry.effect::<Mass>();
    registry.effect::<PayloadChange>();
    registry.effect::<AerodynamicDrag>();
    registry.effect::<RollingResistance>();
    registry.effect::<RollingSpeedLaw>();
    registry.effect::<RollingTemperature>();
    registry.effect::<SoftGround>();
    registry.effect::<Multipass>();
    registry.effect::<NeutralDrag>();
    registry.effect::<DrivelineTemperature>();
    registry.effect::<BrakeDrag>();
    registry.effect::<Braking>();
    registry.effect::<CorneringDrag>();
    registry.effect::<SideSlope>();
    registry.effect::<Roughness>();
    registry.effect::<LoadDependence>();
    registry.effect::<DrawbarLoad>();
    registry.effect::<SpeedThreshold>();
    // Slip and shaft.
    registry.effect::<WheelSlip>();
    registry.effect::<DrivelineEfficiency>();
    registry.effect::<VariatorLoss>();
    registry.effect::<ShiftTransient>();
    // Fuel and battery.
    registry.effect::<AuxiliaryPower>();
    registry.effect::<EngineFriction>();
    registry.effect::<TurboLag>();
    registry.effect::<ColdStart>();
    registry.effect::<RegenerationLimit>();
    registry.effect::<BatteryResistance>();
    // Whatever else there is.
    registry.effect::<Expression>();
}
