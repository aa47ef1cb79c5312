//! `headland check`: reads files and says what is wrong with them.

use crate::arguments::CheckOptions;
use crate::command::run::told_remark;
use crate::failure::{Failure, told_recording};
use crate::say::Say;
use headland_batch::{Comparison, Plan};
use headland_diagnose::{Kind, Together};
use headland_plugin::Registry;
use headland_scenario::{Document, Scenario};
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(Debug, Serialize)]
struct Checked {
    file: String,
    kind: &'static str,
    ok: bool,
    /// What it is about, or what is wrong with it.
    told: String,
    remarks: Vec<String>,
}

/// Runs the command.
pub fn check(registry: &Registry, options: &CheckOptions, say: Say) -> Result<(), Failure> {
    let mut checked: Vec<Checked> = options.files.iter().map(|path| check_one(registry, path)).collect();
    checked.extend(pair(registry, &options.files, &checked));
    let mut text = String::new();
    for one in &checked {
        let _ = writeln!(
            text,
            "{}  {}  {}: {}",
            if one.ok { "ok   " } else { "wrong" },
            one.file,
            one.kind,
            one.told
        );
        for remark in &one.remarks {
            let _ = writeln!(text, "       note: {remark}");
        }
    }
    say.result(&text, &checked)?;
    let wrong = checked.iter().filter(|one| !one.ok).count();
    if wrong > 0 {
        return Err(Failure::Requirement(told_wrong(&checked, options.files.len())));
    }
    Ok(())
}

fn told_wrong(checked: &[Checked], files: usize) -> String {
    let wrong = checked[..files].iter().filter(|one| !one.ok).count();
    if wrong == 0 {
        return "scenario and recording do not go together".to_owned();
    }
    format!("{wrong} of {files} files are wrong")
}

/// One scenario and one recording that are right by themselves are held together as well.
fn pair(registry: &Registry, files: &[PathBuf], checked: &[Checked]) -> Option<Checked> {
    let only = |kind: &str| {
        let mut of = files.iter().zip(checked).filter(|(_, one)| one.kind == kind);
        let (path, one) = of.next()?;
        (of.next().is_none() && one.ok).then_some(path.as_path())
    };
    let (scenario, recording) = (only("scenario")?, only("recording")?);
    let file = format!("{} with {}", scenario.display(), recording.display());
    let of = |ok, told, remarks| Checked { file, kind: "together", ok, told, remarks };
    Some(match held_together(registry, scenario, recording) {
        Ok(one) => of(true, told_together(&one), one.notes),
        Err(failure) => of(false, failure.to_string(), Vec::new()),
    })
}

fn held_together(registry: &Registry, scenario: &Path, recording: &Path) -> Result<Together, Failure> {
    let scenario = Scenario::read(scenario, registry).map_err(|error| Failure::Input(error.told()))?;
    let recording =
        headland_recording::load(recording).map_err(|error| Failure::Input(told_recording(&error)))?;
    Ok(headland_diagnose::together(&scenario, &recording, registry)?)
}

fn told_together(one: &Together) -> String {
    if one.balances.is_empty() {
        return "no balance".to_owned();
    }
    let balance = |kind: &Kind| format!("{} ({})", kind.name(), kind.sides());
    let balances: Vec<String> = one.balances.iter().map(balance).collect();
    format!(
        "balances: {}; a diagnosis fits {} and holds out {}",
        balances.join(", "),
        listed(&one.fitted),
        listed(&one.held_out)
    )
}

fn listed(runs: &[String]) -> String {
    match runs {
        [] => "no run".to_owned(),
        [one] => format!("one run ({one})"),
        many => format!("{} runs ({})", many.len(), many.join(", ")),
    }
}

fn check_one(registry: &Registry, path: &Path) -> Checked {
    let file = path.display().to_string();
    let kind = match Document::read(path) {
        Ok(document) => kind_of(&document),
        Err(error) => {
            return Checked { file, kind: "file", ok: false, told: error.told(), remarks: Vec::new() };
        }
    };
    let result = match kind {
        "recording" => headland_recording::check(path)
            .map(|check| (check.about, check.notices.iter().map(ToString::to_string).collect()))
            .map_err(|error| told_recording(&error)),
        "comparison" => planned(registry, path).map_err(|failure| failure.to_string()),
        _ => Scenario::read(path, registry)
            .map(|scenario| (scenario.about.clone(), scenario.remarks.iter().map(told_remark).collect()))
            .map_err(|error| error.told()),
    };
    match result {
        Ok((told, remarks)) => Checked { file, kind, ok: true, told, remarks },
        Err(told) => Checked { file, kind, ok: false, told, remarks: Vec::new() },
    }
}

/// A comparison is checked with every scenario that it stands for.
fn planned(registry: &Registry, path: &Path) -> Result<(String, Vec<String>), Failure> {
    let plan = Plan::new(Comparison::read(path)?, registry, 0)?;
    if let Some((of, error)) = plan.refused().next() {
        return Err(Failure::Input(format!("{of}:\n{}", error.told())));
    }
    Ok((format!("{} ({} runs)", plan.comparison.about, plan.total()), Vec::new()))
}

/// A recording description has runs with files and no vehicle; everything else is meant as a scenario.
fn kind_of(document: &Document) -> &'static str {
    let has = |key: &str| document.tree().field(key).is_some();
    if Comparison::is(document) {
        "comparison"
    } else if has("channels") || has("format") || has("runs") && !has("vehicle") && !has("simulation") {
        "recording"
    } else {
        "scenario"
    }
}
