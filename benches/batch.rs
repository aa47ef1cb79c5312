//! Ten thousand short runs: one core against two, and what memory they take. `cargo bench --bench batch`,
//! which writes a page with `-- --markdown PAGE.md`.
//!
//! Each run is put together from text, simulated, counted and written to the journal, as `headland batch` does it.
#![expect(clippy::print_stdout, reason = "a benchmark says what it measured")]
#![allow(clippy::unwrap_used, reason = "a benchmark stops where something is missing")]

use headland_batch::{Comparison, Journal, Plan, Settings, execute, table};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

/// A tractor that pulls a trailer up to speed: 20 s in steps of 50 ms.
const COMPARISON: &str = r#"(
    about: "short runs",
    variants: [(name: "tractor", vehicle: include("vehicles/xerion_3800.ron"))],
    cycles: [(
        name: "pull away",
        tasks: [Drawbar(force_n: "8 kN")],
        cycle: [Reach(speed_m_s: "20 km/h", acceleration_m_s2: 0.5), Hold(for_s: 9)],
    )],
    grounds: [(name: "sand", ground: include("grounds/moist_sand.ron"))],
    air: (density_kg_m3: 1.2),
    sample: (count: COUNT, seed: 1, of: {"vehicle.mass_kg": ("12 t", "15 t"), "ground.soil.coefficient": (0.04, 0.09)}),
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#;

/// What runs took.
struct Took {
    seconds: f64,
    /// Of all cores together. Where it is the same on one thread and on two, only a busy machine keeps them from twice the rate.
    busy_seconds: f64,
}

/// What the runs take on so many threads, the table of results left out.
fn took(runs: u32, threads: usize) -> Took {
    let registry = headland_stock::registry();
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let text = COMPARISON.replace("COUNT", &runs.to_string());
    let comparison = Comparison::of_text("bench", &text, &scenarios).unwrap();
    let plan = Plan::new(comparison, &registry, 1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let identity = plan.comparison.identity(1);
    let mut journal = Journal::open(folder.path(), &identity, plan.total(), false).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let settings = Settings { traces: false, stop: &|| false, progress: &|_| {} };
    let (begin, busy) = (Instant::now(), busy_seconds());
    pool.install(|| execute(&plan, &registry, &mut journal, &settings).unwrap());
    let took = Took { seconds: begin.elapsed().as_secs_f64(), busy_seconds: busy_seconds() - busy };
    assert_eq!(journal.finished(), u64::from(runs));
    table::write(&plan, &mut journal, &folder.path().join("results.parquet")).unwrap();
    took
}

/// Seconds that all threads of this program have worked so far; NaN where the system does not tell.
fn busy_seconds() -> f64 {
    const TICKS_PER_S: f64 = 100.0;
    let told = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = told.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks =
        |index: usize| fields.get(index).and_then(|field| field.parse::<f64>().ok()).unwrap_or(f64::NAN);
    // Fields 14 and 15, counted behind the name of the program, which is the second.
    (ticks(11) + ticks(12)) / TICKS_PER_S
}

/// Greatest resident memory so far [MB]; NaN where the system does not tell.
fn memory_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse().ok())
        .map_or(f64::NAN, |kb: f64| kb / 1024.0)
}

/// A page with the figures, where `--markdown PAGE.md` asks for one.
fn written(memory: &[(u32, f64)], turns: &[(Took, Took)], ratio: f64) -> std::io::Result<()> {
    let mut asked = std::env::args().skip_while(|argument| argument != "--markdown").skip(1);
    let Some(page) = asked.next() else { return Ok(()) };
    let mut text = String::from(
        "# A batch on one core and on two\n\nMade by `cargo bench --bench batch -- --markdown docs/evidence/batch.md`: runs of a tractor \
         that pulls a trailer up to\nspeed, 20 s each in steps of 50 ms, put together from text, simulated, counted and written to the \
         journal.\n\n| 10,000 runs | one core | two cores | ratio | processors' time, one | two |\n|---|---:|---:|---:|---:|---:|\n",
    );
    for (turn, (one, two)) in turns.iter().enumerate() {
        let _ = writeln!(
            text,
            "| turn {} | {:.2} s | {:.2} s | {:.3} | {:.2} s | {:.2} s |",
            turn + 1,
            one.seconds,
            two.seconds,
            one.seconds / two.seconds,
            one.busy_seconds,
            two.busy_seconds
        );
    }
    let _ = writeln!(
        text,
        "\nMedian of the ratios: {ratio:.3}, of at least 1.9 that are asked for.\n\n| runs | greatest memory |\n|---:|---:|"
    );
    for (runs, greatest_mb) in memory {
        let _ = writeln!(text, "| {runs} | {greatest_mb:.1} MB |");
    }
    std::fs::write(page, text)
}

fn main() {
    // Memory first: its greatest value never falls.
    let memory = [1_000, 10_000, 40_000].map(|runs| {
        took(runs, 2);
        println!("batch/memory_{runs}_runs          {:>8.1} MB", memory_mb());
        (runs, memory_mb())
    });
    let (mut ratios, mut turns) = (Vec::new(), Vec::new());
    for _ in 0..5 {
        let (one, two) = (took(10_000, 1), took(10_000, 2));
        let ratio = one.seconds / two.seconds;
        println!(
            "batch/10000_runs  one core {:>6.2} s  two cores {:>6.2} s  ratio {ratio:.3}  work {:>6.2} s and {:>6.2} s",
            one.seconds, two.seconds, one.busy_seconds, two.busy_seconds
        );
        ratios.push(ratio);
        turns.push((one, two));
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    println!("batch/ratio_two_to_one          {median:>8.3} (median of {})", ratios.len());
    written(&memory, &turns, median).unwrap();
}
