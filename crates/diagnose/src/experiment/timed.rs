//! What would tell of a function of time. No other run shares it, so no run can be drafted; but how well it is known, whether
//! the runs at hand repeat it, and how the odds grow with their number is in the data.

use super::null_space::listed;
use super::{Candidate, TELLS};
use crate::Case;
use crate::causes::catalogue::Form;
use crate::causes::cycles::correlation;
use crate::causes::profile::Function;
use crate::proof::refine::{Cured, HALF_95};
use crate::told::words::number;
use headland_calibrate::statistics::median;

/// Functions that are correlated by more than this in every two runs take the same course.
const ALIKE: f64 = 0.8;
/// Functions are held against each other at so many times.
const TIMES: u32 = 60;
/// Nobody drives the same run more often than this.
const MOST_RUNS: f64 = 30.0;

/// What to drive or log next.
pub fn next(case: &Case, cured: &Cured, rivals: &[Candidate]) -> Option<String> {
    let function = cured.function()?;
    let (low, high, sd) = reach(case, function)?;
    let unit = cured.cause.terms.first().map_or("", |term| term.unit);
    let amount = |value: f64| match unit {
        "1" => number(value),
        unit => format!("{} {unit}", number(value)),
    };
    let by_run = cured.cause.by_run;
    let repeated = match repeated(case, function) {
        _ if by_run => "each run has its own, so further runs tell nothing of these".to_owned(),
        Some((runs, least)) if least > ALIKE => format!(
            "its course has one shape in the {runs} runs at hand, of whatever size (correlation {least:.2} at least), so it goes with the \
             clock or with what is driven; drive another cycle to tell which"
        ),
        Some((runs, least)) => format!(
            "it takes another course in each of the {runs} runs at hand (correlation down to {least:.2}), so further runs \
             tell nothing of it"
        ),
        None => format!(
            "drive the same run once more: whether it comes back would be told wherever it changes by more than {}",
            amount(HALF_95 * std::f64::consts::SQRT_2 * sd)
        ),
    };
    let rivals: Vec<(&'static str, f64)> = rivals.iter().map(|one| (one.id, one.behind)).collect();
    let more = more_of_the_same(case, &rivals).map_or(String::new(), |more| format!("; {more}"));
    Some(format!(
        "{}: {} it is known to ±{} between {} and {}, so a log of that resolution would prove it; {repeated}{more}",
        cured.cause.experiment,
        if by_run { "in each run" } else { "at each time" },
        number(HALF_95 * sd),
        number(low),
        amount(high),
    ))
}

/// How many runs like those at hand would tell a cause from rivals, where one of the two is a function of time: each run
/// pays for its own function, so the odds grow with the number of runs.
pub fn more_of_the_same(case: &Case, rivals: &[(&'static str, f64)]) -> Option<String> {
    if rivals.is_empty() {
        return None;
    }
    let runs = case.fit.iter().filter(|fit| **fit).count() as f64;
    let told = |(id, now): &(&'static str, f64)| {
        let more = (TELLS * runs / now.max(0.0) - runs).ceil().max(1.0);
        if more > MOST_RUNS {
            return format!("not even {MOST_RUNS} runs like these would tell it from `{id}`");
        }
        let these = if more > 1.0 { "runs like these" } else { "run like these" };
        format!(
            "{more} {these} should tell it from `{id}` (the {runs} at hand give ln p {now:.1} of {TELLS})"
        )
    };
    Some(listed(&rivals.iter().map(told).collect::<Vec<_>>()))
}

/// Least and greatest value over the runs that were fitted, and the usual standard deviation.
fn reach(case: &Case, function: &Function) -> Option<(f64, f64, f64)> {
    let (mut all, mut sds) = (Vec::new(), Vec::new());
    let told = |group: usize| function.spread.shared || case.fit[group];
    for (_, (values, sd)) in function.values.iter().enumerate().filter(|(group, _)| told(*group)) {
        all.extend(values.iter().copied());
        sds.extend(sd.iter().copied());
    }
    let low = all.iter().copied().reduce(f64::min)?;
    let high = all.iter().copied().reduce(f64::max)?;
    Some((low, high, median(&sds)))
}

/// The number of runs that were fitted and the least correlation between two of their functions.
fn repeated(case: &Case, function: &Function) -> Option<(usize, f64)> {
    let fitted: Vec<usize> = (0..case.runs.len()).filter(|run| case.fit[*run]).collect();
    let start_s = |run: usize| case.runs[run].measured.trace.time_s().first().copied().unwrap_or(0.0);
    let duration_s = |run: &usize| case.runs[*run].measured.trace.duration_s();
    let shortest_s = fitted.iter().map(duration_s).reduce(f64::min)?;
    let courses: Vec<Vec<f64>> = fitted
        .iter()
        .map(|run| {
            let at = |index: u32| start_s(*run) + shortest_s * f64::from(index) / f64::from(TIMES);
            let group = function.group_of(Form::OverTime, &case.runs[*run]);
            (0..=TIMES).map(|index| function.value(group, at(index))).collect()
        })
        .collect();
    let pairs = (0..courses.len()).flat_map(|one| (0..one).map(move |other| (one, other)));
    let least = pairs.map(|(one, other)| correlation(&courses[one], &courses[other])).reduce(f64::min)?;
    least.is_finite().then_some((fitted.len(), least))
}
