//! `headland validate`: makes `docs/validation.md` from the recordings.

use crate::arguments::ValidateOptions;
use crate::failure::Failure;
use crate::output::{must_be_writable, write_whole};
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
    // The fits take minutes.
    must_be_writable(&options.out)?;
    let text = validation::page(registry, &options.scenarios, (&options.beside, &options.out), seed, say)?;
    write_whole(&options.out, &text)?;
    let file = options.out.display().to_string();
    let told = format!("written  {file}");
    say.result(&told, &Written { file, lines: text.lines().count() })
}
