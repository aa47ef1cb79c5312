//! `headland calibrate`: fits the free parameters of a scenario to a recording.

use crate::arguments::CalibrateOptions;
use crate::command::compare::notes;
use crate::failure::Failure;
use crate::fitted::{self, Calibration};
use crate::held;
use crate::output::Output;
use crate::page;
use crate::say::Say;
use headland_calibrate::fit::Fit;
use headland_calibrate::study::Study;
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;
use std::fmt::Write;

/// Every so many runs one is held out where the recording marks none.
const HELD_OUT_OF: usize = 4;

/// Runs the command.
pub fn calibrate(registry: &Registry, options: &CalibrateOptions, say: Say) -> Result<(), Failure> {
    let scenario = Scenario::read(&options.held.scenario, registry)?;
    let recording = held::read_recording(&options.held.recording, say)?;
    let mut study = held::study(&scenario, &recording, registry)?;
    let mut output = Output::new(options.held.out.as_deref(), &options.held.scenario)?;
    hold_out(&mut study);
    let fit = fit(&study, say)?;
    let before = held::drive(&study, &study.start(), "replaying before", say)?;
    let after = held::drive(&study, &fit.values(), "replaying after", say)?;
    let mut document = Calibration::new(&options.held, &study, &fit, &before, &after);
    document.notes = notes(&study.notes, &after);
    document.notices = held::told_notices(&recording.notices);
    let fitted = fitted::scenario(&study, &recording, &fit, registry)?;
    output.json("calibration.json", &document)?;
    output.text("scenario.ron", &fitted)?;
    let page = page::calibrate::page(&scenario.about, &recording, &document, &fit, (&before, &after))?;
    output.page("report.html", &page)?;
    say.result(&told(&scenario, &recording, &document, &output), &document)
}

/// Fits, telling so.
pub fn fit(study: &Study, say: Say) -> Result<Fit, Failure> {
    let runs = study.runs.iter().filter(|run| !run.held_out).count();
    say.progress(&format!("fitting {} parameters to {runs} runs", study.parameters.len()));
    Ok(study.calibrate()?)
}

/// Where the recording holds nothing out, the tool does, and says so.
pub fn hold_out(study: &mut Study) {
    if study.runs.len() < HELD_OUT_OF || study.runs.iter().any(|run| run.held_out) {
        return;
    }
    for run in study.runs.iter_mut().skip(HELD_OUT_OF - 1).step_by(HELD_OUT_OF) {
        run.held_out = true;
    }
    let names: Vec<&str> = study.runs.iter().filter(|run| run.held_out).map(|run| run.id.as_str()).collect();
    study.notes.push(format!(
        "the recording marks no run as `held_out`, so every fourth was never fitted: {}",
        names.join(", ")
    ));
}

fn told(scenario: &Scenario, recording: &Recording, document: &Calibration, output: &Output) -> String {
    let mut text = format!("{}\n  fitted to {}\n", scenario.about, recording.about);
    for estimate in &document.estimates {
        let bound = if estimate.at_bound { ", at its bound" } else { "" };
        let _ = writeln!(
            text,
            "  {:<28} {} → {} {}   95 %: {} to {}{bound}",
            estimate.name,
            page::short(estimate.prior),
            page::short(estimate.value),
            estimate.unit,
            page::short(estimate.ci95[0]),
            page::short(estimate.ci95[1]),
        );
    }
    for signal in &document.signals {
        for (what, part) in [("fitted", &signal.fitted), ("held out", &signal.held_out)] {
            if !part.runs.is_empty() {
                let _ = writeln!(
                    text,
                    "  {:<18} RMSE {} → {} {}   {} {what} runs",
                    signal.channel,
                    page::short(part.rmse_before),
                    page::short(part.rmse_after),
                    signal.unit,
                    part.runs.len()
                );
            }
        }
    }
    for sentence in &document.null_space {
        let _ = writeln!(text, "  cannot tell  {sentence}");
    }
    for note in &document.notes {
        let _ = writeln!(text, "  note     {note}");
    }
    let _ = writeln!(text, "  written  {}", output.told());
    text
}
