//! `headland validate`: makes `docs/validation.md` from the recordings.

use crate::arguments::ValidateOptions;
use crate::failure::Failure;
use crate::say::Say;
use crate::validation;
use headland_plugin::Registry;
use serde::Serialize;

#[derive(Debug, Serialize)]
struct Written {
    file: String,
    lines: usize,
}

/// Runs the command.
pub fn validate(registry: &Registry, options: &ValidateOptions, seed: u64, say: Say) -> Result<(), Failure> {
    let text = validation::page(registry, &options.scenarios, (&options.beside, &options.out), seed, say)?;
    std::fs::write(&options.out, &text).map_err(|error| Failure::unwritable(&options.out, &error))?;
    let file = options.out.display().to_string();
    let told = format!("written  {file}");
    say.result(&told, &Written { file, lines: text.lines().count() })
}
