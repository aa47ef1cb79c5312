//! The page of a diagnosis.

use headland_diagnose::{Diagnosed, FindingReport, Verdict};
use headland_recording::Recording;
use headland_report::build::{self, Parameter};
use headland_report::{Axis, Cell, Figure, Item, Lines, Plot, Report, Section, Series, Table};

/// Runs that get plots of their own.
const IN_DETAIL: usize = 6;

/// Makes the page.
pub fn page(about: &str, recording: &Recording, found: &Diagnosed) -> Report {
    let diagnosis = &found.diagnosis;
    let mut report = Report::new(about, diagnosis.answer.clone()).with(proof(found));
    for finding in &diagnosis.findings {
        report = report.with(section(finding, found));
    }
    report = report.with(left(found));
    let parameters: Vec<Parameter> = diagnosis
        .calibrated
        .iter()
        .map(|one| Parameter {
            name: one.name.clone(),
            prior: one.prior,
            value: one.value,
            ci95: (one.ci95[0], one.ci95[1]),
        })
        .collect();
    if !parameters.is_empty() {
        let section =
            Section::new("Free parameters").with(build::parameter_table("Free parameters", &parameters));
        report = report.with(section);
    }
    if !diagnosis.null_space.is_empty() {
        let section = Section::new("What these recordings cannot tell");
        report = report.with(section.with(Item::Sentences(diagnosis.null_space.clone())));
    }
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

fn proof(found: &Diagnosed) -> Section {
    let fit = &found.diagnosis.fit;
    let unit = headland_units::unit_of_name(&fit.signal).map_or_else(String::new, |unit| unit.symbol);
    let mut figures = vec![Figure::text("Verdict", verdict(found.diagnosis.verdict))];
    figures.push(Figure::new("Error before, fitted runs", fit.fitted.rmse_before, &unit));
    figures.push(Figure::new("Error after, fitted runs", fit.fitted.rmse_after, &unit));
    if let Some(held) = &fit.held_out {
        figures.push(Figure::new("Error before, runs it never saw", held.rmse_before, &unit));
        figures.push(Figure::new("Error after, runs it never saw", held.rmse_after, &unit));
    }
    if fit.fitted.noise.is_finite() {
        figures.push(Figure::new("Noise of the sensor", fit.fitted.noise, &unit));
    }
    Section::new("Proof")
        .words(format!("Root mean square error of {}.", fit.signal))
        .with(Item::Figures(figures))
}

fn section(finding: &FindingReport, found: &Diagnosed) -> Section {
    let mut section = Section::new(finding.id.replace('_', " ")).words(format!(
        "{} Equation: {}. Next: {}.",
        finding.sentence, finding.equation, finding.next_experiment
    ));
    let parameters: Vec<Parameter> = finding
        .parameters
        .iter()
        .map(|one| Parameter {
            name: one.name.clone(),
            prior: f64::NAN,
            value: one.value,
            ci95: (one.ci95[0], one.ci95[1]),
        })
        .collect();
    if !parameters.is_empty() {
        section = section.with(build::parameter_table("Parameters", &parameters));
    }
    let name = found
        .effects
        .first()
        .and_then(|run| run.trace.channels().iter().find(|channel| channel.name.starts_with(&finding.id)))
        .map(|channel| channel.name.clone());
    if let Some(name) = name {
        let series: Vec<Series> = found
            .effects
            .iter()
            .filter_map(|run| {
                Some(Series::new(run.id.clone(), run.trace.time_s().to_vec(), run.trace.get(&name)?.to_vec()))
            })
            .take(IN_DETAIL)
            .collect();
        section =
            section.with(Plot::new("The effect along the runs", Lines::over_time(Axis::of(&name), series)));
    }
    if !finding.stretches.is_empty() {
        let row = |place: &headland_diagnose::Interval| {
            vec![
                Cell::from(place.run.clone()),
                Cell::from(format!("{:.1} to {:.1}", place.from_s, place.to_s)),
                Cell::from(format!("{:.0} to {:.0}", place.from_position_m, place.to_position_m)),
            ]
        };
        section = section.with(Table {
            title: "Where it works".to_owned(),
            columns: vec![Axis::new("run", ""), Axis::new("time", "s"), Axis::new("position", "m")],
            rows: finding.stretches.iter().take(40).map(row).collect(),
        });
    }
    if !finding.indistinguishable_from.is_empty() {
        let row = |rival: &headland_diagnose::Rival| {
            vec![Cell::from(rival.id.clone()), Cell::from(format!("{:.3}", rival.squared_correlation))]
        };
        section = section.with(Table {
            title: "Causes that explain as much".to_owned(),
            columns: vec![Axis::new("cause", ""), Axis::new("squared correlation", "")],
            rows: finding.indistinguishable_from.iter().map(row).collect(),
        });
    }
    section
}

/// What each balance leaves over, before and after.
fn left(found: &Diagnosed) -> Section {
    let mut section = Section::new("What the balances leave over").words(
        "Measured minus modelled: with the free parameters alone, and with everything that was found.",
    );
    for left in found.residuals.iter().take(IN_DETAIL) {
        let (kind, times) = (left.balance, &left.time_s);
        let series = vec![
            Series::new("free parameters alone", times.clone(), left.before.clone()),
            Series::new("with what was found", times.clone(), left.after.clone()),
        ];
        let axis = Axis::new(format!("left over in the {} balance", kind.name()), kind.unit());
        let title = format!("{}: {}", super::titled(&left.run), kind.name());
        section = section.with(Plot::new(title, Lines::over_time(axis, series)));
    }
    section
}
