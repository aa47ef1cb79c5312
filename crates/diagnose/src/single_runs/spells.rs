//! Which spells there are in single runs: those that stand out from all that is left, and those that only stand out where the
//! noise is what neighbouring rows show, if they make the recordings more likely than anything that all runs have in common.

use crate::balances::balance::{Kind, System, block_s};
use crate::balances::gram::Column;
use crate::choosing::search::{Accepted, Found, search_without, worth};
use crate::choosing::state::{Part, Stand, State};
use crate::law::unlisted;
use crate::look::{Look, MANY_ROWS};
use crate::runs::places::of_places;
use crate::single_runs::brakes::off_the_ground;
use crate::single_runs::events::{self, Event, Spot, Stretches};
use crate::{Case, DiagnoseError};

/// Spells in single runs are set aside, and what every run has in common is looked for once more without them.
pub fn spells(
    case: &mut Case,
    look: &mut Look,
    sound: &[Vec<bool>],
    braked: &[Event],
) -> Result<Vec<Event>, DiagnoseError> {
    /// Where fewer of them are none of the ground, it is the ground that holds back.
    const MOST_OFF: f64 = 0.5;
    let mut events = quiet(case, look)?;
    if events.is_empty() {
        events = loud(case, look);
    }
    let named = events::named(&case.runs, &events).into_iter();
    let mut events: Vec<Event> =
        named.filter(|(id, _)| case.wanted(id)).flat_map(|(_, events)| events).collect();
    let of_runs = off_the_ground(case, sound, &events).len();
    if events.is_empty() || MOST_OFF * events.len() as f64 > of_runs as f64 || of_places(case, &events) {
        return Ok(braked.to_vec());
    }
    let usable = outside(case, sound, &events);
    // What was found before the spells were known may have stood in for them.
    case.forget()?;
    look.again(case, &usable)?;
    look.sensors_first(case)?;
    look.sharpen(case)?;
    events.extend_from_slice(braked);
    events.sort_by(|one, other| one.run.cmp(&other.run).then(one.from_s.total_cmp(&other.from_s)));
    Ok(events)
}

/// The samples that are usable and lie in no spell.
pub fn outside(case: &Case, usable: &[Vec<bool>], events: &[Event]) -> Vec<Vec<bool>> {
    let mut outside = events::outside(&case.runs, events, block_s(Kind::Motion, &case.runs, case.rows));
    for (outside, usable) in outside.iter_mut().zip(usable) {
        for (outside, usable) in outside.iter_mut().zip(usable) {
            *outside &= usable;
        }
    }
    outside
}

/// Spells that stand out from all that is left.
fn loud(case: &Case, look: &Look) -> Vec<Event> {
    // A function of time can imitate spells; it is looked at without.
    let timed = |one: &Accepted| {
        let cause = &case.causes[one.trial.cause];
        cause.id == "payload_change" && cause.is_function()
    };
    if look.found.accepted.iter().any(timed) {
        let plain = search_without(case, &look.system, &look.pool, &["payload_change"]);
        events::events(case, (&look.system, &look.pool), plain.as_ref().unwrap_or(&look.found))
    } else {
        events::events(case, (&look.system, &look.pool), &look.found)
    }
}

/// Spells with which the recordings are more likely than with all that was found, laws that nobody listed among it.
fn quiet(case: &mut Case, look: &Look) -> Result<Vec<Event>, DiagnoseError> {
    /// As much as any other cause takes that no other run shows.
    const LEAST: f64 = 20.0;
    if look.system.row_count() > MANY_ROWS || !look.system.has(Kind::Motion) {
        return Ok(Vec::new());
    }
    let state = State { case, system: &look.system, pool: &look.pool, fit: &case.fit };
    let mut starts = vec![look.found.stand.clone()];
    if !look.found.stand.parts.is_empty() {
        starts.push(look.found.first.clone());
    }
    // Or beside some of it: what else was found may have stood in for them.
    starts.extend(state.subsets(&look.found.stand));
    let enough = worth(&look.found.stand) + LEAST;
    let told = starts.iter().filter_map(|start| state.with_spots(start, enough));
    let Some((score, spots)) = told.max_by(|one, other| one.0.total_cmp(&other.0)) else {
        return Ok(Vec::new());
    };
    let events = events::within_runs(case, &events::joined(spots));
    if events.is_empty() || score < enough {
        return Ok(Vec::new());
    }
    let law = worth_with_a_law(case, look)?;
    Ok(if score < law + LEAST { Vec::new() } else { events })
}

/// How likely the recordings are with a law of forces that nobody listed, where there is one: spells say nothing of consumers.
fn worth_with_a_law(case: &mut Case, look: &Look) -> Result<f64, DiagnoseError> {
    let (causes, mut pool) = (case.causes.len(), look.pool.clone());
    let found: Found = unlisted::of_motion(case, &look.system, &mut pool, look.found.clone())?;
    case.causes.truncate(causes);
    Ok(worth(&found.stand))
}

impl State<'_> {
    /// Some of the causes of a set, not all and not none.
    fn subsets(&self, stand: &Stand) -> Vec<Stand> {
        let taken = |set: usize| -> Vec<Part> {
            let parts = stand.parts.iter().enumerate();
            parts.filter(|(place, _)| set >> place & 1 == 1).map(|(_, part)| part.clone()).collect()
        };
        let all = (1 << stand.parts.len()) - 1;
        (1..all).filter_map(|set| self.settle(&taken(set), &stand.noises)).collect()
    }

    /// How good a set is with spells beside it, and what those are; none where no spell stands out. It ought to become as
    /// good as is `wanted`.
    fn with_spots(&self, start: &Stand, wanted: f64) -> Option<(f64, Vec<Spot>)> {
        /// Noise, causes and spells belong together: they are found in turns, first at the noise that neighbouring rows show,
        /// with which a cause gives back what it took of the spells, then at that of what is left.
        const ROUNDS: usize = 10;
        const QUIET: usize = 3;
        /// What no driver feels is no spell: share of the weight.
        const FAINT: f64 = 0.005;
        /// What is so far from what is wanted then does not get there.
        const HOPELESS: f64 = 100.0;
        /// Begin, end and force of a spell: each was one of about a hundred.
        const PER_SPELL: f64 = 14.0;
        let mut best: Option<(f64, Vec<Spot>)> = None;
        let mut noises = self.quiet(start);
        let mut left = start.left.clone();
        for round in 1..=ROUNDS {
            let mut spots = events::spots(self.case, self.system, &left, &noises, Stretches::Every);
            spots.retain(|spot| {
                spot.event.force_n > FAINT * events::weight_n(self.case, spot.event.run)
                    && self.is_told_beside(&start.parts, &spot.event)
            });
            if spots.is_empty() {
                break;
            }
            let residual = with(self.system.residual.clone(), -1.0, &spots);
            let without = System { residual, ..self.system.clone() };
            let beside = State { system: &without, ..*self };
            let stand = beside.settle(&start.parts, &noises)?;
            let fitted = events::joined(spots.clone()).iter().filter(|event| self.fit[event.run]).count();
            let score = worth(&stand) - PER_SPELL * fitted as f64;
            noises = if round < QUIET { beside.quiet(&stand) } else { stand.noises };
            left = with(stand.left, 1.0, &spots);
            if best.as_ref().is_none_or(|(other, _)| score > *other) {
                best = Some((score, spots));
            } else if round > QUIET {
                break;
            }
            if round > QUIET && score < wanted - HOPELESS {
                break;
            }
        }
        best
    }
}

/// Rows with so many times the spells added.
fn with(mut rows: Column, times: f64, spots: &[Spot]) -> Column {
    for Spot { chunk, rows: (from, to), event } in spots {
        rows[*chunk].rows_mut(*from, to - from).add_scalar_mut(times * event.force_n);
    }
    rows
}
