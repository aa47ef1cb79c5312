//! Every file under `scenarios/` is run, compared or checked.

use super::help::{done, headland, run, top, word};
use std::path::{Path, PathBuf};

/// Folder of the recordings, where they are.
fn recordings() -> Option<PathBuf> {
    let named = std::env::var_os("HEADLAND_RECORDINGS").map(PathBuf::from);
    let folder = named.unwrap_or_else(|| top().join("../shared/recordings"));
    folder.is_dir().then(|| folder.canonicalize().unwrap())
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|end| end == "ron"))
        .collect();
    found.sort();
    found
}

#[test]
fn every_scenario_runs_or_checks() {
    let all = files(&top().join("scenarios"));
    assert!(all.len() >= 5, "{all:?}");
    let out = tempfile::tempdir().unwrap();
    let mut ran = 0;
    for path in all {
        done(&["check", word(&path)]);
        if std::fs::read_to_string(&path).unwrap().contains("cycle:") {
            done(&["run", word(&path), "--out", word(out.path())]);
            ran += 1;
        }
    }
    assert!(ran >= 3, "{ran} scenarios have a cycle");
}

#[test]
fn every_recording_that_is_described_checks() {
    let Some(recordings) = recordings() else {
        eprintln!("skipped: no folder of recordings; HEADLAND_RECORDINGS names one");
        return;
    };
    for path in files(&top().join("scenarios/recordings")) {
        let output =
            headland().env("HEADLAND_RECORDINGS", &recordings).args(["check", word(&path)]).output().unwrap();
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{told}");
    }
}

/// The heavy truck: no mass is known, and fuel is what judges the model.
#[test]
fn a_recording_of_a_truck_is_held_against_its_scenario() {
    let Some(recordings) = recordings() else {
        eprintln!("skipped: no folder of recordings; HEADLAND_RECORDINGS names one");
        return;
    };
    let out = tempfile::tempdir().unwrap();
    let (scenario, recording) =
        (top().join("scenarios/class8_truck.ron"), top().join("scenarios/recordings/class8_trucks.ron"));
    let arguments = ["compare", word(&scenario), "--recording", word(&recording), "--out", word(out.path())];
    let output = headland().env("HEADLAND_RECORDINGS", &recordings).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let document = super::help::json(&out.path().join("comparison.json"));
    assert!(document["channels"].as_array().unwrap().iter().any(|one| one["channel"] == "fuel_rate_kg_s"));
    assert!(document["driven"].as_array().unwrap().iter().any(|one| one == "speed_m_s"));
}

#[test]
fn recordings_that_are_not_there_are_asked_for_by_name() {
    let path = top().join("scenarios/recordings/bmw_i3.ron");
    let output =
        headland().env("HEADLAND_RECORDINGS", "/nowhere").args(["check", word(&path)]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("set HEADLAND_RECORDINGS"));
    assert!(run(&["plugins"]).status.success());
}
