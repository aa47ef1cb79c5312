//! What is found once rows may stray: a function follows rows one by one, and what is strange about some of them would pass
//! for a part of it; and what they bend hides other causes.
//!
//! This comes last, where the causes that every row asks for are known: a spell of something that is really there is strange
//! as well, and would be passed over.

use crate::balances::noise::Noises;
use crate::causes::catalogue::Form;
use crate::causes::profile::{FINE, FINE_IN_TIME, Function};
use crate::causes::trial::Pool;
use crate::choosing::contest::Contest;
use crate::choosing::search::{Found, LEAST_GAIN, MOST_CAUSES, PER_CAUSE};
use crate::choosing::state::{Part, Stand, State};
use crate::outliers::tails::Tails;
use crate::{Case, System};

/// What was found, looked at again where rows stray; `finer` are the free parameters alone and the causes on rows that are
/// others than those of the search.
pub fn straying(
    case: &Case,
    system: &System,
    pool: &Pool,
    found: Found,
    finer: Option<(Stand, Stand)>,
) -> Found {
    let state = State { case, system, pool, fit: &case.fit };
    let other = finer.is_some();
    let (first, best) = finer.unwrap_or_else(|| (found.first.clone(), found.stand.clone()));
    let again = || -> Option<Found> {
        let stand = state.further(state.straying(&best)?)?;
        let mut unproven = found.unproven.clone();
        let stand = state.needed(stand, &mut unproven, found.needed)?;
        Some(state.found(stand, first.clone(), (found.tried.clone(), unproven), found.needed))
    };
    let as_it_was = || {
        let told = (found.tried.clone(), found.unproven.clone());
        other.then(|| state.found(best.clone(), first.clone(), told, found.needed))
    };
    again().or_else(as_it_was).unwrap_or(found)
}

impl State<'_> {
    /// What shows besides once rows may stray: causes that the strange rows hid.
    fn further(&self, mut best: Stand) -> Option<Stand> {
        while best.parts.len() < MOST_CAUSES {
            let reduced = self.reduced(&best.noises, &best.parts)?;
            let needed = PER_CAUSE + LEAST_GAIN.max(self.chance(&best, &reduced));
            let able = |one: &Contest| one.stand.score - best.score >= needed && self.sensible(&one.stand);
            let judged = self.spread_anew(&best, self.contest(&best, &reduced, &[]));
            let Some(next) = judged.into_iter().find(able) else { break };
            best = next.stand;
        }
        Some(best)
    }

    /// A set with functions, whose rows may stray; none where they do not.
    fn straying(&self, best: &Stand) -> Option<Stand> {
        /// Each function as it suits best beside what strays, round after round.
        const ROUNDS: usize = 3;
        if best.parts.iter().all(|part| part.spread.is_none()) {
            return None;
        }
        let with_tails = |stand: &Stand| {
            let noises = Noises { tails: None, ..stand.noises.clone() };
            let tails = Tails::of(&self.system.chunks, &noises, &stand.left);
            Noises { tails, ..noises }
        };
        let astray = self.settle(&best.parts, &with_tails(best))?;
        // Where no rows stray, functions may still be finer than they were looked for.
        let tailed = astray.score >= best.score + LEAST_GAIN;
        let mut current = if tailed { astray } else { best.clone() };
        let strays = |stand: &Stand| if tailed { with_tails(stand) } else { stand.noises.clone() };
        // What lasts is no noise where a function can follow it.
        current.noises.brief = (0..self.system.kinds.len())
            .map(|balance| {
                let functions = current.parts.iter().filter(|part| part.spread.is_some());
                functions.into_iter().any(|part| self.touches(&part.trial, balance))
            })
            .collect();
        // What a function leaves out passes for noise, and would let no function follow: it is asked from both sides.
        let loud = |stand: &Stand| self.system.noises_like(&stand.left, self.fit, Some(&strays(stand)));
        let quiet = |stand: &Stand| self.quiet(&Stand { noises: strays(stand), ..stand.clone() });
        let starts: [&dyn Fn(&Stand) -> Noises; 2] = [&loud, &quiet];
        let of = |start: &&dyn Fn(&Stand) -> Noises| {
            let mut noises = start(&current);
            let mut last: Option<Stand> = None;
            for _ in 0..ROUNDS {
                let settled = self.respread(last.as_ref().unwrap_or(&current), &noises)?;
                noises = strays(&settled);
                last = Some(settled);
            }
            last
        };
        let all: Vec<Stand> = starts.iter().filter_map(of).collect();
        let finest = all.into_iter().max_by(|one, other| one.score.total_cmp(&other.score)).or(Some(current));
        let finest = finest.map(|stand| self.spread_finer(&stand).unwrap_or(stand));
        finest.filter(|stand| tailed || stand.score >= best.score + LEAST_GAIN)
    }

    /// A set whose functions are spread anew, as suits them best at a noise.
    fn respread(&self, stand: &Stand, noises: &Noises) -> Option<Stand> {
        let mut parts = stand.parts.clone();
        for place in 0..parts.len() {
            let mut others = parts.clone();
            let part = Part { spread: None, ..others.remove(place) };
            if parts[place].spread.as_ref().is_some_and(|spread| spread.jumps.is_none()) {
                let beside = Stand { parts: others, ..stand.clone() };
                let in_time = self.cause(&part.trial).form == Form::OverTime;
                let fine = if in_time { FINE_IN_TIME } else { FINE };
                let shared = parts[place].spread.as_ref().is_some_and(|spread| spread.shared);
                let spread = if shared {
                    self.best_spread_of(&part, &beside, noises, (fine, &[true]))
                } else {
                    self.best_spread(&part, &beside, noises, fine)
                };
                parts[place].spread = spread.or(parts[place].spread.clone());
            }
        }
        self.settle(&parts, noises)
    }

    /// The functions of a set from all runs, with everything else as the fitted ones have it.
    pub fn functions_along(&self, stand: &Stand) -> Vec<Option<Function>> {
        /// Rows of runs that were not fitted stray beside what their own functions leave: found round after round.
        const ROUNDS: usize = 4;
        let (chunks, profiles) = (&self.system.chunks, self.profiles(&stand.parts));
        let all = vec![true; self.fit.len()];
        let mut noises = Noises::normal(stand.noises.each.clone());
        let mut functions = self.drawn(stand, &noises, &all);
        if stand.noises.tails.is_some() {
            let bare = self.left(&stand.used, &stand.estimate.beta);
            for _ in 0..ROUNDS {
                let mut left = bare.clone();
                for (one, made) in profiles.iter().zip(&functions) {
                    let (Some((profile, _)), Some(made)) = (one, made) else { continue };
                    for (left, rows) in left.iter_mut().zip(profile.rows(self.system, made)) {
                        *left -= rows;
                    }
                }
                noises.tails = Tails::of(chunks, &noises, &left);
                functions = self.drawn(stand, &noises, &all);
            }
        }
        functions
    }
}
