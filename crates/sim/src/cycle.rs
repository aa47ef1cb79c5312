//! Driving a cycle of phases, one after the other.

use crate::balance::{Command, Given, Instant};
use crate::ending::Ending;
use crate::ledger::Ledger;
use crate::plan::{Cycle, Driven, Phase, Setting};
use crate::recorder::Recorder;
use crate::reference::Reference;
use crate::simulation::Simulation;
use crate::step::{Machine, Moment};
use crate::{End, Outcome};
use headland_plugin::Mode;
use headland_trace::TraceError;
use std::collections::BTreeMap;

/// A run of more steps would fill the memory: 10 million take some gigabytes, and are a day at 10 ms.
pub(crate) const MOST_STEPS: usize = 10_000_000;

/// So many steps are made before it is asked again whether somebody interrupts.
const STEPS_BETWEEN_LOOKS: usize = 32;

/// Why a phase cannot go on, if it cannot.
pub(crate) type Hopeless<'h> = Option<&'h dyn Fn(&Machine, &Instant) -> Option<String>>;

/// A cycle that is being driven.
pub(crate) struct Running<'a> {
    pub machine: Machine<'a>,
    pub(crate) recorder: Recorder,
    /// Between two rows of the trace [s]; 0 for one each step.
    pub(crate) record_s: f64,
    /// Whether a motion that is known beforehand is asked for its forces once a step only.
    pub(crate) quasi_static: bool,
    pub cycle: &'a Cycle,
    extent_m: Option<(f64, f64)>,
    pub(crate) ground: Ground,
    pub target_m_s: f64,
    /// Whether the driver has engaged the reverse.
    pub backward: bool,
    pub setting: Setting,
    driven: Vec<Driven>,
    /// What was found of each group that has a guard.
    entered: BTreeMap<usize, bool>,
    stop: &'a dyn Fn() -> bool,
    /// Steps after which it is asked again whether to go on.
    next_look: usize,
    interrupted: bool,
}

impl<'a> Running<'a> {
    pub(crate) fn new(simulation: Simulation<'a>) -> Self {
        let Simulation { model, cycle, carriage, record_s, quasi_static, stop } = simulation;
        let Cycle { start, phases, .. } = cycle;
        let remembers =
            |phase: &Phase| matches!(phase, Phase::With { setting, .. } if setting.driver.is_some());
        let driver = phases.iter().any(remembers).then_some("driver_error_m");
        let machine = match (carriage, driver) {
            (Some(carriage), driver) => Machine::on(model, carriage, driver),
            (None, Some(driver)) => Machine::with_driver(model, driver, start.position_m, start.speed_m_s),
            (None, None) => Machine::new(model, 0.0, start.position_m, start.speed_m_s),
        };
        Self {
            recorder: Recorder::new(&machine),
            machine,
            record_s,
            quasi_static,
            cycle,
            extent_m: model.terrain.extent_m(),
            ground: Ground::of(model.terrain.extent_m()),
            target_m_s: start.speed_m_s,
            backward: false,
            setting: Setting::default(),
            driven: Vec::new(),
            entered: BTreeMap::new(),
            stop,
            next_look: 0,
            interrupted: false,
        }
    }

    /// Drives every phase, or as far as it comes.
    pub(crate) fn drive_all(mut self) -> Result<Outcome, TraceError> {
        let mut end = End::Finished;
        for (index, phase) in self.cycle.phases.iter().enumerate() {
            if let Err(reason) = self.drive_one(index, phase) {
                let (time_s, position_m) = (self.machine.time_s, self.machine.position_m());
                end = if self.interrupted {
                    End::Interrupted { time_s, position_m }
                } else {
                    End::Stopped { time_s, position_m, reason }
                };
                break;
            }
        }
        self.finish(end)
    }

    /// Why there is to be no further step, apart from what the machine says.
    #[allow(clippy::inline_always, reason = "the inner loop")]
    #[inline(always)]
    pub(crate) fn look_up(&mut self) -> Result<(), String> {
        if self.machine.steps < self.next_look { Ok(()) } else { self.look_around() }
    }

    #[inline(never)]
    fn look_around(&mut self) -> Result<(), String> {
        if self.machine.steps >= MOST_STEPS {
            return Err(format!("it takes more than {MOST_STEPS} steps of {} s", self.cycle.step_s));
        }
        if (self.stop)() {
            self.interrupted = true;
            return Err("it was interrupted".to_owned());
        }
        self.next_look = MOST_STEPS.min(self.machine.steps + STEPS_BETWEEN_LOOKS);
        Ok(())
    }

    /// Drives a phase and writes down what became of it.
    fn drive_one(&mut self, index: usize, phase: &Phase) -> Result<(), String> {
        let (setting, phase) = match phase {
            Phase::With { setting, phase } => (setting.clone(), &**phase),
            bare => (Setting::default(), bare),
        };
        let (from_s, from_m) = (self.machine.time_s, self.machine.position_m());
        let entered = self.entered(&setting)?;
        let wanted = self.wanted(phase).filter(|_| entered);
        let result = if entered {
            self.set(&setting).and_then(|()| self.drive(phase))
        } else {
            Ok("passed over: what it waits for is not so".to_owned())
        };
        self.driven.push(Driven {
            phase: index,
            name: setting.name,
            from_s,
            to_s: self.machine.time_s,
            from_m,
            to_m: self.machine.position_m(),
            ended_by: result.clone().unwrap_or_else(|reason| format!("stopped: {reason}")),
            wanted_m: wanted.map(|wanted| wanted.way_m(self.machine.time_s).abs()),
            may_slow_down: !matches!(phase, Phase::Hold { .. } | Phase::Follow { .. }),
        });
        result.map(|_| ())
    }

    /// The speed that a phase wants over its time, where it says so.
    fn wanted(&self, phase: &Phase) -> Option<Reference> {
        let (begin_s, speed_m_s) = (self.machine.time_s, self.machine.speed_m_s());
        match phase {
            Phase::Hold { .. } => Some(Reference::steady(begin_s, self.target_m_s)),
            Phase::Follow { profile } => Some(Reference::along(begin_s, profile)),
            Phase::Drive { speed_m_s: target, acceleration_m_s2, .. } => {
                Some(Reference::ramp(begin_s, speed_m_s, *target, *acceleration_m_s2))
            }
            _ => None,
        }
    }

    /// Whether every guard of a phase holds. That of a group is asked once.
    fn entered(&mut self, setting: &Setting) -> Result<bool, String> {
        for guard in &setting.guards {
            let known = self.entered.get(&guard.group).copied();
            let holds = match known {
                Some(holds) => holds,
                None => Ending::conditions(&guard.when, &self.machine)?.all(&self.machine.moment()),
            };
            self.entered.insert(guard.group, holds);
            if !holds {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Tells the tasks what to do.
    fn set(&mut self, setting: &Setting) -> Result<(), String> {
        let tasks = &self.machine.model.tasks;
        let mut modes = vec![if setting.tasks.is_some() { Mode::Rest } else { Mode::Work }; tasks.len()];
        for (name, mode) in setting.tasks.iter().flatten() {
            let index = tasks.iter().position(|task| task.name == *name);
            let index = index.ok_or_else(|| format!("no task is named `{name}`"))?;
            modes[index] = *mode;
        }
        self.machine.modes().copy_from_slice(&modes);
        self.setting = setting.clone();
        Ok(())
    }

    /// Steps until the phase ends, or a piece of it does; says whether it was the phase.
    pub(crate) fn until(
        &mut self,
        control: &impl crate::step::Control,
        ending: &Ending,
        piece_end_s: f64,
        hopeless: Hopeless,
    ) -> Result<bool, String> {
        loop {
            if let Some(ended) = self.one(control, ending, piece_end_s, hopeless)? {
                return Ok(ended);
            }
        }
    }

    /// Makes a step; where there is none left, says whether the phase is over.
    #[allow(clippy::inline_always, reason = "the inner loop")]
    #[inline(always)]
    pub(crate) fn one(
        &mut self,
        control: &impl crate::step::Control,
        ending: &Ending,
        piece_end_s: f64,
        hopeless: Hopeless,
    ) -> Result<Option<bool>, String> {
        let end_s = ending.end_s.min(piece_end_s);
        let machine = &mut self.machine;
        let instant = machine.instant(control);
        if let Some(reason) = machine.stuck() {
            return Err(reason);
        }
        if !(instant.acceleration_m_s2.is_finite() && machine.speed_m_s().is_finite()) {
            return Err("a force is not a finite number; look at the parameters of the models".to_owned());
        }
        let left_s = end_s - machine.time_s;
        let over = left_s <= 0.0 || ending.left(&machine.moment()) <= 0.0;
        let due_s = if over { 0.0 } else { ON_TIME * self.record_s };
        if self.recorder.last_time_s().is_none_or(|last| machine.time_s > last + due_s) {
            self.recorder.push(machine, &instant);
        }
        if over {
            return Ok(Some(machine.time_s >= ending.end_s || ending.left(&machine.moment()) <= 0.0));
        }
        if let Some(reason) = machine.no_further(&instant, hopeless) {
            return Err(reason);
        }
        self.look_up()?;
        let machine = &mut self.machine;
        if machine.time_s >= self.cycle.longest_s {
            return Err(format!("the phase has not ended after {} s", self.cycle.longest_s));
        }
        let step_s = sliver(left_s, self.cycle.step_s);
        let ground = self.ground;
        machine.step(&instant, step_s, control, |at| ending.left(at).min(ground.left_m(at)));
        if step_s == left_s && machine.time_s < end_s && end_s - machine.time_s < 1e-9 {
            machine.time_s = end_s;
        }
        match self.within_the_path() {
            // What a carriage comes to is foreseen, and may be passed by a little.
            Err(told) if ending.left(&self.machine.moment()) > 0.0 => Err(told),
            _ => Ok(None),
        }
    }

    fn within_the_path(&self) -> Result<(), String> {
        match self.extent_m {
            Some((from_m, to_m))
                if !(from_m - LOCATED_M..=to_m + LOCATED_M).contains(&self.machine.position_m()) =>
            {
                let [from_m, to_m] = [from_m, to_m].map(in_millimetres);
                Err(format!("the path ends: it runs from {from_m} m to {to_m} m"))
            }
            _ => Ok(()),
        }
    }

    fn finish(mut self, end: End) -> Result<Outcome, TraceError> {
        let coast = |_: &Moment| (Command::Coast, Given::default());
        if self.recorder.last_time_s().is_none_or(|last| self.machine.time_s > last) {
            let instant = self.machine.instant(&coast);
            self.recorder.push(&self.machine, &instant);
        }
        let mut ledger = Ledger::close(
            self.machine.model.driveline.source(),
            self.machine.kinetic_gain_j(),
            &self.machine.slots,
            self.machine.energies_j(),
        );
        if let Some(carriage) = &self.machine.carriage {
            ledger.add(carriage.accounts());
        }
        let steps = self.machine.steps;
        Ok(Outcome { trace: self.recorder.finish()?, ledger, end, steps, phases: self.driven })
    }
}

/// The next step where `left_s` [s] are left: a last sliver of one would only cost accuracy.
pub(crate) fn sliver(left_s: f64, step_s: f64) -> f64 {
    if left_s < 1.000_001 * step_s { left_s } else { step_s }
}

/// A row is due this early, as a part of the time between two: so many roundings of steps are no step more.
pub(crate) const ON_TIME: f64 = 1.0 - 1e-6;

/// A length as people read it, to the millimetre [m].
fn in_millimetres(length_m: f64) -> f64 {
    (1e3 * length_m).round() / 1e3
}

/// Where a step ends though its phase does not: just beyond the path, so that who stands at its very end is on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground {
    from_m: f64,
    to_m: f64,
}

impl Ground {
    fn of(extent_m: Option<(f64, f64)>) -> Self {
        let (from_m, to_m) = extent_m.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        Self { from_m: from_m - 2.0 * LOCATED_M, to_m: to_m + 2.0 * LOCATED_M }
    }

    /// What is left to either end [m].
    #[allow(clippy::inline_always, reason = "it is asked within each step")]
    #[inline(always)]
    pub(crate) fn left_m(&self, at: &Moment) -> f64 {
        (self.to_m - at.position_m).min(at.position_m - self.from_m)
    }
}

/// A path that is driven to its very end is left by the rounding of a located end [m].
const LOCATED_M: f64 = 1e-6;
