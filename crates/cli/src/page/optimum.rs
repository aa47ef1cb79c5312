//! The page of a management and the course of least fuel.

use crate::command::optimum::Courses;
use headland_report::{Axis, Cell, Lines, Plot, Report, Section, Series, Table};
use headland_scenario::Scenario;

/// Runs that get plots of their own; the table holds all.
const IN_DETAIL: usize = 12;

/// Makes the page.
pub fn page(scenario: &Scenario, all: &[Courses], step_s: f64) -> Report {
    let worst = all.iter().map(|one| one.measured.above_least).fold(f64::NEG_INFINITY, f64::max);
    let lede = format!(
        "The management takes {} {:.1} % more fuel than what knows the whole course and ends at the same charge.",
        if all.len() > 1 { "up to" } else { "" },
        100.0 * worst
    )
    .replace("  ", " ");
    let mut report = Report::new(scenario.about.clone(), lede).with(overview(all, step_s));
    for one in all.iter().take(IN_DETAIL) {
        report = report.with(detail(one, all.len() == 1));
    }
    report
}

fn overview(all: &[Courses], step_s: f64) -> Section {
    let row = |one: &Courses| {
        let run = &one.measured;
        vec![
            Cell::from(run.id.clone()),
            (run.simulated_fuel_j / 1e6).into(),
            (100.0 * run.simulated_charge).into(),
            (run.fuel_j / 1e6).into(),
            (run.least_fuel_j / 1e6).into(),
            (100.0 * run.above_least).into(),
            (100.0 * run.charges.0).into(),
            (100.0 * run.charges.1).into(),
            (100.0 * run.charges.2).into(),
        ]
    };
    let table = Table {
        title: "Fuel and the least".to_owned(),
        columns: vec![
            Axis::new("run", ""),
            Axis::new("simulated fuel", "MJ"),
            Axis::new("simulated charge at the end", "%"),
            Axis::new("fuel of the management", "MJ"),
            Axis::new("least fuel", "MJ"),
            Axis::new("above the least", "%"),
            Axis::new("charge at the start", "%"),
            Axis::new("charge at the end", "%"),
            Axis::new("charge at the end of the least", "%"),
        ],
        rows: all.iter().map(row).collect(),
    };
    let words = format!(
        "The course is what the run asked of its driveline, in steps of {step_s} s without a turbocharger's lag. The management \
         and dynamic programming (Bellman 1957; Sundström and Guzzella 2009) share the power on it, in the ranges that \
         the transmission took. No management can do better than the least but for the grid of charges and powers that it \
         is looked for on."
    );
    Section::new("At a glance").words(words).with(table)
}

fn detail(one: &Courses, alone: bool) -> Section {
    let lines = |names: [(&str, &str); 2]| {
        let series = names
            .into_iter()
            .filter_map(|(told, name)| Some(Series::new(told, one.trace.time_s(), one.trace.get(name)?)));
        Lines::over_time(Axis::of(names[0].1), series.collect())
    };
    let title = if alone { "The courses".to_owned() } else { one.measured.id.clone() };
    let both = |name, least| [("managed", name), ("least fuel", least)];
    let charge = lines(both("state_of_charge", "least_state_of_charge"));
    let power = lines(both("engine_power_w", "least_engine_power_w"));
    Section::new(title)
        .with(Plot::new("State of charge", charge))
        .with(Plot::new("Power of the engine", power))
}
