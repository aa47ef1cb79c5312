//! The program `conceal`: makes concealed cases, and scores a diagnosis on them.

use clap::{Parser, Subcommand};
use headland_conceal::{ConcealError, Probe, generate, real, score};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Parser)]
#[command(name = "conceal", about = "Makes recordings with concealed causes, and scores a diagnosis on them")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Make cases: a folder each, with scenario, recording and truth
    Generate {
        /// How many
        #[arg(long, default_value_t = 60)]
        cases: usize,
        /// Seed of the set
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Number of the first case
        #[arg(long, default_value_t = 0)]
        first: usize,
        /// State every nominal parameter as it is: to test the plant, not a diagnosis
        #[arg(long)]
        exact: bool,
        /// That, and sensors without noise: what is left is how plant and model differ
        #[arg(long)]
        noiseless: bool,
        /// Where the cases are put
        #[arg(long)]
        out: PathBuf,
    },
    /// Write what a nominal model leaves over in each case of a set as a table, for other programs
    Table {
        /// How many
        #[arg(long, default_value_t = 60)]
        cases: usize,
        /// Seed of the set
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Number of the first case
        #[arg(long, default_value_t = 0)]
        first: usize,
        /// Where the tables are put
        #[arg(long)]
        out: PathBuf,
    },
    /// Diagnose every case that has no diagnosis yet, and write the score
    Score {
        /// The cases
        folder: PathBuf,
        /// The program under test
        #[arg(long, default_value = "target/release/headland")]
        program: PathBuf,
        /// Leave the true cause out of the library: what is claimed instead?
        #[arg(long)]
        without_truth: bool,
        /// How many cases at a time, each with one thread
        #[arg(long, default_value_t = 2)]
        jobs: usize,
        /// Stop a diagnosis after this many seconds
        #[arg(long, default_value_t = 1800.0)]
        limit_s: f64,
        /// Score what is there and run nothing
        #[arg(long)]
        no_run: bool,
        /// The table, as Markdown
        #[arg(long)]
        markdown: Option<PathBuf>,
    },
    /// Diagnose recordings of real vehicles, and hold the answers against the channels that were withheld
    Real {
        /// The program under test
        #[arg(long, default_value = "target/release/headland")]
        program: PathBuf,
        /// The recordings [default: what HEADLAND_RECORDINGS names, else ../shared/recordings]
        #[arg(long)]
        recordings: Option<PathBuf>,
        /// The scenarios of the project
        #[arg(long, default_value = "scenarios")]
        scenarios: PathBuf,
        /// The one set of recordings to do
        #[arg(long)]
        only: Option<String>,
        /// Longest time for one diagnosis, in seconds
        #[arg(long, default_value_t = 1800.0)]
        limit_s: f64,
        /// Where inputs and answers are put
        #[arg(long, default_value = "out/real")]
        scratch: PathBuf,
        /// The table, as Markdown
        #[arg(long)]
        markdown: Option<PathBuf>,
    },
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: Arguments) -> Result<(), ConcealError> {
    let mut out = std::io::stdout();
    match arguments.task {
        Task::Generate { cases, seed, first, exact, noiseless, out: folder } => {
            let probe = match (noiseless, exact) {
                (true, _) => Probe::Noiseless,
                (false, true) => Probe::Exact,
                (false, false) => Probe::No,
            };
            for case in first..first + cases {
                let made = generate(seed, case, probe)?;
                made.write(&folder.join(format!("case_{case:03}")))?;
                let hidden: Vec<String> = made
                    .truth
                    .hidden
                    .iter()
                    .map(|cause| format!("{} ({:.1} × noise)", cause.law, cause.strength))
                    .collect();
                let _ = writeln!(
                    out,
                    "case {case:03}  {:9}  {:8}  {}",
                    made.truth.family,
                    made.truth.kind,
                    hidden.join(", ")
                );
            }
        }
        Task::Table { cases, seed, first, out: folder } => {
            for case in first..first + cases {
                headland_conceal::table::export(seed, case, &folder)?;
            }
        }
        Task::Score { folder, program, without_truth, jobs, limit_s, no_run, markdown } => {
            let options = score::Options { program, without_truth, run: !no_run, jobs, limit_s };
            let progress = |line: &str| {
                let _ = writeln!(std::io::stderr(), "{line}");
            };
            let scored = score::all(&folder, &options, progress)?;
            let page = score::page(&scored, &options);
            if let Some(path) = markdown {
                std::fs::write(&path, &page).map_err(|source| ConcealError::File { path, source })?;
            }
            let _ = writeln!(out, "{page}");
        }
        Task::Real { program, recordings, scenarios, only, limit_s, scratch, markdown } => {
            let named = || std::env::var_os("HEADLAND_RECORDINGS").map(PathBuf::from);
            let recordings = recordings.or_else(named).unwrap_or_else(|| "../shared/recordings".into());
            prove(&real::Options { program, recordings, scenarios, scratch, only, limit_s }, markdown)?;
        }
    }
    Ok(())
}

fn prove(options: &real::Options, markdown: Option<PathBuf>) -> Result<(), ConcealError> {
    let absolute = |path: &Path| {
        std::path::absolute(path).map_err(|source| ConcealError::File { path: path.to_owned(), source })
    };
    let options = real::Options {
        recordings: absolute(&options.recordings)?,
        scenarios: absolute(&options.scenarios)?,
        scratch: absolute(&options.scratch)?,
        ..options.clone()
    };
    if !options.recordings.is_dir() {
        let _ = writeln!(std::io::stderr(), "skipped: no recordings at {}", options.recordings.display());
        return Ok(());
    }
    let rows = real::all(&options, |line| {
        let _ = writeln!(std::io::stderr(), "{line}");
    })?;
    let page = real::page(&rows);
    if let Some(path) = markdown {
        std::fs::write(&path, &page).map_err(|source| ConcealError::File { path, source })?;
    }
    let _ = writeln!(std::io::stdout(), "{page}");
    Ok(())
}
