//! One step of the classical Runge-Kutta method, and the instant within a step at which something happens.
//!
//! Source: Hairer, Nørsett and Wanner, *Solving Ordinary Differential Equations I* (1993), II.1. Fourth order where the
//! right-hand side is smooth. Energies are integrated beside the motion with the same weights, so that the ledger
//! closes as well as the motion is resolved.

use crate::Model;
use crate::balance::{Command, Given, Instant, Point, Scratch};
use crate::borne::Borne;
use crate::carriage::Carriage;
use crate::cycle::Hopeless;
use crate::deciding::Deciding;
use crate::ledger::{MASS_CHANGE, Slots};
use crate::model::Layout;
use crate::wheels::{AxleState, WheelScratch};

/// Where a machine is, what it does and what its models remember.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment<'a> {
    pub time_s: f64,
    pub position_m: f64,
    pub speed_m_s: f64,
    pub states: &'a [f64],
}

/// What the driver does at a moment.
pub(crate) trait Control {
    /// Command and recorded circumstances.
    fn at(&self, moment: &Moment) -> (Command, Given);
}

impl<F: Fn(&Moment) -> (Command, Given)> Control for F {
    #[allow(clippy::inline_always, reason = "see the balance")]
    #[inline(always)]
    fn at(&self, moment: &Moment) -> (Command, Given) {
        self(moment)
    }
}

pub(crate) const POSITION: usize = 0;
pub(crate) const SPEED: usize = 1;
pub(crate) const FIRST_STATE: usize = 2;

/// A model in motion.
#[derive(Debug)]
pub(crate) struct Machine<'a> {
    pub model: &'a Model,
    pub layout: Layout,
    pub slots: Slots,
    pub time_s: f64,
    pub steps: usize,
    /// What moves it; `None` where the longitudinal balance does.
    pub carriage: Option<Box<dyn Carriage + 'a>>,
    /// What the models push the carriage with.
    pub(crate) borne: Borne,
    /// Position, speed, states, energies.
    pub(crate) y: Vec<f64>,
    pub(crate) scratch: Scratch,
    pub(crate) start: Vec<f64>,
    pub(crate) stage: Vec<f64>,
    pub(crate) slopes: [Vec<f64>; 4],
    pub(crate) first_kinetic_j: Option<f64>,
    pub(crate) mass_kg: f64,
    /// Effective mass at the second, third and fourth stage of the last step [kg].
    stage_masses_kg: [f64; 3],
    /// Speed at those stages [m/s].
    stage_speeds_m_s: [f64; 3],
}

impl<'a> Machine<'a> {
    pub fn new(model: &'a Model, time_s: f64, position_m: f64, speed_m_s: f64) -> Self {
        Self::laid_out(model, model.layout(), time_s, position_m, speed_m_s)
    }

    /// With a driver who remembers one number, called `name` in the trace.
    pub fn with_driver(model: &'a Model, name: &str, position_m: f64, speed_m_s: f64) -> Self {
        let mut layout = model.layout();
        layout.driver = Some(layout.states.len());
        layout.states.push((name.to_owned(), 0.0));
        Self::laid_out(model, layout, 0.0, position_m, speed_m_s)
    }

    fn laid_out(model: &'a Model, layout: Layout, time_s: f64, position_m: f64, speed_m_s: f64) -> Self {
        let slots = Slots::of(model);
        let mut y = vec![position_m, speed_m_s];
        y.extend(layout.states.iter().map(|(_, initial)| *initial));
        y.resize(y.len() + slots.count(), 0.0);
        let zero = vec![0.0; y.len()];
        let scratch = Scratch {
            actions: vec![headland_plugin::Action::default(); model.effects.len()],
            modes: vec![headland_plugin::Mode::default(); model.tasks.len()],
            wheels: WheelScratch::default(),
            deciding: Deciding::default(),
        };
        Self {
            model,
            layout,
            slots,
            time_s,
            steps: 0,
            carriage: None,
            borne: Borne::default(),
            scratch,
            start: zero.clone(),
            stage: zero.clone(),
            slopes: [zero.clone(), zero.clone(), zero.clone(), zero],
            y,
            first_kinetic_j: None,
            mass_kg: f64::NAN,
            stage_masses_kg: [f64::NAN; 3],
            stage_speeds_m_s: [f64::NAN; 3],
        }
    }

    pub fn position_m(&self) -> f64 {
        self.y[POSITION]
    }

    pub fn speed_m_s(&self) -> f64 {
        self.y[SPEED]
    }

    pub fn states(&self) -> &[f64] {
        &self.y[FIRST_STATE..FIRST_STATE + self.layout.states.len()]
    }

    pub fn energies_j(&self) -> &[f64] {
        &self.y[FIRST_STATE + self.layout.states.len()..]
    }

    /// Sets the motion, as at the start of a window; states and energies stay.
    pub fn set_motion(&mut self, position_m: f64, speed_m_s: f64) {
        self.y[POSITION] = position_m;
        self.y[SPEED] = speed_m_s;
    }

    pub fn set_state(&mut self, index: usize, value: f64) {
        self.y[FIRST_STATE + index] = value;
    }

    /// Acceleration at an instant: that of the forces, or that of the last step where a carriage makes it [m/s²].
    pub fn acceleration_m_s2(&self, instant: &Instant) -> f64 {
        let of_step = self.carriage.as_ref().and_then(|carriage| carriage.motion().acceleration_m_s2);
        of_step.unwrap_or(instant.acceleration_m_s2)
    }

    /// The moment at which the machine stands.
    pub fn moment(&self) -> Moment<'_> {
        Moment {
            time_s: self.time_s,
            position_m: self.y[POSITION],
            speed_m_s: self.y[SPEED],
            states: self.states(),
        }
    }

    /// Why a task cannot do what it is told.
    pub fn trouble(&self, instant: &Instant) -> Option<String> {
        let tasks = self.model.tasks.iter().zip(&self.layout.tasks).zip(&self.scratch.modes);
        tasks.into_iter().find_map(|((task, range), mode)| {
            let own = &self.states()[range.clone()];
            let reason = task.plugin.trouble(*mode, &instant.situation, own)?;
            Some(format!("{}: {reason}", task.name))
        })
    }

    /// What each task is told to do from now on.
    pub fn modes(&mut self) -> &mut [headland_plugin::Mode] {
        &mut self.scratch.modes
    }

    /// Why its wheels cannot go on.
    pub fn stuck(&self) -> Option<String> {
        if let Some(carriage) = &self.carriage {
            return carriage.trouble();
        }
        let limit = self.model.axles.as_ref()?.slip_limit;
        self.scratch.wheels.stuck.map(|stuck| stuck.in_words(limit))
    }

    /// What each axle does; none where the vehicle rolls as a whole.
    pub fn axle_states(&self) -> &[AxleState] {
        &self.scratch.wheels.axles
    }

    pub fn effect_actions(&self) -> &[headland_plugin::Action] {
        &self.scratch.actions
    }

    /// The balance where the machine stands, after driveline and effects have decided what they decide between two steps. The
    /// direction of a machine at rest is what the forces make of it.
    pub fn instant(&mut self, control: &impl Control) -> Instant {
        let mut instant = self.as_decided(control);
        if self.decide(&instant) {
            instant = self.as_decided(control);
        }
        instant
    }

    /// Why the driveline cannot go on.
    pub fn exhausted(&self, instant: &Instant) -> Option<String> {
        let own = self.layout.driveline.clone();
        if own.is_empty() {
            return None;
        }
        self.model.driveline.exhausted(&instant.demand, &instant.delivery, &self.states()[own])
    }

    /// Why it cannot go on from an instant: the driveline, the driver or a task says so.
    pub fn no_further(&self, instant: &Instant, hopeless: Hopeless) -> Option<String> {
        self.exhausted(instant)
            .or_else(|| hopeless.and_then(|hopeless| hopeless(self, instant)))
            .or_else(|| self.trouble(instant))
    }

    /// Lets the driveline and the effects decide; says whether anything changed. Who remembers nothing decides nothing.
    pub(crate) fn decide(&mut self, instant: &Instant) -> bool {
        let Self { model, layout, y, .. } = self;
        let own = |range: &std::ops::Range<usize>| FIRST_STATE + range.start..FIRST_STATE + range.end;
        let mut changed = !layout.driveline.is_empty()
            && model.driveline.decide(&instant.demand, &mut y[own(&layout.driveline)]);
        for (effect, range) in
            model.effects.iter().zip(&layout.effects).filter(|(_, range)| !range.is_empty())
        {
            changed |= effect.plugin.decide(&instant.situation, &mut y[own(range)]);
        }
        changed
    }

    /// The balance where the machine stands.
    fn as_decided(&mut self, control: &impl Control) -> Instant {
        if self.carriage.is_some() {
            return self.borne_instant(control);
        }
        let y = std::mem::take(&mut self.y);
        let mut slope = std::mem::take(&mut self.slopes[0]);
        let direction = sign(y[SPEED]);
        let instant = self.derive(self.time_s, &y, direction, control, &mut slope);
        self.y = y;
        self.slopes[0] = slope;
        if self.first_kinetic_j.is_none() {
            self.first_kinetic_j = Some(self.kinetic_j(instant.effective_mass_kg));
            self.mass_kg = instant.effective_mass_kg;
        } else if instant.effective_mass_kg != self.mass_kg {
            self.book_mass(instant.effective_mass_kg);
        }
        instant
    }

    fn kinetic_j(&self, mass_kg: f64) -> f64 {
        0.5 * mass_kg * self.y[SPEED] * self.y[SPEED]
    }

    /// Gain of kinetic energy since the first instant [J].
    pub fn kinetic_gain_j(&self) -> f64 {
        let now_j = match &self.carriage {
            Some(carriage) => carriage.kinetic_j(),
            None => self.kinetic_j(self.mass_kg),
        };
        self.first_kinetic_j.map_or(0.0, |first| now_j - first)
    }

    #[allow(clippy::inline_always, reason = "see the balance")]
    #[inline(always)]
    pub(crate) fn derive(
        &mut self,
        time_s: f64,
        y: &[f64],
        direction: f64,
        control: &impl Control,
        slope: &mut [f64],
    ) -> Instant {
        let Self { model, layout, slots, scratch, .. } = self;
        derive::<false, false>((model, layout, slots, scratch), (time_s, direction), y, control, slope)
    }

    /// Steps from the instant that [`Machine::instant`] found, by `step_s` or to the first time at which `event` falls
    /// to zero or the vehicle comes to rest. Returns the time stepped [s].
    pub fn step(
        &mut self,
        first: &Instant,
        step_s: f64,
        control: &impl Control,
        event: impl Fn(&Moment) -> f64,
    ) -> f64 {
        self.steps += 1;
        if self.carriage.is_some() {
            return self.borne_step(step_s, &event);
        }
        std::mem::swap(&mut self.start, &mut self.y);
        let from_rest = self.start[SPEED] == 0.0;
        let direction = if from_rest { sign(first.acceleration_m_s2) } else { sign(self.start[SPEED]) };
        let begin_s = self.time_s;
        let states = FIRST_STATE..FIRST_STATE + self.layout.states.len();
        let measure = |y: &[f64], step: f64| {
            let ahead = if from_rest { f64::INFINITY } else { y[SPEED] * direction };
            let (position_m, speed_m_s) = (y[POSITION], y[SPEED]);
            let time_s = begin_s + step;
            event(&Moment { time_s, position_m, speed_m_s, states: &y[states.clone()] }).min(ahead)
        };
        self.runge_kutta(step_s, direction, control);
        let mut taken = step_s;
        let end = measure(&self.y, step_s);
        if end <= 0.0 {
            taken = self.locate(step_s, end, direction, control, &measure);
        }
        let stopped = !from_rest && self.y[SPEED] * direction <= SPEED_AT_REST_M_S;
        if direction == 0.0 || stopped || (from_rest && self.y[SPEED] * direction < 0.0) {
            self.y[SPEED] = 0.0;
        }
        self.time_s = begin_s + taken;
        if self.stage_masses_kg != [first.effective_mass_kg; 3] {
            self.book_masses(first.effective_mass_kg);
        }
        taken
    }

    /// Books the kinetic energy that mass brings or takes along a step, ∫ ½ v² dm, from the mass at its first stage on.
    ///
    /// Mass and the square of speed are parabolas through the stages, and their product is integrated by Simpson's rule.
    fn book_masses(&mut self, first_kg: f64) {
        let [second, third, last] = self.stage_masses_kg;
        let middle = 0.5 * (second + third);
        let square = |speed: f64| speed * speed;
        let begin = square(self.start[SPEED]);
        let half = 0.5 * (square(self.stage_speeds_m_s[0]) + square(self.stage_speeds_m_s[1]));
        let end = square(self.stage_speeds_m_s[2]);
        let gain = begin * (4.0 * middle - 3.0 * first_kg - last)
            + half * 4.0 * (last - first_kg)
            + end * (first_kg - 4.0 * middle + 3.0 * last);
        let account = FIRST_STATE + self.layout.states.len() + MASS_CHANGE;
        self.y[account] -= 0.5 * gain / 6.0;
        self.mass_kg = last;
    }

    /// Books the kinetic energy that mass brings when it comes aboard, or is coupled, at speed.
    pub(crate) fn book_mass(&mut self, mass_kg: f64) {
        let gain = 0.5 * (mass_kg - self.mass_kg) * self.y[SPEED] * self.y[SPEED];
        let account = FIRST_STATE + self.layout.states.len() + MASS_CHANGE;
        self.y[account] -= gain;
        self.mass_kg = mass_kg;
    }

    /// Moves on along a motion that is known: states and energies by the trapezoidal rule, from the rates before (as
    /// [`Machine::rates`] gave them) to those of the new instant. Returns that instant.
    pub fn follow(
        &mut self,
        time_s: f64,
        position_m: f64,
        speed_m_s: f64,
        before: &[f64],
        control: &impl Control,
    ) -> Instant {
        self.steps += 1;
        let step_s = time_s - self.time_s;
        self.start.copy_from_slice(&self.y);
        for (value, rate) in self.y.iter_mut().zip(before).skip(FIRST_STATE) {
            *value += step_s * rate;
        }
        self.time_s = time_s;
        self.set_motion(position_m, speed_m_s);
        let instant = self.as_decided(control);
        let rates = before.iter().zip(&self.slopes[0]);
        for ((value, start), (before, after)) in
            self.y.iter_mut().zip(&self.start).zip(rates).skip(FIRST_STATE)
        {
            *value = start + 0.5 * step_s * (before + after);
        }
        // The energies of the step are booked; only now may anything be decided.
        if self.decide(&instant) { self.as_decided(control) } else { instant }
    }

    /// Rates of change at the last instant: speed, acceleration, rates of the states, powers.
    pub fn rates(&self) -> &[f64] {
        &self.slopes[0]
    }

    fn runge_kutta(&mut self, step_s: f64, direction: f64, control: &impl Control) {
        /// Where the stages stand in the step.
        const NODES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];
        for (stage, node) in NODES.into_iter().enumerate().skip(1) {
            let mut y = std::mem::take(&mut self.stage);
            let mut slope = std::mem::take(&mut self.slopes[stage]);
            let lead = node * step_s;
            for ((value, start), before) in y.iter_mut().zip(&self.start).zip(&self.slopes[stage - 1]) {
                *value = start + lead * before;
            }
            let instant = self.derive(self.time_s + lead, &y, direction, control, &mut slope);
            self.stage_masses_kg[stage - 1] = instant.effective_mass_kg;
            self.stage_speeds_m_s[stage - 1] = y[SPEED];
            self.stage = y;
            self.slopes[stage] = slope;
        }
        let [k1, k2, k3, k4] = &self.slopes;
        let slopes = k1.iter().zip(k2).zip(k3).zip(k4);
        for ((value, start), (((k1, k2), k3), k4)) in self.y.iter_mut().zip(&self.start).zip(slopes) {
            let mean = (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
            *value = start + step_s * mean;
        }
    }

    /// Shortens the step until `measure` is zero (Illinois variant of the secant method).
    fn locate(
        &mut self,
        step_s: f64,
        end: f64,
        direction: f64,
        control: &impl Control,
        measure: &impl Fn(&[f64], f64) -> f64,
    ) -> f64 {
        const MOST_ITERATIONS: usize = 60;
        const RELATIVE_TOLERANCE: f64 = 1e-13;
        let (mut low, mut high) = (0.0, step_s);
        let (mut at_low, mut at_high) = (measure(&self.start, 0.0), end);
        if at_low <= 0.0 || at_low.is_nan() {
            return step_s;
        }
        let mut step = high;
        let mut side = 0;
        for _ in 0..MOST_ITERATIONS {
            if at_high == 0.0 || high - low <= RELATIVE_TOLERANCE * step_s {
                break;
            }
            step = if at_low.is_finite() {
                (low * at_high - high * at_low) / (at_high - at_low)
            } else {
                0.5 * (low + high)
            };
            self.runge_kutta(step, direction, control);
            let value = measure(&self.y, step);
            if value > 0.0 {
                (low, at_low) = (step, value);
                if side == 1 {
                    at_high *= 0.5;
                }
                side = 1;
            } else {
                (high, at_high) = (step, value);
                if side == -1 {
                    at_low *= 0.5;
                }
                side = -1;
            }
        }
        if step != high {
            step = high;
            self.runge_kutta(step, direction, control);
        }
        step
    }
}

/// The balance of a model where `y` says it stands; writes the rates of `y`. `WHOLE` vehicles are known to roll as a whole.
#[allow(clippy::inline_always, reason = "see the balance")]
#[inline(always)]
pub(crate) fn derive<const DECIDES: bool, const WHOLE: bool>(
    (model, layout, slots, scratch): (&Model, &Layout, &Slots, &mut Scratch),
    (time_s, direction): (f64, f64),
    y: &[f64],
    control: &impl Control,
    slope: &mut [f64],
) -> Instant {
    let states = layout.states.len();
    let (position_m, speed_m_s) = (y[POSITION], y[SPEED]);
    let moment = Moment { time_s, position_m, speed_m_s, states: &y[FIRST_STATE..FIRST_STATE + states] };
    let (command, given) = control.at(&moment);
    let (motion, rest) = slope.split_at_mut(FIRST_STATE);
    let (rates, powers) = rest.split_at_mut(states);
    if let Some(driver) = layout.driver {
        rates[driver] = given.driver_rate;
    }
    let point = Point { time_s, position_m, speed_m_s, direction };
    let instant = model.balance::<DECIDES, WHOLE>(
        point,
        command,
        &given,
        layout,
        slots,
        moment.states,
        rates,
        powers,
        scratch,
    );
    motion[POSITION] = speed_m_s;
    motion[SPEED] = instant.acceleration_m_s2;
    instant
}

/// Below this a speed is the rounding of a located stop.
const SPEED_AT_REST_M_S: f64 = 1e-12;

pub(crate) fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}
