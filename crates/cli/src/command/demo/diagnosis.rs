//! Ten coast-downs in a wind that nobody wrote down: the logs are made with it, the diagnosis is given a scenario without.

use crate::arguments::DemoOptions;
use crate::command::diagnose;
use crate::command::run::simulate_all;
use crate::embedded;
use crate::failure::Failure;
use crate::held;
use crate::output::Output;
use crate::page::short;
use crate::say::Say;
use crate::staged;
use headland_diagnose::Options;
use headland_plugin::Registry;
use headland_scenario::Scenario;

/// Logs what was driven, and asks what the scenario without it lacks.
pub fn forgotten_wind(
    registry: &Registry,
    options: &DemoOptions,
    seed: u64,
    say: Say,
) -> Result<(), Failure> {
    let mut output = Output::new(Some(&options.out), &options.out)?;
    let driven = Scenario::read(&embedded::write(&embedded::COAST_DOWN_IN_WIND, &mut output)?, registry)?;
    let path = embedded::write(&embedded::COAST_DOWN_CALM, &mut output)?;
    say.progress(&format!("simulating {} runs", driven.runs.len()));
    let described = staged::write(&driven, &simulate_all(&driven, registry)?.runs, seed, &mut output)?;
    let scenario = Scenario::read(&path, registry)?;
    let recording = held::read_recording(&described, say)?;
    let wanted = Options { seed, ..Options::default() };
    let found = diagnose::find(registry, (&scenario, &recording), &wanted, say)?;
    diagnose::write(&mut output, registry, &scenario, (&recording, &described), &found)?;
    let text = format!(
        "Driven: {}.\nLogged at 10 Hz with {} m/s of noise. Asked with: {}.\n\n{}open {}\n",
        driven.about,
        short(staged::NOISE_M_S),
        scenario.about,
        diagnose::told(&found, &output),
        output.path().join("report.html").display()
    );
    say.result(&text, &found.diagnosis)
}
