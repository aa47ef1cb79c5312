//! A map of engine speeds from a drive, held against the transmission that was driven.

use crate::root;
use headland_scenario::Scenario;
use headland_sim::{End, simulate};
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

fn run(words: &[&str]) -> String {
    let words = ["headland", "--quiet"].iter().chain(words).map(OsString::from);
    format!("{:?}", headland::run(&headland_stock::registry(), words))
}

fn done() -> String {
    format!("{:?}", ExitCode::SUCCESS)
}

/// The mapped drive as a recording, in a folder.
fn recorded(folder: &Path) {
    let out = folder.join("drive");
    let scenario = root().join("scenarios/mapping_drive.ron");
    assert_eq!(run(&["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()]), done());
    let description = "(about: \"a drive for a map\", runs: [(id: \"run\", file: \"drive/trace.parquet\")])";
    std::fs::write(folder.join("recording.ron"), description).unwrap();
}

fn mapped(folder: &Path, more: &[&str]) -> String {
    let (recording, out) = (folder.join("recording.ron"), folder.join("map.ron"));
    let words = ["cvt-map", recording.to_str().unwrap(), "--out", out.to_str().unwrap()];
    run(&[&words[..], more].concat())
}

/// A drive within what was seen, with either transmission; its mean engine speed.
fn engine_rad_s(folder: &Path, driveline: &str) -> f64 {
    let parts = root().join("scenarios/parts");
    let text = format!(
        "(about: \"either\", vehicle: (mass_kg: 13019.3, rotating_mass_kg: 0, drag_area_m2: 6.0, driveline: {driveline}),
          ground: (terrain: Flat, soil: LinearSpeedLaw(coefficient: 0.06, speed_scale_m_s: \"100 km/h\")),
          air: (density_kg_m3: 1.2), start: (position_m: 0, speed_m_s: \"8 km/h\"),
          tasks: [Drawbar(force_n: \"18 kN\")],
          cycle: [Hold(for_s: 5), Reach(speed_m_s: \"14 km/h\", acceleration_m_s2: 0.1), Hold(for_s: 5)],
          simulation: (fidelity: Longitudinal, step_s: 0.05))"
    )
    .replace("PARTS", parts.to_str().unwrap());
    let path = folder.join("either.ron");
    std::fs::write(&path, text).unwrap();
    let registry = headland_stock::registry();
    let scenario = Scenario::read(&path, &registry).unwrap_or_else(|error| panic!("{}", error.told()));
    let outcome = simulate(&scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap()).unwrap();
    assert_eq!(outcome.end, End::Finished);
    let speeds = outcome.trace.get("engine_speed_rad_s").unwrap();
    speeds.iter().sum::<f64>() / speeds.len() as f64
}

#[test]
fn the_map_of_a_drive_drives_as_what_it_was_made_from() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path());
    assert_eq!(mapped(folder.path(), &["--speeds", "14", "--forces", "9"]), done());
    let inside = engine_rad_s(
        folder.path(),
        "HydromechanicalCvt(engine: include(\"PARTS/engine_254_kw.ron\"), \
         transmission: include(\"PARTS/transmission_50_km_h.ron\"))",
    );
    let by_map = engine_rad_s(
        folder.path(),
        "MappedCvt(engine: include(\"PARTS/engine_254_kw.ron\"), map: include(\"map.ron\"), \
         transmission_efficiency: 0.88, idle_torque_n_m: 45, max_force_n: 90e3, wheel_radius_m: 0.93, rotating_mass_kg: 0)",
    );
    assert!((by_map / inside - 1.0).abs() < 0.03, "{by_map} by the map, {inside} from the inside");
}

#[test]
fn a_recording_without_forces_and_a_grid_without_samples_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    recorded(folder.path());
    let input = format!("{:?}", ExitCode::from(2));
    assert_eq!(mapped(folder.path(), &["--least-samples", "1000000"]), input);
    assert_eq!(mapped(folder.path(), &["--speeds", "1"]), input);
    assert_eq!(mapped(folder.path(), &["--efficiency", "1.2"]), input);
    assert_eq!(mapped(folder.path(), &["--reference-torque", "700"]), input);
    std::fs::write(folder.path().join("x.csv"), "time_s,speed_m_s,engine_speed_rad_s\n0,1,100\n1,2,110\n")
        .unwrap();
    let description = "(about: \"no force\", runs: [(id: \"run\", file: \"x.csv\")])";
    std::fs::write(folder.path().join("recording.ron"), description).unwrap();
    assert_eq!(mapped(folder.path(), &[]), input);
    assert!(!folder.path().join("map.ron").exists());
}
