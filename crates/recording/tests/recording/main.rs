//! Descriptions and logs written by the tests, read as a user's would be.

mod bad_input;
mod described;
mod layouts;
mod published;
mod times;

use headland_recording::{Recording, RecordingError, load};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder with a description and its logs.
pub struct Folder {
    folder: TempDir,
}

impl Folder {
    /// A folder with these files.
    pub fn of(files: &[(&str, &[u8])]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        Self { folder }
    }

    /// A log `log.csv` and a description of it with these fields beside `about` and `runs`.
    pub fn log(log: impl AsRef<[u8]>, fields: &str) -> Self {
        let description = format!("(about: \"test\", runs: [(id: \"r\", file: \"log.csv\")],\n{fields})");
        Self::of(&[("log.csv", log.as_ref()), ("recording.ron", description.as_bytes())])
    }

    /// Where a file lies.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Reads the description.
    pub fn load(&self) -> Result<Recording, RecordingError> {
        load(&self.path("recording.ron"))
    }

    /// The values of a channel of the first run.
    pub fn values(&self, channel: &str) -> Vec<f64> {
        let recording = self.load().unwrap();
        recording.runs[0].trace.require(channel).unwrap().to_vec()
    }

    /// The message of a refusal, its file without the folder.
    pub fn refusal(&self) -> String {
        let error = self.load().unwrap_err();
        error.to_string().replace(&format!("{}/", self.folder.path().display()), "")
    }
}

/// Whether two lists agree to a billionth.
pub fn alike(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len()
        && found
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1.0) || (a.is_nan() && b.is_nan()))
}
