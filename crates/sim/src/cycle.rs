//! Driving a cycle of phases, one after the other.

use crate::balance::{Command, Given, Instant};
use crate::ledger::Ledger;
use crate::recorder::Recorder;
use crate::step::Machine;
use crate::{End, Model, Outcome};
use headland_trace::TraceError;

/// How a run begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Distance along the path [m].
    pub position_m: f64,
    /// Speed [m/s].
    pub speed_m_s: f64,
}

/// When a coasting phase ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Until {
    /// The vehicle rests.
    Stopped,
    /// Its speed has fallen to this [m/s].
    SpeedBelow(f64),
    /// This long after the phase began [s].
    Elapsed(f64),
    /// This far after the phase began [m].
    Travelled(f64),
}

/// One piece of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// Change speed at a steady rate.
    Reach {
        /// Speed to reach [m/s].
        speed_m_s: f64,
        /// Rate, more than 0 [m/s²].
        acceleration_m_s2: f64,
    },
    /// Keep the speed.
    Hold {
        /// For this long [s].
        for_s: f64,
    },
    /// Neutral, no brake.
    Coast {
        /// Until then.
        until: Until,
    },
    /// Follow a speed over time.
    Follow {
        /// Time since the phase began [s] and speed [m/s], linear in between, times increasing from 0.
        profile: Vec<(f64, f64)>,
    },
}

/// How a run is driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// How it begins.
    pub start: Start,
    /// Its phases.
    pub phases: Vec<Phase>,
    /// How fast the driver takes back an error of speed [1/s].
    ///
    /// The driver knows the resistances and feeds them forward: a = dv_ref/dt + gain (v_ref − v).
    pub driver_gain_per_s: f64,
    /// Step of the integration [s].
    pub step_s: f64,
    /// A run longer than this is stopped [s].
    pub longest_s: f64,
}

/// Below this acceleration [m/s²] a vehicle that wants more has reached the end of its force.
const NO_MORE_ACCELERATION_M_S2: f64 = 1e-5;

/// A run of more steps would fill the memory: 10 million take some gigabytes, and are a day at 10 ms.
const MOST_STEPS: usize = 10_000_000;

/// Drives the model through the cycle.
///
/// # Errors
/// [`TraceError`] where the steps do not make a trace, which would be a bug.
pub fn simulate(model: &Model, cycle: &Cycle) -> Result<Outcome, TraceError> {
    let mut run = Running::new(model, cycle);
    let mut end = End::Finished;
    for phase in &cycle.phases {
        if let Err(reason) = run.drive(phase) {
            end = End::Stopped { time_s: run.machine.time_s, position_m: run.machine.position_m(), reason };
            break;
        }
    }
    run.finish(end)
}

struct Running<'a> {
    machine: Machine<'a>,
    recorder: Recorder,
    cycle: &'a Cycle,
    extent_m: Option<(f64, f64)>,
    target_m_s: f64,
}

impl<'a> Running<'a> {
    fn new(model: &'a Model, cycle: &'a Cycle) -> Self {
        let machine = Machine::new(model, 0.0, cycle.start.position_m, cycle.start.speed_m_s);
        let recorder = Recorder::new(&machine);
        let target_m_s = cycle.start.speed_m_s;
        Self { machine, recorder, cycle, extent_m: model.terrain.extent_m(), target_m_s }
    }

    fn drive(&mut self, phase: &Phase) -> Result<(), String> {
        let begin_s = self.machine.time_s;
        let gain = self.cycle.driver_gain_per_s;
        match phase {
            Phase::Reach { speed_m_s, acceleration_m_s2 } => {
                let target = *speed_m_s;
                let up = target > self.machine.speed_m_s();
                let rate = if up { *acceleration_m_s2 } else { -acceleration_m_s2 };
                self.target_m_s = target;
                if target == self.machine.speed_m_s() {
                    return Ok(());
                }
                let control = move |_: f64, _: f64, _: f64| (Command::Accelerate(rate), Given::default());
                let missing = move |_: f64, _: f64, speed: f64| (target - speed) * rate.signum();
                self.until(&control, missing, f64::INFINITY, &|machine, instant| {
                    let short = (machine.speed_m_s() - target).abs() > 0.0
                        && instant.acceleration_m_s2 * rate.signum() < NO_MORE_ACCELERATION_M_S2;
                    short.then(|| {
                        format!(
                            "the drive cannot bring the vehicle to {target:.2} m/s: at {:.2} m/s its force of {:.0} N \
                             only matches the resistances",
                            machine.speed_m_s(),
                            instant.delivery.force_n
                        )
                    })
                })
            }
            Phase::Hold { for_s } => {
                let target = self.target_m_s;
                let control = move |_: f64, _: f64, speed: f64| {
                    (Command::Accelerate(gain * (target - speed)), Given::default())
                };
                self.until(&control, |_, _, _| f64::INFINITY, begin_s + for_s, &never)
            }
            Phase::Coast { until } => {
                let control = |_: f64, _: f64, _: f64| (Command::Coast, Given::default());
                let begin_m = self.machine.position_m();
                let moving = self.machine.speed_m_s() != 0.0;
                let at_rest = move |machine: &Machine, instant: &Instant| {
                    (machine.speed_m_s() == 0.0 && instant.acceleration_m_s2 == 0.0 && moving).then(|| {
                        "the vehicle has come to rest before the end of the coasting phase".to_owned()
                    })
                };
                let result = match *until {
                    Until::Stopped => self.until(&control, |_, _, speed| speed, f64::INFINITY, &never),
                    Until::SpeedBelow(target) => {
                        self.until(&control, |_, _, speed| speed - target, f64::INFINITY, &at_rest)
                    }
                    Until::Elapsed(for_s) => {
                        self.until(&control, |_, _, _| f64::INFINITY, begin_s + for_s, &never)
                    }
                    Until::Travelled(far) => self.until(
                        &control,
                        |_, position, _| far - (position - begin_m),
                        f64::INFINITY,
                        &at_rest,
                    ),
                };
                self.target_m_s = self.machine.speed_m_s();
                result
            }
            Phase::Follow { profile } => {
                for piece in profile.windows(2) {
                    let ((from_s, from), (to_s, to)) = (piece[0], piece[1]);
                    let rate = (to - from) / (to_s - from_s);
                    let piece_begin_s = begin_s + from_s;
                    let control = move |time: f64, _: f64, speed: f64| {
                        let reference = from + rate * (time - piece_begin_s);
                        (Command::Accelerate(rate + gain * (reference - speed)), Given::default())
                    };
                    self.target_m_s = to;
                    self.until(&control, |_, _, _| f64::INFINITY, begin_s + to_s, &never)?;
                }
                Ok(())
            }
        }
    }

    /// Steps until `event` falls to zero, or until a time.
    fn until(
        &mut self,
        control: &impl crate::step::Control,
        event: impl Fn(f64, f64, f64) -> f64,
        end_s: f64,
        hopeless: &dyn Fn(&Machine, &Instant) -> Option<String>,
    ) -> Result<(), String> {
        loop {
            let machine = &mut self.machine;
            let instant = machine.instant(control);
            if !(instant.acceleration_m_s2.is_finite() && machine.speed_m_s().is_finite()) {
                return Err("a force is not a finite number; look at the parameters of the models".to_owned());
            }
            if self.recorder.last_time_s().is_none_or(|last| machine.time_s > last) {
                self.recorder.push(machine, &instant);
            }
            let left_s = end_s - machine.time_s;
            if left_s <= 0.0 || event(machine.time_s, machine.position_m(), machine.speed_m_s()) <= 0.0 {
                return Ok(());
            }
            if let Some(reason) = hopeless(machine, &instant).or_else(|| machine.exhausted(&instant)) {
                return Err(reason);
            }
            if machine.steps >= MOST_STEPS {
                return Err(format!("it takes more than {MOST_STEPS} steps of {} s", self.cycle.step_s));
            }
            if machine.time_s >= self.cycle.longest_s {
                return Err(format!("the phase has not ended after {} s", self.cycle.longest_s));
            }
            // A last sliver of a step would only cost accuracy.
            let step_s = if left_s < 1.000_001 * self.cycle.step_s { left_s } else { self.cycle.step_s };
            machine.step(&instant, step_s, control, &event);
            if step_s == left_s && machine.time_s < end_s && end_s - machine.time_s < 1e-9 {
                machine.time_s = end_s;
            }
            if let Some((from_m, to_m)) = self.extent_m
                && !(from_m..=to_m).contains(&machine.position_m())
            {
                return Err(format!("the path ends: it runs from {from_m} m to {to_m} m"));
            }
        }
    }

    fn finish(mut self, end: End) -> Result<Outcome, TraceError> {
        let coast = |_: f64, _: f64, _: f64| (Command::Coast, Given::default());
        if self.recorder.last_time_s().is_none_or(|last| self.machine.time_s > last) {
            let instant = self.machine.instant(&coast);
            self.recorder.push(&self.machine, &instant);
        }
        let ledger = Ledger::close(
            self.machine.model.driveline.source(),
            self.machine.kinetic_gain_j(),
            &self.machine.slots,
            self.machine.energies_j(),
        );
        Ok(Outcome { trace: self.recorder.finish()?, ledger, end, steps: self.machine.steps })
    }
}

fn never(_: &Machine, _: &Instant) -> Option<String> {
    None
}
