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
}

impl Unlisted {
    /// Force on the body, forward [N].
    pub fn forward_n(&self, now: &Now) -> f64 {
        let v = now.speed_m_s.max(0.0);
        match *self {
            Self::FadingWave { force_n, wavelength_m, phase_rad, fade_m } => {
                let x = now.position_m;
                -force_n * (TAU * x / wavelength_m + phase_rad).sin() * (-x.max(0.0) / fade_m).exp()
            }
            Self::ThreeHalves { force_n, speed_m_s } => -force_n * (v / speed_m_s).powf(1.5),
            Self::Sticking { force_n, speed_m_s } => -force_n / (1.0 + v / speed_m_s),
            Self::Lug { force_n, wavelength_m } => -force_n * (TAU * now.position_m / wavelength_m).sin(),
            Self::Hysteresis { force_n, acceleration_m_s2 } => {
                -force_n * (now.acceleration_m_s2 / acceleration_m_s2).tanh()
            }
            Self::Saturating { force_n, speed_m_s } => -force_n * (1.0 - (-v / speed_m_s).exp()),
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
        }
    }

    /// Its parameters. No diagnosis can name them, so they are told for people only.
    pub fn told(&self) -> Vec<Told> {
        match *self {
            Self::FadingWave { force_n, wavelength_m, phase_rad, fade_m } => vec![
                parameter("amplitude_n", force_n, "N"),
                parameter("wavelength_m", wavelength_m, "m"),
                parameter("phase_rad", phase_rad, "rad"),
                parameter("fade_m", fade_m, "m"),
            ],
            Self::Lug { force_n, wavelength_m } => {
                vec![parameter("amplitude_n", force_n, "N"), parameter("wavelength_m", wavelength_m, "m")]
            }
            Self::Hysteresis { force_n, acceleration_m_s2 } => vec![
                parameter("amplitude_n", force_n, "N"),
                parameter("scale_acceleration_m_s2", acceleration_m_s2, "m/s²"),
            ],
            Self::ThreeHalves { force_n, speed_m_s }
            | Self::Sticking { force_n, speed_m_s }
            | Self::Saturating { force_n, speed_m_s } => {
                vec![parameter("amplitude_n", force_n, "N"), parameter("scale_speed_m_s", speed_m_s, "m/s")]
            }
        }
    }
}
