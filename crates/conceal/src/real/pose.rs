//! Poses a row: runs the program under test on a scenario and a recording, and reads what it wrote.

use super::{Options, Row};
use crate::error::ConcealError;
use crate::score::{Diagnosis, Finding};
use headland_trace::{Run, read_parquet};
use serde_json::Value;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What the program said.
pub struct Said {
    /// Its diagnosis; none where it gave none.
    pub diagnosis: Option<Diagnosis>,
    /// Its answer in its own words, or why there is none.
    pub answer: String,
    /// What its effects did along every run.
    pub effects: Vec<Run>,
    /// Time that it took [s].
    pub wall_s: f64,
    /// Where it wrote.
    pub out: PathBuf,
}

/// Runs the program; what it prints goes to `log.txt`.
pub fn diagnose(
    options: &Options,
    name: &str,
    scenario: &Path,
    recording: &Path,
    more: &[&str],
) -> Result<Said, ConcealError> {
    /// How often it is looked whether the program has ended.
    const LOOK: Duration = Duration::from_millis(50);
    let out = options.scratch.join(name).join("out");
    if out.exists() {
        std::fs::remove_dir_all(&out).map_err(|source| ConcealError::File { path: out.clone(), source })?;
    }
    std::fs::create_dir_all(&out).map_err(|source| ConcealError::File { path: out.clone(), source })?;
    let log = out.join("log.txt");
    let log_error = |source| ConcealError::File { path: log.clone(), source };
    let printed = File::create(&log).map_err(log_error)?;
    let begun = Instant::now();
    let mut child = Command::new(&options.program)
        .arg("diagnose")
        .arg(scenario)
        .arg("--recording")
        .arg(recording)
        .arg("--out")
        .arg(&out)
        .arg("--quiet")
        .args(more)
        .env("HEADLAND_RECORDINGS", &options.recordings)
        .stdin(Stdio::null())
        .stdout(printed.try_clone().map_err(log_error)?)
        .stderr(printed)
        .spawn()
        .map_err(|source| ConcealError::Program { program: options.program.clone(), source })?;
    let mut late = false;
    while child.try_wait().map_err(log_error)?.is_none() {
        if begun.elapsed().as_secs_f64() > options.limit_s {
            late = true;
            child.kill().map_err(log_error)?;
            child.wait().map_err(log_error)?;
            break;
        }
        std::thread::sleep(LOOK);
    }
    let wall_s = begun.elapsed().as_secs_f64();
    let path = out.join("diagnosis.json");
    let nothing =
        |answer: String| Said { diagnosis: None, answer, effects: Vec::new(), wall_s, out: out.clone() };
    if late {
        return Ok(nothing(format!("no answer within {:.0} s", options.limit_s)));
    }
    if !path.is_file() {
        let text = std::fs::read_to_string(&log).unwrap_or_default();
        let line = text.lines().find(|line| !line.trim().is_empty()).unwrap_or("nothing printed");
        return Ok(nothing(format!("no diagnosis: {line}")));
    }
    let text = std::fs::read_to_string(&path).map_err(log_error)?;
    let json: Value =
        serde_json::from_str(&text).map_err(|source| ConcealError::Json { path: path.clone(), source })?;
    let answer = json.get("answer").and_then(Value::as_str).unwrap_or_default().to_owned();
    let effects = out.join("effects.parquet");
    let effects = if effects.is_file() { read_parquet(&effects)? } else { Vec::new() };
    Ok(Said { diagnosis: Some(Diagnosis::read(&path)?), answer, effects, wall_s, out })
}

/// Writes an input of a row into its scratch folder.
pub fn write(options: &Options, name: &str, file: &str, text: &str) -> Result<PathBuf, ConcealError> {
    let folder = options.scratch.join(name);
    let path = folder.join(file);
    let failed = |source| ConcealError::File { path: path.clone(), source };
    std::fs::create_dir_all(&folder).map_err(failed)?;
    std::fs::write(&path, text).map_err(failed)?;
    Ok(path)
}

impl Said {
    /// What it found.
    pub fn findings(&self) -> &[Finding] {
        self.diagnosis.as_ref().map_or(&[], |diagnosis| &diagnosis.findings)
    }

    /// Whether a cause was found.
    pub fn found(&self, id: &str) -> bool {
        self.findings().iter().any(|finding| finding.id == id)
    }

    /// Whether a cause was found or stands first among the alternatives of one that was.
    pub fn found_or_first(&self, id: &str) -> bool {
        let first =
            |finding: &Finding| finding.indistinguishable_from.first().is_some_and(|one| one.id == id);
        self.findings().iter().any(|finding| finding.id == id || first(finding))
    }

    /// Times and what these effects do together along a run; none where none of them does anything.
    pub fn series(&self, run: &str, columns: &[&str]) -> Option<(Vec<f64>, Vec<f64>)> {
        let run = self.effects.iter().find(|one| one.id == run)?;
        let mut sum: Option<Vec<f64>> = None;
        for values in columns.iter().filter_map(|column| run.trace.get(column)) {
            let sum = sum.get_or_insert_with(|| vec![0.0; values.len()]);
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += value;
            }
        }
        sum.map(|sum| (run.trace.time_s().to_vec(), sum))
    }

    /// A free parameter: value and 95 % interval.
    pub fn calibrated(&self, name: &str) -> Option<(f64, [f64; 2])> {
        let diagnosis = self.diagnosis.as_ref()?;
        let one = diagnosis.calibrated.iter().find(|one| one.name == name)?;
        let [low, high] = one.ci95.unwrap_or([None, None]);
        Some((one.value?, [low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY)]))
    }

    /// A row that holds what was said.
    pub fn row(&self, set: &'static str, concealed: &str) -> Row {
        let said = match &self.diagnosis {
            None => "no diagnosis".to_owned(),
            Some(diagnosis) => {
                let one = |finding: &Finding| {
                    let others: Vec<&str> =
                        finding.indistinguishable_from.iter().map(|one| one.id.as_str()).collect();
                    let or = if others.is_empty() {
                        String::new()
                    } else {
                        format!(" (or {})", others.join(", "))
                    };
                    format!("{}{or}", finding.id)
                };
                let causes: Vec<String> = diagnosis.findings.iter().map(one).collect();
                format!(
                    "{}: {}",
                    diagnosis.verdict,
                    if causes.is_empty() { "-".to_owned() } else { causes.join("; ") }
                )
            }
        };
        Row {
            set,
            concealed: concealed.to_owned(),
            said,
            answer: self.answer.clone(),
            held_out: self.held_out(),
            wall_s: self.wall_s,
            ..Row::default()
        }
    }

    fn held_out(&self) -> String {
        let Some(fit) = self.diagnosis.as_ref().and_then(|one| one.fit.as_ref()) else {
            return "-".to_owned();
        };
        let Some(part) = &fit.held_out else { return "none held out".to_owned() };
        let number = |value: Option<f64>| super::signal::short(value.unwrap_or(f64::NAN));
        format!("{} {} → {}", fit.signal, number(part.rmse_before), number(part.rmse_after))
    }
}
