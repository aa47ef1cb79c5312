//! `headland demo`: built-in examples that need no file.
use crate::arguments::DemoOptions;
use crate::failure::Failure;
use crate::say::Say;
use headland_plugin::Registry;
/// Runs the command.
pub fn demo(_registry: &Registry, _options: &DemoOptions, _seed: u64, _say: &Say) -> Result<(), Failure> {
    Ok(())
}
