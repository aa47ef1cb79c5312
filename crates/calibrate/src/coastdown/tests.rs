//! The analysis as a whole, on runs with a known truth.

use super::synthetic::Field;
use super::*;
use headland_trace::{Origin, Trace};

fn settings() -> Settings {
    Settings { speed_law_unit: Some(SpeedUnit::KilometresPerHour), replicates: 400, ..Settings::default() }
}

/// A run whose speed is given in closed form, ten samples a second.
fn run(id: &str, reversed: bool, until_s: u16, speed: impl Fn(f64) -> f64) -> CoastRun {
    let time: Vec<f64> = (0..=until_s * 10).map(|at| f64::from(at) * 0.1).collect();
    let mut trace = Trace::new(time.clone()).unwrap();
    trace.push("speed_m_s", time.iter().map(|t| speed(*t)).collect(), Origin::Measured).unwrap();
    CoastRun {
        id: id.to_owned(),
        trace,
        path: Some("road".to_owned()),
        reversed,
        mass_kg: Constant::exact(1500.0),
        rotating_mass_kg: Constant::exact(45.0),
        drag_area_m2: None,
        air_density_kg_m3: None,
        heading_rad: None,
    }
}

/// f0 + f2 v² in closed form: v = √(f0/f2) tan(atan(v0 √(f2/f0)) − t √(f0 f2)/m).
fn tangent(f0: f64, f2: f64, initial: f64) -> impl Fn(f64) -> f64 {
    move |t| (f0 / f2).sqrt() * ((initial * (f2 / f0).sqrt()).atan() - t * (f0 * f2).sqrt() / 1545.0).tan()
}

fn value(fit: &FitReport, name: &str) -> f64 {
    fit.estimate(name).unwrap_or_else(|| panic!("{name} is not in {fit:?}")).value
}

/// Grade 0.4 % is m g · 0.004 more against, less along: cancelled by the pair, and found.
#[test]
fn reversed_runs_cancel_a_constant_grade_and_tell_it() {
    let climb = 1500.0 * 9.806_65 * 0.004;
    let runs = [
        run("up", false, 40, tangent(140.0 + climb, 0.65, 30.0)),
        run("down", true, 40, tangent(140.0 - climb, 0.65, 30.0)),
        run("up again", false, 40, tangent(140.0 + climb, 0.65, 25.0)),
        run("down again", true, 40, tangent(140.0 - climb, 0.65, 25.0)),
    ];
    let found = analyse(&runs, &Settings { speed_law_unit: None, ..settings() }).unwrap();
    let fit = &found.road_load.fit;
    assert!((value(fit, "f0") / 140.0 - 1.0).abs() < 1e-6, "{fit:?}");
    assert!((value(fit, "f2") / 0.65 - 1.0).abs() < 1e-6, "{fit:?}");
    assert!(value(fit, "f1").abs() < 1e-4, "{fit:?}");
    assert!((value(fit, "grade of `road`") / 0.004 - 1.0).abs() < 1e-6, "{fit:?}");
    assert_eq!(found.pairs.len(), 2);
    assert!((found.pairs[0].as_grade / 0.004 - 1.0).abs() < 0.01, "{:?}", found.pairs);
    assert!(found.speed_law.is_none() && found.two_stage.is_none());
}

/// The worked split case of f0 139.4112 N and f2 0.646178 N s²/m² at 1545 kg, as the speed it implies.
#[test]
fn a_published_pair_of_coefficients_comes_back() {
    let runs = [
        run("a", false, 60, tangent(139.4112, 0.646_178, 30.0)),
        run("b", true, 60, tangent(139.4112, 0.646_178, 30.0)),
    ];
    let fit = analyse(&runs, &Settings::default()).unwrap().road_load.fit;
    assert!(
        (value(&fit, "f0") - 139.4112).abs() < 1e-3 && (value(&fit, "f2") - 0.646_178).abs() < 1e-5,
        "{fit:?}"
    );
}

#[test]
fn noise_free_runs_give_back_what_made_them() {
    let runs = Field::noise_free().runs(1).unwrap();
    let found = analyse(&runs, &settings()).unwrap();
    let law = found.speed_law.unwrap();
    assert!((value(&law.fit, "c_w") / 0.069 - 1.0).abs() < 1e-6, "{law:?}");
    let fit = &found.road_load.fit;
    let weight = 13_019.3 * 9.806_65;
    assert!((value(fit, "f0") / (0.069 * weight) - 1.0).abs() < 1e-5, "{fit:?}");
    assert!((value(fit, "f1") / (0.069 * weight * 0.036) - 1.0).abs() < 1e-3, "{fit:?}");
    assert!((value(fit, "f2") / (0.5 * 1.238 * 6.0) - 1.0).abs() < 0.01, "{fit:?}");
    assert!(found.runs.iter().all(|run| run.offset.abs() < 1e-6 && run.rms_m_s < 1e-6), "{:?}", found.runs);
    let order: Vec<&str> = fit.estimates[..3].iter().map(|estimate| estimate.name.as_str()).collect();
    assert_eq!(order, ["f0", "f1", "f2"]);
    let readings: Vec<f64> = law.units.iter().map(|reading| reading.rms_m_s).collect();
    assert!(readings[0] < 1e-3 * readings[1] && readings[1] < readings[2], "{readings:?}");
}

/// Without rotating mass the two-stage coefficient is low by m/m_eff: 0.069 · 13019.3 / 13969.3 and a little for air.
#[test]
fn the_two_stage_coefficient_is_low_where_wheels_are_left_out() {
    let found = analyse(&Field::noise_free().runs(1).unwrap(), &settings()).unwrap();
    let (low, right) = (found.two_stage.unwrap(), found.two_stage_with_rotating_mass.unwrap());
    for pool in [right.kept.by_samples, right.kept.by_runs, right.all.by_medians] {
        assert!((pool / 0.069 - 1.0).abs() < 2e-3, "{pool}");
    }
    let expected = 0.069 * 13_019.3 / 13_969.3;
    assert!((low.kept.by_samples / expected - 1.0).abs() < 3e-3, "{low:?}");
}

/// 0.3 % of grade on the lane, 2 m/s along it: neither moves c_w.
#[test]
fn disturbances_that_change_sign_with_direction_leave_the_coefficient() {
    let field = Field { grade_sd: 0.003, initial_m_s: vec![30.0 / 3.6; 4], ..Field::noise_free() };
    let law = analyse(&field.runs(3).unwrap(), &settings()).unwrap().speed_law.unwrap();
    assert!((value(&law.fit, "c_w") / 0.069 - 1.0).abs() < 1e-5, "{law:?}");
    assert!(value(&law.fit, "grade of `lane`").abs() > 1e-4);
}

#[test]
fn one_direction_says_that_grade_and_resistance_are_one() {
    let mut runs = Field::disturbed().runs(2).unwrap();
    runs.retain(|run| !run.reversed);
    let found = analyse(&runs, &settings()).unwrap();
    assert!(found.road_load.fit.estimate("grade of `lane`").is_none());
    let said = |part: &str| found.null_space.iter().any(|sentence| sentence.contains(part));
    assert!(said("driven in one direction only"), "{:#?}", found.null_space);
    assert!(found.pairs.is_empty());
}

#[test]
fn what_ten_runs_cannot_separate_is_said() {
    let found = analyse(&Field::disturbed().runs(2).unwrap(), &settings()).unwrap();
    let said = |part: &str| found.null_space.iter().any(|sentence| sentence.contains(part));
    for part in
        ["only force over mass is seen", "scale error of the speed sensor", "f1 can hardly be separated"]
    {
        assert!(said(part), "no `{part}` in {:#?}", found.null_space);
    }
    assert!(!said("driven in one direction only"));
}

#[test]
fn the_same_seed_gives_the_same_bits_at_any_thread_count_and_json_holds_them() {
    let runs = Field::disturbed().runs(5).unwrap();
    let text = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        serde_json::to_string(&pool.install(|| analyse(&runs, &settings()).unwrap())).unwrap()
    };
    let once = text(1);
    assert_eq!(once, text(4));
    assert!(!once.contains("null]") && once.contains("\"schema\":\"headland.coastdown/1\""));
    let back: CoastDown = serde_json::from_str(&once).unwrap();
    assert_eq!(back.runs.len(), 10);
}

#[test]
fn a_single_run_has_values_and_no_intervals() {
    let runs = &Field::disturbed().runs(4).unwrap()[..1];
    let found = analyse(runs, &settings()).unwrap();
    let law = found.speed_law.unwrap();
    assert!((value(&law.fit, "c_w") / 0.069 - 1.0).abs() < 0.15);
    assert!(law.fit.estimates.iter().all(|estimate| estimate.interval_95.is_none()));
    assert!(found.null_space.iter().any(|sentence| sentence.contains("single run")));
}

#[test]
fn impossible_runs_are_refused_by_name() {
    let good = Field::noise_free().runs(1).unwrap();
    assert!(matches!(analyse(&[], &settings()), Err(CoastDownError::NoRun)));
    let mut twice = good.clone();
    twice[1].id = "r1".to_owned();
    assert!(matches!(analyse(&twice, &settings()), Err(CoastDownError::Twice { run }) if run == "r1"));
    let mut negative = good.clone();
    negative[2].mass_kg = Constant::exact(-5.0);
    let error = analyse(&negative, &settings()).unwrap_err().to_string();
    assert_eq!(error, "run `r3`: `mass_kg` is -5, expected more than 0");
    let width = Settings { difference_s: 0.0, ..settings() };
    assert!(matches!(analyse(&good, &width), Err(CoastDownError::Setting { name: "difference_s", .. })));
}

#[test]
fn a_run_that_does_not_coast_is_left_out_and_told() {
    let mut runs = Field::noise_free().runs(1).unwrap();
    runs.push(CoastRun { id: "steady".to_owned(), ..run("steady", false, 10, |_| 8.0) });
    let found = analyse(&runs, &settings()).unwrap();
    assert_eq!(found.left_out.len(), 1);
    assert!(found.left_out[0].run == "steady" && found.runs.len() == 10);
}
