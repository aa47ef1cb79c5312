//! The viewer served to browsers on this machine.

use crate::ViewError;
use crate::viewer::find;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The address that only this machine reaches.
const LOOPBACK: &str = "127.0.0.1";
/// How long a server may take until it answers.
const PATIENCE: Duration = Duration::from_secs(20);
/// How often is looked whether it answers, has ended, or is to end.
const PAUSE: Duration = Duration::from_millis(50);

/// A viewer for browsers on this machine; it ends when this is dropped.
#[derive(Debug)]
pub struct Server {
    child: Child,
    viewer: PathBuf,
    page: SocketAddr,
    address: String,
}

impl Server {
    /// What a browser opens.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Waits until the server ends, or is to end because `stop` says so.
    ///
    /// # Errors
    /// [`ViewError::File`] where the system refuses to wait.
    pub fn wait(mut self, stop: &dyn Fn() -> bool) -> Result<(), ViewError> {
        while !stop() && self.ended()?.is_none() {
            sleep(PAUSE);
        }
        Ok(())
    }

    fn ended(&mut self) -> Result<Option<std::process::ExitStatus>, ViewError> {
        self.child.try_wait().map_err(|source| ViewError::File { path: self.viewer.clone(), source })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Where it has ended already there is nothing to end.
        end(&mut self.child);
        let _ = self.child.wait();
    }
}

/// Ends a viewer with everything that it started: what `pip` installs is a program that starts the viewer proper, which
/// would outlive it.
#[cfg(unix)]
fn end(child: &mut Child) {
    let group = format!("-{}", child.id());
    let ended = Command::new("sh")
        .args(["-c", "kill -s TERM -- \"$1\"", "sh", &group])
        .stderr(Stdio::null())
        .status();
    if !ended.is_ok_and(|status| status.success()) {
        let _ = child.kill();
    }
}

#[cfg(not(unix))]
fn end(child: &mut Child) {
    let _ = child.kill();
}

/// A group of its own, which can be ended as a whole. What a terminal interrupts is this program, and it ends the group.
#[cfg(unix)]
fn apart(command: &mut Command) {
    std::os::unix::process::CommandExt::process_group(command, 0);
}

#[cfg(not(unix))]
fn apart(_: &mut Command) {}

/// Serves the viewer with a file to browsers on this machine, and to no other; it answers when this returns.
///
/// # Errors
/// What [`show`](crate::show) refuses; [`ViewError::File`] where the machine has no free ports, [`ViewError::Silent`] where the
/// viewer does not answer.
pub fn serve(path: &Path) -> Result<Server, ViewError> {
    let viewer = find(path, std::env::var_os("PATH").as_deref())?;
    start(&viewer, path, PATIENCE)
}

fn start(viewer: &Path, path: &Path, patience: Duration) -> Result<Server, ViewError> {
    let file_error = |source| ViewError::File { path: viewer.to_owned(), source };
    // Both are free at once: the listeners are dropped together.
    let listeners = [0; 2].map(|port: u16| TcpListener::bind((LOOPBACK, port)));
    let mut places = Vec::with_capacity(2);
    for listener in listeners {
        places.push(listener.and_then(|listener| listener.local_addr()).map_err(file_error)?);
    }
    let [data, page] = [places[0].port().to_string(), places[1].port().to_string()];
    let mut command = Command::new(viewer);
    command
        .args(["--serve-web", "--bind", LOOPBACK, "--port", &data, "--web-viewer-port", &page])
        .arg(path)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    apart(&mut command);
    let child = command.spawn().map_err(file_error)?;
    let address = format!("http://{LOOPBACK}:{page}/?url=rerun%2Bhttp%3A%2F%2F{LOOPBACK}%3A{data}%2Fproxy");
    let mut server = Server { child, viewer: viewer.to_owned(), page: places[1], address };
    let started = Instant::now();
    while TcpStream::connect_timeout(&server.page, PAUSE).is_err() {
        if let Some(status) = server.ended()? {
            return Err(ViewError::Ended { viewer: viewer.to_owned(), status });
        }
        if started.elapsed() > patience {
            return Err(ViewError::Silent { viewer: viewer.to_owned(), seconds: patience.as_secs() });
        }
        sleep(PAUSE);
    }
    Ok(server)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use crate::stand_in::program;
    use std::io::{Read as _, Write as _};

    fn until(holds: impl Fn() -> bool) -> bool {
        let started = Instant::now();
        while !holds() && started.elapsed() < PATIENCE {
            sleep(PAUSE);
        }
        holds()
    }

    #[test]
    fn a_server_that_ends_at_once_or_never_answers_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let ends = program(folder.path(), "exit 3");
        let error = start(&ends, Path::new("run.rrd"), PATIENCE).unwrap_err();
        assert!(matches!(error, ViewError::Ended { .. }), "{error}");
        // It writes down what it is told, and starts another program as the installed viewer does, which would leave a trace.
        let (told, late) = (folder.path().join("told"), folder.path().join("late"));
        let text = format!("echo \"$@\" > {}; (sleep 2; touch {}) & wait", told.display(), late.display());
        let silent = program(folder.path(), &text);
        let error = start(&silent, Path::new("run.rrd"), Duration::from_millis(800)).unwrap_err();
        assert!(matches!(error, ViewError::Silent { .. }), "{error}");
        let told = std::fs::read_to_string(told).unwrap();
        assert!(
            told.starts_with("--serve-web --bind 127.0.0.1 --port ") && told.ends_with(" run.rrd\n"),
            "{told}"
        );
        sleep(Duration::from_secs(2));
        assert!(!late.exists(), "what the viewer started outlives it");
    }

    /// `cargo test -p headland-view -- --ignored` with the viewer on the PATH.
    #[test]
    #[ignore = "needs the viewer on the PATH"]
    fn the_viewer_answers_on_this_machine_until_it_is_told_to_stop() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.rrd");
        let runs = [crate::scene::tests::run("r1", &[("position_m", &[0.0, 1.0])])];
        crate::write(&crate::scene::tests::scene(&runs, &[]), &path).unwrap();
        let server = serve(&path).unwrap();
        let page = server.page;
        let mut stream = TcpStream::connect(page).unwrap();
        stream.write_all(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n").unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer);
        assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("<html"), "{answer}");
        server.wait(&|| true).unwrap();
        assert!(
            until(|| TcpStream::connect_timeout(&page, PAUSE).is_err()),
            "the viewer outlives its server"
        );
    }
}
