//! The accepted causes fitted once more without linearising, together with the free parameters.

use crate::balances::gram::Column;
use crate::causes::catalogue::{Cause, Class, ELECTRIC, Form, Term, spell};
use crate::causes::losses::SMALL_LOSS;
use crate::causes::profile::Function;
use crate::causes::sensors::is_no_fault;
use crate::causes::trial::{Pool, Trial, for_run};
use crate::choosing::search::{Accepted, Found, Rival};
use crate::law::beside_courses::gives_more;
use crate::proof::mirror::{self, Lane, is_whole};
use crate::proof::widths::{Beyond, Widths, widths};
use crate::runs::places::in_one_place;
use crate::runs::recorded::Recorded;
use crate::runs::said::{Said, said};
use crate::single_runs::events::{Event, LEAST_GAIN, named};
use crate::single_runs::regeneration::limit_w;
use crate::{Case, DiagnoseError, Kind, System};
use headland_calibrate::fit::{Estimate, Fit, Parameter, Residuals, fit};
use headland_calibrate::statistics::median;
use headland_scenario::Scenario;

/// Half the width of a 95 % interval, in standard deviations.
pub const HALF_95: f64 = 1.96;
/// Nothing is known worse than before; scatter between the runs may widen an interval beyond that, but not by this factor.
const LOST: f64 = 3.0;
/// A free parameter that is so many standard deviations from what is known of it was carried off by something else.
const FAR: f64 = 4.0;

/// A cause with its values.
#[derive(Clone, Debug)]
pub struct Cured {
    /// The cause.
    pub cause: Cause,
    /// How it was accepted.
    pub accepted: Accepted,
    /// Its parameters in the order of its terms, with 95 % intervals; empty for a function.
    pub values: Vec<(f64, [f64; 2])>,
    /// Spells in single runs, where it is some.
    pub events: Vec<Event>,
    /// Values that explain as much as its own, seen in a mirror along the lane; none where there are none.
    pub mirrored: Option<Vec<f64>>,
    /// What of a wind blows along the line of all runs, where there is one.
    pub lane: Option<Lane>,
}

impl Cured {
    /// A cause with values, which nothing else is known of.
    pub fn new(cause: Cause, accepted: Accepted, values: Vec<(f64, [f64; 2])>) -> Self {
        Self { cause, accepted, values, events: Vec::new(), mirrored: None, lane: None }
    }

    /// Whether every amplitude of it may as well be nought. What blows along a lane is none where that may be, whatever is open
    /// of what blows across.
    pub fn may_be_none(&self) -> bool {
        if let Some(lane) = self.lane {
            return lane.speed_m_s <= HALF_95 * lane.sd_m_s;
        }
        let amplitudes = self.cause.terms.iter().zip(&self.values).filter(|(term, _)| term.linear);
        let mut known = amplitudes.map(|(_, (_, ci95))| ci95).peekable();
        self.cause.form == Form::Parameters
            && known.peek().is_some()
            && known.all(|ci95| ci95[0] <= 0.0 && ci95[1] >= 0.0)
    }

    /// Tells what of a wind blows along the line of all runs, from its parts, whose estimates are correlated.
    fn told_along(&mut self, case: &Case, correlation: f64) {
        if self.cause.blows_by_run() {
            self.lane = self.strongest().filter(|_| mirror::lanes_rad(case).is_some());
        }
        let ([north, east, ..], true) = (&self.values[..], is_whole(&self.cause)) else { return };
        let known = |(value, ci95): &(f64, [f64; 2])| (*value, (ci95[1] - ci95[0]) / (2.0 * HALF_95));
        let parts = [known(north), known(east)];
        self.lane = mirror::axis_rad(case).map(|axis_rad| Lane::of(axis_rad, parts, correlation));
    }

    /// What of a wind that blows otherwise in each run blows along its axis where it is strongest.
    fn strongest(&self) -> Option<Lane> {
        let function = self.function()?;
        let each = function.values.iter().filter_map(|(values, sds)| Some((*values.iter().next()?, sds[0])));
        let (value, sd) = each.max_by(|one, other| one.0.abs().total_cmp(&other.0.abs()))?;
        Some(Lane::along(*self.accepted.trial.shape.first()?, (value, sd)))
    }

    /// Whether single runs tell it of themselves: spells, or what works in one run.
    pub fn in_single_runs(&self) -> bool {
        !self.events.is_empty() || self.cause.run.is_some()
    }

    /// Whether it takes a course of its own in each run.
    pub fn takes_its_own_course(&self) -> bool {
        self.cause.is_course() && self.function().is_some_and(|function| !function.spread.shared)
    }
}

/// A free parameter.
#[derive(Clone, Debug)]
pub struct Free {
    /// Its name.
    pub name: String,
    /// As the scenario has it.
    pub prior: f64,
    /// As it was found.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Where the rows alone would have it, where they were not believed.
    pub asked: f64,
}

/// Everything that was found, with values.
#[derive(Clone)]
pub struct Refined {
    /// The causes.
    pub causes: Vec<Cured>,
    /// The free parameters.
    pub free: Vec<Free>,
    /// What the data cannot separate.
    pub null_space: Vec<String>,
}

impl Refined {
    /// Values of the free parameters.
    pub fn values(&self) -> Vec<f64> {
        self.free.iter().map(|free| free.value).collect()
    }

    /// The free parameter that the rows would have furthest from what was known of it, and by how many standard deviations.
    pub fn strain(&self, case: &Case) -> Option<(&Free, f64)> {
        let known = |free: &Free| case.study.parameters.iter().find(|one| one.name == free.name);
        let of = |free: &'_ Free| {
            let sd = known(free)?.sd.filter(|sd| *sd > 0.0)?;
            Some((free.asked - free.prior).abs() / sd)
        };
        let told = self.free.iter().filter(|free| case.tells(&free.name));
        told.filter_map(|free| Some((free, of(free)?))).max_by(|one, other| one.1.total_cmp(&other.1))
    }

    /// Whether all that was found is switched in each run by itself.
    pub fn is_switched_alone(&self) -> bool {
        let switched = |cured: &Cured| cured.cause.is_switched() && cured.takes_its_own_course();
        !self.causes.is_empty() && self.causes.iter().all(switched)
    }

    /// Takes everything back: no cause is left, and the free parameters are as they were known before.
    pub fn learn_nothing(&mut self, case: &Case) {
        self.causes.clear();
        for (free, known) in self.free.iter_mut().zip(&case.study.parameters) {
            let half = known.sd.map_or(f64::INFINITY, |sd| HALF_95 * sd);
            (free.value, free.asked) = (free.prior, free.prior);
            free.ci95 = [(free.prior - half).max(known.bounds.0), (free.prior + half).min(known.bounds.1)];
        }
    }

    /// The faults of sensors, with their sizes.
    pub fn artefacts(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let artefacts = self.causes.iter().filter(|cured| cured.cause.class == Class::Artefact);
        artefacts.filter_map(|cured| Some((cured.cause.id, cured.values.first()?.0)))
    }
}

impl Cured {
    /// The function, where it is one.
    pub fn function(&self) -> Option<&Function> {
        self.accepted.function.as_ref()
    }

    /// Why nothing of its kind is as it would have to be: consumers take, and draught grows with speed, if it depends on it. What stands in
    /// for something else may be found like that. Source of the second: ASABE D497.7.
    pub fn is_unlike_its_kind(&self) -> Option<&'static str> {
        let course = self.function().filter(|_| self.cause.id == ELECTRIC && self.cause.is_course());
        let gives = |course: &Function| {
            gives_more(course.values.iter().flat_map(|(powers_w, _)| powers_w.iter().copied()))
        };
        let gives = course.is_some_and(gives);
        let falls = self.cause.id == "drawbar_load"
            && self
                .cause
                .terms
                .iter()
                .zip(&self.values)
                .any(|(term, (_, ci95))| term.name == "linear_n_s_m" && ci95[1] < 0.0);
        if gives {
            Some("the consumer that was found would give back more than it takes, which none does")
        } else if falls {
            Some("the draught that was found would fall with speed, which none does")
        } else {
            None
        }
    }

    /// The cause with its function as every run tells its own part of it.
    pub fn along(&self) -> Self {
        let mut own = self.clone();
        if own.accepted.along.is_some() {
            own.accepted.function.clone_from(&own.accepted.along);
        }
        own
    }

    /// Its parameters without their intervals.
    pub fn values(&self) -> Vec<f64> {
        self.values.iter().map(|(value, _)| *value).collect()
    }
}

/// Values for everything that was accepted.
pub fn refine(
    case: &Case,
    system: &System,
    pool: &mut Pool,
    found: &Found,
) -> Result<Refined, DiagnoseError> {
    case.step("fitting")?;
    let beyond = widths(case, system, pool, found)?;
    let pool: &Pool = pool;
    let mut refined = linear(case, pool, found, &beyond);
    let physics: Vec<usize> = (0..refined.causes.len())
        .filter(|place| matches!(refined.causes[*place].cause.form, Form::Parameters | Form::Law))
        .collect();
    // Beside a function the linear estimate stands: it is joint with the function's.
    if refined.causes.iter().any(|cured| cured.function().is_some()) {
        return Ok(refined);
    }
    // No scenario has the small losses that were free beside what was found.
    let lossless = without_losses(pool, found);
    if let Some(found) = &lossless {
        refined = linear(case, pool, found, &beyond);
    }
    // The constants of a law are what its search made of them; beside a wind, which no sum of columns draws as it blows, it is fitted
    // by its amount.
    let law = refined.causes.iter().any(|cured| cured.cause.form == Form::Law);
    if law && !refined.causes.iter().any(|cured| is_whole(&cured.cause)) {
        return Ok(refined);
    }
    let found = lossless.as_ref().unwrap_or(found);
    let mut new: Vec<Cured> = physics.iter().map(|place| refined.causes[*place].clone()).collect();
    for cured in new.iter_mut().filter(|cured| is_whole(&cured.cause)) {
        mirror::lean(cured.values.iter_mut().map(|(value, _)| value));
    }
    let Fitted { fit: fitted, slots, mut mirrored } = match both_ways(case, system, pool, found, &new, None) {
        Ok(fitted) => fitted,
        Err(DiagnoseError::Interrupted) => return Err(DiagnoseError::Interrupted),
        // Where the fit runs into what the effects refuse, the linear estimate stands.
        Err(_) => return Ok(refined),
    };
    // What nothing measured tells apart a fit without limits puts anywhere: there the linear estimate stands as well, which
    // knows what was known before.
    let lost = |estimate: &Estimate, sd: f64| estimate.ci95[1] - estimate.ci95[0] > LOST * 2.0 * HALF_95 * sd;
    let of_slots: Vec<f64> = slots
        .iter()
        .map(|(place, term)| {
            let own = &new[*place];
            loosely(&own.cause, *term, own.values[*term].0).2
        })
        .collect();
    let count = refined.free.len();
    let (of_free, of_causes) = fitted.estimates.split_at(count);
    let free_lost = of_free.iter().any(|estimate| {
        estimate.prior_sd.is_some_and(|sd| (estimate.value - estimate.prior).abs() > FAR * sd)
    });
    let mut correlation = fitted.correlation.clone();
    let mut before = count;
    let of_causes = if free_lost || of_causes.iter().zip(&of_slots).any(|(one, sd)| lost(one, *sd)) {
        // What was found is then fitted once more beside the free parameters as they are: its columns were made beside
        // those of the scenario.
        let beside = refined.values();
        match both_ways(case, system, pool, found, &new, Some(&beside)) {
            Ok(fitted) => {
                mirrored = fitted.mirrored;
                (correlation, before) = (fitted.fit.correlation, 0);
                fitted.fit.estimates
            }
            Err(DiagnoseError::Interrupted) => return Err(DiagnoseError::Interrupted),
            Err(_) => return Ok(refined),
        }
    } else {
        for (own, estimate) in refined.free.iter_mut().zip(of_free) {
            (own.value, own.asked) = (estimate.value, estimate.value);
            own.ci95 = no_wider(widest(estimate.value, estimate.ci95, own.ci95), estimate);
        }
        of_causes.to_vec()
    };
    if of_causes.iter().zip(&of_slots).any(|(estimate, sd)| lost(estimate, *sd)) {
        return Ok(refined);
    }
    for ((place, term), estimate) in slots.iter().zip(&of_causes) {
        let own = &mut refined.causes[physics[*place]].values[*term];
        *own = (estimate.value, widest(estimate.value, estimate.ci95, own.1));
    }
    for (place, number) in physics.iter().enumerate() {
        let own: Vec<usize> = (0..slots.len()).filter(|slot| slots[*slot].0 == place).collect();
        let known = match own[..] {
            [one, other, ..] => correlation.get(before + one).and_then(|row| row.get(before + other)),
            _ => None,
        };
        refined.causes[*number].told_along(case, known.copied().unwrap_or(0.0));
    }
    if let Some((place, values)) = mirrored {
        refined.causes[physics[place]].mirrored = Some(values);
    }
    Ok(refined)
}

/// What was found, as it is estimated where the small losses of an electric drive are none; nothing where there are none to begin
/// with.
fn without_losses(pool: &Pool, found: &Found) -> Option<Found> {
    let own = pool.small.iter().filter(|(id, _)| id.starts_with(SMALL_LOSS));
    let positions: Vec<usize> =
        own.filter_map(|(_, column)| found.used.iter().position(|used| used == column)).collect();
    if positions.is_empty() {
        return None;
    }
    let mut other = found.clone();
    if other.stand.estimate.beta == other.estimate.beta {
        other.stand.estimate = other.stand.estimate.without(&positions)?;
    }
    other.estimate = other.estimate.without(&positions)?;
    Some(other)
}

/// The interval about a value as wide as the wider of two: the one fit holds small faults of sensors where they are, the
/// other lets them free but bends nothing.
fn widest(value: f64, one: [f64; 2], other: [f64; 2]) -> [f64; 2] {
    let half = |ci: [f64; 2]| 0.5 * (ci[1] - ci[0]);
    if half(one) >= half(other) { one } else { [value - half(other), value + half(other)] }
}

/// The interval of a free parameter no wider than what was known of it before: scatter between runs takes no knowledge away.
fn no_wider(ci95: [f64; 2], estimate: &Estimate) -> [f64; 2] {
    let half = HALF_95 * estimate.prior_sd.unwrap_or(f64::INFINITY);
    if ci95[1] - ci95[0] <= 2.0 * half { ci95 } else { [estimate.value - half, estimate.value + half] }
}

/// The linear estimate, shapes taken as known.
pub fn plain(case: &Case, pool: &Pool, found: &Found) -> Refined {
    let of = |accepted: &Accepted| vec![0.0; case.causes[accepted.trial.cause].terms.len()];
    let causes = found.accepted.iter().map(of).collect();
    linear(case, pool, found, &Beyond { causes, free: vec![0.0; case.study.parameters.len()] })
}

/// The linear estimate.
fn linear(case: &Case, pool: &Pool, found: &Found, beyond: &Beyond) -> Refined {
    let interval = |position: usize, value: f64| {
        let half = HALF_95 * found.estimate.covariance[(position, position)].sqrt();
        [value - half, value + half]
    };
    let parameters = case.study.parameters.iter().enumerate();
    let free = parameters.map(|(position, one)| {
        let value = (one.value + found.estimate.beta[position]).clamp(one.bounds.0, one.bounds.1);
        let known = found.estimate.covariance[(position, position)].sqrt();
        // No shape of a cause takes away what was known before.
        let most = one.sd.unwrap_or(f64::INFINITY).max(known);
        let half = HALF_95 * known.hypot(beyond.free[position]).min(most);
        let asked = one.value + found.stand.estimate.beta[position];
        let asked = if asked == one.value + found.estimate.beta[position] { value } else { asked };
        Free { name: one.name.clone(), prior: one.value, value, ci95: [value - half, value + half], asked }
    });
    let mut causes: Vec<Cured> = Vec::new();
    for (accepted, widths) in found.accepted.iter().zip(&beyond.causes) {
        let cause = case.causes[accepted.trial.cause].clone();
        let values = if cause.is_function() { Vec::new() } else { started(case, accepted, found, widths) };
        let correlation = correlated(accepted, found);
        let mut own = Cured::new(cause, accepted.clone(), values);
        own.told_along(case, correlation);
        causes.push(own);
    }
    for correction in &case.corrections {
        let Some((_, column)) = pool.corrected.iter().find(|(own, _)| *own == correction.id) else {
            continue;
        };
        // Its column is none of a trial, so its number is its place among those in use.
        let value = correction.value + found.estimate.beta[*column];
        let ci95 = interval(*column, value);
        // What may be none is no fault, nor is what may be no more than anybody would mind.
        let least = ci95[0].max(-ci95[1]).max(0.0);
        if least == 0.0 || is_no_fault(case, correction.id, least) {
            continue;
        }
        let values = vec![(value, ci95)];
        let accepted = correction.accepted.clone();
        let cause = case.causes[accepted.trial.cause].clone();
        causes.push(Cured::new(cause, accepted, values));
    }
    Refined { causes, free: free.collect(), null_space: Vec::new() }
}

/// Adds spells in single runs, those of each name as one cause, where any of them is in a run that was fitted: what is told by runs
/// that were held out is no finding.
pub fn spells(case: &Case, system: &System, events: &[Event], refined: &mut Refined) {
    let motion = system.kinds.iter().position(|kind| *kind == Kind::Motion);
    let Some(balance) = motion else { return };
    for (id, events) in named(&case.runs, events) {
        if !events.iter().any(|event| case.fit[event.run]) {
            continue;
        }
        let limit = if id == "braking" { limit_w(case, &events) } else { None };
        let mut cured = spelt(if limit.is_some() { "regeneration_limit" } else { id }, events, balance);
        if limit.is_none() && id == "braking" && is_gentle(case, &cured.events) {
            cured.accepted.rivals.extend(pull_instead(case, &cured.accepted));
        }
        if let ("drawbar_load", [event]) = (id, &cured.events[..])
            && in_one_place(case, Some(event.run), [event.from_s, event.to_s])
        {
            cured.accepted.rivals.extend(patch_instead(case, &cured.accepted));
        }
        let values = limit.map(|(value, sd)| (value, [value - HALF_95 * sd, value + HALF_95 * sd]));
        refined.causes.push(match values {
            Some(value) => Cured { values: vec![value], ..cured },
            None => cured,
        });
    }
}

/// Correlation of the two parts of a cause; none where it has one alone.
fn correlated(accepted: &Accepted, found: &Found) -> f64 {
    let place = |column: &usize| found.used.iter().position(|used| used == column);
    let places: Vec<usize> = accepted.trial.columns.iter().filter_map(place).collect();
    let [one, other] = places[..] else { return 0.0 };
    let covariance = &found.estimate.covariance;
    covariance[(one, other)] / (covariance[(one, one)] * covariance[(other, other)]).sqrt()
}

/// Whether spells hold a vehicle back as gently and as long as an implement on the ground does, so that nothing tells them from a
/// foot on the brake.
fn is_gentle(case: &Case, events: &[Event]) -> bool {
    /// Drivers brake harder [m/s²], or not as long [s].
    const GENTLE_M_S2: f64 = 0.5;
    const LONG_S: f64 = 5.0;
    let slows = |event: &Event| {
        case.nominal[event.run].first_mass_kg().map_or(f64::INFINITY, |mass_kg| event.force_n / mass_kg)
    };
    let lasts: Vec<f64> = events.iter().map(|event| event.to_s - event.from_s).collect();
    median(&lasts) > LONG_S && median(&events.iter().map(slows).collect::<Vec<_>>()) < GENTLE_M_S2
}

/// A pull in the place of brakes, which says as much.
fn pull_instead(case: &Case, brakes: &Accepted) -> Option<Rival> {
    let pull = |cause: &Cause| cause.id == "drawbar_load" && cause.window().is_none() && cause.run.is_none();
    let cause = case.causes.iter().position(pull)?;
    Some(Rival { cause, gain: brakes.gain, squared_correlation: 1.0, free: Vec::new() })
}

/// Softer ground in the place of a pull, which says as much.
fn patch_instead(case: &Case, pull: &Accepted) -> Option<Rival> {
    let cause = case.causes.iter().position(Cause::is_patch)?;
    Some(Rival { cause, gain: pull.gain, squared_correlation: 1.0, free: Vec::new() })
}

/// Spells of one name as a cause.
fn spelt(id: &'static str, events: Vec<Event>, balance: usize) -> Cured {
    let longest = |event: &Event| event.to_s - event.from_s;
    let whole: f64 = events.iter().map(longest).sum();
    let mean = events.iter().map(|event| event.force_n * longest(event)).sum::<f64>() / whole.max(1e-9);
    let sd = events.iter().map(|event| event.sd_n).fold(0.0, f64::max);
    let trial = Trial::new(0, &[], Vec::new(), Vec::new());
    let accepted = Accepted {
        trial,
        gain: events.iter().map(|event| event.gain).fold(0.0, f64::max),
        by_chance: LEAST_GAIN,
        rivals: Vec::new(),
        function: None,
        along: None,
        balance,
    };
    let values = vec![(mean, [mean - HALF_95 * sd, mean + HALF_95 * sd])];
    Cured { events, ..Cured::new(spell(id), accepted, values) }
}

/// A parameter of a new cause: which cause, which term.
type Slot = (usize, usize);

/// What a term of a cause may be in a fit, and how far it is from known: value, limits, standard deviation.
fn loosely(cause: &Cause, term: usize, value: f64) -> (f64, (f64, f64), f64) {
    let term = &cause.terms[term];
    if term.linear {
        let sd = if is_whole(cause) { term.scale } else { 4.0 * term.scale };
        return (value.clamp(term.low, term.high), (term.low, term.high), sd);
    }
    // A shape is known about as well as its grid is spaced, which may reach further than it can be.
    let value = value.clamp(term.low, term.high);
    let limits = ((0.2 * value).max(term.low), (5.0 * value).min(term.high));
    (value, limits, 0.6 * value.abs())
}

/// A fit of causes.
struct Fitted {
    fit: Fit,
    slots: Vec<Slot>,
    /// A cause, and values of it that explain as much.
    mirrored: Option<(usize, Vec<f64>)>,
}

/// Fits causes, and those that may be seen in a mirror once more from there: the better one of both.
fn both_ways(
    case: &Case,
    system: &System,
    pool: &Pool,
    found: &Found,
    new: &[Cured],
    held: Option<&[f64]>,
) -> Result<Fitted, DiagnoseError> {
    let (fit, slots) = nonlinear(case, system, pool, found, new, held)?;
    let own = Fitted { fit, slots, mirrored: None };
    let place = new.iter().position(|cured| is_whole(&cured.cause));
    let (Some(place), Some(axis_rad)) = (place, mirror::axis_rad(case)) else { return Ok(own) };
    let values_of = |fitted: &Fitted| -> Vec<f64> {
        let count = fitted.fit.estimates.len() - fitted.slots.len();
        let estimates = fitted.slots.iter().zip(&fitted.fit.estimates[count..]);
        estimates.filter(|((own, _), _)| *own == place).map(|(_, estimate)| estimate.value).collect()
    };
    let mut turned = new.to_vec();
    let start = mirror::mirrored(&values_of(&own), axis_rad);
    for (own, value) in turned[place].values.iter_mut().zip(&start) {
        own.0 = *value;
    }
    let (fit, slots) = match nonlinear(case, system, pool, found, &turned, held) {
        Ok(fitted) => fitted,
        Err(DiagnoseError::Interrupted) => return Err(DiagnoseError::Interrupted),
        Err(_) => return Ok(own),
    };
    let other = Fitted { fit, slots, mirrored: None };
    let (mut better, lesser) =
        if other.fit.cost_after < own.fit.cost_after { (other, own) } else { (own, other) };
    if lesser.fit.cost_after - better.fit.cost_after < mirror::AS_GOOD {
        better.mirrored = Some((place, values_of(&lesser)));
    }
    Ok(better)
}

/// Fits causes together with the free parameters, or beside them where they are held.
fn nonlinear(
    case: &Case,
    system: &System,
    pool: &Pool,
    found: &Found,
    new: &[Cured],
    held: Option<&[f64]>,
) -> Result<(Fit, Vec<Slot>), DiagnoseError> {
    let mut parameters: Vec<Parameter> =
        if held.is_some() { Vec::new() } else { case.study.parameters.clone() };
    let (free, count) = (parameters.len(), case.study.parameters.len());
    let mut slots: Vec<Slot> = Vec::new();
    for (place, cured) in new.iter().enumerate() {
        for (index, term) in cured.cause.terms.iter().enumerate() {
            let value = cured.values[index].0;
            let needed = if term.linear {
                is_whole(&cured.cause) || cured.accepted.trial.terms.contains(&index)
            } else {
                value != 0.0 && !term.is_held()
            };
            if needed {
                let (value, (low, high), sd) = loosely(&cured.cause, index, value);
                let (from, to) = cured.cause.within(index, &cured.values());
                let bounds = (low.max(from), high.min(to));
                slots.push((place, index));
                parameters.push(Parameter { name: term.name.to_owned(), value, sd: Some(sd), bounds });
            }
        }
    }
    let whiteners = found.noises.1.whiteners(&system.chunks);
    // Small faults of sensors and corrections keep their linear estimate: fitted freely they would shrink the noise
    // along with the signal. So do faults that are accepted, of which no model says anything.
    let mut small: Vec<(&Column, f64)> =
        (count..pool.nuisance).map(|column| (&pool.columns[column], found.estimate.beta[column])).collect();
    for accepted in found.accepted.iter().filter(|one| case.causes[one.trial.cause].form == Form::Measured) {
        let own = accepted.trial.columns.iter().filter_map(|column| {
            let place = found.used.iter().position(|used| used == column)?;
            Some((&pool.columns[*column], found.estimate.beta[place]))
        });
        small.extend(own);
    }
    let evaluate = |x: &[f64]| -> Result<Residuals, DiagnoseError> {
        let mut effects: Vec<(Cause, Vec<f64>)> =
            new.iter().map(|cured| (cured.cause.clone(), cured.values())).collect();
        for ((place, index), value) in slots.iter().zip(&x[free..]) {
            effects[*place].1[*index] = *value;
        }
        let said = said_with_all(case, &case.runs, &effects, held.unwrap_or(&x[..free]))?;
        let residual = system.residual_of(&case.runs, &said);
        let mut clusters: Residuals = Vec::new();
        let mut cluster_of: Vec<usize> = Vec::new();
        for (index, chunk) in system.chunks.iter().enumerate().filter(|(_, chunk)| case.fit[chunk.run]) {
            let values = small
                .iter()
                .fold(residual[index].clone(), |left, (column, size)| left - &column[index] * *size);
            let values = values * as_heavy(case, system.kind(chunk), chunk.run, &said[chunk.run]);
            let white = match &whiteners {
                Some(whiteners) => whiteners.white(index, chunk, &values),
                None => values,
            };
            if let Some(cluster) = cluster_of.iter().position(|run| *run == chunk.run) {
                clusters[cluster].extend(white.iter());
            } else {
                cluster_of.push(chunk.run);
                clusters.push(white.iter().copied().collect());
            }
        }
        Ok(clusters)
    };
    Ok((fit(&parameters, evaluate)?, slots))
}

/// What makes a residual that of as heavy a vehicle as the nominal one. What is left of the forces is mass times what is left
/// of the acceleration: a lighter vehicle would have less of it by being lighter, and a fit would take that for the better.
fn as_heavy(case: &Case, kind: Kind, run: usize, said: &Said) -> f64 {
    if kind != Kind::Motion {
        return 1.0;
    }
    let mean = |said: &Said| -> f64 {
        let known = || said.effective_mass_kg.iter().filter(|mass| mass.is_finite());
        known().sum::<f64>() / known().count() as f64
    };
    let ratio = mean(&case.nominal[run]) / mean(said);
    if ratio.is_finite() { ratio } else { 1.0 }
}

/// The linear estimate of a cause's parameters, as wide as its shape leaves it.
fn started(case: &Case, accepted: &Accepted, found: &Found, widths: &Widths) -> Vec<(f64, [f64; 2])> {
    let cause = &case.causes[accepted.trial.cause];
    let mut shape = accepted.trial.shape.iter();
    let one = |(index, term): (usize, &Term)| {
        if !term.linear {
            let value = shape.next().copied().unwrap_or(1.0);
            let half = HALF_95 * widths[index];
            return (value, [value - half, value + half]);
        }
        let place = accepted.trial.terms.iter().position(|own| *own == index);
        let column = place.map(|place| accepted.trial.columns[place]);
        let position = column.and_then(|column| found.used.iter().position(|used| *used == column));
        let Some(position) = position else { return (0.0, [0.0; 2]) };
        let value = found.estimate.beta[position];
        let half = HALF_95 * found.estimate.covariance[(position, position)].sqrt().hypot(widths[index]);
        (value, [value - half, value + half])
    };
    cause.terms.iter().enumerate().map(one).collect()
}

/// What the model says with several effects.
pub fn said_with_all(
    case: &Case,
    runs: &[Recorded],
    effects: &[(Cause, Vec<f64>)],
    values: &[f64],
) -> Result<Vec<Said>, DiagnoseError> {
    let scenario_for = |run: &Recorded| -> Result<Scenario, DiagnoseError> {
        let mut document = case.study.scenario().document().clone();
        for (cause, values) in effects {
            document = document.with_effect(&for_run(&cause.written(values), cause, run))?;
        }
        Ok(Scenario::of(document, case.registry)?)
    };
    if effects.iter().any(|(cause, _)| cause.id == "multipass" || cause.run.is_some()) {
        let scenarios: Vec<Scenario> = runs.iter().map(scenario_for).collect::<Result<_, _>>()?;
        return said(runs, &case.kinds, |run| {
            Ok(case.study.model_of(&scenarios[run], &runs[run].measured, values)?)
        });
    }
    let scenario = match runs.first() {
        Some(first) => scenario_for(first)?,
        None => case.study.scenario().clone(),
    };
    case.said_of(runs, &scenario, values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::causes::catalogue::{Around, causes};

    /// The grid of a cold engine reaches to 900 s, and runs of 40 s tell no more than 120 s.
    #[test]
    fn a_shape_beyond_what_it_can_be_is_fitted_within_it() {
        let all =
            causes(&Around { duration_s: 40.0, mass_kg: 1000.0, gravity_m_s2: 9.81, ..Around::default() });
        let cold = all.iter().find(|cause| cause.id == "cold_start").unwrap();
        let (value, (low, high), _) = loosely(cold, 1, 900.0);
        assert!(low < high && (low..=high).contains(&value), "{value} between {low} and {high}");
    }
}
