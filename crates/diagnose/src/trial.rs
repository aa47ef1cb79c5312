//! Causes turned into regressors: each effect is put into the scenario, every run is driven with it, and what the
//! model then says differently is the column.

use crate::balance::{Balance, Drive0, Kind, Said, change, column};
use crate::catalogue::{Cause, Form};
use crate::gram::Column;
use crate::{Case, DiagnoseError};
use headland_sim::local_fit;
use headland_trace::{Channel, Trace};
use headland_units::constants::STANDARD_GRAVITY_M_S2;
use nalgebra::DVector;

/// Regressors of one balance.
pub struct Pool {
    /// The columns: free parameters first, then the trials'.
    pub columns: Vec<Column>,
    /// Prior standard deviation of each column's parameter.
    pub sd: Vec<f64>,
    /// How many are free parameters.
    pub nuisance: usize,
    /// The trials.
    pub trials: Vec<Trial>,
}

/// A cause with its non-linear parameters held.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Which cause.
    pub cause: usize,
    /// Its non-linear parameters.
    pub shape: Vec<f64>,
    /// Its columns, or the one signature of a function.
    pub columns: Vec<usize>,
    /// Which of the cause's terms each column stands for; the other linear ones are zero.
    pub terms: Vec<usize>,
}

/// A change of a free parameter for its column, as a share of its standard deviation.
const NUISANCE_STEP: f64 = 0.3;
/// A change of an effect's parameter for its column, as a share of its usual size.
const CAUSE_STEP: f64 = 0.5;
/// A column weaker than this share of the residual says nothing.
const WEAKEST: f64 = 1e-7;

/// Columns of the free parameters and of all causes, one pool for each balance.
pub fn pools(case: &Case, balances: &[Balance], causes: &[Cause]) -> Result<Vec<Pool>, DiagnoseError> {
    let empty = |_: &Balance| Pool { columns: Vec::new(), sd: Vec::new(), nuisance: 0, trials: Vec::new() };
    let mut pools: Vec<Pool> = balances.iter().map(empty).collect();
    let priors = case.study.priors();
    for (index, parameter) in case.study.parameters.iter().enumerate() {
        let sd = parameter.sd.unwrap_or_else(|| wide(parameter.value, parameter.bounds));
        let mut step = NUISANCE_STEP * sd;
        if parameter.value + step > parameter.bounds.1 {
            step = -step;
        }
        let mut values = priors.clone();
        values[index] = (values[index] + step).clamp(parameter.bounds.0, parameter.bounds.1);
        let step = values[index] - priors[index];
        let after = case.said(case.study.scenario(), &values)?;
        for (balance, pool) in balances.iter().zip(&mut pools) {
            pool.columns.push(difference(case, balance, &after, step));
            pool.sd.push(sd);
            pool.nuisance += 1;
        }
    }
    small_faults(case, balances, &mut pools)?;
    for (number, cause) in causes.iter().enumerate() {
        case.progress.step(cause.id);
        if case.progress.interrupted() {
            return Err(DiagnoseError::Interrupted);
        }
        if cause.form == Form::Measured {
            measured(case, balances, &mut pools, number, cause)?;
            continue;
        }
        for shape in &cause.shapes {
            add_trial(case, balances, &mut pools, number, shape)?;
        }
    }
    Ok(pools)
}

/// Adds a trial of a cause with these non-linear parameters.
pub fn add_trial(
    case: &Case,
    balances: &[Balance],
    pools: &mut [Pool],
    number: usize,
    shape: &[f64],
) -> Result<(), DiagnoseError> {
    let cause = &case.causes[number];
    let priors = case.study.priors();
    let mut found: Vec<Vec<Part>> = balances.iter().map(|_| Vec::new()).collect();
    for (term, part) in cause.terms.iter().enumerate().filter(|(_, term)| term.linear) {
        let step = CAUSE_STEP * part.scale;
        let text = |run: &Drive0| signature(cause, term, step, shape, run);
        let after = case.said_with(&text, &priors)?;
        for (balance, found) in balances.iter().zip(&mut found) {
            if tried_on(cause, balance.kind, balances) {
                let column = difference(case, balance, &after, step);
                found.push(Part { column, scale: part.scale, term });
            }
        }
    }
    for ((balance, pool), found) in balances.iter().zip(pools.iter_mut()).zip(found) {
        add(balance, pool, number, shape, found);
    }
    Ok(())
}

/// The body pitches on its tyres while it speeds up, and the accelerometer with it.
const PITCH: &str = "pitch";
/// How much, usually [rad s²/m]: 0.0015 to 0.0023 rad at 0.7 m/s², for a tractor 1.3 m high on 3.6 m of wheelbase.
const PITCH_RAD_S2_M: f64 = 0.004;

/// What every sensor does a little: half a sampling period of latency, half a per cent of scale. Nobody would call it a
/// fault, and it must not be taken for physics; so it is free in every balance.
fn small_faults(case: &Case, balances: &[Balance], pools: &mut [Pool]) -> Result<(), DiagnoseError> {
    const SCALE: f64 = 0.005;
    let period_s =
        |drive: &Drive0| drive.measured.trace.duration_s() / (drive.measured.trace.len().max(2) - 1) as f64;
    let period_s = case.drives.iter().map(period_s).fold(0.0, f64::max);
    let small = [
        (Kind::Motion, "latency", 0.5 * period_s),
        (Kind::Motion, "force_scale", SCALE),
        (Kind::Motion, "speed_scale", SCALE),
        (Kind::Parity, PITCH, PITCH_RAD_S2_M),
    ];
    for (kind, id, sd) in small {
        if !balances.iter().any(|balance| balance.kind == kind) {
            continue;
        }
        let columns = fault(case, balances, id, sd)?;
        for ((balance, pool), column) in balances.iter().zip(pools.iter_mut()).zip(columns) {
            if balance.kind != kind {
                continue;
            }
            pool.columns.push(column);
            pool.sd.push(sd);
            pool.nuisance += 1;
        }
    }
    Ok(())
}

/// Whether a cause is tried on a balance: causes of motion are looked for in powers only where no force was measured.
fn tried_on(cause: &Cause, kind: Kind, balances: &[Balance]) -> bool {
    let has = |kind: Kind| balances.iter().any(|balance| balance.kind == kind);
    let power = matches!(kind, Kind::Battery | Kind::Fuel);
    cause.balances.contains(&kind) && !(power && cause.balances.contains(&Kind::Motion) && has(Kind::Motion))
}

/// A standard deviation for a parameter of which nothing is known.
fn wide(value: f64, bounds: (f64, f64)) -> f64 {
    let range = bounds.1 - bounds.0;
    if range.is_finite() {
        range
    } else if value != 0.0 {
        value.abs()
    } else {
        1.0
    }
}

/// The effect that stands for one term of a cause, as it is written for a run.
fn signature(cause: &Cause, term: usize, step: f64, shape: &[f64], run: &Drive0) -> String {
    match (cause.form, cause.id) {
        (Form::OverPosition, "grade") => format!("grade_constant(grade: {step:?})"),
        (Form::OverPosition, _) => format!("rolling_resistance(coefficient: {step:?})"),
        (Form::OverTime, "payload_change") => format!("mass(extra_mass_kg: {step:?})"),
        (Form::OverTime, _) => format!("auxiliary_power(power_w: {step:?})"),
        _ => {
            let mut values = Vec::new();
            let mut held = shape.iter();
            for (index, part) in cause.terms.iter().enumerate() {
                values.push(match part.linear {
                    true if index == term => step,
                    true => 0.0,
                    false => held.next().copied().unwrap_or(1.0),
                });
            }
            for_run(&cause.written(&values), cause, run)
        }
    }
}

/// What a run alone knows of an effect.
pub fn for_run(text: &str, cause: &Cause, run: &Drive0) -> String {
    if cause.id == "multipass" {
        let text = text.strip_suffix(')').unwrap_or(text);
        return format!("{text}, pass: {:?})", run.pass as f64 + 1.0);
    }
    text.to_owned()
}

fn difference(case: &Case, balance: &Balance, after: &[Said], step: f64) -> Column {
    let samples: Vec<Vec<f64>> = case
        .drives
        .iter()
        .zip(case.nominal.iter().zip(after))
        .map(|(drive, (before, after))| {
            let mut samples = change(balance.kind, drive, before, after);
            for value in &mut samples {
                *value = -*value / step;
            }
            samples
        })
        .collect();
    column(&balance.chunks, &samples)
}

/// The column of one term.
struct Part {
    column: Column,
    scale: f64,
    term: usize,
}

fn add(balance: &Balance, pool: &mut Pool, cause: usize, shape: &[f64], found: Vec<Part>) {
    let strength = |column: &Column| column.iter().map(DVector::norm_squared).sum::<f64>().sqrt();
    let residual = strength(&balance.residual);
    let found: Vec<Part> =
        found.into_iter().filter(|one| strength(&one.column) * one.scale > WEAKEST * residual).collect();
    if found.is_empty() {
        return;
    }
    let first = pool.columns.len();
    let columns: Vec<usize> = (first..first + found.len()).collect();
    let terms: Vec<usize> = found.iter().map(|one| one.term).collect();
    for one in found {
        pool.columns.push(one.column);
        pool.sd.push(one.scale);
    }
    // A cause of several terms is tried with each of them alone as well: none is claimed that is not needed.
    if columns.len() > 1 {
        for (column, term) in columns.iter().zip(&terms) {
            pool.trials.push(Trial {
                cause,
                shape: shape.to_vec(),
                columns: vec![*column],
                terms: vec![*term],
            });
        }
    }
    pool.trials.push(Trial { cause, shape: shape.to_vec(), columns, terms });
}

/// Columns of what a sensor does: the recording is corrected, and the residual follows.
fn measured(
    case: &Case,
    balances: &[Balance],
    pools: &mut [Pool],
    number: usize,
    cause: &Cause,
) -> Result<(), DiagnoseError> {
    let Some(term) = cause.terms.first() else { return Ok(()) };
    let step = CAUSE_STEP * term.scale;
    let columns = fault(case, balances, cause.id, step)?;
    for ((balance, pool), column) in balances.iter().zip(pools).zip(columns) {
        if cause.balances.contains(&balance.kind) {
            add(balance, pool, number, &[], vec![Part { column, scale: term.scale, term: 0 }]);
        }
    }
    Ok(())
}

/// What a unit of a sensor's fault does to every row of every balance.
///
/// The acceleration is the one that force and model make: the recorded one would bring its noise into the column.
fn fault(case: &Case, balances: &[Balance], id: &str, step: f64) -> Result<Vec<Column>, DiagnoseError> {
    let corrected = corrected(&case.drives, id, step)?;
    let said = case.said_of(&corrected, case.study.scenario(), &case.study.priors())?;
    let of_run = |kind: Kind, run: usize| -> Vec<f64> {
        let (before, after) = (&case.drives[run], &corrected[run]);
        let (model, remodelled) = (&case.nominal[run], &said[run]);
        let channel = |drive: &Drive0, name: &str| drive.measured.trace.get(name).map(<[f64]>::to_vec);
        let less = |name: &str| match (channel(before, name), channel(after, name)) {
            (Some(before), Some(after)) => before.iter().zip(after).map(|(one, other)| one - other).collect(),
            _ => vec![0.0; model.resistance_n.len()],
        };
        match kind {
            Kind::Motion => {
                let time_s = before.measured.trace.time_s();
                let force =
                    |drive: &Drive0, index: usize| drive.force_n.as_ref().map_or(0.0, |force| force[index]);
                (0..model.resistance_n.len())
                    .map(|index| {
                        let made = before.acceleration_m_s2[index];
                        let faster = match id {
                            "latency" => {
                                interpolate(time_s, &before.acceleration_m_s2, time_s[index] + step) - made
                            }
                            // With a wheel speed beside it, it is that sensor whose scale is wrong.
                            "speed_scale" if before.measured.trace.get("wheel_speed_m_s").is_none() => {
                                made / (1.0 + step) - made
                            }
                            _ => 0.0,
                        };
                        force(before, index) - force(after, index) + remodelled.resistance_n[index]
                            - model.resistance_n[index]
                            + model.effective_mass_kg[index] * faster
                    })
                    .collect()
            }
            Kind::Parity => less("specific_force_m_s2"),
            Kind::Slip => less("wheel_speed_m_s"),
            Kind::Shaft | Kind::Battery | Kind::Fuel => vec![0.0; model.resistance_n.len()],
        }
    };
    Ok(balances
        .iter()
        .map(|balance| {
            let samples: Vec<Vec<f64>> = (0..case.drives.len())
                .map(|run| of_run(balance.kind, run).iter().map(|value| value / step).collect())
                .collect();
            column(&balance.chunks, &samples)
        })
        .collect())
}

/// The runs as they would have been recorded without an artefact of this size.
pub fn corrected(drives: &[Drive0], id: &str, value: f64) -> Result<Vec<Drive0>, DiagnoseError> {
    drives
        .iter()
        .map(|drive| {
            let mut drive = drive.clone();
            let trace = &drive.measured.trace;
            let time_s = trace.time_s().to_vec();
            let scaled = |name: &str| -> Option<Vec<f64>> {
                trace.get(name).map(|values| values.iter().map(|sample| sample / (1.0 + value)).collect())
            };
            let speed = || trace.get("speed_m_s").map(<[f64]>::to_vec).unwrap_or_default();
            let changed: Option<(&str, Vec<f64>)> = match id {
                "latency" => {
                    let speed = speed();
                    let late = time_s.iter().map(|time| interpolate(&time_s, &speed, time + value)).collect();
                    Some(("speed_m_s", late))
                }
                "speed_scale" if trace.get("wheel_speed_m_s").is_some() => {
                    scaled("wheel_speed_m_s").map(|values| ("wheel_speed_m_s", values))
                }
                "speed_scale" => scaled("speed_m_s").map(|values| ("speed_m_s", values)),
                "accelerometer_bias" => trace.get("specific_force_m_s2").map(|values| {
                    ("specific_force_m_s2", values.iter().map(|sample| sample - value).collect())
                }),
                "accelerometer_tilt" => trace.get("specific_force_m_s2").map(|values| {
                    let tilt = STANDARD_GRAVITY_M_S2 * value.sin();
                    ("specific_force_m_s2", values.iter().map(|sample| sample - tilt).collect())
                }),
                PITCH => trace.get("specific_force_m_s2").map(|values| {
                    let pitch =
                        drive.acceleration_m_s2.iter().map(|made| STANDARD_GRAVITY_M_S2 * value * made);
                    (
                        "specific_force_m_s2",
                        values.iter().zip(pitch).map(|(sample, pitch)| sample - pitch).collect(),
                    )
                }),
                _ => None,
            };
            if let Some((name, values)) = changed {
                drive.measured.trace = with_channel(trace, name, values)?;
            }
            if id == "force_scale" {
                for sample in drive.force_n.iter_mut().flatten() {
                    *sample /= 1.0 + value;
                }
                for name in ["tractive_force_n", "motor_torque_n_m", "engine_torque_n_m"] {
                    let trace = &drive.measured.trace;
                    if let Some(values) = trace.get(name) {
                        let values = values.iter().map(|sample| sample / (1.0 + value)).collect();
                        drive.measured.trace = with_channel(trace, name, values)?;
                    }
                }
            }
            if let Some(speed) = drive.measured.trace.get("speed_m_s") {
                drive.motion = local_fit(&time_s, speed, drive.measured.how.smoothing_s);
            }
            Ok(drive)
        })
        .collect()
}

fn with_channel(trace: &Trace, name: &str, values: Vec<f64>) -> Result<Trace, DiagnoseError> {
    let mut changed = Trace::new(trace.time_s().to_vec())?;
    let mut values = Some(values);
    for Channel { name: own, values: kept, origin } in trace.channels() {
        let values = if own == name { values.take().unwrap_or_default() } else { kept.clone() };
        changed.push(own.clone(), values, *origin)?;
    }
    Ok(changed)
}

fn interpolate(times: &[f64], values: &[f64], at: f64) -> f64 {
    let right = times.partition_point(|time| *time < at).clamp(1, times.len() - 1);
    let share = ((at - times[right - 1]) / (times[right] - times[right - 1])).clamp(0.0, 1.0);
    values[right - 1] + share * (values[right] - values[right - 1])
}
