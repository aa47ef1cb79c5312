//! Recordings of a rigid body, given to a diagnosis that knows one dimension: it names what one dimension lacks.

use headland_calibrate::statistics::Draws;
use headland_diagnose::{Diagnosed, Options, Silent, diagnose};
use headland_recording::{RecordedRun, Recording};
use headland_scenario::{Fidelity, Scenario};
use headland_trace::{Origin, Trace};
use std::path::{Path, PathBuf};

/// Noise of a speed sensor [m/s].
const NOISE_M_S: f64 = 0.02;
/// A recording ends before the vehicle rocks to its rest [m/s].
const SLOWEST_M_S: f64 = 0.3;

/// What a logger would have of a run of the rigid body.
fn logged(trace: &Trace, number: u64) -> Trace {
    let get = |name: &str| trace.get(name).unwrap();
    let (speed, yaw) = (get("speed_m_s"), get("yaw_rate_rad_s"));
    let rows = speed.iter().take_while(|speed| **speed > SLOWEST_M_S).count();
    let mut draws = Draws::new(5, number);
    let mut log = Trace::new(trace.time_s()[..rows].to_vec()).unwrap();
    let mut push = |name: &str, values: Vec<f64>| log.push(name, values, Origin::Measured).unwrap();
    push("speed_m_s", speed[..rows].iter().map(|speed| speed + NOISE_M_S * draws.normal()).collect());
    push("curvature_per_m", yaw[..rows].iter().zip(speed).map(|(yaw, speed)| yaw / speed).collect());
    for name in ["position_m", "heading_rad", "coasting"] {
        push(name, get(name)[..rows].to_vec());
    }
    log
}

/// Drives runs of `scenarios/coast_down_turns.ron` as a rigid body, and gives them to a diagnosis with the same scenario.
fn diagnosed(runs: &[&str]) -> Diagnosed {
    let registry = headland_stock::registry();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/coast_down_turns.ron");
    let scenario = Scenario::read(&path, &registry).unwrap();
    assert!(matches!(scenario.fidelity, Fidelity::RigidBody { .. }));
    let recorded = runs.iter().enumerate().map(|(number, id)| {
        let spec = scenario.runs.iter().find(|spec| spec.id == *id).unwrap();
        let own = scenario.run(spec, &registry).unwrap();
        let outcome =
            own.fidelity.simulate(&own.model(&registry).unwrap(), own.cycle.as_ref().unwrap()).unwrap();
        RecordedRun {
            id: (*id).to_owned(),
            trace: logged(&outcome.trace, number as u64),
            path: None,
            reversed: false,
            held_out: number + 1 == runs.len(),
            known: Vec::new(),
            sensors: Vec::new(),
        }
    });
    let recording = Recording {
        about: "coast-downs of the rigid body".to_owned(),
        path: PathBuf::from("recording.ron"),
        runs: recorded.collect(),
        known: Vec::new(),
        notices: Vec::new(),
    };
    diagnose(&scenario, &recording, &registry, &Options::default(), &Silent).unwrap()
}

/// The vehicle's tyres hold 6 per rad of the 127.7 kN that it weighs, 766 kN/rad, about no slip; in the fastest turns they
/// come near to what friction holds, and are softer.
#[test]
fn turns_of_a_rigid_body_are_the_drag_of_its_tyres_in_curves() {
    let found = diagnosed(&["right-1", "right-3", "left-1", "left-2", "straight-1", "right-2"]);
    let said = &found.diagnosis;
    let cornering = said.findings.iter().find(|finding| finding.id == "cornering_drag");
    let cornering = cornering.unwrap_or_else(|| panic!("{}", said.answer));
    let stiffness = cornering.parameters[0].value;
    assert!((0.7 * 766e3..766e3).contains(&stiffness), "{stiffness}: {}", said.answer);
    let held_out = said.fit.held_out.as_ref().unwrap();
    assert!(held_out.rmse_after < 0.75 * held_out.rmse_before, "{}", said.answer);
}

/// What is driven straight on has no such drag: nothing is made of the turns that are not there.
#[test]
fn straight_coast_downs_of_a_rigid_body_show_no_drag_in_curves() {
    let found = diagnosed(&["straight-1", "straight-2"]);
    let said = &found.diagnosis;
    assert!(said.findings.iter().all(|finding| finding.id != "cornering_drag"), "{}", said.answer);
}
