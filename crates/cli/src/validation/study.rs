//! The coast-down study: ten simulated runs, one of them as far off as the study's own outlier.

use super::table::table;
use crate::command::coastdown::{self, Analysis, with_interval};
use crate::command::run::simulate_all;
use crate::failure::Failure;
use crate::held;
use crate::output::Output;
use crate::page::short;
use crate::say::Say;
use crate::staged;
use crate::study_input::StudyInput;
use headland_calibrate::coastdown::{Estimate, Settings, SpeedUnit, TwoStage};
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;
use std::fmt::Write;
use std::path::Path;

/// What the study published: *Applied Sciences* 16 (2026) 1814.
const PUBLISHED: [(&str, f64); 3] = [
    ("c_w without its outlier", 0.069),
    ("c_w of all runs", 0.0682),
    ("median of its outlier, run 6", 0.042),
];
/// Its outlier.
const OUTLIER: usize = 5;
const COEFFICIENT: &str = "ground.soil.coefficient";

/// The part of the page.
pub fn part(registry: &Registry, scenarios: &Path, seed: u64, say: Say) -> Result<String, Failure> {
    let mut scenario = Scenario::read(&scenarios.join("coast_down_study.ron"), registry)?;
    if let Some(run) = scenario.runs.get_mut(OUTLIER) {
        run.with.push((COEFFICIENT.to_owned(), format!("{:?}", PUBLISHED[2].1)));
    }
    let simulated = simulate_all(&scenario, registry)?;
    let folder = std::env::temp_dir().join(format!("headland-validation-{}", std::process::id()));
    let mut output = Output::new(Some(&folder), &folder)?;
    let described = staged::write(&scenario, &simulated.runs, seed, &mut output)?;
    let recording = held::read_recording(&described, say);
    // The logs are read; that their folder may stay behind must not hide what the reading said.
    let _ = std::fs::remove_dir_all(&folder);
    let recording = recording?;
    let analysis = analyse(&recording, seed, say)?;
    let result = analysis.result();
    let mut text = format!(
        "## The coast-down study\n\n{}. Simulated with c_w {} in all runs but the sixth, which was given {}, the median of \
         the study's own outlier; speed sampled at 10 Hz with {} m/s of noise.\n\n",
        scenario.about,
        short(scenario.document().number(COEFFICIENT).unwrap_or(f64::NAN)),
        short(PUBLISHED[2].1),
        short(staged::NOISE_M_S)
    );
    if let Some(two) = &result.two_stage {
        text += &pools(two);
        let outliers: Vec<&str> =
            two.runs.iter().filter(|run| run.outlier).map(|run| run.run.as_str()).collect();
        let mut kept = recording.clone();
        kept.runs.retain(|run| !outliers.contains(&run.id.as_str()));
        let kept = analyse(&kept, seed, say)?;
        let student =
            |c_w: &Estimate| with_interval(&Estimate { interval_95: c_w.student_95, ..c_w.clone() });
        let _ = writeln!(
            text,
            "\nThe fit of speed over time gives c_w {} without the outlier and {} with it; 95 % intervals in parentheses, \
             that of all runs by Student's t: one run so far from the others leaves no narrow one.\n",
            c_w(&kept).map_or_else(String::new, with_interval),
            c_w(&analysis).map_or_else(String::new, student),
        );
    }
    Ok(text)
}

fn analyse(recording: &Recording, seed: u64, say: Say) -> Result<Analysis, Failure> {
    let settings =
        Settings { seed, speed_law_unit: Some(SpeedUnit::KilometresPerHour), ..Settings::default() };
    coastdown::analyse(recording, StudyInput::new(recording, &[])?, settings, say)
}

fn c_w(analysis: &Analysis) -> Option<&Estimate> {
    analysis.result().speed_law.as_ref()?.fit.estimate("c_w")
}

fn pools(two: &TwoStage) -> String {
    let row = |name: &str, pool: &headland_calibrate::coastdown::Pool, published: f64| {
        vec![
            name.to_owned(),
            short(published),
            short(pool.by_samples),
            short(pool.by_runs),
            short(pool.by_medians),
        ]
    };
    let rows =
        [row(PUBLISHED[0].0, &two.kept, PUBLISHED[0].1), row(PUBLISHED[1].0, &two.all, PUBLISHED[1].1)];
    let outliers: Vec<&str> = two.runs.iter().filter(|run| run.outlier).map(|run| run.run.as_str()).collect();
    let mut text = format!(
        "The two-stage method marks as outliers: {}. Which pool the study used is not stated; all three stand here.\n\n",
        if outliers.is_empty() { "none".to_owned() } else { outliers.join(", ") }
    );
    text += &table(&["", "published", "pooled by samples", "by run means", "by run medians"], &rows);
    text
}
