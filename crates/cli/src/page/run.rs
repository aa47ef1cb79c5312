//! The page of a simulation.

use super::{energy, motion, wheels};
use headland_report::{Axis, Cell, Figure, Item, Lines, Plot, Report, ReportError, Section, Series, Table};
use headland_scenario::Scenario;
use headland_sim::{End, Outcome};
use headland_trace::Trace;

/// Runs that get plots of their own; the table and the trace hold all.
const IN_DETAIL: usize = 12;

/// Makes the page.
pub fn page(
    scenario: &Scenario,
    runs: &[(String, Outcome)],
    remarks: &[String],
) -> Result<Report, ReportError> {
    let vehicle = scenario.vehicle_name.as_deref().unwrap_or("vehicle");
    let mut report = Report::new(scenario.about.clone(), lede(vehicle, runs)).with(overview(runs, remarks));
    for (id, outcome) in runs.iter().take(IN_DETAIL) {
        report = report.with(detail(id, outcome, runs.len() == 1)?);
    }
    Ok(report)
}

fn lede(vehicle: &str, runs: &[(String, Outcome)]) -> String {
    let duration: f64 = runs.iter().map(|(_, outcome)| outcome.trace.duration_s()).sum();
    let stopped = runs.iter().filter(|(_, outcome)| outcome.end != End::Finished).count();
    let cut = |(_, outcome): &&(String, Outcome)| matches!(outcome.end, End::Interrupted { .. });
    let interrupted = runs.iter().filter(cut).count();
    let ends = match (runs.len(), stopped) {
        (1, 0) => "It was driven to its end.".to_owned(),
        (_, 0) => "All were driven to their end.".to_owned(),
        (1, _) if interrupted > 0 => "It was interrupted before its end.".to_owned(),
        (_, stopped) if interrupted == stopped => format!("{stopped} were interrupted before their end."),
        (_, stopped) if interrupted > 0 => format!(
            "{interrupted} were interrupted before their end, {} could not be driven to theirs.",
            stopped - interrupted
        ),
        (_, stopped) => format!("{stopped} could not be driven to the end."),
    };
    let count = if runs.len() == 1 { "one run".to_owned() } else { format!("{} runs", runs.len()) };
    format!("{vehicle}: {count}, simulated over {}. {ends}", headland_report::quantity(duration, "s"))
}

fn overview(runs: &[(String, Outcome)], remarks: &[String]) -> Section {
    let mut section = Section::new("At a glance");
    if let [(_, outcome)] = runs {
        section = section.with(Item::Figures(figures(outcome)));
    } else {
        section = section.with(together(runs)).with(table(runs));
    }
    if !remarks.is_empty() {
        section = section.with(Item::Sentences(remarks.to_vec()));
    }
    section
}

fn distance_m(trace: &Trace) -> f64 {
    match trace.get("position_m") {
        Some([first, .., last]) => last - first,
        _ => 0.0,
    }
}

fn top_m_s(trace: &Trace) -> f64 {
    trace.get("speed_m_s").unwrap_or(&[]).iter().copied().fold(0.0, f64::max)
}

fn figures(outcome: &Outcome) -> Vec<Figure> {
    let kmh = format!("{} km/h", super::short(3.6 * top_m_s(&outcome.trace)));
    let closed = format!("closed to {:.0e} of what moved", outcome.ledger.relative_residual());
    let mut figures = vec![
        Figure::new("Duration", outcome.trace.duration_s(), "s"),
        Figure::new("Distance", distance_m(&outcome.trace), "m"),
        Figure::new("Greatest speed", top_m_s(&outcome.trace), "m/s").note(kmh),
        Figure::new("Energy moved", outcome.ledger.turnover_j(), "J").note(closed),
    ];
    if outcome.ledger.source_j != 0.0 {
        let source = outcome.ledger.source_name.replace('_', " ");
        figures.push(Figure::new(format!("Energy from {source}"), outcome.ledger.source_j, "J"));
    }
    figures
}

fn together(runs: &[(String, Outcome)]) -> Plot {
    let series = runs.iter().take(IN_DETAIL).filter_map(|(id, outcome)| {
        Some(Series::new(id.clone(), outcome.trace.time_s(), outcome.trace.get("speed_m_s")?))
    });
    Plot::new("Speed of all runs", Lines::over_time(Axis::of("speed_m_s"), series.collect()))
}

fn table(runs: &[(String, Outcome)]) -> Table {
    let row = |(id, outcome): &(String, Outcome)| {
        let end = match &outcome.end {
            End::Finished => "finished".to_owned(),
            End::Stopped { reason, .. } => format!("stopped: {reason}"),
            End::Interrupted { .. } => "interrupted".to_owned(),
        };
        vec![
            Cell::from(id.clone()),
            outcome.trace.duration_s().into(),
            distance_m(&outcome.trace).into(),
            (3.6 * top_m_s(&outcome.trace)).into(),
            (outcome.ledger.turnover_j() / 1e3).into(),
            Cell::from(end),
        ]
    };
    Table {
        title: "Runs".to_owned(),
        columns: vec![
            Axis::new("run", ""),
            Axis::new("duration", "s"),
            Axis::new("distance", "m"),
            Axis::new("greatest speed", "km/h"),
            Axis::new("energy moved", "kJ"),
            Axis::new("end", ""),
        ],
        rows: runs.iter().map(row).collect(),
    }
}

fn detail(id: &str, outcome: &Outcome, alone: bool) -> Result<Section, ReportError> {
    let trace = &outcome.trace;
    let mut section = Section::new(if alone { "The run".to_owned() } else { super::titled(id) })
        .words("Drag across a plot over time to zoom all of them; double-click to see everything again.")
        .with(headland_report::build::over_time("speed_m_s", &[("simulated", trace)], Vec::new())?)
        .with(motion::forces(trace)?);
    let plots = wheels::plots(trace).into_iter().chain(motion::powers(trace));
    for plot in plots.chain(motion::along(trace)).chain(motion::map(trace)) {
        section = section.with(plot);
    }
    Ok(section.with(energy::flow(&outcome.ledger)))
}
