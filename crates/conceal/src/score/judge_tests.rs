use super::*;
use crate::hidden::Told;
use crate::truth::Prior;
use headland_trace::{Origin, Trace};

fn truth(ids: &[&str]) -> Truth {
    let cause = |id: &&str| Cause {
        id: (*id).to_owned(),
        law: (*id).to_owned(),
        class: "physics".to_owned(),
        parameters: vec![Told { name: "speed_m_s".to_owned(), value: 5.0, unit: "m/s".to_owned() }],
        column: format!("{id}_n"),
        rms: 100.0,
        strength: 3.0,
    };
    Truth {
        schema: crate::truth::SCHEMA.to_owned(),
        seed: 1,
        case: 0,
        family: "coast".to_owned(),
        kind: "single".to_owned(),
        hidden: ids.iter().map(cause).collect(),
        also_true: vec!["accelerometer_tilt".to_owned()],
        nominal: vec![Prior {
            path: "vehicle.mass_kg".to_owned(),
            truth: 13_000.0,
            nominal: 13_050.0,
            sd: 60.0,
            bounds: (1e4, 2e4),
            free: true,
        }],
        noise: [("speed_m_s".to_owned(), 0.03)].into(),
        force_noise_n: 100.0,
        power_noise_w: 0.0,
        held_out: vec!["r2".to_owned()],
    }
}

fn said(verdict: &str, findings: &str) -> Diagnosis {
    serde_json::from_str(&format!(
        r#"{{"schema": "headland.diagnosis/1", "verdict": "{verdict}", "answer": "", "findings": [{findings}],
            "fit": {{"signal": "speed_m_s", "held_out": {{"runs": ["r2"], "rmse_before": 0.33, "rmse_after": 0.06, "noise": 0.03}}}},
            "calibrated": [{{"name": "mass_kg", "prior": 13050.0, "value": 13010.0, "ci95": [12980, 13040], "unit": "kg"}}]}}"#
    ))
    .unwrap()
}

fn finding(kind: &str, id: &str, others: &str) -> String {
    format!(
        r#"{{"kind": "{kind}", "id": "{id}", "balance": "motion", "indistinguishable_from": [{others}],
            "parameters": [{{"name": "speed_m_s", "value": 5.3, "ci95": [4.9, 5.7], "unit": "m/s"}}]}}"#
    )
}

fn outcome(ids: &[&str], verdict: &str, findings: &str) -> Outcome {
    judge(&truth(ids), &said(verdict, findings), &[], &[])
}

#[test]
fn a_right_first_finding_counts_with_its_interval_and_its_improvement() {
    let right = outcome(&["wind"], "missing_physics", &finding("physics", "wind", ""));
    assert_eq!(right.found, [Found::Right]);
    assert_eq!(
        (right.parameters, right.calibrated),
        (Covered { hits: 1, trials: 1 }, Covered { hits: 1, trials: 1 })
    );
    // (0.33 − 0.06) / (0.33 − 0.03)
    assert!((right.improvement.unwrap() - 0.9).abs() < 1e-12);
    assert!(right.false_physics.is_empty());
}

#[test]
fn an_honest_doubt_has_to_name_the_cause() {
    let other = r#"{"id": "wind", "squared_correlation": 0.97}"#;
    let named = finding("physics", "grade_constant", other);
    assert_eq!(outcome(&["wind"], "cannot_tell", &named).found, [Found::Honest]);
    assert_eq!(outcome(&["wind"], "missing_physics", &named).found, [Found::Alternative]);
    let unnamed = finding("physics", "grade_constant", "");
    let wrong = outcome(&["wind"], "cannot_tell", &unnamed);
    assert_eq!(wrong.found, [Found::Wrong]);
    assert_eq!(wrong.false_physics, ["grade_constant"]);
}

#[test]
fn of_two_causes_both_have_to_lead() {
    let findings =
        [("wind", ""), ("mass", ""), ("grade", "")].map(|(id, other)| finding("physics", id, other));
    let two = outcome(&["wind", "grade"], "missing_physics", &findings.join(","));
    assert_eq!(two.found, [Found::Right, Found::Behind]);
    assert_eq!(two.false_physics, ["mass"]);
}

#[test]
fn nothing_said_of_something_is_missed_and_something_of_nothing_a_false_alarm() {
    assert_eq!(outcome(&["wind"], "none", "").found, [Found::Missed]);
    assert_eq!(outcome(&[], "missing_physics", &finding("physics", "wind", "")).false_physics, ["wind"]);
}

/// The body of the plant pitches, and the scenario does not know: saying so is neither right nor wrong.
#[test]
fn what_is_true_of_every_plant_takes_no_place() {
    let findings = [finding("artefact", "accelerometer_tilt", ""), finding("physics", "wind", "")].join(",");
    let both = outcome(&["wind"], "both", &findings);
    assert_eq!(both.found, [Found::Right]);
    assert!(both.false_artefacts.is_empty());
}

#[test]
fn an_angle_is_covered_a_turn_away() {
    let interval =
        Interval { name: "from_rad".to_owned(), value: Some(0.0), ci95: Some([Some(-0.2), Some(0.2)]) };
    let mut covered = Covered::default();
    count(&mut covered, Some(&interval), 6.2);
    count(&mut covered, Some(&interval), 3.0);
    assert_eq!(covered, Covered { hits: 1, trials: 2 });
}

#[test]
fn a_force_that_is_half_as_large_has_its_correlation_and_its_slope() {
    let run = |name: &str, scale: f64| {
        let times: Vec<f64> = (0..50).map(f64::from).collect();
        let values = times.iter().map(|time| scale * (0.3 * time).sin()).collect();
        let mut trace = Trace::new(times).unwrap();
        trace.push(name, values, Origin::Measured).unwrap();
        Run { id: "r2".to_owned(), trace }
    };
    let half = {
        let mut found = run("wind_n", 50.0);
        let scale = vec![1e6; found.trace.len()];
        found.trace.push("speed_scale_n", scale, Origin::Measured).unwrap();
        let said = said("both", &finding("artefact", "speed_scale", ""));
        reconstruction(&truth(&["wind"]), &said, &[run("wind_n", 100.0)], &[found]).unwrap()
    };
    assert!((half.correlation - 1.0).abs() < 1e-9 && (half.slope - 0.5).abs() < 1e-9);
    assert!((half.r2 - 0.75).abs() < 0.01, "{}", half.r2);
}
