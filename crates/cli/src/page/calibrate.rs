//! The page of a calibration.

use super::compare::spoken;
use crate::fitted::{Calibration, Part, RunFit, Signal};
use crate::held::Pair;
use headland_calibrate::fit::Fit;
use headland_recording::Recording;
use headland_report::build::{self, Parameter};
use headland_report::{Axis, Bar, Bars, Cell, Item, Plot, Report, ReportError, Section, Table};

/// Runs that get plots of their own.
const IN_DETAIL: usize = 4;

/// Makes the page; `pairs` are all runs before and after.
pub fn page(
    about: &str,
    recording: &Recording,
    document: &Calibration,
    fit: &Fit,
    pairs: (&[Pair], &[Pair]),
) -> Result<Report, ReportError> {
    let report = Report::new(about, format!("Fitted to {}. {}", recording.about, said(&document.signals)))
        .with(parameters(fit))
        .with(errors(document));
    let mut report = report;
    for (before, after) in pairs.0.iter().zip(pairs.1).take(IN_DETAIL) {
        report = report.with(detail(before, after)?);
    }
    if let Some(section) = super::notices(&recording.notices, &document.notes) {
        report = report.with(section);
    }
    Ok(report)
}

fn said(signals: &[Signal]) -> String {
    let one = |signal: &Signal| {
        let part = if signal.held_out.runs.is_empty() { &signal.fitted } else { &signal.held_out };
        let which = if signal.held_out.runs.is_empty() { "" } else { " in runs that were never fitted" };
        format!(
            "RMSE of {} {} → {} {}{which}.",
            spoken(&signal.channel),
            super::short(part.rmse_before),
            super::short(part.rmse_after),
            signal.unit
        )
    };
    signals.iter().map(one).collect::<Vec<_>>().join(" ")
}

fn parameters(fit: &Fit) -> Section {
    let parameter = |estimate: &headland_calibrate::fit::Estimate| Parameter {
        name: estimate.name.rsplit('.').next().unwrap_or(&estimate.name).to_owned(),
        prior: estimate.prior,
        value: estimate.value,
        ci95: (estimate.ci95[0], estimate.ci95[1]),
    };
    let estimates: Vec<Parameter> = fit.estimates.iter().map(parameter).collect();
    let names: Vec<&str> = estimates.iter().map(|estimate| estimate.name.as_str()).collect();
    let mut section = Section::new("Parameters").with(build::parameter_table("Free parameters", &estimates));
    let bound: Vec<&str> = fit
        .estimates
        .iter()
        .filter(|estimate| estimate.at_bound)
        .map(|estimate| estimate.name.as_str())
        .collect();
    if !bound.is_empty() {
        section = section.with(Item::Words(format!(
            "At a bound, so that the interval says nothing: {}.",
            bound.join(", ")
        )));
    }
    if !fit.null_space.is_empty() {
        section = section.with(Item::Sentences(fit.null_space.clone()));
    }
    if fit.correlation.len() > 1 {
        section = section.with(build::correlation(&names, &fit.correlation));
    }
    section
}

fn errors(document: &Calibration) -> Section {
    let mut section = Section::new("Error before and after");
    let row = |signal: &Signal, what: &str, part: &Part| {
        vec![
            Cell::from(format!("{} [{}]", spoken(&signal.channel), signal.unit)),
            Cell::from(format!("{} {what}", part.runs.len())),
            part.rmse_before.into(),
            part.rmse_after.into(),
            (100.0 * (part.rmse_after / part.rmse_before - 1.0)).into(),
        ]
    };
    let mut rows = Vec::new();
    for signal in &document.signals {
        for (what, part) in [("fitted", &signal.fitted), ("held out", &signal.held_out)] {
            if !part.runs.is_empty() {
                rows.push(row(signal, what, part));
            }
        }
    }
    let columns = vec![
        Axis::new("signal", ""),
        Axis::new("runs", ""),
        Axis::new("RMSE before", ""),
        Axis::new("RMSE after", ""),
        Axis::new("change", "%"),
    ];
    section = section.with(Table { title: "Root mean square error".to_owned(), columns, rows });
    for signal in document.signals.iter().filter(|_| document.runs.len() > 1) {
        section = section.with(bars(signal, &document.runs));
    }
    section
}

fn bars(signal: &Signal, runs: &[RunFit]) -> Plot {
    let of = |run: &RunFit, after: bool| {
        let found = run.signals.iter().find(|one| one.channel == signal.channel);
        found.map_or(f64::NAN, |one| if after { one.rmse_after } else { one.rmse_before })
    };
    let name = |run: &RunFit| if run.held_out { format!("{} (held out)", run.run) } else { run.run.clone() };
    let bar = |name: &str, after: bool| Bar {
        name: name.to_owned(),
        values: runs.iter().map(|run| of(run, after)).collect(),
        error: None,
    };
    let bars = Bars {
        categories: runs.iter().map(name).collect(),
        axis: Axis::new(format!("RMSE of {}", spoken(&signal.channel)), &signal.unit),
        bars: vec![bar("before", false), bar("after", true)],
        stacked: false,
        horizontal: true,
    };
    Plot::new(format!("Error of {} by run", spoken(&signal.channel)), bars)
}

fn detail(before: &Pair, after: &Pair) -> Result<Section, ReportError> {
    let held_out = if after.held_out { ", never fitted" } else { "" };
    let mut section = Section::new(super::titled(&after.comparison.run) + held_out);
    for name in after.signals.iter().filter(|name| after.outcome.trace.get(name).is_some()) {
        let traces = [
            ("measured", &after.measured),
            ("before", &before.outcome.trace),
            ("after", &after.outcome.trace),
        ];
        section = section.with(build::over_time(name, &traces, Vec::new())?);
        section = section.with(build::residual_over_time(
            name,
            &after.measured,
            &after.outcome.trace,
            None,
            Vec::new(),
        )?);
    }
    Ok(section)
}
