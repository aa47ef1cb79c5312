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
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    type Signal = fn(f64) -> f64;

    fn trace(step_s: f64, count: u32, channels: &[(&str, Signal, Origin)]) -> Trace {
        let time_s: Vec<f64> = (0..count).map(|step| step_s * f64::from(step)).collect();
        let mut trace = Trace::new(time_s.clone()).unwrap();
        for (name, value, origin) in channels {
            trace.push(*name, time_s.iter().map(|t| value(*t)).collect(), *origin).unwrap();
        }
        trace
    }

    /// A recording at 1 Hz of 31 s, and a model at 4 Hz that ends after 20 s: ten samples have no counterpart.
    fn compared() -> RunComparison {
        let measured = trace(
            1.0,
            31,
            &[
                ("speed_m_s", |t| 5.0 + t, Origin::Measured),
                ("grade", |_| 0.01, Origin::Measured),
                ("heading_rad", |t| (6.0 + 0.1 * t) % TAU, Origin::Measured),
                ("battery_voltage_v", |_| 400.0, Origin::Measured),
                ("battery_current_a", |_| 10.0, Origin::Measured),
                ("air_temperature_c", |_| 20.0, Origin::Measured),
            ],
        );
        let modelled = trace(
            0.25,
            81,
            &[
                ("speed_m_s", |t| 5.5 + t, Origin::Predicted),
                ("grade", |_| 0.01, Origin::Driven),
                ("heading_rad", |t| (6.1 + 0.1 * t) % TAU, Origin::Predicted),
                ("battery_voltage_v", |_| 390.0, Origin::Predicted),
                ("battery_current_a", |_| 10.4, Origin::Predicted),
                ("tractive_force_n", |_| 1.0, Origin::Predicted),
            ],
        );
        let run = |trace| Run { id: "r1".to_owned(), trace };
        compare_runs(&run(measured), &run(modelled)).unwrap()
    }

    #[test]
    fn each_shared_channel_is_compared_at_the_times_of_the_recording() {
        let comparison = compared();
        let speed = comparison.channel("speed_m_s").unwrap();
        assert_eq!((speed.metrics.pairs, speed.dropped.outside), (21, 10));
        assert!((speed.metrics.bias - 0.5).abs() < 1e-12 && speed.unit == "m/s");
        assert!(speed.iso18571.is_some() && speed.lag.is_some() && speed.cdf.is_some());
        assert_eq!((comparison.samples, comparison.duration_s), (31, 30.0));
    }

    #[test]
    fn an_input_is_driven_and_not_validated() {
        let comparison = compared();
        assert!(comparison.channel("grade").unwrap().driven);
        let validated: Vec<&str> = comparison.validated().map(|found| found.channel.as_str()).collect();
        assert_eq!(validated, ["speed_m_s", "heading_rad", "battery_voltage_v", "battery_current_a"]);
    }

    /// The heading passes north in both signals, at different times.
    #[test]
    fn a_heading_error_is_the_shorter_way_round_and_has_no_relative_error() {
        let comparison = compared();
        let heading = comparison.channel("heading_rad").unwrap();
        assert!((heading.metrics.bias - 0.1).abs() < 1e-9 && heading.metrics.max_error < 0.1 + 1e-9);
        assert_eq!(
            (heading.metrics.theil, heading.metrics.sprague_geers, heading.iso18571),
            (None, None, None)
        );
    }

    /// 400 V · 10 A · 20 s = 80 kJ against 390 V · 10.4 A · 20 s = 81.12 kJ: 1.4 % too much. The distance is
    /// 5 · 20 + 20²/2 = 300 m, and half a metre more for each of the 20 s.
    #[test]
    fn totals_are_of_rates_and_of_products() {
        let comparison = compared();
        let energy = comparison.total("battery_power_w").unwrap();
        assert!((energy.measured - 80_000.0).abs() < 1e-6 && energy.unit == "J" && !energy.driven);
        assert!((energy.relative_error.unwrap() - 0.014).abs() < 1e-12);
        let distance = comparison.total("speed_m_s").unwrap();
        assert!((distance.measured - 300.0).abs() < 1e-9 && (distance.modelled - 310.0).abs() < 1e-9);
        assert_eq!(comparison.totals.len(), 3);
    }

    #[test]
    fn what_one_side_lacks_is_said() {
        let skipped = compared().skipped;
        assert_eq!(
            skipped[0],
            Skipped { channel: "air_temperature_c".to_owned(), why: WhySkipped::NotModelled }
        );
        assert_eq!(
            skipped[1],
            Skipped { channel: "tractive_force_n".to_owned(), why: WhySkipped::NotMeasured }
        );
        let empty = trace(1.0, 9, &[("speed_m_s", |_| f64::NAN, Origin::Measured)]);
        let model = trace(1.0, 9, &[("speed_m_s", |t| t, Origin::Predicted)]);
        let comparison = compare_traces("r", &empty, &model).unwrap();
        assert_eq!(comparison.skipped[0].why, WhySkipped::TooFewPairs);
        assert!(comparison.channels.is_empty() && comparison.totals.is_empty());
    }

    #[test]
    fn strangers_are_refused() {
        let a = trace(1.0, 3, &[("speed_m_s", |t| t, Origin::Measured)]);
        let b = trace(1.0, 3, &[("grade", |t| t, Origin::Predicted)]);
        let error = compare_traces("r1", &a, &b).unwrap_err();
        assert_eq!(error.to_string(), "run `r1`: no channel in common; measured: speed_m_s; modelled: grade");
        let mut late = Trace::new(vec![10.0, 11.0]).unwrap();
        late.push("speed_m_s", vec![0.0; 2], Origin::Predicted).unwrap();
        let error = compare_traces("r1", &a, &late).unwrap_err();
        assert!(
            error.to_string().ends_with("measured from 0 s to 2 s, modelled from 10 s to 11 s"),
            "{error}"
        );
        let nothing = trace(1.0, 0, &[("speed_m_s", |t| t, Origin::Predicted)]);
        assert!(matches!(compare_traces("r1", &a, &nothing), Err(CompareError::NoOverlap { .. })));
    }
}
