//! The plant: a body on a pitching suspension, wheels that turn and creep, integrated at 1 kHz.
//!
//! M dv/dt   = F_creep − R(v) N − ½ ρ A v² − M g sin θ + ΣF_hidden        body
//! m_w du/dt = F_drive − F_creep                                        rim of all wheels, m_w = Σ J / r²
//! F_creep   = N (u − v) / (k u)                                        k the creep for a pull as great as the load
//! φ''       = ω² (γ dv/dt − φ) − 2 ζ ω φ'                              pitch, nose up
//!
//! Sources: Newton; slip in proportion to pull, Wong, *Theory of Ground Vehicles* (2008), section 1.4; a sprung body as
//! one oscillator, Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter C.
//! Creep is stiff and is stepped by the implicit Euler rule, the sum of momenta exactly; forces are taken at mid-step.
//!
//! The wheels' inertia m_w is what a scenario calls `rotating_mass_kg`: a plant without hidden causes differs from its
//! nominal model only by creep (0.05 % for a pull as great as the load) and by the pitch that the sensors see.

mod driver;
mod electric;
mod engine;
mod motion;

pub use driver::{Driver, Goal};
pub use electric::Electric;
pub use engine::{Engine, Running};
pub(crate) use motion::{Begin, drive};
pub use motion::{Sample, Stop};

/// Step of the integration [s].
pub const STEP_S: f64 = 0.001;

/// Resistance of the ground over the load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// c (1 + v / v_s).
    Linear {
        /// At rest.
        coefficient: f64,
        /// Speed at which it has doubled [m/s].
        scale_m_s: f64,
    },
    /// c (1 + (v / v_s)²).
    Quadratic {
        /// At rest.
        coefficient: f64,
        /// Speed at which it has doubled [m/s].
        scale_m_s: f64,
    },
}

impl Ground {
    /// Resistance over load.
    pub fn share(&self, speed_m_s: f64) -> f64 {
        match *self {
            Self::Linear { coefficient, scale_m_s } => coefficient + coefficient * speed_m_s / scale_m_s,
            Self::Quadratic { coefficient, scale_m_s } => {
                let ratio = speed_m_s / scale_m_s;
                coefficient + coefficient * ratio * ratio
            }
        }
    }
}

/// The vehicle as it truly is, hidden causes left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// Mass on the wheels [kg].
    pub mass_kg: f64,
    /// Inertia of all that turns, at the rim [kg].
    pub turning_kg: f64,
    /// Drag area [m²].
    pub drag_area_m2: f64,
    /// The ground.
    pub ground: Ground,
    /// Density of the air [kg/m³].
    pub air_density_kg_m3: f64,
    /// Gravity [m/s²].
    pub gravity_m_s2: f64,
    /// Creep for a pull as great as the load.
    pub creep: f64,
    /// Nose-up pitch for each m/s² of acceleration [rad s²/m].
    pub pitch_gain_rad_s2_m: f64,
    /// Natural frequency of pitch [Hz].
    pub pitch_hz: f64,
    /// Damping ratio of pitch.
    pub pitch_damping: f64,
    /// Height of the speed antenna above the axis of pitch [m].
    pub antenna_m: f64,
    /// Battery and motor, where it has them.
    pub electric: Option<Electric>,
    /// Engine and transmission, where it has them.
    pub engine: Option<Engine>,
}

#[cfg(test)]
mod tests;
