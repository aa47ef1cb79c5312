//! How a function is spread over its path or its time: the length and the size that make the recordings most likely.
//!
//! Both are looked for on a coarse grid first. What a function of the path takes up of a whole path goes with them: of a path of
//! length D it is σ √(2 L / D) as a standard deviation, and rows hardly tell a function that is large and long from one that is
//! smaller and shorter, since both wander alike from knot to knot, by σ √(2 Δ / L). So length and size are found more finely
//! where one is accepted, and anew beside each cause that it may have taken up.
//! Source: Rasmussen and Williams, *Gaussian Processes for Machine Learning* (2006), section 5.4.1, the evidence over
//! hyperparameters.

use crate::balances::balance::Kind;
use crate::balances::gram::{Reduced, Whitened};
use crate::balances::noise::Noises;
use crate::causes::catalogue::{Cause, Form};
use crate::causes::cycles::Cycles;
use crate::causes::profile::{Profile, Spread};
use crate::choosing::state::{Chosen, Part, Stand, State};
use rayon::prelude::*;

/// A function that is correlated for so long stays the same throughout a run [s].
const BY_RUN_S: f64 = 1e7;

/// Sizes that are tried, as shares of the usual one, beside that itself. What is smaller than the least is nothing that anybody would
/// name, but what a sensor or the blocks of the rows leave.
const SIZES: [f64; 4] = [0.1, 0.3, 3.0, 10.0];

/// A function beside the other causes of a set, ready to be asked how likely it makes the recordings.
struct Spreading<'s, 'a> {
    state: &'s State<'a>,
    whitened: Whitened,
    profile: Profile<'a>,
    /// The function that all runs share, where it is asked for.
    shared: Option<Profile<'a>>,
    others: &'s [Part],
    /// Products without the other functions, where those share no rows with it.
    without: Option<Reduced>,
    places: Vec<usize>,
    sd: Vec<f64>,
}

impl<'s, 'a> Spreading<'s, 'a> {
    fn of(
        state: &'s State<'a>,
        part: &Part,
        (others, alike): (&'s [Part], &[bool]),
        noises: &Noises,
    ) -> Option<Self> {
        let mut parts = others.to_vec();
        parts.push(part.clone());
        let Chosen { columns, sd, places, .. } = state.chosen(&parts);
        let whitened = Whitened::new(&state.system.chunks, &state.system.residual, &columns, noises)?;
        // What shares no rows with it is eliminated once.
        let apart = state.apart(&part.trial, others);
        let without = if apart {
            Some(state.without_functions(&whitened, &state.profiles(others), state.fit)?)
        } else {
            None
        };
        let shared = alike.contains(&true).then(|| state.profile(&part.trial, true));
        let profile = state.profile(&part.trial, false);
        Some(Self { state, whitened, profile, shared, others, without, places, sd })
    }

    /// ln p of the recordings with the function spread like this, but for what does not go with the spread.
    fn evidence(&self, part: &Part, spread: &Spread) -> Option<f64> {
        let (state, chunks) = (self.state, &self.state.system.chunks);
        let reduced = if let Some(without) = &self.without {
            let mut reduced = without.clone();
            let profile = if spread.shared { self.shared.as_ref()? } else { &self.profile };
            profile.gathered(&self.whitened, chunks, state.fit, spread).solved(spread)?.take(&mut reduced);
            reduced
        } else {
            let mut profiles = state.profiles(self.others);
            profiles.push(Some((state.profile(&part.trial, spread.shared), spread.clone())));
            state.without_functions(&self.whitened, &profiles, state.fit)?
        };
        Some(reduced.estimate(&self.places, &self.sd)?.log_evidence)
    }
}

/// Lengths that are tried of a cause, of which `longest` is the longest that could be told.
fn lengths(cause: &Cause, longest: f64) -> Vec<f64> {
    /// Loads that a run takes up and gives off, at most.
    const MOST_LOADS: f64 = 30.0;
    let all: &[f64] = match cause.form {
        _ if cause.by_run => &[BY_RUN_S],
        Form::OverPosition => &[5.0, 15.0, 50.0, 150.0, 450.0],
        // A tank fills and empties; what comes and goes faster is a force.
        _ if cause.id == "payload_change" => &[20.0, 80.0, 320.0],
        _ => &[5.0, 20.0, 80.0, 320.0],
    };
    // Nor does it change its mind all the time: a load that comes and goes within a small part of the way is none.
    let least = if cause.id == "payload_change" { longest / MOST_LOADS } else { 0.0 };
    let able = |length: &f64| cause.by_run || (least..longest).contains(length);
    all.iter().copied().filter(able).collect()
}

impl State<'_> {
    /// Length and size that make the recordings most likely, of a course of time that all runs share as well where each drives in
    /// its own way: where all drive alike, it would be told from no law.
    pub fn best_spread(
        &self,
        part: &Part,
        stand: &Stand,
        noises: &Noises,
        knots_per_length: f64,
    ) -> Option<Spread> {
        let cause = self.cause(&part.trial);
        // Powers alone hardly tell a load that comes from a consumer.
        let told = self.system.has(Kind::Motion) || cause.id == "auxiliary_power";
        let able = cause.is_course() && told && self.case.cycles == Cycles::Free;
        let alike: &[bool] = if able { &[false, true] } else { &[false] };
        self.best_spread_of(part, stand, noises, (knots_per_length, alike))
    }

    /// The same of courses that are each run's own or that all share: the length at the usual size first, then the size.
    pub fn best_spread_of(
        &self,
        part: &Part,
        stand: &Stand,
        noises: &Noises,
        (knots_per_length, alike): (f64, &[bool]),
    ) -> Option<Spread> {
        let cause = self.cause(&part.trial);
        let spreading = Spreading::of(self, part, (&stand.parts, alike), noises)?;
        let usual = cause.terms[0].scale;
        let choice = |spread: &Spread| {
            self.choices(&[Part { spread: Some(spread.clone()), trial: part.trial.clone() }])
        };
        let best_of = |spreads: Vec<Spread>| {
            let judged = spreads
                .into_iter()
                .filter_map(|spread| Some((spreading.evidence(part, &spread)? - choice(&spread), spread)));
            judged.max_by(|one, other| one.0.total_cmp(&other.0))
        };
        let of_length = |length: f64| {
            alike.iter().map(move |shared| Spread {
                length,
                size: usual,
                knots_per_length,
                jumps: None,
                shared: *shared,
            })
        };
        let possible = lengths(cause, spreading.profile.longest());
        let (gain, spread) = best_of(possible.into_iter().flat_map(of_length).collect())?;
        let sizes = SIZES.iter().map(|share| Spread { size: share * usual, ..spread.clone() }).collect();
        let (other_gain, other) = best_of(sizes)?;
        Some(if other_gain > gain { other } else { spread })
    }

    /// A set with one course of time for all runs in the place of one that each takes of its own, where that makes the recordings
    /// more likely; none where nothing is better. What the course of each run left to noise, that of all may follow, so each length
    /// and each size is asked at the noise that suits it.
    pub fn shared_instead(&self, stand: &Stand) -> Option<Stand> {
        if self.case.cycles == Cycles::Apart {
            return None;
        }
        let mut best: Option<Stand> = None;
        for place in 0..stand.parts.len() {
            let now = best.as_ref().unwrap_or(stand);
            let part = &now.parts[place];
            let cause = self.cause(&part.trial);
            let own = part.spread.as_ref().filter(|own| own.jumps.is_none() && !own.shared);
            let (true, Some(own)) = (cause.is_course(), own) else { continue };
            let usual = Spread { shared: true, size: cause.terms[0].scale, ..own.clone() };
            let with = |spread: Spread| {
                let mut parts = now.parts.clone();
                parts[place].spread = Some(spread);
                let settled = self.settle(&parts, &now.noises)?;
                let able =
                    !self.impossible(&settled.parts, &settled.estimate) && self.functions_possible(&settled);
                able.then_some(settled)
            };
            let likeliest = |spreads: Vec<Spread>| {
                let settled = spreads.into_par_iter().filter_map(with);
                settled.max_by(|one, other| one.score.total_cmp(&other.score))
            };
            let all = lengths(cause, self.profile(&part.trial, true).longest());
            let long = likeliest(all.into_iter().map(|length| Spread { length, ..usual.clone() }).collect());
            let Some(spread) = long.as_ref().and_then(|long| long.parts[place].spread.clone()) else {
                continue;
            };
            let sized = SIZES.iter().map(|share| Spread { size: share * usual.size, ..spread.clone() });
            let sized = likeliest(sized.collect());
            let shared = [long, sized].into_iter().flatten();
            let shared = shared.max_by(|one, other| one.score.total_cmp(&other.score));
            best = shared.filter(|one| one.score > now.score).or(best);
        }
        best
    }

    /// A set whose functions of the path are spread more finely than a grid has them, as suits them best beside all the others;
    /// none where nothing is better, or where runs share a path. Functions that share their rows with others stay as they are.
    pub fn spread_finer(&self, stand: &Stand) -> Option<Stand> {
        /// A growth of ln p below this is none.
        const LEAST: f64 = 0.5;
        // On a path that runs share each tells the others what is of the path.
        if self.paths_shared() {
            return None;
        }
        let mut parts = stand.parts.clone();
        let mut moved = false;
        for place in 0..parts.len() {
            let cause = self.cause(&parts[place].trial);
            let steady = parts[place].spread.as_ref().filter(|spread| spread.jumps.is_none()).cloned();
            let (Form::OverPosition, Some(spread)) = (cause.form, steady) else { continue };
            let mut others = parts.clone();
            let part = others.remove(place);
            let Some(spreading) = Spreading::of(self, &part, (&others, &[false]), &stand.noises) else {
                continue;
            };
            // Side by side with another function it has no band, and every step takes long.
            if spreading.without.is_none() {
                continue;
            }
            let longest = spreading.profile.longest();
            let shortest = lengths(cause, longest).into_iter().fold(longest, f64::min);
            let [least, .., most] = SIZES.map(|share| share * cause.terms[0].scale);
            let evidence = |length: f64, size: f64| {
                ((shortest..longest).contains(&length) && (least..=most).contains(&size))
                    .then(|| spreading.evidence(&part, &Spread { length, size, ..spread.clone() }))
                    .flatten()
            };
            if let Some((length, size)) = climbed((spread.length, spread.size), LEAST, evidence) {
                parts[place].spread = Some(Spread { length, size, ..spread });
                moved = true;
            }
        }
        if !moved {
            return None;
        }
        let finer = self.settle(&parts, &stand.noises)?;
        (finer.score > stand.score + LEAST && self.functions_possible(&finer)).then_some(finer)
    }
}

/// Length and size from which every way leads down, by ever smaller steps along what rows hardly tell apart and across it; none
/// where that is where it began.
fn climbed(from: (f64, f64), least: f64, evidence: impl Fn(f64, f64) -> Option<f64>) -> Option<(f64, f64)> {
    /// Factors of the length, the greatest first: half of the way between two of the grid, then a quarter.
    const STEPS: [f64; 2] = [1.73, 1.32];
    /// So many steps of one size at most.
    const MOST: usize = 6;
    let mut here = from;
    let mut best = evidence(here.0, here.1)?;
    for step in STEPS {
        let root = step.sqrt();
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..MOST {
            // Along the same wandering from knot to knot, and by the size alone.
            let ways = [(step, root), (1.0 / step, 1.0 / root), (1.0, step), (1.0, 1.0 / step)];
            let back = |way: &(f64, f64)| {
                last.is_some_and(|last| (last.0 * way.0 - 1.0).abs() + (last.1 * way.1 - 1.0).abs() < 1e-9)
            };
            let tried = ways
                .into_iter()
                .filter(|way| !back(way))
                .filter_map(|way| Some((evidence(here.0 * way.0, here.1 * way.1)?, way)));
            let Some((found, way)) = tried.max_by(|one, other| one.0.total_cmp(&other.0)) else { break };
            if found <= best + least {
                break;
            }
            (best, here, last) = (found, (here.0 * way.0, here.1 * way.1), Some(way));
        }
    }
    (here != from).then_some(here)
}

#[cfg(test)]
mod tests {
    use super::climbed;

    /// A ridge along which size²/length is the same falls off slowly, and across it fast.
    #[test]
    fn a_hill_that_is_a_ridge_is_climbed_to_its_top() {
        let (length, size) = (120.0_f64, 0.011_f64);
        let hill = |own_length: f64, own_size: f64| {
            let (along, wide) = ((own_length / length).ln(), (own_size / size).ln());
            Some(-20.0 * along * along - 900.0 * (2.0 * wide - along).powi(2))
        };
        let (found_length, found_size) = climbed((450.0, 0.02), 0.01, hill).unwrap();
        assert!((found_length / length).ln().abs() < 0.2, "{found_length}");
        assert!((found_size / size).ln().abs() < 0.2, "{found_size}");
        assert_eq!(climbed((length, size), 0.01, hill), None);
    }

    #[test]
    fn what_cannot_be_is_no_way_up() {
        let only_shorter = |length: f64, _: f64| (length < 200.0).then_some(length);
        let (length, _) = climbed((100.0, 1.0), 0.01, only_shorter).unwrap();
        assert!(length > 150.0 && length < 200.0, "{length}");
    }
}
