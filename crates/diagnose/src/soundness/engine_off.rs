//! Engines that somebody switched off: no fuel while the vehicle stands, where the model's engine idles. That is no mismatch of
//! physics; it is what was done.

use crate::Case;
use crate::runs::recorded::Recorded;
use crate::soundness::faults::{SLOWEST_M_S, stretches};

/// A shorter time without fuel may be one that a sensor missed [s].
const LEAST_S: f64 = 2.0;
/// Less than this share of what the model's engine takes is nothing.
const NOTHING: f64 = 0.05;

/// Leaves samples out at which engines were off, and notes how long they were.
pub fn leave_out(case: &mut Case, usable: &mut [Vec<bool>]) {
    let mut told: Vec<String> = Vec::new();
    for (run, usable) in case.runs.iter().zip(usable.iter_mut()) {
        let modelled = case.nominal[run.number].fuel_kg_s.as_deref().unwrap_or(&[]);
        let off = off(run, modelled);
        let time_s = run.measured.trace.time_s();
        let whole_s: f64 = off.iter().map(|(from, to)| time_s[*to] - time_s[*from]).sum();
        if whole_s > 0.0 {
            told.push(format!("{} ({whole_s:.0} s)", run.measured.id));
        }
        for (from, to) in off {
            usable[from..=to].fill(false);
        }
    }
    if !told.is_empty() {
        case.study.notes.push(format!(
            "No fuel was taken while the vehicle stood, as by an engine that is off, in {}; the scenario's engine idles then, so \
             those samples were left out.",
            told.join(", ")
        ));
    }
}

/// First and last samples of the stretches of a run in which its engine was off.
fn off(run: &Recorded, modelled: &[f64]) -> Vec<(usize, usize)> {
    let Some(fuel) = run.measured.trace.get("fuel_rate_kg_s") else { return Vec::new() };
    let time_s = run.measured.trace.time_s();
    let is_off =
        |index: usize| run.motion.value[index].abs() < SLOWEST_M_S && fuel[index] < NOTHING * modelled[index];
    let mut all = stretches(is_off, modelled.len().min(fuel.len()));
    all.retain(|(from, to)| time_s[*to] - time_s[*from] >= LEAST_S);
    // A mean that reaches over its ends holds some of it.
    all.iter().map(|(from, to)| (from.saturating_sub(1), (to + 1).min(fuel.len() - 1))).collect()
}
