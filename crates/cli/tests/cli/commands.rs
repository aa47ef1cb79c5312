//! Each command on small input.

use super::help::{Place, demo, done, headland, json, refused, word};
use serde_json::Value;

fn exists(folder: &std::path::Path, names: &[&str]) {
    for name in names {
        let path = folder.join(name);
        assert!(path.metadata().is_ok_and(|found| found.len() > 0), "{}", path.display());
    }
}

#[test]
fn run_writes_trace_summary_and_page() {
    let place = Place::new();
    let told = done(&["run", &place.path("scenario.ron"), "--out", &place.path("out")]);
    assert!(told.contains("a cart rolls out") && told.contains("written"), "{told}");
    exists(place.path("out").as_ref(), &["trace.parquet", "summary.json", "report.html"]);
    let summary = place.json("out/summary.json");
    assert_eq!(summary["schema"], "headland.run/1");
    assert!(summary["runs"][0]["relative_energy_residual"].as_f64().unwrap() < 1e-6);
}

#[test]
fn json_on_standard_output_is_the_document_and_nothing_else() {
    let place = Place::new();
    let out = place.path("out");
    let told = done(&["run", &place.path("scenario.ron"), "--out", &out, "--json"]);
    let document: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(document, place.json("out/summary.json"));
    for arguments in [
        &["plugins", "--json"][..],
        &["schema"],
        &["schema", "--snippets"],
        &["demo", "--list", "--json"],
        &["check", &place.path("scenario.ron"), "--json"],
    ] {
        serde_json::from_str::<Value>(&done(arguments)).unwrap();
    }
}

#[test]
fn quiet_says_nothing_on_standard_error() {
    let place = Place::new();
    let recording = place.path("recording.ron");
    let out = place.path("out");
    let output = headland().args(["coastdown", &recording, "--out", &out, "--quiet"]).output().unwrap();
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn check_reads_scenarios_and_recordings_and_counts_what_is_wrong() {
    let place = Place::new();
    let told = done(&["check", &place.path("scenario.ron"), &place.path("recording.ron")]);
    assert!(told.contains("scenario: a cart rolls out") && told.contains("recording: a cart"), "{told}");
    place.write("wrong.ron", "(abuot: \"x\")");
    let told = refused(1, &["check", &place.path("scenario.ron"), &place.path("wrong.ron")]);
    assert!(told.contains("1 of 2 files"), "{told}");
}

#[test]
fn check_holds_one_scenario_and_one_recording_together() {
    let place = Place::new();
    let (scenario, recording) = (place.path("scenario.ron"), place.path("recording.ron"));
    let told = done(&["check", &scenario, &recording]);
    assert!(told.contains("balances: motion (forces against acceleration)"), "{told}");
    assert!(!done(&["check", &scenario, &scenario, &recording]).contains("together"));
    let text = std::fs::read_to_string(&scenario).unwrap();
    let end = text.trim_end().strip_suffix(')').unwrap();
    place.write("uphill.ron", &format!("{end}    replay: (inputs: [Grade]),\n)"));
    let told = refused(1, &["check", &place.path("uphill.ron"), &recording]);
    assert!(told.contains("do not go together"), "{told}");
    let told: Value = serde_json::from_str(&{
        let output = headland().args(["check", &place.path("uphill.ron"), &recording, "--json"]).output();
        String::from_utf8(output.unwrap().stdout).unwrap()
    })
    .unwrap();
    assert_eq!((told[1]["ok"].clone(), told[2]["ok"].clone()), (true.into(), false.into()));
    assert!(told[2]["told"].as_str().unwrap().contains("grade"), "{told}");
}

#[test]
fn a_recording_is_compared_and_its_inputs_are_called_driven() {
    let place = Place::new();
    assert!(place.compare().status.success());
    exists(place.path("out").as_ref(), &["trace.parquet", "comparison.json", "report.html"]);
    let document = place.json("out/comparison.json");
    assert_eq!(document["schema"], "headland.comparison/1");
    assert_eq!(document["driven"], serde_json::json!(["coasting"]));
    assert_eq!(document["channels"][0]["channel"], "speed_m_s");
    assert_eq!(document["driven_by"][0]["drive"], "Coast");
}

#[test]
fn a_requirement_that_is_missed_is_exit_1_and_one_that_is_met_is_0() {
    let place = Place::new();
    let (scenario, recording, out) =
        (place.path("scenario.ron"), place.path("recording.ron"), place.path("out"));
    let with = |requirement| {
        ["compare", &scenario, "--recording", &recording, "--out", &out, "--require", requirement]
            .map(str::to_owned)
    };
    let met = with("speed_m_s rmse < 5 m/s");
    assert!(done(&met.each_ref().map(String::as_str)).contains("met: speed_m_s rmse < 5"));
    let missed = with("speed_m_s rmse < 1 mm/s");
    assert!(refused(1, &missed.each_ref().map(String::as_str)).contains("not met"));
    assert_eq!(place.json("out/comparison.json")["requirements"][0]["met"], false);
}

/// The log rolls out at 0.3 m/s²; with the drag of 1.2 m² on 1000 kg that is a coefficient of 0.0228 at 7 m/s.
#[test]
fn a_calibration_halves_the_error_and_its_scenario_runs_from_elsewhere() {
    let place = Place::new();
    let (scenario, recording) = (place.path("scenario.ron"), place.path("recording.ron"));
    done(&["calibrate", &scenario, "--recording", &recording, "--out", &place.path("out")]);
    exists(place.path("out").as_ref(), &["calibration.json", "scenario.ron", "report.html"]);
    let document = place.json("out/calibration.json");
    let fitted = &document["signals"][0]["fitted"];
    let error = |name: &str| fitted[name].as_f64().unwrap();
    assert!(error("rmse_after") < 0.5 * error("rmse_before"), "{fitted}");
    let value = document["estimates"][0]["value"].as_f64().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let moved = elsewhere.path().join("moved.ron");
    std::fs::copy(place.path("out/scenario.ron"), &moved).unwrap();
    let told = headland()
        .current_dir(elsewhere.path())
        .args(["compare", "moved.ron", "--recording", &recording, "--json"])
        .output()
        .unwrap();
    assert!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    let again: Value = serde_json::from_slice(&told.stdout).unwrap();
    let rmse = again["channels"][0]["rmse"].as_f64().unwrap();
    assert!((rmse / error("rmse_after") - 1.0).abs() < 1e-9, "{rmse}");
    assert!(std::fs::read_to_string(&moved).unwrap().contains(&format!("{value:?}")));
}

#[test]
fn a_scenario_that_needs_a_file_still_finds_it_after_calibration() {
    let place = Place::new();
    place.write("slope.csv", "position_m,elevation_m\n0,0\n500,1\n1000,0\n");
    let text = super::help::SCENARIO
        .replace("terrain: Flat", "terrain: Profile(heading_rad: 0, file: \"slope.csv\")");
    place.write("scenario.ron", &text);
    let recording = place.path("recording.ron");
    done(&[
        "calibrate",
        &place.path("scenario.ron"),
        "--recording",
        &recording,
        "--out",
        &place.path("deep/out"),
    ]);
    done(&["run", &place.path("deep/out/scenario.ron"), "--out", &place.path("again")]);
}

#[test]
fn coast_downs_give_a_coefficient_and_road_loads() {
    let recording = demo().join("recording/recording.ron");
    let out = tempfile::tempdir().unwrap();
    let told = done(&["coastdown", word(&recording), "--speed-unit", "km/h", "--out", word(out.path())]);
    assert!(told.contains("c_w") && told.contains("two-stage"), "{told}");
    exists(out.path(), &["coastdown.json", "report.html"]);
    let document = json(&out.path().join("coastdown.json"));
    assert_eq!(document["runs"].as_array().unwrap().len(), 10);
    assert_eq!(document["schema"], "headland.coastdown/1");
    let coefficient = document["speed_law"]["fit"]["estimates"][0]["value"].as_f64().unwrap();
    assert!((coefficient - 0.069).abs() < 0.001, "{coefficient}");
}

#[test]
fn a_unit_that_nobody_stated_is_assumed_aloud() {
    let place = Place::new();
    let told = done(&["coastdown", &place.path("recording.ron"), "--out", &place.path("out")]);
    assert!(told.contains("the unit of v in c_w (1 + v/100) was not stated"), "{told}");
    let told = done(&[
        "coastdown",
        &place.path("recording.ron"),
        "--out",
        &place.path("out"),
        "--speed-unit",
        "mph",
    ]);
    assert!(!told.contains("not stated"), "{told}");
}

#[test]
fn the_demonstration_leaves_everything_behind_and_finds_its_truth() {
    exists(
        demo(),
        &[
            "report.html",
            "coastdown.json",
            "comparison.json",
            "trace.parquet",
            "recording/recording.ron",
            "recording/run_01.csv",
            "scenarios/coast_down_study.ron",
        ],
    );
    let document = json(&demo().join("coastdown.json"));
    let ends = document["speed_law"]["fit"]["estimates"][0]["interval_95"].clone();
    let end = |index: usize| ends[index].as_f64().unwrap();
    assert!(end(0) < 0.069 && 0.069 < end(1), "{ends}");
    let rmse = json(&demo().join("comparison.json"))["channels"][0]["rmse"].as_f64().unwrap();
    // The noise of the sensor, 0.03 m/s, and the initial speed that is read from noisy samples.
    assert!((0.028..0.045).contains(&rmse), "{rmse}");
}

#[test]
fn the_demonstration_of_a_diagnosis_finds_the_wind_that_was_driven_in() {
    let out = tempfile::tempdir().unwrap();
    let told = done(&["demo", "diagnosis", "--quiet", "--out", word(out.path())]);
    assert!(told.contains("A wind of which these runs show only the part along their lanes"), "{told}");
    exists(out.path(), &["report.html", "effects.parquet", "recording.ron", "recording/run_10.csv"]);
    let log = std::fs::read_to_string(out.path().join("recording/run_01.csv")).unwrap();
    assert!(!log.contains("wind"), "nobody measured it: {}", log.lines().next().unwrap());
    let document = json(&out.path().join("diagnosis.json"));
    assert_eq!(document["verdict"], "missing_physics");
    assert_eq!(document["findings"].as_array().unwrap().len(), 1);
    let number = |name: &str, field: &str| {
        let parameters = document["findings"][0]["parameters"].as_array().unwrap();
        parameters.iter().find(|one| one["name"] == name).unwrap()[field].clone()
    };
    let ends = number("speed_m_s", "ci95");
    assert!(ends[0].as_f64().unwrap() < 8.5 && 8.5 < ends[1].as_f64().unwrap(), "{ends}");
    // Its part along the lane, of 8.5 m/s at 35°.
    let along_m_s =
        number("speed_m_s", "value").as_f64().unwrap() * number("from_rad", "value").as_f64().unwrap().cos();
    assert!((along_m_s - 8.5 * 35f64.to_radians().cos()).abs() < 1.5, "{along_m_s}");
    // What was found runs with the ordinary commands.
    let improved = out.path().join("scenario.ron");
    let again = out.path().join("again");
    done(&[
        "compare",
        word(&improved),
        "--recording",
        word(&out.path().join("recording.ron")),
        "--require",
        "speed_m_s rmse < 0.07 m/s",
        "--out",
        word(&again),
    ]);
}

#[test]
fn threads_change_nothing_and_a_seed_does() {
    let make = |threads: &str, seed: &str| {
        let out = tempfile::tempdir().unwrap();
        done(&["demo", "--out", word(out.path()), "--threads", threads, "--seed", seed, "--quiet"]);
        let read = |name: &str| {
            let text = std::fs::read_to_string(out.path().join(name)).unwrap();
            text.replace(word(out.path()), "")
        };
        ["coastdown.json", "comparison.json", "recording/run_03.csv"].map(read)
    };
    let one = make("1", "7");
    assert_eq!(one, make("2", "7"));
    assert_ne!(one[2], make("2", "8")[2]);
}

#[test]
fn a_calibration_has_the_same_bits_at_any_number_of_threads() {
    let (scenario, recording) =
        (demo().join("scenarios/coast_down_study.ron"), demo().join("recording/recording.ron"));
    let make = |threads: &str| {
        let out = tempfile::tempdir().unwrap();
        done(&[
            "calibrate",
            word(&scenario),
            "--recording",
            word(&recording),
            "--out",
            word(out.path()),
            "--threads",
            threads,
        ]);
        std::fs::read(out.path().join("calibration.json")).unwrap()
    };
    assert_eq!(make("1"), make("2"));
}

/// 3 % over the first 500 m of the path are 500 sin(atan 0.03) = 14.993 m of height.
#[test]
fn terrain_tells_the_ground_in_words() {
    let place = Place::new();
    let on = |terrain: &str| {
        place.write(
            "ground.ron",
            &super::help::SCENARIO.replace("terrain: Flat", &format!("terrain: {terrain}")),
        );
        done(&["terrain", &place.path("ground.ron")]).replace('\u{a0}', " ")
    };
    assert_eq!(
        on("ConstantGrade(grade: 0.03, heading_rad: 0)"),
        "a cart rolls out\n  path     without an end; its first 500 m are told\n  height   0 m to 14.99 m, 14.99 m climbed\n  \
         grade    at most 3.0 % up, 0.0 % down\n"
    );
    assert_eq!(
        on(
            "Profile(heading_rad: 0, points: [(position_m: 0, elevation_m: 2), (position_m: 80, elevation_m: 2)])"
        ),
        "a cart rolls out\n  path     80 m\n  height   2 m to 2 m, 0 m climbed\n  grade    at most 0.0 % up, 0.0 % down\n"
    );
    let lanes = on(
        "AbLines(heading_rad: 0, length_m: 100, spacing_m: 12, lanes: 3, side: Right, turn_radius_m: 6, turn_ramp_m: 4)",
    );
    assert!(lanes.contains("  bends    down to 6 m\n  marks    turn × 2, lane × 2\n"), "{lanes}");
}
