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

/// A set of causes, and how good it is at a noise.
type Scored = (f64, Vec<Part>);

impl State<'_> {
    /// Sets of at least two causes more than `start` has, each with the noise that it leaves; none where there are many rows,
    /// which take long and tell causes one by one.
    pub fn together(&self, start: &Stand, banned: &[&str]) -> Vec<Stand> {
        if self.system.row_count() > MANY_ROWS {
            return Vec::new();
        }
        let noises = self.quiet(start);
        let pairs = noises.each.iter().zip(&start.noises.each).zip(&self.system.usual);
        let hides = |((quiet, loud), usual): ((&Noise, &Noise), &Option<f64>)| {
            let lasting = usual.is_some_and(|usual| loud.lasting() > UNUSUAL * usual);
            lasting || quiet.sd().powi(2) < LESS * loud.sd().powi(2)
        };
        if !pairs.into_iter().any(hides) {
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
            let mut grown: Vec<Scored> = Vec::new();
            for parts in &open {
                let Some(reduced) = self.reduced(noises, parts) else { continue };
                let mut own = self.one_more(parts, &reduced, banned);
                own.sort_by(|one, other| other.0.total_cmp(&one.0));
                dedup(&mut own, |part| self.id(&part.trial));
                own.truncate(beam);
                grown.extend(own.into_iter().map(|one| self.reshaped(one, &reduced)));
            }
            grown.sort_by(|one, other| other.0.total_cmp(&one.0));
            dedup(&mut grown, |part| self.id(&part.trial));
            grown.truncate(beam);
            open = grown.into_iter().map(|(_, parts)| parts).collect();
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

    /// Sets with one cause more that is no function, in each of its shapes, at the noise of `reduced`.
    fn one_more(&self, parts: &[Part], reduced: &Reduced, banned: &[&str]) -> Vec<Scored> {
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
    fn reshaped(&self, (score, parts): Scored, reduced: &Reduced) -> Scored {
        /// Shapes that depend on each other are found in turns.
        const TURNS: usize = 3;
        let mut best = (score, parts);
        for _ in 0..TURNS {
            let before = best.0;
            for place in 0..best.1.len() {
                let own = best.1[place].clone();
                if own.spread.is_some() {
                    continue;
                }
                let alike = self.pool.trials.iter().filter(|trial| {
                    trial.cause == own.trial.cause
                        && trial.terms == own.trial.terms
                        && trial.shape != own.trial.shape
                });
                let with = |trial: &Trial| {
                    let mut parts = best.1.clone();
                    parts[place].trial = trial.clone();
                    self.scored(parts, reduced)
                };
                let top = alike.filter_map(with).max_by(|one, other| one.0.total_cmp(&other.0));
                if let Some(top) = top.filter(|top| top.0 > best.0) {
                    best = top;
                }
            }
            if best.0 <= before {
                break;
            }
        }
        best
    }

    /// A set, and how good it is at the noise of `reduced`.
    fn scored(&self, parts: Vec<Part>, reduced: &Reduced) -> Option<Scored> {
        let columns = self.columns(&parts);
        let estimate = reduced.estimate(&columns, &self.sd())?;
        let score = estimate.log_evidence + self.heavy(&columns, &estimate.beta) - self.choices(&parts);
        Some((score, parts))
    }
}

/// Of sets of the same causes only the first stays.
fn dedup<'a>(sets: &mut Vec<Scored>, id: impl Fn(&Part) -> &'a str) {
    let mut known: Vec<Vec<&str>> = Vec::new();
    sets.retain(|(_, parts)| {
        let mut ids: Vec<&str> = parts.iter().map(&id).collect();
        ids.sort_unstable();
        let new = !known.contains(&ids);
        known.push(ids);
        new
    });
}
