//! Driving the model with what was recorded.
//!
//! Either the speed is given, and the model says what force, torque, fuel and electricity it took; or the force (a
//! recorded torque, a recorded tractive force, or neutral) is given, and the model says how the vehicle moved. Long
//! recordings are driven in windows that start from the recorded speed, so that errors do not pile up without bound.

use crate::balance::{Command, Followed, Given};
use crate::ledger::Ledger;
use crate::recorder::Recorder;
use crate::shaking::shaking_m2_s4;
use crate::slope::{LocalFit, chainage_from_m, local_fit, travelled};
use crate::step::{Machine, Moment};
use crate::{End, Model, Outcome};
use headland_trace::{Origin, Trace, TraceError};

/// Which recorded channel moves the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// `speed_m_s`: what did the motion cost?
    Speed,
    /// `motor_torque_n_m` or `engine_torque_n_m`, through the driveline's gears.
    Torque,
    /// `tractive_force_n`.
    Force,
    /// None: it coasts. Where `Inputs::Coasting` is told and says that it does not, the recorded motion is followed, and the next
    /// coast starts from it.
    Coast,
}

/// How a recording drives the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    /// What moves the model.
    pub drive: Drive,
    /// Recorded circumstances that the model is told as well.
    pub also: Vec<Inputs>,
    /// Length of the windows [s]; `None` for one window.
    ///
    /// Of no length, the model starts anew at every sample: it says what acts there, and how it would move on.
    pub window_s: Option<f64>,
    /// Half width of the local fit that gives speed and acceleration of the recording [s].
    pub smoothing_s: f64,
    /// Longest step of the integration [s].
    pub step_s: f64,
    /// Where the path is driven towards its start from [m]; `None` where it is driven towards its end.
    ///
    /// Recorded positions count along the path where they fall, and from the run's own start where they grow.
    pub reversed_from_m: Option<f64>,
    /// How often the path was driven before.
    pub passes_before: usize,
    /// Whether the recorded motion is followed while somebody brakes, where `Inputs::Brake` is told and a recorded force or
    /// torque drives: how hard the brakes hold nobody recorded.
    pub follows_brakes: bool,
}

impl Replay {
    /// Sample by sample, whether the recorded motion is followed: something drives or brakes of which nothing is known but how the
    /// vehicle moved.
    pub fn followed(&self, recorded: &Trace) -> Vec<bool> {
        let told = |input: Inputs| self.also.contains(&input);
        let on = |input: Inputs| {
            let switch = recorded.get(input.channels()[0]).unwrap_or_default();
            switch.iter().map(|value| *value >= 0.5)
        };
        match self.drive {
            Drive::Coast if told(Inputs::Coasting) => {
                on(Inputs::Coasting).map(|coasting| !coasting).collect()
            }
            Drive::Force | Drive::Torque if self.follows_brakes && told(Inputs::Brake) => {
                on(Inputs::Brake).collect()
            }
            _ => vec![false; recorded.len()],
        }
    }
}

/// A recorded circumstance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "each is named after its channel")]
pub enum Inputs {
    Grade,
    Heading,
    Curvature,
    Roll,
    VerticalAcceleration,
    Wind,
    AirTemperature,
    OilTemperature,
    /// For effects that follow it; what the battery of the model holds starts from it.
    StateOfCharge,
    TyrePressure,
    AuxiliaryPower,
    /// At the hitch, beside what tasks pull with.
    DrawbarForce,
    /// In the place of what tasks take from the power take-off.
    PtoPower,
    /// In the place of what tasks take from the remote hydraulics.
    HydraulicPower,
    /// Mass that is carried beside that of the vehicle.
    Payload,
    Coasting,
    Brake,
    /// The engine turns as it was recorded, whatever the driveline would have chosen. What it is compared with is part of
    /// the model's answer otherwise, so it is among the circumstances only where somebody asks for it.
    EngineSpeed,
}

impl Inputs {
    /// Every circumstance that a model is told without being asked to.
    pub const ALL: [Self; 17] = [
        Self::Grade,
        Self::Heading,
        Self::Curvature,
        Self::Roll,
        Self::VerticalAcceleration,
        Self::Wind,
        Self::AirTemperature,
        Self::OilTemperature,
        Self::StateOfCharge,
        Self::TyrePressure,
        Self::AuxiliaryPower,
        Self::DrawbarForce,
        Self::PtoPower,
        Self::HydraulicPower,
        Self::Payload,
        Self::Coasting,
        Self::Brake,
    ];

    /// The channels that it is made of.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Grade => &["grade"],
            Self::Heading => &["heading_rad"],
            Self::Curvature => &["curvature_per_m"],
            Self::Roll => &["roll_rad"],
            Self::VerticalAcceleration => &["vertical_acceleration_m_s2"],
            Self::Wind => &["wind_speed_m_s", "wind_direction_rad"],
            Self::AirTemperature => &["air_temperature_c"],
            Self::OilTemperature => &["oil_temperature_c"],
            Self::StateOfCharge => &["state_of_charge"],
            Self::TyrePressure => &["tyre_pressure_pa"],
            Self::AuxiliaryPower => &["auxiliary_power_w"],
            Self::DrawbarForce => &["drawbar_force_n"],
            Self::PtoPower => &["pto_power_w"],
            Self::HydraulicPower => &["hydraulic_power_w"],
            Self::Payload => &["payload_kg"],
            Self::Coasting => &["coasting"],
            Self::Brake => &["brake"],
            Self::EngineSpeed => &["engine_speed_rad_s"],
        }
    }

    /// Whether a recording has all of its channels, without a missing value.
    pub fn whole(self, recorded: &Trace) -> bool {
        let known = |values: &[f64]| values.iter().all(|value| value.is_finite());
        self.channels().iter().all(|name| recorded.get(name).is_some_and(known))
    }
}

/// A recording that cannot drive the model.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// A channel that drives the model is not in the recording.
    #[error("the recording cannot drive the model: {0}")]
    Missing(TraceError),
    /// The recording is too short.
    #[error("the recording has {samples} samples, expected at least 2")]
    Short {
        /// Samples found.
        samples: usize,
    },
    /// The driveline cannot make a force of the recorded torque.
    #[error("the driveline of the scenario cannot turn a recorded torque into a force at the wheels")]
    NoTorque,
    /// The steps do not make a trace: a bug.
    #[error(transparent)]
    Trace(#[from] TraceError),
}

/// Drives the model with a recording. The trace has the recording's time base; samples that could not be simulated
/// for want of input are NaN.
///
/// # Errors
/// [`ReplayError`].
pub fn replay(model: &Model, recorded: &Trace, how: &Replay) -> Result<Outcome, ReplayError> {
    replayed(model, recorded, how, None)
}

/// As [`replay`], but the trace holds of its channels those of these names alone: to write down what nobody reads takes as long
/// as the motion.
///
/// # Errors
/// [`ReplayError`].
pub fn replay_channels(
    model: &Model,
    recorded: &Trace,
    how: &Replay,
    names: &[&str],
) -> Result<Outcome, ReplayError> {
    replayed(model, recorded, how, Some(names))
}

fn replayed(
    model: &Model,
    recorded: &Trace,
    how: &Replay,
    names: Option<&[&str]>,
) -> Result<Outcome, ReplayError> {
    if recorded.len() < 2 {
        return Err(ReplayError::Short { samples: recorded.len() });
    }
    let tape = Tape { names, ..Tape::load(model, recorded, how)? };
    let outcome = match how.drive {
        Drive::Speed => tape.follow(model, |tape, index, speed, _| tape.accelerated(index, speed))?,
        Drive::Torque | Drive::Force | Drive::Coast if how.window_s == Some(0.0) => tape
            .follow(model, |tape, index, speed, coasting| {
                (tape.pushed(model, how, (index, 0.0), speed, coasting), false)
            })?,
        Drive::Torque | Drive::Force | Drive::Coast => tape.forward(model, how)?,
    };
    Ok(Outcome { trace: mark_driven(outcome.trace, how), ..outcome })
}

/// The recorded inputs.
struct Tape<'a> {
    reversed_from_m: Option<f64>,
    passes_before: usize,
    time_s: &'a [f64],
    motion: LocalFit,
    position_m: Vec<f64>,
    /// Force at the wheels [N], or torque [N m], by what drives.
    push: Option<&'a [f64]>,
    /// Whether the recorded motion is followed.
    followed: Vec<bool>,
    also: Vec<(Inputs, Vec<&'a [f64]>)>,
    /// Empty where no vertical acceleration is told.
    shaking_m2_s4: Vec<f64>,
    state_of_charge: Option<&'a [f64]>,
    /// Channels that are read of what the model says; all of them where none are named.
    names: Option<&'a [&'a str]>,
}

/// Below this recorded speed [m/s] the vehicle stands, held by whatever held it.
const STANDSTILL_M_S: f64 = 0.02;

impl<'a> Tape<'a> {
    fn load(model: &Model, recorded: &'a Trace, how: &Replay) -> Result<Self, ReplayError> {
        let time_s = recorded.time_s();
        let speed = recorded.require("speed_m_s").map_err(ReplayError::Missing)?;
        let motion = local_fit(time_s, speed, how.smoothing_s);
        let position_m = match (recorded.get("position_m"), how.reversed_from_m) {
            (Some(position), Some(from_m)) if chainage_from_m(position).is_some() => {
                position.iter().map(|position| from_m - position).collect()
            }
            (Some(position), _) => position.to_vec(),
            (None, _) => travelled(time_s, &motion.value),
        };
        let push = match how.drive {
            Drive::Speed | Drive::Coast => None,
            Drive::Force => Some(recorded.require("tractive_force_n").map_err(ReplayError::Missing)?),
            Drive::Torque => {
                if model.driveline.force_of_torque_n(1.0, 1.0).is_none() {
                    return Err(ReplayError::NoTorque);
                }
                let torque = recorded
                    .get("motor_torque_n_m")
                    .map_or_else(|| recorded.require("engine_torque_n_m"), Ok)
                    .map_err(ReplayError::Missing)?;
                Some(torque)
            }
        };
        let mut also = Vec::new();
        for input in &how.also {
            let mut columns = Vec::new();
            for name in input.channels() {
                columns.push(recorded.require(name).map_err(ReplayError::Missing)?);
            }
            also.push((*input, columns));
        }
        let told = also.iter().find(|(input, _)| *input == Inputs::VerticalAcceleration);
        let shaking_m2_s4 = told.map_or_else(Vec::new, |(_, columns)| shaking_m2_s4(time_s, columns[0]));
        let state_of_charge = recorded.get("state_of_charge");
        let reversed_from_m = how.reversed_from_m;
        Ok(Self {
            reversed_from_m,
            passes_before: how.passes_before,
            time_s,
            motion,
            position_m,
            push,
            followed: how.followed(recorded),
            also,
            shaking_m2_s4,
            state_of_charge,
            names: None,
        })
    }

    /// The circumstances at a share of the way from sample `index` to the next, and whether the vehicle coasts.
    fn given(&self, model: &Model, index: usize, share: f64) -> (Given, bool) {
        let mut given = Given {
            reversed_from_m: self.reversed_from_m,
            passes_before: self.passes_before,
            ..Given::default()
        };
        let mut coasting = false;
        for (input, columns) in &self.also {
            let value = |column: usize| {
                let series = columns[column];
                let next = series[(index + 1).min(series.len() - 1)];
                series[index] + share * (next - series[index])
            };
            match input {
                Inputs::Grade => given.sin_slope = Some(value(0).atan().sin()),
                Inputs::Heading => given.heading_rad = Some(columns[0][index]),
                Inputs::Curvature => given.curvature_per_m = Some(value(0)),
                Inputs::Roll => given.roll_rad = Some(value(0)),
                Inputs::VerticalAcceleration => given.shaking_m2_s4 = Some(self.shaking_m2_s4[index]),
                Inputs::Wind => {
                    let air = given.air.get_or_insert(model.air);
                    (air.wind_speed_m_s, air.wind_from_rad) = (value(0), columns[1][index]);
                }
                Inputs::AirTemperature => {
                    given.air.get_or_insert(model.air).temperature_c = value(0);
                }
                Inputs::OilTemperature => given.oil_temperature_c = Some(value(0)),
                Inputs::StateOfCharge => given.state_of_charge = Some(value(0)),
                Inputs::TyrePressure => given.tyre_pressure_pa = Some(value(0)),
                Inputs::AuxiliaryPower => given.auxiliary_power_w = Some(value(0)),
                Inputs::DrawbarForce => given.drawbar_force_n = Some(value(0)),
                Inputs::PtoPower => given.pto_power_w = Some(value(0)),
                Inputs::HydraulicPower => given.hydraulic_power_w = Some(value(0)),
                Inputs::Payload => given.payload_kg = value(0),
                Inputs::Coasting => coasting = columns[0][index] >= 0.5,
                Inputs::Brake => given.braking = columns[0][index] >= 0.5,
                Inputs::EngineSpeed => given.engine_speed_rad_s = value(0),
            }
        }
        (given, coasting)
    }

    fn adopt_charge(&self, machine: &mut Machine, index: usize) {
        let Some(charge) = self.state_of_charge else { return };
        if let Some(state) = machine.layout.charge
            && charge[index].is_finite()
        {
            machine.set_state(state, charge[index]);
        }
    }

    /// The recorded acceleration, where the vehicle moves.
    fn accelerated(&self, index: usize, speed: f64) -> (Command, bool) {
        let stands = speed.abs() < STANDSTILL_M_S;
        (Command::Accelerate(if stands { 0.0 } else { self.motion.slope[index] }), true)
    }

    /// The recorded push, a share of the way from one sample to the next.
    fn pushed(
        &self,
        model: &Model,
        how: &Replay,
        (index, share): (usize, f64),
        speed: f64,
        coasting: bool,
    ) -> Command {
        let Some(push) = self.push.filter(|_| !coasting) else { return Command::Coast };
        let next = push[(index + 1).min(push.len() - 1)];
        let value = push[index] + share * (next - push[index]);
        let force = if how.drive == Drive::Torque {
            model.driveline.force_of_torque_n(value, speed).unwrap_or(f64::NAN)
        } else {
            value
        };
        // Nobody reverses on a braking motor: at rest it only holds, but where the recording goes backward.
        Command::Recorded(if speed <= 0.0 && !self.is_backward(index) { force.max(0.0) } else { force })
    }

    /// Whether the recorded vehicle goes backward, or is about to.
    fn is_backward(&self, index: usize) -> bool {
        let next = (index + 1).min(self.motion.value.len() - 1);
        self.motion.value[index].min(self.motion.value[next]) <= -STANDSTILL_M_S
    }

    /// The speed that a sample begins with: noise about standing is none backward.
    fn begun_m_s(&self, index: usize) -> f64 {
        let speed = self.motion.value[index];
        if self.is_backward(index) { speed } else { speed.max(0.0) }
    }

    /// Follows the recorded motion sample by sample. `command` is told the sample, the speed and whether it coasts, and
    /// says as well whether the motion is what drives.
    fn follow(
        &self,
        model: &Model,
        command: impl Fn(&Self, usize, f64, bool) -> (Command, bool),
    ) -> Result<Outcome, ReplayError> {
        let mut machine = Machine::new(model, self.time_s[0], self.position_m[0], self.motion.value[0]);
        self.adopt_charge(&mut machine, 0);
        let mut recorder = Recorder::new(&machine).only(self.names).expecting(self.time_s.len());
        let mut before: Vec<f64> = Vec::new();
        for (index, &time_s) in self.time_s.iter().enumerate() {
            let (given, coasting) = self.given(model, index, 0.0);
            let stands = self.motion.value[index].abs() < STANDSTILL_M_S;
            let speed = if stands { 0.0 } else { self.motion.value[index] };
            let (command, driven) = match command(self, index, speed, coasting) {
                (Command::Accelerate(_), driven) if coasting => (Command::Coast, driven),
                (_, driven) if stands && !coasting => (Command::Accelerate(0.0), driven),
                other => other,
            };
            let followed = if driven { Followed::Driven } else { Followed::Sampled };
            let given = Given { followed, ..given };
            let control = move |_: &Moment| (command, given);
            let instant = if index == 0 {
                machine.set_motion(self.position_m[0], speed);
                machine.instant(&control)
            } else {
                machine.follow(time_s, self.position_m[index], speed, &before, &control)
            };
            before.clear();
            before.extend_from_slice(machine.rates());
            recorder.push(&machine, &instant);
        }
        finish(&machine, recorder)
    }

    fn forward(&self, model: &Model, how: &Replay) -> Result<Outcome, ReplayError> {
        let mut machine = Machine::new(model, self.time_s[0], self.position_m[0], self.begun_m_s(0));
        self.adopt_charge(&mut machine, 0);
        let mut recorder = Recorder::new(&machine).only(self.names);
        let mut window_start_s = self.time_s[0];
        for index in 0..self.time_s.len() {
            let (begin_s, next) = (self.time_s[index], (index + 1).min(self.time_s.len() - 1));
            let followed = self.followed[index];
            let starts = followed || index > 0 && self.followed[index - 1];
            if starts || how.window_s.is_some_and(|window_s| begin_s - window_start_s >= window_s) {
                machine.set_motion(self.position_m[index], self.begun_m_s(index));
                self.adopt_charge(&mut machine, index);
                window_start_s = begin_s;
            }
            let span_s = self.time_s[next] - begin_s;
            let stands = [index, next].iter().all(|at| self.motion.value[*at].abs() < STANDSTILL_M_S);
            if stands {
                machine.set_motion(machine.position_m(), 0.0);
            }
            let control = |at: &Moment| {
                let share = if span_s > 0.0 { (at.time_s - begin_s) / span_s } else { 0.0 };
                let (given, coasting) = self.given(model, index, share);
                let command = if stands {
                    Command::Accelerate(0.0)
                } else if followed {
                    Command::Accelerate(self.motion.slope[index])
                } else {
                    self.pushed(model, how, (index, share), at.speed_m_s, coasting)
                };
                (command, given)
            };
            let instant = machine.instant(&control);
            recorder.push(&machine, &instant);
            if next == index {
                break;
            }
            let pieces = (span_s / how.step_s).ceil().max(1.0);
            let mut first = instant;
            while machine.time_s < self.time_s[next] {
                let left_s = self.time_s[next] - machine.time_s;
                let step_s = left_s.min(span_s / pieces);
                if machine.step(&first, step_s, &control, |_: &Moment| f64::INFINITY) >= left_s - 1e-12 {
                    machine.time_s = self.time_s[next];
                } else {
                    first = machine.instant(&control);
                }
            }
        }
        finish(&machine, recorder)
    }
}

fn finish(machine: &Machine, recorder: Recorder) -> Result<Outcome, ReplayError> {
    let ledger = Ledger::close(
        machine.model.driveline.source(),
        machine.kinetic_gain_j(),
        &machine.slots,
        machine.energies_j(),
    );
    Ok(Outcome {
        trace: recorder.finish()?,
        ledger,
        end: End::Finished,
        steps: machine.steps,
        phases: Vec::new(),
    })
}

/// Marks the channels that agree with the recording because they were taken from it.
fn mark_driven(trace: Trace, how: &Replay) -> Trace {
    let mut driven: Vec<&str> = match how.drive {
        Drive::Speed => vec!["speed_m_s", "position_m", "acceleration_m_s2"],
        Drive::Torque => vec!["motor_torque_n_m", "engine_torque_n_m", "tractive_force_n"],
        Drive::Force => vec!["tractive_force_n"],
        Drive::Coast => vec!["coasting"],
    };
    driven.extend(how.also.iter().flat_map(|input| input.channels()));
    trace.with_origin(Origin::Driven, |name| driven.contains(&name))
}
