//! Stretches in which a battery gives less than the drive takes from it, by more than any loss could be wrong: nothing that was
//! left out of a model makes energy. Either another source feeds the drive there, or one of the two was recorded wrongly; whatever
//! explained it would be a consumer that gives. What was recorded of the battery there is left out of its balance.
//!
//! P + α |P_m| < P_m − 0.1 P₉₅   over the mean of some seconds, for every shift of the two against each other that clocks may have;
//! P recorded, P_m as the recorded torque or force takes it, α what efficiencies may be wrong by, P₉₅ what the drive takes at most.

use crate::causes::sensors::with_channel;
use crate::runs::recorded::Recorded;
use crate::soundness::faults::stretches;
use crate::{Case, DiagnoseError};
use headland_calibrate::statistics::{quantile_of_sorted, sorted};

/// Means over so long to either side are compared [s]: a current that is held or filtered has given by then what it gives.
const AROUND_S: f64 = 2.5;
/// Clocks of two loggers may be so far apart [s].
const APART_S: f64 = 2.0;
/// An efficiency may be wrong by this share of the power.
const EFFICIENCY: f64 = 0.2;
/// And this share of the greatest power has to be missing beyond that.
const MATTERS: f64 = 0.1;
/// What is missing for a greater share of all the time, or of that of a run, is no slip of a logger but how things are.
const RARE: f64 = 0.02;
const RARE_IN_A_RUN: f64 = 0.25;
const POWER: &str = "battery_power_w";

/// Leaves out what was recorded of the battery in such stretches, and notes where they lie.
pub fn leave_out(case: &mut Case) -> Result<(), DiagnoseError> {
    let sourceless: Vec<Vec<bool>> = (0..case.runs.len()).map(|run| sourceless(case, run)).collect();
    let share =
        |flags: &[bool]| flags.iter().filter(|flag| **flag).count() as f64 / flags.len().max(1) as f64;
    let all: Vec<bool> = sourceless.iter().flatten().copied().collect();
    let usual = share(&all) > RARE || sourceless.iter().any(|flags| share(flags) > RARE_IN_A_RUN);
    if usual || !all.contains(&true) {
        return Ok(());
    }
    let mut told: Vec<String> = Vec::new();
    for (run, flags) in sourceless.iter().enumerate() {
        for (from, to) in stretches(|index| flags[index], flags.len()) {
            let time_s = case.runs[run].measured.trace.time_s();
            let (id, from_s, to_s) = (&case.runs[run].measured.id, time_s[from], time_s[to]);
            told.push(format!("{id} from {from_s:.0} to {to_s:.0} s"));
        }
        for own in [&mut case.runs[run], &mut case.raw[run]] {
            blank(own, flags)?;
        }
    }
    case.study.notes.push(format!(
        "The battery gives less than the drive takes from it in {}. Nothing that consumes does that: another source feeds the \
         drive, or one of the two was recorded wrongly. The power of the battery was left out there.",
        told.join(" and ")
    ));
    Ok(())
}

/// Forgets what was recorded of the battery at some samples.
fn blank(run: &mut Recorded, flags: &[bool]) -> Result<(), DiagnoseError> {
    let Some(power_w) = run.measured.trace.get(POWER) else { return Ok(()) };
    let kept = power_w.iter().zip(flags).map(|(power_w, flag)| if *flag { f64::NAN } else { *power_w });
    run.measured.trace = with_channel(&run.measured.trace, POWER, kept.collect())?;
    Ok(())
}

/// The samples of a run at which its battery gives too little.
fn sourceless(case: &Case, run: usize) -> Vec<bool> {
    let (own, said) = (&case.runs[run], &case.nominal[run]);
    let trace = &own.measured.trace;
    let none = vec![false; trace.len()];
    let (Some(given_w), Some(taken_w)) = (trace.get(POWER), &said.battery_w) else { return none };
    // What follows from the motion holds every slope that nobody knows.
    let finite = |values: &[f64]| values.iter().filter(|value| value.is_finite()).count() * 2 > values.len();
    if !own.force_is_known() || !finite(given_w) || !finite(taken_w) {
        return none;
    }
    let sizes: Vec<f64> = taken_w.iter().filter(|power| power.is_finite()).map(|power| power.abs()).collect();
    let least_w = MATTERS * quantile_of_sorted(&sorted(&sizes), 0.95);
    let spare: Vec<f64> = taken_w.iter().map(|taken| taken - EFFICIENCY * taken.abs()).collect();
    let (given, taken, spare) = (Means::of(given_w), Means::of(taken_w), Means::of(&spare));
    let time_s = trace.time_s();
    let around = |middle: usize, shift_s: f64| {
        let middle_s = time_s[middle] + shift_s;
        let from = time_s.partition_point(|time| *time < middle_s - AROUND_S);
        (from, time_s.partition_point(|time| *time <= middle_s + AROUND_S))
    };
    let lacks = |middle: usize, shift_s: f64| {
        let (gives_w, takes_w) = (given.over(around(middle, shift_s)), spare.over(around(middle, 0.0)));
        gives_w.zip(takes_w).is_some_and(|(gives_w, takes_w)| gives_w < takes_w - least_w)
    };
    let for_certain =
        |middle: &usize| [-1.0, -0.5, 0.0, 0.5, 1.0].iter().all(|share| lacks(*middle, share * APART_S));
    let seems = |middle: usize| {
        let means = given.over(around(middle, 0.0)).zip(taken.over(around(middle, 0.0)));
        means.is_some_and(|(gives_w, takes_w)| gives_w < takes_w)
    };
    let mut flags = none;
    for middle in (0..trace.len()).filter(for_certain) {
        // Where one stretch begins and ends nothing is certain: as far as nothing is left for any consumer.
        let (from, to) = around(middle, 0.0);
        let before = (0..from).rev().take_while(|index| !flags[*index] && seems(*index)).count();
        let after = (to..trace.len()).take_while(|index| seems(*index)).count();
        flags[from - before..to + after].fill(true);
    }
    flags
}

/// Means over stretches of samples.
struct Means {
    sums: Vec<f64>,
    unknown: Vec<usize>,
}

impl Means {
    fn of(values: &[f64]) -> Self {
        let (mut sums, mut unknown) = (vec![0.0], vec![0]);
        for (index, value) in values.iter().enumerate() {
            sums.push(sums[index] + if value.is_finite() { *value } else { 0.0 });
            unknown.push(unknown[index] + usize::from(!value.is_finite()));
        }
        Self { sums, unknown }
    }

    /// The mean from one sample to the other; none where any of them is unknown, or there are none.
    fn over(&self, (from, to): (usize, usize)) -> Option<f64> {
        let whole = to > from && self.unknown[to] == self.unknown[from];
        whole.then(|| (self.sums[to] - self.sums[from]) / (to - from) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_is_that_of_known_samples_alone() {
        let means = Means::of(&[1.0, 3.0, f64::NAN, 5.0]);
        assert_eq!(means.over((0, 2)), Some(2.0));
        assert_eq!(means.over((1, 3)), None);
        assert_eq!(means.over((3, 4)), Some(5.0));
        assert_eq!(means.over((2, 2)), None);
    }
}
