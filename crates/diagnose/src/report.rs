//! The answer: `diagnosis.json`, and what is written beside it.

use crate::balance::{Kind, System};
use crate::catalogue::{Cause, Class, Form};
use crate::faults::Fault;
use crate::locate::stretches;
use crate::prove::Proof;
use crate::refine::{Cured, HALF_95, Refined};
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
pub struct RivalReport {
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
    pub indistinguishable_from: Vec<RivalReport>,
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
    system: &System,
    found: &Found,
    refined: &Refined,
    proof: &Proof,
    faults: &[Fault],
) -> Result<Diagnosed, DiagnoseError> {
    let mut findings = findings(case, system, found, refined, proof);
    findings.extend(faults.iter().map(|fault| faulty(fault, system)));
    let verdict = verdict(&findings);
    let ids = |wanted: bool| -> Vec<String> {
        let chosen = case.runs.iter().zip(&case.fit).filter(|(_, fit)| **fit == wanted);
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
        _ => found.noises.1.0.iter().map(|noise| (1.0 + noise.lack()).sqrt()).fold(0.0, f64::max),
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
        .map(|free| Calibrated {
            name: free.name.clone(),
            prior: free.prior,
            value: free.value,
            ci95: free.ci95,
            unit: unit(&free.name),
        })
        .collect();
    let mut notes = case.study.notes.clone();
    if !found.unproven.is_empty() {
        let names: Vec<&str> = found.unproven.iter().map(|cause| case.causes[*cause].id).collect();
        notes.push(format!(
            "{} would explain each run by itself, but not one from the others; so nothing of it is claimed.",
            names.join(", ")
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
        answer: words::answer(verdict, &findings, &fit, &system.kinds),
        findings,
        fit,
        calibrated,
        null_space,
        notes,
        tried: tried(case, found),
    };
    Ok(Diagnosed {
        diagnosis,
        scenarios: proof.scenarios.iter().map(|(_, text)| text.clone()).collect(),
        effects: effects(case, proof)?,
        corrections: corrections(refined),
        residuals: residuals(case, system, found),
    })
}

fn findings(
    case: &Case,
    system: &System,
    found: &Found,
    refined: &Refined,
    proof: &Proof,
) -> Vec<FindingReport> {
    let mut findings: Vec<FindingReport> = Vec::new();
    for (place, (cured, effect)) in refined.causes.iter().zip(&proof.effects).enumerate() {
        let balance = system.kinds[cured.accepted.balance];
        let share = share(case, system, found, refined, place);
        let parameters = parameters(cured);
        let rivals: Vec<RivalReport> = cured
            .accepted
            .rivals
            .iter()
            .map(|rival| RivalReport {
                id: case.causes[rival.cause].id.to_owned(),
                squared_correlation: rival.squared_correlation,
            })
            .collect();
        findings.push(FindingReport {
            kind: match cured.cause.class {
                Class::Physics => FindingKind::Physics,
                Class::Artefact => FindingKind::Artefact,
                Class::Unlisted => FindingKind::Unlisted,
            },
            id: cured.cause.id.to_owned(),
            balance,
            sentence: words::sentence(&cured.cause, balance, &parameters, share, &rivals),
            equation: cured.cause.equation_text(),
            depends_on: cured.cause.channels(),
            stretches: stretches(&case.runs, &effect.runs),
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
fn faulty(fault: &Fault, system: &System) -> FindingReport {
    FindingReport {
        kind: FindingKind::Artefact,
        id: fault.id.to_owned(),
        balance: system.kinds.first().copied().unwrap_or(Kind::Motion),
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

fn tried(case: &Case, found: &Found) -> Vec<Tried> {
    let mut all = Vec::new();
    for (number, round) in found.tried.iter().enumerate() {
        for (cause, shape, gain) in &round.causes {
            all.push(Tried {
                round: number + 1,
                id: case.causes[*cause].id.to_owned(),
                shape: shape.clone(),
                gain: *gain,
                needed: round.by_chance,
            });
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
    } else if findings.first().is_some_and(|finding| finding.kind == FindingKind::Unlisted) {
        Verdict::Unlisted
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

/// Share of the mismatch with the nominal model, in the balance in which a cause shows most, that it explains: its mean
/// square over that of everything beyond the noise of the sensors. What the free parameters take is mismatch too.
fn share(case: &Case, system: &System, found: &Found, refined: &Refined, place: usize) -> f64 {
    let balance = refined.causes[place].accepted.balance;
    let size = |column: &crate::gram::Column| system.mean_squares(column, &case.fit)[balance];
    let noise = found.noises.1.0[balance].sensor;
    let before = (size(&system.residual) - noise).max(f64::MIN_POSITIVE);
    let left = (size(&found.left) - noise).max(0.0);
    let of = |place: usize| found.effects.get(place).map_or(0.0, size);
    let all: f64 = (0..refined.causes.len()).map(of).sum();
    let calibrated = (before - left - all).max(0.0);
    // Rows in which a spell works were set aside: it is judged by the force that it takes away.
    let Some(cured) = refined.causes.get(place).filter(|cured| cured.events.is_empty()) else { return 1.0 };
    if found.effects.get(place).is_none() {
        // Corrected in the recording itself, before anything was left.
        return if cured.accepted.gain > 0.0 { 1.0 - left / before.max(left) } else { 0.0 };
    }
    if all > 0.0 { of(place) / (all + left + calibrated) } else { 0.0 }
}

fn parameters(cured: &Cured) -> Vec<ParameterReport> {
    let one = |name: &str, value: f64, ci95: [f64; 2], unit: &str| ParameterReport {
        name: name.to_owned(),
        value,
        ci95,
        unit: unit.to_owned(),
    };
    if let Some(function) = cured.function() {
        return function_parameters(&cured.cause, function);
    }
    if let (Some(law), Some((factor, _))) = (&cured.cause.law, cured.values.first()) {
        // Amplitudes come out in newtons or watts; the factor that was estimated beside belongs to them.
        let constant = |constant: &headland_symbolic::Constant| {
            let factor = if ["N", "W"].contains(&constant.unit.as_str()) { *factor } else { 1.0 };
            let (value, half) = (factor * constant.value, HALF_95 * factor * constant.sd.unwrap_or(0.0));
            one(&constant.name, value, [value - half, value + half], &constant.unit)
        };
        return law.constants.iter().map(constant).collect();
    }
    match cured.cause.id {
        "wind" => {
            let [(north, north_ci), (east, east_ci), ..] = cured.values[..] else { return Vec::new() };
            let sd = |ci: [f64; 2]| (ci[1] - ci[0]) / (2.0 * HALF_95);
            let speed = north.hypot(east);
            let from = east.atan2(north).rem_euclid(std::f64::consts::TAU);
            let along = (north * sd(north_ci)).hypot(east * sd(east_ci)) / speed.max(1e-9);
            let across = (east * sd(north_ci)).hypot(north * sd(east_ci)) / speed.max(1e-9).powi(2);
            vec![
                one("speed_m_s", speed, [(speed - HALF_95 * along).max(0.0), speed + HALF_95 * along], "m/s"),
                one("from_rad", from, [from - HALF_95 * across, from + HALF_95 * across], "rad"),
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

fn function_parameters(cause: &Cause, function: &crate::profile::Function) -> Vec<ParameterReport> {
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
            ci95: [peak.0 - HALF_95 * peak.1, peak.0 + HALF_95 * peak.1],
            unit: term.unit.to_owned(),
        },
        ParameterReport {
            name: format!("{}_rms", term.name),
            value: rms,
            ci95: [rms - HALF_95 * peak.1, rms + HALF_95 * peak.1],
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
    for rival in &cured.accepted.rivals {
        let own = case.causes[rival.cause].experiment;
        if !runs.contains(&own) {
            runs.push(own);
        }
    }
    runs.truncate(3);
    runs.join("; or ")
}

fn effects(case: &Case, proof: &Proof) -> Result<Vec<Run>, DiagnoseError> {
    let mut runs = Vec::new();
    for (index, drive) in case.runs.iter().enumerate() {
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
    let correction = |(id, value): (&str, f64)| match id {
        "latency" => Some(("speed_m_s".to_owned(), value, 1.0, 0.0)),
        "speed_scale" => Some(("speed_m_s".to_owned(), 0.0, 1.0 + value, 0.0)),
        "force_scale" => Some(("tractive_force_n".to_owned(), 0.0, 1.0 + value, 0.0)),
        "accelerometer_bias" => Some(("specific_force_m_s2".to_owned(), 0.0, 1.0, value)),
        _ => None,
    };
    refined.artefacts().filter_map(correction).collect()
}

fn residuals(case: &Case, system: &System, found: &Found) -> Vec<LeftOver> {
    let mut all = Vec::new();
    for (number, kind) in system.kinds.iter().enumerate() {
        for (run, recorded) in case.runs.iter().enumerate() {
            let (mut times, mut before, mut after) = (Vec::new(), Vec::new(), Vec::new());
            for (index, chunk) in system.chunks.iter().enumerate() {
                if chunk.run == run && chunk.balance == number {
                    times.extend(chunk.rows.iter().map(|row| row.time_s));
                    before.extend(found.before[index].iter());
                    after.extend(found.left[index].iter());
                }
            }
            let id = recorded.measured.id.clone();
            all.push(LeftOver { balance: *kind, run: id, time_s: times, before, after });
        }
    }
    all
}
