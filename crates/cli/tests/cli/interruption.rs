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
