//! Shapes between the points of a grid: what lies between them must not be left for another cause to explain.

use crate::causes::catalogue::{Cause, Form, Term};
use crate::causes::trial::{Pool, Trial, add_trial};
use crate::choosing::search::{Accepted, Found, LEAST_GAIN};
use crate::choosing::state::{Part, State};
use crate::choosing::windows;
use crate::look::MANY_ROWS;
use crate::{Case, DiagnoseError, System};

/// So many causes get the chance.
const MOST: usize = 3;
/// Those that bring at least this share of what the best one brings.
const CLOSE: f64 = 0.5;
/// First factor by which a parameter is moved: half way to the next point of a grid of doubles.
const FACTOR: f64 = 1.4;
/// Moves at one factor.
const MOST_MOVES: usize = 5;
/// The factor's root is taken so many times.
const ROUNDS: usize = 8;

/// How a shape is judged.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum How {
    /// By itself: a wrong companion must not hold it where it is.
    ByItself,
    /// Beside what it was accepted with, by the same terms.
    Beside,
    /// Beside it as well, by any of its terms, at the noise that neighbouring rows show: while a window is not where it
    /// belongs, what its edges leave passes for noise, and any other place is as good.
    Quietly,
}

/// Adds a trial at the best shape, of the best causes that have one. Whether there was anything to add.
pub fn sharpen(case: &Case, system: &System, pool: &mut Pool, found: &Found) -> Result<bool, DiagnoseError> {
    let Some(round) = found.tried.first() else { return Ok(false) };
    let Some(greatest) = round.causes.first().map(|one| one.2).filter(|gain| *gain > 0.0) else {
        return Ok(false);
    };
    let shaped = |cause: usize| is_shaped(&case.causes[cause]);
    let mut chosen: Vec<(usize, Vec<f64>)> = Vec::new();
    let mut consider = |cause: usize, shape: &[f64]| {
        if shaped(cause) && !chosen.iter().any(|(own, _)| *own == cause) {
            chosen.push((cause, shape.to_vec()));
        }
    };
    for one in &found.accepted {
        consider(one.trial.cause, &one.trial.shape);
    }
    // Levels of each run, and courses, have no shape and take what one between two points of a grid leaves, so they come first. What is
    // of two causes finds its shape beside them, as one of theirs.
    let near = round.causes.iter().filter(|(cause, _, gain)| {
        *gain > 0.0 && *gain >= CLOSE * greatest && shaped(*cause) && !case.causes[*cause].is_of_two()
    });
    for (cause, shape, _) in near.take(MOST) {
        consider(*cause, shape);
    }
    // Bells at some speeds follow teeth between others, which a grid of few speeds shows hardly any of.
    let by_speeds = |cause: usize| case.causes[cause].speeds() > 0;
    if let Some(own) = found.accepted.iter().find(|one| by_speeds(one.trial.cause)) {
        let own = case.causes[own.trial.cause].id;
        let mut others = round.causes.iter().filter(|one| by_speeds(one.0) && case.causes[one.0].id != own);
        if let Some((cause, shape)) = of_two_speeds(case, system, pool, found, own)? {
            consider(cause, &shape);
        } else if let Some((cause, shape, _)) = others.next() {
            consider(*cause, shape);
        }
    }
    // A window of the grid begins and ends seconds beside the one that is there, and each edge beside its place costs it dearly.
    // Where there are many rows that takes long, and their windows are long as well.
    let few = system.row_count() <= MANY_ROWS;
    let windows = round.causes.iter().filter(|one| one.2 > 0.0 && case.causes[one.0].window().is_some());
    for (cause, shape, _) in windows.take(usize::from(few)) {
        consider(*cause, shape);
    }
    let mut added = false;
    for (cause, shape) in chosen {
        let accepted = found.accepted.iter().any(|one| one.trial.cause == cause);
        for how in [How::ByItself, How::Beside, How::Quietly] {
            let able = match how {
                How::ByItself => true,
                How::Beside => accepted,
                How::Quietly => (accepted || few) && case.causes[cause].window().is_some(),
            };
            if !able {
                continue;
            }
            let best = best(case, system, pool, found, how, (cause, &shape))?;
            if how == How::ByItself {
                added |= grow(case, system, pool, found, (cause, &best))?;
            }
            if how == How::Quietly {
                added |= windows::soften(case, system, pool, found, (cause, &best))?;
            }
            if best != shape {
                // What fades by a time constant of its own, or is there for a while, is no better for having found it first.
                for (alike, shape) in alike(case, cause, &best) {
                    add_trial(case, system, pool, alike, &shape)?;
                }
                added = true;
            }
        }
    }
    Ok(added)
}

/// The likeliest of two speeds of the causes by speeds that go by another name: between two of the points of a variator lies a tooth, and
/// one point by itself has none.
fn of_two_speeds(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    but: &str,
) -> Result<Option<(usize, Vec<f64>)>, DiagnoseError> {
    /// Places over the range of speeds.
    const PLACES: u8 = 16;
    let Some(fastest_m_s) = case.fastest_m_s() else { return Ok(None) };
    let others = (0..case.causes.len()).filter(|cause| {
        let cause = &case.causes[*cause];
        let shaped = cause.terms.iter().filter(|term| !term.linear).count();
        cause.speeds() == 2 && shaped == 2 && cause.id != but && case.wanted(cause.id)
    });
    let at = |place: u8| fastest_m_s * f64::from(place) / f64::from(PLACES);
    let mut best: Option<(f64, usize, Vec<f64>)> = None;
    for cause in others {
        for one in 1..PLACES {
            for other in one + 1..=PLACES {
                let shape = vec![at(one), at(other)];
                let gain = likely(case, system, pool, found, (cause, &shape))?;
                if best.as_ref().is_none_or(|(greatest, ..)| gain > *greatest) {
                    best = Some((gain, cause, shape));
                }
            }
        }
    }
    Ok(best.map(|(_, cause, shape)| (cause, shape)))
}

/// Adds trials of the same cause at one more speed, and at another, while each makes the recordings more likely than chance would:
/// grids of several speeds are too coarse for what is narrow. Whether there were any.
fn grow(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    (cause, shape): (usize, &[f64]),
) -> Result<bool, DiagnoseError> {
    /// Places at which one more is tried, over the range that the known ones and the fastest speed span.
    const PLACES: u8 = 24;
    let (mut cause, mut shape, mut added) = (cause, shape.to_vec(), false);
    while let Some(next) = case.causes[cause].with_one_more_speed(&case.causes) {
        let Some(fastest_m_s) = case.fastest_m_s() else { break };
        let mut greatest = likely(case, system, pool, found, (cause, &shape))? + LEAST_GAIN;
        let before = greatest;
        let mut longer = shape.clone();
        for place in 1..=PLACES {
            let speed_m_s = fastest_m_s * f64::from(place) / f64::from(PLACES);
            let other: Vec<f64> = shape.iter().copied().chain([speed_m_s]).collect();
            let gain = likely(case, system, pool, found, (next, &other))?;
            if gain > greatest {
                (longer, greatest) = (other, gain);
            }
        }
        if greatest <= before {
            break;
        }
        shape = best(case, system, pool, found, How::ByItself, (next, &longer))?;
        cause = next;
        add_trial(case, system, pool, cause, &shape)?;
        added = true;
    }
    Ok(added)
}

/// How likely a cause of this shape makes the recordings, by itself.
fn likely(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    (cause, shape): (usize, &[f64]),
) -> Result<f64, DiagnoseError> {
    // What was accepted left the noise that it left.
    let accepted = found.accepted.iter().any(|one| case.causes[one.trial.cause].id == case.causes[cause].id);
    let noises = if accepted { &found.noises.1 } else { &found.noises.0 };
    likeliest(case, system, pool, (cause, shape), |state, trial| {
        state.likely(&[Part { trial: trial.clone(), spread: None }], noises)
    })
}

/// The best of the trials of a cause of this shape, as each is judged; none of them stays.
pub fn likeliest(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    (cause, shape): (usize, &[f64]),
    judged: impl Fn(&State, &Trial) -> Option<f64>,
) -> Result<f64, DiagnoseError> {
    if !case.causes[cause].possible(shape) {
        return Ok(f64::NEG_INFINITY);
    }
    let (columns, trials) = (pool.columns.len(), pool.trials.len());
    add_trial(case, system, pool, cause, shape)?;
    let state = State { case, system, pool, fit: &case.fit };
    let new = pool.trials[trials..].iter().filter_map(|trial| judged(&state, trial));
    let greatest = new.fold(f64::NEG_INFINITY, f64::max);
    pool.truncate(columns, trials);
    Ok(greatest)
}

/// A cause of this shape, and others that fade by a time constant or are there for a while as well, each with it and with what it
/// holds itself.
fn alike(case: &Case, cause: usize, shape: &[f64]) -> Vec<(usize, Vec<f64>)> {
    let of_shape = |cause: usize| case.causes[cause].terms.iter().filter(|term| !term.linear);
    let free = |cause: usize| of_shape(cause).filter(|term| !term.is_held());
    let names = |cause: usize| free(cause).map(|term| term.name).collect::<Vec<_>>();
    let own = names(cause);
    let shared = own == ["time_constant_s"] || own == ["from_s", "to_s"];
    let class = case.causes[cause].class;
    let moved: Vec<f64> =
        of_shape(cause).zip(shape).filter(|(term, _)| !term.is_held()).map(|(_, value)| *value).collect();
    let others = (0..case.causes.len()).filter(|other| {
        let same = case.causes[*other].class == class && case.causes[*other].form == Form::Parameters;
        *other != cause && same && shared && names(*other) == own
    });
    let with = |other: usize| {
        let mut moved = moved.iter();
        let value = |term: &Term| if term.is_held() { Some(term.low) } else { moved.next().copied() };
        (other, of_shape(other).filter_map(value).collect())
    };
    std::iter::once((cause, shape.to_vec())).chain(others.map(with)).collect()
}

/// The shape that makes the recordings most likely, by moving one parameter at a time.
fn best(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
    how: How,
    (cause, start): (usize, &[f64]),
) -> Result<Vec<f64>, DiagnoseError> {
    moved(case, (cause, start), judge(case, system, pool, found, how, cause))
}

/// How likely a shape of a cause makes the recordings, as it is judged.
pub fn judge<'a>(
    case: &'a Case,
    system: &'a System,
    pool: &'a mut Pool,
    found: &'a Found,
    how: How,
    cause: usize,
) -> impl FnMut(&[f64]) -> Result<f64, DiagnoseError> + 'a {
    let is_own = |one: &&Accepted| {
        let accepted = one.trial.cause;
        accepted == cause || case.causes[accepted].softened(&case.causes) == Some(cause)
    };
    let own = found.accepted.iter().find(is_own);
    let accepted = own.filter(|_| how != How::ByItself);
    let spread = own.and_then(|one| one.function.as_ref()).map(|function| function.spread.clone());
    let wanted = accepted.filter(|_| how == How::Beside).map(|one| one.trial.terms.clone());
    // Beside the other accepted causes, but for functions.
    let others: Vec<Part> = found
        .accepted
        .iter()
        .filter(|one| accepted.is_some() && !is_own(one) && one.function.is_none())
        .map(|one| Part { trial: one.trial.clone(), spread: None })
        .collect();
    let noises = match how {
        How::ByItself => found.noises.0.clone(),
        How::Beside => found.noises.1.clone(),
        How::Quietly => State { case, system, pool, fit: &case.fit }.quiet(&found.stand),
    };
    move |shape| {
        likeliest(case, system, pool, (cause, shape), |state, trial| {
            if wanted.as_ref().is_some_and(|terms| *terms != trial.terms) {
                return None;
            }
            let mut parts = others.clone();
            parts.push(Part { trial: trial.clone(), spread: spread.clone() });
            state.likely(&parts, &noises)
        })
    }
}

/// Several causes that all runs share, each at its best shape beside the others, where levels of each run were accepted: those follow
/// what a grid leaves between its points, and would stand for all of them. Nothing where there are none.
pub fn beside_each_other(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
) -> Result<Vec<Part>, DiagnoseError> {
    let by_run = |one: &Accepted| one.function.is_some() && case.causes[one.trial.cause].by_run;
    let stand = found.several.as_ref().filter(|_| found.accepted.iter().any(by_run));
    let Some(stand) = stand else { return Ok(Vec::new()) };
    let noises = State { case, system, pool, fit: &case.fit }.quiet(stand);
    let mut parts = stand.parts.clone();
    for place in 0..parts.len() {
        let own = parts[place].trial.clone();
        if !is_shaped(&case.causes[own.cause]) {
            continue;
        }
        let judged = |state: &State, trial: &Trial| {
            let mut parts = parts.clone();
            parts[place].trial = trial.clone();
            (trial.terms == own.terms).then(|| state.likely(&parts, &noises)).flatten()
        };
        let with = |shape: &[f64]| likeliest(case, system, pool, (own.cause, shape), judged);
        let shape = moved(case, (own.cause, &own.shape), with)?;
        let trials = pool.trials.len();
        add_trial(case, system, pool, own.cause, &shape)?;
        if let Some(trial) = pool.trials[trials..].iter().find(|trial| trial.terms == own.terms) {
            parts[place].trial = trial.clone();
        }
    }
    Ok(parts)
}

/// Whether a cause has a shape that is looked for.
fn is_shaped(cause: &Cause) -> bool {
    let free = cause.terms.iter().any(|term| !term.linear && !term.is_held());
    free && (cause.form == Form::Parameters || cause.by_run) && !cause.blows_by_run()
}

/// The likeliest shape of a cause that is reached by moving one parameter at a time, and a ramp about its end as well as about its begin.
pub fn moved(
    case: &Case,
    (cause, start): (usize, &[f64]),
    mut likely: impl FnMut(&[f64]) -> Result<f64, DiagnoseError>,
) -> Result<Vec<f64>, DiagnoseError> {
    let terms: Vec<_> = case.causes[cause].terms.iter().filter(|term| !term.linear).collect();
    let place = |wanted: &str| terms.iter().position(|term| term.name == wanted);
    let ramp = case.causes[cause].ramp().and(place("threshold_m_s").zip(place("width_m_s")));
    let along = |shape: &[f64], way: usize, factor: f64| match shape.get(way) {
        Some(value) => (*value != 0.0 && !terms[way].is_held()).then(|| scaled(shape, way, factor)),
        None => ramp.map(|ramp| about_its_end(shape, ramp, factor)),
    };
    let mut shape = start.to_vec();
    let mut greatest = likely(&shape)?;
    let mut factor = FACTOR;
    for _ in 0..ROUNDS {
        // At one factor until nothing is better.
        for _ in 0..MOST_MOVES {
            let mut moved = false;
            for way in 0..=shape.len() {
                for factor in [factor, 1.0 / factor] {
                    let Some(other) = along(&shape, way, factor) else { continue };
                    let gain = likely(&other)?;
                    if gain > greatest {
                        (shape, greatest, moved) = (other, gain, true);
                        break;
                    }
                }
            }
            if !moved {
                break;
            }
        }
        factor = factor.sqrt();
    }
    Ok(shape)
}

/// A ramp whose width is times a factor and whose end stays, by the places of its begin and its width.
fn about_its_end(shape: &[f64], (begin, width): (usize, usize), factor: f64) -> Vec<f64> {
    let mut other = scaled(shape, width, factor);
    other[begin] += shape[width] - other[width];
    other
}

/// A shape with one parameter times a factor.
fn scaled(shape: &[f64], place: usize, factor: f64) -> Vec<f64> {
    let mut other = shape.to_vec();
    other[place] *= factor;
    other
}

#[cfg(test)]
mod tests {
    use super::about_its_end;

    #[test]
    fn a_ramp_that_is_moved_about_its_end_ends_where_it_did() {
        let [begin, width] = about_its_end(&[3.3, 0.3], (0, 1), 1.5)[..] else { panic!("two numbers") };
        assert!((width - 0.45).abs() < 1e-12 && (begin + width - 3.6).abs() < 1e-12, "{begin} {width}");
    }
}
