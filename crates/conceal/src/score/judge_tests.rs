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
        evidence: 100.0,
        twins: Vec::new(),
        power_column: None,
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
        oracle: None,
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
    judge(&truth(ids), &said(verdict, findings), None, &[], &[])
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
    let improvement = right.improvement.unwrap();
    assert!((improvement.share - 0.9).abs() < 1e-12 && !improvement.by_oracle);
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

fn force_of(name: &str, scale: f64) -> Run {
    let times: Vec<f64> = (0..50).map(f64::from).collect();
    let values = times.iter().map(|time| scale * (0.3 * time).sin()).collect();
    let mut trace = Trace::new(times).unwrap();
    trace.push(name, values, Origin::Measured).unwrap();
    Run { id: "r2".to_owned(), trace }
}

/// Brake drag hides; rolling resistance is its twin in these runs, a wind is not.
#[test]
fn a_twin_counts_only_where_it_does_the_same() {
    let mut truth = truth(&["brake_drag"]);
    truth.hidden[0].twins = vec!["rolling_resistance".to_owned()];
    let along = [force_of("brake_drag_n", -100.0)];
    let judged = |findings: &str, column: &str, scale: f64| {
        judge(&truth, &said("missing_physics", findings), None, &along, &[force_of(column, scale)])
    };
    let plain = finding("physics", "rolling_resistance", "");
    let same = judged(&plain, "rolling_resistance_n", -104.0);
    assert_eq!((same.found.as_slice(), same.false_physics.len()), ([Found::Twin].as_slice(), 0));
    let half = judged(&plain, "rolling_resistance_n", -50.0);
    assert_eq!((half.found.as_slice(), half.false_physics.len()), ([Found::Wrong].as_slice(), 1));
    // Named as the alternative it is right whatever its size.
    let other = r#"{"id": "brake_drag", "squared_correlation": 0.99}"#;
    let named = judged(&finding("physics", "rolling_resistance", other), "rolling_resistance_n", -50.0);
    assert_eq!(named.found, [Found::Twin]);
    let wind = judged(&finding("physics", "wind", ""), "wind_n", -104.0);
    assert_eq!((wind.found.as_slice(), wind.false_physics.len()), ([Found::Wrong].as_slice(), 1));
    // A fault of a sensor is no twin of physics.
    let fault = judged(&finding("artefact", "rolling_resistance", ""), "other_n", -104.0);
    assert_eq!(fault.found, [Found::Wrong]);
}

#[test]
fn an_unlisted_cause_is_right_with_its_force_and_rough_without() {
    let truth = truth(&["unlisted"]);
    let along = [force_of("unlisted_n", -100.0)];
    let judged = |kind: &str, id: &str, scale: f64| {
        let said = said("unlisted", &finding(kind, id, ""));
        judge(&truth, &said, None, &along, &[force_of(&format!("{id}_n"), scale)])
    };
    assert_eq!(judged("unlisted", "unlisted", -95.0).found, [Found::Right]);
    assert_eq!(judged("unlisted", "unlisted", -40.0).found, [Found::Rough]);
    let wind = judged("physics", "wind", -95.0);
    assert_eq!((wind.found.as_slice(), wind.false_physics.len()), ([Found::Wrong].as_slice(), 1));
}

/// Before 0.33, after 0.06; the true model leaves 0.09: (0.33 − 0.06) / (0.33 − 0.09).
#[test]
fn an_improvement_is_held_against_the_true_model_where_it_drove_the_same_runs() {
    let oracle = |runs: &str| -> Diagnosis {
        serde_json::from_str(&format!(
            r#"{{"verdict": "none", "fit": {{"signal": "speed_m_s",
                "held_out": {{"runs": [{runs}], "rmse_before": 0.09, "rmse_after": 0.09}}}}}}"#
        ))
        .unwrap()
    };
    let said = said("missing_physics", &finding("physics", "wind", ""));
    let of = |runs: &str| judge(&truth(&["wind"]), &said, Some(&oracle(runs)), &[], &[]).improvement.unwrap();
    assert!(of("\"r2\"").by_oracle && (of("\"r2\"").share - 1.125).abs() < 1e-12);
    assert!(!of("\"r1\"").by_oracle);
    // What differs from run to run, faults and nothing have none.
    let mut braked = truth(&["wind"]);
    braked.hidden[0].law = "braking".to_owned();
    assert!(judge(&braked, &said, None, &[], &[]).improvement.is_none());
    assert!(judge(&truth(&[]), &said, None, &[], &[]).improvement.is_none());
}

/// In a case whose forces only fuel shows, the power that a force takes is held against the power that was found.
#[test]
fn a_force_without_a_measured_force_is_held_against_in_power() {
    let mut truth = truth(&["wind"]);
    truth.hidden[0].power_column = Some("wind_w".to_owned());
    let mut along = force_of("wind_n", -100.0);
    along
        .trace
        .push("wind_w", force_of("x", 700.0).trace.get("x").unwrap().to_vec(), Origin::Measured)
        .unwrap();
    let said = said("missing_physics", &finding("physics", "wind", ""));
    let judged = judge(&truth, &said, None, &[along], &[force_of("wind_w", 700.0)]);
    assert!(judged.reconstruction.unwrap().r2 > 0.999);
}

/// An equation of the shaft's balance gives the power of the shaft; what was hidden is told as that of the fuel, at 40 %.
#[test]
fn an_equation_of_the_shaft_is_held_against_what_it_takes_of_the_fuel() {
    let mut truth = truth(&["unlisted"]);
    truth.hidden[0].column = "unlisted_w".to_owned();
    let efficiency = Prior {
        path: "vehicle.driveline.willans_efficiency".to_owned(),
        truth: 0.4,
        ..truth.nominal[0].clone()
    };
    truth.nominal.push(efficiency);
    let judged = |balance: &str, watts: f64| {
        let finding = finding("unlisted", "unlisted", "").replace("motion", balance);
        let said = said("unlisted", &finding);
        judge(&truth, &said, None, &[force_of("unlisted_w", 1000.0)], &[force_of("unlisted_w", watts)]).found
    };
    assert_eq!(judged("shaft", 400.0), [Found::Right]);
    assert_eq!(judged("fuel", 400.0), [Found::Rough]);
    assert_eq!(judged("fuel", 1000.0), [Found::Right]);
    assert_eq!(judged("shaft", 1000.0), [Found::Rough]);
}
