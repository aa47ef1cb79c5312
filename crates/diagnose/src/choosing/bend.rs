//! Causes that are not in proportion to their parameters: a wind of 8 m/s pushes more than twice as hard as one of 4 m/s.
//! Their columns are made once more at the size that was found, so that what they say there is exact.
//!
//! The effect of several parameters is divided among them as if each had been added first and last in turn, half and half,
//! which for two of them gives the whole effect without a rest.
//! Source: L. S. Shapley, in *Contributions to the Theory of Games* II (1953), 307 (the division).

use crate::balances::balance::Kind;
use crate::balances::gram::Column;
use crate::balances::noise::Noises;
use crate::causes::catalogue::{Cause, Form};
use crate::causes::profile::COARSE;
use crate::causes::trial::{Pool, Trial, add_trial_at, effect, effect_beside, for_run};
use crate::choosing::search::{Found, TOLERANCE};
use crate::choosing::state::{Part, Stand, State};
use crate::proof::mirror::{is_whole, lean};
use crate::runs::recorded::Recorded;
use crate::{Case, DiagnoseError, System};
use nalgebra::DVector;

/// So many causes get the chance.
const MOST: usize = 3;
/// Those that bring at least this share of what the best one brings.
const CLOSE: f64 = 0.5;
/// A cause whose columns miss its effect by less than this share of it is in proportion.
const STRAIGHT: f64 = 0.02;
/// Columns are made anew so many times: each time the size that they are made at is closer.
const ROUNDS: usize = 4;

/// What the parameters of a trial are, and the free ones beside them where those have a say in what they do.
struct Size {
    own: Vec<f64>,
    free: Option<Vec<f64>>,
}

/// Adds trials with columns made at the size that was found, of the best causes that are not in proportion. Whether there
/// was anything to add.
pub fn bend(case: &Case, system: &System, pool: &mut Pool, found: &Found) -> Result<bool, DiagnoseError> {
    let mut chosen: Vec<Trial> = Vec::new();
    let mut consider = |trial: &Trial| {
        let known = |own: &Trial| own.cause == trial.cause && own.terms == trial.terms;
        let cause = &case.causes[trial.cause];
        let able = cause.form == Form::Parameters && cause.law.is_none();
        if able && !chosen.iter().any(known) {
            chosen.push(trial.clone());
        }
    };
    for one in &found.accepted {
        consider(&one.trial);
        // What belongs together is tried with all of it.
        let cause = &case.causes[one.trial.cause];
        let all = |trial: &&Trial| trial.cause == one.trial.cause && trial.terms.len() == cause.terms.len();
        if is_whole(cause) {
            pool.trials.iter().filter(all).for_each(&mut consider);
        }
    }
    if let Some(round) = found.tried.first() {
        let greatest = round.causes.first().map_or(0.0, |one| one.2);
        let close = round.causes.iter().filter(|one| one.2 > 0.0 && one.2 >= CLOSE * greatest);
        for (cause, shape, _) in close.take(MOST) {
            let same = |trial: &&Trial| trial.cause == *cause && trial.shape == *shape;
            pool.trials.iter().filter(same).for_each(&mut consider);
        }
    }
    let mut added = false;
    for trial in chosen {
        let accepted = found.accepted.iter().any(|one| one.trial.columns == trial.columns);
        let others = found.accepted.iter().filter(|one| accepted && one.trial.columns != trial.columns);
        let others: Vec<Part> = others
            .filter(|one| one.function.is_none())
            .map(|one| Part { trial: one.trial.clone(), spread: None })
            .collect();
        let noises = if accepted { &found.noises.1 } else { &found.noises.0 };
        let size = |pool: &Pool, trial: &Trial| size(case, system, pool, trial, (&others, noises));
        added |= bent(case, system, pool, &trial, &size)?;
    }
    Ok(levelled(case, system, pool, found)? || added)
}

/// A set whose listed causes have columns made at the size that they have in it, where the recordings do not deny it: beside a law they are of
/// another size than without it, and so are the free parameters, which may have stood in for the law.
pub fn beside_a_law(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    set: Stand,
) -> Result<Stand, DiagnoseError> {
    let mut best = set;
    for place in 0..best.parts.len() {
        let part = best.parts[place].clone();
        let cause = &case.causes[part.trial.cause];
        if cause.form != Form::Parameters || cause.law.is_some() || part.spread.is_some() {
            continue;
        }
        let mut parts = best.parts.clone();
        parts.remove(place);
        let size = |pool: &Pool, trial: &Trial| size(case, system, pool, trial, (&parts, &best.noises));
        if !bent(case, system, pool, &part.trial, &size)? {
            continue;
        }
        let Some(trial) = pool.trials.last().cloned() else { continue };
        let state = State { case, system, pool, fit: &case.fit };
        let mut parts = best.parts.clone();
        parts[place].trial = trial;
        if let Some(anew) =
            state.settle(&parts, &best.noises).filter(|anew| anew.score > best.score - TOLERANCE)
        {
            best = anew;
        }
    }
    Ok(best)
}

/// What a trial is beside other causes at a noise.
fn size(
    case: &Case,
    system: &System,
    pool: &Pool,
    trial: &Trial,
    (others, noises): (&[Part], &Noises),
) -> Option<Size> {
    let state = State { case, system, pool, fit: &case.fit };
    let mut parts = others.to_vec();
    parts.push(Part { trial: trial.clone(), spread: None });
    let (_, beta) = state.weighed(&parts, noises)?;
    let first = beta.len() - trial.columns.len();
    let own = beta.iter().skip(first).copied().collect();
    let parameters = case.study.parameters.iter().zip(beta.iter());
    let free = parameters
        .map(|(parameter, change)| (parameter.value + change).clamp(parameter.bounds.0, parameter.bounds.1));
    // An engine that holds back burns nothing, however much less it would be asked for: where that ends the free parameters say.
    Some(Size { own, free: system.has(Kind::Fuel).then(|| free.collect()) })
}

/// Adds a wind that blows otherwise in each run, where it is accepted or nearly, at what it is in each of them and along the axis that
/// tells them best. Whether there is one.
fn levelled(case: &Case, system: &System, pool: &mut Pool, found: &Found) -> Result<bool, DiagnoseError> {
    /// The axis is turned by a good part of the way to the next one that was tried, and by halves of that [rad].
    const TURNS_RAD: [f64; 5] = [0.4, 0.2, 0.1, 0.05, 0.025];
    let Some((parts, place)) = blowing(case, system, pool, found) else { return Ok(false) };
    let (columns, trials) = (pool.columns.len(), pool.trials.len());
    let number = parts[place].trial.cause;
    let made = |pool: &mut Pool, stand: &Stand, axis_rad: f64| -> Result<Option<Stand>, DiagnoseError> {
        pool.truncate(columns, trials);
        let Some(levels) = levels_m_s(stand, place) else { return Ok(None) };
        let mut parts = parts.clone();
        add_trial_at(case, system, pool, number, (&[axis_rad], &levels))?;
        let Some(trial) = pool.trials.get(trials) else { return Ok(None) };
        parts[place].trial = trial.clone();
        Ok(State { case, system, pool, fit: &case.fit }.settle(&parts, &found.noises.1))
    };
    let axis_of = |stand: &Stand| stand.parts[place].trial.shape.first().copied().unwrap_or(0.0);
    let first = State { case, system, pool, fit: &case.fit }.settle(&parts, &found.noises.1);
    let Some(mut best) = first else { return Ok(false) };
    for _ in 0..ROUNDS {
        let axis_rad = axis_of(&best);
        let Some(other) = made(pool, &best, axis_rad)? else { break };
        best = other;
    }
    let free = case.causes[number].terms.iter().any(|term| !term.linear && !term.is_held());
    for turn_rad in TURNS_RAD.iter().filter(|_| free).flat_map(|turn_rad| [*turn_rad, -turn_rad]) {
        let turned_rad = axis_of(&best) + turn_rad;
        if let Some(other) = made(pool, &best, turned_rad)?.filter(|other| other.score > best.score) {
            best = other;
        }
    }
    let axis_rad = axis_of(&best);
    made(pool, &best, axis_rad)?;
    Ok(pool.trials.len() > trials)
}

/// A set with a wind that blows otherwise in each run, and its place among the parts: what was accepted, or that wind alone where
/// nothing was and it was the best of what was tried.
fn blowing(case: &Case, system: &System, pool: &Pool, found: &Found) -> Option<(Vec<Part>, usize)> {
    let blows = |trial: &Trial| case.causes[trial.cause].blows_by_run();
    let parts = found.stand.parts.clone();
    if let Some(place) = parts.iter().position(|part| blows(&part.trial)) {
        return Some((parts, place));
    }
    let (cause, shape, gain) = found.tried.first()?.causes.first().filter(|_| parts.is_empty())?;
    let tried = |trial: &&Trial| trial.cause == *cause && trial.shape == *shape && blows(trial);
    let trial = pool.trials.iter().find(tried).filter(|_| *gain > 0.0)?.clone();
    let part = Part { trial, spread: None };
    let state = State { case, system, pool, fit: &case.fit };
    let spread = state.best_spread(&part, &found.stand, &found.noises.1, COARSE)?;
    Some((vec![Part { spread: Some(spread), ..part }], 0))
}

/// What a wind is in each run [m/s], at the begin of it: knots are further apart than any run is long. Where it is next to nothing,
/// its column is that of a little.
fn levels_m_s(stand: &Stand, place: usize) -> Option<Vec<f64>> {
    const LEAST_M_S: f64 = 0.5;
    let even = stand.estimate.beta[stand.position(stand.parts[place].trial.columns[0])?];
    let function = stand.functions.get(place)?.as_ref()?;
    let level = |(values, _): &(DVector<f64>, DVector<f64>)| {
        let level = even + values.iter().next().copied().unwrap_or(0.0);
        level.abs().max(LEAST_M_S).copysign(level)
    };
    Some(function.values.iter().map(level).collect())
}

/// Adds strong winds from all sides. One of 10 m/s is not ten times one of 1 m/s, and next to nothing like it where vehicles are
/// slow; so by the small one it would be overlooked beside other causes, and never be made anew.
pub fn winds(case: &Case, system: &System, pool: &mut Pool) -> Result<(), DiagnoseError> {
    /// A fresh breeze, 5 on Beaufort's scale, as strong as anybody measures in [m/s].
    const FRESH_M_S: f64 = 9.0;
    const SIDES: u8 = 6;
    let is_wind = |trial: &&Trial| {
        let cause = &case.causes[trial.cause];
        is_whole(cause) && cause.form == Form::Parameters && trial.terms.len() == cause.terms.len()
    };
    let Some(small) = pool.trials.iter().find(is_wind).cloned() else { return Ok(()) };
    let scales: Vec<f64> = small.columns.iter().map(|column| pool.sd[*column]).collect();
    for side in 0..SIDES {
        // Never quite along a part, which would then be nought and have no column.
        let (east, north) = (std::f64::consts::TAU * (f64::from(side) + 0.3) / f64::from(SIDES)).sin_cos();
        let size = Size { own: vec![FRESH_M_S * north, FRESH_M_S * east], free: None };
        let made = divided(case, system, &small, &size)?;
        let first = pool.columns.len();
        let columns = (first..first + made.len()).collect();
        pool.columns.extend(made);
        pool.sd.extend(&scales);
        pool.trials.push(Trial { columns, ..small.clone() });
    }
    Ok(())
}

/// Adds one trial anew, if it is not in proportion.
fn bent(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    trial: &Trial,
    size: &dyn Fn(&Pool, &Trial) -> Option<Size>,
) -> Result<bool, DiagnoseError> {
    let cause = &case.causes[trial.cause];
    let (columns, trials) = (pool.columns.len(), pool.trials.len());
    let mut current = trial.clone();
    for round in 0..ROUNDS {
        let Some(mut size) = size(pool, &current) else { break };
        if round == 0 && is_whole(cause) {
            lean(size.own.iter_mut());
        }
        let values = &size.own;
        if values
            .iter()
            .zip(&trial.terms)
            .any(|(value, term)| *value == 0.0 || cause.impossible(*term, *value))
        {
            break;
        }
        let made = divided(case, system, trial, &size)?;
        let old: Vec<&Column> = current.columns.iter().map(|column| &pool.columns[*column]).collect();
        if missed(&made, &old, values) < STRAIGHT {
            break;
        }
        if round > 0 {
            pool.truncate(columns, trials);
        }
        let scales: Vec<f64> = trial.columns.iter().map(|column| pool.sd[*column]).collect();
        current.columns = (columns..columns + made.len()).collect();
        pool.columns.extend(made);
        pool.sd.extend(scales);
        pool.trials.push(current.clone());
    }
    Ok(pool.trials.len() > trials)
}

/// What each parameter of a trial does at these values, per unit of it.
fn divided(
    case: &Case,
    system: &System,
    trial: &Trial,
    Size { own: values, free }: &Size,
) -> Result<Vec<Column>, DiagnoseError> {
    let cause = &case.causes[trial.cause];
    let beside = match free {
        Some(free) => Some((free, case.said_so_far_with(case.study.scenario(), free)?)),
        None => None,
    };
    let with = |within: &dyn Fn(usize) -> bool| -> Result<Column, DiagnoseError> {
        let all = placed(cause, trial, values, within);
        let text = |run: &Recorded| for_run(&cause.written(&all), cause, run);
        match &beside {
            Some((free, said)) => effect_beside(case, system, cause, &text, (free, said)),
            None => effect(case, system, cause, 1.0, &text),
        }
    };
    let whole = with(&|_| true)?;
    if values.len() == 1 {
        return Ok(vec![shared(&whole, values[0])]);
    }
    let alone: Vec<Column> =
        (0..values.len()).map(|place| with(&|own| own == place)).collect::<Result<_, _>>()?;
    let mut made = Vec::new();
    for (place, value) in values.iter().enumerate() {
        // Of two, what is not the one is the other.
        let all_others;
        let others = if values.len() == 2 {
            &alone[1 - place]
        } else {
            all_others = with(&|own| own != place)?;
            &all_others
        };
        let mut column = whole.clone();
        for ((rows, alone), others) in column.iter_mut().zip(&alone[place]).zip(others) {
            *rows += alone;
            *rows -= others;
        }
        made.push(shared(&column, 2.0 * value));
    }
    Ok(made)
}

/// All parameters of a cause with those values of its trial's that are `within`; the other linear ones are zero.
fn placed(cause: &Cause, trial: &Trial, values: &[f64], within: &dyn Fn(usize) -> bool) -> Vec<f64> {
    let mut shape = trial.shape.iter();
    let of = |(index, term): (usize, &crate::causes::catalogue::Term)| {
        if !term.linear {
            return shape.next().copied().unwrap_or(1.0);
        }
        let place = trial.terms.iter().position(|own| *own == index);
        place.filter(|place| within(*place)).map_or(0.0, |place| values[place])
    };
    cause.terms.iter().enumerate().map(of).collect()
}

fn shared(column: &Column, by: f64) -> Column {
    column.iter().map(|rows| rows / by).collect()
}

/// By how much columns of these values miss what others make of them, as a share of that.
fn missed(made: &[Column], old: &[&Column], values: &[f64]) -> f64 {
    let (mut off, mut all) = (0.0, 0.0);
    let Some(first) = made.first() else { return 0.0 };
    for chunk in 0..first.len() {
        for row in 0..first[chunk].len() {
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
                values.iter().enumerate().map(|(place, value)| value * of(place)).sum()
            };
            let whole = sum(&|place| made[place][chunk][row]);
            let straight = sum(&|place| old[place][chunk][row]);
            off += (whole - straight).powi(2);
            all += whole * whole;
        }
    }
    if all > 0.0 { (off / all).sqrt() } else { 0.0 }
}
