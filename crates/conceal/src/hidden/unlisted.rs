//! Causes that no list holds: whoever finds them has to write the equation.

use super::{Now, Told, parameter};
use std::f64::consts::TAU;

/// A law without a name.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "fields are named as the parameters are told")]
pub enum Unlisted {
    /// F = −A sin(2π x/λ + φ) e^(−x/L), whichever way it is driven: firm and soft waves that fade along the lane.
    FadingWave { force_n: f64, wavelength_m: f64, phase_rad: f64, fade_m: f64 },
    /// F = −A (v/v₀)^1.5.
    ThreeHalves { force_n: f64, speed_m_s: f64 },
    /// F = −A / (1 + v/v₀): drag that lets go with speed.
    Sticking { force_n: f64, speed_m_s: f64 },
    /// F = −A sin(2π x/λ): lugs or a lump, once a turn.
    Lug { force_n: f64, wavelength_m: f64 },
    /// F = −A tanh(a/a₀): a force that turns with the sign of acceleration.
    Hysteresis { force_n: f64, acceleration_m_s2: f64 },
    /// F = −A (1 − e^(−v/v₀)): drag that saturates.
    Saturating { force_n: f64, speed_m_s: f64 },
    /// F = −A from the speed v₁ on until it falls below v₂: a flap that stays open.
    Latch { force_n: f64, on_m_s: f64, off_m_s: f64 },
    /// F = −A (v/v₀) / (1 + e^((T − T₀)/w)): grease that stiffens in the cold.
    Stiffening { force_n: f64, speed_m_s: f64, middle_c: f64, width_k: f64 },
    /// F = −A max(0, κ v²)/a₀: a wheel that rubs in right-hand bends only.
    OneSided { force_n: f64, side_m_s2: f64 },
    /// F = −A (v/v₀) |F_d|/F₀: a loss in proportion to drive force and speed, both.
    Product { force_n: f64, speed_m_s: f64, drive_n: f64 },
    /// F = −A in every second half of a period of time: a pump that is clocked.
    Clocked { force_n: f64, period_s: f64, phase_s: f64 },
    /// P = A (v/v₀)³: a fan that the wheels turn electrically.
    FanBySpeed { power_w: f64, speed_m_s: f64 },
    /// P = A |a|/a₀: a pump that works while speed changes.
    PumpByChange { power_w: f64, acceleration_m_s2: f64 },
}

impl Unlisted {
    /// Force on the body, forward [N].
    pub fn forward_n(&self, now: &Now) -> f64 {
        let v = now.speed_m_s.max(0.0);
        match *self {
            Self::FadingWave { force_n, wavelength_m, phase_rad, fade_m } => {
                let wave = (TAU * now.position_m / wavelength_m + phase_rad).sin();
                -force_n * wave * (-now.lane_position_m.max(0.0) / fade_m).exp()
            }
            Self::ThreeHalves { force_n, speed_m_s } => -force_n * (v / speed_m_s).powf(1.5),
            Self::Sticking { force_n, speed_m_s } => -force_n / (1.0 + v / speed_m_s),
            Self::Lug { force_n, wavelength_m } => -force_n * (TAU * now.position_m / wavelength_m).sin(),
            Self::Hysteresis { force_n, acceleration_m_s2 } => {
                -force_n * (now.acceleration_m_s2 / acceleration_m_s2).tanh()
            }
            Self::Saturating { force_n, speed_m_s } => -force_n * (1.0 - (-v / speed_m_s).exp()),
            Self::Latch { force_n, .. } => -force_n * now.memory,
            Self::Stiffening { force_n, speed_m_s, middle_c, width_k } => {
                -force_n * (v / speed_m_s) / (1.0 + ((now.air_c - middle_c) / width_k).exp())
            }
            Self::OneSided { force_n, side_m_s2 } => {
                -force_n * (now.curvature_per_m * v * v).max(0.0) / side_m_s2
            }
            Self::Product { force_n, speed_m_s, drive_n } => {
                -force_n * (v / speed_m_s) * now.drive_n.abs() / drive_n
            }
            Self::Clocked { force_n, period_s, phase_s } => {
                let turn = ((now.time_s + phase_s) / period_s).rem_euclid(1.0);
                if turn < 0.5 { 0.0 } else { -force_n }
            }
            Self::FanBySpeed { .. } | Self::PumpByChange { .. } => 0.0,
        }
    }

    /// Power that it takes from the electric consumers' side [W]; none for a force.
    pub fn power_w(&self, now: &Now) -> Option<f64> {
        match *self {
            Self::FanBySpeed { power_w, speed_m_s } => Some(power_w * (now.speed_m_s / speed_m_s).powi(3)),
            Self::PumpByChange { power_w, acceleration_m_s2 } => {
                Some(power_w * now.acceleration_m_s2.abs() / acceleration_m_s2)
            }
            _ => None,
        }
    }

    /// Whether it takes power and makes no force.
    pub fn is_power(&self) -> bool {
        self.power_w(&Now::default()).is_some()
    }

    /// What it remembers.
    pub fn remember(&self, now: &Now) -> f64 {
        match *self {
            Self::Latch { on_m_s, .. } if now.speed_m_s >= on_m_s => 1.0,
            Self::Latch { off_m_s, .. } if now.speed_m_s < off_m_s => 0.0,
            _ => now.memory,
        }
    }

    /// What it is called in the truth.
    pub fn name(&self) -> &'static str {
        match self {
            Self::FadingWave { .. } => "fading_wave",
            Self::ThreeHalves { .. } => "three_halves",
            Self::Sticking { .. } => "sticking",
            Self::Lug { .. } => "lug",
            Self::Hysteresis { .. } => "hysteresis",
            Self::Saturating { .. } => "saturating",
            Self::Latch { .. } => "latch",
            Self::Stiffening { .. } => "stiffening",
            Self::OneSided { .. } => "one_sided",
            Self::Product { .. } => "product",
            Self::Clocked { .. } => "clocked",
            Self::FanBySpeed { .. } => "fan_by_speed",
            Self::PumpByChange { .. } => "pump_by_change",
        }
    }

    /// Channels on which it depends: who finds it has to use these and no others.
    pub fn variables(&self) -> &'static [&'static str] {
        match self {
            Self::FadingWave { .. } | Self::Lug { .. } => &["position_m"],
            Self::ThreeHalves { .. }
            | Self::Sticking { .. }
            | Self::Saturating { .. }
            | Self::Latch { .. }
            | Self::FanBySpeed { .. } => &["speed_m_s"],
            Self::Hysteresis { .. } | Self::PumpByChange { .. } => &["acceleration_m_s2"],
            Self::Stiffening { .. } => &["speed_m_s", "air_temperature_c"],
            Self::OneSided { .. } => &["speed_m_s", "curvature_per_m"],
            Self::Product { .. } => &["speed_m_s", "force_n"],
            Self::Clocked { .. } => &["time_s"],
        }
    }

    /// Its parameters. No diagnosis can name them, so they are told for people only.
    pub fn told(&self) -> Vec<Told> {
        let newtons = |force_n: f64| parameter("amplitude_n", force_n, "N");
        let watts = |power_w: f64| parameter("amplitude_w", power_w, "W");
        let speed = |speed_m_s: f64| parameter("scale_speed_m_s", speed_m_s, "m/s");
        let acceleration = |value: f64| parameter("scale_acceleration_m_s2", value, "m/s²");
        match *self {
            Self::FadingWave { force_n, wavelength_m, phase_rad, fade_m } => vec![
                newtons(force_n),
                parameter("wavelength_m", wavelength_m, "m"),
                parameter("phase_rad", phase_rad, "rad"),
                parameter("fade_m", fade_m, "m"),
            ],
            Self::Lug { force_n, wavelength_m } => {
                vec![newtons(force_n), parameter("wavelength_m", wavelength_m, "m")]
            }
            Self::Hysteresis { force_n, acceleration_m_s2 } => {
                vec![newtons(force_n), acceleration(acceleration_m_s2)]
            }
            Self::ThreeHalves { force_n, speed_m_s }
            | Self::Sticking { force_n, speed_m_s }
            | Self::Saturating { force_n, speed_m_s } => vec![newtons(force_n), speed(speed_m_s)],
            Self::Latch { force_n, on_m_s, off_m_s } => vec![
                newtons(force_n),
                parameter("on_m_s", on_m_s, "m/s"),
                parameter("off_m_s", off_m_s, "m/s"),
            ],
            Self::Stiffening { force_n, speed_m_s, middle_c, width_k } => vec![
                newtons(force_n),
                speed(speed_m_s),
                parameter("middle_c", middle_c, "°C"),
                parameter("width_k", width_k, "K"),
            ],
            Self::OneSided { force_n, side_m_s2 } => vec![newtons(force_n), acceleration(side_m_s2)],
            Self::Product { force_n, speed_m_s, drive_n } => {
                vec![newtons(force_n), speed(speed_m_s), parameter("scale_drive_n", drive_n, "N")]
            }
            Self::Clocked { force_n, period_s, phase_s } => vec![
                newtons(force_n),
                parameter("period_s", period_s, "s"),
                parameter("phase_s", phase_s, "s"),
            ],
            Self::FanBySpeed { power_w, speed_m_s } => vec![watts(power_w), speed(speed_m_s)],
            Self::PumpByChange { power_w, acceleration_m_s2 } => {
                vec![watts(power_w), acceleration(acceleration_m_s2)]
            }
        }
    }
}
