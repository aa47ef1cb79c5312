//! Before and after, on runs that were fitted and on runs that were not.

use crate::balance::{Balance, Drive0, Kind, Said, forward};
use crate::catalogue::{Cause, Class, Form};
use crate::events::Event;
use crate::refine::{Cured, Refined, said_with_all};
use crate::search::Found;
use crate::trial::{corrected, for_run};
use crate::{Case, DiagnoseError};
use headland_scenario::Scenario;
use headland_sim::{Replay, replay};
use rayon::prelude::*;

/// What an effect did along one run.
#[derive(Clone, Debug)]
pub struct Reconstructed {
    /// The cause.
    pub id: &'static str,
    /// Unit of the values: `n`, `w`, `m_s`, `m_s2`.
    pub unit: &'static str,
    /// One series for each run, sample by sample.
    pub runs: Vec<Vec<f64>>,
}

/// Errors of one signal over some runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    /// Root mean square with the nominal scenario.
    pub before: f64,
    /// Root mean square with what was found.
    pub after: f64,
}

/// The proof.
pub struct Proof {
    /// The signal.
    pub signal: &'static str,
    /// Over the runs that were fitted.
    pub fitted: Errors,
    /// Over the runs that were not; none where there are none.
    pub held_out: Option<Errors>,
    /// What the sensor of the signal explains.
    pub noise: f64,
    /// The effects along the runs.
    pub effects: Vec<Reconstructed>,
    /// The improved scenario: text for each path, the first being that of `scenario.ron`.
    pub scenarios: Vec<(usize, String)>,
}

/// Makes the proof.
pub fn prove(case: &Case, balances: &[Balance], refined: &Refined) -> Result<Proof, DiagnoseError> {
    case.progress.step("proving");
    let artefacts: Vec<&Cured> =
        refined.causes.iter().filter(|cured| cured.cause.class == Class::Artefact).collect();
    let mut drives = case.drives.clone();
    for cured in &artefacts {
        if let Some((value, _)) = cured.values.first() {
            drives = corrected(&drives, cured.cause.id, *value)?;
        }
    }
    let effects = refined
        .causes
        .iter()
        .map(|cured| reconstruct(case, balances, cured, refined))
        .collect::<Result<Vec<_>, _>>()?;
    let signal = signal(case, balances, refined);
    let (errors, noise) = match signal {
        "speed_m_s" => speeds(case, balances, &drives, refined)?,
        _ => rows(case, balances, &drives, refined, &effects, signal)?,
    };
    let over = |wanted: bool| {
        let chosen: Vec<&Errors> = errors
            .iter()
            .zip(&case.fit)
            .filter(|(_, fit)| **fit == wanted)
            .map(|(errors, _)| errors)
            .collect();
        let root = |of: fn(&Errors) -> f64| {
            let squares: Vec<f64> =
                chosen.iter().map(|one| of(one).powi(2)).filter(|value| value.is_finite()).collect();
            (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
        };
        (!chosen.is_empty()).then(|| Errors { before: root(|one| one.before), after: root(|one| one.after) })
    };
    let mut paths: Vec<usize> = Vec::new();
    let mut scenarios = Vec::new();
    for (run, drive) in case.drives.iter().enumerate() {
        if !paths.contains(&drive.path) {
            paths.push(drive.path);
            scenarios.push((drive.path, improved(case, refined, run)?.document().text().to_owned()));
        }
        if !by_path(refined) {
            break;
        }
    }
    Ok(Proof {
        signal,
        fitted: over(true).unwrap_or_default(),
        held_out: over(false),
        noise,
        effects,
        scenarios,
    })
}

fn by_path(refined: &Refined) -> bool {
    refined.causes.iter().any(|cured| cured.function.is_some() || !cured.events.is_empty())
}

/// The signal by which before and after are told.
fn signal(case: &Case, balances: &[Balance], refined: &Refined) -> &'static str {
    let found = refined.causes.first().map(|cured| balances[cured.balance].kind);
    let kind = found.unwrap_or_else(|| {
        let motion = balances.iter().find(|balance| balance.kind == Kind::Motion);
        motion.or(balances.first()).map_or(Kind::Motion, |balance| balance.kind)
    });
    let _ = case;
    match kind {
        Kind::Motion | Kind::Shaft => "speed_m_s",
        Kind::Parity => "specific_force_m_s2",
        Kind::Slip => "wheel_speed_m_s",
        Kind::Battery => "battery_power_w",
        Kind::Fuel => "fuel_rate_kg_s",
    }
}

/// The scenario with everything that was found, for one run.
pub fn improved(case: &Case, refined: &Refined, run: usize) -> Result<Scenario, DiagnoseError> {
    let values = refined.values();
    let paths = case.study.paths().iter().map(String::as_str);
    let changes: Vec<(&str, f64)> = paths.zip(values.iter().copied()).collect();
    let mut document = case.study.scenario().document().with(&changes)?;
    for cured in &refined.causes {
        if let Some(text) = text(case, cured, run) {
            document = document.with_effect(&text)?;
        }
    }
    Ok(Scenario::of(document, case.registry)?)
}

/// A cause as the scenario of a run writes it; none of a sensor's.
fn text(case: &Case, cured: &Cured, run: usize) -> Option<String> {
    if cured.cause.class == Class::Artefact {
        return None;
    }
    let drive = &case.drives[run];
    if !cured.events.is_empty() {
        let own: Vec<&Event> = cured.events.iter().filter(|event| event.run == run).collect();
        return (!own.is_empty()).then(|| spelt(cured.cause.id, &own));
    }
    let Some(function) = &cured.function else {
        let values: Vec<f64> = cured.values.iter().map(|(value, _)| *value).collect();
        return Some(for_run(&cured.cause.written(&values), &cured.cause, drive));
    };
    let over_position = cured.cause.form == Form::OverPosition;
    if !over_position && !case.fit[run] {
        // A function of time is that of its own run.
        return None;
    }
    let group = if over_position { drive.path } else { run };
    let knots = function.knots(group);
    let values: Vec<f64> = function.values[group].0.iter().copied().collect();
    let list =
        |values: &[f64]| values.iter().map(|value| format!("{value:.6?}")).collect::<Vec<_>>().join(", ");
    let edges = |knots: &[f64]| {
        // Steps change half way between knots.
        let mut edges: Vec<f64> = knots.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        if let [first, second, ..] = knots {
            edges.insert(0, 1.5 * first - 0.5 * second);
        }
        edges
    };
    Some(match cured.cause.id {
        "grade" => format!("grade(positions_m: [{}], grades: [{}])", list(&knots), list(&values)),
        "soft_ground" => {
            let mut edges = edges(&knots);
            if let (Some(last), Some(before)) = (knots.last(), knots.iter().rev().nth(1)) {
                edges.push(1.5 * last - 0.5 * before);
            }
            format!("soft_ground(positions_m: [{}], coefficients: [{}])", list(&edges), list(&values))
        }
        "payload_change" => {
            format!("payload_change(times_s: [{}], masses_kg: [{}])", list(&knots), list(&values))
        }
        _ => {
            let mut edges = edges(&knots);
            if let (Some(last), Some(before)) = (knots.last(), knots.iter().rev().nth(1)) {
                edges.push(1.5 * last - 0.5 * before);
            }
            format!("auxiliary_power(times_s: [{}], powers_w: [{}])", list(&edges), list(&values))
        }
    })
}

/// Spells as a scenario writes them.
fn spelt(id: &str, events: &[&Event]) -> String {
    if id != "braking" {
        let one = |event: &&Event| {
            format!(
                "drawbar_load(force_n: {:?}, from_s: {:?}, to_s: {:?})",
                event.force_n, event.from_s, event.to_s
            )
        };
        return events.iter().map(one).collect::<Vec<_>>().join(", ");
    }
    let (mut times, mut forces) = (Vec::new(), Vec::new());
    for event in events {
        times.extend([format!("{:?}", event.from_s), format!("{:?}", event.to_s)]);
        forces.push(format!("{:?}", event.force_n));
        forces.push("0.0".to_owned());
    }
    // The times are edges: the last one ends the last, empty spell.
    times.push(format!("{:?}", events.last().map_or(0.0, |event| event.to_s) + 1.0));
    format!("braking(times_s: [{}], forces_n: [{}])", times.join(", "), forces.join(", "))
}

/// What an effect does along every run.
fn reconstruct(
    case: &Case,
    balances: &[Balance],
    cured: &Cured,
    refined: &Refined,
) -> Result<Reconstructed, DiagnoseError> {
    let balance = &balances[cured.balance];
    let unit = match (cured.cause.class, balance.kind) {
        (_, Kind::Motion) => "n",
        (_, Kind::Battery | Kind::Fuel | Kind::Shaft) => "w",
        (_, Kind::Slip) => "m_s",
        (_, Kind::Parity) => "m_s2",
    };
    let values = refined.values();
    let bare = case.said(case.study.scenario(), &values)?;
    // Forces are told forward, as in every trace: what resists is negative. Powers are what is taken.
    let way = if unit == "n" { 1.0 } else { -1.0 };
    let negated = |before: &[Said], after: &[Said]| -> Vec<Vec<f64>> {
        case.drives
            .iter()
            .zip(before.iter().zip(after))
            .map(|(drive, (before, after))| {
                let change = crate::balance::change(balance.kind, drive, before, after);
                change.iter().map(|value| way * value).collect()
            })
            .collect()
    };
    let runs = if !cured.events.is_empty() {
        let of_run = |(run, drive): (usize, &Drive0)| -> Vec<f64> {
            let own: Vec<&Event> = cured.events.iter().filter(|event| event.run == run).collect();
            let at = |time: &f64| {
                -own.iter()
                    .filter(|event| (event.from_s..event.to_s).contains(time))
                    .map(|event| event.force_n)
                    .sum::<f64>()
            };
            drive.measured.trace.time_s().iter().map(at).collect()
        };
        case.drives.iter().enumerate().map(of_run).collect()
    } else if cured.cause.class == Class::Artefact {
        let value = cured.values.first().map_or(0.0, |(value, _)| *value);
        let fixed = corrected(&case.drives, cured.cause.id, value)?;
        let after = case.said_of(&fixed, case.study.scenario(), &values)?;
        negated(&bare, &after)
    } else if let Some(function) = &cured.function {
        let unit_text = |_: &Drive0| match cured.cause.id {
            "grade" => "grade_constant(grade: 0.01)".to_owned(),
            "soft_ground" => "rolling_resistance(coefficient: 0.01)".to_owned(),
            "payload_change" => "mass(extra_mass_kg: 0.01)".to_owned(),
            _ => "auxiliary_power(power_w: 0.01)".to_owned(),
        };
        let after = case.said_with(&unit_text, &values)?;
        let mut series = negated(&bare, &after);
        for (run, (samples, drive)) in series.iter_mut().zip(&case.drives).enumerate() {
            let time_s = drive.measured.trace.time_s();
            for (index, sample) in samples.iter_mut().enumerate() {
                let value = if cured.cause.form == Form::OverPosition {
                    function.value(drive.path, drive.position_m[index])
                } else {
                    function.value(run, time_s[index])
                };
                *sample *= 100.0 * value;
            }
        }
        series
    } else {
        let values_of: Vec<f64> = cured.values.iter().map(|(value, _)| *value).collect();
        let effects: Vec<(Cause, Vec<f64>)> = vec![(cured.cause.clone(), values_of)];
        let after = said_with_all(case, &case.drives, &effects, &values)?;
        negated(&bare, &after)
    };
    Ok(Reconstructed { id: cured.cause.id, unit, runs })
}

/// Longest window in which a long run is driven forward [s].
const WINDOW_S: f64 = 30.0;

fn speeds(
    case: &Case,
    balances: &[Balance],
    drives: &[Drive0],
    refined: &Refined,
) -> Result<(Vec<Errors>, f64), DiagnoseError> {
    let errors = (0..drives.len())
        .into_par_iter()
        .map(|run| {
            let (before, after) = (&case.drives[run], &drives[run]);
            let Some(drive) = forward(after) else { return Ok(Errors { before: f64::NAN, after: f64::NAN }) };
            let nominal = case.study.model(&before.measured, &case.study.priors())?;
            let scenario = improved(case, refined, run)?;
            let cured = case.study.model_of(&scenario, &after.measured, &refined.values())?;
            let long = after.measured.trace.duration_s() > 2.0 * WINDOW_S;
            let how = Replay {
                drive,
                window_s: after.measured.how.window_s.or(long.then_some(WINDOW_S)),
                ..after.measured.how.clone()
            };
            let rmse = |model: &headland_sim::Model, drive: &Drive0| -> Result<f64, DiagnoseError> {
                let failed = |error| DiagnoseError::Replay { run: drive.measured.id.clone(), error };
                let modelled = replay(model, &drive.measured.trace, &how).map_err(failed)?.trace;
                let measured = drive.measured.trace.get("speed_m_s").unwrap_or(&[]);
                let squares: Vec<f64> = modelled
                    .get("speed_m_s")
                    .unwrap_or(&[])
                    .iter()
                    .zip(measured)
                    .map(|(one, other)| (one - other).powi(2))
                    .filter(|value| value.is_finite())
                    .collect();
                Ok((squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt())
            };
            Ok(Errors { before: rmse(&nominal, before)?, after: rmse(&cured, after)? })
        })
        .collect::<Result<Vec<Errors>, DiagnoseError>>()?;
    let _ = balances;
    Ok((errors, speed_noise(case)))
}

/// What the description says of the speed sensor, or the scatter about the local fit.
fn speed_noise(case: &Case) -> f64 {
    let mut squares = 0.0;
    let mut count = 0usize;
    for drive in &case.drives {
        if let Some(speed) = drive.measured.trace.get("speed_m_s") {
            for (measured, smooth) in speed.iter().zip(&drive.motion.value) {
                let error = (measured - smooth).powi(2);
                if error.is_finite() {
                    squares += error;
                    count += 1;
                }
            }
        }
    }
    (squares / count.max(1) as f64).sqrt()
}

/// Errors of the rows of a balance, for signals that are not driven forward.
fn rows(
    case: &Case,
    balances: &[Balance],
    drives: &[Drive0],
    refined: &Refined,
    effects: &[Reconstructed],
    signal: &str,
) -> Result<(Vec<Errors>, f64), DiagnoseError> {
    let kind = match signal {
        "battery_power_w" => Kind::Battery,
        "fuel_rate_kg_s" => Kind::Fuel,
        "wheel_speed_m_s" => Kind::Slip,
        _ => Kind::Parity,
    };
    let unit = if kind == Kind::Fuel { 1.0 / crate::balance::FUEL_J_KG } else { 1.0 };
    let Some((index, balance)) = balances.iter().enumerate().find(|(_, balance)| balance.kind == kind) else {
        return Ok((vec![Errors { before: f64::NAN, after: f64::NAN }; case.drives.len()], f64::NAN));
    };
    let said = case.said_of(drives, case.study.scenario(), &refined.values())?;
    let mut after = balance.residual_of(drives, &said);
    for (cured, effect) in refined.causes.iter().zip(effects) {
        if cured.balance != index || cured.cause.class == Class::Artefact {
            continue;
        }
        let timed = cured.cause.form == Form::OverTime;
        let column = crate::balance::column(&balance.chunks, &effect.runs);
        for ((left, column), chunk) in after.iter_mut().zip(&column).zip(&balance.chunks) {
            if !timed || case.fit[chunk.run] {
                *left -= column;
            }
        }
    }
    let mut errors = Vec::new();
    for run in 0..case.drives.len() {
        let of = |column: &crate::gram::Column| {
            let (mut sum, mut count) = (0.0, 0usize);
            for (chunk, values) in balance.chunks.iter().zip(column).filter(|(chunk, _)| chunk.run == run) {
                sum += values.norm_squared();
                count += chunk.rows.len();
            }
            if count == 0 { f64::NAN } else { unit * (sum / count as f64).sqrt() }
        };
        errors.push(Errors { before: of(&balance.residual), after: of(&after) });
    }
    Ok((errors, f64::NAN))
}

/// Causes of balances that become worse on the runs that were held out. What is a function of time belongs to its own
/// run, and no other can show it.
pub fn unproven(found: &[Option<Found>], refined: &Refined) -> Vec<&'static str> {
    /// A cause may only relieve a free parameter that was pushed beyond its prior; that need not show in other runs. It
    /// must not harm them.
    const HARM: f64 = -3.0;
    let fails = |cured: &&Cured| {
        let gain = found[cured.balance].as_ref().and_then(|found| found.held_out_gain);
        cured.cause.form != Form::OverTime && gain.is_some_and(|gain| gain < HARM)
    };
    refined.causes.iter().filter(fails).map(|cured| cured.cause.id).collect()
}
