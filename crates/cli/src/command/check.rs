//! `headland check`: reads files and says what is wrong with them.

use crate::arguments::CheckOptions;
use crate::command::run::told_remark;
use crate::failure::{Failure, told_recording};
use crate::say::Say;
use headland_batch::{Comparison, Plan};
use headland_plugin::Registry;
use headland_scenario::{Document, Scenario};
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;

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
    let checked: Vec<Checked> = options.files.iter().map(|path| check_one(registry, path)).collect();
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
        return Err(Failure::Requirement(format!("{wrong} of {} files are wrong", checked.len())));
    }
    Ok(())
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
