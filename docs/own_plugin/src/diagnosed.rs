//! Effects of this program are hidden in simulated recordings, and found by a diagnosis that knows the scenario alone.

use crate::registry;
use headland_calibrate::statistics::Draws;
use headland_diagnose::{Diagnosed, Options, Progress, diagnose};
use headland_recording::{RecordedRun, Recording};
use headland_scenario::Scenario;
use headland_sim::simulate;
use headland_trace::{Origin, Trace};
use std::path::{Path, PathBuf};

struct Silent;

impl Progress for Silent {
    fn step(&self, _: &str) {}

    fn interrupted(&self) -> bool {
        false
    }
}

fn lane() -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("washboard_lane.ron");
    Scenario::read(&path, &registry()).unwrap()
}

/// What sensors would record of the lane with an effect more.
fn recorded(effect: &str) -> Recording {
    let registry = registry();
    let truth = lane().with_effect(effect, &registry).unwrap();
    let run = |(number, spec): (usize, &headland_scenario::RunSpec)| {
        let scenario = truth.run(spec, &registry).unwrap();
        let model = scenario.model(&registry).unwrap();
        let outcome = simulate(&model, scenario.cycle.as_ref().unwrap()).unwrap();
        let mut draws = Draws::new(3, number as u64);
        let mut trace = Trace::new(outcome.trace.time_s().to_vec()).unwrap();
        for name in ["speed_m_s", "position_m", "heading_rad", "tractive_force_n", "coasting"] {
            let noise = if name == "speed_m_s" { 0.02 } else { 0.0 };
            let values = outcome.trace.get(name).unwrap().iter();
            let values: Vec<f64> = values.map(|value| value + noise * draws.normal()).collect();
            trace.push(name, values, Origin::Measured).unwrap();
        }
        RecordedRun {
            id: spec.id.clone(),
            trace,
            path: Some("lane".to_owned()),
            reversed: false,
            held_out: number == 3,
            known: Vec::new(),
            sensors: Vec::new(),
        }
    };
    Recording {
        about: "simulated".to_owned(),
        path: PathBuf::from("recording.ron"),
        runs: truth.runs.iter().enumerate().map(run).collect(),
        known: Vec::new(),
        notices: Vec::new(),
    }
}

/// Hides an effect and looks for it: it comes first, its force within its interval, and the improved scenario has it.
fn is_found(hidden: &str, id: &str, force_n: f64) {
    let found: Diagnosed =
        diagnose(&lane(), &recorded(hidden), &registry(), &Options::default(), &Silent).unwrap();
    let answer = &found.diagnosis.answer;
    let finding = found.diagnosis.findings.first().unwrap_or_else(|| panic!("{answer}"));
    assert_eq!(finding.id, id, "{answer}");
    let [low, high] = finding.parameters[0].ci95;
    assert!(low < force_n && force_n < high, "{answer}");
    let improved =
        Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry()).unwrap();
    assert_eq!(improved.model(&registry()).unwrap().effects[0].name, id);
}

#[test]
fn a_washboard_is_found_without_being_asked_for() {
    is_found("washboard(force_n: 1430)", "washboard", 1430.0);
}

#[test]
fn a_crop_is_found_because_the_scenario_suspects_it() {
    is_found("standing_crop(force_n: 1210, from_m: 60, to_m: 110, lag_s: 0.5)", "standing_crop", 1210.0);
}
