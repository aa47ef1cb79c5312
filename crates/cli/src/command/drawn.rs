//! Runs of a batch that are drawn beside one another.

use crate::failure::Failure;
use crate::picture::Chosen;
use headland_batch::{Plan, Spec, run};
use headland_plugin::Registry;
use headland_scenario::Scenario;
use headland_trace::Run;

/// Runs that are drawn where none is named.
const DRAWN: usize = 6;

/// The numbers of the runs to draw: those that were asked for, else the first of every variant.
///
/// # Errors
/// [`Failure::Input`] where a number is that of no run, or stands twice.
pub fn numbers(plan: &Plan, asked: &[u64]) -> Result<Vec<u64>, Failure> {
    for (index, number) in asked.iter().enumerate() {
        if *number >= plan.total() {
            let last = plan.total().saturating_sub(1);
            return Err(Failure::Input(format!(
                "--drawn {number}: there is no such run, expected 0 to {last}"
            )));
        }
        if asked[..index].contains(number) {
            return Err(Failure::Input(format!("--drawn {number} stands twice")));
        }
    }
    if !asked.is_empty() {
        return Ok(asked.to_vec());
    }
    Ok((0..plan.comparison.variants.len()).filter_map(|variant| first(plan, variant)).take(DRAWN).collect())
}

/// The first run of a variant, in the first cycle and on the first ground that it can be put together with.
fn first(plan: &Plan, variant: usize) -> Option<u64> {
    let (cycles, grounds) = (plan.comparison.cycles.len(), plan.comparison.grounds.len());
    (0..cycles)
        .flat_map(|cycle| (0..grounds).map(move |ground| (cycle, ground)))
        .map(|(cycle, ground)| Spec { number: 0, variant, cycle, ground, point: 0, repetition: 0 })
        .find(|spec| plan.is_possible(*spec))
        .map(|spec| plan.number(spec))
}

/// Simulates the runs again, which gives the same bits, with all their channels.
///
/// # Errors
/// [`Failure::Requirement`] where one of them has no trace.
pub fn chosen(plan: &Plan, registry: &Registry, numbers: &[u64]) -> Result<Chosen, Failure> {
    let specs: Vec<Spec> = numbers.iter().map(|number| plan.spec(*number)).collect();
    let (mut scenarios, mut runs) = (Vec::with_capacity(specs.len()), Vec::with_capacity(specs.len()));
    for spec in &specs {
        let (row, trace) = run(plan, registry, spec.number);
        let Some(trace) = trace else {
            let run = plan.called(*spec);
            return Err(Failure::Requirement(format!("{run} cannot be drawn: {}", row.error)));
        };
        let (scenario, _) = Scenario::with_model(plan.document(*spec)?, registry)?;
        scenarios.push(scenario);
        runs.push(Run { id: name(plan, &specs, *spec), trace });
    }
    Ok(Chosen { title: plan.comparison.about.clone(), scenarios, runs })
}

/// Its variant, with all that tells it from the others.
fn name(plan: &Plan, all: &[Spec], spec: Spec) -> String {
    let comparison = &plan.comparison;
    let differs = |of: &dyn Fn(&Spec) -> u64| all.iter().any(|other| of(other) != of(&spec));
    let mut parts = vec![comparison.variants[spec.variant].name.clone()];
    if differs(&|one| one.cycle as u64) {
        parts.push(comparison.cycles[spec.cycle].name.clone());
    }
    if differs(&|one| one.ground as u64) {
        parts.push(comparison.grounds[spec.ground].name.clone());
    }
    if differs(&|one| one.point) || differs(&|one| u64::from(one.repetition)) {
        parts.push(format!("run {}", spec.number));
    }
    parts.join(", ")
}
