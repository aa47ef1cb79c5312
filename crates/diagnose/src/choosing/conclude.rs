//! What a set of causes comes down to: each is asked whether it is needed, whether one run teaches it to another, whether it
//! can be what it would have to be, and whether another belongs in its place.

use crate::balances::gram::Column;
use crate::balances::noise::Noises;
use crate::causes::catalogue::Form;
use crate::causes::profile::Function;
use crate::causes::slowed::joined;
use crate::choosing::contest::Contest;
use crate::choosing::rivals::twin;
use crate::choosing::search::{Accepted, Found, MOST_CAUSES, Round};
use crate::choosing::state::{Part, Stand, State};
use crate::look::MANY_ROWS;

/// A cause of a set, and what could stand in its place.
pub struct Side {
    /// The cause.
    pub part: Part,
    /// The set without it, where that can be estimated.
    pub lesser: Option<Stand>,
    /// The set with another cause in its place, the best first, its own among them; and last a function of the path by its
    /// other name.
    pub contests: Vec<Contest>,
}

/// What a set of causes was asked of before: what was tried, and what the runs do not teach each other.
pub type Before = (Vec<Round>, Vec<usize>);

/// So many causes are exchanged one after the other.
const EXCHANGES: usize = 3;

impl State<'_> {
    /// What a set comes down to, cause by cause. What is in the place of another cause is exchanged for it, but for none of
    /// those that the runs do not teach each other.
    pub fn conclude(&self, best: Stand, first: Stand, before: Before, needed: f64) -> Option<Found> {
        let (tried, mut unproven) = before;
        let before = unproven.len();
        let mut best = self.needed(best, &mut unproven, needed)?;
        // Of many rows one cause more takes long to find.
        if unproven.len() > before && self.system.row_count() <= MANY_ROWS {
            best = self.instead(best, &mut unproven, needed)?;
        }
        let mut sides = self.sides(&best);
        for _ in 0..EXCHANGES {
            let Some(other) = self.exchanged(&best, &sides, &unproven) else { break };
            best = self.needed(other, &mut unproven, needed)?;
            sides = self.sides(&best);
        }
        Some(self.told((best, sides), first, (tried, unproven), needed))
    }

    /// The set without the causes that it does without; those that no run teaches another, or that would have to be what they
    /// cannot be, are `unproven`.
    pub fn needed(&self, best: Stand, unproven: &mut Vec<usize>, needed: f64) -> Option<Stand> {
        let best = self.without_needless(best, needed)?;
        let (best, more) = self.without_unproven(best)?;
        unproven.extend(more);
        self.without_impossible(best, unproven)
    }

    /// The set with what holds in the place of causes that are `unproven`: what they imitate may be another cause, of which one
    /// run tells the others.
    fn instead(&self, mut best: Stand, unproven: &mut Vec<usize>, needed: f64) -> Option<Stand> {
        for _ in 0..EXCHANGES {
            if best.parts.len() >= MOST_CAUSES {
                break;
            }
            let banned = self.case.ids(unproven);
            let reduced = self.reduced(&best.noises, &best.parts)?;
            let able = |stand: &Stand| {
                let law = stand.parts.last().is_some_and(|part| self.cause(&part.trial).law.is_some());
                !law && stand.score - best.score >= needed && self.sensible(stand)
            };
            let mut contests = self.contest(&best, &reduced, &banned).into_iter();
            let Some(one) = contests.find(|one| able(&one.stand)) else { break };
            let known = unproven.len();
            let other = self.needed(one.stand, unproven, needed)?;
            let holds = other.parts.len() > best.parts.len();
            if holds {
                best = other;
            } else if unproven.len() == known {
                break;
            }
        }
        Some(best)
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

    /// The set without causes that do not help to predict a run from the others, and what those are. A function of time
    /// belongs to its own run, one of position to its path, and no other can show it.
    pub fn without_unproven(&self, mut best: Stand) -> Option<(Stand, Vec<usize>)> {
        /// Growth of ln p of the runs predicted.
        const LEAST: f64 = 1.0;
        let mut out = Vec::new();
        loop {
            let Some(gains) = self.predicted(&best) else { return Some((best, out)) };
            let timed = |place: &usize| {
                let part = &best.parts[*place];
                let of_place = self.cause(&part.trial).form == Form::OverPosition;
                self.timed(part) || of_place && !self.paths_shared()
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
        let sides = self.sides(&best);
        self.told((best, sides), first, (tried, unproven), needed)
    }

    /// What a set of causes is beside the others and beside those that could stand in the place of each.
    fn sides(&self, best: &Stand) -> Vec<Side> {
        let of = |place: usize| {
            let part = best.parts[place].clone();
            let mut others = best.parts.clone();
            others.remove(place);
            let lesser = self.settle(&others, &best.noises);
            let reduced = self.reduced(&best.noises, &others);
            let contests = lesser.as_ref().zip(reduced).map(|(lesser, reduced)| {
                self.contest(&Stand { noises: best.noises.clone(), ..lesser.clone() }, &reduced, &[])
            });
            let mut contests = contests.unwrap_or_default();
            contests.extend(self.twin(best, place));
            Side { part, lesser, contests }
        };
        (0..best.parts.len()).map(of).collect()
    }

    /// The set with a function of the path by its other name, spread as it is: slopes where it has softer ground, and softer
    /// ground where it has slopes. A search spreads each as suits it best beside the noise that it starts with, and may end
    /// elsewhere.
    fn twin(&self, best: &Stand, place: usize) -> Option<Contest> {
        let part = &best.parts[place];
        let beside = |id: &str| {
            let mut others = best.parts.iter().enumerate().filter(|(other, _)| *other != place);
            others.any(|(_, other)| self.id(&other.trial) == id)
        };
        let twin = twin(self.id(&part.trial)).filter(|id| part.spread.is_some() && !beside(id))?;
        let trial = self.pool.trials.iter().find(|trial| {
            let cause = self.cause(trial);
            cause.is_function() && cause.id == twin
        })?;
        let mut parts = best.parts.clone();
        let other = Part { trial: trial.clone(), ..parts.remove(place) };
        parts.push(other);
        let stand = self.settle(&parts, &best.noises)?;
        let possible = !self.impossible(&stand.parts, &stand.estimate) && self.functions_possible(&stand);
        possible.then_some(Contest { stand })
    }

    /// What was found, as it is told.
    fn told(
        &self,
        (best, mut sides): (Stand, Vec<Side>),
        first: Stand,
        (tried, unproven): (Vec<Round>, Vec<usize>),
        needed: f64,
    ) -> Found {
        let gain = |side: &Side| side.lesser.as_ref().map_or(needed, |lesser| best.score - lesser.score);
        sides.sort_by(|one, other| gain(other).total_cmp(&gain(one)));
        // What the runs do not teach each other stands for nothing that they do, but for one number in the place of another: where they teach
        // a scale of the force, it was by chance that they did not a mass.
        let banned = self.case.ids(&unproven);
        let new = |one: &Contest| one.stand.parts.last().map(|part| self.cause(&part.trial));
        for side in &mut sides {
            let number = !self.cause(&side.part.trial).is_function();
            side.contests.retain(|one| {
                new(one).is_some_and(|cause| !cause.is_banned(&banned) || number && !cause.is_function())
            });
        }
        let mut accepted = Vec::new();
        let mut effects = Vec::new();
        let held = self.held(&best);
        let along = self.functions_along(&held);
        for side in &sides {
            let part = &side.part;
            let rows = held.effect(self, part);
            let place = best.parts.iter().position(|own| own.trial.columns == part.trial.columns);
            // The value that it has everywhere belongs to the function.
            let even = held.value(part.trial.columns[0]);
            let shares: Vec<f64> = part.beside().iter().map(|column| held.value(*column)).collect();
            let of = |functions: &[Option<Function>]| {
                let function = place.and_then(|place| functions.get(place)?.clone());
                function.map(|function| joined(self.case, function.raised(even), &shares))
            };
            let function = place
                .and_then(|place| self.with_levels(&held, place))
                .map_or_else(|| of(&held.functions), |function| Some(function.raised(even)));
            let mut one = Accepted {
                balance: self.balance_of(&rows, &held.noises),
                trial: part.trial.clone(),
                gain: gain(side),
                by_chance: needed,
                rivals: self.rivals(&best, side),
                function,
                along: of(&along),
            };
            self.name_by_shape(&mut one);
            accepted.push(one);
            effects.push(rows);
        }
        self.named_in_neutral(&best, &mut accepted);
        self.named_level(&best, &mut accepted);
        self.named_patch(&best, &mut accepted);
        Found {
            tried,
            unproven,
            accepted,
            noises: (first.noises.clone(), best.noises.clone()),
            used: held.used,
            estimate: held.estimate,
            left: held.left,
            before: first.left.clone(),
            effects,
            stand: best,
            first,
            needed,
            several: None,
        }
    }

    /// The levels of a cause that has one in each run, where it alone is one: those of runs that were not fitted as the first half
    /// of each tells, so that the other half shows whether it holds. None of anything else.
    fn with_levels(&self, held: &Stand, place: usize) -> Option<Function> {
        let levelled = |part: &Part| self.cause(&part.trial).by_run && part.spread.is_some();
        let part = &held.parts[place];
        if !levelled(part) || held.parts.iter().filter(|part| levelled(part)).count() > 1 {
            return None;
        }
        let mut function = held.functions[place].clone()?;
        let signature = &self.pool.columns[part.trial.columns[0]];
        for run in (0..self.fit.len()).filter(|run| !self.fit[*run]) {
            let time_s = self.case.runs[run].measured.trace.time_s();
            let middle_s = 0.5 * (time_s[0] + time_s[time_s.len() - 1]);
            // What is usual of the level is a measurement of nought.
            let (mut products, mut squares) = (0.0, function.spread.size.powi(-2));
            for (index, chunk) in self.system.chunks.iter().enumerate().filter(|(_, chunk)| chunk.run == run)
            {
                let variance = held.noises.each[chunk.balance].sd().powi(2);
                let early = chunk.rows.iter().take_while(|row| row.time_s < middle_s).count();
                let told = signature[index].iter().zip(&held.left[index]).enumerate().take(early);
                for (row, (signature, left)) in told {
                    let loud = chunk.loudness.get(row).copied().unwrap_or(1.0);
                    let weight = signature / (variance * loud * loud);
                    products += weight * left;
                    squares += weight * signature;
                }
            }
            let (values, sds) = &mut function.values[run];
            values.fill(products / squares);
            sds.fill(squares.sqrt().recip());
        }
        Some(function)
    }

    /// The balance in which rows stand out most from its noise.
    fn balance_of(&self, rows: &Column, noises: &Noises) -> usize {
        let squares = self.system.mean_squares(rows, self.fit);
        let strengths = squares.iter().zip(&noises.each).map(|(square, noise)| square / noise.sd().powi(2));
        let best = strengths.enumerate().max_by(|one, other| one.1.total_cmp(&other.1));
        best.map_or(0, |(number, _)| number)
    }
}
