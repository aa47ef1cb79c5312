//! One diagnosis against one truth.

use super::diagnosis::{Diagnosis, Finding, Fit, Interval};
use super::statistics::correlation;
use crate::truth::{Cause, Prior, Truth};
use headland_trace::Run;
use std::f64::consts::{PI, TAU};

/// What became of a hidden cause.
///
/// A cause leads where it is among as many first findings as there are hidden causes. A twin of a cause is one that
/// nobody could tell from it in these runs (`Cause::twins`). It is as good as the cause only where it does the same in
/// effect: where it was named with the cause as its alternative, or where the reconstruction is right ([`IN_EFFECT`]).
/// An unlisted cause is right where it was said to be unlisted and its reconstruction is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Found {
    /// It leads.
    Right,
    /// The verdict is `cannot_tell`, and it is named as the finding or as its alternative.
    Honest,
    /// A twin of it leads, and does the same in effect.
    Twin,
    /// Named as an alternative of a leading finding under another verdict.
    Alternative,
    /// It was said to be unlisted, as it is, and its reconstruction is wrong.
    Rough,
    /// Found, and something else before it.
    Behind,
    /// Something else was claimed.
    Wrong,
    /// Nothing was claimed.
    Missed,
}

impl Found {
    /// Whether it is as good as a diagnosis can be.
    pub fn good(self) -> bool {
        matches!(self, Self::Right | Self::Honest | Self::Twin)
    }
}

/// R² of a reconstruction that is right.
pub const IN_EFFECT: f64 = 0.9;

/// Laws that differ from run to run: what they do in a run that was held out no other run can show.
const OF_EACH_RUN: [&str; 4] =
    ["braking", "drawbar_load/spells", "auxiliary_power/switched", "regeneration_limit"];

/// How well intervals cover.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Covered {
    /// Intervals that hold the truth.
    pub hits: usize,
    /// Intervals that were given.
    pub trials: usize,
}

/// A reconstructed force or power against the true one, over the runs that were held out; over those that were fitted
/// where a law differs from run to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reconstruction {
    /// Correlation; NaN where the truth does not vary.
    pub correlation: f64,
    /// 1 − Σ(found − true)²/Σ(true − mean)², about 0 where the truth hardly varies.
    pub r2: f64,
    /// Slope of found over true.
    pub slope: f64,
}

/// Share of the possible improvement on held-out runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Improvement {
    /// (before − after) / (before − best).
    pub share: f64,
    /// Whether the best is that of the true effect with the true parameters; else it is the noise of the sensor, which
    /// nothing can reach.
    pub by_oracle: bool,
}

/// The score of a case.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The verdict.
    pub verdict: String,
    /// Ids of the findings, in their order.
    pub claimed: Vec<String>,
    /// What became of each hidden cause.
    pub found: Vec<Found>,
    /// Listed physics that is claimed and not there.
    pub false_physics: Vec<String>,
    /// Faults of sensors that are claimed and not there.
    pub false_artefacts: Vec<String>,
    /// Intervals of the parameters of causes that were found.
    pub parameters: Covered,
    /// Intervals of the nominal parameters that were moved.
    pub calibrated: Covered,
    /// Reconstruction of the physics that was hidden.
    pub reconstruction: Option<Reconstruction>,
    /// Share of the possible improvement on held-out runs that was reached.
    pub improvement: Option<Improvement>,
    /// Whether a twin of a hidden cause was claimed, right in effect or not.
    pub twin: bool,
}

/// Judges. The oracle is a diagnosis of the true model: its errors before anything is found are the best there are.
pub fn judge(
    truth: &Truth,
    diagnosis: &Diagnosis,
    oracle: Option<&Diagnosis>,
    along: &[Run],
    effects: &[Run],
) -> Outcome {
    // What is true of every plant neither counts nor takes a place, unless it is what was hidden.
    let hidden = |id: &str| truth.hidden.iter().any(|cause| cause.id == id);
    let known = |finding: &&Finding| !truth.also_true.contains(&finding.id) || hidden(&finding.id);
    let findings: Vec<&Finding> = diagnosis.findings.iter().filter(known).collect();
    let reconstruction = reconstruction(truth, diagnosis, along, effects);
    let close = reconstruction.is_some_and(|force| force.r2 >= IN_EFFECT);
    let found: Vec<Found> =
        truth.hidden.iter().map(|cause| became(cause, &findings, truth, &diagnosis.verdict, close)).collect();
    let twin_of =
        |finding: &Finding, cause: &Cause| finding.kind == cause.class && cause.twins.contains(&finding.id);
    let a_twin = |finding: &Finding| truth.hidden.iter().any(|cause| twin_of(finding, cause));
    let as_good = |finding: &Finding| {
        let stands_for = |(cause, found): (&Cause, &Found)| *found == Found::Twin && twin_of(finding, cause);
        truth.hidden.iter().zip(&found).any(stands_for)
    };
    let claims = |kind: &str| -> Vec<String> {
        let of = |finding: &&&Finding| {
            finding.kind == kind && !hidden(&finding.id) && !names(finding, truth) && !as_good(finding)
        };
        findings.iter().filter(of).map(|finding| finding.id.clone()).collect()
    };
    let mut parameters = Covered::default();
    for cause in &truth.hidden {
        if let Some(finding) = findings.iter().find(|finding| is(finding, &cause.id)) {
            for told in &cause.parameters {
                count(
                    &mut parameters,
                    finding.parameters.iter().find(|one| one.name == told.name),
                    told.value,
                );
            }
        }
    }
    let mut calibrated = Covered::default();
    for prior in truth.nominal.iter().filter(|prior| prior.free) {
        let named =
            |one: &&Interval| one.name == prior.path || prior.path.ends_with(&format!(".{}", one.name));
        count(&mut calibrated, diagnosis.calibrated.iter().find(named), prior.truth);
    }
    Outcome {
        verdict: diagnosis.verdict.clone(),
        claimed: findings.iter().map(|finding| finding.id.clone()).collect(),
        found: found.clone(),
        false_physics: claims("physics"),
        false_artefacts: claims("artefact"),
        parameters,
        calibrated,
        reconstruction,
        improvement: improvement(truth, diagnosis, oracle),
        twin: findings.iter().any(|finding| a_twin(finding)),
    }
}

fn is(finding: &Finding, id: &str) -> bool {
    finding.id == id || (id == "unlisted" && finding.kind == "unlisted")
}

/// Whether one of its alternatives is a hidden cause.
fn names(finding: &Finding, truth: &Truth) -> bool {
    truth.hidden.iter().any(|cause| finding.indistinguishable_from.iter().any(|other| other.id == cause.id))
}

fn became(cause: &Cause, findings: &[&Finding], truth: &Truth, verdict: &str, close: bool) -> Found {
    let first = &findings[..findings.len().min(truth.hidden.len())];
    let alternative =
        |finding: &&&Finding| finding.indistinguishable_from.iter().any(|other| other.id == cause.id);
    let doubts = verdict == "cannot_tell";
    if first.iter().any(|finding| is(finding, &cause.id)) {
        return match (cause.id == "unlisted" && !close, doubts) {
            (true, _) => Found::Rough,
            (false, true) => Found::Honest,
            (false, false) => Found::Right,
        };
    }
    if findings.iter().any(|finding| alternative(&finding)) {
        let twin = |finding: &&&Finding| {
            finding.kind == cause.class && cause.twins.contains(&finding.id) && alternative(finding)
        };
        return match (doubts, first.iter().any(|finding| twin(&finding))) {
            (true, _) => Found::Honest,
            (false, true) => Found::Twin,
            (false, false) => Found::Alternative,
        };
    }
    let twin = |finding: &&&Finding| finding.kind == cause.class && cause.twins.contains(&finding.id);
    if close && first.iter().any(|finding| twin(&finding)) {
        return Found::Twin;
    }
    if findings.iter().any(|finding| is(finding, &cause.id)) {
        return Found::Behind;
    }
    if findings.is_empty() { Found::Missed } else { Found::Wrong }
}

fn count(covered: &mut Covered, interval: Option<&Interval>, truth: f64) {
    let Some(Interval { name, ci95: Some([Some(low), Some(high)]), .. }) = interval else { return };
    covered.trials += 1;
    let inside = if name.ends_with("_rad") && high - low < TAU {
        // An angle: the truth may lie a turn away.
        let middle = 0.5 * (low + high);
        let away = (truth - middle + PI).rem_euclid(TAU) - PI;
        away.abs() <= 0.5 * (high - low)
    } else {
        (*low..=*high).contains(&truth)
    };
    covered.hits += usize::from(inside);
}

/// Share of rmse that goes away, of what goes away with the true effect and the true parameters; where these cannot be
/// written as a scenario, of what goes away when only noise is left.
fn improvement(truth: &Truth, diagnosis: &Diagnosis, oracle: Option<&Diagnosis>) -> Option<Improvement> {
    /// A mismatch below this many times the best has nothing to improve.
    const WORTH: f64 = 1.5;
    let physics = truth.hidden.iter().all(|cause| cause.class == "physics");
    let of_each_run = truth.hidden.iter().any(|cause| OF_EACH_RUN.contains(&cause.law.as_str()));
    if truth.hidden.is_empty() || !physics || of_each_run {
        return None;
    }
    let fit = diagnosis.fit.as_ref()?;
    let held_out = fit.held_out.as_ref()?;
    let (before, after) = (held_out.rmse_before?, held_out.rmse_after?);
    let same = |other: &&Fit| {
        other.signal == fit.signal && other.held_out.as_ref().is_some_and(|part| part.runs == held_out.runs)
    };
    let best = oracle
        .and_then(|oracle| oracle.fit.as_ref())
        .filter(same)
        .and_then(|other| other.held_out.as_ref()?.rmse_before);
    let (best, by_oracle) = match best {
        Some(best) => (best, true),
        None => (*truth.noise.get(&fit.signal)?, false),
    };
    (before > WORTH * best).then(|| Improvement { share: (before - after) / (before - best), by_oracle })
}

/// Which kind of quantity a column holds, by the end of its name.
fn unit(column: &str) -> &'static str {
    if column.ends_with("_w") {
        "_w"
    } else if column.contains("_m_s") {
        "_m_s"
    } else {
        "_n"
    }
}

/// All hidden physics of one unit together against all that was reconstructed in it.
fn reconstruction(
    truth: &Truth,
    diagnosis: &Diagnosis,
    along: &[Run],
    effects: &[Run],
) -> Option<Reconstruction> {
    let causes: Vec<&Cause> = truth.hidden.iter().filter(|cause| cause.class == "physics").collect();
    // What a faulty sensor amounts to is no physics.
    let of_a_sensor = |column: &str| {
        let mut faults = diagnosis.findings.iter().filter(|finding| finding.kind == "artefact");
        faults.any(|finding| column.strip_prefix(&finding.id).is_some_and(|rest| rest.starts_with('_')))
    };
    let columns = |effect: &Run, suffix: &str| -> Vec<String> {
        let fits = |name: &&str| {
            name.ends_with(suffix) && !name.contains("_low") && !name.contains("_high") && !of_a_sensor(name)
        };
        let names = effect.trace.channels().iter().map(|channel| channel.name.as_str());
        names.filter(fits).map(str::to_owned).collect()
    };
    let mut suffix = unit(&causes.first()?.column);
    let any = |suffix: &str| effects.iter().any(|effect| !columns(effect, suffix).is_empty());
    if suffix == "_n" && !any("_n") && any("_w") && causes[0].power_column.is_some() {
        // A force that only fuel shows is reconstructed as the power that it takes.
        suffix = "_w";
    }
    let in_unit =
        |cause: &&&Cause| unit(&cause.column) == suffix || (suffix == "_w" && cause.power_column.is_some());
    let column_of = |cause: &Cause| match &cause.power_column {
        Some(column) if suffix == "_w" => column.clone(),
        _ => cause.column.clone(),
    };
    // What was hidden is told as the power of the fuel, an equation of the shaft's balance as that of the shaft.
    let named = |one: &&Prior| one.path.ends_with("willans_efficiency");
    let fuel_per_shaft = truth.nominal.iter().find(named).map_or(1.0, |one| 1.0 / one.truth);
    let as_hidden = |column: &str| {
        let mut found = diagnosis.findings.iter();
        let of_shaft = found.any(|finding| {
            finding.kind == "unlisted" && finding.balance == "shaft" && column.starts_with(&finding.id)
        });
        if of_shaft && column.ends_with("_w") { fuel_per_shaft } else { 1.0 }
    };
    let told = (!truth.held_out.is_empty()).then(|| truth.held_out.clone());
    let chosen =
        || diagnosis.fit.as_ref().and_then(|fit| fit.held_out.as_ref()).map(|part| part.runs.clone());
    let held_out = told.or_else(chosen).unwrap_or_default();
    let of_each_run = causes.iter().any(|cause| OF_EACH_RUN.contains(&cause.law.as_str()));
    let (mut found, mut true_one) = (Vec::new(), Vec::new());
    for run in along.iter().filter(|run| held_out.contains(&run.id) != of_each_run) {
        let Some(effect) = effects.iter().find(|effect| effect.id == run.id) else { continue };
        let columns = columns(effect, suffix);
        if columns.is_empty() {
            continue;
        }
        for (row, time_s) in run.trace.time_s().iter().enumerate() {
            let sum: f64 = columns
                .iter()
                .filter_map(|name| Some(as_hidden(name) * effect.trace.at(name, *time_s)?))
                .sum();
            let hidden: f64 = causes
                .iter()
                .filter(in_unit)
                .filter_map(|cause| run.trace.get(&column_of(cause)).map(|values| values[row]))
                .sum();
            if sum.is_finite() && hidden.is_finite() {
                found.push(sum);
                true_one.push(hidden);
            }
        }
    }
    (true_one.len() > 10).then(|| compare(&found, &true_one))
}

fn compare(found: &[f64], true_one: &[f64]) -> Reconstruction {
    /// A truth that varies by less than this share of its size is a constant.
    const CONSTANT: f64 = 0.05;
    let n = true_one.len() as f64;
    let mean = true_one.iter().sum::<f64>() / n;
    let square: f64 = true_one.iter().map(|value| value * value).sum();
    let spread: f64 = true_one.iter().map(|value| (value - mean).powi(2)).sum();
    let error: f64 = found.iter().zip(true_one).map(|(found, truth)| (found - truth).powi(2)).sum();
    let product: f64 = found.iter().zip(true_one).map(|(found, truth)| found * truth).sum();
    let varies = (spread / square).sqrt() > CONSTANT;
    Reconstruction {
        correlation: if varies { correlation(found, true_one) } else { f64::NAN },
        r2: 1.0 - error / if varies { spread } else { square },
        slope: product / square,
    }
}

#[cfg(test)]
#[path = "judge_tests.rs"]
mod tests;
