//! The folder that a command writes into.

use crate::failure::Failure;
use headland_report::Report;
use headland_trace::{Run, write_parquet};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Writes a text; a file appears whole or not at all, and what stood there stays until then.
pub fn write_whole(path: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error| Failure::unwritable(path, &error);
    // A pipe or a terminal is written to; nothing takes its place.
    if path.metadata().is_ok_and(|found| !found.is_file()) {
        return std::fs::write(path, text).map_err(failed);
    }
    let mut draft = path.to_owned().into_os_string();
    draft.push(".part");
    let written = std::fs::write(&draft, text).and_then(|()| std::fs::rename(&draft, path));
    if written.is_err() {
        // Half a file helps nobody; that it may stay behind must not hide why it is half.
        let _ = std::fs::remove_file(&draft);
    }
    written.map_err(failed)
}

/// Refuses a file that cannot be written, before what takes long is begun; what stands there stays as it is.
pub fn must_be_writable(path: &Path) -> Result<(), Failure> {
    let stood = path.exists();
    let opened = std::fs::OpenOptions::new().append(true).create(true).open(path);
    opened.map_err(|error| Failure::unwritable(path, &error))?;
    if stood { Ok(()) } else { std::fs::remove_file(path).map_err(|error| Failure::unwritable(path, &error)) }
}

/// A folder for results, and what was written there.
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    written: Vec<String>,
}

impl Output {
    /// Makes the folder, `out/<stem of the input>` where none is named.
    pub fn new(named: Option<&Path>, input: &Path) -> Result<Self, Failure> {
        let folder = named.map_or_else(
            || Path::new("out").join(input.file_stem().unwrap_or(std::ffi::OsStr::new("result"))),
            Path::to_owned,
        );
        std::fs::create_dir_all(&folder).map_err(|error| Failure::no_folder(&folder, &error))?;
        let whole = |path: &Path| path.canonicalize().ok();
        let beside =
            input.parent().map(|parent| if parent.as_os_str().is_empty() { Path::new(".") } else { parent });
        if input.is_file() && beside.and_then(whole) == whole(&folder) {
            return Err(Failure::Input(format!(
                "--out {} is the folder of {}: what is written there could replace what was read; name another",
                folder.display(),
                input.display()
            )));
        }
        Ok(Self { folder, written: Vec::new() })
    }

    /// Where a file of this name goes, noted as written.
    pub fn file(&mut self, name: &str) -> PathBuf {
        self.written.push(name.to_owned());
        self.folder.join(name)
    }

    /// Writes a text; a file appears whole or not at all.
    pub fn text(&mut self, name: &str, text: &str) -> Result<PathBuf, Failure> {
        let path = self.file(name);
        write_whole(&path, text)?;
        Ok(path)
    }

    /// Writes a JSON document.
    pub fn json(&mut self, name: &str, document: &impl Serialize) -> Result<(), Failure> {
        let mut json = serde_json::to_string_pretty(document)
            .map_err(|error| Failure::Machine(format!("cannot write JSON: {error}")))?;
        json.push('\n');
        self.text(name, &json).map(drop)
    }

    /// Writes traces.
    pub fn traces(&mut self, name: &str, runs: &[Run]) -> Result<(), Failure> {
        let path = self.file(name);
        Ok(write_parquet(&path, runs)?)
    }

    /// Writes a page.
    pub fn page(&mut self, name: &str, report: &Report) -> Result<(), Failure> {
        let path = self.file(name);
        Ok(report.write(&path)?)
    }

    /// Makes a folder inside.
    pub fn folder(&self, name: &Path) -> Result<PathBuf, Failure> {
        let folder = self.folder.join(name);
        std::fs::create_dir_all(&folder).map_err(|error| Failure::no_folder(&folder, &error))?;
        Ok(folder)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.folder
    }

    /// The line that tells what was written.
    pub fn told(&self) -> String {
        let (inside, own): (Vec<&String>, Vec<&String>) =
            self.written.iter().partition(|name| name.contains('/'));
        let mut names: Vec<&str> = Vec::new();
        for name in own {
            names.push(name);
        }
        for name in inside {
            let folder = name.split_inclusive('/').next().unwrap_or(name);
            if !names.contains(&folder) {
                names.push(folder);
            }
        }
        format!("{}: {}", self.folder.display(), names.join("  "))
    }
}
