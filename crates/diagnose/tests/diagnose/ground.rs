//! What is of the ground, and what only looks like it or is taken for something else.

use super::setting::{
    ELECTRIC, found_of_scenario, named, recorded_of_scenario, recording_of_scenario, scenario,
};
use headland_calibrate::statistics::Draws;
use headland_diagnose::{Diagnosed, Options, Verdict};
use headland_recording::Known;

/// A tractor in neutral on one lane, from eight speeds, with `effects`.
fn coasts(effects: &str) -> String {
    let run = |run: u32| {
        let speed_m_s = 9.0 - 0.4 * f64::from(run);
        format!("(id: \"c{run}\", with: {{\"start.speed_m_s\": {speed_m_s:?}}}), ")
    };
    let runs: String = (0..8).map(run).collect();
    format!(
        r#"(
    about: "a tractor that rolls free",
    vehicle: (mass_kg: 13000, rotating_mass_kg: 0, drag_area_m2: 6.0, driveline: Neutral()),
    ground: (terrain: Flat(heading_rad: 0.0), soil: Constant(coefficient: 0.025)),
    air: (density_kg_m3: 1.2),
    start: (position_m: 0, speed_m_s: 9.0),
    cycle: [Coast(until: SpeedBelow(speed_m_s: 0.6))],
    effects: [{effects}],
    free: [
        (name: "ground.soil.coefficient", sd: 0.003, bounds: (0.002, 0.3)),
        (name: "vehicle.mass_kg", sd: 65, bounds: (10000, 16000)),
    ],
    runs: [{runs}],
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#
    )
}

/// A study with another value of one of its runs.
fn with(text: &str, run: usize, name: &str, value: usize) -> String {
    let begin = format!("(id: \"c{run}\", with: {{");
    text.replace(&begin, &format!("{begin}\"{name}\": {value}, "))
}

/// A speed that is known to 0.03 m/s.
fn noisy(name: &str, value: f64, draws: &mut Draws) -> f64 {
    if name == "speed_m_s" { value + 0.03 * draws.normal() } else { value }
}

fn found(hidden: &str) -> Diagnosed {
    let registry = headland_stock::registry();
    let channels = ["speed_m_s", "position_m"];
    let recording = recording_of_scenario(&coasts(hidden), &registry, &channels, (29, &noisy));
    found_of_scenario(&coasts(""), &recording, &Options::default(), &registry).unwrap()
}

/// Every run is held back alike where the ground is soft; drivers brake where they brake.
#[test]
fn a_patch_that_doubles_the_resistance_is_no_brake() {
    let found = found("soft_ground(positions_m: [40, 70], coefficients: [0.035])");
    assert!(named(&found, "soft_ground"), "{}", found.diagnosis.answer);
    assert!(!named(&found, "braking"), "{}", found.diagnosis.answer);
}

/// A lane that is softer everywhere and has a patch: level and map are one sum, and both are named, as are brakes, which on one
/// ground drag as a level does. A patch alone is no level.
#[test]
fn a_map_that_lies_off_nought_all_along_names_the_level_beside_it() {
    let patch = "soft_ground(positions_m: [40, 70], coefficients: [0.035])";
    let both = found(&format!("rolling_resistance(coefficient: 0.04), {patch}"));
    for id in ["soft_ground", "rolling_resistance", "brake_drag"] {
        assert!(named(&both, id), "{id}: {}", both.diagnosis.answer);
    }
    let alone = found(patch);
    for id in ["rolling_resistance", "brake_drag"] {
        assert!(!named(&alone, id), "{}", alone.diagnosis.answer);
    }
}

/// Passes of which each one changes the resistance by a factor: a level of its own in each run says as much, and teaches no run the next
/// one. Beside what was found already no regressor may ask for less than nothing.
fn passes_are_told(factor: f64) {
    let registry = headland_stock::registry();
    let passes = format!("multipass(coefficient: 0.021, factor: {factor:?}, pass: 1)");
    let hidden = (0..8).fold(coasts(&passes), |text, run| with(&text, run, "effects.0.pass", run + 1));
    let recording = recording_of_scenario(&hidden, &registry, &["speed_m_s", "position_m"], (29, &noisy));
    let found = found_of_scenario(&coasts(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [pass] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(pass.id, "multipass", "{}", said.answer);
    let told = pass.parameters.iter().find(|one| one.name == "factor").unwrap();
    assert!((told.value - factor).abs() < 0.05, "{told:?}");
}

#[test]
fn ground_that_firms_to_next_to_nothing_is_no_level_of_each_run() {
    passes_are_told(0.6);
}

#[test]
fn ground_that_breaks_up_is_no_level_of_each_run() {
    passes_are_told(1.13);
}

/// Eight weighed loads, of which the resistance does not grow in proportion, on a brake that drags: levels of each run follow both, and
/// crowd out each of them alone.
#[test]
fn a_load_and_a_brake_are_no_levels_of_each_run() {
    const FORCE_N: f64 = 900.0;
    const MASSES_KG: [usize; 8] = [13_000, 15_800, 11_000, 14_400, 10_200, 13_000, 15_800, 11_000];
    let registry = headland_stock::registry();
    let effects = format!(
        "brake_drag(force_n: {FORCE_N:?}), load_dependence(exponent: 1.4, coefficient: 0.025, reference_mass_kg: 13000)"
    );
    let weighed = |text: String, run: usize| with(&text, run, "vehicle.mass_kg", MASSES_KG[run]);
    let hidden = (0..8).fold(coasts(&effects), weighed);
    let mut recording = recording_of_scenario(&hidden, &registry, &["speed_m_s", "position_m"], (29, &noisy));
    for (run, mass_kg) in recording.runs.iter_mut().zip(MASSES_KG) {
        run.known.push(Known { name: "mass_kg".to_owned(), value: mass_kg as f64, sd: Some(15.0) });
    }
    // Of a coefficient that is known to a tenth a brake would be a part.
    let nominal = coasts("").replacen("sd: 0.003,", "sd: 0.0004,", 1);
    let found = found_of_scenario(&nominal, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    for id in ["brake_drag", "load_dependence"] {
        assert!(named(&found, id), "{id}: {}", said.answer);
    }
    assert_eq!(said.findings.len(), 2, "{}", said.answer);
    let drag = said.findings.iter().flat_map(|one| &one.parameters).find(|one| one.name == "force_n");
    let drag = drag.unwrap_or_else(|| panic!("{}", said.answer));
    assert!((drag.value - FORCE_N).abs() < 150.0, "{drag:?}");
}

/// Laps of 31 m on soft ground, of which every one leaves a part of the resistance: not oil that warms up beside another level.
#[test]
fn ground_that_firms_from_lap_to_lap_is_told_with_the_lap() {
    const LAP_M: f64 = 31.0;
    let registry = headland_stock::registry();
    let hidden = format!("multipass(coefficient: 0.031, factor: 0.62, lap_length_m: {LAP_M:?})");
    let mut recording = recorded_of_scenario(&scenario(0.069, &hidden, ""), &registry);
    for run in &mut recording.runs {
        run.path = None;
    }
    let nominal = scenario(0.069, "", "");
    let said = found_of_scenario(&nominal, &recording, &Options::default(), &registry).unwrap().diagnosis;
    let [laps] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(laps.id, "multipass", "{}", said.answer);
    let lap = laps.parameters.iter().find(|one| one.name == "lap_length_m").unwrap();
    assert!((lap.value - LAP_M).abs() < 0.5, "{lap:?}");
}

/// One run alone comes across a patch: that the ground was soft there, and that something was let down for as long, say the same.
#[test]
fn what_holds_one_run_back_in_one_place_is_in_doubt() {
    let text = |effects: &str| {
        let text = scenario(0.069, effects, "start: (position_m: 0, speed_m_s: 1.0),");
        let elsewhere = |text: String, run: u32| {
            let with = |more: &str| format!("(id: \"r{run}\", with: {{{more}");
            text.replace(&with(""), &with("\"start.position_m\": 300.0, "))
        };
        (1..5).fold(text, elsewhere)
    };
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| {
        if name == "speed_m_s" { value + 0.02 * draws.normal() } else { value }
    };
    let hidden = text("soft_ground(positions_m: [50, 90], coefficients: [0.04])");
    let channels = ["speed_m_s", "position_m", "tractive_force_n", "coasting"];
    let recording = recording_of_scenario(&hidden, &registry, &channels, (41, &noisy));
    let found = found_of_scenario(&text(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::CannotTell, "{}", said.answer);
    assert!(named(&found, "soft_ground"), "{}", said.answer);
}

/// What the speed is held by follows the ground, and moves nothing: a mass would be as large as it may be.
#[test]
fn runs_whose_speed_was_held_tell_no_mass() {
    let text = |effects: &str| {
        let run = |run: u32| format!("(id: \"h{run}\", with: {{}}), ");
        let runs: String = (0..6).map(run).collect();
        format!(
            r#"(
    about: "a tractor that holds its speed",
    vehicle: (
        mass_kg: 13000, rotating_mass_kg: 800, drag_area_m2: 6.0,
        driveline: {ELECTRIC},
    ),
    ground: (terrain: Flat(heading_rad: 0.0), soil: Constant(coefficient: 0.07)),
    air: (density_kg_m3: 1.2),
    start: (position_m: 0, speed_m_s: 3.0),
    cycle: [Hold(for_s: 60)],
    effects: [{effects}],
    free: [
        (name: "vehicle.mass_kg", sd: 1000, bounds: (8000, 26000)),
        (name: "ground.soil.coefficient", sd: 0.02, bounds: (0.01, 0.3)),
    ],
    runs: [{runs}],
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#
        )
    };
    let registry = headland_stock::registry();
    // The force wanders with the ground by a sixth, and the speed stays.
    let wander = std::cell::Cell::new(0.0);
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "tractive_force_n" => {
            wander.set(0.98 * wander.get() + 300.0 * draws.normal());
            value + wander.get()
        }
        _ => value,
    };
    let channels = ["speed_m_s", "position_m", "tractive_force_n"];
    let recording = recording_of_scenario(&text(""), &registry, &channels, (31, &noisy));
    let found = found_of_scenario(&text(""), &recording, &Options::default(), &registry).unwrap();
    let notes = &found.diagnosis.notes;
    assert!(notes.iter().any(|note| note.contains("The speed was held")), "{notes:?}");
    assert!(found.diagnosis.calibrated.iter().all(|one| one.name != "mass_kg"));
    assert!(!named(&found, "mass") && !named(&found, "latency"), "{}", found.diagnosis.answer);
}
