//! `headland diagnose`: finds the physics that a scenario left out.

use crate::arguments::DiagnoseOptions;
use crate::failure::{Failure, interrupted};
use crate::held;
use crate::output::Output;
use crate::page;
use crate::picture::{Wanted, draw_diagnosis};
use crate::say::Say;
use headland_calibrate::study::StudyError;
use headland_diagnose::{DiagnoseError, Diagnosed, Options, Progress};
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;
use std::fmt::Write;
use std::path::Path;

struct Steps(Say);

impl Progress for Steps {
    fn step(&self, what: &str) {
        self.0.progress(&format!("diagnosis: {what}"));
    }

    fn interrupted(&self) -> bool {
        interrupted()
    }
}

impl From<DiagnoseError> for Failure {
    fn from(error: DiagnoseError) -> Self {
        match error {
            DiagnoseError::Interrupted | DiagnoseError::Study(StudyError::Interrupted) => Self::Unfinished,
            DiagnoseError::Study(error) => error.into(),
            other => Self::Input(other.to_string()),
        }
    }
}

/// Runs the command.
pub fn diagnose(registry: &Registry, options: &DiagnoseOptions, seed: u64, say: Say) -> Result<(), Failure> {
    let drawn = Wanted::of(options.picture);
    drawn.possible()?;
    let scenario = Scenario::read(&options.held.scenario, registry)?;
    let recording = held::read_recording(&options.held.recording, say)?;
    let mut output = Output::new(options.held.out.as_deref(), &options.held.scenario)?;
    let wanted = Options { without: options.without.clone(), only: options.only.clone(), seed };
    let found = find(registry, (&scenario, &recording), &wanted, say)?;
    write(&mut output, registry, &scenario, (&recording, &options.held.recording), &found)?;
    let picture = draw_diagnosis(drawn, &scenario.about, &recording, &found, &mut output)?;
    say.result(&told(&found, &output), &found.diagnosis)?;
    picture.serve(say)
}

/// The diagnosis of a recording, its steps told.
pub fn find(
    registry: &Registry,
    (scenario, recording): (&Scenario, &Recording),
    wanted: &Options,
    say: Say,
) -> Result<Diagnosed, Failure> {
    Ok(headland_diagnose::diagnose(scenario, recording, registry, wanted, &Steps(say))?)
}

/// Writes what was found, as files that other commands take and a page; beside the recording stands the file of its
/// description.
pub fn write(
    output: &mut Output,
    registry: &Registry,
    scenario: &Scenario,
    (recording, described): (&Recording, &Path),
    found: &Diagnosed,
) -> Result<(), Failure> {
    output.json("diagnosis.json", &found.diagnosis)?;
    output.traces("effects.parquet", &found.effects)?;
    scenarios(output, registry, scenario, found)?;
    recording_text(output, described, found)?;
    output.page("report.html", &page::diagnose::page(&scenario.about, recording, found))?;
    Ok(())
}

/// The improved scenario; files that its plugins name are found from where the first one lay.
fn scenarios(
    output: &mut Output,
    registry: &Registry,
    scenario: &Scenario,
    found: &Diagnosed,
) -> Result<(), Failure> {
    for (index, text) in found.scenarios.iter().enumerate() {
        let name = if index == 0 { "scenario.ron".to_owned() } else { format!("scenario_{}.ron", index + 1) };
        let text = crate::fitted::with_folder(scenario, text, registry)?;
        output.text(&name, &text)?;
    }
    if let Some(text) = &found.elsewhere {
        output.text("scenario_elsewhere.ron", &crate::fitted::with_folder(scenario, text, registry)?)?;
    }
    Ok(())
}

/// The improved description of the recording: the same one with what was found of its sensors.
fn recording_text(output: &mut Output, path: &Path, found: &Diagnosed) -> Result<(), Failure> {
    let text = crate::corrected::description(path, &found.corrections)?;
    output.text("recording.ron", &text).map(drop)
}

/// What is said at the end.
pub fn told(found: &Diagnosed, output: &Output) -> String {
    let diagnosis = &found.diagnosis;
    let mut text = format!("{}\n", diagnosis.answer);
    for finding in &diagnosis.findings {
        let equation =
            if finding.equation.is_empty() { String::new() } else { format!("  {}", finding.equation) };
        let _ = writeln!(text, "\n  {}{equation}", finding.id);
        for stretch in finding.stretches.iter().take(4) {
            let _ = writeln!(
                text,
                "    where  {} from {:.1} to {:.1} s, {:.0} to {:.0} m",
                stretch.run, stretch.from_s, stretch.to_s, stretch.from_position_m, stretch.to_position_m
            );
        }
        let more = finding.stretches.len().saturating_sub(4);
        if more > 0 {
            let _ = writeln!(text, "           and {more} more");
        }
        let _ = writeln!(text, "    next   {}", finding.next_experiment);
    }
    for sentence in &diagnosis.null_space {
        let _ = writeln!(text, "  cannot tell  {sentence}");
    }
    for note in &diagnosis.notes {
        let _ = writeln!(text, "  note     {note}");
    }
    let _ = writeln!(text, "  written  {}", output.told());
    text
}
