//! Goes through the cases of a folder, one after the other, and leaves alone what was diagnosed before.

use super::diagnosis::Diagnosis;
use super::judge::{Outcome, judge};
use crate::error::ConcealError;
use crate::truth::Truth;
use headland_trace::read_parquet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// What to do.
#[derive(Clone, Debug)]
pub struct Options {
    /// The program under test.
    pub program: PathBuf,
    /// Whether the true causes are taken out of its library.
    pub without_truth: bool,
    /// Whether cases without a diagnosis are diagnosed.
    pub run: bool,
}

/// A case with its score.
#[derive(Clone, Debug)]
pub struct Scored {
    /// Name of its folder.
    pub name: String,
    /// What it conceals.
    pub truth: Truth,
    /// What became of it; the text says why there is no diagnosis.
    pub outcome: Result<Outcome, String>,
}

/// Scores every case of a folder.
///
/// # Errors
/// [`ConcealError`] where there are no cases, a truth cannot be read, or the program cannot be started. A diagnosis that
/// fails is part of the score.
pub fn all(
    folder: &Path,
    options: &Options,
    mut progress: impl FnMut(&str),
) -> Result<Vec<Scored>, ConcealError> {
    let listing =
        std::fs::read_dir(folder).map_err(|source| ConcealError::File { path: folder.to_owned(), source })?;
    let mut cases: Vec<PathBuf> = listing
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.join("truth.json").is_file())
        .collect();
    cases.sort();
    if cases.is_empty() {
        return Err(ConcealError::NoCase { folder: folder.to_owned() });
    }
    let mut scored = Vec::new();
    for case in cases {
        let name = case.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let truth = Truth::read(&case)?;
        if options.without_truth
            && truth.hidden.iter().all(|cause| cause.class != "physics" || cause.id == "unlisted")
        {
            continue;
        }
        let out = case.join(if options.without_truth { "out_without" } else { "out" });
        let begun = Instant::now();
        if options.run && !out.join("diagnosis.json").is_file() {
            diagnose(&case, &out, &truth, options)?;
            progress(&format!("{name}  {:.1} s", begun.elapsed().as_secs_f64()));
        }
        let outcome = outcome(&case, &out, &truth);
        scored.push(Scored { name, truth, outcome });
    }
    Ok(scored)
}

/// Runs the program on scenario and recording; what it says goes to `log.txt`.
fn diagnose(case: &Path, out: &Path, truth: &Truth, options: &Options) -> Result<(), ConcealError> {
    let file_error = |source| ConcealError::File { path: out.to_owned(), source };
    std::fs::create_dir_all(out).map_err(file_error)?;
    let mut command = Command::new(&options.program);
    command.arg("diagnose").arg(case.join("scenario.ron"));
    command.arg("--recording").arg(case.join("recording.ron"));
    command.arg("--out").arg(out).arg("--quiet");
    if options.without_truth {
        for cause in truth.hidden.iter().filter(|cause| cause.class == "physics") {
            command.arg("--without").arg(&cause.id);
        }
    }
    let said = command
        .stdin(Stdio::null())
        .output()
        .map_err(|source| ConcealError::Program { program: options.program.clone(), source })?;
    let log = [said.stdout, said.stderr, format!("{}\n", said.status).into_bytes()].concat();
    std::fs::write(out.join("log.txt"), log).map_err(file_error)
}

fn outcome(case: &Path, out: &Path, truth: &Truth) -> Result<Outcome, String> {
    let path = out.join("diagnosis.json");
    if !path.is_file() {
        let log = std::fs::read_to_string(out.join("log.txt")).unwrap_or_default();
        let line = log.lines().find(|line| !line.trim().is_empty()).unwrap_or("not run").to_owned();
        return Err(line);
    }
    let diagnosis = Diagnosis::read(&path).map_err(|error| error.to_string())?;
    let along = read_parquet(&case.join("truth.parquet")).map_err(|error| error.to_string())?;
    let effects = out.join("effects.parquet");
    let effects = if effects.is_file() {
        read_parquet(&effects).map_err(|error| error.to_string())?
    } else {
        Vec::new()
    };
    Ok(judge(truth, &diagnosis, &along, &effects))
}
