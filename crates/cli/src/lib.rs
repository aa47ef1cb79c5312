//! The program `headland` as a library: a program with models of its own hands over its registry and has the same
//! commands.
//!
//! ```no_run
//! fn main() -> std::process::ExitCode {
//!     let registry = headland_stock::registry();
//!     headland::run(&registry, std::env::args_os())
//! }
//! ```

mod arguments;
mod block;
mod command;
mod corrected;
mod embedded;
mod failure;
mod fitted;
mod held;
mod output;
mod pace;
mod page;
#[cfg(feature = "rerun")]
mod painted;
mod picture;
mod say;
#[cfg(feature = "rerun")]
mod scenery;
mod schema;
mod staged;
mod study_input;
mod validation;

pub use arguments::SchemaKind;
pub use schema::{schema, schema_of, snippets};

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use headland_plugin::Registry;
use say::Say;
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the program with the models of a registry.
pub fn run(registry: &Registry, arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are no mistakes; they go to standard output with status 0.
            let status = if error.use_stderr() { failure::INPUT } else { 0 };
            return match error.print() {
                Ok(()) => ExitCode::from(status),
                Err(_) => ExitCode::from(failure::MACHINE),
            };
        }
    };
    let say = Say::new(arguments.common.quiet, arguments.common.json);
    match begin(registry, &arguments, say) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            Say::failure(&failure);
            ExitCode::from(failure.status())
        }
    }
}

/// More threads than any machine of today has.
const MOST_THREADS: usize = 1024;

fn begin(registry: &Registry, arguments: &Arguments, say: Say) -> Result<(), Failure> {
    failure::listen_for_interruption()?;
    if let Some(threads) = arguments.common.threads {
        if threads.get() > MOST_THREADS {
            return Err(Failure::Input(format!("--threads is {threads}, expected at most {MOST_THREADS}")));
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .build_global()
            .map_err(|error| Failure::Machine(format!("cannot start {threads} threads: {error}")))?;
    }
    match &arguments.command {
        Command::Run(options) => command::run::run(registry, options, say),
        Command::Check(options) => command::check::check(registry, options, say),
        Command::Compare(options) => command::compare::compare(registry, options, say),
        Command::Calibrate(options) => command::calibrate::calibrate(registry, options, say),
        Command::Diagnose(options) => {
            command::diagnose::diagnose(registry, options, arguments.common.seed, say)
        }
        Command::Coastdown(options) => command::coastdown::coastdown(options, arguments.common.seed, say),
        Command::Batch(options) => command::batch::batch(registry, options, arguments.common.seed, say),
        Command::Optimum(options) => command::optimum::optimum(registry, options, say),
        Command::CvtMap(options) => command::cvt_map::run(options, say),
        Command::Terrain(options) => command::terrain::terrain(registry, options, say),
        Command::Demo(options) => command::demo::demo(registry, options, arguments.common.seed, say),
        Command::Validate(options) => {
            command::validate::validate(registry, options, arguments.common.seed, say)
        }
        Command::Schema(options) => command::schema::run(registry, options, say),
        Command::Plugins(options) => command::plugins::plugins(registry, options, say),
    }
}
