//! The Rerun viewer, a program of its own.

use crate::{Scene, ViewError, write};
use std::ffi::OsStr;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The version of the viewer that reads these files.
pub const VIEWER_VERSION: &str = "0.36.3";

/// How long a viewer may take to find out that it cannot start.
const GRACE: Duration = Duration::from_millis(1500);

/// The address that only this machine reaches.
const LOOPBACK: &str = "127.0.0.1";

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

/// A viewer for browsers on this machine; it ends when this is dropped.
#[derive(Debug)]
pub struct Server {
    child: Child,
    viewer: PathBuf,
    address: String,
}

impl Server {
    /// What a browser opens.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Waits until the server ends, as it does when it is interrupted.
    ///
    /// # Errors
    /// [`ViewError::File`] where the system refuses to wait.
    pub fn wait(mut self) -> Result<(), ViewError> {
        let waited = self.child.wait().map(drop);
        waited.map_err(|source| ViewError::File { path: self.viewer.clone(), source })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Where it has ended already there is nothing to end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Serves the viewer with a file to browsers on this machine, and to no other.
///
/// # Errors
/// What [`show`] refuses; [`ViewError::File`] where the machine has no free ports.
pub fn serve(path: &Path) -> Result<Server, ViewError> {
    let viewer = find(path, std::env::var_os("PATH").as_deref())?;
    start_server(&viewer, path)
}

fn start_server(viewer: &Path, path: &Path) -> Result<Server, ViewError> {
    let file_error = |source| ViewError::File { path: viewer.to_owned(), source };
    // Both are free at once: the listeners are dropped together.
    let listeners = [0; 2].map(|port: u16| TcpListener::bind((LOOPBACK, port)));
    let mut ports = Vec::with_capacity(2);
    for listener in &listeners {
        let listener = listener.as_ref().map_err(|error| file_error(std::io::Error::from(error.kind())))?;
        ports.push(listener.local_addr().map_err(file_error)?.port().to_string());
    }
    drop(listeners);
    let (data, page) = (&ports[0], &ports[1]);
    let child = Command::new(viewer)
        .args(["--serve-web", "--bind", LOOPBACK, "--port", data, "--web-viewer-port", page])
        .arg(path)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(file_error)?;
    let address = format!("http://{LOOPBACK}:{page}/?url=rerun%2Bhttp%3A%2F%2F{LOOPBACK}%3A{data}%2Fproxy");
    let mut server = Server { child, viewer: viewer.to_owned(), address };
    let started = Instant::now();
    while started.elapsed() < GRACE {
        if let Some(status) = server.child.try_wait().map_err(file_error)? {
            return Err(ViewError::Ended { viewer: viewer.to_owned(), status });
        }
        sleep(Duration::from_millis(50));
    }
    Ok(server)
}

fn find(file: &Path, folders: Option<&OsStr>) -> Result<PathBuf, ViewError> {
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
        use std::os::unix::fs::PermissionsExt as _;

        fn program(folder: &Path, text: &str) -> PathBuf {
            let path = folder.join("rerun");
            std::fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
            path
        }

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

        /// The program writes down what it is told, and then waits as a server does.
        #[test]
        fn what_is_served_is_bound_to_this_machine_alone() {
            let folder = tempfile::tempdir().unwrap();
            let told = folder.path().join("told");
            let server = program(folder.path(), &format!("echo \"$@\" > {}; exec sleep 60", told.display()));
            let server = start_server(&server, Path::new("run.rrd")).unwrap();
            let told = std::fs::read_to_string(told).unwrap();
            assert!(
                told.starts_with("--serve-web --bind 127.0.0.1 --port ") && told.ends_with(" run.rrd\n"),
                "{told}"
            );
            assert!(server.address().starts_with("http://127.0.0.1:"), "{}", server.address());
            drop(server);
            let ends = program(folder.path(), "exit 3");
            assert!(matches!(start_server(&ends, Path::new("run.rrd")), Err(ViewError::Ended { .. })));
        }
    }
}
