//! One finding: its sentence, its parameters, the effect along the runs with its band.

use super::{capital, plain, unit};
use headland_diagnose::{Diagnosed, FindingReport, Interval, ParameterReport};
use headland_report::{Axis, Cell, Lines, Plot, Section, Series, Table};
use headland_trace::Run;

/// Runs that get lines of their own.
const IN_DETAIL: usize = 4;
/// Stretches in the table.
const STRETCHES: usize = 40;
/// An equation with fewer letters than this stays in one line.
const WHOLE: usize = 40;
/// Units of effects, as the names of their channels end.
const UNITS: [&str; 4] = ["n", "w", "m_s", "m_s2"];

/// The section.
pub fn section(finding: &FindingReport, found: &Diagnosed) -> Section {
    // A short equation must not be torn at its spaces.
    let equation = match finding.equation.as_str() {
        "" => String::new(),
        short if short.chars().count() < WHOLE => format!(" Equation: {}.", short.replace(' ', "\u{a0}")),
        long => format!(" Equation: {long}."),
    };
    let mut section =
        Section::new(capital(&plain(&finding.id))).words(format!("{}{equation}", finding.sentence));
    if !finding.parameters.is_empty() {
        section = section.with(parameters(&finding.parameters));
    }
    let name = UNITS
        .iter()
        .map(|unit| format!("{}_{unit}", finding.id))
        .find(|name| found.effects.first().is_some_and(|run| run.trace.get(name).is_some()));
    if let Some(name) = name {
        // Of each run that was held out a plot of its own; of the fitted ones those that come first.
        let held = &found.diagnosis.fit.held_out;
        let held = |run: &&Run| held.as_ref().is_some_and(|held| held.runs.contains(&run.id));
        let (own, fitted): (Vec<&Run>, Vec<&Run>) = found.effects.iter().partition(held);
        for run in own.into_iter().chain(fitted).filter(|run| moves(run, &name)).take(IN_DETAIL) {
            section = section.with(along(run, &name, finding));
        }
    }
    if !finding.stretches.is_empty() {
        section = section.with(places(&finding.stretches));
    }
    section
}

fn moves(run: &Run, name: &str) -> bool {
    run.trace.get(name).is_some_and(|values| values.iter().any(|value| *value != 0.0))
}

fn along(run: &Run, name: &str, finding: &FindingReport) -> Plot {
    let values = |name: &str| run.trace.get(name).map(<[f64]>::to_vec);
    let mut series =
        Series::new(plain(&finding.id), run.trace.time_s().to_vec(), values(name).unwrap_or_default());
    let mut banded = "";
    if let (Some(low), Some(high)) = (values(&format!("{name}_low")), values(&format!("{name}_high"))) {
        series = series.band(low, high);
        banded = ", with its 95 % band";
    }
    let axis = Axis { label: plain(&finding.id), ..Axis::of(name) };
    let title = format!("{} along {}{banded}", capital(&plain(&finding.id)), run.id);
    let words = if name.ends_with("_n") { "Forward is positive: what resists is negative." } else { "" };
    Plot::new(title, Lines::over_time(axis, vec![series])).words(words)
}

fn parameters(all: &[ParameterReport]) -> Table {
    let row = |one: &ParameterReport| {
        let [lower, upper] = one.ci95;
        let value = if lower < upper {
            Cell::Interval { value: one.value, lower, upper }
        } else {
            Cell::Number(one.value)
        };
        vec![Cell::from(plain(headland_units::stem(&one.name))), value, Cell::from(unit(&one.unit))]
    };
    Table {
        title: "Parameters".to_owned(),
        columns: vec![
            Axis::new("parameter", ""),
            Axis::new("value, 95 % interval", ""),
            Axis::new("unit", ""),
        ],
        rows: all.iter().map(row).collect(),
    }
}

fn places(all: &[Interval]) -> Table {
    let row = |place: &Interval| {
        vec![
            Cell::from(place.run.clone()),
            Cell::from(format!("{:.1} to {:.1}", place.from_s, place.to_s)),
            Cell::from(format!("{:.0} to {:.0}", place.from_position_m, place.to_position_m)),
        ]
    };
    let more = if all.len() > STRETCHES {
        format!(" (the first {STRETCHES} of {})", all.len())
    } else {
        String::new()
    };
    Table {
        title: format!("Where it works{more}"),
        columns: vec![Axis::new("run", ""), Axis::new("time", "s"), Axis::new("position", "m")],
        rows: all.iter().take(STRETCHES).map(row).collect(),
    }
}
