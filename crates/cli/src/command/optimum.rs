//! `headland optimum`: a management measured against the course of least fuel, which knows what comes.

use super::run::simulate_all;
use crate::arguments::OptimumOptions;
use crate::failure::Failure;
use crate::output::Output;
use crate::page;
use crate::say::Say;
use headland_management::{Demanded, Fineness, Sharing};
use headland_plugin::{Registry, Share};
use headland_scenario::{RunSpec, Scenario};
use headland_sim::{End, Outcome, demands};
use headland_trace::{Origin, Run, Trace};
use serde::Serialize;
use std::fmt::Write;

/// `summary.json`.
#[derive(Debug, Serialize)]
pub struct Summary {
    schema: &'static str,
    about: String,
    step_s: f64,
    runs: Vec<Measured>,
}

/// A run, as its management shared the power and as dynamic programming would have.
#[derive(Debug, Serialize)]
pub struct Measured {
    /// Its name.
    pub id: String,
    /// Steps of the course.
    pub steps: usize,
    /// Fuel of the simulation, with its own step [J].
    pub simulated_fuel_j: f64,
    /// Charge at the end of the simulation.
    pub simulated_charge: f64,
    /// Fuel of the management on the course [J].
    pub fuel_j: f64,
    /// The least fuel that ends at the same charge [J].
    pub least_fuel_j: f64,
    /// What the management takes beyond the least, as a share of it.
    pub above_least: f64,
    /// Energy that the wheels got less than was asked: with the management, and with the least fuel [J].
    pub short_j: (f64, f64),
    /// Charge at the start, at the end, and at the end of the course of least fuel.
    pub charges: (f64, f64, f64),
    /// Energy that the store gained with the management [J].
    pub gained_j: f64,
}

/// A run that was measured, with its courses.
pub struct Courses {
    /// What is told of it.
    pub measured: Measured,
    /// Charge and power of the engine, as they were managed and with least fuel.
    pub trace: Trace,
}

/// Runs the command.
pub fn optimum(registry: &Registry, options: &OptimumOptions, say: Say) -> Result<(), Failure> {
    hold(options)?;
    let scenario = Scenario::read(&options.scenario, registry)?;
    if scenario.document().find("vehicle.management").is_none() {
        return Err(Failure::Input(format!(
            "{} has no `vehicle.management`, so nobody shares power between an engine and a second store; expected a hybrid",
            options.scenario.display()
        )));
    }
    let mut output = Output::new(options.out.as_deref(), &options.scenario)?;
    let simulated = simulate_all(&scenario, registry)?;
    let mut all = Vec::new();
    for (id, outcome) in &simulated.runs {
        if let End::Stopped { time_s, reason, .. } = &outcome.end {
            return Err(Failure::Requirement(format!(
                "run `{id}` could not be driven to its end: {reason} (at {time_s:.2} s); an optimum of a part compares with \
                 nothing"
            )));
        }
        let spec = scenario.runs.iter().find(|spec| spec.id == *id);
        all.push(measured(&scenario, spec, registry, (id, outcome), options, say)?);
    }
    let traces: Vec<Run> =
        all.iter().map(|one| Run { id: one.measured.id.clone(), trace: one.trace.clone() }).collect();
    output.traces("optimum.parquet", &traces)?;
    output.page("report.html", &page::optimum::page(&scenario, &all, options.step))?;
    let summary = Summary {
        schema: "headland.optimum/1",
        about: scenario.about.clone(),
        step_s: options.step,
        runs: all.into_iter().map(|one| one.measured).collect(),
    };
    output.json("summary.json", &summary)?;
    say.result(&told(&summary, &output), &summary)
}

/// Refuses what no grid can be made of.
fn hold(options: &OptimumOptions) -> Result<(), Failure> {
    let refuse = |name: &str, found: String, expected: &str| {
        Err(Failure::Input(format!("--{name} is {found}, expected {expected}")))
    };
    if !(options.step.is_finite() && options.step > 0.0) {
        return refuse("step", options.step.to_string(), "seconds, more than 0");
    }
    if options.charges < 3 {
        return refuse("charges", options.charges.to_string(), "3 or more");
    }
    if options.levels < 1 {
        return refuse("levels", options.levels.to_string(), "1 or more");
    }
    Ok(())
}

fn measured(
    scenario: &Scenario,
    spec: Option<&RunSpec>,
    registry: &Registry,
    (id, outcome): (&str, &Outcome),
    options: &OptimumOptions,
    say: Say,
) -> Result<Courses, Failure> {
    let model = match spec {
        Some(spec) => scenario.run(spec, registry)?.model(registry)?,
        None => scenario.model(registry)?,
    };
    let demands = demands(&outcome.trace, options.step);
    let input = |error: &dyn std::fmt::Display| Failure::Input(format!("run `{id}`: {error}"));
    let demanded = Demanded::new(&*model.driveline, &demands, options.step).map_err(|error| input(&error))?;
    say.progress(&format!(
        "run `{id}`: {} steps, {} charges, {} powers of the engine",
        demands.len(),
        options.charges,
        options.levels
    ));
    let fineness = Fineness { charges: options.charges, levels: options.levels };
    let least = demanded.least(fineness).map_err(|error| input(&error))?;
    let managed = &demanded.managed;
    let end = |charges: &[f64]| charges.last().copied().unwrap_or(f64::NAN);
    let measured = Measured {
        id: id.to_owned(),
        steps: demands.len(),
        simulated_fuel_j: outcome.ledger.source_j,
        simulated_charge: end(outcome.trace.get("state_of_charge").unwrap_or(&[])),
        fuel_j: managed.fuel_j,
        least_fuel_j: least.fuel_j,
        above_least: managed.fuel_j / least.fuel_j - 1.0,
        short_j: (managed.short_j, least.short_j),
        charges: (managed.charges[0], end(&managed.charges), end(&least.charges)),
        gained_j: demanded.gained_j(),
    };
    Ok(Courses { trace: trace(&demanded, &least, options.step)?, measured })
}

/// Both courses, a sample at the begin of every step.
fn trace(demanded: &Demanded<'_>, least: &Sharing, step_s: f64) -> Result<Trace, Failure> {
    let managed = &demanded.managed;
    let steps = managed.shares.len();
    let power = |shares: &[Share]| -> Vec<f64> {
        shares.iter().map(|share| if share.engine_runs { share.engine_w } else { 0.0 }).collect()
    };
    let mut trace = Trace::new((0..steps).map(|step| step_s * step as f64).collect())?;
    for (name, values) in [
        ("state_of_charge", managed.charges[..steps].to_vec()),
        ("least_state_of_charge", least.charges[..steps].to_vec()),
        ("engine_power_w", power(&managed.shares)),
        ("least_engine_power_w", power(&least.shares)),
    ] {
        trace.push(name, values, Origin::Predicted)?;
    }
    Ok(trace)
}

fn told(summary: &Summary, output: &Output) -> String {
    let mut text = format!("{}\n", summary.about);
    for run in &summary.runs {
        let name = if summary.runs.len() > 1 { format!("{:<10} ", run.id) } else { String::new() };
        let _ = writeln!(
            text,
            "  {name}fuel {:.2} MJ, the least that ends at the same charge {:.2} MJ: {:+.1} %",
            run.fuel_j / 1e6,
            run.least_fuel_j / 1e6,
            100.0 * run.above_least
        );
        let (start, end, _) = run.charges;
        let _ = writeln!(text, "  {name}charge {:.1} % to {:.1} %", 100.0 * start, 100.0 * end);
        let _ = writeln!(
            text,
            "  {name}simulated with its own step: fuel {:.2} MJ, charge to {:.1} %",
            run.simulated_fuel_j / 1e6,
            100.0 * run.simulated_charge
        );
    }
    let _ = writeln!(text, "  written  {}", output.told());
    text
}
