//! Ten coast-downs: simulated, logged with noise, analysed from the logs, compared.

use crate::arguments::DemoOptions;
use crate::command::coastdown::{self, Analysis};
use crate::command::compare::{self, Comparison};
use crate::command::run::simulate_all;
use crate::embedded;
use crate::failure::Failure;
use crate::held::{self, Pair};
use crate::output::Output;
use crate::page::{self, short};
use crate::say::Say;
use crate::staged;
use crate::study_input::StudyInput;
use headland_calibrate::coastdown::{Settings, SpeedUnit};
use headland_plugin::Registry;
use headland_recording::Recording;
use headland_report::{Item, Report, Section};
use headland_scenario::Scenario;
use serde::Serialize;
use std::fmt::Write;

/// Where the truth lies in the scenario.
const TRUTH: &str = "ground.soil.coefficient";

#[derive(Debug, Serialize)]
struct Told<'a> {
    true_c_w: f64,
    coastdown: &'a coastdown::Document,
    comparison: &'a Comparison,
}

/// Simulates the study, logs it and analyses the logs.
pub fn coast_down(registry: &Registry, options: &DemoOptions, seed: u64, say: Say) -> Result<(), Failure> {
    let mut output = Output::new(Some(&options.out), &options.out)?;
    let path = embedded::write(&embedded::COAST_DOWN_STUDY, &mut output)?;
    let scenario = Scenario::read(&path, registry)?;
    say.progress(&format!("simulating {} runs", scenario.runs.len()));
    let simulated = simulate_all(&scenario, registry)?;
    output.traces("trace.parquet", &simulated.traces())?;
    output.json("summary.json", &simulated.summary)?;
    let described = staged::write(&scenario, &simulated.runs, seed, &mut output)?;
    let recording = held::read_recording(&described, say)?;
    let analysis = analyse(&recording, seed, say)?;
    output.json("coastdown.json", &analysis.document)?;
    let study = held::study(&scenario, &recording, registry)?;
    let pairs = held::drive(&study, &study.start(), "comparing", say)?;
    let notes = compare::notes(&study.notes, &pairs);
    let comparison =
        compare::document((&path, &described), &recording, &pairs, held::summary(&pairs), &[], notes);
    output.json("comparison.json", &comparison)?;
    let truth = scenario.document().number(TRUTH).unwrap_or(f64::NAN);
    output.page("report.html", &page(&scenario, &recording, &analysis, &pairs, &comparison, truth)?)?;
    let told = Told { true_c_w: truth, coastdown: &analysis.document, comparison: &comparison };
    say.result(&text(&scenario, &analysis, &comparison, truth, &output), &told)
}

fn analyse(recording: &Recording, seed: u64, say: Say) -> Result<Analysis, Failure> {
    let settings =
        Settings { seed, speed_law_unit: Some(SpeedUnit::KilometresPerHour), ..Settings::default() };
    coastdown::analyse(recording, StudyInput::new(recording, &[])?, settings, say)
}

/// Whether the truth was found, in words.
fn verdict(analysis: &Analysis, truth: f64) -> String {
    let estimate = analysis.result().speed_law.as_ref().and_then(|law| law.fit.estimate("c_w"));
    match estimate.and_then(|c_w| c_w.interval_95.map(|ends| (c_w, ends))) {
        Some((c_w, [low, high])) => format!(
            "c_w is found as {}; {}, which the simulation was given, lies {} the interval",
            coastdown::with_interval(c_w),
            short(truth),
            if (low..=high).contains(&truth) { "inside" } else { "outside" }
        ),
        None => "no interval of c_w was found".to_owned(),
    }
}

fn page(
    scenario: &Scenario,
    recording: &Recording,
    analysis: &Analysis,
    pairs: &[Pair],
    comparison: &Comparison,
    truth: f64,
) -> Result<Report, Failure> {
    let of_comparison = page::compare::page(&page::compare::Content {
        about: &scenario.about,
        recording,
        pairs,
        summary: comparison.summary(),
        checks: &[],
        notes: &[],
    })?;
    let mut report =
        Report::new("Demonstration: a coast-down study", format!("{}.", verdict(analysis, truth)));
    report = report.with(Section::new("What was done").with(Item::Words(format!(
        "{} was simulated. The speed was sampled ten times a second and given the noise of a GPS receiver, {} m/s (one \
         standard deviation). The logs lie in the folder “recording”, the scenario in “scenarios”; what follows was made \
         from the logs alone.",
        scenario.about,
        short(staged::NOISE_M_S)
    ))));
    for section in page::coastdown::page(recording, analysis).sections {
        report = report.with(section);
    }
    for mut section in of_comparison.sections.into_iter().filter(|section| section.title != page::ABOUT_DATA)
    {
        section.title = format!("Simulation against log: {}", section.title.to_lowercase());
        report = report.with(section);
    }
    Ok(report)
}

fn text(
    scenario: &Scenario,
    analysis: &Analysis,
    comparison: &Comparison,
    truth: f64,
    output: &Output,
) -> String {
    let mut text = format!("{}\n", scenario.about);
    let _ = writeln!(
        text,
        "  simulated, sampled at 10 Hz with {} m/s of noise, and analysed from the logs",
        short(staged::NOISE_M_S)
    );
    let _ = writeln!(text, "  {}", verdict(analysis, truth));
    if let Some(two) = &analysis.result().two_stage {
        let _ = writeln!(text, "  the two-stage method of the study gives {}", short(two.kept.by_samples));
    }
    compare::channels(&mut text, comparison.summary());
    let _ = writeln!(text, "  written  {}", output.told());
    let _ = writeln!(text, "open {}", output.path().join("report.html").display());
    text
}
