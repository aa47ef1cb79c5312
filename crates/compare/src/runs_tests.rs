//! A recording at 1 Hz against a model at 4 Hz, and what is refused.

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
    assert_eq!((heading.metrics.theil, heading.metrics.sprague_geers, heading.iso18571), (None, None, None));
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
    assert_eq!(skipped[0], Skipped { channel: "air_temperature_c".to_owned(), why: WhySkipped::NotModelled });
    assert_eq!(skipped[1], Skipped { channel: "tractive_force_n".to_owned(), why: WhySkipped::NotMeasured });
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
    assert!(error.to_string().ends_with("measured from 0 s to 2 s, modelled from 10 s to 11 s"), "{error}");
    let nothing = trace(1.0, 0, &[("speed_m_s", |t| t, Origin::Predicted)]);
    assert!(matches!(compare_traces("r1", &a, &nothing), Err(CompareError::NoOverlap { .. })));
}

/// A recorded power goes before the product of its factors, and a product is an input as soon as one factor is.
#[test]
fn a_product_is_driven_by_either_factor_and_yields_to_a_recorded_power() {
    let factors = |origin| {
        vec![
            ("battery_voltage_v", (|_| 400.0) as Signal, Origin::Predicted),
            ("battery_current_a", |_| 10.0, origin),
        ]
    };
    let driven = trace(1.0, 5, &factors(Origin::Driven));
    let comparison = compare_traces("r", &driven, &driven).unwrap();
    assert!(comparison.total("battery_power_w").unwrap().driven);
    let mut channels = factors(Origin::Predicted);
    channels.push(("battery_power_w", |_| 4100.0, Origin::Predicted));
    let recorded = trace(1.0, 5, &channels);
    let comparison = compare_traces("r", &recorded, &recorded).unwrap();
    let powers: Vec<f64> =
        comparison.totals.iter().filter(|t| t.of == "battery_power_w").map(|t| t.measured).collect();
    assert_eq!(powers, [16_400.0]);
}
