//! An interruption ends the program with 130 and keeps what was finished.

use super::help::{Place, SCENARIO, headland};
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// More runs than are simulated before anybody interrupts.
fn place() -> Place {
    let place = Place::new();
    let one = |run: usize| format!("        (id: \"long_{run}\", with: {{\"cycle.0.until.for_s\": 500}}),\n");
    let long = (0..600).map(one).collect::<Vec<_>>().concat();
    let runs = format!("    runs: [\n        (id: \"short\", with: {{}}),\n{long}    ],\n    free");
    let text = SCENARIO
        .replace("    free", &runs)
        .replace("step_s: 0.05", "step_s: 0.02")
        .replace("terrain: Flat", "terrain: ConstantGrade(grade: -0.03, heading_rad: 0)");
    place.write("scenario.ron", &text);
    place
}

fn interrupt(child: &Child) {
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
}

/// One run that would take a day of steps of 10 ms is cut, and what it came to is there to be read.
#[test]
fn a_single_run_that_is_interrupted_keeps_what_was_simulated() {
    for wait_ms in [500, 1500, 4000, 10_000] {
        let place = Place::new();
        let text = SCENARIO
            .replace("Coast(until: Elapsed(for_s: 20))", "Coast(until: Elapsed(for_s: 80000))")
            .replace("step_s: 0.05", "step_s: 0.01");
        place.write("scenario.ron", &text);
        let child = headland()
            .args(["run", &place.path("scenario.ron"), "--out", &place.path("out")])
            .stderr(std::process::Stdio::piped())
            .stdout(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(wait_ms));
        interrupt(&child);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "interrupted after {wait_ms} ms");
        if !Path::new(&place.path("out/summary.json")).exists() {
            continue;
        }
        let summary = place.json("out/summary.json");
        let run = &summary["runs"][0];
        let (at_s, lasted_s) =
            (run["end"]["Interrupted"]["time_s"].as_f64().unwrap(), run["duration_s"].as_f64());
        assert!(at_s > 0.0 && lasted_s == Some(at_s), "{run}");
        assert!(run["phases"][0]["ended_by"].as_str().unwrap().contains("interrupted"), "{run}");
        assert!(Path::new(&place.path("out/trace.parquet")).exists());
        let page = std::fs::read_to_string(place.path("out/report.html")).unwrap();
        assert!(page.contains("It was interrupted before its end."));
        let (told, said) = (output.stdout, String::from_utf8_lossy(&output.stderr).into_owned());
        assert!(
            String::from_utf8_lossy(&told).contains("interrupted after") && said.contains("interrupted"),
            "{said}"
        );
        return;
    }
    panic!("nothing was ever simulated");
}

/// Interrupts sooner or later, as fast as the machine happens to be: too soon nothing is finished yet.
#[test]
fn an_interruption_keeps_what_is_finished_and_ends_with_130() {
    for wait_ms in [700, 1500, 3000, 6000, 12_000, 24_000] {
        let place = place();
        let mut child = headland()
            .args(["run", &place.path("scenario.ron"), "--out", &place.path("out"), "--threads", "1"])
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(wait_ms));
        let begin = Instant::now();
        interrupt(&child);
        let status = child.wait().unwrap();
        assert_eq!(
            status.code(),
            Some(130),
            "interrupted after {wait_ms} ms, ended {:?} later",
            begin.elapsed()
        );
        if Path::new(&place.path("out/summary.json")).exists() {
            let runs = place.json("out/summary.json")["runs"].as_array().unwrap().len();
            assert!((1..601).contains(&runs), "{runs} runs are kept");
            return;
        }
    }
    panic!("nothing is ever finished");
}

/// A file that may not grow stands for a full disk. What was whole before it filled stays, and nothing is left half.
#[test]
fn a_full_disk_is_3_and_leaves_no_half_file() {
    for (blocks, kept) in [(1, None), (64, Some("trace.parquet"))] {
        let place = Place::new();
        let script = format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec {} run {} --out {}",
            env!("CARGO_BIN_EXE_headland"),
            place.path("scenario.ron"),
            place.path("out")
        );
        let output = Command::new("bash").args(["-c", &script]).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{told}");
        assert!(told.contains("cannot write") && told.contains("out/"), "{told}");
        let left: Vec<String> = std::fs::read_dir(place.path("out"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        assert!(left.iter().all(|name| !name.contains(".part")), "{left:?}");
        assert!(kept.is_none_or(|kept| left.iter().any(|name| name == kept)), "{left:?}");
    }
}
