//! A second opinion, where a map of the ground took what may be many things.
//!
//! A map is free to be almost anything along a path, and takes the place of what any other cause does on average there; a search
//! that begins with it may not come back. Where it is claimed and looks like that, by lying off nought all along or by leaving
//! more than noise, the runs are looked at once more without it, and the runs that were held out decide.

use crate::report::{Diagnosed, Diagnosis, Fit, FitRuns, Verdict};
use crate::{DiagnoseError, Options};

/// What is free to be almost anything.
const MAP: &str = "soft_ground";
/// The same with one value.
const LEVEL: &str = "rolling_resistance";
/// What is left is this many times the noise, and more.
const MORE_THAN_NOISE: f64 = 1.5;
/// The error with another set of causes has to be less than this share of what it is with the map.
const BETTER: f64 = 0.8;

/// Whether it is asked for.
fn wanted(first: &Diagnosis) -> bool {
    let map = first.findings.iter().find(|finding| finding.id == MAP);
    map.is_some_and(|map| {
        let level = map.indistinguishable_from.iter().any(|rival| rival.id == LEVEL);
        level || first.fit.lack_of_fit > MORE_THAN_NOISE
    })
}

/// Whether runs are told better by another set of causes: those held out, and those fitted no worse.
fn is_better(other: &Diagnosis, first: &Diagnosis) -> bool {
    let claims = !other.findings.is_empty() && other.verdict != Verdict::None;
    let errors = |fit: &Fit| -> (f64, f64) {
        let after = |runs: &FitRuns| runs.rmse_after;
        (after(&fit.fitted), fit.held_out.as_ref().map_or_else(|| after(&fit.fitted), after))
    };
    let ((fitted, held_out), (fitted_first, held_out_first)) = (errors(&other.fit), errors(&first.fit));
    claims
        && other.fit.signal == first.fit.signal
        && held_out < BETTER * held_out_first
        && fitted < fitted_first
}

/// The first opinion, or the one without the map where that is better; `look` looks with other options.
pub fn opinion(
    first: Diagnosed,
    options: &Options,
    look: impl Fn(&Options) -> Result<Diagnosed, DiagnoseError>,
) -> Result<Diagnosed, DiagnoseError> {
    if !wanted(&first.diagnosis) {
        return Ok(first);
    }
    let without = options.without.iter().cloned().chain([MAP.to_owned()]).collect();
    let other = match look(&Options { without, ..options.clone() }) {
        Ok(other) => other,
        Err(DiagnoseError::NoBalance { .. }) => return Ok(first),
        Err(error) => return Err(error),
    };
    Ok(if is_better(&other.diagnosis, &first.diagnosis) { other } else { first })
}
