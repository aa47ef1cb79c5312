//! `headland compare`: replays a recording through a model and compares the two.

use crate::arguments::CompareOptions;
use crate::failure::{Failure, interrupted};
use crate::held::{self, Pair, ToldNotice};
use crate::output::Output;
use crate::page;
use crate::picture::{self, Drawn, Wanted};
use crate::say::Say;
use headland_calibrate::statistics::standard_deviation;
use headland_compare::{Check, Requirement, Summary};
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_scenario::Scenario;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// `comparison.json`.
#[derive(Debug, Serialize)]
pub struct Comparison {
    #[serde(flatten)]
    summary: Summary,
    scenario: String,
    recording: String,
    /// Run, what drove the model, samples that were left out.
    driven_by: Vec<DrivenBy>,
    requirements: Vec<Required>,
    notes: Vec<String>,
    notices: Vec<ToldNotice>,
}

impl Comparison {
    /// All runs at a glance.
    pub fn summary(&self) -> &Summary {
        &self.summary
    }
}

#[derive(Debug, Serialize)]
struct DrivenBy {
    run: String,
    drive: &'static str,
    judged_by: Vec<String>,
    samples_left_out: usize,
}

#[derive(Debug, Serialize)]
struct Required {
    text: String,
    #[serde(flatten)]
    check: Check,
}

/// Runs the command.
pub fn compare(registry: &Registry, options: &CompareOptions, say: Say) -> Result<(), Failure> {
    let wanted: Vec<Requirement> =
        options.require.iter().map(|text| text.parse()).collect::<Result<_, _>>()?;
    let pictures = Wanted::of(options.picture);
    pictures.possible()?;
    let scenario = Scenario::read(&options.held.scenario, registry)?;
    let recording = held::read_recording(&options.held.recording, say)?;
    let study = held::study(&scenario, &recording, registry)?;
    let mut output = Output::new(options.held.out.as_deref(), &options.held.scenario)?;
    let pairs = held::drive_finished(&study, &study.start(), "replaying", say)?;
    let summary = held::summary(&pairs);
    let checks = wanted.iter().map(|wanted| summary.meets(wanted)).collect::<Result<Vec<_>, _>>()?;
    let notes = notes(&study.notes, &pairs);
    let document = document(
        (&options.held.scenario, &options.held.recording),
        &recording,
        &pairs,
        summary,
        &checks,
        notes,
    );
    let traces = held::traces(&pairs)?;
    output.traces("trace.parquet", &traces)?;
    output.json("comparison.json", &document)?;
    let page = page::compare::page(&page::compare::Content {
        about: &scenario.about,
        recording: &recording,
        pairs: &pairs,
        summary: &document.summary,
        checks: &checks,
        notes: &document.notes,
    })?;
    output.page("report.html", &page)?;
    let drawn = Drawn { scenario: &scenario, registry, runs: &traces, pairs: &pairs };
    let picture = picture::draw(pictures, &drawn, &mut output)?;
    say.result(&told(&scenario, &recording, &document, &checks, &output), &document)?;
    picture.serve(say)?;
    if interrupted() {
        return Err(Failure::Interrupted);
    }
    missed(&checks)
}

/// What was decided on the way.
pub fn notes(of_study: &[String], pairs: &[Pair]) -> Vec<String> {
    let mut notes = of_study.to_vec();
    let all: usize = pairs.iter().map(|pair| pair.measured.len()).sum();
    let mut left_out = |of: fn(&Pair) -> usize, why: &str| {
        let count: usize = pairs.iter().map(of).sum();
        if count > 0 {
            let share = 100.0 * count as f64 / all as f64;
            notes.push(format!(
                "{count} of {all} samples ({share:.1} %) are left out of the errors, not of the totals: {why}"
            ));
        }
    };
    left_out(
        |pair| pair.left_out,
        "the vehicle slows down harder there than `least_acceleration_m_s2`, and brakes were not recorded",
    );
    left_out(
        |pair| pair.followed,
        "what drives the vehicle there, or how hard its brakes hold, was not recorded: the model follows its motion",
    );
    left_out(
        |pair| pair.unknown,
        "what the model is driven by lacks values there for longer than can be bridged",
    );
    notes.extend(elsewhere(pairs));
    notes
}

/// What there is to say of a model that went another way than the recording, over ground that rises and falls: it met slopes that
/// were not there.
fn elsewhere(pairs: &[Pair]) -> Option<String> {
    /// So far from each other, places have other slopes [m].
    const FAR_M: f64 = 10.0;
    /// Slopes that spread by less do not matter, as a share of weight in the root mean square.
    const HILLY: f64 = 0.005;
    let hilly = |pair: &&Pair| pair.outcome.trace.get("grade").map_or(0.0, standard_deviation) > HILLY;
    let forward = pairs.iter().filter(|pair| pair.drive != "Speed").filter(hilly);
    let far = forward.filter_map(|pair| {
        let far_m = pair.comparison.channel("position_m")?.metrics.max_error;
        (far_m > FAR_M).then_some((far_m, pair.comparison.run.as_str()))
    });
    let (far_m, run) = far.max_by(|one, other| one.0.total_cmp(&other.0))?;
    Some(format!(
        "where slopes change, what is a little ahead meets the next one early: in {run} the model came {far_m:.0} m from where the \
         vehicle was. `replay: (drive: Speed)` compares forces where they acted, a shorter `window_s` begins anew more often"
    ))
}

/// Puts the document together; `files` are scenario and recording.
pub fn document(
    files: (&Path, &Path),
    recording: &Recording,
    pairs: &[Pair],
    summary: Summary,
    checks: &[Check],
    notes: Vec<String>,
) -> Comparison {
    let driven_by = |pair: &Pair| DrivenBy {
        run: pair.comparison.run.clone(),
        drive: pair.drive,
        judged_by: pair.signals.clone(),
        samples_left_out: pair.left_out + pair.followed + pair.unknown,
    };
    let required = |check: &Check| Required { text: check.requirement.to_string(), check: check.clone() };
    Comparison {
        summary,
        scenario: files.0.display().to_string(),
        recording: files.1.display().to_string(),
        driven_by: pairs.iter().map(driven_by).collect(),
        requirements: checks.iter().map(required).collect(),
        notes,
        notices: held::told_notices(&recording.notices),
    }
}

fn told(
    scenario: &Scenario,
    recording: &Recording,
    document: &Comparison,
    checks: &[Check],
    output: &Output,
) -> String {
    let mut text = format!("{}\n  against {}\n", scenario.about, recording.about);
    channels(&mut text, &document.summary);
    for check in checks {
        let _ = writeln!(text, "  {check}");
    }
    for note in &document.notes {
        let _ = writeln!(text, "  note     {note}");
    }
    notices(&mut text, recording);
    let _ = writeln!(text, "  written  {}", output.told());
    text
}

/// One line a channel and a total.
pub fn channels(text: &mut String, summary: &Summary) {
    for channel in &summary.channels {
        let _ = writeln!(
            text,
            "  {:<18} RMSE {} {unit}, bias {} {unit}; worst {} {unit} in {}",
            channel.channel,
            page::short(channel.rmse),
            page::short(channel.bias),
            page::short(channel.worst_rmse),
            channel.worst_run,
            unit = channel.unit,
        );
    }
    for total in &summary.totals {
        let verdict = match total.within_criterion {
            Some(true) => ", within 5 %",
            Some(false) => ", not within 5 %",
            None => "",
        };
        let error = total.relative_error.map_or_else(
            || "small against what passed".to_owned(),
            |error| format!("{:+.1} %", 100.0 * error),
        );
        let _ = writeln!(
            text,
            "  {:<18} total {} against {} {} measured: {error}{verdict}",
            total.of,
            page::short(total.modelled),
            page::short(total.measured),
            total.unit
        );
    }
    if !summary.driven.is_empty() {
        let _ = writeln!(
            text,
            "  driven   {} (inputs of the model: they validate nothing)",
            summary.driven.join(", ")
        );
    }
}

/// Notices, the first ones of many.
pub fn notices(text: &mut String, recording: &Recording) {
    const SHOWN: usize = 8;
    for notice in recording.notices.iter().take(SHOWN) {
        let _ = writeln!(text, "  notice   {notice}");
    }
    if recording.notices.len() > SHOWN {
        let _ = writeln!(text, "  notice   and {} more, in the report", recording.notices.len() - SHOWN);
    }
}

fn missed(checks: &[Check]) -> Result<(), Failure> {
    let missed: Vec<String> = checks.iter().filter(|check| !check.met).map(ToString::to_string).collect();
    if missed.is_empty() { Ok(()) } else { Err(Failure::Requirement(missed.join("\n"))) }
}
