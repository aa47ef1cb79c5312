//! One cause more: the trials beside a set of causes, the best first.

use crate::catalogue::Form;
use crate::gram::{Column, Reduced, Whitened};
use crate::profile::Spread;
use crate::search::rank;
use crate::state::{Part, Stand, State};
use rayon::prelude::*;

/// A set with one cause more.
pub struct Contest {
    /// The set, the new cause last.
    pub stand: Stand,
}

/// Trials whose noise is estimated anew.
const FINALISTS: usize = 8;
/// Trials within this of the best one are judged, though they be many.
const CLOSE: f64 = 10.0;

impl State<'_> {
    /// The sets with one cause more, but for those of `banned`, the best first.
    pub fn contest(&self, stand: &Stand, reduced: &Reduced, banned: &[&str]) -> Vec<Contest> {
        let taken: Vec<&str> = stand
            .parts
            .iter()
            .flat_map(|part| {
                let cause = self.cause(&part.trial);
                std::iter::once(cause.id).chain(part.spread.and(cause.even()).map(|(even, _)| even))
            })
            .chain(banned.iter().copied())
            .collect();
        let sd = self.sd();
        let mut open: Vec<(f64, Part)> = Vec::new();
        for trial in &self.pool.trials {
            let cause = self.cause(trial);
            if taken.contains(&cause.id) || cause.is_function() {
                continue;
            }
            let part = Part { trial: trial.clone(), spread: None };
            let mut with = stand.used.clone();
            with.extend(&trial.columns);
            let Some(estimate) = reduced.estimate(&with, &sd) else { continue };
            let mut parts = stand.parts.clone();
            parts.push(part.clone());
            if !self.impossible(&parts, &estimate) {
                let score = estimate.log_evidence + self.heavy(&with, &estimate.beta) - self.choices(&parts);
                open.push((score, part));
            }
        }
        open.sort_by(|one, other| other.0.total_cmp(&one.0));
        // Of each cause with the same terms only the best shape is judged.
        let mut known: Vec<(usize, Vec<usize>)> = Vec::new();
        open.retain(|(_, part)| {
            let own = (part.trial.cause, part.trial.terms.clone());
            let new = !known.contains(&own);
            if new {
                known.push(own);
            }
            new
        });
        if let Some(best) = open.first().map(|one| one.0) {
            let close = open.iter().filter(|one| one.0 > best - CLOSE).count();
            open.truncate(FINALISTS.max(close.min(2 * FINALISTS)));
        }
        let mut finalists: Vec<Part> = open.into_iter().map(|(_, part)| part).collect();
        finalists.extend(self.functions(stand, &taken));
        // The noise belongs to what is explained: each finalist is judged with its own.
        let settled = |part: Part| {
            let mut parts = stand.parts.clone();
            parts.push(part);
            let settled = self.settle(&parts, &stand.noises)?;
            (!self.impossible(&settled.parts, &settled.estimate)).then_some(Contest { stand: settled })
        };
        let mut judged: Vec<Contest> = finalists.into_par_iter().filter_map(settled).collect();
        judged.sort_by(|one, other| rank(&other.stand, self).total_cmp(&rank(&one.stand, self)));
        judged
    }

    /// The functions, each spread as suits best at the noise of a set.
    fn functions(&self, stand: &Stand, taken: &[&str]) -> Vec<Part> {
        let open = self.pool.trials.par_iter().filter(|trial| {
            let cause = self.cause(trial);
            cause.is_function() && !taken.contains(&cause.id) && self.apart(trial, &stand.parts)
        });
        let part = |trial: &crate::trial::Trial| {
            let part = Part { trial: trial.clone(), spread: None };
            Some(Part { spread: Some(self.best_spread(&part, stand)?), ..part })
        };
        open.filter_map(part).collect()
    }

    /// Length and size that make the recordings most likely: the length at the usual size first, then the size.
    fn best_spread(&self, part: &Part, stand: &Stand) -> Option<Spread> {
        const SIZES: [f64; 4] = [0.1, 0.3, 3.0, 10.0];
        let cause = self.cause(&part.trial);
        let mut parts = stand.parts.clone();
        parts.push(part.clone());
        let used = self.columns(&parts);
        let columns: Vec<&Column> = used.iter().map(|column| &self.pool.columns[*column]).collect();
        let all_sd = self.sd();
        let sd: Vec<f64> = used.iter().map(|column| all_sd[*column]).collect();
        let places: Vec<usize> = (0..used.len()).collect();
        let chunks = &self.system.chunks;
        let whitened = Whitened::new(chunks, &self.system.residual, &columns, &stand.noises)?;
        let profile = self.profile(&part.trial);
        let without = self.without_functions(&whitened, &self.profiles(&stand.parts), self.fit)?;
        let evidence = |spread: &Spread| {
            let mut reduced = without.clone();
            profile.take(&whitened, chunks, self.fit, spread, &mut reduced)?;
            Some(reduced.estimate(&places, &sd)?.log_evidence)
        };
        let lengths: &[f64] = match cause.form {
            Form::OverPosition => &[5.0, 15.0, 50.0, 150.0, 450.0],
            _ => &[5.0, 20.0, 80.0, 320.0],
        };
        let usual = cause.terms[0].scale;
        let best_of = |spreads: Vec<Spread>| {
            let judged = spreads.into_iter().filter_map(|spread| Some((evidence(&spread)?, spread)));
            judged.max_by(|one, other| one.0.total_cmp(&other.0))
        };
        let longest = profile.longest();
        let possible = lengths.iter().copied().filter(|length| *length < longest);
        let (gain, spread) = best_of(possible.map(|length| Spread { length, size: usual }).collect())?;
        let sizes = SIZES.iter().map(|share| Spread { size: share * usual, ..spread }).collect();
        let (other_gain, other) = best_of(sizes)?;
        Some(if other_gain > gain { other } else { spread })
    }
}
