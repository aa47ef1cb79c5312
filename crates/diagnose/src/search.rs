//! Which causes the recordings need: sets of them are grown side by side while the evidence grows more than chance could
//! make it grow, and the best set is asked of each of its causes whether it can do without, or with another instead.

use crate::Case;
use crate::balance::System;
use crate::catalogue::{Cause, Class, Form};
use crate::contest::Contest;
use crate::gram::{Column, Estimate, Reduced};
use crate::noise::{Noises, Shape};
use crate::profile::Function;
use crate::sensors::petty;
use crate::state::{Part, Stand, State};
use crate::trial::{Pool, Trial};
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
/// A squared correlation below which a cause does not stand for another one.
const UNLIKE: f64 = 0.02;
/// A formula of this squared correlation with a listed cause is that cause.
pub const OTHER_WORDS: f64 = 0.97;
/// Two causes that leave less than this share of the smaller one when they are added cancel each other: neither is there.
const CANCELLED: f64 = 0.3;

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
            let judged = state.contest(stand, &reduced, banned);
            if place == 0 {
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
        let Some(top) = grown.first() else { break };
        others.extend(grown.iter().cloned());
        if worth(top) > worth(&best) {
            best = top.clone();
        }
        open = grown;
    }
    for stand in state.together(&first, banned) {
        if worth(&stand) > worth(&best) + LEAST_GAIN {
            best = stand.clone();
        }
        others.push(stand);
    }
    let mut found = state.conclude(best, first, tried, needed)?;
    state.sets_as_good(&mut found, &others);
    Some(found)
}

/// As it was found, but with another set of causes.
pub fn concluded(state: &State, best: Stand, found: &Found) -> Option<Found> {
    state.conclude(best, found.first.clone(), found.tried.clone(), found.needed)
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
    /// What a set comes down to, cause by cause.
    pub fn conclude(&self, best: Stand, first: Stand, tried: Vec<Round>, needed: f64) -> Option<Found> {
        let best = self.without_needless(best, needed)?;
        let (best, mut unproven) = self.without_unproven(best)?;
        let best = self.without_impossible(best, &mut unproven)?;
        Some(self.found(best, first, (tried, unproven), needed))
    }

    /// The set without causes that had to be what they cannot be once others were gone; those are told as `unproven`.
    fn without_impossible(&self, mut best: Stand, unproven: &mut Vec<usize>) -> Option<Stand> {
        while let Some(place) = self.first_beyond(&best.parts, &best.estimate.beta) {
            let mut parts = best.parts.clone();
            unproven.push(parts.remove(place).trial.cause);
            best = self.settle(&parts, &best.noises)?;
        }
        Some(best)
    }

    /// The set without causes that bring less beside the others than chance would.
    pub fn without_needless(&self, mut best: Stand, needed: f64) -> Option<Stand> {
        loop {
            let lesser = (0..best.parts.len()).filter_map(|place| {
                let mut parts = best.parts.clone();
                parts.remove(place);
                self.settle(&parts, &best.noises)
            });
            let Some(top) = lesser.max_by(|one, other| one.score.total_cmp(&other.score)) else {
                return Some(best);
            };
            if best.score - top.score >= needed {
                return Some(best);
            }
            best = top;
        }
    }

    /// Other sets that are as good: what they hold otherwise stands beside the cause that it is most like.
    pub fn sets_as_good(&self, found: &mut Found, others: &[Stand]) {
        let best = worth(&found.stand);
        let Some(reduced) = self.reduced(&found.stand.noises, &[]) else { return };
        let nuisance: Vec<usize> = (0..self.pool.nuisance).collect();
        for other in others.iter().filter(|other| worth(other) > best - TOLERANCE) {
            for part in &other.parts {
                let id = self.id(&part.trial);
                let named = |one: &Accepted| {
                    let rival = |rival: &Rival| self.case.causes[rival.cause].id == id;
                    self.id(&one.trial) == id || one.rivals.iter().any(rival)
                };
                // Only where the other set does without some of ours is it an alternative, and only what it has more.
                let replaced: Vec<usize> = (0..found.accepted.len())
                    .filter(|place| {
                        let own = self.id(&found.accepted[*place].trial);
                        !other.parts.iter().any(|part| self.id(&part.trial) == own)
                    })
                    .collect();
                if found.accepted.iter().any(named) || replaced.is_empty() {
                    continue;
                }
                let like = |place: &usize| {
                    let columns = &found.accepted[*place].trial.columns;
                    reduced.squared_correlation(columns, &part.trial.columns, &nuisance, &self.sd())
                };
                let likest = replaced.into_iter().map(|place| (place, like(&place)));
                // What is like none of them explains something else, and a formula that is one of them says it in other words.
                let law = self.cause(&part.trial).law.is_some();
                let other_words = |correlation: f64| law && correlation > OTHER_WORDS;
                let likest =
                    likest.filter(|(_, correlation)| *correlation > UNLIKE && !other_words(*correlation));
                if let Some((place, correlation)) = likest.max_by(|one, other| one.1.total_cmp(&other.1)) {
                    let gain = found.accepted[place].gain + worth(other) - best;
                    let cause = part.trial.cause;
                    found.accepted[place].rivals.push(Rival {
                        cause,
                        gain,
                        squared_correlation: correlation,
                    });
                }
            }
        }
    }

    /// The set without causes that do not help to predict a run from the others, and what those are. A function of time
    /// belongs to its own run, one of position to its path, and no other can show it.
    pub fn without_unproven(&self, mut best: Stand) -> Option<(Stand, Vec<usize>)> {
        /// Growth of ln p of the runs predicted.
        const LEAST: f64 = 1.0;
        let mut out = Vec::new();
        loop {
            let Some(gains) = self.predicted(&best) else { return Some((best, out)) };
            let timed = |place: &usize| match self.cause(&best.parts[*place].trial) {
                Cause { run: Some(_), .. } | Cause { form: Form::OverTime, .. } => true,
                Cause { form: Form::OverPosition, .. } => !self.paths_shared(),
                _ => false,
            };
            let worst = (0..gains.len())
                .filter(|place| !timed(place))
                .min_by(|one, other| gains[*one].total_cmp(&gains[*other]));
            let Some(worst) = worst.filter(|place| gains[*place] < LEAST) else { return Some((best, out)) };
            let mut parts = best.parts.clone();
            out.push(parts.remove(worst).trial.cause);
            best = self.settle(&parts, &best.noises)?;
        }
    }

    /// What was found, each cause with what it brings beside the others and what could stand in its place.
    pub fn found(
        &self,
        best: Stand,
        first: Stand,
        (tried, unproven): (Vec<Round>, Vec<usize>),
        needed: f64,
    ) -> Found {
        let mut parts: Vec<(f64, Part, Vec<Rival>)> = Vec::new();
        for place in 0..best.parts.len() {
            let part = best.parts[place].clone();
            let mut others = best.parts.clone();
            others.remove(place);
            let (gain, rivals) = match self.settle(&others, &best.noises) {
                Some(lesser) => (best.score - lesser.score, self.rivals(&best, &part, &lesser)),
                None => (needed, Vec::new()),
            };
            parts.push((gain, part, rivals));
        }
        parts.sort_by(|one, other| other.0.total_cmp(&one.0));
        let mut accepted = Vec::new();
        let mut effects = Vec::new();
        let along = self.functions_along(&best);
        for (gain, part, rivals) in parts {
            let rows = best.effect(self, &part);
            let place = best.parts.iter().position(|own| own.trial.columns == part.trial.columns);
            // The value that it has everywhere belongs to the function.
            let even =
                best.position(part.trial.columns[0]).map_or(0.0, |position| best.estimate.beta[position]);
            let of = |functions: &[Option<Function>]| {
                place.and_then(|place| functions.get(place)?.clone()).map(|function| function.raised(even))
            };
            let function = of(&best.functions);
            let mut one = Accepted {
                balance: self.balance_of(&rows, &best.noises),
                trial: part.trial,
                gain,
                by_chance: needed,
                rivals,
                function,
                along: of(&along),
            };
            self.name_by_shape(&mut one);
            accepted.push(one);
            effects.push(rows);
        }
        Found {
            tried,
            unproven,
            accepted,
            noises: (first.noises.clone(), best.noises.clone()),
            used: best.used.clone(),
            estimate: best.estimate.clone(),
            left: best.left.clone(),
            before: first.left.clone(),
            effects,
            stand: best,
            first,
            needed,
        }
    }

    /// The balance in which rows stand out most from its noise.
    fn balance_of(&self, rows: &Column, noises: &Noises) -> usize {
        let squares = self.system.mean_squares(rows, self.fit);
        let strengths = squares.iter().zip(&noises.each).map(|(square, noise)| square / noise.sd().powi(2));
        let best = strengths.enumerate().max_by(|one, other| one.1.total_cmp(&other.1));
        best.map_or(0, |(number, _)| number)
    }

    /// Causes that explain as much in the place of one.
    fn rivals(&self, best: &Stand, part: &Part, lesser: &Stand) -> Vec<Rival> {
        let id = self.id(&part.trial);
        let Some(reduced) = self.reduced(&best.noises, &lesser.parts) else { return Vec::new() };
        let at_best = Stand { noises: best.noises.clone(), ..lesser.clone() };
        let mut rivals: Vec<Rival> = Vec::new();
        for other in self.contest(&at_best, &reduced, &[]) {
            let Some(own) = other.stand.parts.last() else { continue };
            let listed = rivals.iter().any(|rival| self.case.causes[rival.cause].id == self.id(&own.trial));
            if self.id(&own.trial) == id || listed || other.stand.score <= best.score - TOLERANCE {
                continue;
            }
            let correlation = reduced.squared_correlation(
                &part.trial.columns,
                &own.trial.columns,
                &lesser.used,
                &self.sd(),
            );
            rivals.push(Rival {
                cause: own.trial.cause,
                gain: other.stand.score - lesser.score,
                squared_correlation: correlation,
            });
        }
        rivals
    }

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
            let smaller = sizes[one].iter().sum::<f64>().min(sizes[other].iter().sum());
            in_noise(&sum).iter().sum::<f64>() < CANCELLED * smaller
        };
        let pairs = (0..effects.len()).flat_map(|one| (0..one).map(move |other| (one, other)));
        sizes.iter().all(heard)
            && !pairs.into_iter().any(|(one, other)| cancels(one, other))
            && stand.parts.iter().all(|part| self.beyond_the_sensor(stand, part))
    }

    /// Whether a sensor's fault is one that anybody would mind.
    fn beyond_the_sensor(&self, stand: &Stand, part: &Part) -> bool {
        let position = part.trial.columns.first().and_then(|column| stand.position(*column));
        let value = position.map_or(0.0, |position| stand.estimate.beta[position]);
        !petty(self.case, self.id(&part.trial), value)
    }

    /// A function over position that these recordings give to slopes and to soft ground alike: where it rises in places
    /// above a floor it is told as ground, where it goes both ways as slopes. The other stays named beside it.
    fn name_by_shape(&self, one: &mut Accepted) {
        /// So many times higher than deep is 'in places'.
        const LOPSIDED: f64 = 2.0;
        let causes: &[Cause] = &self.case.causes;
        let id = causes[one.trial.cause].id;
        let twin = match id {
            "grade" => "soft_ground",
            "soft_ground" => "grade",
            _ => return,
        };
        let Some(place) = one.rivals.iter().position(|rival| causes[rival.cause].id == twin) else { return };
        let Some(function) = &one.function else { return };
        let values: Vec<f64> =
            function.values.iter().flat_map(|(values, _)| values.iter().copied()).collect();
        let values = sorted(&values);
        let [low, middle, high] = [0.02, 0.5, 0.98].map(|share| quantile_of_sorted(&values, share));
        let ground = high - middle > LOPSIDED * (middle - low);
        if ground == (id == "soft_ground") {
            return;
        }
        let rival = one.rivals[place].cause;
        if let Some(trial) = self.pool.trials.iter().find(|trial| trial.cause == rival) {
            one.rivals[place].cause = one.trial.cause;
            one.trial = Trial { columns: one.trial.columns.clone(), ..trial.clone() };
        }
    }
}

/// Of two that explain as much, a cause in the world is named before a fault of a sensor.
pub fn rank(stand: &Stand, state: &State) -> f64 {
    /// A difference of ln p that is none.
    const NEARLY: f64 = 1.0;
    let artefact = stand.parts.last().is_some_and(|part| state.cause(&part.trial).class == Class::Artefact);
    stand.score - if artefact { NEARLY } else { 0.0 }
}
