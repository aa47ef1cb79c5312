//! One diagnosis against one truth.

use super::diagnosis::{Diagnosis, Finding, Interval};
use super::statistics::correlation;
use crate::truth::{Cause, Truth};
use headland_trace::Run;
use std::f64::consts::{PI, TAU};

/// What became of a hidden cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Found {
    /// It leads: among the first findings, as many as there are causes.
    Right,
    /// The verdict is `cannot_tell`, and it is named as the finding or as its alternative.
    Honest,
    /// Named as an alternative of a leading finding under another verdict.
    Alternative,
    /// Found, and something else before it.
    Behind,
    /// Something else was claimed.
    Wrong,
    /// Nothing was claimed.
    Missed,
}

/// How well intervals cover.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Covered {
    /// Intervals that hold the truth.
    pub hits: usize,
    /// Intervals that were given.
    pub trials: usize,
}

/// A reconstructed force or power against the true one, over the runs that were held out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reconstruction {
    /// Correlation; NaN where the truth does not vary.
    pub correlation: f64,
    /// 1 − Σ(found − true)²/Σ(true − mean)², about 0 where the truth hardly varies.
    pub r2: f64,
    /// Slope of found over true.
    pub slope: f64,
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
    pub improvement: Option<f64>,
}

/// Judges.
pub fn judge(truth: &Truth, diagnosis: &Diagnosis, along: &[Run], effects: &[Run]) -> Outcome {
    // What is true of every plant neither counts nor takes a place, unless it is what was hidden.
    let hidden = |id: &str| truth.hidden.iter().any(|cause| cause.id == id);
    let known = |finding: &&Finding| !truth.also_true.contains(&finding.id) || hidden(&finding.id);
    let findings: Vec<&Finding> = diagnosis.findings.iter().filter(known).collect();
    let leading = truth.hidden.len();
    let found: Vec<Found> =
        truth.hidden.iter().map(|cause| became(cause, &findings, leading, &diagnosis.verdict)).collect();
    let claims = |kind: &str| -> Vec<String> {
        let of = |finding: &&&Finding| finding.kind == kind && !hidden(&finding.id) && !names(finding, truth);
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
        found,
        false_physics: claims("physics"),
        false_artefacts: claims("artefact"),
        parameters,
        calibrated,
        reconstruction: reconstruction(truth, diagnosis, along, effects),
        improvement: improvement(truth, diagnosis),
    }
}

fn is(finding: &Finding, id: &str) -> bool {
    finding.id == id || (id == "unlisted" && finding.kind == "unlisted")
}

/// Whether one of its alternatives is a hidden cause.
fn names(finding: &Finding, truth: &Truth) -> bool {
    truth.hidden.iter().any(|cause| finding.indistinguishable_from.iter().any(|other| other.id == cause.id))
}

fn became(cause: &Cause, findings: &[&Finding], leading: usize, verdict: &str) -> Found {
    let first = &findings[..findings.len().min(leading)];
    let alternative =
        |finding: &&&Finding| finding.indistinguishable_from.iter().any(|other| other.id == cause.id);
    if first.iter().any(|finding| is(finding, &cause.id)) {
        return if verdict == "cannot_tell" { Found::Honest } else { Found::Right };
    }
    if findings.iter().any(|finding| alternative(&finding)) {
        return if verdict == "cannot_tell" { Found::Honest } else { Found::Alternative };
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

/// Share of rmse that goes away, of what goes away when only noise is left.
fn improvement(truth: &Truth, diagnosis: &Diagnosis) -> Option<f64> {
    /// A mismatch below this many times the noise has nothing to improve.
    const WORTH: f64 = 1.5;
    let fit = diagnosis.fit.as_ref()?;
    let noise = *truth.noise.get(&fit.signal)?;
    let held_out = fit.held_out.as_ref()?;
    let (before, after) = (held_out.rmse_before?, held_out.rmse_after?);
    (before > WORTH * noise).then(|| (before - after) / (before - noise))
}

/// All hidden physics of one unit together against all that was reconstructed in it.
fn reconstruction(
    truth: &Truth,
    diagnosis: &Diagnosis,
    along: &[Run],
    effects: &[Run],
) -> Option<Reconstruction> {
    let unit = |column: &str| {
        if column.ends_with("_w") {
            "_w"
        } else if column.contains("_m_s") {
            "_m_s"
        } else {
            "_n"
        }
    };
    let causes: Vec<&Cause> = truth.hidden.iter().filter(|cause| cause.class == "physics").collect();
    let suffix = unit(&causes.first()?.column);
    // What a faulty sensor amounts to is no physics.
    let of_a_sensor = |column: &str| {
        let mut faults = diagnosis.findings.iter().filter(|finding| finding.kind == "artefact");
        faults.any(|finding| column.strip_prefix(&finding.id).is_some_and(|rest| rest.starts_with('_')))
    };
    let (mut found, mut true_one) = (Vec::new(), Vec::new());
    for run in along.iter().filter(|run| truth.held_out.contains(&run.id)) {
        let Some(effect) = effects.iter().find(|effect| effect.id == run.id) else { continue };
        let columns: Vec<&str> = effect
            .trace
            .channels()
            .iter()
            .map(|channel| channel.name.as_str())
            .filter(|name| {
                name.ends_with(suffix)
                    && !name.contains("_low")
                    && !name.contains("_high")
                    && !of_a_sensor(name)
            })
            .collect();
        if columns.is_empty() {
            continue;
        }
        for (row, time_s) in run.trace.time_s().iter().enumerate() {
            let sum: f64 = columns.iter().filter_map(|name| effect.trace.at(name, *time_s)).sum();
            let hidden: f64 = causes
                .iter()
                .filter(|cause| unit(&cause.column) == suffix)
                .filter_map(|cause| run.trace.get(&cause.column).map(|values| values[row]))
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
