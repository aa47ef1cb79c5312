//! Names of the hidden causes and of their parameters, as the contract has them.

use super::{Law, Told, parameter};

impl Law {
    /// The contract's id, or `unlisted`.
    pub fn id(&self) -> &'static str {
        match self {
            Self::Wind { .. } => "wind",
            Self::Grade { .. } => "grade",
            Self::GradeConstant { .. } => "grade_constant",
            Self::RotatingInertia { .. } => "rotating_inertia",
            Self::Mass { .. } => "mass",
            Self::PayloadChange { .. } => "payload_change",
            Self::AerodynamicDrag { .. } => "aerodynamic_drag",
            Self::RollingResistance { .. } => "rolling_resistance",
            Self::RollingSpeedLaw { .. } => "rolling_speed_law",
            Self::TyreWarmUp { .. } | Self::TyreCold { .. } => "rolling_temperature",
            Self::SoftGround { .. } => "soft_ground",
            Self::Multipass { .. } => "multipass",
            Self::NeutralDrag { .. } => "neutral_drag",
            Self::DrivelineTemperature { .. } => "driveline_temperature",
            Self::BrakeDrag { .. } => "brake_drag",
            Self::Braking { .. } => "braking",
            Self::CorneringDrag { .. } => "cornering_drag",
            Self::LoadDependence { .. } => "load_dependence",
            Self::DrawbarLoad { .. } | Self::DrawbarSpells { .. } => "drawbar_load",
            Self::SpeedThreshold { .. } => "speed_threshold",
            Self::DrivelineEfficiency { .. } => "driveline_efficiency",
            Self::VariatorLoss { .. } => "variator_loss",
            Self::ShiftTransient { .. } => "shift_transient",
            Self::WheelSlip { .. } => "wheel_slip",
            Self::AuxiliaryConstant { .. }
            | Self::AuxiliarySwitched { .. }
            | Self::AuxiliaryByCold { .. } => "auxiliary_power",
            Self::BatteryResistance { .. } => "battery_resistance",
            Self::EngineFriction { .. } => "engine_friction",
            Self::ColdStart { .. } => "cold_start",
            Self::TurboLag { .. } => "turbo_lag",
            Self::RegenerationLimit { .. } => "regeneration_limit",
            Self::Other(_) => "unlisted",
        }
    }

    /// Its parameters, where it has any that are numbers.
    pub fn told(&self) -> Vec<Told> {
        match self {
            Self::Wind { speed_m_s, from_rad } => {
                vec![parameter("speed_m_s", *speed_m_s, "m/s"), parameter("from_rad", *from_rad, "rad")]
            }
            Self::GradeConstant { grade } => vec![parameter("grade", *grade, "1")],
            Self::RotatingInertia { rotating_mass_kg } => {
                vec![parameter("rotating_mass_kg", *rotating_mass_kg, "kg")]
            }
            Self::Mass { extra_mass_kg } => vec![parameter("extra_mass_kg", *extra_mass_kg, "kg")],
            Self::AerodynamicDrag { extra_area_m2 } => vec![parameter("extra_area_m2", *extra_area_m2, "m²")],
            Self::RollingResistance { coefficient } | Self::WheelSlip { coefficient } => {
                vec![parameter("coefficient", *coefficient, "1")]
            }
            Self::TyreWarmUp { cold_coefficient, time_constant_s } => vec![
                parameter("cold_coefficient", *cold_coefficient, "1"),
                parameter("time_constant_s", *time_constant_s, "s"),
            ],
            Self::TyreCold { coefficient_per_k, .. } => {
                vec![parameter("coefficient_per_k", *coefficient_per_k, "1/K")]
            }
            Self::Multipass { coefficient, factor } => {
                vec![parameter("coefficient", *coefficient, "1"), parameter("factor", *factor, "1")]
            }
            Self::NeutralDrag { force_n, viscous_n_s_m } => {
                vec![parameter("force_n", *force_n, "N"), parameter("viscous_n_s_m", *viscous_n_s_m, "N s/m")]
            }
            Self::DrivelineTemperature { cold_force_n, cold_viscous_n_s_m, time_constant_s } => vec![
                parameter("cold_force_n", *cold_force_n, "N"),
                parameter("cold_viscous_n_s_m", *cold_viscous_n_s_m, "N s/m"),
                parameter("time_constant_s", *time_constant_s, "s"),
            ],
            Self::BrakeDrag { force_n } => vec![parameter("force_n", *force_n, "N")],
            Self::CorneringDrag { cornering_stiffness_n_per_rad } => {
                vec![parameter("cornering_stiffness_n_per_rad", *cornering_stiffness_n_per_rad, "N/rad")]
            }
            Self::LoadDependence { exponent, .. } => vec![parameter("exponent", *exponent, "1")],
            Self::DrawbarLoad { force_n, linear_n_s_m, from_s, to_s } => vec![
                parameter("force_n", *force_n, "N"),
                parameter("linear_n_s_m", *linear_n_s_m, "N s/m"),
                parameter("from_s", *from_s, "s"),
                parameter("to_s", *to_s, "s"),
            ],
            Self::SpeedThreshold { force_n, threshold_m_s, width_m_s } => vec![
                parameter("force_n", *force_n, "N"),
                parameter("threshold_m_s", *threshold_m_s, "m/s"),
                parameter("width_m_s", *width_m_s, "m/s"),
            ],
            Self::DrivelineEfficiency { loss } => vec![parameter("loss", *loss, "1")],
            Self::VariatorLoss { loss, node_m_s } => {
                vec![parameter("loss", *loss, "1"), parameter("node_speed_m_s", *node_m_s, "m/s")]
            }
            Self::ShiftTransient { force_n, speed_m_s, width_m_s } => vec![
                parameter("force_n", *force_n, "N"),
                parameter("speed_m_s", *speed_m_s, "m/s"),
                parameter("width_m_s", *width_m_s, "m/s"),
            ],
            Self::AuxiliaryConstant { power_w } => vec![parameter("power_w", *power_w, "W")],
            Self::AuxiliaryByCold { freezing_power_w, balance_temperature_c } => vec![
                parameter("freezing_power_w", *freezing_power_w, "W"),
                parameter("balance_temperature_c", *balance_temperature_c, "°C"),
            ],
            Self::BatteryResistance { resistance_ohm } => {
                vec![parameter("resistance_ohm", *resistance_ohm, "ohm")]
            }
            Self::EngineFriction { torque_n_m } => vec![parameter("torque_n_m", *torque_n_m, "N m")],
            Self::ColdStart { cold_torque_n_m, time_constant_s } => vec![
                parameter("cold_torque_n_m", *cold_torque_n_m, "N m"),
                parameter("time_constant_s", *time_constant_s, "s"),
            ],
            Self::TurboLag { time_constant_s, unboosted_power_w } => vec![
                parameter("time_constant_s", *time_constant_s, "s"),
                parameter("unboosted_power_w", *unboosted_power_w, "W"),
            ],
            Self::RegenerationLimit { power_w, no_speed_m_s, full_speed_m_s } => vec![
                parameter("power_w", *power_w, "W"),
                parameter("no_speed_m_s", *no_speed_m_s, "m/s"),
                parameter("full_speed_m_s", *full_speed_m_s, "m/s"),
            ],
            Self::Other(law) => law.told(),
            // The speed law's parameters move with the speed they refer to; the rest are functions of place or time.
            Self::RollingSpeedLaw { .. }
            | Self::Grade { .. }
            | Self::PayloadChange { .. }
            | Self::SoftGround { .. }
            | Self::Braking { .. }
            | Self::DrawbarSpells { .. }
            | Self::AuxiliarySwitched { .. } => Vec::new(),
        }
    }
}
