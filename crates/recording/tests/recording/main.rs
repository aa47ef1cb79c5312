//! Descriptions and logs written by the tests, read as a user's would be.

mod bad_input;
mod described;
mod documented;
mod layouts;
mod published;
mod times;

use headland_recording::{Recording, RecordingError, load};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder with a description and its logs.
struct Folder {
    folder: TempDir,
}

impl Folder {
    /// A folder with these files.
    fn of(files: &[(&str, &[u8])]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        Self { folder }
    }

    /// A log `log.csv` and a description of it with these fields beside `about` and `runs`.
    fn log(log: impl AsRef<[u8]>, fields: &str) -> Self {
        let description = format!("(about: \"test\", runs: [(id: \"r\", file: \"log.csv\")],\n{fields})");
        Self::of(&[("log.csv", log.as_ref()), ("recording.ron", description.as_bytes())])
    }

    /// Where a file lies.
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Reads the description.
    fn load(&self) -> Result<Recording, RecordingError> {
        load(&self.path("recording.ron"))
    }

    /// The values of a channel of the first run.
    fn values(&self, channel: &str) -> Vec<f64> {
        let recording = self.load().unwrap();
        recording.runs[0].trace.require(channel).unwrap().to_vec()
    }

    /// The message of a refusal, its file without the folder.
    fn refusal(&self) -> String {
        let error = self.load().unwrap_err();
        error.to_string().replace(&format!("{}/", self.folder.path().display()), "")
    }
}

/// Whether two lists agree to a billionth.
fn alike(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1.0) || (a.is_nan() && b.is_nan()))
}

/// A log of a header and so many rows.
fn lines(header: &str, rows: u32, row: impl Fn(u32) -> String) -> String {
    let rows: Vec<String> = (0..rows).map(row).collect();
    format!("{header}\n{}\n", rows.join("\n"))
}
