//! A tractor, what is recorded of it, and what a diagnosis finds.

#![allow(dead_code, reason = "each file of tests uses some of it")]

use headland_calibrate::statistics::Draws;
use headland_diagnose::{DiagnoseError, Diagnosed, Options, Silent, diagnose};
use headland_plugin::Registry;
use headland_recording::{RecordedRun, Recording};
use headland_scenario::Scenario;
use headland_sim::simulate;
use headland_trace::{Origin, Trace};
use std::path::{Path, PathBuf};

/// An electric drive of a tractor of 13 t.
pub const ELECTRIC: &str = "ElectricSingleSpeed(
            open_circuit_voltage_v: 600, resistance_ohm: 0.05, capacity_a_h: 200, initial_state_of_charge: 0.8,
            max_torque_n_m: 3000, max_regeneration_torque_n_m: 3000, max_power_w: 300000, gear_ratio: 20,
            wheel_radius_m: 0.9, drive_efficiency: 0.9, standby_power_w: 500, rotating_mass_kg: 0,
        )";

/// A tractor that drives up, holds, slows down and coasts, to and fro; `more` are further fields.
pub fn scenario(coefficient: f64, effects: &str, more: &str) -> String {
    let runs: String = ["0 deg", "180 deg", "0 deg", "180 deg", "0 deg"]
        .iter()
        .enumerate()
        .map(|(run, heading)| {
            format!("(id: \"r{run}\", with: {{\"ground.terrain.heading_rad\": \"{heading}\"}}), ")
        })
        .collect::<Vec<_>>()
        .concat();
    format!(
        r#"(
    about: "a tractor",
    vehicle: (
        mass_kg: 13000, rotating_mass_kg: 800, drag_area_m2: 6.0,
        driveline: {ELECTRIC},
    ),
    ground: (terrain: Flat(heading_rad: 0.0), soil: LinearSpeedLaw(coefficient: {coefficient:?}, speed_scale_m_s: "100 km/h")),
    air: (density_kg_m3: 1.2),
    cycle: [
        Reach(speed_m_s: 8, acceleration_m_s2: 0.6),
        Hold(for_s: 6),
        Reach(speed_m_s: 3, acceleration_m_s2: 0.4),
        Hold(for_s: 4),
        Coast(until: SpeedBelow(speed_m_s: 0.5)),
    ],
    effects: [{effects}],
    free: [
        (name: "ground.soil.coefficient", sd: 0.01, bounds: (0.01, 0.3)),
        (name: "vehicle.mass_kg", sd: 65, bounds: (10000, 16000)),
    ],
    runs: [{runs}],
    {more}
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#
    )
}

const CHANNELS: [&str; 5] = ["speed_m_s", "position_m", "heading_rad", "tractive_force_n", "coasting"];

/// Simulates, and adds the noise of a speed sensor.
pub fn recorded(coefficient: f64, effects: &str) -> Recording {
    recorded_with(coefficient, effects, &headland_stock::registry())
}

/// As [`recorded`], with effects of a registry.
pub fn recorded_with(coefficient: f64, effects: &str, registry: &Registry) -> Recording {
    recorded_of_scenario(&scenario(coefficient, effects, ""), registry)
}

/// The drives of a scenario with the noise of a speed sensor.
pub fn recorded_of_scenario(text: &str, registry: &Registry) -> Recording {
    let noisy = |name: &str, value: f64, draws: &mut Draws| {
        if name == "speed_m_s" { value + 0.02 * draws.normal() } else { value }
    };
    recording_of_scenario(text, registry, &CHANNELS, (11, &noisy))
}

/// What a sensor makes of a sample: name of the channel, sample, draws of noise.
pub type Sensor<'a> = &'a dyn Fn(&str, f64, &mut Draws) -> f64;

/// The five drives with these channels, each sample as its sensor shows it; draws begin at a seed.
pub fn recording_of(
    (coefficient, effects): (f64, &str),
    registry: &Registry,
    channels: &[&str],
    (seed, sensor): (u64, Sensor),
) -> Recording {
    recording_of_scenario(&scenario(coefficient, effects, ""), registry, channels, (seed, sensor))
}

/// The drives of a scenario.
pub fn recording_of_scenario(
    text: &str,
    registry: &Registry,
    channels: &[&str],
    (seed, sensor): (u64, Sensor),
) -> Recording {
    let scenario = Scenario::of_text("truth.ron", text, Path::new(""), registry).unwrap();
    let runs = scenario.runs.iter().enumerate().map(|(number, spec)| {
        let scenario = scenario.run(spec, registry).unwrap();
        let model = scenario.model(registry).unwrap();
        let outcome = simulate(&model, scenario.cycle.as_ref().unwrap()).unwrap();
        let mut draws = Draws::new(seed, number as u64);
        let mut trace = Trace::new(outcome.trace.time_s().to_vec()).unwrap();
        for name in channels {
            let values = outcome.trace.get(name).unwrap();
            let values = values.iter().map(|value| sensor(name, *value, &mut draws)).collect();
            trace.push(*name, values, Origin::Measured).unwrap();
        }
        RecordedRun {
            id: spec.id.clone(),
            trace,
            path: Some("lane".to_owned()),
            reversed: false,
            held_out: number == 4,
            known: Vec::new(),
            sensors: Vec::new(),
        }
    });
    Recording {
        about: "simulated".to_owned(),
        path: PathBuf::from("recording.ron"),
        runs: runs.collect(),
        known: Vec::new(),
        notices: Vec::new(),
    }
}

/// What is found with the library as it is.
pub fn found(recording: &Recording, options: &Options) -> Result<Diagnosed, DiagnoseError> {
    found_with(recording, options, "", &headland_stock::registry())
}

/// What is found with further fields of the scenario and effects of a registry.
pub fn found_with(
    recording: &Recording,
    options: &Options,
    more: &str,
    registry: &Registry,
) -> Result<Diagnosed, DiagnoseError> {
    found_of_scenario(&scenario(0.069, "", more), recording, options, registry)
}

/// What is found with a scenario.
pub fn found_of_scenario(
    text: &str,
    recording: &Recording,
    options: &Options,
    registry: &Registry,
) -> Result<Diagnosed, DiagnoseError> {
    let scenario = Scenario::of_text("nominal.ron", text, Path::new(""), registry).unwrap();
    diagnose(&scenario, recording, registry, options, &Silent)
}

/// Whether a cause was named, or stated among those that cannot be told apart.
pub fn named(found: &Diagnosed, id: &str) -> bool {
    found
        .diagnosis
        .findings
        .iter()
        .any(|finding| finding.id == id || finding.indistinguishable_from.iter().any(|rival| rival.id == id))
}
