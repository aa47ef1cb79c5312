//! Steps per second of the rigid body: one vehicle, and 64 at once. `cargo bench --bench rigid_body [-- SCENARIO.ron ...]`.
//!
//! Four wheels, each with its tyre, its soil and its slip, driveline, driver and trace included: on the level, on two maps of
//! heights (with a soil that knows resistance only, and with one that knows slip and ruts), on a side slope, and on suspended
//! axles whose hubs hop over rough ground. The fastest of some rounds counts, so that a busy machine disturbs little; but 64
//! vehicles take long, and find no free moment on one that is busy throughout. Whether threads stand in each other's way is told
//! by the time that all processors together take for a step, which is that of one vehicle alone where they do not. All 64 have to
//! come to the same bits as the one.

#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]
#![allow(clippy::unwrap_used, reason = "a bench stops where something is missing")]

use headland_scenario::Scenario;
use headland_sim::Outcome;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Rounds of which the fastest counts.
const ROUNDS: usize = 20;
/// Rounds of all vehicles.
const MANY: usize = 3;
/// Vehicles at once.
const VEHICLES: usize = 64;

fn main() {
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let registry = headland_stock::registry();
    let own = [
        "coast_down_rigid",
        "rough_ground_rigid",
        "rolling_field_rigid",
        "side_slope_rigid",
        "wheel_hop_rigid",
    ];
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
        let begin_s = processors_s();
        let one_s = fastest(ROUNDS, || drop(drive()));
        let alone_s = processors_s().zip(begin_s).map(|(end, begin)| (end - begin) / ROUNDS as f64);
        let mut same = true;
        let begin_s = processors_s();
        let all_s = fastest(MANY, || {
            let outcomes: Vec<Outcome> = (0..VEHICLES).into_par_iter().map(|_| drive()).collect();
            same &= outcomes.iter().all(|outcome| bits(outcome) == bits(&alone));
        });
        let runs = (MANY * VEHICLES) as f64;
        let together_s = processors_s().zip(begin_s).map(|(end, begin)| (end - begin) / runs);
        assert!(same, "{name}: threads change bits");
        let steps = alone.steps as f64;
        println!(
            "{name:<20} {:>9.0} steps per second alone, {:>9.0} of {VEHICLES} vehicles on {} threads",
            steps / one_s,
            VEHICLES as f64 * steps / all_s,
            rayon::current_num_threads(),
        );
        if let (Some(alone_s), Some(together_s)) = (alone_s, together_s) {
            println!(
                "{:<20} processors' time for a step, of that of one alone: {:.2}",
                "",
                together_s / alone_s
            );
        }
    }
}

/// Time that this program has had of all processors [s]; `None` where the system does not say (Linux does, in hundredths).
fn processors_s() -> Option<f64> {
    const PER_SECOND: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the program's name, which may hold spaces, the state is the first field; both times are the 12th and the 13th.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |field: usize| fields.get(field)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / PER_SECOND)
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
