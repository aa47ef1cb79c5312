//! `headland coastdown`: rolling resistance and road loads from coast-downs.

use crate::arguments::CoastdownOptions;
use crate::failure::Failure;
use crate::held::{self, ToldNotice};
use crate::output::Output;
use crate::page::{self, short};
use crate::say::Say;
use crate::study_input::{StudyInput, given, speed_unit};
use headland_calibrate::coastdown::{CoastDown, Curve, Estimate, RunRow, Settings, SpeedUnit, Study};
use headland_calibrate::statistics::median;
use headland_recording::Recording;
use serde::Serialize;
use std::fmt::Write;

/// `coastdown.json`.
#[derive(Debug, Serialize)]
pub struct Document {
    #[serde(flatten)]
    result: CoastDown,
    recording: String,
    settings: Settings,
    assumed: Vec<String>,
    /// Runs that something else than rolling may have slowed, one sentence each.
    doubts: Vec<String>,
    notices: Vec<ToldNotice>,
}

/// An analysis with what its page needs.
pub struct Analysis {
    /// The document.
    pub document: Document,
    /// Speed of each run, measured and fitted.
    pub curves: Vec<Curve>,
    /// Coefficient of each sample, run by run.
    pub samples: Vec<(String, Vec<f64>)>,
}

impl Analysis {
    /// What was found.
    pub fn result(&self) -> &CoastDown {
        &self.document.result
    }

    /// Runs that something else than rolling may have slowed.
    pub fn doubts(&self) -> &[String] {
        &self.document.doubts
    }

    /// What had to be assumed.
    pub fn assumed(&self) -> &[String] {
        &self.document.assumed
    }
}

/// Runs the command.
pub fn coastdown(options: &CoastdownOptions, seed: u64, say: Say) -> Result<(), Failure> {
    let given = options.known.iter().map(|text| given(text)).collect::<Result<Vec<_>, _>>()?;
    let unit = options.speed_unit.as_deref().map(speed_unit).transpose()?;
    let recording = held::read_recording(&options.recording, say)?;
    let input = StudyInput::new(&recording, &given)?;
    let mut settings = Settings { seed, speed_law_unit: unit, ..Settings::default() };
    if let Some(lowest) = options.lowest_speed {
        settings.lowest_speed_m_s = lowest;
    }
    let mut output = Output::new(options.out.as_deref(), &options.recording)?;
    let analysis = analyse(&recording, input, settings, say)?;
    output.json("coastdown.json", &analysis.document)?;
    output.page("report.html", &page::coastdown::page(&recording, &analysis))?;
    let mut text = told(&recording, &analysis);
    let _ = writeln!(text, "  written  {}", output.told());
    say.result(&text, &analysis.document)
}

/// Analyses. Where no unit of v was stated the most probable one is taken, and that is said.
pub fn analyse(
    recording: &Recording,
    input: StudyInput,
    mut settings: Settings,
    say: Say,
) -> Result<Analysis, Failure> {
    let StudyInput { runs, mut assumed } = input;
    let stated = settings.speed_law_unit.is_some();
    let unit = settings.speed_law_unit.unwrap_or(SpeedUnit::KilometresPerHour);
    settings.speed_law_unit = Some(unit);
    say.progress(&format!("fitting {} runs", runs.len()));
    let study = Study::new(&runs, &settings)?;
    let mut result = study.analyse()?;
    if !stated {
        result.null_space.retain(|sentence| !sentence.starts_with("The unit of v"));
    }
    if let (false, Some(law)) = (stated, &result.speed_law) {
        let others: Vec<String> = law
            .units
            .iter()
            .filter(|reading| reading.unit != unit)
            .map(|reading| format!("{} with {}", short(reading.c_w), reading.unit.symbol()))
            .collect();
        assumed.push(format!(
            "the unit of v in c_w (1 + v/100) was not stated; {} is taken, as the law is usually written; c_w would be {} \
             (--speed-unit states it)",
            unit.symbol(),
            others.join(" and ")
        ));
    }
    let document = Document {
        doubts: doubts(&result),
        result,
        recording: recording.path.display().to_string(),
        settings,
        assumed,
        notices: held::told_notices(&recording.notices),
    };
    Ok(Analysis { document, curves: study.curves()?, samples: study.samples(unit) })
}

/// Runs that fit far worse than the middle one.
fn doubts(result: &CoastDown) -> Vec<String> {
    const FAR: f64 = 4.0;
    let rms: Vec<f64> = result.runs.iter().map(|row| row.rms_m_s).collect();
    let middle = median(&rms);
    let doubt = |row: &RunRow| {
        format!(
            "`{}` fits {} times worse than the middle run: something else than a steady roll-out slowed it, such as \
             brakes or another surface; look at its residual, and name the stretch that rolls in `segments`",
            row.run,
            short((row.rms_m_s / middle).round())
        )
    };
    result.runs.iter().filter(|row| row.rms_m_s > FAR * middle).map(doubt).collect()
}

/// `0.0712 (0.0703 to 0.0721)`.
pub fn with_interval(estimate: &Estimate) -> String {
    match estimate.interval_95 {
        Some([low, high]) => {
            let (value, interval) = headland_report::with_interval(estimate.value, low, high);
            format!("{value} ({interval})")
        }
        None => short(estimate.value),
    }
}

/// The result for a person.
pub fn told(recording: &Recording, analysis: &Analysis) -> String {
    let result = analysis.result();
    let mut text =
        format!("{}\n  {} coast-downs, 95 % intervals in parentheses\n", recording.about, result.runs.len());
    if let Some(law) = &result.speed_law {
        for estimate in &law.fit.estimates {
            let unit = if estimate.unit == "1" { "" } else { &estimate.unit };
            let _ = writeln!(text, "  {:<10} {} {unit}", estimate.name, with_interval(estimate));
        }
    }
    for estimate in &result.road_load.fit.estimates {
        let unit = if estimate.unit == "1" { "" } else { &estimate.unit };
        let _ = writeln!(text, "  {:<10} {} {unit}", estimate.name, with_interval(estimate));
    }
    if let Some(two) = &result.two_stage {
        let outliers: Vec<&str> =
            two.runs.iter().filter(|run| run.outlier).map(|run| run.run.as_str()).collect();
        let without = if outliers.is_empty() {
            "no run is an outlier".to_owned()
        } else {
            format!("without {}; with all {}", outliers.join(", "), short(two.all.by_samples))
        };
        let _ = writeln!(
            text,
            "  two-stage  c_w {} pooled by samples, {} by runs: {without}",
            short(two.kept.by_samples),
            short(two.kept.by_runs)
        );
    }
    for one in &result.left_out {
        let _ = writeln!(text, "  left out   {}", one.reason);
    }
    for sentence in analysis.doubts() {
        let _ = writeln!(text, "  doubt    {sentence}");
    }
    for sentence in &result.null_space {
        let _ = writeln!(text, "  cannot tell  {sentence}");
    }
    for sentence in analysis.assumed() {
        let _ = writeln!(text, "  assumed  {sentence}");
    }
    crate::command::compare::notices(&mut text, recording);
    text
}
