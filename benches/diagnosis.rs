//! Seconds that a diagnosis takes with the whole library: ten runs of a minute at 50 Hz, with a wind that nobody wrote down.
//! `cargo bench --bench diagnosis`.
//!
//! Held against the simulation of the same ten runs, so that the ratio says more of the program than of the machine. Cross-checks on
//! runs held out, doubles with simulated noise, proof and next experiment are in it, as `headland diagnose` has them; files are not.

#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]
#![allow(clippy::unwrap_used, reason = "a bench stops where something is missing")]

use headland_calibrate::statistics::Draws;
use headland_diagnose::{Options, Silent, diagnose};
use headland_recording::{RecordedRun, Recording};
use headland_scenario::Scenario;
use headland_sim::{Outcome, simulate};
use headland_trace::{Origin, Trace};
use std::path::{Path, PathBuf};
use std::time::Instant;

const RUNS: usize = 10;
/// Of the speed sensor [m/s].
const NOISE_M_S: f64 = 0.02;
const CHANNELS: [&str; 4] = ["speed_m_s", "position_m", "heading_rad", "tractive_force_n"];

fn main() {
    let registry = headland_stock::registry();
    let read =
        |effects: &str| Scenario::of_text("bench.ron", &text(effects), Path::new(""), &registry).unwrap();
    let (truth, nominal) = (read("wind(speed_m_s: 5.5, from_rad: 0.6)"), read(""));
    let begin = Instant::now();
    let outcomes: Vec<Outcome> = truth
        .runs
        .iter()
        .map(|spec| {
            let scenario = truth.run(spec, &registry).unwrap();
            simulate(&scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap()).unwrap()
        })
        .collect();
    let simulated_s = begin.elapsed().as_secs_f64();
    let runs =
        outcomes.iter().enumerate().map(|(number, outcome)| recorded(number, &outcome.trace)).collect();
    let recording = Recording {
        about: "simulated".to_owned(),
        path: PathBuf::from("recording.ron"),
        runs,
        known: Vec::new(),
        notices: Vec::new(),
    };
    let samples: usize = recording.runs.iter().map(|run| run.trace.len()).sum();
    let driven_s: f64 = recording.runs.iter().map(|run| run.trace.duration_s()).sum();
    let begin = Instant::now();
    let found = diagnose(&nominal, &recording, &registry, &Options::default(), &Silent).unwrap();
    let diagnosed_s = begin.elapsed().as_secs_f64();
    let ids: Vec<&str> = found.diagnosis.findings.iter().map(|finding| finding.id.as_str()).collect();
    println!(
        "{RUNS} runs, {driven_s:.0} s and {samples} samples in all, on {} threads: {diagnosed_s:.1} s for a diagnosis, {:.0} times \
         the {simulated_s:.3} s of their simulation; found {ids:?}",
        rayon::current_num_threads(),
        diagnosed_s / simulated_s,
    );
}

/// A run as its sensors show it.
fn recorded(number: usize, simulated: &Trace) -> RecordedRun {
    let mut draws = Draws::new(1, number as u64);
    let mut trace = Trace::new(simulated.time_s().to_vec()).unwrap();
    for name in CHANNELS {
        let noise = if name == "speed_m_s" { NOISE_M_S } else { 0.0 };
        let values =
            simulated.get(name).unwrap().iter().map(|value| value + noise * draws.normal()).collect();
        trace.push(name, values, Origin::Measured).unwrap();
    }
    RecordedRun {
        id: format!("r{number}"),
        trace,
        path: Some("lane".to_owned()),
        reversed: number % 2 == 1,
        held_out: number >= RUNS - 3,
        known: Vec::new(),
        sensors: Vec::new(),
    }
}

/// A tractor that drives a lane to and fro for a minute each.
fn text(effects: &str) -> String {
    let runs: Vec<String> = (0..RUNS)
        .map(|run| {
            let heading = if run % 2 == 0 { "0 deg" } else { "180 deg" };
            format!("(id: \"r{run}\", with: {{\"ground.terrain.heading_rad\": \"{heading}\"}}), ")
        })
        .collect();
    let runs = runs.concat();
    format!(
        r#"(
    about: "a tractor on a lane",
    vehicle: (
        mass_kg: 13000, rotating_mass_kg: 800, drag_area_m2: 6.0,
        driveline: ElectricSingleSpeed(
            open_circuit_voltage_v: 600, resistance_ohm: 0.05, capacity_a_h: 200, initial_state_of_charge: 0.8,
            max_torque_n_m: 3000, max_regeneration_torque_n_m: 3000, max_power_w: 300000, gear_ratio: 20,
            wheel_radius_m: 0.9, drive_efficiency: 0.9, standby_power_w: 500, rotating_mass_kg: 0,
        ),
    ),
    ground: (terrain: Flat(heading_rad: 0.0), soil: LinearSpeedLaw(coefficient: 0.069, speed_scale_m_s: "100 km/h")),
    air: (density_kg_m3: 1.2),
    cycle: [
        Reach(speed_m_s: 8, acceleration_m_s2: 0.4),
        Hold(for_s: 12),
        Reach(speed_m_s: 3, acceleration_m_s2: 0.25),
        Hold(for_s: 8),
    ],
    effects: [{effects}],
    free: [
        (name: "ground.soil.coefficient", sd: 0.01, bounds: (0.01, 0.3)),
        (name: "vehicle.mass_kg", sd: 65, bounds: (10000, 16000)),
    ],
    runs: [{runs}],
    simulation: (fidelity: Longitudinal, step_s: 0.02),
)"#
    )
}
