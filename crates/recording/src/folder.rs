//! Where the logs of a description lie.

use crate::{Place, RecordingError};
use std::env;
use std::path::{Path, PathBuf};

/// The folder in which a description's files are looked up: its own, or the one that it names, relative to its own.
///
/// `${NAME}` is the environment variable, which has to be set; `${NAME:-some/folder}` says what holds where it is not.
pub(crate) fn of_description(
    description: &Path,
    folder: Option<&str>,
    at: &Place,
) -> Result<PathBuf, RecordingError> {
    let own = description.parent().map(Path::to_owned).unwrap_or_default();
    let Some(folder) = folder else { return Ok(own) };
    let mut text = String::new();
    let mut rest = folder;
    let mut named = None;
    while let Some((before, after)) = rest.split_once("${") {
        let Some((inside, after)) = after.split_once('}') else { break };
        let (name, default) = match inside.split_once(":-") {
            Some((name, default)) => (name, Some(default)),
            None => (inside, None),
        };
        text.push_str(before);
        match (env::var(name), default) {
            (Ok(value), _) if !value.is_empty() => text.push_str(&value),
            (_, Some(default)) => text.push_str(default),
            _ => return Err(RecordingError::Variable { at: at.clone(), name: name.to_owned() }),
        }
        named = Some(name.to_owned());
        rest = after;
    }
    text.push_str(rest);
    let found = own.join(text);
    match named {
        Some(variable) if !found.is_dir() => {
            Err(RecordingError::NoRecordings { at: at.clone(), folder: found, variable })
        }
        _ => Ok(found),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(text: &str) -> Result<PathBuf, RecordingError> {
        of_description(Path::new("logs/recording.ron"), Some(text), &Place::file(Path::new("x.ron")))
    }

    #[test]
    fn a_variable_that_is_not_set_is_named() {
        let error = folder("${HEADLAND_NO_SUCH_VARIABLE}/a").unwrap_err();
        assert!(
            matches!(&error, RecordingError::Variable { name, .. } if name == "HEADLAND_NO_SUCH_VARIABLE")
        );
        assert!(error.to_string().contains("HEADLAND_NO_SUCH_VARIABLE"));
    }

    #[test]
    fn a_default_that_stands_in_the_description_holds_where_the_variable_is_not_set() {
        let here = tempfile::tempdir().unwrap();
        let text = format!("${{HEADLAND_NO_SUCH_VARIABLE:-{}}}", here.path().display());
        assert_eq!(folder(&text).unwrap(), here.path());
        let error = folder("${HEADLAND_NO_SUCH_VARIABLE:-nowhere}").unwrap_err();
        assert!(error.to_string().contains("set HEADLAND_NO_SUCH_VARIABLE"), "{error}");
    }

    #[test]
    fn without_a_variable_the_folder_is_beside_the_description() {
        assert_eq!(folder("day_1").unwrap(), Path::new("logs").join("day_1"));
        assert_eq!(of_description(Path::new("a/b.ron"), None, &Place::default()).unwrap(), Path::new("a"));
    }
}
