//! Causes turned into regressors: each effect is put into the scenario, every run is driven with it, and what the
//! model then says differently is the column.

use crate::balances::balance::{Kind, System, change};
use crate::balances::gram::Column;
use crate::causes::catalogue::{Cause, Form};
use crate::causes::losses::{bent_engine, half_samples, slow_powers, small_losses, torque_errors};
use crate::causes::remembered::Driven;
use crate::causes::sensors::{fault, small_faults};
use crate::causes::slowed::with_speed;
use crate::causes::windowed::in_window;
use crate::look::MANY_ROWS;
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::{Case, DiagnoseError};

/// The regressors.
#[derive(Clone, Default)]
pub struct Pool {
    /// The columns: free parameters first, then small faults of sensors, then the trials'.
    pub columns: Vec<Column>,
    /// Prior standard deviation of each column's parameter.
    pub sd: Vec<f64>,
    /// How many columns belong to no trial.
    pub nuisance: usize,
    /// Column of each small fault that is free throughout.
    pub small: Vec<(&'static str, usize)>,
    /// Column of each fault that was corrected already: what is left of it.
    pub corrected: Vec<(&'static str, usize)>,
    /// The trials.
    pub trials: Vec<Trial>,
}

impl Pool {
    /// Forgets what was added behind so many columns and trials.
    pub fn truncate(&mut self, columns: usize, trials: usize) {
        self.columns.truncate(columns);
        self.sd.truncate(columns);
        self.trials.truncate(trials);
    }
}

/// A cause with its non-linear parameters held.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Which cause.
    pub cause: usize,
    /// Its non-linear parameters.
    pub shape: Vec<f64>,
    /// Its columns, or the one signature of a function.
    pub columns: Vec<usize>,
    /// Which of the cause's terms each column stands for; the other linear ones are zero.
    pub terms: Vec<usize>,
    /// Columns that stand beside a function of it: what goes with speed.
    pub beside: Vec<usize>,
    /// The level of each run that its signature was made at, where it is in proportion to none; empty where it is.
    pub levels: Vec<f64>,
}

impl Trial {
    /// A trial of which columns are known by their terms, and nothing else.
    pub fn new(cause: usize, shape: &[f64], columns: Vec<usize>, terms: Vec<usize>) -> Self {
        Self { cause, shape: shape.to_vec(), columns, terms, beside: Vec::new(), levels: Vec::new() }
    }
}

/// A change of a free parameter for its column, as a share of its standard deviation.
const NUISANCE_STEP: f64 = 0.3;
/// A change of an effect's parameter for its column, as a share of its usual size.
const CAUSE_STEP: f64 = 0.5;
/// The same, beside what was found so far, of causes that take from the resistance of the ground: where little of it is left they would
/// take all, and no resistance drives.
const STEP_BESIDE: f64 = 0.05;
const TAKES: [&str; 2] = ["multipass", "rolling_resistance"];
/// What is left of a corrected fault, as a share of its usual size.
const REST: f64 = 0.1;
/// What a map is everywhere, as a share of what it is in places: a level belongs to the soil, and a slope all along to the lane.
const LEVEL: f64 = 0.3;
/// A column weaker than this share of the residual says nothing.
const WEAKEST: f64 = 1e-7;

/// Columns of the free parameters and of faults of sensors that belong to no trial.
pub fn nuisance(case: &Case, system: &System) -> Result<Pool, DiagnoseError> {
    let mut pool = Pool::default();
    let priors = case.study.priors();
    for (index, parameter) in case.study.parameters.iter().enumerate() {
        let sd = parameter.sd.unwrap_or_else(|| wide(parameter.value, parameter.bounds));
        let mut step = NUISANCE_STEP * sd;
        if parameter.value + step > parameter.bounds.1 {
            step = -step;
        }
        let mut values = priors.clone();
        values[index] = (values[index] + step).clamp(parameter.bounds.0, parameter.bounds.1);
        let step = values[index] - priors[index];
        let after = case.said_so_far_with(case.study.scenario(), &values)?;
        pool.columns.push(system.column(|kind| difference(case, kind, &after, step)));
        pool.sd.push(sd);
    }
    let small = small_faults(case, system)?.into_iter().chain(small_losses(case, system));
    let bent = bent_engine(case, system, &pool.columns);
    for small in small
        .chain(slow_powers(case, system))
        .chain(torque_errors(case, system))
        .chain(bent)
        .chain(half_samples(case, system))
    {
        pool.small.push((small.id, pool.columns.len()));
        pool.columns.push(small.column);
        pool.sd.push(small.sd);
    }
    for correction in &case.corrections {
        let scale = case.causes[correction.accepted.trial.cause].terms[0].scale;
        pool.corrected.push((correction.id, pool.columns.len()));
        // A small step: most of the fault is gone.
        pool.columns.push(fault(case, system, correction.id, REST * scale)?);
        pool.sd.push(scale);
    }
    pool.nuisance = pool.columns.len();
    Ok(pool)
}

/// Columns of the free parameters, of small faults and of all causes.
pub fn pool(case: &Case, system: &System) -> Result<Pool, DiagnoseError> {
    let mut pool = nuisance(case, system)?;
    for (number, cause) in case.causes.iter().enumerate() {
        case.step(cause.id)?;
        let corrected = case.corrections.iter().any(|correction| correction.id == cause.id);
        let out = case.only.as_ref().is_some_and(|only| !only.contains(&number));
        // What is of two causes shows as two where there are many rows, and to choose it takes two searches more.
        let out = out || cause.is_of_two() && system.row_count() > MANY_ROWS;
        if out || corrected || case.no_faults.contains(&cause.id) {
            continue;
        }
        for shape in &cause.shapes {
            add_trial(case, system, &mut pool, number, shape)?;
        }
    }
    Ok(pool)
}

/// Adds a trial of a cause with these non-linear parameters.
pub fn add_trial(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    number: usize,
    shape: &[f64],
) -> Result<(), DiagnoseError> {
    add_trial_at(case, system, pool, number, (shape, &[]))
}

/// The same of a cause that is in proportion to none of its levels, at those of each run; in small steps where there are none.
pub fn add_trial_at(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    number: usize,
    (shape, levels): (&[f64], &[f64]),
) -> Result<(), DiagnoseError> {
    let cause = &case.causes[number];
    let mut found: Vec<Part> = Vec::new();
    for (term, part) in cause.terms.iter().enumerate().filter(|(_, term)| term.linear) {
        let share = if case.has_built() && TAKES.contains(&cause.id) { STEP_BESIDE } else { CAUSE_STEP };
        let whole = cause.own_step(shape).or_else(|| case.step_so_far(cause, part));
        let step = whole.unwrap_or(share * part.scale);
        let known = pool
            .trials
            .iter()
            .find(|trial| cause.does_the_same((term, shape), &case.causes[trial.cause], &trial.shape));
        let column = if let Some(known) = known {
            pool.columns[known.columns[0]].clone()
        } else if !levels.is_empty() {
            at_levels(case, system, cause, shape, levels)?
        } else if let Some(column) = in_window(case, system, cause, (term, step), shape)? {
            column
        } else if cause.form == Form::Measured {
            let mut column = fault(case, system, cause.id, shape.first().copied().unwrap_or(step))?;
            system.silence(&mut column, |kind| kind.among(cause.balances));
            column
        } else {
            effect(case, system, cause, step, &|run| signature(cause, term, step, shape, run))?
        };
        let map = cause.form == Form::OverPosition;
        let scale = if map { LEVEL * part.scale } else { part.scale };
        found.push(Part { column, scale, term });
    }
    let beside = found.first().map_or_else(Vec::new, |one| with_speed(case, system, cause, &one.column));
    let trials = pool.trials.len();
    add(system, pool, (number, cause), shape, found);
    if let Some(trial) = pool.trials.get_mut(trials) {
        trial.levels = levels.to_vec();
        trial.beside = (pool.columns.len()..pool.columns.len() + beside.len()).collect();
        for (column, sd) in beside {
            pool.columns.push(column);
            pool.sd.push(sd);
        }
    }
    Ok(())
}

/// What a cause that has a level in each run does to the rows at those, per unit of them.
fn at_levels(
    case: &Case,
    system: &System,
    cause: &Cause,
    shape: &[f64],
    levels: &[f64],
) -> Result<Column, DiagnoseError> {
    let mut column =
        effect(case, system, cause, 1.0, &|run: &Recorded| cause.constant(levels[run.number], shape))?;
    for (rows, chunk) in column.iter_mut().zip(&system.chunks) {
        *rows /= levels[chunk.run];
    }
    Ok(column)
}

/// What an effect does to the rows, per step of it.
pub fn effect(
    case: &Case,
    system: &System,
    cause: &Cause,
    step: f64,
    text: &(impl Fn(&Recorded) -> String + Sync),
) -> Result<Column, DiagnoseError> {
    Ok(case.column(system, &shown(case, system, cause, step, text)?))
}

/// The same per unit of a cause written in full, beside free parameters of these values and what the model says with them alone.
pub fn effect_beside(
    case: &Case,
    system: &System,
    cause: &Cause,
    text: &(impl Fn(&Recorded) -> String + Sync),
    (values, before): (&[f64], &[Said]),
) -> Result<Column, DiagnoseError> {
    let after = case.said_beside(text, values, &case.kinds)?;
    let of_kind = |kind: Kind| {
        let mut samples = changes(case, kind, (before, &after), 1.0);
        mute(cause, kind, system, &mut samples);
        (kind, samples)
    };
    Ok(case.column(system, &tried(cause, system).into_iter().map(of_kind).collect()))
}

impl Case<'_> {
    /// The rows of what is shown in samples, and of nothing elsewhere.
    pub fn column(&self, system: &System, shown: &Shown) -> Column {
        system.column(|kind| {
            let known = shown.iter().find(|(own, _)| *own == kind);
            known.map_or_else(|| vec![Vec::new(); self.runs.len()], |(_, samples)| samples.clone())
        })
    }
}

/// What an effect does to every sample of the balances that its cause is tried on, per step of it.
pub fn shown(
    case: &Case,
    system: &System,
    cause: &Cause,
    step: f64,
    text: &(impl Fn(&Recorded) -> String + Sync),
) -> Result<Shown, DiagnoseError> {
    let kinds = tried(cause, system);
    if kinds.is_empty() {
        return Ok(Shown::new());
    }
    let texts = case.runs.iter().map(text).collect();
    let known = case.remembered(Driven { kinds, texts, step }, |driven| {
        let after = case.said_beside(text, &case.study.priors(), &driven.kinds)?;
        let of_kind = |kind: &Kind| (*kind, difference(case, *kind, &after, step));
        Ok(driven.kinds.iter().map(of_kind).collect())
    })?;
    let mut shown = Shown::clone(&known);
    for (kind, samples) in &mut shown {
        mute(cause, *kind, system, samples);
    }
    Ok(shown)
}

/// What a drive that loses all its force on the way would leave out of the motion, sample by sample [N].
pub fn lost_drive_n(case: &Case) -> Result<Vec<Vec<f64>>, DiagnoseError> {
    /// A share that any driveline can lose.
    const SHARE: f64 = 0.1;
    let text = format!("driveline_efficiency(loss: {SHARE:?})");
    let after = case.said_beside(&|_| text.clone(), &case.study.priors(), &[Kind::Motion])?;
    Ok(difference(case, Kind::Motion, &after, SHARE))
}

/// Samples of every run, by the balance that they show in.
pub type Shown = Vec<(Kind, Vec<Vec<f64>>)>;

/// What wheels that slip by all their speed would make of each balance that slip shows in, sample by sample, by how a little slip shows.
pub fn per_slip(case: &Case, system: &System) -> Result<Shown, DiagnoseError> {
    /// A slip that leaves speeds and powers in proportion to it, nearly.
    const SLIP: f64 = 1e-3;
    let slip = Cause::slip();
    let text = slip.written(&[SLIP]);
    shown(case, system, &slip, SLIP, &|_| text.clone())
}

/// What a newton against the motion makes of each balance that such a force shows in, sample by sample.
pub fn per_newton(case: &Case, system: &System) -> Result<Shown, DiagnoseError> {
    /// A force that any vehicle can bear [N].
    const PULL_N: f64 = 100.0;
    let pull = Cause::pull();
    let text = pull.written(&[PULL_N]);
    shown(case, system, &pull, PULL_N, &|_| text.clone())
}

/// The balances that a cause is tried on.
fn tried(cause: &Cause, system: &System) -> Vec<Kind> {
    system.kinds.iter().copied().filter(|kind| tried_on(cause, *kind, system)).collect()
}

/// Whether a cause is tried on a balance, in any run.
pub fn tried_on(cause: &Cause, kind: Kind, system: &System) -> bool {
    // What an engine takes within itself never comes to its shaft.
    let within = kind == Kind::Shaft && ["engine_friction", "cold_start"].contains(&cause.id);
    if within || !kind.among(cause.balances) {
        return false;
    }
    let forced = told_by_force(cause, kind, system);
    system
        .chunks
        .iter()
        .any(|chunk| system.kind(chunk) == kind && !forced.get(chunk.run).is_some_and(|one| *one))
}

/// Causes of motion are looked for in powers only in runs in which no force was measured: takes the others out.
pub fn mute(cause: &Cause, kind: Kind, system: &System, samples: &mut [Vec<f64>]) {
    for (samples, forced) in samples.iter_mut().zip(told_by_force(cause, kind, system)) {
        if forced {
            samples.clear();
        }
    }
}

/// The runs, by number, in which a force tells of the cause and a power need not.
fn told_by_force(cause: &Cause, kind: Kind, system: &System) -> Vec<bool> {
    if !kind.is_power() || !cause.balances.contains(&Kind::Motion) {
        return Vec::new();
    }
    let moves = |run: usize| {
        let mut rows = system.chunks.iter().filter(|chunk| system.kind(chunk) == Kind::Motion);
        rows.any(|chunk| chunk.run == run)
    };
    system.forced.iter().enumerate().map(|(run, forced)| *forced && moves(run)).collect()
}

/// A standard deviation for a parameter of which nothing is known.
fn wide(value: f64, bounds: (f64, f64)) -> f64 {
    let range = bounds.1 - bounds.0;
    if range.is_finite() {
        range
    } else if value != 0.0 {
        value.abs()
    } else {
        1.0
    }
}

/// The effect that stands for one term of a cause, as it is written for a run.
fn signature(cause: &Cause, term: usize, step: f64, shape: &[f64], run: &Recorded) -> String {
    if matches!(cause.form, Form::OverPosition | Form::OverTime) {
        return cause.constant(step, shape);
    }
    let mut held = shape.iter();
    let value = |(index, part): (usize, &crate::causes::catalogue::Term)| match part.linear {
        true if index == term => step,
        true => 0.0,
        false => held.next().copied().unwrap_or(1.0),
    };
    let values: Vec<f64> = cause.terms.iter().enumerate().map(value).collect();
    for_run(&cause.written(&values), cause, run)
}

/// What a run alone knows of an effect.
pub fn for_run(text: &str, cause: &Cause, run: &Recorded) -> String {
    if cause.run.is_some_and(|own| own != run.number) {
        return cause.idle();
    }
    text.to_owned()
}

/// What a change of the model does to the residual of each run, for a step of one.
fn difference(case: &Case, kind: Kind, after: &[Said], step: f64) -> Vec<Vec<f64>> {
    changes(case, kind, (case.said_so_far(), after), step)
}

/// The same from before to after.
fn changes(case: &Case, kind: Kind, (before, after): (&[Said], &[Said]), step: f64) -> Vec<Vec<f64>> {
    let of_run = |(run, (before, after)): (&Recorded, (&Said, &Said))| {
        change(kind, run, before, after).iter().map(|value| -value / step).collect()
    };
    case.runs.iter().zip(before.iter().zip(after)).map(of_run).collect()
}

/// The column of one term.
struct Part {
    column: Column,
    scale: f64,
    term: usize,
}

fn add(system: &System, pool: &mut Pool, (number, cause): (usize, &Cause), shape: &[f64], found: Vec<Part>) {
    let everywhere = vec![true; system.chunks.iter().map(|chunk| chunk.run + 1).max().unwrap_or(0)];
    let squares = |column: &Column| system.mean_squares(column, &everywhere);
    let residual = squares(&system.residual);
    let says = |one: &Part| {
        let own = squares(&one.column);
        own.iter().zip(&residual).any(|(own, residual)| own.sqrt() * one.scale > WEAKEST * residual.sqrt())
    };
    let found: Vec<Part> = found.into_iter().filter(says).collect();
    if found.is_empty() {
        return;
    }
    let first = pool.columns.len();
    let columns: Vec<usize> = (first..first + found.len()).collect();
    let terms: Vec<usize> = found.iter().map(|one| one.term).collect();
    for one in found {
        pool.columns.push(one.column);
        pool.sd.push(one.scale);
    }
    // A cause of several terms is tried with each of them alone as well: none is claimed that is not needed.
    if columns.len() > 1 {
        for (column, term) in columns.iter().zip(&terms).filter(|(_, term)| cause.alone(**term)) {
            let (columns, terms) = (vec![*column], vec![*term]);
            pool.trials.push(Trial::new(number, shape, columns, terms));
        }
    }
    pool.trials.push(Trial::new(number, shape, columns, terms));
}
