//! Where the logs of a description lie.

use crate::{Place, RecordingError};
use std::env;
use std::path::{Path, PathBuf};

/// The variable that names the folder of recordings.
const RECORDINGS: &str = "HEADLAND_RECORDINGS";

/// The folder in which a description's files are looked up: its own, or the one that it names.
///
/// `${HEADLAND_RECORDINGS}` is the variable where it is set, else `shared/recordings` in the nearest folder above the
/// description that has one. Any other `${NAME}` is an environment variable.
pub(crate) fn of_description(description: &Path, folder: Option<&str>, at: &Place) -> Result<PathBuf, RecordingError> {
    let own = description.parent().map(Path::to_owned).unwrap_or_default();
    let Some(folder) = folder else { return Ok(own) };
    let mut text = String::new();
    let mut rest = folder;
    while let Some((before, after)) = rest.split_once("${") {
        let Some((name, after)) = after.split_once('}') else { break };
        text.push_str(before);
        text.push_str(&variable(name, description, at)?);
        rest = after;
    }
    text.push_str(rest);
    Ok(own.join(text))
}

fn variable(name: &str, description: &Path, at: &Place) -> Result<String, RecordingError> {
    match env::var(name) {
        Ok(value) if !value.is_empty() => Ok(value),
        _ if name == RECORDINGS => beside(description)
            .map(|folder| folder.to_string_lossy().into_owned())
            .ok_or_else(|| RecordingError::NoRecordings { at: at.clone() }),
        _ => Err(RecordingError::Variable { at: at.clone(), name: name.to_owned() }),
    }
}

/// The nearest `shared/recordings` in a folder above the description.
fn beside(description: &Path) -> Option<PathBuf> {
    let whole = description.canonicalize().ok()?;
    whole.ancestors().skip(1).map(|above| above.join("shared").join("recordings")).find(|folder| folder.is_dir())
}
