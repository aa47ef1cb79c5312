//! Coast-downs of which nothing but the speed was recorded.

use super::setting::{ELECTRIC, found_of_scenario, named, recording_of_scenario};
use headland_calibrate::statistics::Draws;
use headland_diagnose::{DiagnoseError, Diagnosed, Options, Verdict};
use headland_recording::{RecordedRun, Recording};
use headland_trace::{Origin, Trace};

/// Ten coast-downs to and fro, from two speeds; `more` are further fields.
fn scenario(effects: &str, more: &str) -> String {
    let run = |run: usize| {
        let (heading_deg, speed_km_h) = (180 * (run % 2), if run % 4 < 2 { 30 } else { 15 });
        format!(
            "(id: \"c{run}\", with: {{\"ground.terrain.heading_rad\": \"{heading_deg} deg\", \
             \"start.speed_m_s\": \"{speed_km_h} km/h\"}}), "
        )
    };
    let runs: String = (0..10).map(run).collect();
    format!(
        r#"(
    about: "a tractor that rolls free",
    vehicle: (mass_kg: 13000, rotating_mass_kg: 800, drag_area_m2: 6.9, driveline: Neutral()),
    ground: (terrain: Flat(heading_rad: 0.0), soil: Constant(coefficient: 0.02)),
    air: (density_kg_m3: 1.2),
    start: (position_m: 0, speed_m_s: "30 km/h"),
    cycle: [Coast(until: SpeedBelow(speed_m_s: 0.6))],
    effects: [{effects}],
    free: [
        (name: "vehicle.drag_area_m2", sd: 0.5, bounds: (2.0, 14.0)),
        (name: "ground.soil.coefficient", sd: 0.001, bounds: (0.005, 0.1)),
    ],
    runs: [{runs}],
    {more}
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#
    )
}

fn found(hidden: &str, more: &str) -> Result<Diagnosed, DiagnoseError> {
    let registry = headland_stock::registry();
    let noisy = |_: &str, value: f64, draws: &mut Draws| value + 0.03 * draws.normal();
    let recording = recording_of_scenario(&scenario(hidden, ""), &registry, &["speed_m_s"], (41, &noisy));
    found_of_scenario(&scenario("", more), &recording, &Options::default(), &registry)
}

/// Samples by which a receiver is late.
const LATE: usize = 6;

/// The same runs with a speed that is late and noisy, and what an accelerometer feels where an acceleration was recorded.
fn by_a_late_receiver(mut recording: Recording) -> Recording {
    for (number, run) in recording.runs.iter_mut().enumerate() {
        let mut draws = Draws::new(7, number as u64);
        let exact = run.trace.remove("speed_m_s").unwrap().values;
        let said = (0..exact.len()).map(|index| exact[index.saturating_sub(LATE)] + 0.03 * draws.normal());
        run.trace.push("speed_m_s", said.collect(), Origin::Measured).unwrap();
        if let Some(felt) = run.trace.remove("acceleration_m_s2") {
            let felt = felt.values.iter().map(|value| value + 0.05 * draws.normal()).collect();
            run.trace.push("specific_force_m_s2", felt, Origin::Measured).unwrap();
        }
    }
    recording
}

/// That a diagnosis tells a late speed, and by how much.
fn is_late(found: &Diagnosed) {
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::SensorArtefact, "{}", said.answer);
    assert_eq!((said.findings.len(), said.findings[0].id.as_str()), (1, "latency"), "{}", said.answer);
    let [low, high] = said.findings[0].parameters[0].ci95;
    let truth_s = 0.05 * LATE as f64;
    // Nobody knows by how much the logger's own filter delays.
    assert!((low..=high).contains(&truth_s) && high - low < 0.25, "{low} to {high} s");
    // And the improved recording is set right by it.
    let (channel, latency_s, _, _) = &found.corrections[0];
    assert!(channel == "speed_m_s" && (low..=high).contains(latency_s), "{:?}", found.corrections);
}

/// A receiver that is late still says the speed of before where a coast-down begins, in every run and wherever that is. It was told
/// as slopes at the places where the runs begin, and as a brake.
#[test]
fn a_speed_that_goes_on_at_the_begin_of_every_coast_down_is_late() {
    let registry = headland_stock::registry();
    let exact = |_: &str, value: f64, _: &mut Draws| value;
    let text = scenario("", "").replace("coefficient: 0.02)", "coefficient: 0.06)");
    let late = by_a_late_receiver(recording_of_scenario(&text, &registry, &["speed_m_s"], (0, &exact)));
    is_late(&found_of_scenario(&text, &late, &Options::default(), &registry).unwrap());
}

/// A run that was driven says nothing of how the others begin.
#[test]
fn a_late_speed_is_told_by_coast_downs_beside_a_run_that_was_driven() {
    let registry = headland_stock::registry();
    let exact = |_: &str, value: f64, _: &mut Draws| value;
    let coasts = scenario("", "")
        .replace("coefficient: 0.02)", "coefficient: 0.06)")
        .replace("driveline: Neutral()", &format!("driveline: {ELECTRIC}"));
    let drives = coasts.replace(
        "cycle: [Coast(until: SpeedBelow(speed_m_s: 0.6))]",
        "cycle: [Hold(for_s: 20), Reach(speed_m_s: 5, acceleration_m_s2: 0.3), Hold(for_s: 20)]",
    );
    let channels = ["speed_m_s", "tractive_force_n", "coasting", "acceleration_m_s2"];
    let of = |text: &str| recording_of_scenario(text, &registry, &channels, (0, &exact));
    let mut recording = of(&coasts);
    let mut driven = of(&drives).runs.remove(0);
    driven.id = "driven".to_owned();
    recording.runs.push(driven);
    let late = by_a_late_receiver(recording);
    is_late(&found_of_scenario(&coasts, &late, &Options::default(), &registry).unwrap());
}

/// Of an electric drive of which its battery alone tells nobody knows that it coasts: who holds a speed and then slows down as fast as free
/// rolling would has a driver, and no late speed.
#[test]
fn a_driver_who_holds_a_speed_at_first_is_no_late_sensor() {
    let registry = headland_stock::registry();
    let text = scenario("", "")
        .replace("coefficient: 0.02)", "coefficient: 0.06)")
        .replace("driveline: Neutral()", &format!("driveline: {ELECTRIC}"))
        .replace(
            "cycle: [Coast(until: SpeedBelow(speed_m_s: 0.6))]",
            "cycle: [Hold(for_s: 0.3), Reach(speed_m_s: 2, acceleration_m_s2: 0.56), Hold(for_s: 8)]",
        );
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.01 * draws.normal(),
        "battery_voltage_v" | "battery_current_a" => value + 0.1 * draws.normal(),
        _ => value,
    };
    let channels = ["speed_m_s", "battery_voltage_v", "battery_current_a"];
    let mut recording = recording_of_scenario(&text, &registry, &channels, (5, &noisy));
    recording.runs.truncate(4);
    let found = found_of_scenario(&text, &recording, &Options::default(), &registry).unwrap();
    assert!(!named(&found, "latency"), "{}", found.diagnosis.answer);
}

/// Where all fitted runs coast, drag in neutral is a level of rolling resistance by what they say; a run that was driven and held out
/// denies the level, and shows nothing of the drag in neutral.
#[test]
fn a_driven_run_that_is_held_out_leaves_the_drag_in_neutral() {
    const DRAG_N: f64 = 700.0;
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.03 * draws.normal(),
        "tractive_force_n" => value + 100.0 * draws.normal(),
        _ => value,
    };
    let electric = |effects: &str| {
        scenario(effects, "")
            .replace("driveline: Neutral()", &format!("driveline: {ELECTRIC}"))
            .replace("(name: \"ground.soil.coefficient\", sd: 0.001, bounds: (0.005, 0.1)),", "")
    };
    let hidden = electric(&format!("neutral_drag(force_n: {DRAG_N:?}, viscous_n_s_m: 0)"));
    let drives = hidden.replace(
        "cycle: [Coast(until: SpeedBelow(speed_m_s: 0.6))]",
        "cycle: [Hold(for_s: 20), Reach(speed_m_s: 5, acceleration_m_s2: 0.3), Hold(for_s: 20)]",
    );
    let channels = ["speed_m_s", "tractive_force_n", "coasting"];
    let of = |text: &str| recording_of_scenario(text, &registry, &channels, (47, &noisy));
    let mut recording = of(&hidden);
    recording.runs.truncate(4);
    let driven = RecordedRun { id: "driven".to_owned(), held_out: true, ..of(&drives).runs.remove(0) };
    recording.runs.push(driven);
    let found = found_of_scenario(&electric(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [drag] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!((drag.id.as_str(), said.verdict), ("neutral_drag", Verdict::CannotTell), "{}", said.answer);
    let force = drag.parameters.iter().find(|one| one.name == "force_n").unwrap();
    assert!((force.value / DRAG_N - 1.0).abs() < 0.35, "{}", said.answer);
}

fn noted(found: &Diagnosed, what: &str) -> bool {
    found.diagnosis.notes.iter().any(|note| note.contains(what))
}

/// A driveline that never drives leaves no doubt that what nobody drove coasts; another one does, until the scenario says so.
#[test]
fn the_speed_of_a_vehicle_in_neutral_is_enough() {
    let inferred = found("speed_threshold(force_n: 900.0, threshold_m_s: 5.0, width_m_s: 0.2)", "").unwrap();
    assert!(named(&inferred, "speed_threshold"), "{}", inferred.diagnosis.answer);
    assert!(noted(&inferred, "its driveline never drives"), "{:?}", inferred.diagnosis.notes);
    let stated = found("", "replay: (drive: Coast),").unwrap();
    assert_eq!(stated.diagnosis.verdict, Verdict::None, "{}", stated.diagnosis.answer);
    assert!(noted(&stated, "the scenario says so"), "{:?}", stated.diagnosis.notes);
    let driven = found("", "replay: (drive: Speed),").unwrap_err().to_string();
    assert!(driven.contains("no balance can be made"), "{driven}");
}

/// A vehicle that is driven up to speed by what nobody recorded, and says when it rolls free: its speed is held against a coast that
/// starts where the drive ended.
#[test]
fn drives_that_coast_at_times_are_proven_where_they_coast() {
    let of = |effects: &str| {
        let driven = scenario(effects, "").replace(
            "cycle: [Coast(until: SpeedBelow(speed_m_s: 0.6))]",
            "cycle: [Reach(speed_m_s: 9, acceleration_m_s2: 0.4), Coast(until: SpeedBelow(speed_m_s: 5)), \
             Reach(speed_m_s: 7, acceleration_m_s2: 0.4), Coast(until: SpeedBelow(speed_m_s: 0.6))]",
        );
        driven.replace("driveline: Neutral()", &format!("driveline: {ELECTRIC}"))
    };
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.03 * draws.normal(),
        _ => value,
    };
    let hidden = of("speed_threshold(force_n: 900.0, threshold_m_s: 5.0, width_m_s: 0.2)");
    let mut recording = recording_of_scenario(&hidden, &registry, &["speed_m_s", "coasting"], (43, &noisy));
    recording.runs.truncate(5);
    let found = found_of_scenario(&of(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    assert!(named(&found, "speed_threshold"), "{}", said.answer);
    let held_out = said.fit.held_out.as_ref().unwrap();
    assert!(held_out.rmse_before > 0.1 && held_out.rmse_after < 2.0 * held_out.noise, "{held_out:?}");
}

/// Rolling in neutral, a drag of the driveline and one of the ground that grow with speed are the same.
#[test]
fn a_drag_that_grows_with_speed_is_the_drivelines_or_the_grounds() {
    let law = "rolling_speed_law(linear: 0.0006, reference_speed_m_s: 0.5)";
    for hidden in [law, "neutral_drag(force_n: 0.0, viscous_n_s_m: 150.0)"] {
        let found = found(hidden, "").unwrap();
        assert_eq!(found.diagnosis.verdict, Verdict::CannotTell, "{}", found.diagnosis.answer);
        for id in ["neutral_drag", "rolling_speed_law"] {
            assert!(named(&found, id), "{hidden}: {}", found.diagnosis.answer);
        }
    }
}

/// A force and a part that grows with speed are the driveline's, the ground's by its level and its law, or a brake's beside that
/// law: with one mass, and nothing that drives, they are one sum.
#[test]
fn a_level_of_drag_that_grows_with_speed_is_the_drivelines_the_grounds_or_a_brakes() {
    let ground =
        "rolling_resistance(coefficient: 0.012), rolling_speed_law(linear: 0.0006, reference_speed_m_s: 0.5)";
    for hidden in [ground, "neutral_drag(force_n: 1500.0, viscous_n_s_m: 150.0)"] {
        let found = found(hidden, "").unwrap();
        assert_eq!(found.diagnosis.verdict, Verdict::CannotTell, "{}", found.diagnosis.answer);
        for id in ["neutral_drag", "rolling_resistance", "rolling_speed_law", "brake_drag"] {
            assert!(named(&found, id), "{hidden}, {id}: {}", found.diagnosis.answer);
        }
    }
}

/// A foot on the brake in some coast-downs, of which a switch was logged: nothing drives there that it could be told from.
#[test]
fn a_logged_switch_tells_of_coast_downs_that_were_braked() {
    const FORCE_N: f64 = 6000.0;
    const FROM_S: f64 = 4.0;
    const TO_S: f64 = 6.0;
    let registry = headland_stock::registry();
    let exact = |_: &str, value: f64, _: &mut Draws| value;
    let braked = format!("drawbar_load(force_n: {FORCE_N:?}, from_s: {FROM_S:?}, to_s: {TO_S:?})");
    let some = recording_of_scenario(&scenario(&braked, ""), &registry, &["speed_m_s"], (0, &exact));
    let free = recording_of_scenario(&scenario("", ""), &registry, &["speed_m_s"], (0, &exact));
    let mut recording = free.clone();
    for (number, run) in recording.runs.iter_mut().enumerate() {
        let own = if number % 3 == 0 { &some.runs[number] } else { &free.runs[number] };
        let mut draws = Draws::new(5, number as u64);
        let time_s = own.trace.time_s().to_vec();
        let pressed = |time: &f64| f64::from(u8::from(number % 3 == 0 && (FROM_S..TO_S).contains(time)));
        let switch = time_s.iter().map(pressed).collect();
        let speed = own.trace.get("speed_m_s").unwrap().iter().map(|v| v + 0.02 * draws.normal()).collect();
        run.trace = Trace::new(time_s).unwrap();
        run.trace.push("speed_m_s", speed, Origin::Measured).unwrap();
        run.trace.push("brake", switch, Origin::Measured).unwrap();
    }
    let found = found_of_scenario(&scenario("", ""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    assert!(named(&found, "braking"), "{}", said.answer);
    assert!((said.findings[0].parameters[0].value - FORCE_N).abs() < 0.1 * FORCE_N, "{}", said.answer);
}
