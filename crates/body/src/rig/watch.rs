//! What ends a run before its cycle does.

use super::Rig;
use super::carriage::SLIDES_M_S;
use crate::BodyError;
use crate::wheel::Wheel;
use std::f64::consts::FRAC_PI_2;

/// A vehicle that leans further than this has overturned: none that works stands so [cosine of 60°].
const OVERTURNED: f64 = 0.5;
/// Wheels that slip more than the limit for this long only dig [s].
const DIGS_S: f64 = 1.0;
/// A vehicle this many times the driver's look ahead beside its path has lost it.
const LOST: f64 = 2.0;

/// A speed as people read it, however large.
fn few_digits(speed_m_s: f64) -> String {
    if speed_m_s < 1e4 { format!("{speed_m_s:.1}") } else { format!("{speed_m_s:.1e}") }
}

impl Rig<'_> {
    /// Why a step that the world has made is none of this vehicle, which was pushed by a force of `force_n`.
    pub(super) fn impossible(&self, force_n: f64, step_s: f64) -> Option<String> {
        if let Some(wheel) = self.wheels.iter().find(|wheel| wheel.felt.gross_n.is_nan()) {
            let load_n = wheel.touch.load_n;
            return Some(format!(
                "{} sinks to its hub: the ground does not carry its {load_n:.0} N",
                wheel.told
            ));
        }
        if let Some(wheel) = self.wheels.iter().find(|wheel| !wheel.felt.resistance_n.is_finite()) {
            let resistance_n = wheel.felt.resistance_n;
            return Some(format!("{} is resisted by {resistance_n} N, expected a finite force", wheel.told));
        }
        if !self.world.is_finite() {
            return Some(format!(
                "after a step of {step_s} s under {force_n:.1e} N the motion is no finite number: expected forces of a size that \
                 such a vehicle knows"
            ));
        }
        let (before_m_s, after_m_s) = (self.state.speed_m_s(), self.world.state().speed_m_s());
        let footprint_m = self.wheels.iter().map(|wheel| wheel.footprint_m).fold(f64::INFINITY, f64::min);
        let speed_m_s = after_m_s.abs();
        if step_s * speed_m_s > footprint_m {
            return Some(format!(
                "at {} m/s a wheel rolls past its footprint in a step of {step_s} s: expected {:.1e} s at most",
                few_digits(speed_m_s),
                footprint_m / speed_m_s
            ));
        }
        // What resists stops a vehicle, and does not throw it back.
        let thrown = !self.resting && before_m_s * after_m_s <= 0.0 && speed_m_s > SLIDES_M_S;
        thrown.then(|| {
            format!(
                "a step of {step_s} s under {force_n:.1e} N turns {before_m_s:.1} m/s into {after_m_s:.1} m/s: expected a shorter \
                 step, or less that holds it back"
            )
        })
    }

    /// What is wrong after a step.
    pub(super) fn look(&mut self, step_s: f64) {
        let Some(told) = self.wrong(step_s) else { return };
        self.trouble.get_or_insert(told);
    }

    fn wrong(&mut self, step_s: f64) -> Option<String> {
        let state = &self.state;
        if state.up().z < OVERTURNED {
            let aside = if state.left().z.abs() > state.ahead().z.abs() { "its side" } else { "its end" };
            return Some(format!("the vehicle overturned onto {aside}"));
        }
        if let Some(towed) = &self.towed {
            if towed.state.up().z < OVERTURNED {
                return Some("the trailer overturned".to_owned());
            }
            let angle_rad = towed.angle_rad(&self.state).abs();
            if angle_rad > FRAC_PI_2 {
                return Some(format!(
                    "the trailer has jackknifed: it stands across the vehicle, at a hitch angle of {:.0}°",
                    angle_rad.to_degrees()
                ));
            }
        }
        if self.ground.turned(&self.track.place) {
            return Some(BodyError::NoSurface { position_m: self.track.position_m }.to_string());
        }
        let lost_m = LOST * self.steer.look_ahead_m();
        if self.track.left_m.abs() > lost_m {
            let left_m = self.track.left_m.abs();
            return Some(format!("the vehicle is {left_m:.1} m beside its path: it cannot steer so tightly"));
        }
        self.digging_s = if self.slip() > self.axles.slip_limit { self.digging_s + step_s } else { 0.0 };
        (self.digging_s > DIGS_S).then(|| {
            let most_n: f64 = self.wheels.iter().map(|wheel| wheel.felt.gross_n).sum();
            format!(
                "slip past the limit: with more than the {} that the vehicle may have the ground gives its driven \
                 wheels {most_n:.0} N, and they are asked for more",
                self.axles.slip_limit
            )
        })
    }

    /// Mean slip of the driven wheels.
    pub(super) fn slip(&self) -> f64 {
        let driven = |wheel: &&Wheel| self.axles.list()[wheel.axle].lead.is_some();
        let count = self.wheels.iter().filter(driven).count() as f64;
        self.wheels.iter().filter(driven).map(|wheel| wheel.slip).sum::<f64>() / count
    }
}
