//! Which causes the recordings need: sets of them are grown side by side while the evidence grows more than chance could
//! make it grow, and the best set is asked of each of its causes whether it can do without, or with another instead.

use crate::Case;
use crate::balances::balance::System;
use crate::balances::gram::{Column, Estimate, Reduced};
use crate::balances::noise::{Noises, Shape};
use crate::causes::catalogue::Class;
use crate::causes::profile::Function;
use crate::causes::sensors::is_no_fault;
use crate::causes::trial::{Pool, Trial};
use crate::choosing::contest::Contest;
use crate::choosing::state::{Part, Stand, State};
use headland_calibrate::statistics::{Draws, quantile_of_sorted, sorted};
use rayon::prelude::*;

/// A cause that is needed.
#[derive(Clone, Debug)]
pub struct Accepted {
    /// Its trial.
    pub trial: Trial,
    /// Growth of ln p, beside the other causes.
    pub gain: f64,
    /// What chance would have made of the best of all trials, once in a hundred.
    pub by_chance: f64,
    /// Causes that explain as much.
    pub rivals: Vec<Rival>,
    /// The function, where it is one.
    pub function: Option<Function>,
    /// The function as every run tells its own part of it, those held out among them: to be looked at, no proof.
    pub along: Option<Function>,
    /// The balance in which it shows most.
    pub balance: usize,
}

/// A cause that explains as much as another.
#[derive(Clone, Debug)]
pub struct Rival {
    /// Index of the cause.
    pub cause: usize,
    /// Growth of ln p in the other's place.
    pub gain: f64,
    /// Squared correlation with it, free parameters and other causes projected out.
    pub squared_correlation: f64,
    /// What the free parameters are beside it.
    pub free: Vec<Beside>,
}

/// A free parameter as a set of causes has it.
#[derive(Clone, Copy, Debug)]
pub struct Beside {
    /// How far it is from where the scenario has it.
    pub change: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// One round: the best trials, each with the growth of ln p that it brought.
#[derive(Clone, Debug)]
pub struct Round {
    /// What a growth has to exceed.
    pub by_chance: f64,
    /// Cause, its shape and its gain, the best first.
    pub causes: Vec<(usize, Vec<f64>, f64)>,
}

/// What was found.
#[derive(Clone)]
pub struct Found {
    /// What was tried, round after round.
    pub tried: Vec<Round>,
    /// Causes that the fitted runs ask for but do not teach each other.
    pub unproven: Vec<usize>,
    /// The causes, those that bring most first.
    pub accepted: Vec<Accepted>,
    /// Noise before and after.
    pub noises: (Noises, Noises),
    /// Columns in use at the end.
    pub used: Vec<usize>,
    /// Their estimate.
    pub estimate: Estimate,
    /// What is left of every row.
    pub left: Column,
    /// What the free parameters alone leave of every row.
    pub before: Column,
    /// What each accepted cause does to every row.
    pub effects: Vec<Column>,
    /// The set that was accepted.
    pub stand: Stand,
    /// The free parameters alone.
    pub first: Stand,
    /// What a growth had to exceed.
    pub needed: f64,
    /// The best set of several causes that all runs share, none of them a function, accepted or not.
    pub several: Option<Stand>,
}

/// At most so many causes.
pub const MOST_CAUSES: usize = 3;
/// So many sets are grown side by side, and each by so many causes.
const BEAM: usize = 6;
/// Each cause more makes a set less likely from the start: odds of one to twenty.
pub const PER_CAUSE: f64 = 3.0;
/// A growth of ln p within this of the best one does not tell the two apart: odds of one to twenty.
pub const TOLERANCE: f64 = 3.0;
/// No growth below this counts, whatever chance can do: odds of a thousand to one, because no model of a vehicle is exact and
/// chance is only that of its noise.
pub const LEAST_GAIN: f64 = 7.0;
/// Draws of the null distribution.
const DRAWS: u64 = 300;
/// An effect has to be at least this share of a row's noise, as root mean square.
const LEAST_EFFECT: f64 = 0.15;
/// A cause has to be at least this share of what was to be explained in one of its balances, as mean square.
const LEAST_SHARE: f64 = 0.01;
/// A formula of this squared correlation with a listed cause is that cause.
pub const OTHER_WORDS: f64 = 0.97;
/// Two causes that leave less than this share of the smaller one when they are added cancel each other: neither is there.
const CANCELLED: f64 = 0.3;
/// What they are in a balance matters from this share of what the smaller is in all, and of the noise.
const OPENED: f64 = 0.3;

/// Searches the causes.
pub fn search(case: &Case, system: &System, pool: &Pool) -> Option<Found> {
    search_without(case, system, pool, &[])
}

/// As [`search`], without some causes.
pub fn search_without(case: &Case, system: &System, pool: &Pool, banned: &[&str]) -> Option<Found> {
    let state = State { case, system, pool, fit: &case.fit };
    let first = state.settle(&[], &system.noises(&system.residual, &case.fit))?;
    let mut tried: Vec<Round> = Vec::new();
    let mut best = first.clone();
    let mut others: Vec<Stand> = Vec::new();
    let mut open = vec![first.clone()];
    let mut needed = LEAST_GAIN;
    for _ in 0..MOST_CAUSES {
        let mut grown: Vec<Stand> = Vec::new();
        for (place, stand) in open.iter().enumerate() {
            let reduced = state.reduced(&stand.noises, &stand.parts)?;
            if place == 0 {
                needed = LEAST_GAIN.max(state.chance(stand, &reduced));
            }
            let mut judged = state.contest(stand, &reduced, banned);
            if place == 0 {
                judged = state.spread_anew(stand, judged);
                tried.push(Round {
                    by_chance: needed,
                    causes: judged.iter().map(|one| one.told(stand.score)).collect(),
                });
            }
            let able = judged.into_iter().filter(|one| one.stand.score - stand.score >= needed);
            grown.extend(able.map(|one| one.stand).filter(|stand| state.sensible(stand)).take(BEAM));
        }
        grown.sort_by(|one, other| other.score.total_cmp(&one.score));
        grown.dedup_by(|one, other| same(one, other));
        grown.truncate(BEAM);
        if let Some(finer) = grown.first().and_then(|top| state.spread_finer(top)) {
            grown[0] = finer;
        }
        if let Some(shared) = grown.first().and_then(|top| state.shared_instead(top)) {
            grown[0] = shared;
        }
        let Some(top) = grown.first() else { break };
        others.extend(grown.iter().cloned());
        if worth(top) > worth(&best) {
            best = top.clone();
        }
        open = grown;
    }
    let mut several: Option<Stand> = None;
    let by_run = best.parts.iter().any(|part| state.cause(&part.trial).by_run);
    for stand in state.together(&first, banned, by_run) {
        // Several that only do together are asked as much of as one after the other would be.
        let more = stand.parts.len().saturating_sub(best.parts.len()).max(1);
        if worth(&stand) > worth(&best) + LEAST_GAIN * more as f64 {
            best = stand.clone();
        }
        let shared = |part: &Part| part.spread.is_none() && !state.cause(&part.trial).by_run;
        let better = several.as_ref().is_none_or(|other| worth(&stand) > worth(other));
        if better && stand.parts.iter().all(shared) {
            several = Some(stand.clone());
        }
        others.push(stand);
    }
    let never = (0..case.causes.len()).filter(|cause| banned.contains(&case.causes[*cause].id)).collect();
    let mut found = Found { several, ..state.conclude(best, first, (tried, never), needed)? };
    found.unproven.retain(|cause| !banned.contains(&case.causes[*cause].id));
    let unproven = case.ids(&found.unproven);
    others.retain(|stand| !stand.parts.iter().any(|part| state.cause(&part.trial).is_banned(&unproven)));
    state.sets_as_good(&mut found, &others);
    Some(found)
}

/// As it was found, but with another set of causes.
pub fn concluded(state: &State, best: Stand, found: &Found) -> Option<Found> {
    state.conclude(best, found.first.clone(), (found.tried.clone(), Vec::new()), found.needed)
}

/// How good a set is, with what every cause more costs.
pub fn worth(stand: &Stand) -> f64 {
    stand.score - PER_CAUSE * stand.parts.len() as f64
}

/// Whether two sets hold the same causes.
fn same(one: &Stand, other: &Stand) -> bool {
    let causes = |stand: &Stand| {
        let mut all: Vec<usize> = stand.parts.iter().map(|part| part.trial.cause).collect();
        all.sort_unstable();
        all
    };
    causes(one) == causes(other)
}

impl Contest {
    /// Cause, shape and gain.
    fn told(&self, base: f64) -> (usize, Vec<f64>, f64) {
        let (cause, shape) = self
            .stand
            .parts
            .last()
            .map_or((0, Vec::new()), |part| (part.trial.cause, part.trial.shape.clone()));
        (cause, shape, self.stand.score - base)
    }
}

impl State<'_> {
    /// The growth of ln p that the best of all trials reaches by chance once in a hundred, if nothing is missing.
    pub fn chance(&self, stand: &Stand, reduced: &Reduced) -> f64 {
        let trials: Vec<&Trial> =
            self.pool.trials.iter().filter(|trial| !self.cause(trial).is_function()).collect();
        let mut jittered = reduced.matrix.clone();
        for index in 0..jittered.nrows() {
            jittered[(index, index)] = jittered[(index, index)] * (1.0 + 1e-9) + 1e-300;
        }
        let Some(cholesky) = jittered.cholesky() else { return LEAST_GAIN };
        let factor = cholesky.l();
        let sd = self.sd();
        let one = |draw: u64| {
            let mut draws = Draws::new(self.case.options.seed, draw);
            let white = nalgebra::DVector::from_fn(factor.nrows(), |_, _| draws.normal());
            let mut problem = reduced.clone();
            problem.vector = &factor * white;
            problem.scalar = 0.0;
            let base = problem.estimate(&stand.used, &sd)?;
            let base = base.log_evidence + self.heavy(&stand.used, &base.beta);
            let gain = trials.iter().filter_map(|trial| {
                let part = Part { trial: (*trial).clone(), spread: None };
                let mut with = stand.used.clone();
                with.extend(&trial.columns);
                let estimate = problem.estimate(&with, &sd)?;
                let heavy = self.heavy(&with, &estimate.beta);
                Some(estimate.log_evidence + heavy - self.choices(&[part]) - base)
            });
            Some(gain.fold(f64::NEG_INFINITY, f64::max))
        };
        let best: Vec<f64> = (0..DRAWS).into_par_iter().filter_map(one).collect();
        if best.is_empty() { LEAST_GAIN } else { quantile_of_sorted(&sorted(&best), 0.99) }
    }

    /// Whether every cause of a set is more than the ear can hear, and none is there to cancel another.
    pub fn sensible(&self, stand: &Stand) -> bool {
        let effects: Vec<Column> = stand.parts.iter().map(|part| stand.effect(self, part)).collect();
        let in_noise = |rows: &Column| -> Vec<f64> {
            let squares = self.system.mean_squares(rows, self.fit);
            squares
                .iter()
                .zip(&stand.noises.each)
                .map(|(square, noise)| square / noise.sd().powi(2))
                .collect()
        };
        let sizes: Vec<Vec<f64>> = effects.iter().map(in_noise).collect();
        // What is much in one balance makes nothing small that works in another.
        let whole: Vec<f64> = (0..stand.noises.each.len())
            .map(|balance| sizes.iter().map(|size| size[balance]).sum())
            .collect();
        let heard = |size: &Vec<f64>| {
            size.iter().zip(&whole).zip(&stand.noises.each).any(|((square, whole), noise)| {
                let loud = match noise.shape {
                    // Differences of speed are noisy row by row and not over a run, so their rows are no measure.
                    Shape::Differenced => *square > 0.0,
                    Shape::Averaged => square.sqrt() > LEAST_EFFECT,
                };
                loud && *square > LEAST_SHARE * whole
            })
        };
        let cancels = |one: usize, other: usize| {
            let sum: Column =
                effects[one].iter().zip(&effects[other]).map(|(one, other)| one + other).collect();
            let left = in_noise(&sum);
            let smaller = |balance: usize| sizes[one][balance].min(sizes[other][balance]);
            let all: f64 = sizes[one].iter().sum::<f64>().min(sizes[other].iter().sum());
            // In one balance as well, what one opens for the sake of another balance the other only shuts.
            let shut = |balance: usize| {
                smaller(balance) > OPENED * all.max(1.0) && left[balance] < CANCELLED * smaller(balance)
            };
            left.iter().sum::<f64>() < CANCELLED * all || (0..left.len()).any(shut)
        };
        let pairs = (0..effects.len()).flat_map(|one| (0..one).map(move |other| (one, other)));
        sizes.iter().all(heard)
            && !pairs.into_iter().any(|(one, other)| cancels(one, other))
            && stand.parts.iter().all(|part| self.beyond_the_sensor(stand, part))
            && self.needs_no_answer(stand)
    }

    /// Whether a sensor's fault is one that anybody would mind.
    fn beyond_the_sensor(&self, stand: &Stand, part: &Part) -> bool {
        let position = part.trial.columns.first().and_then(|column| stand.position(*column));
        let value = position.map_or(0.0, |position| stand.estimate.beta[position]);
        !is_no_fault(self.case, self.id(&part.trial), value)
    }
}

/// Of two that explain as much, a cause in the world is named before a fault of a sensor.
pub fn rank(stand: &Stand, state: &State) -> f64 {
    /// A difference of ln p that is none.
    const NEARLY: f64 = 1.0;
    let artefact = stand.parts.last().is_some_and(|part| state.cause(&part.trial).class == Class::Artefact);
    stand.score - if artefact { NEARLY } else { 0.0 }
}
