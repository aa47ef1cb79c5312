//! The answer: `diagnosis.json`, and what is written beside it.

use crate::balance::{Balance, Kind};
use crate::catalogue::{Cause, Class, Form};
use crate::faults::Fault;
use crate::locate::stretches;
use crate::prove::Proof;
use crate::refine::{Cured, Refined};
use crate::search::Found;
use crate::{Case, DiagnoseError, words};
use headland_trace::{Origin, Run, Trace};
use serde::Serialize;

/// What a diagnosis says in a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Physics is missing.
    MissingPhysics,
    /// A sensor is wrong.
    SensorArtefact,
    /// Both.
    Both,
    /// Nothing is missing.
    None,
    /// Several causes explain it as well.
    CannotTell,
    /// A cause that nobody listed.
    Unlisted,
}

/// What a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FindingKind {
    /// Something of the world.
    Physics,
    /// Something of a sensor.
    Artefact,
    /// An equation of its own.
    Unlisted,
}

/// A stretch of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// The run.
    pub run: String,
    /// Begin [s].
    pub from_s: f64,
    /// End [s].
    pub to_s: f64,
    /// Position at the begin [m].
    pub from_position_m: f64,
    /// Position at the end [m].
    pub to_position_m: f64,
}

/// A parameter of a finding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterReport {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Its unit.
    pub unit: String,
}

/// A cause that explains as much.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rival {
    /// Its identifier.
    pub id: String,
    /// Squared correlation with the cause that was named, free parameters projected out.
    pub squared_correlation: f64,
}

/// A finding.
#[derive(Clone, Debug, Serialize)]
pub struct FindingReport {
    /// World or sensor.
    pub kind: FindingKind,
    /// The contract's identifier.
    pub id: String,
    /// The balance in which it shows.
    pub balance: Kind,
    /// One sentence for a person.
    pub sentence: String,
    /// Its equation.
    pub equation: String,
    /// Channels that it depends on.
    pub depends_on: Vec<String>,
    /// Where it works.
    #[serde(rename = "where")]
    pub stretches: Vec<Interval>,
    /// Its parameters.
    pub parameters: Vec<ParameterReport>,
    /// Share of the mismatch that it explains.
    pub share_of_mismatch: f64,
    /// Growth of ln p by this cause, and what chance alone would reach once in a hundred.
    pub evidence: [f64; 2],
    /// Causes that explain as much.
    pub indistinguishable_from: Vec<Rival>,
    /// The run that would tell.
    pub next_experiment: String,
}

/// Errors over some runs.
#[derive(Clone, Debug, Serialize)]
pub struct FitRuns {
    /// The runs.
    pub runs: Vec<String>,
    /// Root mean square error with the nominal scenario.
    pub rmse_before: f64,
    /// With what was found.
    pub rmse_after: f64,
    /// What the sensor explains.
    pub noise: f64,
}

/// Before and after.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// The signal.
    pub signal: String,
    /// Runs that were fitted.
    pub fitted: FitRuns,
    /// Runs that were not; none where there were too few.
    pub held_out: Option<FitRuns>,
    /// Error at the end over the noise of the sensor: near 1 where nothing is left to explain.
    pub lack_of_fit: f64,
}

/// A free parameter.
#[derive(Clone, Debug, Serialize)]
pub struct Calibrated {
    /// Its name.
    pub name: String,
    /// Its prior value.
    pub prior: f64,
    /// Its value.
    pub value: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Its unit.
    pub unit: String,
}

/// A cause that was tried.
#[derive(Clone, Debug, Serialize)]
pub struct Tried {
    /// The balance.
    pub balance: Kind,
    /// The round: one cause is accepted in each.
    pub round: usize,
    /// The cause.
    pub id: String,
    /// Its non-linear parameters.
    pub shape: Vec<f64>,
    /// Growth of ln p.
    pub gain: f64,
    /// What the growth has to exceed.
    pub needed: f64,
}

/// `diagnosis.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// `headland.diagnosis/1`.
    pub schema: &'static str,
    /// What it says in a word.
    pub verdict: Verdict,
    /// One paragraph for a person.
    pub answer: String,
    /// The findings, by their share of the mismatch.
    pub findings: Vec<FindingReport>,
    /// Before and after.
    pub fit: Fit,
    /// The free parameters.
    pub calibrated: Vec<Calibrated>,
    /// What the data cannot separate.
    pub null_space: Vec<String>,
    /// What was decided on the way.
    pub notes: Vec<String>,
    /// The best causes of every round and why they lost: the evidence they brought.
    pub tried: Vec<Tried>,
}

/// A diagnosis with what is written beside it.
#[derive(Clone, Debug)]
pub struct Diagnosed {
    /// `diagnosis.json`.
    pub diagnosis: Diagnosis,
    /// The improved scenario for each path: the first is `scenario.ron`.
    pub scenarios: Vec<String>,
    /// Every effect along every run, for `effects.parquet`.
    pub effects: Vec<Run>,
    /// Corrections of channels for the improved `recording.ron`: channel, latency [s], scale, bias.
    pub corrections: Vec<(String, f64, f64, f64)>,
    /// What every balance leaves over, for pictures.
    pub residuals: Vec<LeftOver>,
}

/// What a balance leaves over in one run, row by row.
#[derive(Clone, Debug)]
pub struct LeftOver {
    /// The balance.
    pub balance: Kind,
    /// The run.
    pub run: String,
    /// Time of each row [s].
    pub time_s: Vec<f64>,
    /// Measured minus modelled with the free parameters alone, in the unit of the balance.
    pub before: Vec<f64>,
    /// With everything that was found.
    pub after: Vec<f64>,
}

/// Puts the answer together.
pub fn report(
    case: &Case,
    balances: &[Balance],
    found: &[Option<Found>],
    refined: &Refined,
    proof: &Proof,
    faults: &[Fault],
    unproven: &[&'static str],
) -> Result<Diagnosed, DiagnoseError> {
    let mut findings = findings(case, balances, found, refined, proof);
    findings.extend(faults.iter().map(|fault| faulty(fault, balances)));
    let verdict = verdict(&findings);
    let ids = |wanted: bool| -> Vec<String> {
        let chosen = case.drives.iter().zip(&case.fit).filter(|(_, fit)| **fit == wanted);
        chosen.map(|(drive, _)| drive.measured.id.clone()).collect()
    };
    let runs = |wanted: bool, errors: &crate::prove::Errors| FitRuns {
        runs: ids(wanted),
        rmse_before: errors.before,
        rmse_after: errors.after,
        noise: proof.noise,
    };
    let lack = match (&proof.held_out, proof.noise) {
        (Some(held), noise) if noise > 0.0 => held.after / noise,
        (None, noise) if noise > 0.0 => proof.fitted.after / noise,
        // Without a noise of its own the signal is judged by the rows: all of their scatter over the sensors' part.
        _ => found.iter().flatten().map(|found| (1.0 + found.lack_of_fit.1).sqrt()).fold(0.0, f64::max),
    };
    let fit = Fit {
        signal: proof.signal.to_owned(),
        fitted: runs(true, &proof.fitted),
        held_out: proof.held_out.as_ref().map(|errors| runs(false, errors)),
        lack_of_fit: lack,
    };
    let unit =
        |name: &str| headland_units::unit_of_name(name).map_or_else(|| "1".to_owned(), |unit| unit.symbol);
    let calibrated = refined
        .free
        .iter()
        .map(|(name, prior, value, ci95)| Calibrated {
            name: name.clone(),
            prior: *prior,
            value: *value,
            ci95: *ci95,
            unit: unit(name),
        })
        .collect();
    let mut notes = case.study.notes.clone();
    if !unproven.is_empty() {
        notes.push(format!(
            "{} would explain the fitted runs, but not those that were held out; so nothing of it is claimed.",
            unproven.join(", ")
        ));
    }
    if case.chosen && ids(false).is_empty() {
        notes.push(
            "There are too few runs to hold one out, so nothing is proven on runs that were not fitted."
                .to_owned(),
        );
    } else if case.chosen {
        notes.push(format!("No run was marked `use: held_out`; held out were {}.", ids(false).join(", ")));
    }
    let mut null_space = refined.null_space.clone();
    for finding in &findings {
        for rival in &finding.indistinguishable_from {
            null_space.push(format!(
                "`{}` and `{}` explain these recordings equally well (squared correlation {:.2}).",
                finding.id, rival.id, rival.squared_correlation
            ));
        }
    }
    let diagnosis = Diagnosis {
        schema: "headland.diagnosis/1",
        verdict,
        answer: words::answer(verdict, &findings, &fit, balances),
        findings,
        fit,
        calibrated,
        null_space,
        notes,
        tried: tried(case, balances, found),
    };
    Ok(Diagnosed {
        diagnosis,
        scenarios: proof.scenarios.iter().map(|(_, text)| text.clone()).collect(),
        effects: effects(case, proof)?,
        corrections: corrections(refined),
        residuals: residuals(case, balances, found),
    })
}

fn findings(
    case: &Case,
    balances: &[Balance],
    found: &[Option<Found>],
    refined: &Refined,
    proof: &Proof,
) -> Vec<FindingReport> {
    let mut findings: Vec<FindingReport> = Vec::new();
    for (cured, effect) in refined.causes.iter().zip(&proof.effects) {
        let balance = &balances[cured.balance];
        let share = share(case, balance, found[cured.balance].as_ref(), cured, refined, proof);
        let parameters = parameters(cured, case);
        let rivals: Vec<Rival> = cured
            .accepted
            .rivals
            .iter()
            .map(|(cause, _, correlation)| Rival {
                id: case.causes[*cause].id.to_owned(),
                squared_correlation: *correlation,
            })
            .collect();
        findings.push(FindingReport {
            kind: if cured.cause.class == Class::Physics {
                FindingKind::Physics
            } else {
                FindingKind::Artefact
            },
            id: cured.cause.id.to_owned(),
            balance: balance.kind,
            sentence: words::sentence(&cured.cause, balance.kind, &parameters, share, &rivals),
            equation: cured.cause.equation.to_owned(),
            depends_on: cured.cause.depends_on.iter().map(|name| (*name).to_owned()).collect(),
            stretches: stretches(&case.drives, &effect.runs),
            parameters,
            share_of_mismatch: share,
            evidence: [cured.accepted.gain, cured.accepted.by_chance],
            next_experiment: experiment(&cured.cause, cured, case),
            indistinguishable_from: rivals,
        });
    }
    findings.sort_by(|one, other| other.share_of_mismatch.total_cmp(&one.share_of_mismatch));
    findings
}

/// A fault that a channel shows by itself.
fn faulty(fault: &Fault, balances: &[Balance]) -> FindingReport {
    FindingReport {
        kind: FindingKind::Artefact,
        id: fault.id.to_owned(),
        balance: balances.first().map_or(Kind::Motion, |balance| balance.kind),
        sentence: words::fault(fault),
        equation: String::new(),
        depends_on: vec![fault.channel.clone()],
        stretches: fault.stretches.clone(),
        parameters: vec![ParameterReport {
            name: "size".to_owned(),
            value: fault.size,
            ci95: [fault.size, fault.size],
            unit: fault.unit.clone(),
        }],
        share_of_mismatch: 0.0,
        evidence: [0.0, 0.0],
        indistinguishable_from: Vec::new(),
        next_experiment: format!("look at the sensor and the logger of `{}`", fault.channel),
    }
}

fn tried(case: &Case, balances: &[Balance], found: &[Option<Found>]) -> Vec<Tried> {
    let mut all = Vec::new();
    for (balance, found) in balances.iter().zip(found) {
        for (number, round) in found.iter().flat_map(|found| &found.tried).enumerate() {
            for (cause, shape, gain) in &round.causes {
                all.push(Tried {
                    balance: balance.kind,
                    round: number + 1,
                    id: case.causes[*cause].id.to_owned(),
                    shape: shape.clone(),
                    gain: *gain,
                    needed: round.by_chance,
                });
            }
        }
    }
    all
}

/// Whether it is in doubt what a finding is: between faults of one sensor the doubt makes no difference.
fn doubtful(finding: &FindingReport) -> bool {
    let fault = |id: &str| ["accelerometer_bias", "accelerometer_tilt"].contains(&id);
    finding.indistinguishable_from.iter().any(|rival| !(fault(&finding.id) && fault(&rival.id)))
}

fn verdict(findings: &[FindingReport]) -> Verdict {
    let any = |kind: FindingKind| findings.iter().any(|finding| finding.kind == kind);
    if findings.is_empty() {
        Verdict::None
    } else if findings.first().is_some_and(doubtful) {
        Verdict::CannotTell
    } else if any(FindingKind::Physics) && any(FindingKind::Artefact) {
        Verdict::Both
    } else if any(FindingKind::Artefact) {
        Verdict::SensorArtefact
    } else if any(FindingKind::Physics) {
        Verdict::MissingPhysics
    } else {
        Verdict::Unlisted
    }
}

/// Share of the mismatch beyond the sensors' noise that a cause explains.
fn share(
    case: &Case,
    balance: &Balance,
    found: Option<&Found>,
    cured: &Cured,
    refined: &Refined,
    proof: &Proof,
) -> f64 {
    let Some(found) = found else { return 0.0 };
    let mean_square = |column: &crate::gram::Column| {
        let (mut sum, mut count) = (0.0, 0usize);
        for (chunk, values) in balance.chunks.iter().zip(column).filter(|(chunk, _)| case.fit[chunk.run]) {
            sum += values.norm_squared();
            count += chunk.rows.len();
        }
        sum / count.max(1) as f64
    };
    let noise = found.noise.1.sensor;
    // Against the nominal model: what the free parameters take is part of the mismatch too.
    let before = (mean_square(&balance.residual) - noise).max(1e-300);
    let left = (mean_square(&found.left) - noise).max(0.0);
    // Over samples: rows in which a spell works are set aside.
    let size = |index: usize| {
        let runs = proof.effects[index].runs.iter().zip(&case.fit).filter(|(_, fit)| **fit);
        let squares: Vec<f64> = runs
            .flat_map(|(run, _)| run)
            .map(|value| value * value)
            .filter(|value| value.is_finite())
            .collect();
        squares.iter().sum::<f64>() / squares.len().max(1) as f64
    };
    let same: Vec<usize> =
        (0..refined.causes.len()).filter(|index| refined.causes[*index].balance == cured.balance).collect();
    let all: f64 = same.iter().map(|index| size(*index)).sum();
    let own = same
        .iter()
        .find(|index| refined.causes[**index].cause.id == cured.cause.id)
        .map_or(0.0, |index| size(*index));
    // What the free parameters take is part of the mismatch with the nominal model too.
    let calibrated = (before - left - all).max(0.0);
    if all > 0.0 { own / (all + left + calibrated) } else { 0.0 }
}

fn parameters(cured: &Cured, case: &Case) -> Vec<ParameterReport> {
    let one = |name: &str, value: f64, ci95: [f64; 2], unit: &str| ParameterReport {
        name: name.to_owned(),
        value,
        ci95,
        unit: unit.to_owned(),
    };
    if let Some(function) = &cured.function {
        return function_parameters(&cured.cause, function, case);
    }
    match cured.cause.id {
        "wind" => {
            let [(north, north_ci), (east, east_ci), ..] = cured.values[..] else { return Vec::new() };
            let sd = |ci: [f64; 2]| (ci[1] - ci[0]) / 3.92;
            let speed = north.hypot(east);
            let from = east.atan2(north).rem_euclid(std::f64::consts::TAU);
            let along = (north * sd(north_ci)).hypot(east * sd(east_ci)) / speed.max(1e-9);
            let across = (east * sd(north_ci)).hypot(north * sd(east_ci)) / speed.max(1e-9).powi(2);
            vec![
                one("speed_m_s", speed, [(speed - 1.96 * along).max(0.0), speed + 1.96 * along], "m/s"),
                one("from_rad", from, [from - 1.96 * across, from + 1.96 * across], "rad"),
            ]
        }
        "cornering_drag" => {
            let Some((value, ci)) = cured.values.first() else { return Vec::new() };
            let stiffness = |compliance: f64| 1.0 / compliance.max(1e-12);
            vec![one(
                "cornering_stiffness_n_per_rad",
                stiffness(*value),
                [stiffness(ci[1]), stiffness(ci[0].max(1e-9))],
                "N/rad",
            )]
        }
        _ => cured
            .cause
            .terms
            .iter()
            .zip(&cured.values)
            // A term that was not needed is zero, and nothing was estimated.
            .filter(|(_, (value, ci))| !(*value == 0.0 && *ci == [0.0; 2]))
            .map(|(term, (value, ci))| one(term.name, *value, *ci, term.unit))
            .collect(),
    }
}

fn function_parameters(
    cause: &Cause,
    function: &crate::profile::Function,
    case: &Case,
) -> Vec<ParameterReport> {
    let _ = case;
    let term = &cause.terms[0];
    // The largest value over all groups, with its own band.
    let mut peak = (0.0, 0.0);
    let (mut sum, mut count) = (0.0, 0usize);
    for (values, sds) in &function.values {
        for (value, sd) in values.iter().zip(sds.iter()) {
            if value.abs() > f64::abs(peak.0) {
                peak = (*value, *sd);
            }
            sum += value * value;
            count += 1;
        }
    }
    let rms = (sum / count.max(1) as f64).sqrt();
    let unit = if cause.form == Form::OverPosition { "m" } else { "s" };
    let length = function.spread.length;
    vec![
        ParameterReport {
            name: term.name.to_owned(),
            value: peak.0,
            ci95: [peak.0 - 1.96 * peak.1, peak.0 + 1.96 * peak.1],
            unit: term.unit.to_owned(),
        },
        ParameterReport {
            name: format!("{}_rms", term.name),
            value: rms,
            ci95: [rms - 1.96 * peak.1, rms + 1.96 * peak.1],
            unit: term.unit.to_owned(),
        },
        ParameterReport {
            name: format!("length_{unit}"),
            value: length,
            ci95: [0.5 * length, 2.0 * length],
            unit: unit.to_owned(),
        },
    ]
}

fn experiment(cause: &Cause, cured: &Cured, case: &Case) -> String {
    if cured.accepted.rivals.is_empty() {
        return cause.experiment.to_owned();
    }
    let mut runs = vec![cause.experiment];
    for (rival, _, _) in &cured.accepted.rivals {
        let own = case.causes[*rival].experiment;
        if !runs.contains(&own) {
            runs.push(own);
        }
    }
    runs.truncate(3);
    runs.join("; or ")
}

fn effects(case: &Case, proof: &Proof) -> Result<Vec<Run>, DiagnoseError> {
    let mut runs = Vec::new();
    for (index, drive) in case.drives.iter().enumerate() {
        let mut trace = Trace::new(drive.measured.trace.time_s().to_vec())?;
        for effect in &proof.effects {
            let name = format!("{}_{}", effect.id, effect.unit);
            if trace.get(&name).is_none() {
                trace.push(name, effect.runs[index].clone(), Origin::Predicted)?;
            }
        }
        runs.push(Run { id: drive.measured.id.clone(), trace });
    }
    Ok(runs)
}

fn corrections(refined: &Refined) -> Vec<(String, f64, f64, f64)> {
    let mut all = Vec::new();
    for cured in refined.causes.iter().filter(|cured| cured.cause.class == Class::Artefact) {
        let value = cured.values.first().map_or(0.0, |(value, _)| *value);
        match cured.cause.id {
            "latency" => all.push(("speed_m_s".to_owned(), value, 1.0, 0.0)),
            "speed_scale" => all.push(("speed_m_s".to_owned(), 0.0, 1.0 + value, 0.0)),
            "force_scale" => all.push(("tractive_force_n".to_owned(), 0.0, 1.0 + value, 0.0)),
            "accelerometer_bias" => all.push(("specific_force_m_s2".to_owned(), 0.0, 1.0, value)),
            _ => {}
        }
    }
    all
}

fn residuals(case: &Case, balances: &[Balance], found: &[Option<Found>]) -> Vec<LeftOver> {
    let mut all = Vec::new();
    for (balance, found) in balances.iter().zip(found) {
        let Some(found) = found else { continue };
        for (run, drive) in case.drives.iter().enumerate() {
            let (mut times, mut before, mut after) = (Vec::new(), Vec::new(), Vec::new());
            for (index, chunk) in balance.chunks.iter().enumerate().filter(|(_, chunk)| chunk.run == run) {
                for (row, place) in chunk.rows.iter().enumerate() {
                    times.push(place.time_s);
                    before.push(found.before[index][row]);
                    after.push(found.left[index][row]);
                }
            }
            all.push(LeftOver {
                balance: balance.kind,
                run: drive.measured.id.clone(),
                time_s: times,
                before,
                after,
            });
        }
    }
    all
}
