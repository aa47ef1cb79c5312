//! What fitted runs foretell of a run that is held out: a course of time that all share, and what stands beside a level of each.

use super::roads::{BY_FORCE, drive, of_runs};
use super::setting::found_of_scenario;
use headland_diagnose::{Diagnosed, Options};
use headland_plugin::Registry;
use headland_trace::{Channel, Trace};

/// Seven drives with what is hidden in each, of which every so-manieth sample was logged, two of them held out.
fn diagnosed(hidden: &dyn Fn(u32) -> String, every: usize, registry: &Registry) -> Diagnosed {
    let held_out: [bool; 7] = std::array::from_fn(|number| number % 4 == 2);
    let mut recording = of_runs(&held_out, (900, 40.0), &BY_FORCE, registry, hidden);
    for (number, run) in recording.runs.iter_mut().enumerate() {
        // No two loggers begin with the same sample.
        run.trace = thinned(&run.trace, 3 * number % every, every);
    }
    found_of_scenario(&drive(""), &recording, &Options::default(), registry).unwrap()
}

/// Every so-manieth sample, from one on.
fn thinned(trace: &Trace, from: usize, every: usize) -> Trace {
    let some = |values: &[f64]| values.iter().skip(from).step_by(every).copied().collect::<Vec<f64>>();
    let mut thinned = Trace::new(some(trace.time_s())).unwrap();
    for Channel { name, values, origin } in trace.channels() {
        thinned.push(name.clone(), some(values), *origin).unwrap();
    }
    thinned
}

/// Logged once a second, the force jumps between two samples, and nobody knows when. The tank fills as fast in every run.
#[test]
fn a_tank_that_fills_alike_in_every_run_is_foretold_by_a_slow_logger() {
    const FILLS: &str = "payload_change(times_s: [0, 40, 150, 300], masses_kg: [0, 0, 4000, 4000])";
    let found = diagnosed(&|_| FILLS.to_owned(), 20, &headland_stock::registry());
    let said = &found.diagnosis;
    let [tank] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(tank.id, "payload_change", "{}", said.answer);
    assert!((tank.parameters[0].value / 4000.0 - 1.0).abs() < 0.15, "{}", said.answer);
    let held = said.fit.held_out.as_ref().unwrap();
    assert!(held.rmse_after < 0.2 * held.rmse_before, "{}", said.answer);
    assert_eq!(found.scenarios.len(), 1, "one course is one scenario");
}

/// A trailer in some of the runs says nothing of the others, which each tell their own level; the drag is the same in all of them.
#[test]
fn a_drag_of_all_runs_is_told_beside_a_pull_of_some() {
    let hidden = |number: u32| {
        let trailer = if number % 3 == 1 { ", drawbar_load(force_n: 1500)" } else { "" };
        format!("aerodynamic_drag(extra_area_m2: 12.0){trailer}")
    };
    let found = diagnosed(&hidden, 10, &headland_stock::registry());
    let said = &found.diagnosis;
    let drag = said.findings.iter().find(|one| one.id == "aerodynamic_drag");
    let drag = drag.unwrap_or_else(|| panic!("{}", said.answer));
    assert!((drag.parameters[0].value / 12.0 - 1.0).abs() < 0.3, "{}", said.answer);
    let held = said.fit.held_out.as_ref().unwrap();
    assert!(held.rmse_after < 0.3 * held.rmse_before, "{}", said.answer);
    assert!(said.answer.contains("its own level"), "{}", said.answer);
    assert!(said.notes.iter().any(|note| note.contains("scenario_2.ron is of")), "{:?}", said.notes);
}
