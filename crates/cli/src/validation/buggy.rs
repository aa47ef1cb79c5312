//! The off-road buggy: does four-wheel drive show in a coast-down?

use super::table::table;
use crate::command::coastdown::{self, Analysis, with_interval};
use crate::failure::Failure;
use crate::held;
use crate::page::short;
use crate::say::Say;
use crate::study_input::StudyInput;
use headland_calibrate::coastdown::{RunRow, Settings, SpeedUnit};
use headland_calibrate::statistics::{mean, standard_deviation, student_quantile};
use std::fmt::Write;
use std::path::Path;

/// The part of the page.
pub fn part(scenarios: &Path, seed: u64, say: Say) -> Result<String, Failure> {
    let recording = held::read_recording(&scenarios.join("recordings/baja_coastdown.ron"), say)?;
    let settings =
        Settings { seed, speed_law_unit: Some(SpeedUnit::KilometresPerHour), ..Settings::default() };
    let analysis = coastdown::analyse(&recording, StudyInput::new(&recording, &[])?, settings, say)?;
    let result = analysis.result();
    let mut text = format!("## {}\n\n", recording.about);
    let row = |row: &RunRow| {
        vec![
            row.run.clone(),
            short(3.6 * row.initial_m_s),
            short(row.duration_s),
            short(row.apparent_resistance_n),
            short(row.c_w.unwrap_or(f64::NAN)),
            short(row.rms_m_s),
        ]
    };
    let rows: Vec<Vec<String>> = result.runs.iter().map(row).collect();
    text +=
        &table(&["run", "from km/h", "duration s", "resistance N", "c_w", "RMS of the residual m/s"], &rows);
    if let Some(c_w) = result.speed_law.as_ref().and_then(|law| law.fit.estimate("c_w")) {
        let _ =
            writeln!(text, "\nAll runs together: c_w {} (95 % interval in parentheses).", with_interval(c_w));
    }
    let _ = writeln!(text, "\n{}\n", answer(&analysis));
    for sentence in analysis.doubts().iter().chain(&result.null_space).chain(analysis.assumed()) {
        let _ = writeln!(text, "- {sentence}");
    }
    Ok(text)
}

/// Two- against four-wheel drive, by Welch's interval of the difference of their means.
fn answer(analysis: &Analysis) -> String {
    let group = |mark: &str| -> Vec<f64> {
        let runs = analysis.result().runs.iter().filter(|row| row.run.contains(mark));
        runs.filter_map(|row| row.c_w).collect()
    };
    let (two, four) = (group("2WD"), group("4WD"));
    if two.len() < 2 || four.len() < 2 {
        return "There are too few runs of each kind to compare two- with four-wheel drive.".to_owned();
    }
    let [low, high] = welch(&two, &four);
    let difference = mean(&four) - mean(&two);
    let verdict = if low <= 0.0 && 0.0 <= high {
        "**No difference was found**: the interval holds zero, and these runs could not show a smaller one than its width"
    } else {
        "**They differ**: the interval does not hold zero"
    };
    format!(
        "Two-wheel drive ({} runs) has c_w {} on average, four-wheel drive ({} runs) {}: a difference of {} with a 95 % \
         interval from {} to {} (Welch). {verdict}.",
        two.len(),
        short(mean(&two)),
        four.len(),
        short(mean(&four)),
        short(difference),
        short(low),
        short(high)
    )
}

/// 95 % interval of the second mean less the first, with Satterthwaite's degrees of freedom.
fn welch(one: &[f64], other: &[f64]) -> [f64; 2] {
    let part = |values: &[f64]| standard_deviation(values).powi(2) / values.len() as f64;
    let (a, b) = (part(one), part(other));
    let freedom = (a + b).powi(2) / (a * a / (one.len() - 1) as f64 + b * b / (other.len() - 1) as f64);
    let half = student_quantile(0.975, freedom) * (a + b).sqrt();
    let difference = mean(other) - mean(one);
    [difference - half, difference + half]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: means 2 and 7, variances 1 and 2 over 3 and 2 runs; 4/3 of variance, (4/3)² / (1/18 + 1) = 1.684 degrees.
    #[test]
    fn welchs_interval_is_worked_by_hand() {
        let [low, high] = welch(&[1.0, 2.0, 3.0], &[6.0, 8.0]);
        assert!((0.5 * (low + high) - 5.0).abs() < 1e-12);
        let half =
            student_quantile(0.975, (4.0_f64 / 3.0).powi(2) / (1.0 / 18.0 + 1.0)) * (4.0_f64 / 3.0).sqrt();
        assert!((high - 5.0 - half).abs() < 1e-12, "{high}");
    }
}
