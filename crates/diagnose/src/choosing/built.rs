//! Rivals, each as fairly built on as what was found. Regressors are made beside what was found so far: slopes that were found
//! beside an inertia are a tenth steeper than beside the mass that makes the same motion, and the mass then seems to fall
//! behind. A set that was as good before anything was built on is therefore asked once more, with regressors that are made
//! beside itself.

use crate::causes::trial::Pool;
use crate::choosing::rivals::TOLERANCE_IN_DOUBT;
use crate::choosing::search::{Accepted, Found, Rival, TOLERANCE};
use crate::choosing::state::{Part, State};
use crate::look::{BUILDS, Look, MANY_ROWS, again, from, prepared};
use crate::{Case, DiagnoseError, System};

/// So many rivals are asked.
const MOST: usize = 3;

/// A set that was as good, and which of its causes stands in the place of another.
#[derive(Clone)]
pub struct Early {
    parts: Vec<Part>,
    /// The place of the one that is exchanged.
    place: usize,
    /// The cause that was there.
    instead_of: usize,
}

impl Early {
    fn cause(&self) -> usize {
        self.parts[self.place].trial.cause
    }
}

/// The sets that are as good as what a look found, with one cause exchanged for another that is a number.
pub fn as_good(case: &Case, look: &Look) -> Vec<Early> {
    let state = State { case, system: &look.system, pool: &look.pool, fit: &case.fit };
    let stand = &look.found.stand;
    let mut all: Vec<(f64, Early)> = Vec::new();
    for accepted in &look.found.accepted {
        let own = |part: &Part| part.trial.columns == accepted.trial.columns;
        let Some(place) = stand.parts.iter().position(own) else { continue };
        for rival in &accepted.rivals {
            let cause = &case.causes[rival.cause];
            if cause.is_function() || cause.law.is_some() || cause.run.is_some() {
                continue;
            }
            let trials = look.pool.trials.iter().filter(|trial| trial.cause == rival.cause);
            let with = trials.filter_map(|trial| {
                let mut parts = stand.parts.clone();
                parts[place] = Part { trial: trial.clone(), spread: None };
                Some((state.settle(&parts, &stand.noises)?.score, parts))
            });
            if let Some((score, parts)) = with.max_by(|one, other| one.0.total_cmp(&other.0)) {
                all.push((score, Early { parts, place, instead_of: accepted.trial.cause }));
            }
        }
    }
    all.sort_by(|one, other| other.0.total_cmp(&one.0));
    all.into_iter().take(MOST).map(|(_, early)| early).collect()
}

/// Names the sets that were as good before anything was built on, where they still are when it is they that are built on.
pub fn name(
    case: &mut Case,
    (early, usable): (&[Early], &[Vec<bool>]),
    (system, pool): (&System, &Pool),
    found: &mut Found,
) -> Result<(), DiagnoseError> {
    let open = |early: &&Early| {
        let same = |cause: usize| case.causes[cause].id == case.causes[early.cause()].id;
        let own = |cause: usize| cause == early.instead_of;
        let named = |one: &Accepted| {
            same(one.trial.cause) || own(one.trial.cause) && one.rivals.iter().any(|rival| same(rival.cause))
        };
        found.accepted.iter().any(|one| own(one.trial.cause))
            && !found.accepted.iter().any(named)
            && !found.unproven.iter().any(|cause| same(*cause))
    };
    let early: Vec<Early> = early.iter().filter(open).cloned().collect();
    if early.is_empty() || system.row_count() > MANY_ROWS || !case.has_built() {
        return Ok(());
    }
    case.step("what is as good")?;
    let needed = found.needed;
    let Some(own) = built_on(case, usable, &found.stand.parts, needed)? else { return Ok(()) };
    let mut as_good: Vec<(f64, Early)> = Vec::new();
    for early in early {
        if let Some(other) = built_on(case, usable, &early.parts, needed)? {
            as_good.push((other - own, early));
        }
    }
    if as_good.iter().any(|(more, _)| *more > -TOLERANCE) {
        as_good.retain(|(more, _)| *more > -TOLERANCE_IN_DOUBT);
        let state = State { case, system, pool, fit: &case.fit };
        for (more, early) in &as_good {
            state.rival(found, early, *more);
        }
    }
    Ok(())
}

impl State<'_> {
    /// Names a rival of what was found, which makes the recordings so much more likely.
    fn rival(&self, found: &mut Found, early: &Early, more: f64) {
        let free = self.free_beside(&found.stand);
        let parts = found.stand.parts.iter();
        let others: Vec<Part> = parts.filter(|part| part.trial.cause != early.instead_of).cloned().collect();
        let reduced = self.reduced(&found.stand.noises, &others);
        let trial = self.pool.trials.iter().find(|trial| trial.cause == early.cause());
        let Some(one) = found.accepted.iter_mut().find(|one| one.trial.cause == early.instead_of) else {
            return;
        };
        let like = reduced.zip(trial).map(|(reduced, trial)| {
            let columns = self.columns(&others);
            reduced.squared_correlation(&one.trial.columns, &trial.columns, &columns, &self.sd())
        });
        let squared_correlation = like.unwrap_or(0.0);
        one.rivals.push(Rival { cause: early.cause(), gain: one.gain + more, squared_correlation, free });
    }
}

/// ln p of the recordings with a set of causes that regressors are built on; none where it cannot be.
fn built_on(
    case: &mut Case,
    usable: &[Vec<bool>],
    parts: &[Part],
    needed: f64,
) -> Result<Option<f64>, DiagnoseError> {
    let kept = case.set_aside()?;
    let score = on_itself(case, usable, parts, needed);
    case.take_back(kept)?;
    score
}

/// Builds on a set of causes as it is estimated beside what was built so far, until the runs accelerate as they did: the first
/// time, they accelerate as without it. ln p of the recordings with it; none where it cannot be.
pub fn on_itself(
    case: &mut Case,
    usable: &[Vec<bool>],
    parts: &[Part],
    needed: f64,
) -> Result<Option<f64>, DiagnoseError> {
    let only = parts.iter().map(|part| part.trial.cause).collect();
    let before = case.only.replace(only);
    let score = score_built(case, usable, parts, needed);
    case.only = before;
    score
}

fn score_built(
    case: &mut Case,
    usable: &[Vec<bool>],
    parts: &[Part],
    needed: f64,
) -> Result<Option<f64>, DiagnoseError> {
    for round in 0..=BUILDS {
        let (system, mut pool) = prepared(case, usable)?;
        let own = again(case, &system, &mut pool, parts)?;
        let state = State { case, system: &system, pool: &pool, fit: &case.fit };
        let Some((first, stand)) = from(&state, &own) else { return Ok(None) };
        if state.impossible(&stand.parts, &stand.estimate) {
            return Ok(None);
        }
        let score = stand.score;
        let found = state.found(stand, first, (Vec::new(), Vec::new()), needed);
        if round == BUILDS || !case.build_on(&pool, &found)? {
            return Ok(Some(score));
        }
    }
    Ok(None)
}
