//! A case: what is hidden in it, its runs as the plant drives them, its logs as the sensors see them.

use crate::assemble::assemble;
use crate::dice::Dice;
use crate::error::ConcealError;
use crate::family::{Family, Needs};
use crate::hidden::{Law, Spell, Told, ask, draw, listed_of, pair_of, parameter, unlisted_for, unlisted_of};
use crate::plan::Plan;
use crate::sensor::{Artefact, Sensor};
use crate::truth::Truth;
use crate::write;
use headland_trace::Run;
use std::path::Path;

/// What is hidden in a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// One listed cause.
    Single,
    /// Two listed causes.
    Two,
    /// A listed cause, and one that no list holds.
    TwoUnlisted,
    /// A listed cause, and a fault of a sensor.
    TwoSensor,
    /// One cause that no list holds.
    Unlisted,
    /// None: the nominal parameters are wrong within their spread.
    Empty,
    /// A fault of a sensor.
    Artefact,
}

impl Kind {
    /// As the truth has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Two => "two",
            Self::TwoUnlisted => "two_unlisted",
            Self::TwoSensor => "two_sensor",
            Self::Unlisted => "unlisted",
            Self::Empty => "empty",
            Self::Artefact => "artefact",
        }
    }
}

/// Of twenty cases seven hide one listed cause, two two, one a listed and an unlisted one, one a cause and a fault, three
/// an unlisted one; four hide none, two faults.
pub fn kind_of(case: usize) -> (Kind, usize) {
    use Kind::{Artefact, Empty, Single, Two, TwoSensor, TwoUnlisted, Unlisted};
    const CYCLE: [Kind; 20] = [
        Single,
        Empty,
        Single,
        Two,
        Single,
        Unlisted,
        Artefact,
        Single,
        Empty,
        TwoUnlisted,
        Single,
        Unlisted,
        TwoSensor,
        Empty,
        Single,
        Artefact,
        Two,
        Single,
        Unlisted,
        Empty,
    ];
    let kind = CYCLE[case % CYCLE.len()];
    let a_cycle = CYCLE.iter().filter(|other| **other == kind).count();
    let before = CYCLE[..case % CYCLE.len()].iter().filter(|other| **other == kind).count();
    (kind, case / CYCLE.len() * a_cycle + before)
}

/// A case, driven and measured.
#[derive(Clone, Debug)]
pub struct Case {
    /// The plan.
    pub plan: Plan,
    /// What is in the logs.
    pub logs: Vec<Run>,
    /// What was hidden along each run, with true speed and position.
    pub along: Vec<Run>,
    /// The truth.
    pub truth: Truth,
}

/// How much of a case is as the nominal model has it: to test the plant, not a diagnosis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Probe {
    /// A case as it should be.
    #[default]
    No,
    /// Every nominal parameter is stated as it is.
    Exact,
    /// That, and sensors without noise, steps, lag and hold.
    Noiseless,
}

/// Makes a case of a set.
///
/// # Errors
/// [`ConcealError::Trace`] where the logs do not come together: a bug.
pub fn generate(seed: u64, case: usize, probe: Probe) -> Result<Case, ConcealError> {
    let (kind, number) = kind_of(case);
    // The order in which laws are dealt is that of the set; all else is the case's own.
    let mut deal = Dice::new(seed, 0);
    let mut dice = Dice::new(seed, 1 + case as u64);
    let (listed, others) = (listed_of(&mut deal), unlisted_of(&mut deal));
    let families = Family::ALL;
    let (family, names): (Family, Vec<&'static str>) = match kind {
        Kind::Single => {
            let one = listed[number % listed.len()];
            (one.family, vec![one.law])
        }
        Kind::Two => {
            let family = families[number % families.len()];
            (family, pair_of(family, &mut dice).to_vec())
        }
        Kind::TwoUnlisted => {
            let family = families[number % families.len()];
            (family, vec![pair_of(family, &mut dice)[0], unlisted_for(family, &mut dice)])
        }
        Kind::TwoSensor => {
            let family = families[number % families.len()];
            (family, vec![pair_of(family, &mut dice)[0]])
        }
        Kind::Unlisted => {
            let one = others[number % others.len()];
            (one.family, vec![one.law])
        }
        Kind::Empty | Kind::Artefact => (families[number % families.len()], Vec::new()),
    };
    let mut needs = Needs { exact: probe != Probe::No, ..Needs::default() };
    for name in &names {
        ask(name, &mut needs, &mut dice);
    }
    let chosen = match kind {
        Kind::Artefact => write::faults::choose(family, number, &mut needs, &mut dice),
        // The first only: two causes are enough.
        Kind::TwoSensor => write::faults::choose(family, number, &mut needs, &mut dice)[..1].to_vec(),
        _ => Vec::new(),
    };
    let mut plan = family.plan(&needs, &mut dice);
    if probe == Probe::Noiseless {
        for channel in &mut plan.channels {
            (channel.sensor, channel.decimals) = (Sensor::default(), channel.decimals + 4);
        }
    }
    let laws: Vec<Law> = names.iter().map(|name| draw(name, &plan, &mut dice)).collect();
    let faults: Vec<Artefact> =
        chosen.into_iter().map(|id| write::faults::draw(id, &plan, &mut dice)).collect();
    assemble((seed, case, kind), plan, &laws, &names, &faults, &mut dice)
}

impl Case {
    /// Writes the case into a folder, which is made.
    ///
    /// # Errors
    /// [`ConcealError::File`], [`ConcealError::Json`] or [`ConcealError::Trace`].
    pub fn write(&self, folder: &Path) -> Result<(), ConcealError> {
        write::case(self, folder)
    }
}

/// A fault's parameter.
pub(crate) fn amount(name: &str, value: f64, unit: &str) -> Vec<Told> {
    vec![parameter(name, value, unit)]
}

/// A spell in every second run.
pub(crate) fn every_second(runs: usize, mut of: impl FnMut(usize) -> (f64, f64, f64)) -> Vec<Spell> {
    let spell = |run: usize| {
        let (from_s, to_s, amount) = of(run);
        Spell { run, from_s, to_s, amount }
    };
    (0..runs).step_by(2).map(spell).collect()
}
