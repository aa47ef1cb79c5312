//! What drivers do whose speed is known beforehand, and what they keep at hand.
//!
//! These are types rather than closures so that they are inlined into every step: what is given is large and mostly nothing, and
//! is not even put together then.

#![allow(clippy::inline_always, reason = "the inner loop")]

use crate::balance::{Command, Given};
use crate::plan::EngineSpeed;
use crate::reference::Reference;
use crate::step::{Control, Moment};

/// What a driver keeps at hand in a phase, by time.
pub(crate) struct Hand {
    /// Whether the reverse is engaged.
    backward: bool,
    /// Speed of the engine [rad/s]; 0 where the driveline chooses.
    kept_rad_s: f64,
    /// The same over time.
    over: Option<Reference>,
}

impl Hand {
    /// In a phase that begins at `begin_s`.
    pub fn new(begin_s: f64, engine_speed: &EngineSpeed, backward: bool) -> Self {
        let (kept_rad_s, over) = match engine_speed {
            EngineSpeed::Free => (0.0, None),
            EngineSpeed::Kept(speed) => (*speed, None),
            EngineSpeed::Over(points) => (0.0, Some(Reference::along(begin_s, points))),
        };
        Self { backward, kept_rad_s, over }
    }

    #[inline(always)]
    pub fn given(&self, time_s: f64) -> Given {
        let engine_speed_rad_s = self.over.as_ref().map_or(self.kept_rad_s, |over| over.speed_m_s(time_s));
        Given { backward: self.backward, engine_speed_rad_s, ..Given::default() }
    }
}

/// Follows a piece of a speed over time, knows the resistances, and takes back an error of speed.
pub(crate) struct Knowing<'a> {
    /// Rate at which an error is taken back [1/s].
    pub gain_per_s: f64,
    pub reference: &'a Reference,
    /// Counted by its first point.
    pub piece: usize,
    pub hand: &'a Hand,
}

impl Control for Knowing<'_> {
    #[inline(always)]
    fn at(&self, at: &Moment) -> (Command, Given) {
        let (wanted, rate) = self.reference.on(self.piece, at.time_s);
        let acceleration = rate + self.gain_per_s * (wanted - at.speed_m_s);
        (Command::Accelerate(acceleration), self.hand.given(at.time_s))
    }
}

/// Stands with the brakes on.
pub(crate) struct Standing<'a>(pub &'a Hand);

impl Control for Standing<'_> {
    #[inline(always)]
    fn at(&self, at: &Moment) -> (Command, Given) {
        (Command::Accelerate(0.0), self.0.given(at.time_s))
    }
}
