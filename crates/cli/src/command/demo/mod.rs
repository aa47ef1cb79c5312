//! `headland demo`: built-in examples that need no file.

mod coast_down;
mod diagnosis;

use crate::arguments::DemoOptions;
use crate::command::batch;
use crate::embedded;
use crate::failure::Failure;
use crate::output::Output;
use crate::say::Say;
use headland_plugin::{Registry, closest};
use serde::Serialize;

/// Name and one line of each example.
const EXAMPLES: [(&str, &str); 3] = [
    ("coastdown", "simulate ten coast-downs, add sensor noise, analyse, compare, report"),
    ("batch", "three drivelines at the plough, on the road and through a mixed day, compared"),
    ("diagnosis", "ten coast-downs in a wind that the scenario does not know: find what was left out"),
];

#[derive(Debug, Serialize)]
struct Example {
    name: &'static str,
    about: &'static str,
}

/// Runs the command.
pub fn demo(registry: &Registry, options: &DemoOptions, seed: u64, say: Say) -> Result<(), Failure> {
    if options.list {
        let examples = EXAMPLES.map(|(name, about)| Example { name, about });
        let text = EXAMPLES.map(|(name, about)| format!("{name:<12} {about}")).join("\n");
        return say.result(&text, &examples);
    }
    let names = EXAMPLES.map(|(name, _)| name);
    if !names.contains(&options.name.as_str()) {
        let hint =
            closest(&options.name, &names).map_or(String::new(), |name| format!("; did you mean `{name}`?"));
        return Err(Failure::Input(format!(
            "no example is named `{}`{hint} known: {}",
            options.name,
            names.join(", ")
        )));
    }
    match options.name.as_str() {
        "batch" => three_drivelines(registry, options, seed, say),
        "diagnosis" => diagnosis::forgotten_wind(registry, options, seed, say),
        _ => coast_down::coast_down(registry, options, seed, say),
    }
}

fn three_drivelines(registry: &Registry, options: &DemoOptions, seed: u64, say: Say) -> Result<(), Failure> {
    let mut output = Output::new(Some(&options.out), &options.out)?;
    let path = embedded::write(&embedded::THREE_DRIVELINES, &mut output)?;
    let done = batch::run(
        registry,
        headland_batch::Comparison::read(&path)?,
        (false, false),
        &mut output,
        seed,
        say,
    )?;
    batch::finish(&done, &output, say)
}
