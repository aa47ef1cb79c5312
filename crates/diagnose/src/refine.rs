//! The accepted causes fitted once more without linearising, together with the free parameters.

use crate::balance::{Balance, Drive0, Kind};
use crate::catalogue::{Cause, Class, Form, spell};
use crate::events::{Event, LEAST_GAIN, name};
use crate::profile::Function;
use crate::search::{Accepted, Found};
use crate::trial::{Pool, corrected, for_run};
use crate::{Case, DiagnoseError};
use headland_calibrate::fit::{Fit, Parameter, Residuals, fit};
use headland_scenario::Scenario;
use nalgebra::DVector;

/// A cause with its values.
#[derive(Clone, Debug)]
pub struct Cured {
    /// The cause.
    pub cause: Cause,
    /// Index of the balance in which it was found.
    pub balance: usize,
    /// How it was accepted.
    pub accepted: Accepted,
    /// Its parameters in the order of its terms, with 95 % intervals; empty for a function.
    pub values: Vec<(f64, [f64; 2])>,
    /// The function, where it is one.
    pub function: Option<Function>,
    /// Spells in single runs, where it is some.
    pub events: Vec<Event>,
}

/// Everything that was found, with values.
pub struct Refined {
    /// The causes, in the order of the balances.
    pub causes: Vec<Cured>,
    /// The free parameters: name, prior, value, 95 % interval.
    pub free: Vec<(String, f64, f64, [f64; 2])>,
    /// What the data cannot separate.
    pub null_space: Vec<String>,
}

impl Refined {
    /// Values of the free parameters.
    pub fn values(&self) -> Vec<f64> {
        self.free.iter().map(|(_, _, value, _)| *value).collect()
    }
}

/// An effect so many times its usual size is none of this kind.
const MOST_SIZES: f64 = 10.0;

/// Fits balance after balance; what an earlier one found stays for the later ones.
pub fn refine(
    case: &Case,
    balances: &[Balance],
    pools: &[Pool],
    found: &[Option<Found>],
) -> Result<Refined, DiagnoseError> {
    let parameters = case.study.parameters.clone();
    let mut free: Vec<(String, f64, f64, [f64; 2])> = parameters
        .iter()
        .map(|one| {
            let sd = one.sd.unwrap_or(f64::INFINITY);
            (one.name.clone(), one.value, one.value, [one.value - 1.96 * sd, one.value + 1.96 * sd])
        })
        .collect();
    let mut causes: Vec<Cured> = Vec::new();
    let mut null_space = Vec::new();
    for (index, (balance, (pool, found))) in balances.iter().zip(pools.iter().zip(found)).enumerate() {
        let Some(found) = found else { continue };
        case.progress.step("fitting");
        let function = found.accepted.iter().find(|one| one.function.is_some());
        let new: Vec<&Accepted> = found.accepted.iter().collect();
        if function.is_some() {
            linear(case, balance, index, pool, found, &mut free, &mut causes);
            continue;
        }
        let moved = [Kind::Motion, Kind::Battery, Kind::Fuel].contains(&balance.kind);
        if new.is_empty() && !moved {
            continue;
        }
        let (fitted, cured) = nonlinear(case, balance, found, &free, &causes, &new)?;
        for (own, estimate) in free.iter_mut().zip(&fitted.estimates[..parameters.len()]) {
            // A balance that does not see a parameter leaves it as it was.
            let width = |ci: [f64; 2]| ci[1] - ci[0];
            if width(estimate.ci95) < width(own.3) || !width(own.3).is_finite() {
                (own.2, own.3) = (estimate.value, estimate.ci95);
            }
        }
        causes.extend(cured.into_iter().map(|one| Cured { balance: index, ..one }));
        null_space.extend(fitted.null_space);
    }
    null_space.sort_unstable();
    null_space.dedup();
    Ok(Refined { causes, free, null_space })
}

/// With a function the linear estimate stands.
fn linear(
    case: &Case,
    balance: &Balance,
    index: usize,
    pool: &Pool,
    found: &Found,
    free: &mut [(String, f64, f64, [f64; 2])],
    causes: &mut Vec<Cured>,
) {
    let _ = balance;
    let interval = |position: usize, value: f64| {
        let sd = found.estimate.covariance[(position, position)].sqrt();
        [value - 1.96 * sd, value + 1.96 * sd]
    };
    for (position, own) in free.iter_mut().enumerate().take(pool.nuisance.min(case.study.parameters.len())) {
        let bounds = case.study.parameters[position].bounds;
        own.2 = (own.1 + found.estimate.beta[position]).clamp(bounds.0, bounds.1);
        own.3 = interval(position, own.2);
    }
    for accepted in &found.accepted {
        let cause = case.causes[accepted.trial.cause].clone();
        let values = if accepted.function.is_none() { started(case, accepted, found) } else { Vec::new() };
        causes.push(Cured {
            cause,
            balance: index,
            accepted: accepted.clone(),
            values,
            function: accepted.function.clone(),
            events: Vec::new(),
        });
    }
}

/// Adds spells in single runs as one cause.
pub fn spells(case: &Case, balances: &[Balance], events: &[Event], refined: &mut Refined) {
    let motion = balances.iter().position(|balance| balance.kind == Kind::Motion);
    let (Some(balance), Some(strongest)) = (motion, events.iter().map(|event| event.gain).reduce(f64::max))
    else {
        return;
    };
    let cause = spell(name(&case.drives, events));
    let longest = |event: &Event| event.to_s - event.from_s;
    let whole: f64 = events.iter().map(longest).sum();
    let mean = events.iter().map(|event| event.force_n * longest(event)).sum::<f64>() / whole.max(1e-9);
    let sd = events.iter().map(|event| event.sd_n).fold(0.0, f64::max);
    let trial = crate::trial::Trial { cause: 0, shape: Vec::new(), columns: Vec::new(), terms: Vec::new() };
    refined.causes.push(Cured {
        cause,
        balance,
        accepted: Accepted {
            trial,
            gain: strongest,
            by_chance: LEAST_GAIN,
            rivals: Vec::new(),
            function: None,
        },
        values: vec![(mean, [mean - 1.96 * sd, mean + 1.96 * sd])],
        function: None,
        events: events.to_vec(),
    });
}

/// The non-linear parameters of one cause, fitted without any other.
pub fn shape(
    case: &Case,
    balance: &Balance,
    found: &Found,
    accepted: &Accepted,
) -> Result<Vec<f64>, DiagnoseError> {
    let free: Vec<(String, f64, f64, [f64; 2])> =
        case.study.parameters.iter().map(|one| (one.name.clone(), one.value, one.value, [0.0; 2])).collect();
    let (_, cured) = nonlinear(case, balance, found, &free, &[], &[accepted])?;
    let Some(cured) = cured.first() else { return Ok(accepted.trial.shape.clone()) };
    let held = cured.cause.terms.iter().zip(&cured.values).filter(|(term, _)| !term.linear);
    Ok(held.map(|(_, (value, _))| *value).collect())
}

/// A parameter of a new cause: which cause, which term.
type Slot = (usize, usize);

#[allow(clippy::too_many_lines, reason = "one problem, set up and solved")]
fn nonlinear(
    case: &Case,
    balance: &Balance,
    found: &Found,
    free: &[(String, f64, f64, [f64; 2])],
    before: &[Cured],
    new: &[&Accepted],
) -> Result<(Fit, Vec<Cured>), DiagnoseError> {
    let mut parameters: Vec<Parameter> = case.study.parameters.clone();
    for (index, parameter) in parameters.iter_mut().enumerate() {
        // An earlier balance has already said something: that is the prior now.
        let (_, prior, value, ci) = &free[index];
        if value != prior {
            parameter.value = value.clamp(parameter.bounds.0, parameter.bounds.1);
            parameter.sd = Some(((ci[1] - ci[0]) / 3.92).max(1e-12));
        }
    }
    let count = parameters.len();
    let start: Vec<Vec<(f64, [f64; 2])>> =
        new.iter().map(|accepted| started(case, accepted, found)).collect();
    let mut slots: Vec<Slot> = Vec::new();
    for (place, accepted) in new.iter().enumerate() {
        let cause = &case.causes[accepted.trial.cause];
        if cause.form == Form::Measured {
            continue;
        }
        for (index, term) in cause.terms.iter().enumerate() {
            let value = start[place][index].0;
            if term.linear && !accepted.trial.terms.contains(&index) || !term.linear && value == 0.0 {
                continue;
            }
            let (low, high, sd) = if term.linear {
                let low = if term.positive { 0.0 } else { -MOST_SIZES * term.scale };
                (low, MOST_SIZES * term.scale, 4.0 * term.scale)
            } else {
                // A shape is known about as well as its grid is spaced.
                (0.2 * value, 5.0 * value, 0.6 * value.abs())
            };
            slots.push((place, index));
            let value = value.clamp(low.min(high), high.max(low));
            parameters.push(Parameter {
                name: term.name.to_owned(),
                value,
                sd: Some(sd),
                bounds: (low, high),
            });
        }
    }
    // A sensor's fault keeps its linear estimate: fitted freely it would shrink the noise along with the signal.
    let mut drives: Vec<Drive0> = case.drives.clone();
    let faults = before.iter().filter(|cured| cured.cause.form == Form::Measured);
    for cured in faults {
        drives = corrected(&drives, cured.cause.id, cured.values[0].0)?;
    }
    for (place, accepted) in new.iter().enumerate() {
        let cause = &case.causes[accepted.trial.cause];
        if cause.form == Form::Measured {
            drives = corrected(&drives, cause.id, start[place][0].0)?;
        }
    }
    let whitener = found.noise.1.whitener(&balance.chunks);
    let filled = |x: &[f64]| -> Vec<Vec<f64>> {
        let mut all: Vec<Vec<f64>> =
            start.iter().map(|values| values.iter().map(|(value, _)| *value).collect()).collect();
        for ((place, index), value) in slots.iter().zip(&x[count..]) {
            all[*place][*index] = *value;
        }
        all
    };
    let evaluate = |x: &[f64]| -> Result<Residuals, DiagnoseError> {
        let mut texts: Vec<(Cause, Vec<f64>)> = before
            .iter()
            .filter(|cured| cured.function.is_none() && cured.cause.class == Class::Physics)
            .map(|cured| (cured.cause.clone(), cured.values.iter().map(|(value, _)| *value).collect()))
            .collect();
        for (accepted, values) in new.iter().zip(filled(x)) {
            let cause = &case.causes[accepted.trial.cause];
            if cause.form != Form::Measured {
                texts.push((cause.clone(), values));
            }
        }
        let said = said_with_all(case, &drives, &texts, &x[..count])?;
        let residual = balance.residual_of(&drives, &said);
        let mut clusters: Residuals = Vec::new();
        let mut cluster_of: Vec<usize> = Vec::new();
        for (chunk, values) in balance.chunks.iter().zip(&residual) {
            if !case.fit[chunk.run] {
                continue;
            }
            let white: DVector<f64> = match &whitener {
                Some(whitener) => whitener.whiten(chunk, values),
                None => values.clone(),
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
    let fitted = fit(&parameters, evaluate)?;
    let mut cured: Vec<Cured> = new
        .iter()
        .zip(&start)
        .map(|(accepted, values)| Cured {
            cause: case.causes[accepted.trial.cause].clone(),
            balance: 0,
            accepted: (*accepted).clone(),
            values: values.clone(),
            function: None,
            events: Vec::new(),
        })
        .collect();
    for ((place, index), estimate) in slots.iter().zip(&fitted.estimates[count..]) {
        cured[*place].values[*index] = (estimate.value, estimate.ci95);
    }
    Ok((fitted, cured))
}

/// The linear estimate of a cause's parameters.
fn started(case: &Case, accepted: &Accepted, found: &Found) -> Vec<(f64, [f64; 2])> {
    let cause = &case.causes[accepted.trial.cause];
    let mut shape = accepted.trial.shape.iter();
    let one = |(index, term): (usize, &crate::catalogue::Term)| {
        if !term.linear {
            let value = shape.next().copied().unwrap_or(1.0);
            return (value, [value; 2]);
        }
        let place = accepted.trial.terms.iter().position(|own| *own == index);
        let column = place.map(|place| accepted.trial.columns[place]);
        let position = column.and_then(|column| found.used.iter().position(|used| *used == column));
        let Some(position) = position else { return (0.0, [0.0; 2]) };
        let value = found.estimate.beta[position];
        let value = if term.positive { value.max(0.0) } else { value };
        let half = 1.96 * found.estimate.covariance[(position, position)].sqrt();
        (value, [value - half, value + half])
    };
    cause.terms.iter().enumerate().map(one).collect()
}

/// What the model says with several effects.
pub fn said_with_all(
    case: &Case,
    drives: &[Drive0],
    effects: &[(Cause, Vec<f64>)],
    values: &[f64],
) -> Result<Vec<crate::balance::Said>, DiagnoseError> {
    let per_run = effects.iter().any(|(cause, _)| cause.id == "multipass");
    let scenario_for = |run: &Drive0| -> Result<Scenario, DiagnoseError> {
        let mut document = case.study.scenario().document().clone();
        for (cause, values) in effects {
            document = document.with_effect(&for_run(&cause.written(values), cause, run))?;
        }
        Ok(Scenario::of(document, case.registry)?)
    };
    if per_run {
        let scenarios: Vec<Scenario> = drives.iter().map(scenario_for).collect::<Result<_, _>>()?;
        let model = |run: usize| Ok(case.study.model_of(&scenarios[run], &drives[run].measured, values)?);
        return crate::balance::said(case.registry, drives, &case.kinds, model, |_| None);
    }
    let scenario = match drives.first() {
        Some(first) => scenario_for(first)?,
        None => case.study.scenario().clone(),
    };
    case.said_of(drives, &scenario, values)
}
