//! How a command ends when it does not end well.

use headland_scenario::ScenarioError;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit status: the work was done and a stated requirement was not met.
pub const REQUIREMENT: u8 = 1;
/// Exit status: bad input or usage.
pub const INPUT: u8 = 2;
/// Exit status: the machine failed.
pub const MACHINE: u8 = 3;
/// Exit status: interrupted, with everything finished so far kept.
pub const INTERRUPTED: u8 = 130;

/// Why a command did not end well.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The work was done and a stated requirement was not met.
    #[error("{0}")]
    Requirement(String),
    /// Bad input or usage.
    #[error("{0}")]
    Input(String),
    /// The machine failed.
    #[error("{0}")]
    Machine(String),
    /// The user interrupted.
    #[error("interrupted; everything that was finished is kept")]
    Interrupted,
}

impl Failure {
    /// The exit status that stands for it.
    pub fn status(&self) -> u8 {
        match self {
            Self::Requirement(_) => REQUIREMENT,
            Self::Input(_) => INPUT,
            Self::Machine(_) => MACHINE,
            Self::Interrupted => INTERRUPTED,
        }
    }

    /// A file that cannot be written: the user's folder, or the machine's disk.
    pub fn unwritable(path: &std::path::Path, error: &std::io::Error) -> Self {
        use std::io::ErrorKind::{QuotaExceeded, StorageFull};
        let text = format!("cannot write {}: {error}", path.display());
        match error.kind() {
            StorageFull | QuotaExceeded => Self::Machine(text),
            _ => Self::Input(text),
        }
    }
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Self {
        Self::Input(error.told())
    }
}

static INTERRUPTION: AtomicBool = AtomicBool::new(false);

/// From now on an interruption is noted instead of ending the program; a second one ends it.
pub fn listen_for_interruption() -> Result<(), Failure> {
    let heard = ctrlc::set_handler(|| {
        if INTERRUPTION.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
    match heard {
        Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(()),
        Err(error) => Err(Failure::Machine(format!("cannot listen for interruptions: {error}"))),
    }
}

/// Whether the user has interrupted.
pub fn interrupted() -> bool {
    INTERRUPTION.load(Ordering::SeqCst)
}
