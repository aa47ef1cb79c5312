//! The page of a comparison.

use super::{energy, motion};
use crate::held::Pair;
use headland_compare::{Check, Summary};
use headland_recording::Recording;
use headland_report::{Axis, Cell, Figure, Item, Plot, Report, ReportError, Section, Table, Tone, build};
use headland_trace::Trace;
use headland_units::stem;

/// Runs that get plots of their own.
const IN_DETAIL: usize = 6;

/// What the page is made of.
pub struct Content<'a> {
    /// The scenario, in its own words.
    pub about: &'a str,
    /// The recording.
    pub recording: &'a Recording,
    /// Every run.
    pub pairs: &'a [Pair],
    /// All of them at a glance.
    pub summary: &'a Summary,
    /// Requirements.
    pub checks: &'a [Check],
    /// What was decided on the way.
    pub notes: &'a [String],
}

/// Makes the page.
pub fn page(content: &Content) -> Result<Report, ReportError> {
    let lede = format!("Held against {}: {}.", content.recording.about, said(content));
    let mut report = Report::new(content.about, lede).with(overview(content));
    let chosen = chosen(content);
    for pair in &chosen {
        report = report.with(detail(pair, content.pairs.len() == 1)?);
    }
    if let Some(section) = super::notices(&content.recording.notices, content.notes) {
        report = report.with(section);
    }
    Ok(report)
}

/// Name of a channel as it is read.
pub fn spoken(channel: &str) -> String {
    stem(channel).replace('_', " ")
}

fn said(content: &Content) -> String {
    let channel = |channel: &headland_compare::ChannelSummary| {
        format!("{} is off by {} (RMSE)", spoken(&channel.channel), quantity(channel.rmse, &channel.unit))
    };
    let said: Vec<String> = content.summary.channels.iter().take(3).map(channel).collect();
    if said.is_empty() { "nothing that was measured was predicted".to_owned() } else { said.join(", ") }
}

fn quantity(value: f64, unit: &str) -> String {
    headland_report::quantity(value, if unit == "1" { "" } else { unit })
}

fn overview(content: &Content) -> Section {
    let mut section = Section::new("At a glance");
    let figures: Vec<Figure> = content
        .checks
        .iter()
        .map(|check| {
            let unit = check.requirement.metric.unit_for(&check.requirement.channel);
            Figure::text(check.requirement.to_string(), quantity(check.found, &unit))
                .note(format!("in run {}", check.run))
                .tone(if check.met { Tone::Good } else { Tone::Bad })
        })
        .collect();
    if !figures.is_empty() {
        section = section.with(Item::Figures(figures));
    }
    section = section.with(channels(content.summary)).with(totals(content.summary));
    if content.pairs.len() > 1 {
        section = section.with(runs(content));
    }
    if !content.summary.driven.is_empty() {
        let driven: Vec<String> = content.summary.driven.iter().map(|name| spoken(name)).collect();
        section = section.with(Item::Words(format!(
            "Inputs of the model, which agree by construction and validate nothing: {}.",
            driven.join(", ")
        )));
    }
    section
}

fn channels(summary: &Summary) -> Table {
    let row = |channel: &headland_compare::ChannelSummary| {
        vec![
            Cell::from(format!("{} [{}]", spoken(&channel.channel), channel.unit)),
            channel.rmse.into(),
            channel.bias.into(),
            channel.mae.into(),
            channel.iso18571.unwrap_or(f64::NAN).into(),
            Cell::from(format!("{} of {}", channel.within_band, channel.runs)),
            Cell::from(format!("{} ({})", channel.worst_run, super::short(channel.worst_rmse))),
        ]
    };
    Table {
        title: "Predicted channels, over all runs".to_owned(),
        columns: [
            "channel",
            "RMSE",
            "bias",
            "MAE",
            "ISO 18571 rating",
            "runs within the band",
            "worst run (RMSE)",
        ]
        .map(|name| Axis::new(name, ""))
        .to_vec(),
        rows: summary.channels.iter().map(row).collect(),
    }
}

fn totals(summary: &Summary) -> Table {
    let row = |total: &headland_compare::Total| {
        let verdict = match total.within_criterion {
            Some(true) => "within 5 %",
            Some(false) => "not within 5 %",
            None => "what little is left of a give and take",
        };
        vec![
            Cell::from(spoken(&total.of)),
            Cell::from(quantity(total.measured, &total.unit)),
            Cell::from(quantity(total.modelled, &total.unit)),
            (100.0 * total.relative_error.unwrap_or(f64::NAN)).into(),
            Cell::from(verdict),
        ]
    };
    Table {
        title: "Totals".to_owned(),
        columns: vec![
            Axis::new("of", ""),
            Axis::new("measured", ""),
            Axis::new("modelled", ""),
            Axis::new("error", "%"),
            Axis::new("criterion", ""),
        ],
        rows: summary.totals.iter().map(row).collect(),
    }
}

fn runs(content: &Content) -> Table {
    let judged = |channel: &&headland_compare::ChannelSummary| {
        content.pairs.iter().any(|pair| pair.signals.contains(&channel.channel))
    };
    let channels: Vec<_> = content.summary.channels.iter().filter(judged).collect();
    let names: Vec<&str> = channels.iter().map(|channel| channel.channel.as_str()).collect();
    let mut columns = vec![Axis::new("run", ""), Axis::new("duration", "s")];
    columns.extend(channels.iter().map(|channel| {
        Axis::new(
            format!("RMSE of {}", spoken(&channel.channel)),
            if channel.unit == "1" { "" } else { &channel.unit },
        )
    }));
    let row = |pair: &Pair| {
        let error = |name: &&str| {
            let found = pair.comparison.channel(name).filter(|found| !found.driven);
            Cell::Number(found.map_or(f64::NAN, |found| found.metrics.rmse))
        };
        let mut row = vec![Cell::from(pair.comparison.run.clone()), pair.comparison.duration_s.into()];
        row.extend(names.iter().map(error));
        row
    };
    Table { title: "Runs".to_owned(), columns, rows: content.pairs.iter().map(row).collect() }
}

/// All runs, or of many the three furthest off, the middle, and the nearest, in the order of the recording.
fn chosen<'a>(content: &Content<'a>) -> Vec<&'a Pair> {
    if content.pairs.len() <= IN_DETAIL {
        return content.pairs.iter().collect();
    }
    let main = content.summary.channels.first().map_or("", |channel| &channel.channel);
    let error = |pair: &Pair| pair.comparison.channel(main).map_or(0.0, |found| found.metrics.rmse);
    let mut ranked: Vec<usize> = (0..content.pairs.len()).collect();
    ranked.sort_by(|one, other| error(&content.pairs[*other]).total_cmp(&error(&content.pairs[*one])));
    let last = ranked.len() - 1;
    let mut kept = [0, 1, 2, last / 2, last].map(|rank| ranked[rank]);
    kept.sort_unstable();
    kept.iter().map(|index| &content.pairs[*index]).collect()
}

fn detail(pair: &Pair, alone: bool) -> Result<Section, ReportError> {
    let (measured, modelled) = (&pair.measured, &pair.outcome.trace);
    let title = if alone { "The run".to_owned() } else { super::titled(&pair.comparison.run) };
    let words = match pair.drive {
        "Speed" => "The recorded speed moves the model; it says what force, torque and energy that took.",
        "Torque" => "The recorded torque moves the model; it says how the vehicle moved.",
        "Force" => "The recorded force moves the model; it says how the vehicle moved.",
        _ => "The vehicle rolls out; the model says how.",
    };
    let mut section = Section::new(title).words(words);
    for plot in signals(pair)? {
        section = section.with(plot);
    }
    section = section.with(motion::forces(modelled)?);
    for plot in motion::powers(modelled).into_iter().chain(motion::map(map_of(measured, modelled))) {
        section = section.with(plot);
    }
    Ok(section.with(energy::flow(&pair.outcome.ledger)))
}

/// Where the recording knows the place, its path; else that of the model.
fn map_of<'a>(measured: &'a Trace, modelled: &'a Trace) -> &'a Trace {
    if measured.get("east_m").is_some() { measured } else { modelled }
}

fn signals(pair: &Pair) -> Result<Vec<Plot>, ReportError> {
    let (measured, modelled) = (&pair.measured, &pair.outcome.trace);
    let mut plots = Vec::new();
    if !pair.signals.iter().any(|name| name == "speed_m_s") && measured.get("speed_m_s").is_some() {
        plots.push(build::over_time("speed_m_s", &[("measured", measured)], Vec::new())?);
    }
    for name in &pair.signals {
        if modelled.get(name).is_none() {
            continue;
        }
        plots.push(build::over_time(name, &[("measured", measured), ("model", modelled)], Vec::new())?);
        plots.push(build::residual_over_time(name, measured, modelled, None, Vec::new())?);
    }
    for name in pair.signals.iter().filter(|name| modelled.get(name).is_some()) {
        for against in ["speed_m_s", "position_m", "heading_rad"] {
            if measured.get(against).is_some() {
                plots.push(build::residual_against(name, against, measured, modelled)?);
            }
        }
    }
    for name in pair.signals.iter().filter(|name| modelled.get(name).is_some()) {
        let Some(cdf) = pair.comparison.channel(name).and_then(|found| found.cdf.as_ref()) else { continue };
        let both = |trace: &Trace| trace.get(name).unwrap_or(&[]).to_vec();
        let (one, other) = (both(measured), both(modelled));
        plots.push(
            build::cumulative_probability(
                Axis::of(name),
                &[("measured", &one, cdf.band_half_width), ("model", &other, 0.0)],
            )
            .words(format!(
                "95 % band of the measured distribution at {} effective samples. A match says nothing about the order \
                 in time.",
                super::short(cdf.effective_samples)
            )),
        );
    }
    Ok(plots)
}
