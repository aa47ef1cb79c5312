//! The page of a coast-down analysis.

mod runs;
mod two_stage;

use super::short;
use crate::command::coastdown::{Analysis, with_interval};
use headland_calibrate::coastdown::{CoastDown, Curve, Estimate};
use headland_recording::Recording;
use headland_report::{Axis, Cell, Figure, Item, Line, Lines, Plot, Report, Section, Series, Table};

/// Makes the page.
pub fn page(recording: &Recording, analysis: &Analysis) -> Report {
    let result = analysis.result();
    let lede = format!(
        "Rolling resistance and road loads from {} coast-downs: {}.",
        result.runs.len(),
        result.speed_law.as_ref().and_then(|law| law.fit.estimates.first()).map_or_else(
            || "no coefficient could be determined".to_owned(),
            |c_w| format!("c_w = {}", with_interval(c_w))
        )
    );
    let mut report = Report::new(recording.about.clone(), lede)
        .with(glance(analysis))
        .with(fit(analysis))
        .with(runs::runs(result));
    if let Some(two) = &result.two_stage {
        report = report.with(two_stage::two_stage(two, analysis));
    }
    if let Some(section) = super::notices(&recording.notices, analysis.assumed()) {
        report = report.with(section);
    }
    report
}

fn glance(analysis: &Analysis) -> Section {
    let result = analysis.result();
    let mut figures = Vec::new();
    if let Some(law) = &result.speed_law {
        for estimate in &law.fit.estimates {
            figures.push(figure(estimate));
        }
    }
    if let Some(two) = &result.two_stage {
        let words = "the paper's two stages, without rotating mass";
        figures.push(Figure::text("c_w of the two-stage method", short(two.kept.by_samples)).note(words));
    }
    let mut section = Section::new("At a glance").with(Item::Figures(figures));
    let told: Vec<String> = analysis
        .doubts()
        .iter()
        .chain(&result.null_space)
        .cloned()
        .chain(result.left_out.iter().map(|one| one.reason.clone()))
        .collect();
    if !told.is_empty() {
        section = section.with(Item::Sentences(told));
    }
    section
}

/// A name without the marks that set it off in a line of text.
fn plain(name: &str) -> String {
    name.replace('`', "")
}

fn figure(estimate: &Estimate) -> Figure {
    let unit = if estimate.unit == "1" { "" } else { &estimate.unit };
    let (value, note) = estimate.interval_95.map_or_else(
        || (short(estimate.value), "too few runs for an interval".to_owned()),
        |[low, high]| {
            let (value, interval) = headland_report::with_interval(estimate.value, low, high);
            (value, format!("95 %: {interval}"))
        },
    );
    Figure::text(plain(&estimate.name), format!("{value} {unit}").trim_end()).note(note)
}

fn fit(analysis: &Analysis) -> Section {
    let result = analysis.result();
    let mut section = Section::new("Fit of speed over time")
        .words("All runs are fitted at once by the speed itself, which is never differentiated; each has its own initial speed.")
        .with(estimates("Road load F = f0 + f1 v + f2 v², v in m/s, level and calm", &result.road_load.fit.estimates));
    if let Some(law) = &result.speed_law {
        let title = format!("Speed law c_w (1 + v/100), v in {}", law.unit.symbol());
        section = section.with(estimates(&title, &law.fit.estimates)).with(units(result));
    }
    section.with(speeds(&analysis.curves)).with(residuals(&analysis.curves)).with(forces(result))
}

fn estimates(title: &str, estimates: &[Estimate]) -> Table {
    let row = |estimate: &Estimate| {
        let value = estimate.value;
        let cell = estimate.interval_95.map_or(Cell::Number(value), |[lower, upper]| Cell::Interval {
            value,
            lower,
            upper,
        });
        vec![
            Cell::from(plain(&estimate.name)),
            Cell::from(if estimate.unit == "1" { "" } else { &estimate.unit }),
            cell,
            estimate.standard_error.unwrap_or(f64::NAN).into(),
            estimate.degrees_of_freedom.unwrap_or(f64::NAN).into(),
        ]
    };
    Table {
        title: title.to_owned(),
        columns: ["parameter", "unit", "estimate (95 % interval)", "standard error", "degrees of freedom"]
            .map(|name| Axis::new(name, ""))
            .to_vec(),
        rows: estimates.iter().map(row).collect(),
    }
}

fn units(result: &CoastDown) -> Table {
    let readings = result.speed_law.iter().flat_map(|law| &law.units);
    Table {
        title: "The same runs read with each unit of v".to_owned(),
        columns: vec![
            Axis::new("unit", ""),
            Axis::new("c_w", ""),
            Axis::new("RMS of the residual", "m/s"),
            Axis::new("scatter between runs, over weight", ""),
        ],
        rows: readings
            .map(|one| {
                vec![one.unit.symbol().into(), one.c_w.into(), one.rms_m_s.into(), one.between_runs_sd.into()]
            })
            .collect(),
    }
}

fn since_start(curve: &Curve) -> Vec<f64> {
    let first = curve.time_s.first().copied().unwrap_or(0.0);
    curve.time_s.iter().map(|time| time - first).collect()
}

fn speeds(curves: &[Curve]) -> Plot {
    let series = curves
        .iter()
        .flat_map(|curve| {
            let time = since_start(curve);
            [
                Series::new(curve.run.clone(), time.clone(), curve.measured_m_s.clone()).drawn(Line::Dots),
                Series::new(format!("{}, fit", curve.run), time, curve.fitted_m_s.clone()),
            ]
        })
        .collect();
    Plot::new("Speed of each coast-down", Lines::over_time(Axis::of("speed_m_s"), series))
        .words("Dots are measured, lines are the fit. Time counts from the start of each coast-down.")
}

fn residuals(curves: &[Curve]) -> Plot {
    let series = curves
        .iter()
        .map(|curve| {
            let residual: Vec<f64> =
                curve.fitted_m_s.iter().zip(&curve.measured_m_s).map(|(fit, speed)| fit - speed).collect();
            Series::new(curve.run.clone(), since_start(curve), residual)
        })
        .collect();
    Plot::new("Fit minus measured", Lines::over_time(Axis::new("residual of speed", "m/s"), series))
}

fn forces(result: &CoastDown) -> Plot {
    let forces = &result.road_load.forces;
    let speed: Vec<f64> = forces.iter().map(|at| at.speed_m_s).collect();
    let force: Vec<f64> = forces.iter().map(|at| at.force_n).collect();
    let end = |index: usize| -> Vec<f64> {
        forces.iter().map(|at| at.interval_95.map_or(f64::NAN, |ends| ends[index])).collect()
    };
    let mut series = Series::new("resistance (95 % band)", speed, force);
    if forces.iter().all(|at| at.interval_95.is_some()) {
        series = series.band(end(0), end(1));
    }
    Plot::new(
        "Resistance on level ground in calm air",
        Lines::over(Axis::of("speed_m_s"), Axis::new("resistance", "N"), vec![series]),
    )
}
