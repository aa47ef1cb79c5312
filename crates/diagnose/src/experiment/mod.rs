//! The next experiment: the run that would tell what these recordings cannot.
//!
//! Every run of a catalogue is drafted with what was found at work, and the columns of all causes in doubt are made on
//! it as they are on the runs at hand. What a run would add to their ln p follows from the normal equations; nothing
//! has to be driven for it.

mod columns;
mod course;
mod draft;
mod information;
mod null_space;
mod signature;
mod stage;
mod timed;
mod words;

use crate::balances::gram::Reduced;
use crate::balances::noise::Noises;
use crate::causes::catalogue::Form;
use crate::causes::trial::{Pool, Trial};
use crate::choosing::search::{Found, Rival};
use crate::proof::refine::{Cured, Refined};
use crate::{Case, DiagnoseError, System};
use columns::Columns;
use course::Without;
use information::{Odds, Sides, World, known, narrowing, odds};
use rayon::prelude::*;
use serde::Serialize;
use stage::Stage;

/// A run that could be driven, and what it would tell.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Experiment {
    /// What it is: `other_direction`, `ballast`, `hold_high_speed`.
    pub run: String,
    /// One sentence for a person.
    pub sentence: String,
    /// The two causes that it would separate.
    pub separates: [String; 2],
    /// ln p of the true one over that of the other after the run, in the worse of the two cases.
    pub expected_ln_odds: f64,
}

/// What to drive next.
#[derive(Debug, Default)]
pub struct Proposals {
    /// Runs against pairs of causes, the one that tells most first.
    pub experiments: Vec<Experiment>,
    /// The best for each cause that was found; none where nothing can be computed.
    pub next: Vec<Option<String>>,
    /// What the recordings know only together.
    pub null_space: Vec<String>,
}

/// So many rivals of a finding are told from it.
const MOST_RIVALS: usize = 3;
/// Odds that tell: twenty to one.
const TELLS: f64 = 3.0;
/// Odds beyond which more is not better: a thousand to one.
const ENOUGH: f64 = 7.0;

/// Proposes runs. Where what was found cannot be driven otherwise than it was, nothing is proposed; the diagnosis stands.
pub fn propose(
    case: &Case,
    system: &System,
    pool: &Pool,
    found: &Found,
    refined: &Refined,
) -> Result<Proposals, DiagnoseError> {
    match thought_through(case, system, pool, found, refined) {
        Err(DiagnoseError::Interrupted) => Err(DiagnoseError::Interrupted),
        Err(_) => {
            let null_space = null_space::sentences(case, system, pool, found, refined);
            Ok(Proposals { null_space, next: vec![None; refined.causes.len()], ..Proposals::default() })
        }
        proposals => proposals,
    }
}

fn thought_through(
    case: &Case,
    system: &System,
    pool: &Pool,
    found: &Found,
    refined: &Refined,
) -> Result<Proposals, DiagnoseError> {
    case.step("proposing")?;
    let null_space = null_space::sentences(case, system, pool, found, refined);
    let mut proposals =
        Proposals { null_space, next: vec![None; refined.causes.len()], ..Proposals::default() };
    let mut doubts = Vec::new();
    for (place, cured) in refined.causes.iter().enumerate().filter(|(_, cured)| cured.events.is_empty()) {
        let rivals = rivals(case, cured, pool);
        if cured.cause.form == Form::OverTime {
            proposals.next[place] = timed::next(case, cured, &rivals);
        } else {
            doubts.push((place, cured, rivals));
        }
    }
    if doubts.is_empty() {
        return Ok(proposals);
    }
    let accepted = refined.causes.iter().filter(|one| one.events.is_empty()).map(|one| &one.accepted.trial);
    let rivals = doubts.iter().flat_map(|(_, _, rivals)| rivals.iter().flat_map(|one| &one.trials));
    let trials: Vec<&Trial> = accepted.chain(rivals).collect();
    let doubted: Vec<usize> = trials.iter().map(|trial| trial.cause).collect();
    let mut stage = match Stage::new(case, refined, &doubted) {
        Ok(Some(stage)) => stage,
        Ok(None) => return Ok(proposals),
        Err(error) => return Err(error),
    };
    for trial in trials {
        stage.bring(trial.cause, &trial.shape)?;
    }
    for (place, cured, rivals) in doubts {
        let columns = Columns::new(case, &stage, system, pool, found);
        let Some(judged) = judge(case, &stage, columns, cured, refined, &rivals)? else { continue };
        proposals.next[place] = words::next(case, &stage.courses, cured, &judged);
        let all = judged.doubts.iter().flat_map(|doubt| words::experiments(&stage.courses, cured, doubt));
        proposals.experiments.extend(all);
    }
    proposals.experiments.sort_by(|one, other| other.expected_ln_odds.total_cmp(&one.expected_ln_odds));
    Ok(proposals)
}

/// A rival with the trials that could stand for it.
struct Candidate {
    cause: usize,
    id: &'static str,
    /// How much less it explains of the runs at hand, in ln p.
    behind: f64,
    trials: Vec<Trial>,
}

/// A rival, and what every proposed run would say of it: none where the run does not fit the question.
struct Doubt {
    rival: &'static str,
    now: f64,
    expected: Vec<Option<f64>>,
}

/// What every proposed run would say of a finding.
struct Judged {
    doubts: Vec<Doubt>,
    /// Rivals that are functions of time, which other runs say nothing of, and how much less they explain.
    timed: Vec<(&'static str, f64)>,
    /// Half the 95 % interval of its size, over the size.
    known: Option<f64>,
    /// By which factor that interval would shrink.
    narrowing: Vec<Option<f64>>,
}

/// The rivals of a finding, the nearest first.
fn rivals(case: &Case, cured: &Cured, pool: &Pool) -> Vec<Candidate> {
    let of = |rival: &Rival| Candidate {
        cause: rival.cause,
        id: case.causes[rival.cause].id,
        behind: cured.accepted.gain - rival.gain,
        trials: pool.trials.iter().filter(|trial| trial.cause == rival.cause).cloned().collect(),
    };
    let mut rivals: Vec<Candidate> = cured.accepted.rivals.iter().map(of).collect();
    rivals.sort_by(|one, other| one.behind.total_cmp(&other.behind));
    rivals.truncate(MOST_RIVALS);
    rivals
}

fn judge(
    case: &Case,
    stage: &Stage,
    mut columns: Columns,
    cured: &Cured,
    refined: &Refined,
    rivals: &[Candidate],
) -> Result<Option<Judged>, DiagnoseError> {
    let own_cause = cured.accepted.trial.cause;
    let Some(own) = columns.found(cured)? else { return Ok(None) };
    // A fault that the recordings were corrected for is in doubt as well: they are taken as they were.
    if own[0] < columns.nuisance {
        columns.uncorrect(own[0], cured.values.first().map_or(0.0, |(value, _)| *value));
    }
    let nuisance: Vec<usize> = (0..columns.nuisance).filter(|column| !own.contains(column)).collect();
    let mut others: Vec<(usize, Vec<usize>)> = Vec::new();
    for one in refined.causes.iter().filter(|one| one.events.is_empty() && one.cause.id != cured.cause.id) {
        let added = if one.cause.form == Form::OverTime { columns.timed(one) } else { columns.found(one)? };
        let mut added = added.unwrap_or_default();
        added.retain(|column| *column >= columns.nuisance);
        others.push((one.accepted.trial.cause, added));
    }
    let beside = |rival: Option<&Candidate>| -> Vec<usize> {
        let kept = others.iter().filter(|(cause, _)| rival.is_none_or(|rival| rival.cause != *cause));
        nuisance.iter().copied().chain(kept.flat_map(|(_, columns)| columns.iter().copied())).collect()
    };
    let like = cured.function().map(|function| &function.spread);
    let mut sides: Vec<(&Candidate, Vec<usize>)> = Vec::new();
    // One value throughout is what a function may be as well: no run tells the two apart but where the ground goes on.
    let even = cured.cause.even().map(|(even, _)| even);
    for rival in rivals.iter().filter(|rival| Some(rival.id) != even) {
        if let Some(other) = columns.rival(&rival.trials, &beside(Some(rival)), like)? {
            sides.push((rival, other));
        }
    }
    let in_world = |noises: &Noises| Some((columns.now(noises)?, columns.proposed(noises)?));
    let worlds: Option<Vec<(Reduced, Vec<Reduced>)>> = columns.noises().par_iter().map(in_world).collect();
    let Some(worlds) = worlds else { return Ok(None) };
    let Some((now, proposed)) = worlds.first() else { return Ok(None) };
    let of_rival = |(rival, other): (&Candidate, Vec<usize>)| {
        let common = beside(Some(rival));
        let sides = Sides { common: &common, one: &own, other: &other, sd: &columns.sd };
        let expected = stage.courses.iter().enumerate().map(|(place, course)| {
            let worlds: Vec<World> =
                worlds.iter().map(|(now, proposed)| World { now, more: &proposed[place] }).collect();
            let silent = |cause: usize| course.without.silences(&case.causes[cause]);
            let fits = course.without == Without::Nothing || silent(own_cause) || silent(rival.cause);
            let odds: Option<Odds> = if fits { odds(&worlds, &sides) } else { None };
            odds.map(|odds| odds.expected(rival.behind)).filter(|expected| expected.is_finite())
        });
        Doubt { rival: rival.id, now: rival.behind, expected: expected.collect() }
    };
    let doubts = sides.into_iter().map(of_rival).collect();
    let used: Vec<usize> = beside(None).into_iter().chain(own.iter().copied()).collect();
    let narrowing = stage.courses.iter().zip(proposed).map(|(course, more)| {
        let plain = course.without == Without::Nothing;
        if plain { narrowing(now, &more.matrix, &used, own.len(), &columns.sd) } else { None }
    });
    let timed = rivals.iter().filter(|rival| case.causes[rival.cause].form == Form::OverTime);
    Ok(Some(Judged {
        doubts,
        timed: timed.map(|rival| (rival.id, rival.behind)).collect(),
        known: known(now, &used, own.len(), &columns.sd),
        narrowing: narrowing.collect(),
    }))
}
