//! The laws of the causes that the contract lists, written anew for the plant.
//!
//! Sources are those of the textbook quantities: the drag equation, Newton's law on an incline, Coulomb friction, slip
//! in proportion to pull (Wong, *Theory of Ground Vehicles* (2008)), warm-up as one time constant.

use super::unlisted::Unlisted;
use super::{Now, Push};

/// A spell of one run: index of the run, begin and end [s], and how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spell {
    /// Index of the run.
    pub run: usize,
    /// Begin [s].
    pub from_s: f64,
    /// End [s].
    pub to_s: f64,
    /// Force [N] or power [W].
    pub amount: f64,
}

/// One hidden cause.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "fields are named as the parameters are told")]
pub enum Law {
    Wind {
        speed_m_s: f64,
        from_rad: f64,
    },
    /// Waves of the grade: amplitude, wavelength [m], phase.
    Grade {
        waves: Vec<(f64, f64, f64)>,
    },
    GradeConstant {
        grade: f64,
    },
    RotatingInertia {
        rotating_mass_kg: f64,
    },
    Mass {
        extra_mass_kg: f64,
    },
    PayloadChange {
        from_s: f64,
        to_s: f64,
        mass_kg: f64,
    },
    AerodynamicDrag {
        extra_area_m2: f64,
    },
    RollingResistance {
        coefficient: f64,
    },
    RollingSpeedLaw {
        linear: f64,
        reference_speed_m_s: f64,
    },
    TyreWarmUp {
        cold_coefficient: f64,
        time_constant_s: f64,
    },
    TyreCold {
        coefficient_per_k: f64,
        reference_temperature_c: f64,
    },
    /// Patches: begin, end [m], coefficient; each axle meets them by itself.
    SoftGround {
        patches: Vec<(f64, f64, f64)>,
        half_wheelbase_m: f64,
    },
    Multipass {
        coefficient: f64,
        factor: f64,
    },
    NeutralDrag {
        force_n: f64,
        viscous_n_s_m: f64,
    },
    DrivelineTemperature {
        cold_force_n: f64,
        cold_viscous_n_s_m: f64,
        time_constant_s: f64,
    },
    BrakeDrag {
        force_n: f64,
    },
    Braking {
        spells: Vec<Spell>,
    },
    CorneringDrag {
        cornering_stiffness_n_per_rad: f64,
    },
    LoadDependence {
        coefficient: f64,
        exponent: f64,
        reference_mass_kg: f64,
    },
    DrawbarLoad {
        force_n: f64,
        linear_n_s_m: f64,
        from_s: f64,
        to_s: f64,
    },
    /// The same in spells of single runs.
    DrawbarSpells {
        spells: Vec<Spell>,
    },
    SpeedThreshold {
        force_n: f64,
        threshold_m_s: f64,
        width_m_s: f64,
    },
    DrivelineEfficiency {
        loss: f64,
    },
    VariatorLoss {
        loss: f64,
        node_m_s: f64,
    },
    ShiftTransient {
        force_n: f64,
        speed_m_s: f64,
        width_m_s: f64,
    },
    WheelSlip {
        coefficient: f64,
    },
    AuxiliaryConstant {
        power_w: f64,
    },
    AuxiliarySwitched {
        spells: Vec<Spell>,
    },
    AuxiliaryByCold {
        freezing_power_w: f64,
        balance_temperature_c: f64,
    },
    BatteryResistance {
        resistance_ohm: f64,
    },
    EngineFriction {
        torque_n_m: f64,
    },
    ColdStart {
        cold_torque_n_m: f64,
        time_constant_s: f64,
    },
    /// Remembers the power that boost gives [W].
    TurboLag {
        time_constant_s: f64,
        unboosted_power_w: f64,
    },
    RegenerationLimit {
        power_w: f64,
        no_speed_m_s: f64,
        full_speed_m_s: f64,
    },
    Other(Unlisted),
}

/// Time since the log began, none before [s].
fn since(now: &Now) -> f64 {
    now.time_s.max(0.0)
}

fn spell(spells: &[Spell], now: &Now) -> f64 {
    let inside =
        |spell: &&Spell| spell.run == now.run && now.time_s >= spell.from_s && now.time_s < spell.to_s;
    spells.iter().find(inside).map_or(0.0, |spell| spell.amount)
}

impl Law {
    /// What it does to the plant.
    #[allow(clippy::too_many_lines, reason = "one arm for each law")]
    pub fn push(&self, now: &Now) -> Push {
        let force = |forward_n: f64| Push { forward_n, ..Push::default() };
        let drag = |against_n: f64| force(-against_n);
        let weight = now.mass_kg * now.gravity_m_s2;
        let v = now.speed_m_s;
        match self {
            Self::Wind { speed_m_s, from_rad } => force(wind_n(now, *speed_m_s, *from_rad)),
            Self::Grade { waves } => {
                let wave = |(amplitude, length, phase): &(f64, f64, f64)| {
                    amplitude * (std::f64::consts::TAU * now.position_m / length + phase).sin()
                };
                slope(now, waves.iter().map(wave).sum())
            }
            Self::GradeConstant { grade } => slope(now, *grade),
            Self::RotatingInertia { rotating_mass_kg } => {
                Push { turning_kg: *rotating_mass_kg, ..Push::default() }
            }
            Self::Mass { extra_mass_kg } => Push { mass_kg: *extra_mass_kg, ..Push::default() },
            Self::PayloadChange { from_s, to_s, mass_kg } => {
                let share = ((now.time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
                Push { mass_kg: mass_kg * share, ..Push::default() }
            }
            Self::AerodynamicDrag { extra_area_m2 } => {
                drag(0.5 * now.air_density_kg_m3 * extra_area_m2 * now.air_speed_2)
            }
            Self::RollingResistance { coefficient } => drag(coefficient * weight),
            Self::RollingSpeedLaw { linear, reference_speed_m_s } => {
                drag(linear * weight * (v - reference_speed_m_s) / reference_speed_m_s)
            }
            Self::TyreWarmUp { cold_coefficient, time_constant_s } => {
                drag(cold_coefficient * weight / (since(now) / time_constant_s).exp())
            }
            Self::TyreCold { coefficient_per_k, reference_temperature_c } => {
                drag(coefficient_per_k * (reference_temperature_c - now.air_c) * weight)
            }
            Self::SoftGround { patches, half_wheelbase_m } => {
                let under = |place: f64| -> f64 {
                    patches
                        .iter()
                        .filter(|(from, to, _)| place >= *from && place < *to)
                        .map(|patch| patch.2)
                        .sum()
                };
                let front = under(now.position_m + half_wheelbase_m);
                let rear = under(now.position_m - half_wheelbase_m);
                drag(0.5 * (front + rear) * weight)
            }
            Self::Multipass { coefficient, factor } => {
                drag(coefficient * weight * ((now.passes_before * factor.ln()).exp() - 1.0))
            }
            Self::NeutralDrag { force_n, viscous_n_s_m } => {
                drag(if now.coasting { force_n + viscous_n_s_m * v } else { 0.0 })
            }
            Self::DrivelineTemperature { cold_force_n, cold_viscous_n_s_m, time_constant_s } => {
                drag((cold_force_n + cold_viscous_n_s_m * v) / (since(now) / time_constant_s).exp())
            }
            Self::BrakeDrag { force_n } => drag(*force_n),
            Self::Braking { spells } => {
                let force_n = spell(spells, now);
                Push { forward_n: -force_n, braked: force_n > 0.0, ..Push::default() }
            }
            Self::CorneringDrag { cornering_stiffness_n_per_rad } => {
                let side_n = now.mass_kg * now.curvature_per_m * v * v;
                drag(side_n * (side_n / cornering_stiffness_n_per_rad))
            }
            Self::LoadDependence { coefficient, exponent, reference_mass_kg } => {
                let ratio = now.mass_kg / reference_mass_kg;
                drag(coefficient * weight * (ratio.ln() * (exponent - 1.0)).exp_m1())
            }
            Self::DrawbarLoad { force_n, linear_n_s_m, from_s, to_s } => {
                let lowered = now.time_s >= *from_s && now.time_s < *to_s;
                drag(if lowered { force_n + linear_n_s_m * v } else { 0.0 })
            }
            Self::DrawbarSpells { spells } => drag(spell(spells, now)),
            Self::SpeedThreshold { force_n, threshold_m_s, width_m_s } => {
                drag(force_n * ((v - threshold_m_s) / width_m_s).clamp(0.0, 1.0))
            }
            Self::DrivelineEfficiency { loss } => drag(loss * now.drive_n.abs()),
            Self::VariatorLoss { loss, node_m_s } => {
                let away = (1.0 - v / node_m_s).abs().min(1.0);
                drag(loss * away * now.drive_n.abs())
            }
            Self::ShiftTransient { force_n, speed_m_s, width_m_s } => {
                let away = (v - speed_m_s) / width_m_s;
                drag(if now.coasting { 0.0 } else { force_n * (-0.5 * away * away).exp() })
            }
            Self::WheelSlip { coefficient } => Push { creep: *coefficient, ..Push::default() },
            Self::AuxiliaryConstant { power_w } => Push { power_w: *power_w, ..Push::default() },
            Self::AuxiliarySwitched { spells } => Push { power_w: spell(spells, now), ..Push::default() },
            Self::AuxiliaryByCold { freezing_power_w, balance_temperature_c } => {
                let share = ((balance_temperature_c - now.air_c) / balance_temperature_c).max(0.0);
                Push { power_w: freezing_power_w * share, ..Push::default() }
            }
            Self::BatteryResistance { resistance_ohm } => {
                Push { resistance_ohm: *resistance_ohm, ..Push::default() }
            }
            Self::EngineFriction { torque_n_m } => Push { engine_n_m: *torque_n_m, ..Push::default() },
            Self::ColdStart { cold_torque_n_m, time_constant_s } => {
                Push { engine_n_m: cold_torque_n_m / (since(now) / time_constant_s).exp(), ..Push::default() }
            }
            Self::TurboLag { .. } => Push::default(),
            Self::RegenerationLimit { .. } => force(now.overflow_n),
            Self::Other(law) => match law.power_w(now) {
                Some(power_w) => Push { power_w, ..Push::default() },
                None => force(law.forward_n(now)),
            },
        }
    }

    /// What it remembers after a step [s] more.
    pub fn remember(&self, now: &Now, step_s: f64) -> f64 {
        match self {
            Self::TurboLag { time_constant_s, unboosted_power_w } => {
                let wanted_w = (now.asked_n * now.speed_m_s - unboosted_power_w).max(0.0);
                now.memory + (wanted_w - now.memory) * step_s / time_constant_s
            }
            Self::Other(law) => law.remember(now),
            _ => now.memory,
        }
    }

    /// Least and greatest force that the drive may give at a speed of the wheels [N].
    pub fn limits_n(&self, memory: f64, wheel_m_s: f64) -> (f64, f64) {
        let at_m_s = wheel_m_s.max(0.1);
        match self {
            Self::TurboLag { unboosted_power_w, .. } => {
                (f64::NEG_INFINITY, (unboosted_power_w + memory) / at_m_s)
            }
            Self::RegenerationLimit { power_w, no_speed_m_s, full_speed_m_s } => {
                let share = ((wheel_m_s - no_speed_m_s) / (full_speed_m_s - no_speed_m_s)).clamp(0.0, 1.0);
                (-power_w * share / at_m_s, f64::INFINITY)
            }
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// What it amounts to: unit and value; forces are net and forward, a power is taken, a speed is that of the wheels.
    pub fn amount(&self, now: &Now, wheel_excess_m_s: f64) -> (&'static str, f64) {
        let push = self.push(now);
        let g = now.gravity_m_s2;
        match self {
            Self::WheelSlip { .. } => ("m_s", wheel_excess_m_s),
            Self::AuxiliaryConstant { .. }
            | Self::AuxiliarySwitched { .. }
            | Self::AuxiliaryByCold { .. } => ("w", in_source(now, push.power_w)),
            Self::Other(law) if law.is_power() => ("w", in_source(now, push.power_w)),
            Self::EngineFriction { .. } | Self::ColdStart { .. } => {
                ("w", push.engine_n_m * now.engine_rad_s * now.fuel_per_shaft)
            }
            Self::TurboLag { .. } => ("n", now.lacking_n),
            Self::BatteryResistance { resistance_ohm } => {
                ("w", resistance_ohm * now.current_a * now.current_a)
            }
            Self::Mass { .. } | Self::PayloadChange { .. } | Self::RotatingInertia { .. } => {
                let inertia_n = (push.mass_kg + push.turning_kg) * now.acceleration_m_s2;
                ("n", -inertia_n - push.mass_kg * g * now.ground_share)
            }
            Self::Grade { .. } | Self::GradeConstant { .. } => ("n", -now.mass_kg * g * push.sin_slope),
            _ => ("n", push.forward_n),
        }
    }
}

/// Power that a consumer takes from battery or tank [W].
fn in_source(now: &Now, power_w: f64) -> f64 {
    if now.fuel_per_shaft > 0.0 { power_w * now.shaft_per_electric * now.fuel_per_shaft } else { power_w }
}

/// Force of this wind minus that of the known one, from vectors in north and east.
fn wind_n(now: &Now, speed_m_s: f64, from_rad: f64) -> f64 {
    let way = [now.heading_rad.cos(), now.heading_rad.sin()];
    let blown = |wind: [f64; 2]| {
        let met: [f64; 2] = [now.speed_m_s * way[0] + wind[0], now.speed_m_s * way[1] + wind[1]];
        let pressure = 0.5 * now.air_density_kg_m3 * now.drag_area_m2 * met[0].hypot(met[1]);
        pressure * (met[0] * way[0] + met[1] * way[1])
    };
    let known = now.known_wind_m_s;
    blown(known) - blown([known[0] + speed_m_s * from_rad.cos(), known[1] + speed_m_s * from_rad.sin()])
}

fn slope(now: &Now, grade: f64) -> Push {
    let uphill = if now.reversed { -grade } else { grade };
    Push { sin_slope: uphill.atan().sin(), ..Push::default() }
}
