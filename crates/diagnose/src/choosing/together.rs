//! Causes that say nothing one by one: what each of them leaves of the others passes for noise. They are grown together at
//! the noise that neighbouring rows show, and judged with the noise that they leave.

use crate::balances::gram::Reduced;
use crate::balances::noise::{Noise, Noises};
use crate::causes::catalogue::{Cause, Form};
use crate::causes::profile::COARSE;
use crate::causes::trial::Trial;
use crate::choosing::search::MOST_CAUSES;
use crate::choosing::state::{Part, Stand, State};
use crate::look::MANY_ROWS;
use rayon::prelude::*;

/// So many sets are grown side by side.
const BEAM: usize = 6;
/// And so many beside a function of the path.
const BEAM_OF_PLACES: usize = 3;
/// Noise that neighbouring rows show is less than all that is left where its variance is below this share of it.
const LESS: f64 = 0.7;

/// And where what lasts of it is so many times what is usual.
const UNUSUAL: f64 = 100.0;

/// A set of causes.
struct Grown {
    parts: Vec<Part>,
    /// How good it is at a noise.
    score: f64,
    /// Whether each of them is what it can be.
    possible: bool,
}

impl State<'_> {
    /// Sets of at least two causes more than `start` has, each with the noise that it leaves, where noise may hide some or levels of each
    /// run were found, which crowd out every cause that is a part of them; none where there are many rows, which take long and tell
    /// causes one by one.
    pub fn together(&self, start: &Stand, banned: &[&str], by_run: bool) -> Vec<Stand> {
        if self.system.row_count() > MANY_ROWS {
            return Vec::new();
        }
        let noises = self.quiet(start);
        let pairs = noises.each.iter().zip(&start.noises.each).zip(&self.system.usual);
        let hides = |((quiet, loud), usual): ((&Noise, &Noise), &Option<f64>)| {
            let lasting = usual.is_some_and(|usual| loud.lasting() > UNUSUAL * usual);
            lasting || quiet.sd().powi(2) < LESS * loud.sd().powi(2)
        };
        if !by_run && !pairs.into_iter().any(hides) {
            return Vec::new();
        }
        let mut all = self.grown_from(start.parts.clone(), &noises, banned, BEAM);
        for part in self.places(start, &noises, banned) {
            let parts = start.parts.iter().cloned().chain([part]).collect();
            all.extend(self.grown_from(parts, &noises, banned, BEAM_OF_PLACES));
        }
        let settled = |parts: Vec<Part>| {
            let stand = self.settle(&parts, &noises)?;
            (!self.impossible(&stand.parts, &stand.estimate) && self.sensible(&stand)).then_some(stand)
        };
        all.into_par_iter().filter_map(settled).collect()
    }

    /// Sets of at least two causes more than one has that is no function itself, or at least one more beside a function.
    fn grown_from(&self, start: Vec<Part>, noises: &Noises, banned: &[&str], beam: usize) -> Vec<Vec<Part>> {
        let few = start.len() + usize::from(start.iter().all(|part| part.spread.is_none()));
        let mut open: Vec<Vec<Part>> = vec![start];
        let mut all: Vec<Vec<Part>> = Vec::new();
        while open.first().is_some_and(|parts| parts.len() < MOST_CAUSES) {
            let mut grown: Vec<Grown> = Vec::new();
            for parts in &open {
                let Some(reduced) = self.reduced(noises, parts) else { continue };
                let own = self.foremost(self.one_more(parts, &reduced, banned), beam);
                grown.extend(own.into_iter().map(|one| self.reshaped(one, &reduced)));
            }
            open = self.foremost(grown, beam).into_iter().map(|one| one.parts).collect();
            if open.first().is_some_and(|parts| parts.len() > few) {
                all.extend(open.iter().cloned());
            }
        }
        all
    }

    /// Functions of the path that runs share: what another cause does to them at each place is as much as noise.
    fn places(&self, start: &Stand, noises: &Noises, banned: &[&str]) -> Vec<Part> {
        let free = start.parts.len() + 1 < MOST_CAUSES && self.paths_shared();
        let trials = self.pool.trials.iter().filter(|trial| {
            let cause = self.cause(trial);
            free && cause.form == Form::OverPosition
                && !cause.is_banned(banned)
                && !start.parts.iter().any(|part| self.id(&part.trial) == cause.id)
                && self.apart(trial, &start.parts)
        });
        let part = |trial: &Trial| {
            let part = Part { trial: trial.clone(), spread: None };
            let spread = self.best_spread(&part, start, noises, COARSE)?;
            Some(Part { spread: Some(spread), ..part })
        };
        trials.filter_map(part).collect()
    }

    /// The best sets, one of the same causes, and half as many again of those that are not possible: two that all but cancel each other are
    /// likelier than most, and leave no room; and what cannot be by itself may be beside another.
    fn foremost(&self, mut sets: Vec<Grown>, beam: usize) -> Vec<Grown> {
        sets.sort_by(|one, other| other.score.total_cmp(&one.score));
        let mut known: Vec<Vec<&str>> = Vec::new();
        sets.retain(|set| {
            let mut ids: Vec<&str> = set.parts.iter().map(|part| self.id(&part.trial)).collect();
            ids.sort_unstable();
            let new = !known.contains(&ids);
            known.push(ids);
            new
        });
        let (mut room, mut others) = (beam, beam / 2);
        sets.retain(|set| {
            let left = if set.possible { &mut room } else { &mut others };
            let stays = *left > 0;
            *left = left.saturating_sub(1);
            stays
        });
        sets
    }

    /// Sets with one cause more that is no function, in each of its shapes, at the noise of `reduced`.
    fn one_more(&self, parts: &[Part], reduced: &Reduced, banned: &[&str]) -> Vec<Grown> {
        let taken = |cause: &Cause| {
            cause.is_banned(banned) || parts.iter().any(|part| self.id(&part.trial) == cause.id)
        };
        let open = self.pool.trials.iter().filter(|trial| {
            let cause = self.cause(trial);
            !cause.is_function() && !taken(cause)
        });
        let with = |trial: &Trial| {
            let part = Part { trial: trial.clone(), spread: None };
            self.scored(parts.iter().cloned().chain([part]).collect(), reduced)
        };
        open.filter_map(with).collect()
    }

    /// A set with each of its causes in the shape that suits best beside the others: what was taken first took the shape that stands for
    /// what came later as well.
    fn reshaped(&self, set: Grown, reduced: &Reduced) -> Grown {
        /// Shapes that depend on each other are found in turns.
        const TURNS: usize = 3;
        let mut best = set;
        for _ in 0..TURNS {
            let before = best.score;
            for place in 0..best.parts.len() {
                let own = best.parts[place].clone();
                if own.spread.is_some() {
                    continue;
                }
                let alike = self.pool.trials.iter().filter(|trial| {
                    let other = &own.trial;
                    trial.cause == other.cause && trial.terms == other.terms && trial.shape != other.shape
                });
                let with = |trial: &Trial| {
                    let mut parts = best.parts.clone();
                    parts[place].trial = trial.clone();
                    self.scored(parts, reduced)
                };
                let better = |one: &Grown| one.score > best.score && one.possible >= best.possible;
                let able = alike.filter_map(with).filter(better);
                if let Some(top) = able.max_by(|one, other| one.score.total_cmp(&other.score)) {
                    best = top;
                }
            }
            if best.score <= before {
                break;
            }
        }
        best
    }

    /// A set, and how good it is at the noise of `reduced`.
    fn scored(&self, parts: Vec<Part>, reduced: &Reduced) -> Option<Grown> {
        let columns = self.columns(&parts);
        let estimate = reduced.estimate(&columns, &self.sd())?;
        let score = estimate.log_evidence + self.heavy(&columns, &estimate.beta) - self.choices(&parts);
        let possible = !self.impossible(&parts, &estimate);
        Some(Grown { parts, score, possible })
    }
}
