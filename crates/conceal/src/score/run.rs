//! Goes through the cases of a folder, several at a time, and leaves alone what was diagnosed before.

use super::diagnosis::Diagnosis;
use super::judge::{Outcome, judge};
use crate::error::ConcealError;
use crate::truth::Truth;
use headland_trace::read_parquet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// What to do.
#[derive(Clone, Debug)]
pub struct Options {
    /// The program under test.
    pub program: PathBuf,
    /// Whether the true causes are taken out of its library.
    pub without_truth: bool,
    /// Whether cases without a diagnosis are diagnosed.
    pub run: bool,
    /// How many cases are diagnosed at a time, each by one thread.
    pub jobs: usize,
    /// Time after which a diagnosis is stopped and counts as none [s].
    pub limit_s: f64,
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
    /// How long the diagnosis took [s].
    pub seconds: Option<f64>,
}

/// Scores every case of a folder.
///
/// # Errors
/// [`ConcealError`] where there are no cases, a truth cannot be read, or the program cannot be started. A diagnosis that
/// fails is part of the score.
pub fn all(
    folder: &Path,
    options: &Options,
    progress: impl Fn(&str) + Sync,
) -> Result<Vec<Scored>, ConcealError> {
    let listing =
        fs::read_dir(folder).map_err(|source| ConcealError::File { path: folder.to_owned(), source })?;
    let mut cases: Vec<PathBuf> = listing
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.join("truth.json").is_file())
        .collect();
    cases.sort();
    if cases.is_empty() {
        return Err(ConcealError::NoCase { folder: folder.to_owned() });
    }
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..options.jobs.max(1) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = cases.get(index) else { return };
                    let scored = one(case, options, &progress);
                    if let Ok(mut done) = done.lock() {
                        done.push((index, scored));
                    }
                }
            });
        }
    });
    let mut done = done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().filter_map(|(_, scored)| scored.transpose()).collect()
}

/// None where the case has no place in the score.
fn one(
    case: &Path,
    options: &Options,
    progress: &(impl Fn(&str) + Sync),
) -> Result<Option<Scored>, ConcealError> {
    let name = case.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let truth = Truth::read(case)?;
    let listed: Vec<&str> = truth
        .hidden
        .iter()
        .filter(|cause| cause.class == "physics" && cause.id != "unlisted")
        .map(|cause| cause.id.as_str())
        .collect();
    if options.without_truth && listed.is_empty() {
        return Ok(None);
    }
    let out = case.join(if options.without_truth { "out_without" } else { "out" });
    if options.run && !out.join("diagnosis.json").is_file() {
        let mut extra = Vec::new();
        for id in listed.iter().filter(|_| options.without_truth) {
            extra.extend(["--without", id]);
        }
        let seconds = diagnose(&case.join("scenario.ron"), case, &out, &extra, options)?;
        put(&out.join("seconds.json"), &format!("{{\"seconds\": {seconds:.2}}}\n"))?;
        progress(&format!("{name}  {seconds:.1} s"));
    }
    let oracle = case.join("oracle");
    if options.run
        && !options.without_truth
        && case.join("oracle.ron").is_file()
        && !oracle.join("diagnosis.json").is_file()
    {
        // One cause that does nothing here is enough: the errors before it are those of the true model.
        diagnose(&case.join("oracle.ron"), case, &oracle, &["--only", "brake_drag"], options)?;
    }
    let seconds = fs::read_to_string(out.join("seconds.json")).ok().and_then(|text| {
        let value: serde_json::Value = serde_json::from_str(&text).ok()?;
        value.get("seconds")?.as_f64()
    });
    let outcome = outcome(case, &out, &truth);
    Ok(Some(Scored { name, truth, outcome, seconds }))
}

fn put(path: &Path, text: &str) -> Result<(), ConcealError> {
    fs::write(path, text).map_err(|source| ConcealError::File { path: path.to_owned(), source })
}

/// Runs the program on a scenario and a case's recording; what it says goes to `log.txt`. Gives the time taken [s].
fn diagnose(
    scenario: &Path,
    case: &Path,
    out: &Path,
    extra: &[&str],
    options: &Options,
) -> Result<f64, ConcealError> {
    /// How often a running program is looked at.
    const LOOK: Duration = Duration::from_millis(50);
    let file_error = |source| ConcealError::File { path: out.to_owned(), source };
    let start_error = |source| ConcealError::Program { program: options.program.clone(), source };
    fs::create_dir_all(out).map_err(file_error)?;
    let log = File::create(out.join("log.txt")).map_err(file_error)?;
    let mut command = Command::new(&options.program);
    command.arg("diagnose").arg(scenario).arg("--recording").arg(case.join("recording.ron"));
    command.arg("--out").arg(out).args(["--quiet", "--threads", "1"]).args(extra);
    command.stdin(Stdio::null()).stdout(log.try_clone().map_err(file_error)?).stderr(log);
    let begun = Instant::now();
    let mut child = command.spawn().map_err(start_error)?;
    while child.try_wait().map_err(start_error)?.is_none() {
        if begun.elapsed().as_secs_f64() > options.limit_s {
            child.kill().map_err(start_error)?;
            child.wait().map_err(start_error)?;
            put(&out.join("log.txt"), &format!("stopped after {} s\n", options.limit_s))?;
            break;
        }
        std::thread::sleep(LOOK);
    }
    Ok(begun.elapsed().as_secs_f64())
}

fn outcome(case: &Path, out: &Path, truth: &Truth) -> Result<Outcome, String> {
    let path = out.join("diagnosis.json");
    if !path.is_file() {
        let log = fs::read_to_string(out.join("log.txt")).unwrap_or_default();
        let line = log.lines().find(|line| !line.trim().is_empty()).unwrap_or("not run").to_owned();
        return Err(line);
    }
    let diagnosis = Diagnosis::read(&path).map_err(|error| error.to_string())?;
    let oracle = Diagnosis::read(&case.join("oracle").join("diagnosis.json")).ok();
    let along = read_parquet(&case.join("truth.parquet")).map_err(|error| error.to_string())?;
    let effects = out.join("effects.parquet");
    let effects = if effects.is_file() {
        read_parquet(&effects).map_err(|error| error.to_string())?
    } else {
        Vec::new()
    };
    Ok(judge(truth, &diagnosis, oracle.as_ref(), &along, &effects))
}
