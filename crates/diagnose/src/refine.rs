//! The accepted causes fitted once more without linearising, together with the free parameters.

use crate::balance::{Balance, Drive0, Kind};
use crate::catalogue::{Cause, Class, Form};
use crate::noise::Noise;
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
        let fitted = nonlinear(case, balance, pool, found, &free, &causes, &new)?;
        let count = parameters.len();
        for (own, estimate) in free.iter_mut().zip(&fitted.estimates[..count]) {
            // A balance that does not see a parameter leaves it as it was.
            let width = |ci: [f64; 2]| ci[1] - ci[0];
            if width(estimate.ci95) < width(own.3) || !width(own.3).is_finite() {
                (own.2, own.3) = (estimate.value, estimate.ci95);
            }
        }
        let mut rest = fitted.estimates[count..].iter();
        for accepted in new {
            let cause = case.causes[accepted.trial.cause].clone();
            let values = rest.by_ref().take(cause.terms.len()).map(|one| (one.value, one.ci95)).collect();
            causes.push(Cured { cause, balance: index, accepted: accepted.clone(), values, function: None });
        }
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
    for (position, own) in free.iter_mut().enumerate().take(pool.nuisance) {
        let bounds = case.study.parameters[position].bounds;
        own.2 = (own.1 + found.estimate.beta[position]).clamp(bounds.0, bounds.1);
        own.3 = interval(position, own.2);
    }
    for accepted in &found.accepted {
        let cause = case.causes[accepted.trial.cause].clone();
        let mut values = Vec::new();
        if accepted.function.is_none() {
            let mut columns = accepted.trial.columns.iter();
            let mut shape = accepted.trial.shape.iter();
            for term in &cause.terms {
                if term.linear {
                    let position = columns.next().and_then(|column| found.used.iter().position(|one| one == column));
                    let value = position.map_or(0.0, |position| found.estimate.beta[position]);
                    values.push((value, position.map_or([value; 2], |position| interval(position, value))));
                } else {
                    let value = shape.next().copied().unwrap_or(1.0);
                    values.push((value, [value; 2]));
                }
            }
        }
        causes.push(Cured {
            cause,
            balance: index,
            accepted: accepted.clone(),
            values,
            function: accepted.function.clone(),
        });
    }
}

fn nonlinear(
    case: &Case,
    balance: &Balance,
    pool: &Pool,
    found: &Found,
    free: &[(String, f64, f64, [f64; 2])],
    before: &[Cured],
    new: &[&Accepted],
) -> Result<Fit, DiagnoseError> {
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
    for accepted in new {
        let cause = &case.causes[accepted.trial.cause];
        let mut columns = accepted.trial.columns.iter();
        let mut shape = accepted.trial.shape.iter();
        for term in &cause.terms {
            let (value, sd) = if term.linear {
                let position = columns.next().and_then(|column| found.used.iter().position(|one| one == column));
                (position.map_or(0.0, |position| found.estimate.beta[position]), Some(4.0 * term.scale))
            } else {
                let value = shape.next().copied().unwrap_or(1.0);
                // A shape is known about as well as its grid is spaced; where it is no parameter it stays.
                (value, Some((0.6 * value.abs()).max(1e-9)))
            };
            let low = if term.positive { 0.0 } else { f64::NEG_INFINITY };
            let (low, high) = if term.linear { (low, f64::INFINITY) } else { (0.2 * value, 5.0 * value) };
            let bounds = if low < high { (low, high) } else { (value - 1e-9, value + 1e-9) };
            parameters.push(Parameter { name: term.name.to_owned(), value: value.max(low), sd, bounds });
        }
    }
    let whitener_noise: Noise = found.noise.1;
    let whitener = whitener_noise.whitener(&balance.chunks);
    let evaluate = |x: &[f64]| -> Result<Residuals, DiagnoseError> {
        let mut drives: Option<Vec<Drive0>> = None;
        let mut texts: Vec<(Cause, Vec<f64>)> = before
            .iter()
            .filter(|cured| cured.function.is_none() && cured.cause.class == Class::Physics)
            .map(|cured| (cured.cause.clone(), cured.values.iter().map(|(value, _)| *value).collect()))
            .collect();
        let mut rest = &x[count..];
        for accepted in new {
            let cause = &case.causes[accepted.trial.cause];
            let (own, others) = rest.split_at(cause.terms.len());
            rest = others;
            if cause.form == Form::Measured {
                drives = Some(corrected(case, cause.id, own[0])?);
            } else {
                texts.push((cause.clone(), own.to_vec()));
            }
        }
        let drives = drives.as_deref().unwrap_or(&case.drives);
        let said = said_with_all(case, drives, &texts, &x[..count])?;
        let residual = balance.residual_of(drives, &said);
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
            match cluster_of.iter().position(|run| *run == chunk.run) {
                Some(cluster) => clusters[cluster].extend(white.iter()),
                None => {
                    cluster_of.push(chunk.run);
                    clusters.push(white.iter().copied().collect());
                }
            }
        }
        Ok(clusters)
    };
    let _ = pool;
    fit(&parameters, evaluate)
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
