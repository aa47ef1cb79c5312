//! Two runs by hand: three pairs that are 0.3 m/s too fast, and one pair more that is 0.1 m/s too slow.

use super::*;
use crate::compare_traces;
use headland_trace::{Origin, Trace};

const CONSTANT_FUEL: [f64; 4] = [0.01; 4];

fn trace(origin: Origin, channels: &[(&str, &[f64])]) -> Trace {
    let count = u32::try_from(channels[0].1.len()).unwrap();
    let mut trace = Trace::new((0..count).map(f64::from).collect()).unwrap();
    for (name, values) in channels {
        trace.push(*name, values.to_vec(), if *name == "grade" { Origin::Driven } else { origin }).unwrap();
    }
    trace
}

fn runs() -> Vec<RunComparison> {
    let first = compare_traces(
        "r1",
        &trace(
            Origin::Measured,
            &[("speed_m_s", &[1.0, 2.0, 3.0]), ("grade", &[0.0; 3]), ("fuel_rate_kg_s", &CONSTANT_FUEL[..3])],
        ),
        &trace(
            Origin::Predicted,
            &[("speed_m_s", &[1.3, 2.3, 3.3]), ("grade", &[0.0; 3]), ("fuel_rate_kg_s", &[0.012; 3])],
        ),
    );
    let second = compare_traces(
        "r2",
        &trace(Origin::Measured, &[("speed_m_s", &[1.0, 2.0, 3.0, f64::NAN, 5.0]), ("grade", &[0.0; 5])]),
        &trace(Origin::Predicted, &[("speed_m_s", &[0.9, 1.9, 2.9, 3.9, 4.9]), ("grade", &[0.0; 5])]),
    );
    vec![first.unwrap(), second.unwrap()]
}

fn check(text: &str) -> Result<Check, CompareError> {
    summarise(&runs()).meets(&text.parse().unwrap())
}

/// Bias (3 · 0.3 - 4 · 0.1) / 7 = 0.071429; RMSE √((3 · 0.09 + 4 · 0.01) / 7) = 0.210442; MAE (0.9 + 0.4) / 7 = 0.185714.
#[test]
fn runs_are_pooled_by_their_pairs() {
    let summary = summarise(&runs());
    let speed = &summary.channels[0];
    assert_eq!(
        (speed.channel.as_str(), speed.runs, speed.pairs, speed.dropped.total()),
        ("speed_m_s", 2, 7, 1)
    );
    assert!((speed.bias - 0.071_429).abs() < 1e-6, "{speed:?}");
    assert!((speed.rmse - 0.210_442).abs() < 1e-6, "{speed:?}");
    assert!((speed.mae - 0.185_714).abs() < 1e-6, "{speed:?}");
    assert_eq!((speed.worst_run.as_str(), speed.within_band), ("r1", 2));
    assert!((speed.worst_rmse - 0.3).abs() < 1e-12);
}

#[test]
fn what_was_an_input_is_listed_and_not_summarised() {
    let summary = summarise(&runs());
    assert_eq!(summary.driven, ["grade"]);
    assert!(summary.channels.iter().all(|channel| channel.channel != "grade"));
    assert_eq!(summary.runs[0].channels.len(), 3);
}

/// Distances: 4 m against 4.6 m, and 3 + 8 = 12 m (over the gap, 3 to 5 in 2 s is 8) less 0.1 m/s for 4 s.
#[test]
fn totals_add_up_over_runs() {
    let summary = summarise(&runs());
    let distance = &summary.totals[0];
    assert!(
        (distance.measured - 16.0).abs() < 1e-12 && (distance.modelled - 16.2).abs() < 1e-12,
        "{distance:?}"
    );
    assert!((distance.relative_error.unwrap() - 0.0125).abs() < 1e-12);
    assert_eq!(
        (distance.covered_s, distance.longest_step_s, distance.within_criterion),
        (6.0, 2.0, Some(true))
    );
    assert_eq!(summary.totals[1].of, "fuel_rate_kg_s");
    assert_eq!(summary.totals[1].within_criterion, Some(false));
}

#[test]
fn a_requirement_is_judged_by_the_worst_run() {
    let failed = check("speed_m_s rmse < 0.2").unwrap();
    assert_eq!((failed.met, failed.run.as_str(), failed.runs), (false, "r1", 2));
    let text = failed.to_string();
    assert_eq!(text, "not met: speed_m_s rmse < 0.2 m/s; found 0.3000 in run `r1`, the worst of 2");
    assert!(check("speed_m_s rmse < 0.31").unwrap().met);
    let shape = check("speed_m_s r_squared > 0.99").unwrap();
    assert!(shape.met && (shape.found - 1.0).abs() < 1e-12);
    let fuel = check("fuel_rate_kg_s total < 5 %").unwrap();
    assert!(!fuel.met && (fuel.found - 0.2).abs() < 1e-12 && fuel.runs == 1);
    let bias = check("speed_m_s bias <= 0.1 m/s");
    assert!((bias.unwrap().found - 0.3).abs() < 1e-12);
}

/// A lower limit is judged by the lowest: r2 is the slower run, of which the size of the bias is 0.1.
#[test]
fn a_lower_limit_is_judged_by_the_lowest_run() {
    let found = check("speed_m_s bias > 0.2").unwrap();
    assert_eq!((found.met, found.run.as_str()), (false, "r2"));
}

#[test]
fn what_cannot_be_checked_is_an_error_and_not_a_pass() {
    let refusal = |text: &str| check(text).unwrap_err().to_string();
    assert!(refusal("grade rmse < 1").contains("`grade` was an input of the model"));
    assert!(refusal("sped_m_s rmse < 1").contains("did you mean `speed_m_s`?; there are: speed_m_s, grade"));
    assert!(refusal("grade total < 1").contains("no total `grade` was compared"));
    assert!(refusal("speed_m_s iso18571 > 0.8").contains("not defined in run `r1`"));
    assert!(refusal("fuel_rate_kg_s nrmse < 0.1").contains("not defined in run `r1`"));
}

#[test]
fn the_summary_is_a_document() {
    let document = serde_json::to_value(summarise(&runs())).unwrap();
    assert_eq!(document["schema"], "headland.comparison/1");
    assert_eq!(document["runs"][0]["run"], "r1");
    assert_eq!(document["runs"][0]["channels"][1]["driven"], true);
    assert!((document["runs"][0]["channels"][0]["metrics"]["rmse"].as_f64().unwrap() - 0.3).abs() < 1e-12);
    assert!(document["runs"][0]["channels"][0]["iso18571"].is_null());
    assert_eq!(serde_json::to_value(summarise(&[])).unwrap()["channels"], serde_json::json!([]));
}

/// The first model is exact and ends two samples early, the second is far too fast and ends one early; the third
/// was given its speed.
#[test]
fn ratings_are_averaged_and_inputs_left_out() {
    let ramp = |offset: f64| (0..30).map(|step| offset + f64::from(step)).collect::<Vec<f64>>();
    let measured = trace(Origin::Measured, &[("speed_m_s", &ramp(0.0))]);
    let against = |id: &str, model: &[f64], origin| {
        compare_traces(id, &measured, &trace(origin, &[("speed_m_s", model)])).unwrap()
    };
    let runs = [
        against("exact", &ramp(0.0)[..28], Origin::Predicted),
        against("off", &ramp(1000.0)[..29], Origin::Predicted),
        against("given", &ramp(500.0), Origin::Driven),
    ];
    let summary = summarise(&runs);
    let speed = &summary.channels[0];
    let off = runs[1].channels[0].iso18571.unwrap().overall;
    assert!(off < 0.5 && (speed.iso18571.unwrap() - f64::midpoint(1.0, off)).abs() < 1e-12);
    assert_eq!((speed.runs, speed.dropped.outside, speed.within_band), (2, 3, 1));
    assert_eq!(summary.driven, ["speed_m_s"]);
    // 27²/2 + 28²/2 m measured, and nothing of the run that was given its speed.
    assert!((summary.totals[0].measured - 756.5).abs() < 1e-9, "{:?}", summary.totals);
    let text = "speed_m_s total < 5 %".parse().unwrap();
    assert_eq!(summary.meets(&text).unwrap().runs, 2);
}
