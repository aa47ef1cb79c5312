//! `headland batch`: many runs, compared.

use super::drawn;
use crate::arguments::BatchOptions;
use crate::failure::{Failure, interrupted};
use crate::output::Output;
use crate::pace::Pace;
use crate::page::{self, short};
use crate::picture::{Wanted, draw_batch};
use crate::say::Say;
use headland_batch::{BatchError, Comparison, Journal, Plan, Settings, Statistics, Summary, execute, table};
use headland_plugin::Registry;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

/// `summary.json`.
#[derive(Debug, Serialize)]
struct Document {
    schema: &'static str,
    about: String,
    runs: u64,
    finished: u64,
    unfinished: u64,
    baseline: Option<String>,
    configurations: Vec<Configuration>,
    troubles: Vec<Trouble>,
}

#[derive(Debug, Serialize)]
struct Configuration {
    variant: String,
    cycle: String,
    ground: String,
    finished: u64,
    unfinished: u64,
    /// What making up for the charge adds to the fuel burnt, as a share of that.
    charge_made_up: Option<f64>,
    /// Way that was not made in the time that its speeds ask for, as a share of what they ask for.
    short_share: f64,
    measures: Vec<Measured>,
}

#[derive(Debug, Serialize)]
struct Measured {
    name: &'static str,
    unit: &'static str,
    mean: f64,
    standard_deviation: Option<f64>,
    against_baseline: Option<Against>,
}

#[derive(Debug, Serialize)]
struct Against {
    share: f64,
    standard_deviation: Option<f64>,
    pairs: u64,
}

#[derive(Debug, Serialize)]
struct Trouble {
    run: u64,
    status: &'static str,
    error: String,
}

/// Runs the command.
pub fn batch(registry: &Registry, options: &BatchOptions, seed: u64, say: Say) -> Result<(), Failure> {
    let pictures = Wanted::of(options.picture);
    pictures.possible()?;
    if !options.drawn.is_empty() && !pictures.any() {
        return Err(Failure::Input("--drawn goes with --rerun, --view or --serve".to_owned()));
    }
    let comparison = Comparison::read(&options.comparison)?;
    if !options.drawn.is_empty() {
        // A number of no run is said before anything is simulated.
        let plan = Plan::new(Comparison::read(&options.comparison)?, registry, seed)?;
        drawn::numbers(&plan, &options.drawn)?;
    }
    let mut output = Output::new(options.out.as_deref(), &options.comparison)?;
    let done = run(registry, comparison, (options.traces, options.anew), &mut output, seed, say)?;
    if !pictures.any() {
        return finish(&done, &output, say);
    }
    let numbers = drawn::numbers(&done.plan, &options.drawn)?;
    let chosen = drawn::chosen(&done.plan, registry, &numbers)?;
    let picture = draw_batch(pictures, &chosen, registry, &mut output)?;
    let finished = finish(&done, &output, say);
    picture.serve(say)?;
    finished
}

/// A batch that is finished.
pub struct Done {
    /// Its runs.
    pub plan: Plan,
    /// What is told of them.
    pub summary: Summary,
}

/// Runs a comparison, or what is left of it, and writes what comes of it.
pub fn run(
    registry: &Registry,
    comparison: Comparison,
    (traces, anew): (bool, bool),
    output: &mut Output,
    seed: u64,
    say: Say,
) -> Result<Done, Failure> {
    let plan = Plan::new(comparison, registry, seed)?;
    if let Some((of, error)) = plan.refused().next() {
        let count = plan.refused().count();
        say.progress(&format!(
            "note: {count} of {} combinations cannot be run and will be rows with their error; the first is {of}:\n{}",
            plan.combinations(),
            error.told()
        ));
    }
    let identity = plan.comparison.identity(seed);
    let mut journal = match Journal::open(output.path(), &identity, plan.total(), anew) {
        Err(BatchError::File { path, source }) => return Err(Failure::unwritable(&path, &source)),
        other => other?,
    };
    if journal.torn_bytes > 0 {
        say.progress(&format!(
            "the journal ends in {} bytes of a run that was not finished",
            journal.torn_bytes
        ));
    }
    if journal.finished() > 0 {
        say.progress(&format!("{} of {} runs are finished already", journal.finished(), plan.total()));
    }
    let pace = Pace::new(say, plan.total(), journal.finished());
    let settings = Settings { traces, stop: &interrupted, progress: &|progress| pace.tell(progress) };
    let executed = execute(&plan, registry, &mut journal, &settings);
    pace.end();
    let kept = |error: BatchError, journal: &Journal| {
        let kept = format!(
            "{} of {} runs are finished and kept; the same command goes on",
            journal.finished(),
            plan.total()
        );
        match Failure::from(error) {
            Failure::Machine(text) => Failure::Machine(format!("{text}\n  {kept}")),
            Failure::Interrupted => {
                say.progress(&kept);
                Failure::Interrupted
            }
            other => other,
        }
    };
    executed.map_err(|error| kept(error, &journal))?;
    let results = output.file("results.parquet");
    table::write(&plan, &mut journal, &results).map_err(|error| kept(error, &journal))?;
    let summary = Summary::of(&plan, &mut journal)?;
    output.json("summary.json", &document(&plan, &summary)).map_err(machine)?;
    output.page("report.html", &page::batch::page(&plan, &summary, registry)?).map_err(machine)?;
    Ok(Done { plan, summary })
}

/// A folder that could be written to a moment ago is no mistake of the user's.
fn machine(failure: Failure) -> Failure {
    match failure {
        Failure::Input(text) => Failure::Machine(text),
        other => other,
    }
}

/// Says what came of it.
pub fn finish(done: &Done, output: &Output, say: Say) -> Result<(), Failure> {
    say.result(&text(done, output), &document(&done.plan, &done.summary))?;
    let Summary { unfinished, troubles, .. } = &done.summary;
    match troubles.first() {
        Some((number, _, error)) => Err(Failure::Requirement(format!(
            "{unfinished} of {} runs have no end; the first is {}: {error}",
            done.plan.total(),
            done.plan.called(done.plan.spec(*number))
        ))),
        None => Ok(()),
    }
}

fn document(plan: &Plan, summary: &Summary) -> Document {
    let comparison = &plan.comparison;
    let present = summary.present();
    let deviation = |one: &Statistics| Some(one.deviation()).filter(|value| value.is_finite());
    let measured = |cell: &headland_batch::Cell, index: usize| {
        let (name, unit) = summary.measures[index].label(&comparison.accounting);
        let (value, against) = (&cell.measures[index], &cell.against[index]);
        (value.count > 0).then(|| Measured {
            name,
            unit,
            mean: value.mean,
            standard_deviation: deviation(value),
            against_baseline: (against.count > 0).then(|| Against {
                share: against.mean,
                standard_deviation: deviation(against),
                pairs: against.count,
            }),
        })
    };
    Document {
        schema: "headland.batch/1",
        about: comparison.about.clone(),
        runs: plan.total(),
        finished: summary.finished,
        unfinished: summary.unfinished,
        baseline: comparison.baseline.map(|index| comparison.variants[index].name.clone()),
        configurations: summary
            .cells
            .iter()
            .map(|cell| Configuration {
                short_share: cell.short(),
                variant: comparison.variants[cell.variant].name.clone(),
                cycle: comparison.cycles[cell.cycle].name.clone(),
                ground: comparison.grounds[cell.ground].name.clone(),
                finished: cell.finished,
                unfinished: cell.unfinished,
                charge_made_up: (cell.made_up.count > 0).then_some(cell.made_up.mean),
                measures: present.iter().filter_map(|index| measured(cell, *index)).collect(),
            })
            .collect(),
        troubles: summary
            .troubles
            .iter()
            .map(|(run, status, error)| Trouble { run: *run, status: status.name(), error: error.clone() })
            .collect(),
    }
}

/// Notes of the text; the page has all.
const MOST_NOTES: usize = 6;
/// Measures of the text; the page has all.
const IN_TEXT: usize = 4;

/// What came of it, for a person at a terminal.
fn text(done: &Done, output: &Output) -> String {
    let (plan, summary) = (&done.plan, &done.summary);
    let comparison = &plan.comparison;
    let mut text = format!("{}\n  {}\n", comparison.about, counted(plan));
    let asked = page::batch::asked(plan, summary);
    for cycle in 0..comparison.cycles.len() {
        for ground in 0..comparison.grounds.len() {
            let place = [&comparison.cycles[cycle], &comparison.grounds[ground]].map(|one| one.name.as_str());
            let _ = writeln!(text, "  {}", place.join(", "));
            for cell in summary.cells.iter().filter(|cell| (cell.cycle, cell.ground) == (cycle, ground)) {
                let name = &comparison.variants[cell.variant].name;
                let values: Vec<String> = asked
                    .iter()
                    .take(IN_TEXT)
                    .filter_map(|index| told(plan, summary, cell, *index))
                    .collect();
                let short = if cell.unfinished > 0 {
                    format!("  {} without an end", cell.unfinished)
                } else {
                    String::new()
                };
                let _ = writeln!(text, "    {name:<14} {}{short}", values.join("  "));
            }
        }
    }
    let slowed = summary.cells.iter().filter_map(|cell| page::batch::much_short(plan, cell));
    let made_up = summary.cells.iter().filter_map(|cell| page::batch::much_made_up(plan, cell));
    let notes: Vec<String> = slowed.chain(made_up).collect();
    for note in notes.iter().take(MOST_NOTES) {
        let _ = writeln!(text, "  note     {note}");
    }
    let _ = writeln!(text, "  written  {}", output.told());
    let _ = writeln!(text, "open {}", Path::new(output.path()).join("report.html").display());
    text
}

/// `fuel 31.2 L (−5.4 ± 0.3 %)`
fn told(plan: &Plan, summary: &Summary, cell: &headland_batch::Cell, index: usize) -> Option<String> {
    let (value, against) = (&cell.measures[index], &cell.against[index]);
    if value.count == 0 {
        return None;
    }
    let (name, unit) = summary.measures[index].label(&plan.comparison.accounting);
    let difference = if against.count == 0 {
        String::new()
    } else if against.count > 1 {
        format!(" ({:+.1} ± {:.1} %)", 100.0 * against.mean, 100.0 * against.deviation())
    } else {
        format!(" ({:+.1} %)", 100.0 * against.mean)
    };
    Some(format!("{name} {} {unit}{difference}", short(value.mean)))
}

/// `3 variants × 2 cycles × 1 ground × 5 repetitions: 30 runs`
pub fn counted(plan: &Plan) -> String {
    let comparison = &plan.comparison;
    let points = usize::try_from(plan.points()).unwrap_or(usize::MAX);
    let times = usize::try_from(comparison.times).unwrap_or(usize::MAX);
    let parts: Vec<String> = [
        (comparison.variants.len(), "variant"),
        (comparison.cycles.len(), "cycle"),
        (comparison.grounds.len(), "ground"),
        (points, "point"),
        (times, "repetition"),
    ]
    .into_iter()
    .filter(|(count, what)| *count > 1 || ["variant", "cycle"].contains(what))
    .map(|(count, what)| format!("{count} {what}{}", if count == 1 { "" } else { "s" }))
    .collect();
    format!("{}: {} runs", parts.join(" × "), plan.total())
}
