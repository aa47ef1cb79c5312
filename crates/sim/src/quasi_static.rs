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
use crate::cycle::{Hopeless, ON_TIME, Running, sliver};
use crate::ending::Ending;
use crate::reference::Reference;
use crate::step::{Control, FIRST_STATE, Machine, Moment, POSITION, SPEED, derive, sign};
use headland_plugin::{Delivery, Demand};

/// A speed nearer than this to what is wanted is what is wanted [m/s]: what the rounding of many steps leaves.
const AS_WANTED_M_S: f64 = 1e-9;

/// The same for an acceleration [m/s²].
const AS_WANTED_M_S2: f64 = 1e-9;

/// A piece of a speed over time, with who drives it.
pub(crate) struct Stretch<'a, C> {
    pub reference: &'a Reference,
    pub piece: usize,
    /// Where the piece ends.
    pub end_s: f64,
    pub control: &'a C,
    pub ending: &'a Ending,
    pub hopeless: Hopeless<'a>,
}

/// A step to come.
#[derive(Clone, Copy)]
struct Ahead {
    step_s: f64,
    /// Speed at its end.
    to_m_s: f64,
    /// Acceleration along it [m/s²].
    rate: f64,
    end_s: f64,
    /// Where the piece of the speed ends, or the phase.
    piece_end_s: f64,
    /// Whether a row is to be written.
    due: bool,
}

/// What became of a step.
enum Met {
    /// The motion is not known, or something happens within the step, be it that the path ends.
    Not,
    /// The piece of the speed ends, the phase does not.
    PieceEnds,
    Stepped,
}

impl Running<'_> {
    /// As [`Running::until`], along a piece of a speed over time.
    pub(crate) fn along(&mut self, stretch: &Stretch<impl Control>) -> Result<bool, String> {
        // Decided here, so that within a step there is only one kind of vehicle.
        if self.machine.model.axles.is_none() {
            self.along_as::<true>(stretch)
        } else {
            self.along_as::<false>(stretch)
        }
    }

    fn along_as<const WHOLE: bool>(&mut self, stretch: &Stretch<impl Control>) -> Result<bool, String> {
        let Stretch { end_s, control, ending, hopeless, .. } = *stretch;
        loop {
            match self.at_middle::<WHOLE>(stretch)? {
                Met::Stepped => {}
                Met::PieceEnds => return Ok(false),
                Met::Not => {
                    if let Some(ended) = self.one(control, ending, end_s, hopeless)? {
                        return Ok(ended);
                    }
                }
            }
        }
    }

    /// A step by the balance in its middle, once the driveline has decided.
    #[allow(clippy::inline_always, reason = "the inner loop")]
    #[inline(always)]
    fn at_middle<const WHOLE: bool>(&mut self, stretch: &Stretch<impl Control>) -> Result<Met, String> {
        let Stretch { reference, piece, end_s: piece_end_s, control, ending, hopeless } = *stretch;
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
        if !known || time_s >= self.cycle.longest_s {
            return Ok(Met::Not);
        }
        self.look_up()?;
        let half_s = 0.5 * step_s;
        let due = time_s + half_s > last_row_s + ON_TIME * self.record_s;
        let ahead = Ahead { step_s, to_m_s, rate, end_s, piece_end_s, due };
        let machine = &mut self.machine;
        let own = FIRST_STATE + machine.layout.driveline.start..FIRST_STATE + machine.layout.driveline.end;
        // An instant that comes of one place alone need not be put together; so each place goes on by itself.
        if own.is_empty() {
            let instant = machine.ask_middle::<false, WHOLE>(step_s, to_m_s, control);
            return self.go_on(&ahead, instant, ending, hopeless);
        }
        machine.scratch.deciding.before(&machine.y[own.clone()], half_s);
        let instant = machine.ask_middle::<true, WHOLE>(step_s, to_m_s, control);
        let deciding = &machine.scratch.deciding;
        if deciding.done {
            machine.y[own.clone()].copy_from_slice(&deciding.begin);
            if deciding.changed {
                machine.stage[own].copy_from_slice(&deciding.middle);
            }
            return self.go_on(&ahead, instant, ending, hopeless);
        }
        // What is asked hangs on what is given, so that has to be known first.
        let before = instant;
        if machine.decide(&before) {
            let instant = machine.ask_middle::<false, WHOLE>(step_s, to_m_s, control);
            return self.go_on(&ahead, instant, ending, hopeless);
        }
        self.go_on(&ahead, instant, ending, hopeless)
    }

    /// Goes to the end of the step by what came about in its middle.
    #[allow(clippy::inline_always, reason = "the inner loop")]
    #[allow(clippy::large_types_passed_by_value, reason = "inlined, it is not even put together")]
    #[inline(always)]
    fn go_on(
        &mut self,
        ahead: &Ahead,
        instant: Instant,
        ending: &Ending,
        hopeless: Hopeless,
    ) -> Result<Met, String> {
        let Ahead { step_s, to_m_s, rate, end_s, piece_end_s, due } = *ahead;
        let machine = &mut self.machine;
        // What is asked comes of the motion; where the drive gives it, the motion is what comes of that.
        let met = (instant.acceleration_m_s2 - rate).abs() <= AS_WANTED_M_S2 * (1.0 + rate.abs());
        if !met {
            return Ok(Met::Not);
        }
        machine.foresee_end(step_s, to_m_s, instant.effective_mass_kg);
        let end = machine.at_end(end_s);
        if ending.left(&end).min(self.ground.left_m(&end)) <= 0.0 {
            return Ok(Met::Not);
        }
        // What others may look at is a copy, made where they look: the instant itself is never put together.
        if due || hopeless.is_some() || machine.is_watched() {
            let seen = instant;
            self.look(&seen, 0.5 * step_s, due, hopeless)?;
        } else if machine.layout.driveline.is_empty() {
            // Who remembers nothing is never exhausted.
        } else if let Some(reason) = machine.exhausted_in_the_middle(instant.demand, instant.delivery) {
            return Err(reason);
        }
        self.machine.pass(end_s);
        // A phase that ends here has more to do.
        Ok(if end_s == piece_end_s && end_s < ending.end_s { Met::PieceEnds } else { Met::Stepped })
    }

    /// Asks everyone whether it can go on, and writes a row where one is due.
    #[inline(never)]
    fn look(&mut self, instant: &Instant, half_s: f64, due: bool, hopeless: Hopeless) -> Result<(), String> {
        let machine = &mut self.machine;
        let begin_s = machine.time_s;
        machine.swap_middle(half_s);
        let reason = machine.stuck().or_else(|| machine.no_further(instant, hopeless));
        if reason.is_none() && due {
            self.recorder.push(machine, instant);
        }
        machine.swap_middle(-half_s);
        machine.time_s = begin_s;
        reason.map_or(Ok(()), Err)
    }
}

impl Machine<'_> {
    /// Puts together where it comes to at the end of the step, for [`Machine::pass`].
    #[allow(clippy::inline_always, reason = "as the balance")]
    #[inline(always)]
    fn foresee_end(&mut self, step_s: f64, to_m_s: f64, mass_kg: f64) {
        let speed_m_s = self.y[SPEED];
        if mass_kg != self.mass_kg {
            self.book_mass(mass_kg);
        }
        let end = self.start[FIRST_STATE..].iter_mut();
        for ((value, start), rate) in end.zip(&self.y[FIRST_STATE..]).zip(&self.slopes[0][FIRST_STATE..]) {
            *value = start + step_s * rate;
        }
        self.start[POSITION] = self.y[POSITION] + 0.5 * step_s * (speed_m_s + to_m_s);
        self.start[SPEED] = to_m_s;
    }

    /// The balance in the middle of a step to the speed `to_m_s`. States there are foreseen with the rates of the step before.
    #[allow(clippy::inline_always, reason = "as the balance: nothing is put together that nobody looks at")]
    #[inline(always)]
    fn ask_middle<const DECIDES: bool, const WHOLE: bool>(
        &mut self,
        step_s: f64,
        to_m_s: f64,
        control: &impl Control,
    ) -> Instant {
        let half_s = 0.5 * step_s;
        let Self { model, layout, slots, scratch, y, stage, slopes: [slope, ..], .. } = self;
        let states = FIRST_STATE..FIRST_STATE + layout.states.len();
        let foreseen = stage[states.clone()].iter_mut();
        for ((value, start), rate) in foreseen.zip(&y[states.clone()]).zip(&slope[states]) {
            *value = start + half_s * rate;
        }
        let middle_m_s = 0.5 * (y[SPEED] + to_m_s);
        stage[POSITION] = y[POSITION] + 0.5 * half_s * (y[SPEED] + middle_m_s);
        stage[SPEED] = middle_m_s;
        let at = (self.time_s + half_s, sign(middle_m_s));
        derive::<DECIDES, WHOLE>((model, layout, slots, scratch), at, stage, control, slope)
    }

    /// Whether anybody but the driveline may stop it, or looks at what it does.
    fn is_watched(&self) -> bool {
        self.carriage.is_some() || self.model.axles.is_some() || !self.model.tasks.is_empty()
    }

    /// As [`Machine::exhausted`], in the middle of the step.
    #[inline(never)]
    fn exhausted_in_the_middle(&self, demand: Demand, delivery: Delivery) -> Option<String> {
        let own = &self.layout.driveline;
        let states = &self.stage[FIRST_STATE + own.start..FIRST_STATE + own.end];
        self.model.driveline.exhausted(&demand, &delivery, states)
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
