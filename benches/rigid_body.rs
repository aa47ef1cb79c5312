//! Steps per second of the rigid body: one vehicle, and 64 at once. `cargo bench --bench rigid_body [-- SCENARIO.ron ...]`.
//!
//! Four wheels on a map of heights, each with its tyre, its soil and its slip, driveline, driver and trace included. The
//! fastest of some rounds counts, so that a busy machine disturbs little. All 64 have to come to the same bits as the one.

#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]
#![allow(clippy::unwrap_used, reason = "a bench stops where something is missing")]

use headland_scenario::Scenario;
use headland_sim::Outcome;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Rounds of which the fastest counts.
const ROUNDS: usize = 20;
/// Vehicles at once.
const VEHICLES: usize = 64;

fn main() {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let registry = headland_stock::registry();
    let own = ["coast_down_rigid", "rough_ground_rigid", "side_slope_rigid"];
    let mut paths: Vec<PathBuf> =
        std::env::args_os().skip(1).filter(|word| word != "--bench").map(PathBuf::from).collect();
    if paths.is_empty() {
        paths = own.iter().map(|name| scenarios.join(format!("{name}.ron"))).collect();
    }
    for path in paths {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let scenario = Scenario::read(&path, &registry).unwrap();
        let model = scenario.model(&registry).unwrap();
        let cycle = scenario.cycle.as_ref().unwrap();
        let drive = || scenario.fidelity.simulate(&model, cycle).unwrap();
        let alone = drive();
        let one_s = fastest(ROUNDS, || drop(drive()));
        let mut same = true;
        let all_s = fastest(ROUNDS / 10, || {
            let outcomes: Vec<Outcome> = (0..VEHICLES).into_par_iter().map(|_| drive()).collect();
            same &= outcomes.iter().all(|outcome| bits(outcome) == bits(&alone));
        });
        assert!(same, "{name}: threads change bits");
        let steps = alone.steps as f64;
        println!(
            "{name:<20} {:>9.0} steps per second alone, {:>9.0} of {VEHICLES} vehicles on {} threads",
            steps / one_s,
            VEHICLES as f64 * steps / all_s,
            rayon::current_num_threads(),
        );
    }
}

fn fastest(rounds: usize, mut run: impl FnMut()) -> f64 {
    let timed = |_| {
        let begin = Instant::now();
        run();
        begin.elapsed().as_secs_f64()
    };
    (0..rounds).map(timed).fold(f64::INFINITY, f64::min)
}

fn bits(outcome: &Outcome) -> Vec<u64> {
    let columns = ["position_m", "speed_m_s", "height_m"];
    columns
        .iter()
        .flat_map(|name| outcome.trace.get(name).unwrap().iter().map(|value| value.to_bits()))
        .collect()
}
