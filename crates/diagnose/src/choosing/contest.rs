//! One cause more: the trials beside a set of causes, the best first.

use crate::balances::gram::Reduced;
use crate::balances::noise::Noises;
use crate::causes::catalogue::{Cause, Form};
use crate::causes::profile::{COARSE, KNOTS_OF_JUMPS, Spread};
use crate::causes::trial::Trial;
use crate::choosing::search::rank;
use crate::choosing::state::{Part, Stand, State};
use crate::look::MANY_ROWS;
use rayon::prelude::*;

/// A set with one cause more.
pub struct Contest {
    /// The set, the new cause last.
    pub stand: Stand,
}

impl Contest {
    /// Whether the new cause is a function that may jump.
    fn jumps(&self) -> bool {
        let spread = self.stand.parts.last().and_then(|part| part.spread.as_ref());
        spread.is_some_and(|spread| spread.jumps.is_some())
    }
}

/// Jumps show a consumer where they say so many times as much as a steady function does.
const JUMPS: f64 = 1.5;
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
                std::iter::once(cause.id).chain(part.spread.as_ref().and(cause.even()).map(|(even, _)| even))
            })
            .collect();
        // A consumer that is on for a while and a pull that power alone tells of would patch each other.
        let on_and_off = |cause: &Cause| cause.is_switched() || cause.window().is_some();
        let set = || stand.parts.iter().map(|part| self.cause(&part.trial));
        let patches = |cause: &Cause| {
            cause.pulls_in_spells() && set().any(on_and_off)
                || on_and_off(cause) && set().any(Cause::pulls_in_spells)
        };
        let out = |cause: &Cause| taken.contains(&cause.id) || cause.is_banned(banned) || patches(cause);
        let sd = self.sd();
        let mut open: Vec<(f64, Part)> = Vec::new();
        for trial in &self.pool.trials {
            let cause = self.cause(trial);
            if out(cause) || cause.is_function() {
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
            // Where rows stray, what could be found without is known, and each trial takes long.
            let most = if stand.noises.tails.is_some() { FINALISTS / 2 } else { 2 * FINALISTS };
            open.truncate(close.clamp(most.min(FINALISTS), most));
        }
        let mut finalists: Vec<(Part, Noises)> =
            open.into_iter().map(|(_, part)| (part, stand.noises.clone())).collect();
        finalists.extend(self.functions(stand, &out));
        // The noise belongs to what is explained: each finalist is judged with its own.
        let settled = |(part, noises): (Part, Noises)| {
            let mut parts = stand.parts.clone();
            parts.push(part);
            let settled = self.settle(&parts, &noises)?;
            let possible = |stand: &Stand| {
                !self.impossible(&stand.parts, &stand.estimate) && self.functions_possible(stand)
            };
            let stepped = self.stepped(&settled);
            let able = [Some(settled), stepped].into_iter().flatten().filter(possible);
            let stand = able.max_by(|one, other| one.score.total_cmp(&other.score))?;
            Some(Contest { stand })
        };
        let mut judged: Vec<Contest> = finalists.into_par_iter().filter_map(settled).collect();
        judged.sort_by(|one, other| rank(&other.stand, self).total_cmp(&rank(&one.stand, self)));
        if let Some(top) = judged.first_mut() {
            self.reshape(top, stand);
        }
        // Jumps are for what no steady function shows: beside one that shows most of it they would only follow the noise closer.
        let best = judged.iter().find(|one| !one.jumps());
        let shown = best.and_then(|one| {
            let cause = self.cause(&one.stand.parts.last()?.trial);
            cause.is_switched().then_some(one.stand.score - stand.score)
        });
        // In long recordings, where the noise of a minute is not that of an hour, there is always something to jump to.
        let most = if self.system.row_count() > MANY_ROWS { f64::INFINITY } else { JUMPS };
        if let Some(shown) = shown {
            judged.retain(|one| !one.jumps() || one.stand.score - stand.score > most * shown.max(1.0));
        }
        judged
    }

    /// The newest cause in its likeliest shape: the one that was judged was likeliest at the noise without it, which hides much.
    fn reshape(&self, one: &mut Contest, without: &Stand) {
        // Beside functions each shape would take long, and they follow what another shape leaves.
        if one.stand.parts.iter().any(|part| part.spread.is_some()) {
            return;
        }
        let Some(newest) = one.stand.parts.last() else { return };
        let with = |trial: &Trial| -> Vec<Part> {
            without.parts.iter().cloned().chain([Part { trial: trial.clone(), spread: None }]).collect()
        };
        let likely = |trial: &Trial| self.likely(&with(trial), &one.stand.noises);
        let alike = self.pool.trials.iter().filter(|trial| {
            let own = &newest.trial;
            trial.cause == own.cause && trial.terms == own.terms && trial.shape != own.shape
        });
        let told = alike.filter_map(|trial| Some((likely(trial)?, trial)));
        let Some((greatest, trial)) = told.max_by(|one, other| one.0.total_cmp(&other.0)) else { return };
        if likely(&newest.trial).is_some_and(|own| own >= greatest) {
            return;
        }
        let settled = self.settle(&with(trial), &one.stand.noises);
        let better = settled
            .filter(|other| other.score > one.stand.score && !self.impossible(&other.parts, &other.estimate));
        if let Some(better) = better {
            one.stand = better;
        }
    }

    /// The functions, each spread as suits best at the noise of a set, and once more at the noise that neighbouring rows
    /// show: what a function leaves out passes for noise, and would let no function follow.
    fn functions(&self, stand: &Stand, out: &dyn Fn(&Cause) -> bool) -> Vec<(Part, Noises)> {
        let many = self.system.row_count() > MANY_ROWS;
        let open = self.pool.trials.iter().filter(|trial| {
            let cause = self.cause(trial);
            cause.is_function()
                && !(cause.by_run && many)
                && !out(cause)
                && self.fits_beside(trial, &stand.parts)
        });
        let quiet = self.quiet(stand);
        let starts: Vec<(&Trial, &Noises)> =
            open.flat_map(|trial| [(trial, &stand.noises), (trial, &quiet)]).collect();
        let part = |(trial, noises): (&Trial, &Noises)| {
            let part = Part { trial: trial.clone(), spread: None };
            let spread = self.best_spread(&part, stand, noises, COARSE)?;
            Some((Part { spread: Some(spread), ..part }, noises.clone()))
        };
        let mut all: Vec<(Part, Noises)> = starts.into_par_iter().filter_map(part).collect();
        all.extend(self.jumping(stand, out, &quiet));
        all
    }

    /// Functions that stay and then jump.
    fn jumping(&self, stand: &Stand, out: &dyn Fn(&Cause) -> bool, quiet: &Noises) -> Vec<(Part, Noises)> {
        let switched = self.pool.trials.iter().filter(|trial| {
            let cause = self.cause(trial);
            cause.is_switched() && !out(cause) && self.apart(trial, &stand.parts)
        });
        let Some(step) = self.shows_switching().map(|number| KNOTS_OF_JUMPS * self.system.blocks_s[number])
        else {
            return Vec::new();
        };
        let part = |trial: &Trial| {
            let spread = Spread::jumping(step, self.cause(trial).terms[0].scale);
            (Part { trial: trial.clone(), spread: Some(spread) }, quiet.clone())
        };
        switched.map(part).collect()
    }

    /// The sets of a contest where functions of the path stand beside the new cause: they may have taken it up, so they are spread
    /// anew beside those causes that bring most, and the best comes first again. The functions of the set before have to be
    /// spread as suits them best already.
    pub fn spread_anew(&self, stand: &Stand, mut judged: Vec<Contest>) -> Vec<Contest> {
        /// So many of them.
        const MOST: usize = 3;
        let of_path = |part: &Part| {
            let steady = part.spread.as_ref().is_some_and(|spread| spread.jumps.is_none());
            steady && self.cause(&part.trial).form == Form::OverPosition
        };
        if !stand.parts.iter().any(of_path) {
            return judged;
        }
        let brings = |one: &Contest| {
            one.stand.score > stand.score && one.stand.parts.last().is_some_and(|part| part.spread.is_none())
        };
        let promising: Vec<usize> =
            (0..judged.len()).filter(|place| brings(&judged[*place])).take(MOST).collect();
        let anew = |place: &usize| Some((*place, self.spread_finer(&judged[*place].stand)?));
        let anew: Vec<(usize, Stand)> = promising.par_iter().filter_map(anew).collect();
        for (place, finer) in anew {
            if !self.impossible(&finer.parts, &finer.estimate) {
                judged[place] = Contest { stand: finer };
            }
        }
        judged.sort_by(|one, other| rank(&other.stand, self).total_cmp(&rank(&one.stand, self)));
        judged
    }

    /// The noise that neighbouring rows show of what a set leaves.
    pub fn quiet(&self, stand: &Stand) -> Noises {
        self.system.quiet(&stand.left, self.fit, &stand.noises)
    }
}
