//! The speed that a driver wants, over time, and what the driver does about it.

use crate::balance::{Command, Given};
use crate::plan::Pi;
use crate::step::Moment;

/// A speed over time since a phase began, linear between its points and constant beyond them.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    begin_s: f64,
    points: Vec<(f64, f64)>,
    /// Slope from each point to the next one; none behind the last.
    rates: Vec<f64>,
}

impl Reference {
    /// The same speed all the time.
    pub fn steady(begin_s: f64, speed_m_s: f64) -> Self {
        Self::along(begin_s, &[(0.0, speed_m_s)])
    }

    /// From one speed to another at a steady rate.
    pub fn ramp(begin_s: f64, from_m_s: f64, to_m_s: f64, rate_m_s2: f64) -> Self {
        let lasts_s = (to_m_s - from_m_s).abs() / rate_m_s2;
        if lasts_s == 0.0 {
            return Self::steady(begin_s, to_m_s);
        }
        Self::along(begin_s, &[(0.0, from_m_s), (lasts_s, to_m_s)])
    }

    /// Along points of time since the phase began and speed.
    pub fn along(begin_s: f64, points: &[(f64, f64)]) -> Self {
        let rate = |[(t0, v0), (t1, v1)]: &[(f64, f64); 2]| (v1 - v0) / (t1 - t0);
        let rates = points.array_windows().map(rate).chain([0.0]).collect();
        Self { begin_s, points: points.to_vec(), rates }
    }

    /// Instants at which its slope changes [s].
    pub fn corners_s(&self) -> Vec<f64> {
        self.points.iter().skip(1).map(|(after_s, _)| self.begin_s + after_s).collect()
    }

    /// Speed [m/s] and its slope [m/s²] on a piece, counted by its first point; behind the last point it stays.
    pub fn on(&self, piece: usize, time_s: f64) -> (f64, f64) {
        let ((t0, v0), rate) = (self.points[piece], self.rates[piece]);
        (v0 + rate * (time_s - self.begin_s - t0), rate)
    }

    /// Speed [m/s] and its slope at an instant; the slope behind a corner.
    pub fn at(&self, time_s: f64) -> (f64, f64) {
        let since_s = time_s - self.begin_s;
        match self.points.partition_point(|(at_s, _)| *at_s <= since_s).checked_sub(1) {
            Some(piece) => self.on(piece, time_s),
            None => (self.points.first().map_or(0.0, |(_, first)| *first), 0.0),
        }
    }

    /// Way from its begin to an instant [m].
    pub fn way_m(&self, until_s: f64) -> f64 {
        let last_s = until_s - self.begin_s;
        let ends_s = self.points.iter().skip(1).map(|(at_s, _)| *at_s).chain([f64::INFINITY]);
        let piece = |((from_s, speed), (end_s, rate)): (&(f64, f64), (f64, &f64))| {
            let lasts_s = (end_s.min(last_s) - from_s).max(0.0);
            speed * lasts_s + 0.5 * rate * lasts_s * lasts_s
        };
        self.points.iter().zip(ends_s.zip(&self.rates)).map(piece).sum()
    }

    /// Speed at an instant [m/s].
    pub fn speed_m_s(&self, time_s: f64) -> f64 {
        self.at(time_s).0
    }
}

/// Who drives.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Driver {
    /// Knows the resistances, and takes back an error of speed at this rate [1/s].
    Knowing(f64),
    /// Knows none.
    Pi(Pi),
}

impl Pi {
    /// What the driver does on a piece of the reference; `memory` is the place of the driver's state among all states.
    pub(crate) fn follow(
        &self,
        reference: &Reference,
        piece: usize,
        memory: Option<usize>,
        at: &Moment,
        given: &Given,
    ) -> (Command, Given) {
        let (wanted, _) = reference.on(piece, at.time_s);
        let ahead = reference.speed_m_s(at.time_s + self.preview_s);
        let gathered = memory.map_or(0.0, |index| at.states[index]);
        let integral = self.integral_per_s2 * gathered;
        let error = wanted - at.speed_m_s;
        let full = integral.abs() >= self.integral_limit_m_s2 && integral * error > 0.0;
        let given = Given { driver_rate: if full { 0.0 } else { error }, ..*given };
        (Command::Push(self.gain_per_s * (ahead - at.speed_m_s) + integral), given)
    }
}
