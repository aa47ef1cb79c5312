//! One run of a recording against one run of a model.

use crate::CompareError;
use crate::align::{Aligned, Dropped, align_channels};
use crate::cdf::{CdfComparison, cdf_comparison};
use crate::direction::full_turn;
use crate::iso18571::{IsoRating, rate_pairs};
use crate::lag::{Lag, cross_correlation_lag};
use crate::metrics::{Metrics, metrics};
use crate::total::{Total, integral_unit, total};
use headland_trace::{Channel, Origin, Run, Trace};
use headland_units::unit_of_name;

/// Level of the Kolmogorov bands: they fail in one of twenty.
pub const ALPHA: f64 = 0.05;

/// Powers that are the product of two channels, for their totals: name, factors.
const POWERS: &[(&str, [&str; 2])] = &[
    ("battery_power_w", ["battery_voltage_v", "battery_current_a"]),
    ("motor_power_w", ["motor_torque_n_m", "motor_speed_rad_s"]),
    ("engine_power_w", ["engine_torque_n_m", "engine_speed_rad_s"]),
    ("tractive_power_w", ["tractive_force_n", "speed_m_s"]),
];

/// One channel compared.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ChannelComparison {
    /// Name.
    pub channel: String,
    /// Its unit; `1` for a pure number.
    pub unit: String,
    /// Whether it was an input of the model: then it agrees by construction and validates nothing.
    pub driven: bool,
    /// Samples of the recording that are no pair.
    pub dropped: Dropped,
    /// The errors in numbers.
    pub metrics: Metrics,
    /// ISO 18571-style rating, at most 1000 even samples; none of a direction, of a constant, or of fewer than 20 pairs.
    pub iso18571: Option<IsoRating>,
    /// How late the model is; none where either signal is constant.
    pub lag: Option<Lag>,
    /// Cumulative probabilities with a 95 % band.
    pub cdf: Option<CdfComparison>,
}

/// Why a channel was not compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum WhySkipped {
    /// The model does not have it.
    NotModelled,
    /// The recording does not have it.
    NotMeasured,
    /// Fewer than two pairs have both values.
    TooFewPairs,
}

/// A channel that was not compared.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Skipped {
    /// Name.
    pub channel: String,
    /// Why.
    pub why: WhySkipped,
}

/// One run compared, channel by channel in the order of the recording.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct RunComparison {
    /// The run.
    pub run: String,
    /// Samples of the recording.
    pub samples: usize,
    /// Time from the first sample of the recording to the last (s).
    pub duration_s: f64,
    /// What both have.
    pub channels: Vec<ChannelComparison>,
    /// Integrals of the rates that both have, and of powers that are the product of two channels.
    pub totals: Vec<Total>,
    /// What could not be compared.
    pub skipped: Vec<Skipped>,
}

impl RunComparison {
    /// The comparison of this channel.
    pub fn channel(&self, name: &str) -> Option<&ChannelComparison> {
        self.channels.iter().find(|comparison| comparison.channel == name)
    }

    /// The total of this rate.
    pub fn total(&self, of: &str) -> Option<&Total> {
        self.totals.iter().find(|total| total.of == of)
    }

    /// The channels that the model predicted: all that can validate it.
    pub fn validated(&self) -> impl Iterator<Item = &ChannelComparison> {
        self.channels.iter().filter(|comparison| !comparison.driven)
    }
}

/// Compares a run of the model with the run of the recording that it belongs to.
///
/// # Errors
/// As [`compare_traces`].
pub fn compare_runs(measured: &Run, modelled: &Run) -> Result<RunComparison, CompareError> {
    compare_traces(&measured.id, &measured.trace, &modelled.trace)
}

/// Compares every channel that both traces have. A channel of the model counts as driven unless its origin is
/// [`Origin::Predicted`]: what was measured and handed through validates as little as an input.
///
/// # Errors
/// [`CompareError::NoSharedChannel`], or [`CompareError::NoOverlap`] in time.
pub fn compare_traces(run: &str, measured: &Trace, modelled: &Trace) -> Result<RunComparison, CompareError> {
    let mut comparison = RunComparison {
        run: run.to_owned(),
        samples: measured.len(),
        duration_s: measured.duration_s(),
        channels: Vec::new(),
        totals: Vec::new(),
        skipped: Vec::new(),
    };
    refuse_strangers(run, measured, modelled)?;
    for channel in measured.channels() {
        let why = match modelled.channel(&channel.name) {
            None => WhySkipped::NotModelled,
            Some(model) => {
                let driven = model.origin != Origin::Predicted;
                let aligned = align_channels((measured.time_s(), channel), (modelled.time_s(), model));
                if let Some(unit) = integral_unit(&channel.name)
                    && aligned.time_s.len() > 1
                {
                    comparison.totals.push(total(&channel.name, unit, driven, &aligned));
                }
                if let Some(compared) = compare_channel(&channel.name, driven, &aligned) {
                    comparison.channels.push(compared);
                    continue;
                }
                WhySkipped::TooFewPairs
            }
        };
        comparison.skipped.push(Skipped { channel: channel.name.clone(), why });
    }
    for channel in modelled.channels().iter().filter(|channel| measured.channel(&channel.name).is_none()) {
        comparison.skipped.push(Skipped { channel: channel.name.clone(), why: WhySkipped::NotMeasured });
    }
    for (name, factors) in POWERS {
        if comparison.total(name).is_none()
            && let (Some(measured_power), Some(modelled_power)) =
                (power(measured, name, factors), power(modelled, name, factors))
        {
            let driven = modelled_power.origin != Origin::Predicted;
            let aligned =
                align_channels((measured.time_s(), &measured_power), (modelled.time_s(), &modelled_power));
            if aligned.time_s.len() > 1 {
                comparison.totals.push(total(name, "J", driven, &aligned));
            }
        }
    }
    Ok(comparison)
}

fn refuse_strangers(run: &str, measured: &Trace, modelled: &Trace) -> Result<(), CompareError> {
    if measured.channels().iter().all(|channel| modelled.channel(&channel.name).is_none()) {
        let names = |trace: &Trace| trace.channels().iter().map(|channel| channel.name.clone()).collect();
        return Err(CompareError::NoSharedChannel {
            run: run.to_owned(),
            measured: names(measured),
            modelled: names(modelled),
        });
    }
    let span = |trace: &Trace| {
        let time_s = trace.time_s();
        time_s.first().zip(time_s.last()).map_or((f64::NAN, f64::NAN), |(first, last)| (*first, *last))
    };
    let (measured_s, modelled_s) = (span(measured), span(modelled));
    // Not the opposite comparison, so that an empty trace overlaps nothing.
    if measured_s.0 <= modelled_s.1 && modelled_s.0 <= measured_s.1 {
        Ok(())
    } else {
        Err(CompareError::NoOverlap { run: run.to_owned(), measured_s, modelled_s })
    }
}

/// `None` of fewer than two pairs.
fn compare_channel(name: &str, driven: bool, aligned: &Aligned) -> Option<ChannelComparison> {
    let metrics = metrics(&aligned.measured, &aligned.modelled).ok()?;
    let direction = full_turn(name).is_some();
    Some(ChannelComparison {
        channel: name.to_owned(),
        unit: unit_of_name(name).map_or_else(|| "1".to_owned(), |unit| unit.symbol),
        driven,
        dropped: aligned.dropped,
        metrics: if direction { metrics.of_direction() } else { metrics },
        iso18571: if direction { None } else { rate_pairs(aligned) },
        lag: cross_correlation_lag(aligned),
        cdf: cdf_comparison(&aligned.measured, &aligned.modelled, ALPHA),
    })
}

/// The product of two channels, predicted only where both are.
fn power(trace: &Trace, name: &str, factors: &[&str; 2]) -> Option<Channel> {
    let (a, b) = (trace.channel(factors[0])?, trace.channel(factors[1])?);
    let predicted = a.origin == Origin::Predicted && b.origin == Origin::Predicted;
    Some(Channel {
        name: name.to_owned(),
        values: a.values.iter().zip(&b.values).map(|(a, b)| a * b).collect(),
        origin: if predicted { Origin::Predicted } else { Origin::Driven },
    })
}

#[cfg(test)]
#[path = "runs_tests.rs"]
mod tests;
