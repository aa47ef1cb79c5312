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
    /// Seed of everything that is drawn at random; the same seed gives the same result
    #[arg(long, global = true, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a scenario
    Run(RunOptions),
    /// Read and check scenarios and recording descriptions without running them
    Check(CheckOptions),
    /// Drive a scenario with a recording and compare the two
    Compare(CompareOptions),
    /// Fit the free parameters of a scenario to a recording
    Calibrate(CalibrateOptions),
    /// Find the physics that a scenario left out
    Diagnose(DiagnoseOptions),
    /// Rolling resistance and road loads from coast-downs
    Coastdown(CoastdownOptions),
    /// Run many variants, cycles and grounds and compare them
    Batch(BatchOptions),
    /// Measure the management of a hybrid against the course of least fuel
    Optimum(OptimumOptions),
    /// Make the map of engine speeds of a `MappedCvt` from a recording
    CvtMap(CvtMapOptions),
    /// Draw the ground of a scenario and the path over it
    Terrain(TerrainOptions),
    /// A built-in example that needs no file
    Demo(DemoOptions),
    /// Make `docs/validation.md` from the published recordings
    #[command(hide = true)]
    Validate(ValidateOptions),
    /// List the models that scenarios can name, with their parameters, equations and sources
    Plugins(PluginsOptions),
    /// Print what files look like, for editors: a JSON schema, or snippets
    Schema(SchemaOptions),
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
    /// Pictures
    #[command(flatten)]
    pub picture: RerunOptions,
}

/// Whether and how runs are drawn by Rerun.
#[derive(Args, Clone, Copy, Debug)]
pub struct RerunOptions {
    /// Write a file for the Rerun viewer as well: `run.rrd`, `diagnosis.rrd` or `batch.rrd`
    #[arg(long)]
    pub rerun: bool,
    /// Open the Rerun viewer
    #[arg(long)]
    pub view: bool,
    /// Serve the Rerun viewer to browsers on this machine, until it is interrupted
    #[arg(long)]
    pub serve: bool,
}

/// A scenario and the recording that it is held against.
#[derive(Args, Debug)]
pub struct HeldOptions {
    /// The scenario
    #[arg(value_name = "SCENARIO.ron")]
    pub scenario: PathBuf,
    /// Description of the recording
    #[arg(long, value_name = "RECORDING.ron")]
    pub recording: PathBuf,
    /// Where results are put
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Options of `headland compare`.
#[derive(Args, Debug)]
pub struct CompareOptions {
    /// What is compared with what
    #[command(flatten)]
    pub held: HeldOptions,
    /// What has to hold in every run, as in "speed_m_s rmse < 0.2 m/s"; repeatable
    #[arg(long, value_name = "REQUIREMENT")]
    pub require: Vec<String>,
    /// Pictures
    #[command(flatten)]
    pub picture: RerunOptions,
}

/// Options of `headland calibrate`.
#[derive(Args, Debug)]
pub struct CalibrateOptions {
    /// What is fitted to what
    #[command(flatten)]
    pub held: HeldOptions,
}

/// Options of `headland diagnose`.
#[derive(Args, Debug)]
pub struct DiagnoseOptions {
    /// What is held against what
    #[command(flatten)]
    pub held: HeldOptions,
    /// Leave a cause out of the library, as in `--without wind`: and if it is not the wind? An effect that `headland plugins` lists, `grade`
    /// and the like, `unlisted`, or a sensor's fault such as `latency` (all in docs/diagnosis.md). Repeatable
    #[arg(long, value_name = "ID")]
    pub without: Vec<String>,
    /// Try just this cause, an effect or a sensor's fault, and no other; repeatable
    #[arg(long, value_name = "ID")]
    pub only: Vec<String>,
    /// Pictures
    #[command(flatten)]
    pub picture: RerunOptions,
}

/// Options of `headland coastdown`.
#[derive(Args, Debug)]
pub struct CoastdownOptions {
    /// Description of the recording
    #[arg(value_name = "RECORDING.ron")]
    pub recording: PathBuf,
    /// Where results are put
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// What the recording does not know, as in `mass_kg=13019.3` or `mass_kg=13.02t+-65kg`; repeatable
    #[arg(long, value_name = "NAME=VALUE")]
    pub known: Vec<String>,
    /// Unit of v in `c_w` (1 + v/100): `km/h`, `mph` or `m/s`
    #[arg(long, value_name = "UNIT")]
    pub speed_unit: Option<String>,
    /// Samples slower than this are left out, m/s
    #[arg(long, value_name = "SPEED")]
    pub lowest_speed: Option<f64>,
}

/// Options of `headland batch`.
#[derive(Args, Debug)]
pub struct BatchOptions {
    /// The comparison
    #[arg(value_name = "COMPARISON.ron")]
    pub comparison: PathBuf,
    /// Where results are put; a batch that was interrupted there goes on
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Keep the trace of every run, in a folder a run
    #[arg(long)]
    pub traces: bool,
    /// Throw away what is finished in the folder and begin again
    #[arg(long)]
    pub anew: bool,
    /// Draw this run, by its number in `results.parquet`; repeatable. Without it the first of every variant is drawn
    #[arg(long, value_name = "NUMBER")]
    pub drawn: Vec<u64>,
    /// Pictures
    #[command(flatten)]
    pub picture: RerunOptions,
}

/// Options of `headland optimum`.
#[derive(Args, Debug)]
pub struct OptimumOptions {
    /// The scenario, of a vehicle with a `management`
    #[arg(value_name = "SCENARIO.ron")]
    pub scenario: PathBuf,
    /// Where results are put
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Length of the steps in which power is shared, s
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0)]
    pub step: f64,
    /// Charges of the grid
    #[arg(long, value_name = "N", default_value_t = 641)]
    pub charges: usize,
    /// Powers of the engine that are tried in every step
    #[arg(long, value_name = "N", default_value_t = 40)]
    pub levels: usize,
}

/// Options of `headland cvt-map`.
#[derive(Args, Debug)]
pub struct CvtMapOptions {
    /// Description of the recording
    #[arg(value_name = "RECORDING.ron")]
    pub recording: PathBuf,
    /// The map, for a scenario to include
    #[arg(long, value_name = "FILE.ron")]
    pub out: PathBuf,
    /// Speeds of the map
    #[arg(long, value_name = "N", default_value_t = 12)]
    pub speeds: usize,
    /// Forces of the map
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub forces: usize,
    /// Samples that a node needs within half a cell
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub least_samples: usize,
    /// Samples slower than this are left out, m/s
    #[arg(long, value_name = "SPEED", default_value_t = 0.3)]
    pub lowest_speed: f64,
    /// Engine to wheels, where the force comes from the engine's torque
    #[arg(long, value_name = "SHARE", default_value_t = 0.88)]
    pub efficiency: f64,
    /// Torque that the transmission takes without load, N m, where the force comes from the engine's torque
    #[arg(long, value_name = "TORQUE", default_value_t = 0.0)]
    pub idle_torque: f64,
    /// Torque that the shares `actual_torque` and `friction_torque` are of, N m
    #[arg(long, value_name = "TORQUE")]
    pub reference_torque: Option<f64>,
}

/// Options of `headland terrain`.
#[derive(Args, Debug)]
pub struct TerrainOptions {
    /// The scenario
    #[arg(value_name = "SCENARIO.ron")]
    pub scenario: PathBuf,
    /// The picture, an SVG
    #[arg(long, value_name = "FILE.svg")]
    pub picture: Option<PathBuf>,
}

/// Options of `headland demo`.
#[derive(Args, Debug)]
pub struct DemoOptions {
    /// `coastdown`: simulate ten coast-downs, add sensor noise, analyse, compare, report; `batch`: compare three drivelines;
    /// `diagnosis`: find the wind that a scenario of ten coast-downs does not know
    #[arg(value_name = "NAME", default_value = "coastdown")]
    pub name: String,
    /// List the examples
    #[arg(long)]
    pub list: bool,
    /// Where results are put
    #[arg(long, value_name = "DIR", default_value = "out/demo")]
    pub out: PathBuf,
}

/// Options of `headland validate`.
#[derive(Args, Debug)]
pub struct ValidateOptions {
    /// Folder of the scenarios, with `recordings/` in it
    #[arg(long, value_name = "DIR", default_value = "scenarios")]
    pub scenarios: PathBuf,
    /// The page
    #[arg(long, value_name = "FILE", default_value = "docs/validation.md")]
    pub out: PathBuf,
    /// A page of a comparison with another program, taken in at the end; once for each
    #[arg(long, value_name = "PAGE.md")]
    pub beside: Vec<PathBuf>,
}

/// Options of `headland check`.
#[derive(Args, Debug)]
pub struct CheckOptions {
    /// Scenarios, comparisons and recording descriptions; one scenario and one recording are held together as well: which
    /// balances they make, and which runs a diagnosis would hold out
    #[arg(value_name = "FILE.ron", required = true)]
    pub files: Vec<PathBuf>,
}

/// Options of `headland schema`.
#[derive(Args, Debug)]
pub struct SchemaOptions {
    /// Files of which kind
    #[arg(value_enum, value_name = "KIND", default_value_t = SchemaKind::Scenario)]
    pub kind: SchemaKind,
    /// Snippets in the format of Visual Studio Code instead
    #[arg(long)]
    pub snippets: bool,
}

/// A kind of files that a schema tells of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SchemaKind {
    /// What is driven, over what and how
    Scenario,
    /// Variants through cycles on grounds, for `headland batch`
    Comparison,
    /// The description of a log, `recording.ron`
    Recording,
}

/// Options of `headland plugins`.
#[derive(Args, Debug)]
pub struct PluginsOptions {
    /// `soil`, `terrain`, `driveline`, `task`, `effect`, or the name of a model
    #[arg(value_name = "KIND")]
    pub kind: Option<String>,
}
