//! Steps per second of one scenario, the simulation alone. `cargo bench --bench step_rate -- SCENARIO.ron`.
//!
//! The model is put together once; every run keeps what its scenario says. The fastest of all runs counts, so that a
//! busy machine disturbs little. `benches/peers/udds_fastsim.py` reads what it prints.
#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]
#![allow(clippy::unwrap_used, reason = "a bench stops where something is missing")]

use headland_scenario::Scenario;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// Runs of which the fastest counts.
const ROUNDS: usize = 300;

fn main() {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let named = std::env::args()
        .skip(1)
        .find(|argument| Path::new(argument).extension().is_some_and(|end| end == "ron"));
    let path = named.map_or_else(|| scenarios.join("over_the_ridge.ron"), Into::into);
    let registry = headland_stock::registry();
    let scenario = Scenario::read(&path, &registry).unwrap();
    let (model, cycle) = (scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap());
    let (mut best_s, mut steps) = (f64::INFINITY, 0);
    for _ in 0..ROUNDS {
        let begin = Instant::now();
        let outcome = black_box(scenario.fidelity.simulate(&model, cycle)).unwrap();
        best_s = best_s.min(begin.elapsed().as_secs_f64());
        steps = outcome.steps;
    }
    println!("{steps} steps, {:.0} steps per second", steps as f64 / best_s);
}
