//! Steps along a motion that is known beforehand: forces and powers are asked once a step, at its middle.
//!
//! v(t) = v₀ + a t, x(t) = x₀ + v₀ t + a t² / 2 within a step; y₁ = y₀ + h ẏ(t₀ + h / 2) for states and energies
//!
//! Source: the quasistatic method of Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 2.4, with the
//! midpoint rule (Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I* (1993), II.1) for what a model
//! remembers. Second order. The work of acceleration is met exactly, since its power is straight within a step; so the ledger
//! closes at any step.
//!
//! It holds where a driver who knows the resistances follows a speed over time, and the drive can. Everything else (a drive that
//! falls short, a speed by place, a coast-down, an end that comes within the step) is stepped by Runge and Kutta.

use crate::balance::Instant;
use crate::cycle::{Hopeless, MOST_STEPS, ON_TIME, Running, sliver};
use crate::ending::Ending;
use crate::reference::Reference;
use crate::step::{Control, FIRST_STATE, Machine, Moment, POSITION, SPEED, sign};

/// A speed nearer than this to what is wanted is what is wanted [m/s]: what the rounding of many steps leaves.
const AS_WANTED_M_S: f64 = 1e-9;

/// The same for an acceleration [m/s²].
const AS_WANTED_M_S2: f64 = 1e-9;

/// What became of a step.
enum Met {
    /// The motion is not known, or something happens within the step.
    Not,
    /// The piece of the speed ends, the phase does not.
    PieceEnds,
    Stepped,
}

impl Running<'_> {
    /// As [`Running::until`], along a piece of a speed over time.
    pub(crate) fn along(
        &mut self,
        (reference, piece): (&Reference, usize),
        control: &impl Control,
        ending: &Ending,
        piece_end_s: f64,
        hopeless: Hopeless,
    ) -> Result<bool, String> {
        loop {
            match self.at_middle((reference, piece), control, ending, piece_end_s, hopeless)? {
                Met::Stepped => {}
                Met::PieceEnds => return Ok(false),
                Met::Not => {
                    if let Some(ended) = self.one(control, ending, piece_end_s, hopeless)? {
                        return Ok(ended);
                    }
                }
            }
        }
    }

    #[allow(clippy::inline_always, reason = "the inner loop")]
    #[inline(always)]
    fn at_middle(
        &mut self,
        (reference, piece): (&Reference, usize),
        control: &impl Control,
        ending: &Ending,
        piece_end_s: f64,
        hopeless: Hopeless,
    ) -> Result<Met, String> {
        let machine = &mut self.machine;
        let (time_s, speed_m_s) = (machine.time_s, machine.speed_m_s());
        // The first row of a run stands at its begin, and the last of a phase at its end.
        let Some(last_row_s) = self.recorder.last_time_s() else { return Ok(Met::Not) };
        if time_s >= ending.end_s || ending.left(&machine.moment()) <= 0.0 {
            return Ok(Met::Not);
        }
        let piece_end_s = ending.end_s.min(piece_end_s);
        let left_s = piece_end_s - time_s;
        if left_s <= 0.0 {
            return Ok(Met::PieceEnds);
        }
        let step_s = sliver(left_s, self.cycle.step_s);
        let end_s = if step_s == left_s { piece_end_s } else { time_s + step_s };
        let ((from_m_s, rate), (to_m_s, _)) = (reference.on(piece, time_s), reference.on(piece, end_s));
        let known = (speed_m_s - from_m_s).abs() <= AS_WANTED_M_S && speed_m_s >= 0.0 && to_m_s >= 0.0;
        if !known || machine.steps >= MOST_STEPS || time_s >= self.cycle.longest_s {
            return Ok(Met::Not);
        }
        let Some(instant) = machine.middle(step_s, to_m_s, rate, control) else { return Ok(Met::Not) };
        if ending.left(&machine.at_end(end_s)) <= 0.0 {
            return Ok(Met::Not);
        }
        machine.swap_middle(0.5 * step_s);
        let reason = machine
            .stuck()
            .or_else(|| machine.exhausted(&instant))
            .or_else(|| hopeless(machine, &instant))
            .or_else(|| machine.trouble(&instant));
        if reason.is_none() && machine.time_s > last_row_s + ON_TIME * self.record_s {
            self.recorder.push(machine, &instant);
        }
        machine.swap_middle(-0.5 * step_s);
        machine.time_s = time_s;
        if let Some(reason) = reason {
            return Err(reason);
        }
        machine.pass(end_s);
        self.within_the_path()?;
        Ok(Met::Stepped)
    }
}

impl Machine<'_> {
    /// The balance in the middle of a step to the speed `to_m_s` at the rate `rate` [m/s²], once the driveline has decided;
    /// `None` where another acceleration comes of it. What the step comes to waits for [`Machine::pass`].
    #[allow(clippy::inline_always, reason = "as the balance: nothing is put together that nobody looks at")]
    #[inline(always)]
    fn middle(&mut self, step_s: f64, to_m_s: f64, rate: f64, control: &impl Control) -> Option<Instant> {
        let mut decided = false;
        let instant = loop {
            let instant = self.ask_middle(step_s, to_m_s, control);
            if decided || !self.decide(&instant) {
                break instant;
            }
            decided = true;
        };
        let met = (instant.acceleration_m_s2 - rate).abs() <= AS_WANTED_M_S2 * (1.0 + rate.abs());
        if !met {
            return None;
        }
        let speed_m_s = self.y[SPEED];
        if instant.effective_mass_kg != self.mass_kg {
            self.book_mass(instant.effective_mass_kg);
        }
        for ((value, start), rate) in
            self.start.iter_mut().zip(&self.y).zip(&self.slopes[0]).skip(FIRST_STATE)
        {
            *value = start + step_s * rate;
        }
        self.start[POSITION] = self.y[POSITION] + 0.5 * step_s * (speed_m_s + to_m_s);
        self.start[SPEED] = to_m_s;
        Some(instant)
    }

    /// States in the middle are foreseen with the rates of the step before.
    #[allow(clippy::inline_always, reason = "as the balance")]
    #[inline(always)]
    fn ask_middle(&mut self, step_s: f64, to_m_s: f64, control: &impl Control) -> Instant {
        let half_s = 0.5 * step_s;
        let mut y = std::mem::take(&mut self.stage);
        let mut slope = std::mem::take(&mut self.slopes[0]);
        for ((value, start), rate) in y.iter_mut().zip(&self.y).zip(&slope).skip(FIRST_STATE) {
            *value = start + half_s * rate;
        }
        let middle_m_s = 0.5 * (self.y[SPEED] + to_m_s);
        y[POSITION] = self.y[POSITION] + 0.5 * half_s * (self.y[SPEED] + middle_m_s);
        y[SPEED] = middle_m_s;
        let instant = self.derive(self.time_s + half_s, &y, sign(middle_m_s), control, &mut slope);
        (self.stage, self.slopes[0]) = (y, slope);
        instant
    }

    /// Stands in the middle of the step, or, with the negative time, back at its begin.
    fn swap_middle(&mut self, by_s: f64) {
        std::mem::swap(&mut self.y, &mut self.stage);
        self.time_s += by_s;
    }

    /// The moment at the end of the step.
    fn at_end(&self, time_s: f64) -> Moment<'_> {
        let states = &self.start[FIRST_STATE..FIRST_STATE + self.layout.states.len()];
        Moment { time_s, position_m: self.start[POSITION], speed_m_s: self.start[SPEED], states }
    }

    /// Goes to the end of the step.
    fn pass(&mut self, end_s: f64) {
        std::mem::swap(&mut self.start, &mut self.y);
        self.time_s = end_s;
        self.steps += 1;
    }
}
