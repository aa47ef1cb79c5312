//! What can be asked on the command line.

use clap::{Args, Parser, Subcommand};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Simulates what an off-road vehicle does in a day's work, holds it against recordings, and finds what was left out.
#[derive(Debug, Parser)]
#[command(name = "headland", version, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// Options of every command.
#[derive(Args, Debug)]
pub struct Common {
    /// Print the result as one JSON document
    #[arg(long, global = true)]
    pub json: bool,
    /// Show no progress
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Number of threads; results do not depend on it
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a scenario
    Run(RunOptions),
    /// Read and check scenarios and recording descriptions without running them
    Check(CheckOptions),
    /// List the models that scenarios can name, with their parameters, equations and sources
    Plugins(PluginsOptions),
}

/// Options of `headland run`.
#[derive(Args, Debug)]
pub struct RunOptions {
    /// The scenario
    #[arg(value_name = "SCENARIO.ron")]
    pub scenario: PathBuf,
    /// Where results are put
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write `run.rrd` for the Rerun viewer as well
    #[arg(long)]
    pub rerun: bool,
    /// Open the Rerun viewer
    #[arg(long)]
    pub view: bool,
}

/// Options of `headland check`.
#[derive(Args, Debug)]
pub struct CheckOptions {
    /// Scenarios and recording descriptions
    #[arg(value_name = "FILE.ron", required = true)]
    pub files: Vec<PathBuf>,
}

/// Options of `headland plugins`.
#[derive(Args, Debug)]
pub struct PluginsOptions {
    /// `soil`, `terrain`, `driveline`, `task`, `effect`, or the name of a model
    #[arg(value_name = "KIND")]
    pub kind: Option<String>,
}
