//! The page of a diagnosis.

mod effect;
mod evidence;
mod map;
mod proof;

use headland_diagnose::{Diagnosed, Verdict};
use headland_recording::Recording;
use headland_report::build::{self, Parameter};
use headland_report::{Axis, Cell, Item, Report, Section, Table};

/// Makes the page.
pub fn page(about: &str, recording: &Recording, found: &Diagnosed) -> Report {
    let diagnosis = &found.diagnosis;
    let mut report = Report::new(about, diagnosis.answer.clone()).with(proof::proof(found));
    for section in map::map(found) {
        report = report.with(section);
    }
    for finding in &diagnosis.findings {
        report = report.with(effect::section(finding, found));
    }
    report = [evidence::section(found), parameters(found), limits(found)]
        .into_iter()
        .flatten()
        .fold(report, Report::with);
    if let Some(section) = super::notices(&recording.notices, &diagnosis.notes) {
        report = report.with(section);
    }
    report
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::MissingPhysics => "physics is missing",
        Verdict::SensorArtefact => "a sensor is wrong",
        Verdict::Both => "physics is missing and a sensor is wrong",
        Verdict::None => "nothing is missing",
        Verdict::CannotTell => "cannot tell",
        Verdict::Unlisted => "a cause that nobody listed",
    }
}

/// An identifier as words.
fn plain(id: &str) -> String {
    id.replace('_', " ")
}

/// With a capital at its begin.
fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// A unit as it is printed.
fn unit(unit: &str) -> String {
    if unit == "1" { String::new() } else { unit.replace("^2", "²").replace("^3", "³") }
}

fn parameters(found: &Diagnosed) -> Option<Section> {
    let calibrated = &found.diagnosis.calibrated;
    let parameters: Vec<Parameter> = calibrated
        .iter()
        .map(|one| Parameter {
            name: one.name.clone(),
            prior: one.prior,
            value: one.value,
            ci95: (one.ci95[0], one.ci95[1]),
        })
        .collect();
    (!parameters.is_empty()).then(|| {
        Section::new("Free parameters")
            .words(
                "What may be a little wrong is calibrated within its prior, and not explained by an effect.",
            )
            .with(build::parameter_table("Free parameters", &parameters))
    })
}

/// What cannot be told, and what to drive next.
fn limits(found: &Diagnosed) -> Option<Section> {
    let diagnosis = &found.diagnosis;
    if diagnosis.null_space.is_empty() && diagnosis.findings.is_empty() {
        return None;
    }
    let mut section = Section::new("What these recordings cannot tell, and what to drive next");
    if diagnosis.null_space.is_empty() {
        section = section.words("No two causes or parameters stand in for each other here.");
    } else {
        section = section.with(Item::Sentences(diagnosis.null_space.clone()));
    }
    let rows: Vec<Vec<Cell>> = diagnosis
        .findings
        .iter()
        .map(|finding| vec![Cell::from(plain(&finding.id)), Cell::from(finding.next_experiment.clone())])
        .collect();
    if !rows.is_empty() {
        section = section.with(Table {
            title: "Next experiment".to_owned(),
            columns: vec![Axis::new("to make sure of", ""), Axis::new("drive", "")],
            rows,
        });
    }
    Some(section)
}
