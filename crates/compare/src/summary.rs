//! Many runs at a glance, and whether they meet what is required of them.

use crate::requirement::{Metric, Requirement, suggestion};
use crate::runs::{ChannelComparison, RunComparison};
use crate::total::{Sums, Total};
use crate::{CompareError, Dropped};
use std::fmt;

/// Name and version of the document.
pub const SCHEMA: &str = "headland.comparison/1";

/// One channel over the runs in which the model predicted it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ChannelSummary {
    /// Name.
    pub channel: String,
    /// Its unit.
    pub unit: String,
    /// Runs in which it was predicted; all that follows is over these.
    pub runs: usize,
    /// Pairs that have both values.
    pub pairs: usize,
    /// Samples of the recordings that are no pair.
    pub dropped: Dropped,
    /// Mean error over all pairs [unit of the channel].
    pub bias: f64,
    /// Root of the mean squared error over all pairs [unit of the channel].
    pub rmse: f64,
    /// Mean absolute error over all pairs [unit of the channel].
    pub mae: f64,
    /// The run with the largest RMSE.
    pub worst_run: String,
    /// Its RMSE [unit of the channel].
    pub worst_rmse: f64,
    /// Mean ISO 18571-style rating of the runs that can be rated.
    pub iso18571: Option<f64>,
    /// Runs in which the modelled distribution stays within the band of the measured one.
    pub within_band: usize,
}

/// The document `comparison.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Summary {
    /// Name and version of the document: `headland.comparison/1`.
    pub schema: &'static str,
    /// The channels that the model predicted in at least one run: all that can validate it.
    pub channels: Vec<ChannelSummary>,
    /// Totals over the runs in which the model predicted them.
    pub totals: Vec<Total>,
    /// Channels that were an input of the model in at least one run; those runs validate nothing of them.
    pub driven: Vec<String>,
    /// Every run.
    pub runs: Vec<RunComparison>,
}

/// Whether a requirement is met, by the run that is furthest from it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Check {
    /// What was required.
    pub requirement: Requirement,
    /// Whether every run meets it.
    pub met: bool,
    /// The worst number that was found, in [`Metric::unit_for`] the channel.
    pub found: f64,
    /// The run it was found in.
    pub run: String,
    /// Runs that were looked at.
    pub runs: usize,
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.met { "met" } else { "not met" };
        write!(f, "{verdict}: {}; found {:.4} in run `{}`", self.requirement, self.found, self.run)?;
        if self.runs > 1 { write!(f, ", the worst of {}", self.runs) } else { Ok(()) }
    }
}

/// Puts runs together, in their order. Channels and totals are in the order in which they first occur.
pub fn summarise(runs: &[RunComparison]) -> Summary {
    let names = |keep: fn(&ChannelComparison) -> bool| {
        unique(
            runs.iter().flat_map(|run| &run.channels).filter(|found| keep(found)).map(|found| &found.channel),
        )
    };
    Summary {
        schema: SCHEMA,
        channels: names(|found| !found.driven)
            .iter()
            .filter_map(|name| channel_summary(name, runs))
            .collect(),
        totals: totals(runs),
        driven: names(|found| found.driven),
        runs: runs.to_vec(),
    }
}

fn unique<'a>(names: impl Iterator<Item = &'a String>) -> Vec<String> {
    let mut unique: Vec<String> = Vec::new();
    for name in names {
        if !unique.contains(name) {
            unique.push(name.clone());
        }
    }
    unique
}

fn channel_summary(name: &str, runs: &[RunComparison]) -> Option<ChannelSummary> {
    let found: Vec<(&str, &ChannelComparison)> = runs
        .iter()
        .filter_map(|run| Some((run.run.as_str(), run.channel(name).filter(|found| !found.driven)?)))
        .collect();
    let (worst_run, worst) = *found.iter().max_by(|a, b| a.1.metrics.rmse.total_cmp(&b.1.metrics.rmse))?;
    let pairs: usize = found.iter().map(|(_, found)| found.metrics.pairs).sum();
    let pooled = |value: fn(&ChannelComparison) -> f64| {
        found.iter().map(|(_, found)| found.metrics.pairs as f64 * value(found)).sum::<f64>() / pairs as f64
    };
    let ratings: Vec<f64> = found.iter().filter_map(|(_, found)| Some(found.iso18571?.overall)).collect();
    let dropped = found.iter().fold(Dropped::default(), |sum, (_, found)| Dropped {
        outside: sum.outside + found.dropped.outside,
        not_measured: sum.not_measured + found.dropped.not_measured,
        not_modelled: sum.not_modelled + found.dropped.not_modelled,
    });
    Some(ChannelSummary {
        channel: name.to_owned(),
        unit: worst.unit.clone(),
        runs: found.len(),
        pairs,
        dropped,
        bias: pooled(|found| found.metrics.bias),
        rmse: pooled(|found| found.metrics.rmse.powi(2)).sqrt(),
        mae: pooled(|found| found.metrics.mae),
        worst_run: worst_run.to_owned(),
        worst_rmse: worst.metrics.rmse,
        iso18571: (!ratings.is_empty()).then(|| crate::statistics::mean(&ratings)),
        within_band: found.iter().filter(|(_, f)| f.cdf.as_ref().is_some_and(|cdf| cdf.within_band)).count(),
    })
}

fn totals(runs: &[RunComparison]) -> Vec<Total> {
    let predicted = || runs.iter().flat_map(|run| &run.totals).filter(|total| !total.driven);
    unique(predicted().map(|total| &total.of))
        .iter()
        .filter_map(|of| {
            let same = || predicted().filter(|total| total.of == *of);
            let sums = same().fold(Sums::default(), |sum, total| sum + total.sums());
            Some(Total::new(of, &same().next()?.unit, false, sums))
        })
        .collect()
}

impl Summary {
    /// Checks a requirement in every run in which the model predicted the channel.
    ///
    /// # Errors
    /// [`CompareError::Unchecked`] where no run has the channel, where it was an input of the model in all of them, or
    /// where the number is not defined in one.
    pub fn meets(&self, requirement: &Requirement) -> Result<Check, CompareError> {
        let refuse =
            |reason: String| CompareError::Unchecked { requirement: requirement.to_string(), reason };
        let name = &requirement.channel;
        let mut values: Vec<(f64, &str)> = Vec::new();
        let mut driven = false;
        for run in &self.runs {
            let (is_driven, value) = match requirement.metric {
                Metric::Total => match run.total(name) {
                    Some(total) => (total.driven, total.relative_error.map(f64::abs)),
                    None => continue,
                },
                metric => match run.channel(name) {
                    Some(found) => (found.driven, value(metric, found)),
                    None => continue,
                },
            };
            if is_driven {
                driven = true;
                continue;
            }
            let undefined = || refuse(format!("it is not defined in run `{}`", run.run));
            values.push((value.filter(|value| value.is_finite()).ok_or_else(undefined)?, &run.run));
        }
        let further = |a: &(f64, &str), b: &(f64, &str)| {
            if requirement.relation.is_upper() { a.0 > b.0 } else { a.0 < b.0 }
        };
        let worst =
            values.iter().copied().reduce(|worst, next| if further(&next, &worst) { next } else { worst });
        let Some((found, run)) = worst else {
            return Err(refuse(if driven {
                format!("`{name}` was an input of the model, so that it agrees by construction")
            } else {
                self.unknown(requirement)
            }));
        };
        Ok(Check {
            requirement: requirement.clone(),
            met: requirement.relation.holds(found, requirement.limit),
            found,
            run: run.to_owned(),
            runs: values.len(),
        })
    }

    fn unknown(&self, requirement: &Requirement) -> String {
        let (what, known) = if requirement.metric == Metric::Total {
            ("total", unique(self.runs.iter().flat_map(|run| &run.totals).map(|total| &total.of)))
        } else {
            ("channel", unique(self.runs.iter().flat_map(|run| &run.channels).map(|found| &found.channel)))
        };
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        let name = &requirement.channel;
        format!(
            "no {what} `{name}` was compared{}; there are: {}",
            suggestion(name, &known),
            known.join(", ")
        )
    }
}

/// A number of a channel; `None` where it is not defined, or is no number of a channel.
fn value(metric: Metric, found: &ChannelComparison) -> Option<f64> {
    let metrics = &found.metrics;
    match metric {
        Metric::Bias => Some(metrics.bias.abs()),
        Metric::Rmse => Some(metrics.rmse),
        Metric::Mae => Some(metrics.mae),
        Metric::MaxError => Some(metrics.max_error),
        Metric::Nrmse => metrics.nrmse_range,
        Metric::NrmseMean => metrics.nrmse_mean,
        Metric::RSquared => metrics.regression.map(|line| line.r_squared),
        Metric::TheilU => metrics.theil.map(|theil| theil.u1),
        Metric::SpragueGeers => metrics.sprague_geers.map(|errors| errors.combined),
        Metric::Russell => metrics.russell.map(|errors| errors.combined),
        Metric::Iso18571 => found.iso18571.map(|rating| rating.overall),
        Metric::CdfDistance => found.cdf.as_ref().map(|cdf| cdf.distance),
        Metric::CdfArea => found.cdf.as_ref().map(|cdf| cdf.area),
        Metric::Lag => found.lag.map(|lag| lag.lag_s.abs()),
        Metric::Total => None,
    }
}

#[cfg(test)]
#[path = "summary_tests.rs"]
mod tests;
