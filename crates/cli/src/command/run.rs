//! `headland run`: simulates a scenario.

use crate::arguments::RunOptions;
use crate::failure::{Failure, interrupted};
use crate::held;
use crate::output::Output;
use crate::page;
use crate::picture::{self, Drawn, Wanted};
use crate::say::Say;
use headland_plugin::Registry;
use headland_scenario::{Remark, RunSpec, Scenario};
use headland_sim::{Driven, End, Ledger, Outcome, speed_not_kept};
use headland_trace::Run;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt::Write;
use std::time::Instant;

/// `summary.json`.
#[derive(Debug, Serialize)]
pub struct Summary {
    schema: &'static str,
    about: String,
    runs: Vec<RunSummary>,
    remarks: Vec<String>,
}

/// One run of the summary.
#[derive(Debug, Serialize)]
pub struct RunSummary {
    id: String,
    end: End,
    duration_s: f64,
    distance_m: f64,
    initial_speed_m_s: f64,
    highest_speed_m_s: f64,
    steps: usize,
    energy: Ledger,
    relative_energy_residual: f64,
    /// When and where each phase began and ended, and what ended it.
    phases: Vec<Driven>,
}

/// A simulated scenario.
pub struct Simulated {
    /// Its runs, each with its name.
    pub runs: Vec<(String, Outcome)>,
    /// What is told of them.
    pub summary: Summary,
}

impl Simulated {
    /// The traces of all runs.
    pub fn traces(&self) -> Vec<Run> {
        self.runs.iter().map(|(id, outcome)| Run { id: id.clone(), trace: outcome.trace.clone() }).collect()
    }
}

/// Runs the command.
pub fn run(registry: &Registry, options: &RunOptions, say: Say) -> Result<(), Failure> {
    let pictures = Wanted::of(options.picture);
    pictures.possible()?;
    let scenario = Scenario::read(&options.scenario, registry)?;
    let mut output = Output::new(options.out.as_deref(), &options.scenario)?;
    let begin = Instant::now();
    let simulated = simulate_all(&scenario, registry)?;
    let took_ms = 1e3 * begin.elapsed().as_secs_f64();
    let traces = simulated.traces();
    output.traces("trace.parquet", &traces)?;
    output.json("summary.json", &simulated.summary)?;
    output.page("report.html", &page::run::page(&scenario, &simulated.runs, &simulated.summary.remarks)?)?;
    let drawn = Drawn { scenario: &scenario, registry, runs: &traces, pairs: &[] };
    let picture = picture::draw(pictures, &drawn, &mut output)?;
    say.result(&told(&scenario, &simulated.summary, took_ms, &output), &simulated.summary)?;
    picture.serve(say)?;
    if interrupted() {
        return Err(Failure::Interrupted);
    }
    match simulated.summary.runs.iter().find_map(stopped) {
        Some(reason) => Err(Failure::Requirement(reason)),
        None => Ok(()),
    }
}

/// Simulates every run of a scenario.
pub fn simulate_all(scenario: &Scenario, registry: &Registry) -> Result<Simulated, Failure> {
    if scenario.cycle.is_none() {
        return Err(Failure::Input(format!(
            "{} has no `cycle`, so there is nothing to simulate; `headland compare` replays a recording through it",
            scenario.document().path().display()
        )));
    }
    let plain = [RunSpec { id: "run".to_owned(), with: Vec::new() }];
    let specs = if scenario.runs.is_empty() { &plain[..] } else { &scenario.runs };
    let runs: Vec<(String, Outcome)> =
        held::finished(specs.par_iter().map(|spec| simulate_one(scenario, spec, registry)).collect())?;
    let summaries = runs.iter().map(|(id, outcome)| summary_of(id, outcome)).collect();
    let summary = Summary {
        schema: "headland.run/1",
        about: scenario.about.clone(),
        runs: summaries,
        remarks: scenario.remarks.iter().map(told_remark).collect(),
    };
    Ok(Simulated { runs, summary })
}

fn simulate_one(
    scenario: &Scenario,
    spec: &RunSpec,
    registry: &Registry,
) -> Result<(String, Outcome), Failure> {
    if interrupted() {
        return Err(Failure::Interrupted);
    }
    let scenario = scenario.run(spec, registry)?;
    let Some(cycle) = &scenario.cycle else {
        return Err(Failure::Input(format!("run {} has no cycle", spec.id)));
    };
    let outcome = scenario
        .fidelity
        .simulate_unless(&scenario.model(registry)?, cycle, &interrupted)
        .map_err(|error| Failure::Machine(error.to_string()))?;
    if !outcome.ledger.turnover_j().is_finite() {
        return Err(Failure::Input(format!(
            "run `{}`: its energies are no finite numbers; look at the parameters of {}",
            spec.id,
            scenario.document().path().display()
        )));
    }
    Ok((spec.id.clone(), outcome))
}

fn summary_of(id: &str, outcome: &Outcome) -> RunSummary {
    let series = |name: &str| outcome.trace.get(name).unwrap_or(&[]);
    let ends = |name: &str| match series(name) {
        [first, .., last] => last - first,
        _ => 0.0,
    };
    RunSummary {
        id: id.to_owned(),
        end: outcome.end.clone(),
        duration_s: outcome.trace.duration_s(),
        distance_m: ends("position_m"),
        initial_speed_m_s: series("speed_m_s").first().copied().unwrap_or(0.0),
        highest_speed_m_s: series("speed_m_s").iter().copied().map(f64::abs).fold(0.0, f64::max),
        steps: outcome.steps,
        relative_energy_residual: outcome.ledger.relative_residual(),
        energy: outcome.ledger.clone(),
        phases: outcome.phases.clone(),
    }
}

fn stopped(run: &RunSummary) -> Option<String> {
    match &run.end {
        // An interruption is told by how the program ends.
        End::Interrupted { .. } => None,
        End::Finished => speed_not_kept(&run.phases)
            .map(|told| format!("run `{}`: {told}; what was simulated is kept", run.id)),
        End::Stopped { time_s, position_m, reason } => Some(format!(
            "run `{}` could not be driven to its end: {reason} (at {time_s:.2} s and {position_m:.1} m); what was \
             simulated up to there is kept",
            run.id
        )),
    }
}

/// A ledger that stays open by more than this part of what moved is told.
const OPEN: f64 = 1e-3;
/// So many phases of a run that was slowed down are told; the summary has all.
const MOST_SLOWED: usize = 3;
/// A run that stopped in its first steps has moved nothing to speak of.
const FEW_STEPS: usize = 100;

/// A remark in one line.
pub fn told_remark(remark: &Remark) -> String {
    format!("{} ({})", remark.text, remark.at)
}

fn told(scenario: &Scenario, summary: &Summary, took_ms: f64, output: &Output) -> String {
    let steps: usize = summary.runs.iter().map(|run| run.steps).sum();
    let step_ms = 1e3 * scenario.cycle.as_ref().map_or(0.0, |cycle| cycle.step_s);
    let mut text = format!(
        "{}\n  {}, {step_ms} ms, {steps} steps in {took_ms:.1} ms\n",
        scenario.about,
        scenario.fidelity.told()
    );
    for run in &summary.runs {
        let name = if summary.runs.len() > 1 { format!("{:<10} ", run.id) } else { String::new() };
        let _ = writeln!(
            text,
            "  {name}{} after {:.2} s and {:.1} m, at most {:.1} km/h",
            match run.end {
                End::Finished => "finished",
                End::Stopped { .. } => "stopped",
                End::Interrupted { .. } => "interrupted",
            },
            run.duration_s,
            run.distance_m,
            3.6 * run.highest_speed_m_s
        );
        let _ = writeln!(
            text,
            "  {}energy   {}",
            if name.is_empty() { "" } else { "           " },
            told_energy(&run.energy)
        );
    }
    let open = |run: &&RunSummary| run.relative_energy_residual > OPEN && run.steps > FEW_STEPS;
    for run in summary.runs.iter().filter(open) {
        let _ = writeln!(
            text,
            "  note     the energies of run `{}` stay open by {:.0e} of what moved: a shorter `step_s` than {step_ms} ms may help",
            run.id, run.relative_energy_residual
        );
    }
    for run in &summary.runs {
        let slowed = run.phases.iter().filter(|driven| driven.may_slow_down).filter_map(Driven::told_short);
        for told in slowed.take(MOST_SLOWED) {
            let _ = writeln!(text, "  note     run `{}` was slowed down: {told}", run.id);
        }
    }
    for remark in &summary.remarks {
        let _ = writeln!(text, "  note     {remark}");
    }
    let _ = writeln!(text, "  written  {}", output.told());
    text
}

/// `fuel 3.2 MJ = kinetic −0.45 + soil 0.40 + … kJ`
fn told_energy(ledger: &Ledger) -> String {
    let (scale, unit) = if ledger.turnover_j() >= 1e7 { (1e6, "MJ") } else { (1e3, "kJ") };
    let mut given = Vec::new();
    let mut taken = Vec::new();
    let mut put = |name: &str, energy_j: f64| {
        let list = if energy_j < 0.0 { &mut given } else { &mut taken };
        if energy_j.abs() >= 5e-4 * ledger.turnover_j() {
            list.push(format!("{} {:.1}", name.replace('_', " "), energy_j.abs() / scale));
        }
    };
    put(&ledger.source_name, -ledger.source_j);
    put("kinetic", ledger.kinetic_j);
    for sink in &ledger.sinks {
        put(&sink.name, sink.energy_j);
    }
    format!(
        "{} = {} {unit}, residual {:.0e} of what moved",
        if given.is_empty() { "0".to_owned() } else { given.join(" + ") },
        if taken.is_empty() { "0".to_owned() } else { taken.join(" + ") },
        ledger.relative_residual()
    )
}
