//! What a scenario says, and what a mistake in it gets.

use crate::{AskedInputs, Scenario, ScenarioError};
use headland_sim::{Inputs, Phase, Resistance, Until};
use std::path::Path;

const GOOD: &str = r#"(
    about: "a coast-down",
    vehicle: (
        mass_kg: "13.0193 t",
        rotating_mass_kg: 0.0,
        drag_area_m2: 5.0,
        driveline: Neutral,
    ),
    ground: (
        terrain: Flat,
        soil: LinearSpeedLaw(coefficient: 0.069, speed_scale_m_s: "100 km/h"),
    ),
    air: (density_kg_m3: 1.24, wind: (speed_m_s: 0.0, from_rad: "90 deg")),
    start: (position_m: 0.0, speed_m_s: "30 km/h"),
    cycle: [Coast(until: Stopped)],
    free: [(name: "coefficient", sd: 0.01, bounds: (0.0, 0.3)), (name: "vehicle.mass_kg")],
    runs: [(id: "still", with: {}), (id: "windy", with: {"air.wind.speed_m_s": "18 km/h"})],
    simulation: (fidelity: Longitudinal, step_s: 0.01),
)"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    Scenario::of_text("test.ron", text, Path::new(""), &headland_stock::registry())
}

/// The error that follows when one piece of the good scenario is another.
fn broken(from: &str, to: &str) -> ScenarioError {
    assert!(GOOD.contains(from), "`{from}` is not in the scenario");
    read(&GOOD.replacen(from, to, 1)).expect_err("the change is a mistake")
}

/// The message, and whether its carets stand below `below`.
fn told(error: &ScenarioError, below: &str) -> String {
    let at = error.location().expect("it lies somewhere");
    let meant: String = at.excerpt.chars().skip(at.column - 1).collect();
    assert!(meant.starts_with(below), "carets below `{meant}`, expected `{below}`: {}", error.told());
    error.told()
}

/// Resistance pushes nobody: a bound at which it would is refused where it stands, and not when a fit comes there.
#[test]
fn a_bound_at_which_there_is_no_model_is_refused() {
    let error = broken("bounds: (0.0, 0.3)", "bounds: (-0.1, 0.3)");
    let said = told(&error, "(-0.1, 0.3)");
    assert!(said.contains("-0.1") && said.contains("ground.soil.coefficient"), "{said}");
}

#[test]
fn a_scenario_says_what_it_says() {
    let scenario = read(GOOD).unwrap();
    let model = scenario.model(&headland_stock::registry()).unwrap();
    assert!((model.vehicle.mass_kg - 13_019.3).abs() < 1e-9);
    assert_eq!(model.vehicle.resistance, Resistance::Drag { area_m2: 5.0 });
    assert!((model.air.wind_from_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    let cycle = scenario.cycle.as_ref().unwrap();
    assert!(matches!(cycle.phases[..], [Phase::Coast { until: Until::Stopped }]));
    assert!((cycle.start.speed_m_s - 30.0 / 3.6).abs() < 1e-12);
    assert_eq!(scenario.free[0].path, "ground.soil.coefficient");
    assert_eq!((scenario.free[0].name.as_str(), scenario.free[0].value), ("coefficient", 0.069));
    assert_eq!(scenario.free[1].name, "mass_kg");
    assert!(scenario.remarks.is_empty(), "{:?}", scenario.remarks);
}

#[test]
fn a_run_differs_where_it_says_so() {
    let registry = headland_stock::registry();
    let scenario = read(GOOD).unwrap();
    let windy = scenario.run(&scenario.runs[1], &registry).unwrap();
    assert!((windy.model(&registry).unwrap().air.wind_speed_m_s - 5.0).abs() < 1e-12);
    assert!(windy.runs.is_empty());
}

#[test]
fn an_effect_can_be_added() {
    let registry = headland_stock::registry();
    let scenario = read(GOOD).unwrap();
    let text = scenario.document().with_effect("wind(speed_m_s: 3.0, from_rad: 0.0)").unwrap();
    assert!(text.text().contains("effects: [wind(speed_m_s: 3.0, from_rad: 0.0)]"));
    let twice = text.with_effect("another()").unwrap();
    assert!(twice.text().contains("from_rad: 0.0), another()]"));
    let _ = registry;
}

#[test]
fn a_replay_can_be_told_more() {
    let scenario = read(GOOD).unwrap();
    let inputs = AskedInputs { all: true, listed: vec![Inputs::Heading, Inputs::EngineSpeed] };
    let asked = |text: &str| {
        let document = read(text).unwrap().document().with_inputs(&inputs).unwrap();
        let told = Scenario::of(document.clone(), &headland_stock::registry()).unwrap();
        assert_eq!(told.replay.inputs.as_ref(), Some(&inputs), "{}", document.text());
        told.replay
    };
    assert_eq!(scenario.replay.inputs, None);
    assert_eq!(asked(GOOD).drive, None);
    let end = GOOD.trim_end().strip_suffix(')').unwrap();
    assert_eq!(asked(&format!("{end}    replay: (drive: Speed, window_s: 5.0),\n)\n")).window_s, Some(5.0));
    asked(&format!("{end}    replay: (inputs: [Wind, Roll]),\n)\n"));
    asked(&format!("{end}    replay: (),\n)\n"));
}

#[test]
fn an_unusual_value_is_remarked_upon_and_accepted() {
    let scenario = read(&GOOD.replacen("0.069", "0.9", 1).replacen("(0.0, 0.3)", "(0.0, 1.0)", 1)).unwrap();
    assert_eq!(scenario.remarks.len(), 1);
    assert_eq!((scenario.remarks[0].at.line, scenario.remarks[0].at.column), (11, 43));
}

#[test]
fn a_misspelt_plugin_is_named_with_what_was_meant() {
    let message = told(&broken("LinearSpeedLaw", "LinearSpeedLow"), "LinearSpeedLow");
    assert!(message.contains("no soil model is named `LinearSpeedLow`"), "{message}");
    assert!(
        message.contains("did you mean `LinearSpeedLaw`?") && message.contains("test.ron:11:15"),
        "{message}"
    );
    assert!(message.contains("known: Constant") && message.contains("headland plugins soil"), "{message}");
}

#[test]
fn a_misspelt_field_is_named_with_what_was_meant() {
    let message = told(&broken("drag_area_m2", "drag_aera_m2"), "drag_aera_m2");
    assert!(
        message.contains("did you mean `drag_area_m2`?") && message.contains("test.ron:6:9"),
        "{message}"
    );
    let message = told(&broken("coefficient: 0.069", "coeficient: 0.069"), "coeficient");
    assert!(message.contains("did you mean `coefficient`?"), "{message}");
}

#[test]
fn a_missing_field_is_named_where_it_belongs() {
    let message = told(&broken("rotating_mass_kg: 0.0,\n        drag", "drag"), "(");
    assert!(
        message.contains("lacks the field `rotating_mass_kg`") && message.contains("test.ron:3:14"),
        "{message}"
    );
    let message = told(&broken("coefficient: 0.069, ", ""), "LinearSpeedLaw");
    assert!(message.contains("lacks the field `coefficient`"), "{message}");
    let message = told(
        &broken("LinearSpeedLaw(coefficient: 0.069, speed_scale_m_s: \"100 km/h\")", "Constant"),
        "Constant",
    );
    assert!(message.contains("lacks the field"), "{message}");
}

#[test]
fn a_unit_that_does_not_fit_is_refused() {
    let message = told(&broken("13.0193 t", "13.0193 km"), "\"13.0193 km\"");
    assert!(message.contains("km") && message.contains("kg"), "{message}");
    let message = told(&broken("13.0193 t", "13.0193"), "\"13.0193\"");
    assert!(message.contains("has no unit"), "{message}");
}

#[test]
fn impossible_values_are_refused_where_they_stand() {
    let message = told(&broken("\"13.0193 t\"", "-5"), "-5");
    assert!(message.contains("`mass_kg` is -5, expected more than 0"), "{message}");
    told(&broken("\"13.0193 t\"", "NaN"), "NaN");
    let message = told(&broken("0.069", "-0.069"), "-0.069");
    assert!(message.contains("`coefficient` is -0.069"), "{message}");
    told(&broken("(0.0, 0.3)", "(0.1, 0.3)"), "(0.1, 0.3)");
    told(&broken("\"coefficient\"", "\"coefficcient\""), "\"coefficcient\"");
    told(&broken("\"air.wind.speed_m_s\": \"18 km/h\"", "\"air.wind.strength\": 5"), "\"air.wind.strength\"");
    told(&broken("step_s: 0.01", "step_s: 0"), "0");
    told(&broken("step_s: 0.01", "step_s: 100"), "100");
    let message = told(&broken("sd: 0.01", "sd: -0.01"), "-0.01");
    assert!(message.contains("`sd` is -0.01, expected more than 0"), "{message}");
    let message =
        told(&broken("\"vehicle.mass_kg\"", "\"ground.soil.coefficient\""), "\"ground.soil.coefficient\"");
    assert!(message.contains("for the second time"), "{message}");
}

#[test]
fn a_value_of_another_kind_is_refused() {
    let message = told(&broken("drag_area_m2: 5.0", "drag_area_m2: true"), "true");
    assert!(message.contains("number") || message.contains("f64"), "{message}");
    let message = told(&broken("until: Stopped", "until: Stoped"), "Stoped");
    assert!(message.contains("did you mean `Stopped`?"), "{message}");
    let message = told(&broken("[Coast(", "[Cost("), "Cost");
    assert!(message.contains("did you mean `Coast`?"), "{message}");
    told(&broken("terrain: Flat", "terrain: 5"), "5");
}

#[test]
fn values_that_nest_without_end_are_refused_and_not_followed() {
    let deep = format!("{}1{}", "(a: ".repeat(5000), ")".repeat(5000));
    assert!(matches!(read(&deep), Err(ScenarioError::Syntax { .. })));
}

#[test]
fn exactly_one_description_of_the_resistance_is_wanted() {
    let load = "road_load: (f0_n: 100, f1_n_s_m: 0, f2_n_s2_m2: 1, air_density_kg_m3: 1.2)";
    let message = told(&broken("drag_area_m2: 5.0", load), "LinearSpeedLaw");
    assert!(message.contains("road-load coefficients hold the rolling resistance already"), "{message}");
    told(&broken("drag_area_m2: 5.0,", &format!("drag_area_m2: 5.0, {load},")), "(f0_n");
    let message = told(&broken("        drag_area_m2: 5.0,\n", ""), "(");
    assert!(message.contains("`drag_area_m2` or `road_load`"), "{message}");
}

#[test]
fn text_that_is_no_ron_is_refused_at_its_first_fault() {
    let error = broken("density_kg_m3: 1.24,", "density_kg_m3 1.24,");
    assert_eq!(error.location().unwrap().line, 13);
    assert!(matches!(read("(about: \"x\""), Err(ScenarioError::Syntax { .. })));
    assert!(matches!(
        Scenario::read(Path::new("."), &headland_stock::registry()),
        Err(ScenarioError::File { .. })
    ));
}

#[test]
fn candidates_are_checked_and_do_not_act() {
    let with = |candidates: &str| {
        GOOD.replacen("    simulation:", &format!("    candidates: [{candidates}],\n    simulation:"), 1)
    };
    let formula = "expression(resistance: \"k_n_s_m * v\", constants: {\"k_n_s_m\": 3.0})";
    let scenario = read(&with(&format!("brake_drag(force_n: \"2 kN\"), {formula}"))).unwrap();
    let [drag, law] = &scenario.candidates[..] else { panic!("{:?}", scenario.candidates) };
    assert_eq!((drag.name.as_str(), drag.fields[0].number), ("brake_drag", Some(2000.0)));
    assert_eq!(law.fields[0].text.as_deref(), Some("k_n_s_m * v"));
    assert!(scenario.model(&headland_stock::registry()).unwrap().effects.is_empty());
    let message = told(&read(&with("brake_drag(force_n: -1.0)")).unwrap_err(), "-1.0");
    assert!(message.contains("force_n"), "{message}");
}

/// The whole file counted as one line.
#[test]
fn lines_that_end_with_a_return_alone_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.ron");
    std::fs::write(&path, "(\r    about: \"t\",\r\n    vehicle: 3, // größe\r)\r").unwrap();
    let error = Scenario::read(&path, &headland_stock::registry()).unwrap_err();
    let (told, at) = (error.told(), error.location().unwrap());
    assert!(told.contains("found `3`") && (at.line, at.column) == (3, 14), "{told} {at:?}");
}

/// It was told at the driveline, in a file that was complete.
#[test]
fn a_field_that_an_included_part_lacks_is_told_at_that_file() {
    let folder = tempfile::tempdir().unwrap();
    let motor = "// a motor\n(\n    max_power_w: 1e5,\n    max_speed_rad_s: 900,\n)\n";
    std::fs::write(folder.path().join("motor.ron"), motor).unwrap();
    let driveline = "BatteryElectric(\n            motor: include(\"motor.ron\"), gear_ratios: [20])";
    let text = GOOD.replacen("Neutral", driveline, 1);
    let error = Scenario::of_text("test.ron", &text, folder.path(), &headland_stock::registry());
    let told = error.unwrap_err().told();
    assert!(told.contains("`motor` lacks the field `max_torque_n_m`"), "{told}");
    assert!(told.contains("motor.ron:2:1"), "{told}");
    // One that the driveline itself lacks is told at its name.
    let whole = motor.replace("max_power_w", "max_torque_n_m: 400, max_power_w").replace(
        "900,",
        "900, copper_w_per_n2_m2: 0.06, iron_torque_n_m: 1, windage_n_m_s2: 2e-6, constant_loss_w: 300, heat_capacity_j_k: 15e3, \
         cooling_w_k: 60, coolant_temperature_c: 65, derating_from_c: 140, derating_to_c: 160,",
    );
    std::fs::write(folder.path().join("motor.ron"), whole).unwrap();
    let error = Scenario::of_text("test.ron", &text, folder.path(), &headland_stock::registry());
    let told = error.unwrap_err().told();
    assert!(told.contains("`BatteryElectric` lacks the field") && told.contains("test.ron:7:20"), "{told}");
}
