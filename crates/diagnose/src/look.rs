//! A look at the runs: their rows, the regressors and what they tell; and looks after it, from what was found before.

use crate::balances::balance::{Kind, Rows, System};
use crate::case::Correction;
use crate::causes::catalogue::Form;
use crate::causes::sensors;
use crate::causes::trial::{Pool, Trial, add_trial_at, pool};
use crate::choosing::bend;
use crate::choosing::built;
use crate::choosing::built::Early;
use crate::choosing::contest::Contest;
use crate::choosing::search::{
    Accepted, Found, LEAST_GAIN, MOST_CAUSES, PER_CAUSE, concluded, search, search_without, worth,
};
use crate::choosing::sharpen;
use crate::choosing::state::{Part, Stand, State};
use crate::choosing::windows::windows;
use crate::outliers::straying;
use crate::{Case, DiagnoseError};
use std::collections::BTreeSet;

/// A search from nothing takes long with more rows than this; what was found before is then where the next one starts.
pub const MANY_ROWS: usize = 16_000;

/// The rows, the regressors and what they tell.
pub struct Look {
    pub system: System,
    pub pool: Pool,
    pub found: Found,
    /// The samples that were looked at.
    usable: Vec<Vec<bool>>,
    /// What was as good before anything was built on.
    early: Vec<Early>,
}

/// What was found is known well enough for regressors after so many times.
pub const BUILDS: usize = 2;

impl Look {
    /// Looks at samples that are `usable`.
    pub fn at(case: &Case, usable: &[Vec<bool>]) -> Result<Self, DiagnoseError> {
        let (system, pool) = prepared(case, usable)?;
        let found = searched(case, &system, &pool)?;
        Ok(Self { system, pool, found, usable: usable.to_vec(), early: Vec::new() })
    }

    /// Looks once more, after the recordings were corrected or others of their samples are usable.
    pub fn again(&mut self, case: &mut Case, usable: &[Vec<bool>]) -> Result<(), DiagnoseError> {
        let (system, mut pool) = prepared(case, usable)?;
        self.found = if system.row_count() > MANY_ROWS {
            case.step("searching on")?;
            let parts = again(case, &system, &mut pool, &self.found.stand.parts)?;
            let state = State { case, system: &system, pool: &pool, fit: &case.fit };
            let told = from(&state, &parts).and_then(|(first, best)| state.grown(first, best, &self.found));
            told.ok_or_else(|| DiagnoseError::NoBalance { channels: case.channels() })?
        } else {
            let before = again(case, &system, &mut pool, &self.found.stand.parts)?;
            let several = self.found.several.as_ref().map_or(&[][..], |stand| &stand.parts);
            let several = again(case, &system, &mut pool, several)?;
            let found = searched(case, &system, &pool)?;
            let found = as_before(case, &system, &pool, (found, &before));
            let state = State { case, system: &system, pool: &pool, fit: &case.fit };
            let told =
                || if several.is_empty() { None } else { state.settle(&several, &state.quiet(&found.first)) };
            Found { several: found.several.clone().or_else(told), ..found }
        };
        (self.system, self.pool, self.usable) = (system, pool, usable.to_vec());
        Ok(())
    }

    /// Takes the faults of sensors that were found out of the recordings, and what else was found into the model, and looks
    /// again, until neither changes. In long recordings only what was found and the faults are tried meanwhile, and then all
    /// once more.
    pub fn sensors_first(&mut self, case: &mut Case) -> Result<(), DiagnoseError> {
        /// A fault that is not linear takes some rounds.
        const ROUNDS: usize = 6;
        let many = self.system.row_count() > MANY_ROWS;
        let mut rests = Rests::default();
        let mut found: BTreeSet<usize> = BTreeSet::new();
        for round in 0..ROUNDS {
            found.extend(self.found.accepted.iter().map(|accepted| accepted.trial.cause));
            if !case.has_built() {
                self.early = built::as_good(case, self);
            }
            let built = round < BUILDS && case.build_on(&self.pool, &self.found)?;
            let corrected = self.correct(case, &mut rests)?;
            if !built && !corrected {
                break;
            }
            let measured = |cause: &usize| case.causes[*cause].form == Form::Measured;
            let faults = (0..case.causes.len()).filter(measured);
            case.only = many.then(|| found.iter().copied().chain(faults).collect());
            let usable = self.usable.clone();
            self.again(case, &usable)?;
        }
        if case.only.take().is_some() {
            let usable = self.usable.clone();
            self.again(case, &usable)?;
        }
        Ok(())
    }

    /// Takes faults of sensors out of the recordings. Whether there were any.
    fn correct(&self, case: &mut Case, rests: &mut Rests) -> Result<bool, DiagnoseError> {
        /// A rest that is this share of the fault, or this share of its usual size, is none.
        const NEARLY: f64 = 0.1;
        let mut corrections = case.corrections.clone();
        let mut more = false;
        for correction in &mut corrections {
            let column = self.pool.corrected.iter().find(|(id, _)| *id == correction.id);
            let rest = column.map_or(0.0, |(_, column)| self.found.estimate.beta[*column]);
            let usual = case.causes[correction.accepted.trial.cause].terms[0].scale;
            more |= rest.abs() > NEARLY * correction.value.abs().max(usual);
            correction.value = rests.next(correction.id, correction.value, rest);
        }
        for accepted in &self.found.accepted {
            let id = case.causes[accepted.trial.cause].id;
            let position = self.found.used.iter().position(|used| *used == accepted.trial.columns[0]);
            if let (true, Some(position)) =
                (["latency", "clock_drift", "speed_scale", "force_scale"].contains(&id), position)
            {
                let value = rests.next(id, 0.0, self.found.estimate.beta[position]);
                corrections.push(Correction { id, value, accepted: accepted.clone() });
                more = true;
            }
        }
        if let Some(late) = self.late(case) {
            corrections.push(late);
            more = true;
        }
        let small: Vec<&'static str> = corrections
            .iter()
            .filter(|correction| sensors::is_no_fault(case, correction.id, correction.value))
            .map(|correction| correction.id)
            .collect();
        if !more && small.is_empty() {
            return Ok(false);
        }
        corrections.retain(|correction| !small.contains(&correction.id));
        case.no_faults.extend(small);
        case.correct(corrections)?;
        Ok(true)
    }

    /// A latency that every sensor may have a little of, where it is more than that: nothing else delays a force, and what is
    /// free throughout is found by no search.
    fn late(&self, case: &Case) -> Option<Correction> {
        /// No filter of a sensor takes longer [s].
        const LONGEST_FILTER_S: f64 = 0.08;
        /// So many standard deviations beyond it.
        const CLEARLY: f64 = 1.7;
        const ID: &str = "latency";
        let known = |id: &str| id == ID;
        if !case.wanted(ID)
            || case.corrections.iter().any(|one| known(one.id))
            || case.no_faults.contains(&ID)
        {
            return None;
        }
        let column = self.pool.small.iter().find(|(id, _)| known(id))?.1;
        let trial = self.pool.trials.iter().find(|trial| known(case.causes[trial.cause].id))?;
        if self.found.accepted.iter().any(|one| known(case.causes[one.trial.cause].id)) {
            return None;
        }
        let position = self.found.used.iter().position(|used| *used == column)?;
        let value = self.found.estimate.beta[position];
        let sd = self.found.estimate.covariance[(position, position)].sqrt();
        let most = sensors::small_latency_s(case).max(LONGEST_FILTER_S);
        if value.abs() < most + CLEARLY * sd {
            return None;
        }
        let accepted = Accepted {
            trial: trial.clone(),
            gain: 0.5 * (value / sd).powi(2),
            by_chance: self.found.needed,
            rivals: Vec::new(),
            function: None,
            along: None,
            balance: self.system.kinds.iter().position(|kind| *kind == Kind::Motion)?,
        };
        Some(Correction { id: ID, value, accepted })
    }

    /// Searches once more with shapes between the points of the grids, and with causes as they are at their size.
    pub fn sharpen(&mut self, case: &Case) -> Result<(), DiagnoseError> {
        /// Speeds of one cause show one after the other, and a window finds its edges beside what was found first.
        const ROUNDS: usize = 3;
        let speeds = |found: &Found| -> usize {
            found.accepted.iter().map(|one| case.causes[one.trial.cause].speeds()).sum()
        };
        let windows = |found: &Found| -> Vec<(usize, Vec<f64>)> {
            let windowed =
                found.accepted.iter().filter(|one| case.causes[one.trial.cause].window().is_some());
            windowed.map(|one| (one.trial.cause, one.trial.shape.clone())).collect()
        };
        for _ in 0..ROUNDS {
            let before = speeds(&self.found);
            let sharp = windows(&self.found);
            let finer = sharpen::sharpen(case, &self.system, &mut self.pool, &self.found)?;
            let bent = bend::bend(case, &self.system, &mut self.pool, &self.found)?;
            if finer || bent {
                let found = searched(case, &self.system, &self.pool)?;
                let before = self.found.stand.parts.clone();
                self.found = as_before(case, &self.system, &self.pool, (found, &before));
            }
            let several = sharpen::beside_each_other(case, &self.system, &mut self.pool, &self.found)?;
            if !several.is_empty() {
                self.found = as_before(case, &self.system, &self.pool, (self.found.clone(), &several));
            }
            let anew = windows(&self.found).iter().any(|window| !sharp.contains(window));
            if speeds(&self.found) <= before && !anew {
                break;
            }
        }
        Ok(())
    }

    /// What was found, on as many rows as there are, each of which may stray.
    pub fn closer(self, case: &mut Case) -> Result<(System, Pool, Found), DiagnoseError> {
        let early = (self.early.clone(), self.usable.clone());
        let (system, pool, mut found) = self.on_all_rows(case)?;
        built::name(case, (&early.0, &early.1), (&system, &pool), &mut found)?;
        Ok((system, pool, found))
    }

    fn on_all_rows(self, case: &mut Case) -> Result<(System, Pool, Found), DiagnoseError> {
        case.step("strange rows")?;
        case.rows = Rows::Many;
        let system = case.system(&self.usable);
        if system.blocks_s == self.system.blocks_s {
            let found = straying::straying(case, &self.system, &self.pool, self.found, None);
            return Ok((self.system, self.pool, found));
        }
        let mut pool = pool(case, &system)?;
        let parts = again(case, &system, &mut pool, &self.found.stand.parts)?;
        let state = State { case, system: &system, pool: &pool, fit: &case.fit };
        let Some(stands) = from(&state, &parts) else {
            case.rows = Rows::Few;
            return Ok((self.system, self.pool, self.found));
        };
        let found = straying::straying(case, &system, &pool, self.found, Some(stands));
        Ok((system, pool, found))
    }
}

/// What was left of each fault at the value that it was corrected by last.
#[derive(Default)]
struct Rests(Vec<(&'static str, f64, f64)>);

impl Rests {
    /// The value to correct by next, where `rest` is left of a fault after it was corrected by `value`: that and the rest, or
    /// where a straight line says that nothing is left, once a correction went too far. What is estimated beside a fault moves
    /// with it, so that a rest may be told twice as large as it is, and the sum of both would go to and fro.
    /// Source: the rule of false position; Press et al., *Numerical Recipes* (2007), section 9.2.
    fn next(&mut self, id: &'static str, value: f64, rest: f64) -> f64 {
        let last = self.0.iter().position(|one| one.0 == id).map(|place| self.0.remove(place));
        self.0.push((id, value, rest));
        match last {
            Some((_, before, left)) if left * rest < 0.0 => value - rest * (value - before) / (rest - left),
            _ => value + rest,
        }
    }
}

pub fn prepared(case: &Case, usable: &[Vec<bool>]) -> Result<(System, Pool), DiagnoseError> {
    let system = case.system(usable);
    if system.kinds.is_empty() {
        return Err(DiagnoseError::NoBalance { channels: case.channels() });
    }
    let mut pool = pool(case, &system)?;
    if system.row_count() <= MANY_ROWS {
        bend::winds(case, &system, &mut pool)?;
        windows(case, &system, &mut pool)?;
    }
    Ok((system, pool))
}

/// Searches; what runs do not teach each other must not hide what they do, so it is searched once more without.
fn searched(case: &Case, system: &System, pool: &Pool) -> Result<Found, DiagnoseError> {
    /// So many times.
    const ROUNDS: usize = 2;
    let none = || DiagnoseError::NoBalance { channels: case.channels() };
    case.step("searching")?;
    let mut found = search(case, system, pool).ok_or_else(none)?;
    let mut unproven = found.unproven.clone();
    for _ in 0..ROUNDS {
        if found.unproven.is_empty() || system.row_count() > MANY_ROWS {
            break;
        }
        case.step("searching")?;
        let banned = case.ids(&unproven);
        let other = search_without(case, system, pool, &banned).ok_or_else(none)?;
        let more: Vec<usize> = other.unproven.iter().copied().filter(|one| !unproven.contains(one)).collect();
        unproven.extend(more);
        if worth(&other.stand) > worth(&found.stand) + LEAST_GAIN {
            // What was tried first is still what the recordings ask for first.
            found = Found { tried: found.tried.iter().chain(&other.tried).cloned().collect(), ..other };
        } else {
            found.unproven.clear();
        }
    }
    found.unproven = unproven;
    Ok(found)
}

/// What was found, or what was found before, where that is clearly better still: sets are grown from what is best by itself, so that those
/// of causes that only do together are not met for certain. Functions are grown anew each time.
fn as_before(case: &Case, system: &System, pool: &Pool, (found, before): (Found, &[Part])) -> Found {
    let state = State { case, system, pool, fit: &case.fit };
    if before.is_empty() || before.iter().any(|part| part.spread.is_some()) {
        return found;
    }
    let still = state.settle(before, &state.quiet(&found.first)).filter(|stand| {
        worth(stand) > worth(&found.stand) + LEAST_GAIN
            && !state.impossible(&stand.parts, &stand.estimate)
            && state.sensible(stand)
    });
    still.and_then(|still| concluded(&state, still, &found)).unwrap_or(found)
}

/// The same causes by the columns of another pool, but for what was corrected meanwhile.
pub fn again(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    parts: &[Part],
) -> Result<Vec<Part>, DiagnoseError> {
    let mut all = Vec::new();
    for part in parts {
        let wanted = &part.trial;
        let id = case.causes[wanted.cause].id;
        let corrected = case.corrections.iter().any(|correction| correction.id == id);
        if corrected || case.no_faults.contains(&id) {
            continue;
        }
        let same = |trial: &&Trial| {
            trial.cause == wanted.cause
                && trial.shape == wanted.shape
                && trial.terms == wanted.terms
                && trial.levels == wanted.levels
        };
        if !pool.trials.iter().any(|trial| same(&trial)) {
            add_trial_at(case, system, pool, wanted.cause, (&wanted.shape, &wanted.levels))?;
        }
        if let Some(trial) = pool.trials.iter().find(same) {
            all.push(Part { trial: trial.clone(), spread: part.spread.clone() });
        }
    }
    Ok(all)
}

/// The free parameters alone, and with causes.
pub fn from(state: &State, parts: &[Part]) -> Option<(Stand, Stand)> {
    let (system, fit) = (state.system, state.fit);
    let first = state.settle(&[], &system.noises(&system.residual, fit))?;
    let loud = state.settle(parts, &first.noises);
    // What a function leaves out passes for noise, and would let no function follow: it is asked from both sides.
    let quiet = state.settle(parts, &state.quiet(loud.as_ref().unwrap_or(&first)));
    let best = [loud, quiet].into_iter().flatten().max_by(|one, other| one.score.total_cmp(&other.score))?;
    Some((first, best))
}

impl State<'_> {
    /// A set with the causes beside that the recordings ask for besides, the best first, and without those that they do not
    /// ask for any more.
    fn grown(&self, first: Stand, mut best: Stand, before: &Found) -> Option<Found> {
        let mut needed = before.needed;
        best = self.spread_finer(&best).unwrap_or(best);
        while best.parts.len() < MOST_CAUSES {
            let reduced = self.reduced(&best.noises, &best.parts)?;
            needed = LEAST_GAIN.max(self.chance(&best, &reduced));
            let able = |one: &Contest| {
                one.stand.score - best.score >= needed.max(PER_CAUSE) && worth(&one.stand) > worth(&best)
            };
            let judged = self.spread_anew(&best, self.contest(&best, &reduced, &[])).into_iter();
            let next = judged.filter(able).find(|one| self.sensible(&one.stand));
            let Some(next) = next else { break };
            best = self.spread_finer(&next.stand).unwrap_or(next.stand);
            best = self.shared_instead(&best).unwrap_or(best);
        }
        self.conclude(best, first, (before.tried.clone(), Vec::new()), needed)
    }
}

#[cfg(test)]
mod tests {
    use super::Rests;

    /// Told twice as large: 0.06, then −0.06 too much, and so on; the line through the first two meets it.
    #[test]
    fn a_rest_that_is_told_too_large_does_not_go_to_and_fro() {
        let rest = |value: f64| 2.0 * (0.03 - value);
        let mut rests = Rests::default();
        let first = rests.next("force_scale", 0.0, rest(0.0));
        let other = rests.next("speed_scale", 0.0, 0.5);
        let second = rests.next("force_scale", first, rest(first));
        assert!((first - 0.06).abs() < 1e-12 && (second - 0.03).abs() < 1e-12, "{first}, {second}");
        // A rest on the same side is what is still missing.
        assert!((rests.next("speed_scale", other, 0.1) - 0.6).abs() < 1e-12);
    }
}
