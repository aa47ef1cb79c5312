//! Many roads, each driven once: what differs from run to run beside slopes that nobody knows.

use super::setting::{ELECTRIC, found_of_scenario, recording_of_scenario};
use headland_calibrate::statistics::Draws;
use headland_diagnose::Options;
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_trace::Origin;

/// A tractor that drives a kilometre and more at several speeds.
pub fn drive(effects: &str) -> String {
    let level =
        |speed_m_s: u32| format!("Reach(speed_m_s: {speed_m_s}, acceleration_m_s2: 0.5), Hold(for_s: 40), ");
    let cycle: String = [8, 4, 9, 5, 7].map(level).concat();
    format!(
        r#"(
    about: "a tractor on a road",
    vehicle: (
        mass_kg: 13000, rotating_mass_kg: 800, drag_area_m2: 6.0,
        driveline: {ELECTRIC},
    ),
    ground: (terrain: Flat(heading_rad: 0.0), soil: LinearSpeedLaw(coefficient: 0.03, speed_scale_m_s: "100 km/h")),
    air: (density_kg_m3: 1.2),
    cycle: [{cycle}],
    effects: [{effects}],
    free: [
        (name: "ground.soil.coefficient", sd: 0.005, bounds: (0.005, 0.3)),
        (name: "vehicle.mass_kg", sd: 65, bounds: (10000, 16000)),
        (name: "vehicle.drag_area_m2", sd: 0.5, bounds: (2, 12)),
    ],
    runs: [(id: "r", with: {{}})],
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#
    )
}

/// Slopes of a road: knots, and a process that forgets itself within 60 m.
fn road(number: u64) -> String {
    const STEP_M: f64 = 20.0;
    let mut draws = Draws::new(77, number);
    let kept = (-STEP_M / 60.0_f64).exp();
    let mut slope = 0.012 * draws.normal();
    let mut next = || {
        let here = slope;
        slope = kept * slope + 0.012 * (1.0 - kept * kept).sqrt() * draws.normal();
        here
    };
    let slopes: Vec<f64> = (0..100).map(|_| next()).collect();
    let places: Vec<f64> = (0..100).map(|knot| STEP_M * f64::from(knot)).collect();
    format!("grade(positions_m: {places:?}, grades: {slopes:?})")
}

/// Resistance for each kelvin that the air of a day is colder [1/K].
const PER_K: f64 = 4e-4;

/// A drive on each of so many days between −2 and 31 °C, with what else is hidden on that day.
fn of_many_days(days: u32, registry: &Registry, hidden: &dyn Fn(u32) -> String) -> Recording {
    let air_c = |number: u32| 31.0 - 3.0 * f64::from((number * 5) % 12);
    let hidden = |number: u32| {
        let cold = format!("rolling_resistance(coefficient: {:?})", PER_K * (20.0 - air_c(number)));
        format!("{}, {cold}", hidden(number))
    };
    let held_out: Vec<bool> = (0..days).map(|number| number % 4 == 3).collect();
    let channels = ["speed_m_s", "position_m", "tractive_force_n"];
    let mut recording = of_runs(&held_out, (500, 40.0), &channels, registry, &hidden);
    for (number, run) in (0..).zip(&mut recording.runs) {
        let temperature_c = vec![air_c(number); run.trace.len()];
        run.trace.push("air_temperature_c", temperature_c, Origin::Measured).unwrap();
    }
    recording
}

/// Nobody recorded places.
pub const BY_FORCE: [&str; 2] = ["speed_m_s", "tractive_force_n"];

/// A drive for each of these, held out where it says so, with what is hidden in it, and a force with so much noise; each has a seed
/// of its own, the first this one.
pub fn of_runs(
    held_out: &[bool],
    (seed, noise_n): (u64, f64),
    channels: &[&str],
    registry: &Registry,
    hidden: &dyn Fn(u32) -> String,
) -> Recording {
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "tractive_force_n" => value + noise_n * draws.normal(),
        _ => value,
    };
    let mut all = None;
    for (number, held_out) in (0..).zip(held_out) {
        let sensor = (seed + u64::from(number), &noisy as _);
        let mut recording = recording_of_scenario(&drive(&hidden(number)), registry, channels, sensor);
        let mut run = recording.runs.remove(0);
        (run.id, run.path, run.held_out) = (format!("r{number}"), None, *held_out);
        all.get_or_insert(recording).runs.push(run);
    }
    all.unwrap()
}

/// Of six runs the last is held out.
const LAST: [bool; 6] = [false, false, false, false, false, true];

/// Tyres that warm up from the temperature outside are one cause, and no oil beside the cold.
#[test]
fn tyres_that_warm_up_from_a_cold_day_are_one_cause() {
    let registry = headland_stock::registry();
    let warming = "rolling_temperature(cold_coefficient: 0.012, time_constant_s: 40)";
    let recording = of_many_days(6, &registry, &|_| warming.to_owned());
    let found = found_of_scenario(&drive(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [tyres] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(tyres.id, "rolling_temperature", "{}", said.answer);
    let value = |name: &str| tyres.parameters.iter().find(|one| one.name == name).unwrap().value;
    assert!((value("cold_coefficient") / 0.012 - 1.0).abs() < 0.15, "{}", said.answer);
    assert!((value("time_constant_s") / 40.0 - 1.0).abs() < 0.25, "{}", said.answer);
    assert!((value("coefficient_per_k") / PER_K - 1.0).abs() < 0.1, "{}", said.answer);
}

/// A map of each road's slopes could take up the cold of its day: slopes that reach as far as a grid lets them are no reason to.
#[test]
fn a_resistance_that_rises_in_the_cold_is_told_beside_the_slopes_of_many_roads() {
    let registry = headland_stock::registry();
    let recording = of_many_days(12, &registry, &|number| road(u64::from(number)));
    let found = found_of_scenario(&drive(""), &recording, &Options::default(), &registry).unwrap();
    let answer = &found.diagnosis.answer;
    let cold = found.diagnosis.findings.iter().find(|one| one.id == "rolling_temperature");
    let told = cold.unwrap_or_else(|| panic!("{answer}")).parameters.iter();
    let per_k =
        told.clone().find(|one| one.name == "coefficient_per_k").unwrap_or_else(|| panic!("{answer}"));
    assert!((per_k.value / PER_K - 1.0).abs() < 0.3, "{per_k:?}");
    // What goes along to another road: the tyres, and none of the slopes.
    let elsewhere = found.elsewhere.unwrap();
    assert!(elsewhere.contains("rolling_temperature") && !elsewhere.contains("grade("), "{elsewhere}");
}

/// A tank fills in all runs, and in some of them an implement pulls for a while: a course that each run takes could draw both.
#[test]
fn a_pull_of_single_runs_is_told_beside_a_load_that_comes() {
    const FILLS: &str = "payload_change(times_s: [0, 40, 150, 300], masses_kg: [0, 0, 4000, 4000])";
    let registry = headland_stock::registry();
    let recording = of_runs(&LAST, (700, 400.0), &BY_FORCE, &registry, &|number| {
        let pulls = if number % 2 == 0 { ", drawbar_load(force_n: 4000, from_s: 95, to_s: 140)" } else { "" };
        format!("{FILLS}{pulls}")
    });
    let found = found_of_scenario(&drive(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [one, other] = &said.findings[..] else { panic!("{}", said.answer) };
    let (load, pull) = if one.id == "payload_change" { (one, other) } else { (other, one) };
    assert_eq!([load.id.as_str(), pull.id.as_str()], ["payload_change", "drawbar_load"], "{}", said.answer);
    assert!(pull.parameters[0].value > 2000.0, "{}", said.answer);
    let pulled = |place: &headland_diagnose::Interval| ["r0", "r2", "r4"].contains(&place.run.as_str());
    let (inside, all) = (pull.stretches.iter().filter(|place| pulled(place)).count(), pull.stretches.len());
    assert!(inside >= 6 && all <= inside + 1, "{:?}", pull.stretches);
}

/// Let down and lifted within two seconds at the same times of every run: a pull that is there at once would leave another pull at each edge,
/// which a formula draws, and none of that is a cause.
#[test]
fn an_implement_that_is_let_down_slowly_pulls_in_one_window() {
    const HIDDEN: [(&str, f64); 5] =
        [("force_n", 5000.0), ("linear_n_s_m", 300.0), ("from_s", 71.3), ("to_s", 133.6), ("ramp_s", 2.0)];
    let registry = headland_stock::registry();
    let text = HIDDEN.map(|(name, value)| format!("{name}: {value:?}")).join(", ");
    let pulls = |_| format!("drawbar_load({text})");
    let recording = of_runs(&LAST, (700, 100.0), &BY_FORCE, &registry, &pulls);
    let found = found_of_scenario(&drive(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [pull] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(pull.id, "drawbar_load", "{}", said.answer);
    for (name, truth) in HIDDEN {
        let told = pull.parameters.iter().find(|one| one.name == name);
        let told = told.unwrap_or_else(|| panic!("no {name}: {}", said.answer)).value;
        let near = if name.ends_with("_s") && name != "ramp_s" { 0.1 } else { 0.1 * truth };
        assert!((told - truth).abs() < near, "{name}: {told} for {truth}: {}", said.answer);
    }
}

/// A governor answers each slope with force: what is in proportion to it would take a share of them, as a loss of the drive does.
#[test]
fn force_that_answers_slopes_is_no_loss_of_the_drive() {
    let registry = headland_stock::registry();
    let recording = of_runs(&LAST, (700, 40.0), &BY_FORCE, &registry, &|number| road(u64::from(number)));
    let found = found_of_scenario(&drive(""), &recording, &Options::default(), &registry).unwrap();
    let told: Vec<&str> = found.diagnosis.findings.iter().map(|one| one.id.as_str()).collect();
    assert!(told == ["grade"] || told == ["soft_ground"], "{}", found.diagnosis.answer);
}

/// A drive of this efficiency that brakes hard now and then, on a road.
fn braked(efficiency: f64, effects: &str) -> String {
    let free = r#"(name: "vehicle.driveline.drive_efficiency", sd: 0.015, bounds: (0.6, 1.0)),"#;
    drive(effects)
        .replace("drive_efficiency: 0.9,", &format!("drive_efficiency: {efficiency},"))
        .replace("free: [", &format!("free: [{free}"))
        .replace("speed_m_s: 4, acceleration_m_s2: 0.5", "speed_m_s: 4, acceleration_m_s2: 1.6")
        .replace("speed_m_s: 5, acceleration_m_s2: 0.5", "speed_m_s: 5, acceleration_m_s2: 0.8")
}

/// Four of them, the last held out, of an efficiency of 0.925, by a drive that gives back no more than 40 kW.
fn limited(channels: &[&str], registry: &Registry) -> Recording {
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.01 * draws.normal(),
        "motor_torque_n_m" => value + 0.5 * draws.normal(),
        "battery_voltage_v" | "battery_current_a" => value + 0.3 * draws.normal(),
        _ => value,
    };
    let hidden = braked(EFFICIENCY, &format!("regeneration_limit(power_w: {LIMIT_W:?})"));
    let mut all: Option<Recording> = None;
    for number in 0..4 {
        let mut recording = recording_of_scenario(&hidden, registry, channels, (40 + number, &noisy as _));
        let mut run = recording.runs.remove(0);
        (run.id, run.path, run.held_out) = (format!("r{number}"), None, number == 3);
        all.get_or_insert(recording).runs.push(run);
    }
    all.unwrap()
}

const EFFICIENCY: f64 = 0.925;
const LIMIT_W: f64 = 40_000.0;

/// The efficiency is stated too low: brakes that help a little leave no loss of the drive, and losses that no scenario has do not
/// stand in the way of what is stated of it.
#[test]
fn brakes_beside_a_limit_leave_nothing_behind() {
    let registry = headland_stock::registry();
    let channels = ["speed_m_s", "motor_torque_n_m", "battery_voltage_v", "battery_current_a"];
    let recording = limited(&channels, &registry);
    let found = found_of_scenario(&braked(0.9, ""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let told: Vec<&str> = said.findings.iter().map(|one| one.id.as_str()).collect();
    assert_eq!(told, ["regeneration_limit"], "{}", said.answer);
    let efficiency = said.calibrated.iter().find(|one| one.name == "drive_efficiency").unwrap();
    assert!((efficiency.value - EFFICIENCY).abs() < 0.005, "{efficiency:?}");
    // How strong they are while they last is followed, and so are those too weak to be told without the limit.
    let held = said.fit.held_out.as_ref().unwrap();
    assert!(held.rmse_after < 3.0 * held.noise, "{held:?}");
}

/// Where nobody recorded a torque the power alone tells of the limit, and it is no load that comes and goes.
#[test]
fn a_limit_is_told_by_the_power_alone() {
    let registry = headland_stock::registry();
    let channels = ["speed_m_s", "battery_voltage_v", "battery_current_a"];
    let recording = limited(&channels, &registry);
    let found = found_of_scenario(&braked(0.92, ""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [limit] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(limit.id, "regeneration_limit", "{}", said.answer);
    assert!((limit.parameters[0].value / LIMIT_W - 1.0).abs() < 0.05, "{}", said.answer);
}
