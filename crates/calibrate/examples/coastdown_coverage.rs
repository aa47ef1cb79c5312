//! How often the 95 % interval holds the true c_w, and how far off each method is, on synthetic ten-run sets.
//!
//! `cargo run -p headland-calibrate --example coastdown_coverage [SETS]` writes `docs/coastdown_coverage.md`.

use headland_calibrate::coastdown::synthetic::Field;
use headland_calibrate::coastdown::{CoastDownError, CoastRun, Estimate, Settings, SpeedUnit, Study};
use headland_trace::TraceError;
use rayon::prelude::*;
use std::fmt::Write as _;
use std::path::Path;

const SETS: u64 = 200;
const COMMAND: &str = "cargo run -p headland-calibrate --example coastdown_coverage";

const READING: &str = "\
The interval is asked for the mean c_w of all runs that could have been driven. The two-stage aggregation is run as
published, with F = m a, and once more with the rotating mass that the fit is given too: the difference between the
two is bias from rotating parts, the rest is what differentiating costs. Where ground, grade and wind vary from run to
run, no method can average more than the runs there are, so that the methods come closer. `fit / method` is the ratio
of RMS errors.

";

#[derive(Debug, thiserror::Error)]
enum Failure {
    #[error(transparent)]
    Analysis(#[from] CoastDownError),
    #[error(transparent)]
    Trace(#[from] TraceError),
    #[error("{path}: {source}")]
    File { path: String, source: std::io::Error },
    #[error("`{found}` is no number of sets")]
    Sets { found: String },
    #[error("set {seed}: {missing} is missing")]
    Missing { seed: u64, missing: &'static str },
}

/// What every method says on one set.
struct Answer {
    c_w: Estimate,
    /// As published, with rotating mass; each pooled by samples and by runs, outliers left out.
    two_stage: [[f64; 2]; 2],
    /// The same with speed differentiated over a second.
    smoother: [[f64; 2]; 2],
}

fn main() -> Result<(), Failure> {
    let (sets, command) = match std::env::args().nth(1) {
        None => (SETS, COMMAND.to_owned()),
        Some(found) => match found.parse::<u64>() {
            Ok(sets) if sets > 0 => (sets, format!("{COMMAND} {sets}")),
            _ => return Err(Failure::Sets { found }),
        },
    };
    let mut text = String::from("# Coast-down: coverage and error on sets with a known truth\n\n");
    let cases = [
        ("Noise as in the field", Field::disturbed()),
        (
            "The same without variation from run to run (sensor noise, gusts, mean grade and wind remain)",
            Field { run_grade_sd: 0.0, run_c_w_sd: 0.0, run_wind_sd_m_s: 0.0, ..Field::disturbed() },
        ),
        (
            "Sensor noise alone, independent from sample to sample",
            Field { speed_sd_m_s: Field::disturbed().speed_sd_m_s, ..Field::noise_free() },
        ),
    ];
    let _ = writeln!(text, "Written by `{command}`: {sets} sets of ten runs, seeds 0 to {}.\n", sets - 1);
    text.push_str(READING);
    text.push_str(&setting(&cases[0].1));
    for (title, field) in &cases {
        let answers: Vec<Answer> =
            (0..sets).into_par_iter().map(|seed| answer(field, seed)).collect::<Result<_, _>>()?;
        let _ = writeln!(text, "\n## {title}\n");
        text.push_str(&coverage(field.c_w, &answers));
        text.push_str(&errors(field.c_w, &answers));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/coastdown_coverage.md");
    let failed = |source| Failure::File { path: path.display().to_string(), source };
    path.parent().map_or(Ok(()), std::fs::create_dir_all).map_err(failed)?;
    std::fs::write(&path, text).map_err(failed)
}

fn answer(field: &Field, seed: u64) -> Result<Answer, Failure> {
    let runs = field.runs(seed)?;
    let settings =
        Settings { speed_law_unit: Some(field.unit), seed, replicates: 999, ..Settings::default() };
    let law = Study::new(&runs, &settings)?.speed_law(field.unit)?;
    let c_w = law.fit.estimate("c_w").cloned().ok_or(Failure::Missing { seed, missing: "c_w" })?;
    Ok(Answer {
        c_w,
        two_stage: two_stage(&runs, &settings, field.unit, seed)?,
        smoother: two_stage(&runs, &Settings { difference_s: 1.0, ..settings }, field.unit, seed)?,
    })
}

fn two_stage(
    runs: &[CoastRun],
    settings: &Settings,
    unit: SpeedUnit,
    seed: u64,
) -> Result<[[f64; 2]; 2], Failure> {
    let study = Study::new(runs, settings)?;
    let pools = [false, true].map(|with_rotating_mass| {
        let pool = study.two_stage(unit, with_rotating_mass)?.kept;
        Some([pool.by_samples, pool.by_runs])
    });
    let [Some(published), Some(with_rotating_mass)] = pools else {
        return Err(Failure::Missing { seed, missing: "the two-stage aggregation" });
    };
    Ok([published, with_rotating_mass])
}

/// The conditions, from the generator itself.
fn setting(field: &Field) -> String {
    let mut text = String::from("| of each set, first case | value |\n|---|---|\n");
    let mut row = |what: &str, value: String| {
        let _ = writeln!(text, "| {what} | {value} |");
    };
    let percent = |value: f64| format!("{:.2} %", 100.0 * value);
    row("true c_w, v in km/h", format!("{}", field.c_w));
    row("mass", format!("{} kg", field.mass_kg));
    row(
        "rotating mass, known to",
        format!("{} ± {} kg", field.rotating_mass_kg.value, field.rotating_mass_kg.sd),
    );
    row("drag area, known to", format!("{} ± {} m²", field.drag_area_m2.value, field.drag_area_m2.sd));
    let initial: Vec<String> = field.initial_m_s.iter().map(|v| format!("{:.0}", v * 3.6)).collect();
    row("initial speeds, directions alternating", format!("{} km/h", initial.join(", ")));
    row("c_w from run to run, sd", percent(field.run_c_w_sd));
    row("grade of the lane, sd over sets", percent(field.grade_sd));
    row("grade from run to run beyond it, sd", percent(field.run_grade_sd));
    row("wind, recorded as if square to the lane", format!("{} m/s", field.wind_m_s));
    row("angle by which it is not, sd over sets", format!("{:.0}°", field.wind_angle_sd_rad.to_degrees()));
    row("wind from run to run, along and across, sd", format!("{} m/s", field.run_wind_sd_m_s));
    row(
        "gusts, along and across, sd and duration",
        format!("{} m/s, {} s", field.gust_sd_m_s, field.gust_time_s),
    );
    row("speed at 10 Hz: independent noise, sd", format!("{} m/s", field.speed_sd_m_s));
    row("correlated noise, sd and duration", format!("{} m/s, {} s", field.drift_sd_m_s, field.drift_time_s));
    row("bias from run to run, sd", format!("{} m/s", field.bias_sd_m_s));
    row("resolution", format!("{:.2} km/h", field.resolution_m_s * 3.6));
    text
}

/// Which interval of an estimate is looked at.
type Pick = fn(&Estimate) -> Option<[f64; 2]>;

fn coverage(truth: f64, answers: &[Answer]) -> String {
    let mut text = String::from(
        "| 95 % interval of the fit | holds the truth in | median half-width |\n|---|---|---|\n",
    );
    let intervals: [(&str, Pick); 4] = [
        ("reported (`interval_95`)", |estimate| estimate.interval_95),
        ("studentised bootstrap over runs", |estimate| estimate.bootstrap_95),
        ("Student's t, Satterthwaite", |estimate| estimate.student_95),
        ("percentile bootstrap over runs", |estimate| estimate.percentile_95),
    ];
    for (name, interval) in intervals {
        let found: Vec<[f64; 2]> = answers.iter().filter_map(|answer| interval(&answer.c_w)).collect();
        let held = found.iter().filter(|[low, high]| (*low..=*high).contains(&truth)).count();
        let mut widths: Vec<f64> = found.iter().map(|[low, high]| 0.5 * (high - low)).collect();
        widths.sort_by(f64::total_cmp);
        let half = widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN);
        let share = 100.0 * held as f64 / found.len() as f64;
        let _ = writeln!(
            text,
            "| {name} | {held} of {} ({share:.1} %) | {:.2} % |",
            found.len(),
            100.0 * half / truth
        );
    }
    text
}

fn errors(truth: f64, answers: &[Answer]) -> String {
    let fit: Vec<f64> = answers.iter().map(|answer| answer.c_w.value).collect();
    let reference = rms(truth, &fit);
    let mut text = String::from("\n| method | mean error | RMS error | fit / method |\n|---|---|---|---|\n");
    let mut row = |name: &str, values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64 - truth;
        let rms = rms(truth, values);
        let _ = writeln!(
            text,
            "| {name} | {:+.2} % | {:.2} % | {:.2} |",
            100.0 * mean / truth,
            100.0 * rms / truth,
            reference / rms
        );
    };
    row("fit of v(t)", &fit);
    let masses = ["as published", "given the rotating mass"];
    let pools = ["pooled by samples", "pooled by runs"];
    for (mass, mass_name) in masses.iter().enumerate() {
        for (pool, pool_name) in pools.iter().enumerate() {
            let pick = |of: fn(&Answer) -> &[[f64; 2]; 2]| -> Vec<f64> {
                answers.iter().map(|answer| of(answer)[mass][pool]).collect()
            };
            row(
                &format!("two-stage {mass_name}, {pool_name}, 0.2 s differences"),
                &pick(|answer| &answer.two_stage),
            );
            row(
                &format!("two-stage {mass_name}, {pool_name}, 1 s differences"),
                &pick(|answer| &answer.smoother),
            );
        }
    }
    text
}

fn rms(truth: f64, values: &[f64]) -> f64 {
    (values.iter().map(|value| (value - truth).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}
