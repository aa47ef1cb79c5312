//! A calibration as a document, and the scenario that it leads to.

mod scenario;

pub use scenario::{scenario, with_folder};

use crate::arguments::HeldOptions;
use crate::held::{Pair, ToldNotice};
use headland_calibrate::fit::Fit;
use headland_calibrate::study::Study;
use headland_compare::{Total, metrics};
use headland_units::unit_of_name;
use serde::Serialize;

/// `calibration.json`.
#[derive(Debug, Serialize)]
pub struct Calibration {
    schema: &'static str,
    scenario: String,
    recording: String,
    converged: bool,
    /// What was found of each free parameter.
    pub estimates: Vec<Estimate>,
    /// Correlation of the estimates, in their order.
    pub correlation: Vec<Vec<f64>>,
    /// Error before and after, signal by signal.
    pub signals: Vec<Signal>,
    /// The same run by run, with totals.
    pub runs: Vec<RunFit>,
    /// What the data cannot separate.
    pub null_space: Vec<String>,
    /// What was decided on the way.
    pub notes: Vec<String>,
    /// What the recording shows about itself.
    pub notices: Vec<ToldNotice>,
}

/// One free parameter.
#[derive(Debug, Serialize)]
pub struct Estimate {
    /// Name.
    pub name: String,
    path: String,
    /// Unit.
    pub unit: String,
    /// Value before.
    pub prior: f64,
    prior_sd: Option<f64>,
    /// Value after.
    pub value: f64,
    standard_error: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Whether it ended at a bound.
    pub at_bound: bool,
}

/// Error of one signal.
#[derive(Debug, Serialize)]
pub struct Signal {
    /// Channel.
    #[serde(rename = "signal")]
    pub channel: String,
    /// Unit.
    pub unit: String,
    /// Over the fitted runs.
    pub fitted: Part,
    /// Over the runs that were never fitted.
    pub held_out: Part,
}

/// Error over some runs.
#[derive(Debug, Serialize)]
pub struct Part {
    /// The runs.
    pub runs: Vec<String>,
    /// Root mean square before.
    pub rmse_before: f64,
    /// Root mean square after.
    pub rmse_after: f64,
}

/// One run.
#[derive(Debug, Serialize)]
pub struct RunFit {
    /// Its name.
    pub run: String,
    /// Whether it was never fitted.
    pub held_out: bool,
    /// Signal, error before, error after.
    pub signals: Vec<SignalFit>,
    /// Totals before.
    pub totals_before: Vec<Total>,
    /// Totals after.
    pub totals_after: Vec<Total>,
}

/// One signal of one run.
#[derive(Debug, Serialize)]
pub struct SignalFit {
    /// Channel.
    #[serde(rename = "signal")]
    pub channel: String,
    /// Root mean square before.
    pub rmse_before: f64,
    /// Root mean square after.
    pub rmse_after: f64,
    /// Mean error after.
    pub bias_after: f64,
}

impl Calibration {
    /// Puts the document together.
    pub fn new(options: &HeldOptions, study: &Study, fit: &Fit, before: &[Pair], after: &[Pair]) -> Self {
        let estimate = |(estimate, path): (&headland_calibrate::fit::Estimate, &String)| Estimate {
            name: estimate.name.clone(),
            path: path.clone(),
            unit: unit(path),
            prior: estimate.prior,
            prior_sd: estimate.prior_sd,
            value: estimate.value,
            standard_error: estimate.standard_error,
            ci95: estimate.ci95,
            at_bound: estimate.at_bound,
        };
        Self {
            schema: "headland.calibration/1",
            scenario: options.scenario.display().to_string(),
            recording: options.recording.display().to_string(),
            converged: fit.converged,
            estimates: fit.estimates.iter().zip(study.paths()).map(estimate).collect(),
            correlation: fit.correlation.clone(),
            signals: signals(before, after),
            runs: before.iter().zip(after).map(run_fit).collect(),
            null_space: fit.null_space.clone(),
            notes: Vec::new(),
            notices: Vec::new(),
        }
    }
}

fn unit(path: &str) -> String {
    let end = path.rsplit('.').next().unwrap_or(path);
    unit_of_name(end).map_or_else(|| "1".to_owned(), |unit| unit.symbol)
}

fn signals(before: &[Pair], after: &[Pair]) -> Vec<Signal> {
    let mut names: Vec<&String> = Vec::new();
    for name in before.iter().flat_map(|pair| &pair.signals) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let part = |name: &str, held_out: bool| {
        let of = |pairs: &[Pair]| {
            let runs: Vec<(String, f64, usize)> = pairs
                .iter()
                .filter(|pair| pair.held_out == held_out)
                .filter_map(|pair| {
                    errors(pair, name).map(|(rmse, _, n)| (pair.comparison.run.clone(), rmse, n))
                })
                .collect();
            let count: usize = runs.iter().map(|(_, _, n)| n).sum();
            let square: f64 = runs.iter().map(|(_, rmse, n)| rmse * rmse * *n as f64).sum();
            (runs, (square / count as f64).sqrt())
        };
        let ((runs, rmse_before), (_, rmse_after)) = (of(before), of(after));
        Part { runs: runs.into_iter().map(|(run, ..)| run).collect(), rmse_before, rmse_after }
    };
    let signal = |name: &&String| Signal {
        channel: (*name).clone(),
        unit: unit(name),
        fitted: part(name, false),
        held_out: part(name, true),
    };
    names.iter().map(signal).collect()
}

/// RMSE, bias and number of pairs of a signal.
pub fn errors(pair: &Pair, name: &str) -> Option<(f64, f64, usize)> {
    let found = metrics(pair.measured.get(name)?, pair.outcome.trace.get(name)?).ok()?;
    Some((found.rmse, found.bias, found.pairs))
}

fn run_fit((before, after): (&Pair, &Pair)) -> RunFit {
    let signal = |name: &String| {
        let ((rmse_before, ..), (rmse_after, bias_after, _)) = (errors(before, name)?, errors(after, name)?);
        Some(SignalFit { channel: name.clone(), rmse_before, rmse_after, bias_after })
    };
    RunFit {
        run: before.comparison.run.clone(),
        held_out: before.held_out,
        signals: before.signals.iter().filter_map(signal).collect(),
        totals_before: before.comparison.totals.clone(),
        totals_after: after.comparison.totals.clone(),
    }
}
