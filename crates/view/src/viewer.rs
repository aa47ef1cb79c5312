//! The Rerun viewer, a program of its own.

use crate::{Scene, ViewError, write};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The version of the viewer that reads these files.
pub const VIEWER_VERSION: &str = "0.36.3";

/// How long a viewer may take to find out that it cannot start.
const GRACE: Duration = Duration::from_millis(1500);

/// The viewer takes more recordings by a port, which it opens to all the world unless told to keep to this machine.
const LISTENS: [&str; 2] = ["--bind", "127.0.0.1"];

/// Writes the scene to a file in the system's folder for such files and starts the viewer on it; gives the file.
///
/// # Errors
/// What [`write()`] and [`show`] refuse.
pub fn open(scene: &Scene) -> Result<PathBuf, ViewError> {
    let viewer = find(Path::new("run.rrd"), std::env::var_os("PATH").as_deref())?;
    let path = std::env::temp_dir().join(format!("headland-{}.rrd", std::process::id()));
    write(scene, &path)?;
    start(&viewer, &path)?;
    Ok(path)
}

/// Starts the viewer on a file and leaves it running.
///
/// # Errors
/// [`ViewError::NoViewer`] where no program called `rerun` is on the PATH, [`ViewError::OtherViewer`] where it is of a
/// version that may not read the file, [`ViewError::Ended`] where it ends with an error as soon as it was started.
pub fn show(path: &Path) -> Result<(), ViewError> {
    start(&find(path, std::env::var_os("PATH").as_deref())?, path)
}

/// The viewer on the PATH, of a version that can read the file.
pub(crate) fn find(file: &Path, folders: Option<&OsStr>) -> Result<PathBuf, ViewError> {
    let name = format!("rerun{}", std::env::consts::EXE_SUFFIX);
    let missing = || ViewError::NoViewer { path: file.to_owned(), version: VIEWER_VERSION };
    let viewer = std::env::split_paths(folders.ok_or_else(missing)?)
        .map(|folder| folder.join(&name))
        .find(|viewer| viewer.is_file())
        .ok_or_else(missing)?;
    let said = Command::new(&viewer).arg("--version").stdin(Stdio::null()).output();
    let said = said.map_err(|source| ViewError::File { path: viewer.clone(), source })?;
    let said = String::from_utf8_lossy(&said.stdout).into_owned();
    match version(&said) {
        Some(found) if same(found, VIEWER_VERSION) => Ok(viewer),
        found => {
            let found = found.unwrap_or("none").to_owned();
            Err(ViewError::OtherViewer { viewer, found, version: VIEWER_VERSION })
        }
    }
}

/// The first word that looks like a version: `rerun-cli 0.36.3 (…) …`.
fn version(said: &str) -> Option<&str> {
    said.split_whitespace()
        .find(|word| word.split('.').count() == 3 && word.starts_with(|c: char| c.is_ascii_digit()))
}

/// Whether two versions agree in all but the last number.
fn same(one: &str, other: &str) -> bool {
    one.rsplit_once('.').map(|(most, _)| most) == other.rsplit_once('.').map(|(most, _)| most)
}

fn start(viewer: &Path, path: &Path) -> Result<(), ViewError> {
    let file_error = |source| ViewError::File { path: viewer.to_owned(), source };
    let mut child = Command::new(viewer)
        .args(LISTENS)
        .arg(path)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(file_error)?;
    let started = Instant::now();
    while started.elapsed() < GRACE {
        match child.try_wait().map_err(file_error)? {
            Some(status) if !status.success() => {
                return Err(ViewError::Ended { viewer: viewer.to_owned(), status });
            }
            // A viewer that was open already took the file.
            Some(_) => return Ok(()),
            None => sleep(Duration::from_millis(50)),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_viewer_has_the_version_of_the_library() {
        assert_eq!(rerun::build_info().version.to_string(), VIEWER_VERSION);
    }

    #[test]
    fn a_missing_viewer_is_named_with_its_version_and_how_to_get_it() {
        let empty = tempfile::tempdir().unwrap();
        let error = find(Path::new("run.rrd"), Some(empty.path().as_os_str())).unwrap_err().to_string();
        let expected = format!(
            "no `rerun` on the PATH to show run.rrd with; `pip install rerun-sdk=={VIEWER_VERSION}` brings it"
        );
        assert_eq!(error, expected);
    }

    #[test]
    fn a_version_differs_by_more_than_its_last_number() {
        assert_eq!(version("rerun-cli 0.36.3 (base web) [rustc 1.95.0]"), Some("0.36.3"));
        assert_eq!(version("no such option"), None);
        assert!(same("0.36.1", "0.36.3") && !same("0.37.0", "0.36.3") && !same("1.36.3", "0.36.3"));
    }

    #[cfg(unix)]
    mod programs {
        use super::*;
        use crate::stand_in::program;

        #[test]
        fn a_viewer_of_another_version_is_refused() {
            let folder = tempfile::tempdir().unwrap();
            program(folder.path(), "echo rerun-cli 0.12.0");
            let error = find(Path::new("run.rrd"), Some(folder.path().as_os_str())).unwrap_err();
            assert!(matches!(&error, ViewError::OtherViewer { found, .. } if found == "0.12.0"), "{error}");
        }

        #[test]
        fn a_viewer_that_ends_at_once_is_an_error_and_one_that_hands_over_is_none() {
            let folder = tempfile::tempdir().unwrap();
            let broken = program(folder.path(), "exit 3");
            let error = start(&broken, Path::new("run.rrd")).unwrap_err();
            assert!(matches!(&error, ViewError::Ended { .. }), "{error}");
            let works = program(folder.path(), "exit 0");
            start(&works, Path::new("run.rrd")).unwrap();
        }

        /// It listened on every interface: whoever is in the same network could send it recordings.
        #[test]
        fn a_viewer_is_told_the_file_and_to_listen_to_this_machine_only() {
            let folder = tempfile::tempdir().unwrap();
            let notes = program(folder.path(), r#"echo "$@" > "$0.told""#);
            start(&notes, Path::new("run.rrd")).unwrap();
            let told = std::fs::read_to_string(folder.path().join("rerun.told")).unwrap();
            assert_eq!(told.trim(), "--bind 127.0.0.1 run.rrd");
        }
    }
}
