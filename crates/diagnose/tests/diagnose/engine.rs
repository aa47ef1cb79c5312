//! What is told by the torque or the fuel of an engine, and what an engine does that is no physics.

use super::changed;
use super::setting::{found_of_scenario, named, recording_of_scenario};
use headland_calibrate::statistics::Draws;
use headland_diagnose::{Options, Verdict};
use headland_plugin::Registry;
use headland_recording::{RecordedRun, Recording};
use headland_scenario::{AskedInputs, Scenario};
use headland_sim::Inputs;
use headland_trace::{Origin, Trace};
use std::f64::consts::PI;
use std::path::Path;
use std::sync::LazyLock;

const SCENARIO: &str = r#"(
    about: "a tractor that stands between two fields",
    vehicle: (
        mass_kg: 13000, rotating_mass_kg: 0, drag_area_m2: 6.0,
        driveline: EngineCvt(
            displacement_m3: 8.8e-3, willans_efficiency: 0.448, willans_friction_pa: "1.9 bar",
            lower_heating_value_j_kg: 42.78e6,
            full_load: [(speed_rad_s: "800 rpm", torque_n_m: 900), (speed_rad_s: "2100 rpm", torque_n_m: 1110)],
            idle_speed_rad_s: "800 rpm", load_share: 0.9, transmission_efficiency: 0.85, max_force_n: "120 kN",
            accessory_power_w: "9 kW", alternator_efficiency: 0.6, wheel_radius_m: 0.93, rotating_mass_kg: 0,
        ),
    ),
    ground: (terrain: Flat(heading_rad: 0.0), soil: Constant(coefficient: 0.05)),
    air: (density_kg_m3: 1.2),
    cycle: [
        Reach(speed_m_s: 6, acceleration_m_s2: 0.4), Hold(for_s: 20), Reach(speed_m_s: 0, acceleration_m_s2: 0.4),
        Stand(until: Elapsed(for_s: 60)),
        Reach(speed_m_s: 4, acceleration_m_s2: 0.3), Hold(for_s: 20), Reach(speed_m_s: 0, acceleration_m_s2: 0.4),
    ],
    free: [
        (name: "ground.soil.coefficient", sd: 0.005, bounds: (0.01, 0.3)),
        (name: "vehicle.driveline.accessory_power_w", sd: 2000, bounds: (0, 40000)),
    ],
    runs: [(id: "f0", with: {}), (id: "f1", with: {}), (id: "f2", with: {}), (id: "f3", with: {}), (id: "f4", with: {})],
    replay: (drive: Speed, least_acceleration_m_s2: -0.2),
    simulation: (fidelity: Longitudinal, step_s: 0.1),
)"#;

/// An engine that is off takes nothing where the model's idles: that is what was done, and no missing consumer.
#[test]
fn an_engine_that_was_switched_off_is_no_mismatch() {
    /// What this engine takes at idle, and a little [kg/s].
    const IDLE_KG_S: f64 = 1.2e-3;
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.01 * draws.normal(),
        _ if value < IDLE_KG_S => 0.0,
        _ => value * (1.0 + 0.01 * draws.normal()),
    };
    let channels = ["speed_m_s", "fuel_rate_kg_s"];
    let recording = recording_of_scenario(SCENARIO, &registry, &channels, (37, &noisy));
    let found = found_of_scenario(SCENARIO, &recording, &Options::default(), &registry).unwrap();
    let diagnosis = &found.diagnosis;
    assert!(
        diagnosis.notes.iter().any(|note| note.contains("an engine that is off")),
        "{:?}",
        diagnosis.notes
    );
    for id in ["auxiliary_power", "engine_friction", "cold_start", "payload_change"] {
        assert!(!named(&found, id), "{}", diagnosis.answer);
    }
}

/// Drives that roll freely now and then.
const STANDS: &str = r"cycle: [
        Reach(speed_m_s: 6, acceleration_m_s2: 0.4), Hold(for_s: 20), Reach(speed_m_s: 0, acceleration_m_s2: 0.4),
        Stand(until: Elapsed(for_s: 60)),
        Reach(speed_m_s: 4, acceleration_m_s2: 0.3), Hold(for_s: 20), Reach(speed_m_s: 0, acceleration_m_s2: 0.4),
    ],";
const ROLLS: &str = r"start: (position_m: 0, speed_m_s: 3),
    cycle: [
        Reach(speed_m_s: 7, acceleration_m_s2: 0.3), Hold(for_s: 15), Coast(until: SpeedBelow(speed_m_s: 3)),
        Reach(speed_m_s: 9, acceleration_m_s2: 0.3), Hold(for_s: 15), Coast(until: SpeedBelow(speed_m_s: 4)),
    ],";
const RUNS: &str = r#"runs: [(id: "f0", with: {}), (id: "f1", with: {}), (id: "f2", with: {})"#;
const APART: &str = r#"runs: [(id: "f0", with: {}), (id: "f1", with: {"cycle.0.speed_m_s": 5.0}),
        (id: "f2", with: {"cycle.3.speed_m_s": 6.0})"#;

/// Work between ends of a field, without a flag.
static LONG: LazyLock<String> = LazyLock::new(|| {
    const LEVELS_M_S: [u32; 10] = [6, 3, 8, 4, 9, 2, 7, 5, 9, 3];
    const SPEEDS: &str = r#"runs: [(id: "f0", with: {}), (id: "f1", with: {"cycle.0.speed_m_s": 5.0}),
        (id: "f2", with: {"cycle.4.speed_m_s": 6.5})"#;
    let level =
        |speed_m_s: u32| format!("Reach(speed_m_s: {speed_m_s}, acceleration_m_s2: 0.4), Hold(for_s: 12), ");
    let levels = format!("cycle: [{}],", LEVELS_M_S.map(level).concat());
    SCENARIO.replacen(STANDS, &levels, 1).replacen(RUNS, SPEEDS, 1).replacen("sd: 2000", "sd: 700", 1)
});

/// A speed by radar, and what an engine's own bus says of it.
fn by_bus(name: &str, value: f64, draws: &mut Draws) -> f64 {
    match name {
        "speed_m_s" => value + 0.01 * draws.normal(),
        "tractive_force_n" => value + 100.0 * draws.normal(),
        "engine_torque_n_m" => value + 4.0 * draws.normal(),
        "engine_speed_rad_s" => value + 0.2 * draws.normal(),
        _ => value,
    }
}

/// A flag tells when a vehicle rolls freely, and nothing tells what drives it else: the torque of the engine shows what is lost
/// on the way to the wheels.
#[test]
fn a_loss_between_engine_and_wheels_is_told_beside_a_flag_of_coasting() {
    let registry = headland_stock::registry();
    let text =
        SCENARIO.replacen(STANDS, ROLLS, 1).replacen(RUNS, APART, 1).replacen("sd: 2000", "sd: 700", 1);
    let truth = text.replacen("    free:", "    effects: [driveline_efficiency(loss: 0.09)],\n    free:", 1);
    let channels = ["speed_m_s", "engine_torque_n_m", "engine_speed_rad_s", "coasting"];
    let recording = recording_of_scenario(&truth, &registry, &channels, (41, &by_bus));
    let found = found_of_scenario(&text, &recording, &Options::default(), &registry).unwrap();
    let diagnosis = &found.diagnosis;
    assert!(named(&found, "driveline_efficiency"), "{}", diagnosis.answer);
    let told = diagnosis.findings.iter().find(|finding| finding.id == "driveline_efficiency").unwrap();
    assert!((told.parameters[0].value - 0.09).abs() < 0.03, "{}", diagnosis.answer);
    assert!(diagnosis.findings.iter().all(|finding| finding.id != "engine_friction"), "{}", diagnosis.answer);
    // What nothing drives forward is told by the power of the engine.
    assert_eq!(diagnosis.fit.signal, "engine_power_w");
    // The engine of the improved scenario turns as it was recorded, as it did here.
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    assert_eq!(improved.replay.inputs, Some(AskedInputs { all: true, listed: vec![Inputs::EngineSpeed] }));
}

/// Brakes hold the wheels at which the force was measured, and the engine, which they drive, turns more slowly than that of the model:
/// its torque says no more there than that it was driven. Accessories gave way to it, and a law that nobody listed was in sight.
#[test]
fn an_engine_that_is_driven_while_brakes_work_tells_of_nothing() {
    /// The gearbox does not shift down.
    const SLOWER: f64 = 0.6;
    let registry = headland_stock::registry();
    let text = SCENARIO
        .replacen(
            "Reach(speed_m_s: 0, acceleration_m_s2: 0.4)",
            "Reach(speed_m_s: 0, acceleration_m_s2: 1.2)",
            2,
        )
        .replacen("sd: 2000", "sd: 400", 1)
        .replacen("    replay: (drive: Speed, least_acceleration_m_s2: -0.2),\n", "", 1);
    let channels =
        ["speed_m_s", "tractive_force_n", "engine_torque_n_m", "engine_speed_rad_s", "brake_force_n"];
    let recording = recording_of_scenario(&text, &registry, &channels, (47, &by_bus));
    let of = |trace: &Trace, name: &str, sample: usize| trace.get(name).unwrap()[sample];
    let recording = changed(&recording, "tractive_force_n", |force_n, trace, sample| {
        force_n - of(trace, "brake_force_n", sample).abs()
    });
    let recording = changed(&recording, "engine_speed_rad_s", |speed_rad_s, trace, sample| {
        if of(trace, "engine_torque_n_m", sample) < 0.0 { SLOWER * speed_rad_s } else { speed_rad_s }
    });
    let found = found_of_scenario(&text, &recording, &Options::default(), &registry).unwrap().diagnosis;
    assert_eq!(found.verdict, Verdict::None, "{}", found.answer);
    let accessories = found.calibrated.iter().find(|one| one.name == "accessory_power_w").unwrap();
    assert!((accessories.value - 9000.0).abs() < 800.0, "{accessories:?}");
}

/// What pulls beyond a speed with the square of what is above it, of which only the engine's torque and the coast-downs between tell:
/// a threshold and the changes of a gear stood for it.
#[test]
fn a_force_that_nobody_listed_is_told_by_the_torque_of_an_engine() {
    const LAW: &str = r#"expression(resistance: "a_n * max((v - v0_m_s) / v0_m_s, 0)^2", constants: {"a_n": 9000.0, "v0_m_s": 4.0})"#;
    let registry = headland_stock::registry();
    let text =
        SCENARIO.replacen(STANDS, ROLLS, 1).replacen(RUNS, APART, 1).replacen("sd: 2000", "sd: 700", 1);
    let truth = text.replacen("    free:", &format!("    effects: [{LAW}],\n    free:"), 1);
    let channels = ["speed_m_s", "engine_torque_n_m", "engine_speed_rad_s", "coasting"];
    let recording = recording_of_scenario(&truth, &registry, &channels, (43, &by_bus));
    let found = found_of_scenario(&text, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    assert!(named(&found, "unlisted"), "{}", said.answer);
    let told = said.findings.iter().find(|finding| finding.id == "unlisted").unwrap();
    assert!(told.equation.starts_with("F = "), "{}", told.equation);
}

/// Down a hill that nobody knows an engine cuts its fuel, and takes no less however steep it is: that is no shallower slope, and no
/// soft ground at the steep places.
#[test]
fn an_engine_that_cuts_its_fuel_downhill_bends_no_slope() {
    /// Places [m] and slopes of the hill.
    const HILL: [[f64; 2]; 8] = [
        [0.0, 0.0],
        [100.0, 0.0],
        [150.0, 0.04],
        [200.0, 0.06],
        [300.0, 0.0],
        [350.0, -0.06],
        [400.0, 0.0],
        [700.0, 0.0],
    ];
    const LENGTH_M: f64 = 700.0;
    const DRIVES: &str = r"cycle: [
        Reach(speed_m_s: 6, acceleration_m_s2: 0.4), Hold(for_s: 45),
        Reach(speed_m_s: 8, acceleration_m_s2: 0.4), Hold(for_s: 30),
        Reach(speed_m_s: 0, acceleration_m_s2: 0.4),
    ],";
    const SPEEDS: &str = r#"runs: [(id: "f0", with: {}), (id: "f1", with: {"cycle.0.speed_m_s": 5.0}),
        (id: "f2", with: {"cycle.0.speed_m_s": 7.0})"#;
    let registry = headland_stock::registry();
    let text = SCENARIO
        .replacen(STANDS, DRIVES, 1)
        .replacen(RUNS, SPEEDS, 1)
        .replacen("coefficient: 0.05", "coefficient: 0.012", 1)
        .replacen("sd: 0.005, bounds: (0.01, 0.3)", "sd: 0.001, bounds: (0.005, 0.1)", 1);
    let channels = ["speed_m_s", "position_m", "fuel_rate_kg_s"];
    // The same way, from either end of it.
    let of = |reversed: bool, seed: u64| {
        let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
            "speed_m_s" => value + 0.01 * draws.normal(),
            "fuel_rate_kg_s" => value * (1.0 + 0.01 * draws.normal()),
            "position_m" if reversed => LENGTH_M - value,
            _ => value,
        };
        let mut points: Vec<[f64; 2]> = HILL.to_vec();
        if reversed {
            points = points.iter().rev().map(|[at_m, slope]| [LENGTH_M - at_m, -slope]).collect();
        }
        let [places, slopes] =
            [0, 1].map(|part| points.iter().map(|point| point[part]).collect::<Vec<f64>>());
        let hidden = format!("    effects: [grade(positions_m: {places:?}, grades: {slopes:?})],\n    free:");
        let truth = text.replacen("    free:", &hidden, 1);
        let mut recording = recording_of_scenario(&truth, &registry, &channels, (seed, &noisy));
        for run in &mut recording.runs {
            (run.reversed, run.held_out) = (reversed, run.id == "f2");
        }
        recording
    };
    let mut recording = of(false, 51);
    let back = of(true, 53).runs.into_iter();
    recording.runs.extend(back.map(|run| RecordedRun { id: format!("{}_back", run.id), ..run }));
    let found = found_of_scenario(&text, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [slope] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(slope.id, "grade", "{}", said.answer);
    let steepest = slope.parameters.iter().find(|one| one.name == "grade").unwrap().value.abs();
    assert!((steepest / 0.06 - 1.0).abs() < 0.1, "{}", said.answer);
}

/// Cold oil, and a fan that is on for a while in every run: beside the cold the edges of the fan are where they are.
#[test]
fn a_consumer_finds_its_edges_beside_cold_oil() {
    const HIDDEN: &str = "    effects: [
        driveline_temperature(cold_force_n: 500, cold_viscous_n_s_m: 60, time_constant_s: 170),
        auxiliary_power(times_s: [50, 110], powers_w: [9000]),
    ],
    free:";
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "engine_torque_n_m" => value + 30.0 * draws.normal(),
        "engine_speed_rad_s" => value + 0.3 * draws.normal(),
        _ => value,
    };
    let channels = ["speed_m_s", "engine_torque_n_m", "engine_speed_rad_s"];
    let recording =
        recording_of_scenario(&LONG.replacen("    free:", HIDDEN, 1), &registry, &channels, (61, &noisy));
    let found = found_of_scenario(&LONG, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let ids: Vec<&str> = said.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert!(ids.contains(&"auxiliary_power") && named(&found, "driveline_temperature"), "{}", said.answer);
    let fan = said.findings.iter().find(|finding| finding.id == "auxiliary_power").unwrap();
    let value = |name: &str| {
        fan.parameters.iter().find(|one| one.name == name).unwrap_or_else(|| panic!("{}", said.answer)).value
    };
    assert!((value("from_s") - 50.0).abs() < 2.0 && (value("to_s") - 110.0).abs() < 2.0, "{}", said.answer);
}

/// A fan that runs while the oil is hot, beside an engine that started cold: a power that takes a course of its own in each run
/// draws both, and tells nothing of the run that is held out.
#[test]
fn a_fan_by_the_recorded_temperature_of_the_oil_is_no_course_of_each_run() {
    const HIDDEN: &str = "    effects: [cold_start(cold_torque_n_m: 90, time_constant_s: 60)],\n    free:";
    const HOT_C: f64 = 62.0;
    // 9 kW at the shaft.
    const FAN_KG_S: f64 = 9e3 / (0.448 * 42.78e6);
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "fuel_rate_kg_s" => value + 5e-5 * draws.normal(),
        _ => value,
    };
    let channels = ["speed_m_s", "fuel_rate_kg_s"];
    let mut recording =
        recording_of_scenario(&LONG.replacen("    free:", HIDDEN, 1), &registry, &channels, (67, &noisy));
    for (run, cold_c) in recording.runs.iter_mut().zip([12.0, 30.0, 21.0, 35.0, 16.0]) {
        let oil_c: Vec<f64> =
            run.trace.time_s().iter().map(|time_s| cold_c + 55.0 * (1.0 - (-time_s / 60.0).exp())).collect();
        let mut fuel_kg_s = run.trace.remove("fuel_rate_kg_s").unwrap().values;
        for (fuel, _) in fuel_kg_s.iter_mut().zip(&oil_c).filter(|(_, oil_c)| **oil_c > HOT_C) {
            *fuel += FAN_KG_S;
        }
        run.trace.push("fuel_rate_kg_s", fuel_kg_s, Origin::Measured).unwrap();
        run.trace.push("oil_temperature_c", oil_c, Origin::Measured).unwrap();
    }
    let found = found_of_scenario(&LONG, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    assert!(!named(&found, "auxiliary_power"), "{}", said.answer);
    let fan =
        said.findings.iter().find(|one| one.id == "unlisted").unwrap_or_else(|| panic!("{}", said.answer));
    assert_eq!(fan.depends_on, ["oil_temperature_c"], "{}", said.answer);
    let hot = fan.parameters.iter().find(|one| one.name.starts_with("oil_temperature1")).unwrap();
    assert!((hot.value - HOT_C).abs() < 1.0, "{}", said.answer);
}

/// Four runs of an engine's fuel, with what is hidden in them from one time to another [s]: in two of them at other times than in the
/// other two.
fn of_two_plans(hidden: &dyn Fn([u32; 2]) -> String, registry: &Registry) -> Recording {
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "fuel_rate_kg_s" => value + 8e-5 * draws.normal(),
        _ => value,
    };
    let channels = ["speed_m_s", "fuel_rate_kg_s"];
    let of = |times_s: [u32; 2]| {
        let hidden = format!("    effects: [{}],\n    free:", hidden(times_s));
        recording_of_scenario(&LONG.replacen("    free:", &hidden, 1), registry, &channels, (63, &noisy))
    };
    let (mut recording, other) = (of([60, 130]), of([25, 85]));
    for run in [1, 3] {
        recording.runs[run] = other.runs[run].clone();
    }
    recording.runs.remove(2);
    recording
}

/// Consumers that some runs switch at other times than others are a course of each run, not what all runs have in common.
#[test]
fn consumers_that_each_run_switches_at_times_of_its_own_are_told() {
    let registry = headland_stock::registry();
    let consumer = |times_s| format!("auxiliary_power(times_s: {times_s:?}, powers_w: [8000])");
    let recording = of_two_plans(&consumer, &registry);
    let found = found_of_scenario(&LONG, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let ids: Vec<&str> = said.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert_eq!(ids, ["auxiliary_power"], "{}", said.answer);
    let course = &found.effects[0].trace;
    let at = |time_s: f64| course.time_s().partition_point(|own| *own < time_s);
    let power_w = course.get("auxiliary_power_w").unwrap();
    let edges = [[56.0, 64.0], [140.0, 120.0]].map(|edge| edge.map(|time_s| power_w[at(time_s)]));
    assert!(edges.iter().all(|[off, on]| (on - off).abs() > 10_000.0), "{edges:?}: {}", said.answer);
}

/// Consumers that each run switches every dozen seconds, to one power and another: a course that wanders as fast gives back what it takes.
#[test]
fn consumers_that_each_run_switches_many_times_are_told_in_steps() {
    const POWERS_W: [f64; 7] = [7000.0, 0.0, 4500.0, 0.0, 9000.0, 0.0, 6000.0];
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "fuel_rate_kg_s" => value + 8e-5 * draws.normal(),
        _ => value,
    };
    let times_s = |run: usize| -> Vec<f64> {
        let (first_s, apart_s) = (6.0 + 3.0 * run as f64, 11.0 + 1.3 * run as f64);
        (0..=POWERS_W.len()).map(|edge| first_s + apart_s * edge as f64).collect()
    };
    let of = |run: usize| {
        let times_s = times_s(run);
        let hidden = format!(
            "    effects: [auxiliary_power(times_s: {times_s:?}, powers_w: {POWERS_W:?})],\n    free:"
        );
        let text = LONG.replacen("    free:", &hidden, 1);
        recording_of_scenario(&text, &registry, &["speed_m_s", "fuel_rate_kg_s"], (71, &noisy))
    };
    let mut recording = of(0);
    recording.runs.truncate(3);
    for run in 1..recording.runs.len() {
        recording.runs[run] = of(run).runs[run].clone();
    }
    let found = found_of_scenario(&LONG, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let ids: Vec<&str> = said.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert_eq!((said.verdict, ids), (Verdict::MissingPhysics, vec!["auxiliary_power"]), "{}", said.answer);
    // What stays between edges has no length over which it forgets itself.
    assert!(said.findings[0].parameters.iter().all(|one| !one.name.starts_with("length")), "{}", said.answer);
    let course = &found.effects[0].trace;
    let power_w = course.get("auxiliary_power_w").unwrap();
    let at_w = |piece: usize| {
        let times_s = times_s(0);
        let middle_s = 0.5 * (times_s[piece] + times_s[piece + 1]);
        power_w[course.time_s().partition_point(|own_s| *own_s < middle_s)]
    };
    let off_w = at_w(1);
    for piece in [0, 2, 6] {
        let share = (at_w(piece) - off_w) / (at_w(4) - off_w);
        assert!((share - POWERS_W[piece] / POWERS_W[4]).abs() < 0.1, "{piece}: {share}: {}", said.answer);
    }
}

/// A fan that turns with the engine, by the cube of its speed, beside such a consumer: a course of each run draws both, and tells nothing of
/// the run that is held out.
#[test]
fn a_fan_by_the_speed_of_the_engine_is_told_beside_a_consumer_that_each_run_switches() {
    /// At the shaft, at 200 rad/s.
    const FAN_W: f64 = 18e3;
    const CONSUMER_W: f64 = 4000.0;
    const HEATING_VALUE_J_KG: f64 = 42.78e6;
    /// Friction torque of the engine: its mean pressure times its displacement over 4 π.
    const FRICTION_N_M: f64 = 1.9e5 * 8.8e-3 / (4.0 * PI);
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        _ => value,
    };
    let channels = ["speed_m_s", "tractive_force_n", "fuel_rate_kg_s", "engine_speed_rad_s"];
    let of = |times_s: [u32; 2]| {
        let hidden = format!(
            "    effects: [auxiliary_power(times_s: {times_s:?}, powers_w: [{CONSUMER_W:?}])],\n    free:"
        );
        recording_of_scenario(&SCENARIO.replacen("    free:", &hidden, 1), &registry, &channels, (69, &noisy))
    };
    let (mut recording, other) = (of([30, 75]), of([60, 100]));
    recording.runs.truncate(4);
    for (number, run) in recording.runs.iter_mut().enumerate() {
        if number % 2 == 1 {
            *run = RecordedRun { id: run.id.clone(), ..other.runs[number].clone() };
        }
        let mut draws = Draws::new(69, 100 + number as u64);
        let turned = run.trace.remove("engine_speed_rad_s").unwrap().values;
        let mut fuel_kg_s = run.trace.remove("fuel_rate_kg_s").unwrap().values;
        // The lever of the engine is moved all the time.
        let turns = |time_s: &f64| 145.0 + 45.0 * (time_s / 5.0 + 2.0 * number as f64).sin();
        let turns: Vec<f64> = run.trace.time_s().iter().map(turns).collect();
        for ((fuel, before), after) in fuel_kg_s.iter_mut().zip(&turned).zip(&turns) {
            *fuel += FRICTION_N_M * (after - before) / HEATING_VALUE_J_KG;
            *fuel += FAN_W * (after / 200.0).powi(3) / (0.448 * HEATING_VALUE_J_KG) + 5e-5 * draws.normal();
        }
        run.trace.push("fuel_rate_kg_s", fuel_kg_s, Origin::Measured).unwrap();
        run.trace.push("engine_speed_rad_s", turns, Origin::Measured).unwrap();
    }
    let found = found_of_scenario(SCENARIO, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let finding = |id: &str| {
        said.findings.iter().find(|one| one.id == id).unwrap_or_else(|| panic!("{id}: {}", said.answer))
    };
    let (fan, consumer) = (finding("unlisted"), finding("auxiliary_power"));
    assert_eq!(fan.depends_on, ["engine_speed_rad_s"], "{}", said.answer);
    let power_w = consumer.parameters.iter().find(|one| one.name == "power_w").unwrap().value;
    assert!((power_w / CONSUMER_W - 1.0).abs() < 0.25, "{}", said.answer);
    let unseen = said.fit.held_out.as_ref().unwrap();
    assert!(unseen.rmse_after < 0.6 * unseen.rmse_before, "{}", said.answer);
}

/// An implement that is lowered where each run comes to it takes more the faster the tractor goes, and is no consumer.
#[test]
fn a_pull_in_spells_is_told_from_a_consumer_by_fuel_alone() {
    const PULL_N: f64 = 4000.0;
    let registry = headland_stock::registry();
    let pull = |[from_s, to_s]: [u32; 2]| {
        format!("drawbar_load(force_n: {PULL_N:?}, from_s: {from_s}, to_s: {to_s})")
    };
    let recording = of_two_plans(&pull, &registry);
    let found = found_of_scenario(&LONG, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [one] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!((one.id.as_str(), said.verdict), ("drawbar_load", Verdict::MissingPhysics), "{}", said.answer);
    let force = one.parameters.iter().find(|one| one.name == "force_n").unwrap();
    assert!((force.value / PULL_N - 1.0).abs() < 0.1, "{}", said.answer);
    // The improved scenario of the first run pulls when it did.
    let text = &found.scenarios[0];
    assert!(text.contains("drawbar_load(times_s: ["), "{text}");
    let course = &found.effects[0].trace;
    let at = |time_s: f64| course.time_s().partition_point(|own| *own < time_s);
    let power_w = course.get("drawbar_load_w").unwrap();
    let speed_m_s = recording.runs[0].trace.get("speed_m_s").unwrap();
    for (time_s, on) in [(40.0, 0.0), (80.0, 1.0), (110.0, 1.0), (150.0, 0.0)] {
        let force_n = 0.85 * 0.448 * power_w[at(time_s)] / speed_m_s[at(time_s)];
        assert!((force_n / PULL_N - on).abs() < 0.15, "{force_n} N at {time_s} s: {}", said.answer);
    }
}

/// Downhill an engine is driven, and the consumer that nobody knew is the first that asks it for power: what it takes of fuel there is
/// less than elsewhere, with or without the slopes that were found meanwhile.
#[test]
fn a_consumer_takes_as_much_beside_slopes_that_let_the_engine_roll() {
    const POWER_W: f64 = 3400.0;
    let levels = [5, 8, 4, 9, 6]
        .map(|speed_m_s| format!("Reach(speed_m_s: {speed_m_s}, acceleration_m_s2: 0.4), Hold(for_s: 18), "));
    let text = |effects: &str| {
        SCENARIO
            .replacen(STANDS, &format!("cycle: [{}], effects: [{effects}],", levels.concat()), 1)
            .replacen("coefficient: 0.05", "coefficient: 0.017", 1)
            .replacen("sd: 0.005", "sd: 0.0015", 1)
            .replacen("sd: 2000", "sd: 700", 1)
    };
    let slopes = "grade(positions_m: [0, 100, 200, 300, 400, 500, 600, 700, 900], \
                  grades: [0.0, 0.03, -0.02, -0.04, 0.02, 0.03, -0.03, 0.01, 0.0])";
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.015 * draws.normal(),
        "tractive_force_n" => value + 100.0 * draws.normal(),
        "fuel_rate_kg_s" => (value + 4e-5 * draws.normal()).max(0.0),
        _ => value,
    };
    let channels = ["speed_m_s", "position_m", "tractive_force_n", "fuel_rate_kg_s"];
    let hidden = text(&format!("auxiliary_power(power_w: {POWER_W:?}), {slopes}"));
    let recording = recording_of_scenario(&hidden, &registry, &channels, (43, &noisy));
    let found = found_of_scenario(&text(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let mut told: Vec<&str> = said.findings.iter().map(|one| one.id.as_str()).collect();
    told.sort_unstable();
    assert_eq!(told, ["auxiliary_power", "grade"], "{}", said.answer);
    let consumer = said.findings.iter().find(|one| one.id == "auxiliary_power").unwrap();
    assert!((consumer.parameters[0].value / POWER_W - 1.0).abs() < 0.1, "{}", said.answer);
}

/// Passes with another implement each, one as heavy to pull as the tractor weighs a quarter, where power alone tells.
#[test]
fn pulls_that_differ_from_run_to_run_are_no_masses() {
    const PULLS_N: [f64; 5] = [2000.0, 26_000.0, 9000.0, 30_000.0, 18_000.0];
    let registry = headland_stock::registry();
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "engine_torque_n_m" => value + 8.0 * draws.normal(),
        _ => value,
    };
    let channels = ["speed_m_s", "engine_speed_rad_s", "engine_torque_n_m"];
    let text = |pull_n: f64| {
        let effects = format!(
            "cycle: [Reach(speed_m_s: 4, acceleration_m_s2: 0.3), Hold(for_s: 25), Reach(speed_m_s: 2.5, \
                               acceleration_m_s2: 0.3), Hold(for_s: 20)], effects: [drawbar_load(force_n: {pull_n:?})],"
        );
        let cycle = SCENARIO.find("    cycle: [").unwrap()..SCENARIO.find("    free: [").unwrap();
        let mut text = SCENARIO.to_owned();
        text.replace_range(cycle, &effects);
        text
    };
    let one = |run: usize| {
        let seed = 47 + u64::try_from(run).unwrap();
        let recording = recording_of_scenario(&text(PULLS_N[run]), &registry, &channels, (seed, &noisy));
        RecordedRun { path: None, ..recording.runs[run].clone() }
    };
    let runs: Vec<RecordedRun> = (0..PULLS_N.len()).map(one).collect();
    let recording = recording_of_scenario(&text(0.0), &registry, &channels, (47, &noisy));
    let recording = Recording { runs, ..recording };
    let found = found_of_scenario(&text(0.0), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [pull] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(pull.id, "drawbar_load", "{}", said.answer);
    assert!(pull.sentence.contains("differs from run to run"), "{}", said.answer);
    assert!(pull.indistinguishable_from.iter().all(|rival| rival.id != "mass"), "{}", said.answer);
}
