//! How a command ends when it does not end well.

use headland_batch::BatchError;
use headland_calibrate::coastdown::CoastDownError;
use headland_calibrate::study::StudyError;
use headland_compare::CompareError;
use headland_recording::RecordingError;
use headland_report::ReportError;
use headland_scenario::{Location, ScenarioError};
use headland_trace::TraceError;
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
    /// The user interrupted a diagnosis, which is written at its end alone.
    #[error("interrupted; this is written when it is done, and nothing of it was")]
    Unfinished,
}

impl Failure {
    /// The exit status that stands for it.
    pub fn status(&self) -> u8 {
        match self {
            Self::Requirement(_) => REQUIREMENT,
            Self::Input(_) => INPUT,
            Self::Machine(_) => MACHINE,
            Self::Interrupted | Self::Unfinished => INTERRUPTED,
        }
    }

    /// A folder for results that cannot be made.
    pub fn no_folder(path: &std::path::Path, error: &std::io::Error) -> Self {
        let hint = "\n  results go there; --out names another folder";
        match Self::unwritable(path, error) {
            Self::Input(text) => Self::Input(text + hint),
            other => other,
        }
    }

    /// A file that cannot be written: the user's folder, or the machine's disk.
    pub fn unwritable(path: &std::path::Path, error: &std::io::Error) -> Self {
        use std::io::ErrorKind::{FileTooLarge, QuotaExceeded, StorageFull};
        let text = format!("cannot write {}: {error}", path.display());
        match error.kind() {
            StorageFull | QuotaExceeded | FileTooLarge => Self::Machine(text),
            _ => Self::Input(text),
        }
    }
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Self {
        Self::Input(error.told())
    }
}

impl From<BatchError> for Failure {
    fn from(error: BatchError) -> Self {
        match error {
            BatchError::Scenario(error) => error.into(),
            BatchError::Combination { of, error } => Self::Input(format!("{of}:\n{}", error.told())),
            BatchError::Another { .. } => Self::Input(format!(
                "{error}\n  name another folder with --out, or throw away what is there with --anew"
            )),
            BatchError::TooMany { .. } | BatchError::Busy { .. } | BatchError::NoJournal { .. } => {
                Self::Input(error.to_string())
            }
            BatchError::Interrupted => Self::Interrupted,
            BatchError::Vanished { .. }
            | BatchError::File { .. }
            | BatchError::Table { .. }
            | BatchError::Trace(_) => Self::Machine(error.to_string()),
        }
    }
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        Self::Input(told_recording(&error))
    }
}

/// The message, and the line that it is about where that is a description and not a log.
pub fn told_recording(error: &RecordingError) -> String {
    let told = error.to_string();
    let Some((path, line, column)) = error.location() else { return told };
    let is_description = path.extension().is_some_and(|end| end == "ron");
    let text = if is_description { std::fs::read_to_string(&path).ok() } else { None };
    let Some(excerpt) = text.as_deref().and_then(|text| text.lines().nth(line - 1)) else { return told };
    let place = format!("\n  {}", error.place());
    let message = told.strip_suffix(&place).unwrap_or(&told);
    let location = Location { path, line, column, width: 1, excerpt: excerpt.to_owned() };
    format!("{message}\n{}", location.shown(""))
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Interrupted => Self::Interrupted,
            StudyError::Trace(error) => Self::Machine(error.to_string()),
            other => Self::Input(other.to_string()),
        }
    }
}

impl From<CompareError> for Failure {
    fn from(error: CompareError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<CoastDownError> for Failure {
    fn from(error: CoastDownError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::File { path, source } => Self::unwritable(&path, &source),
            other => Self::Machine(other.to_string()),
        }
    }
}

impl From<TraceError> for Failure {
    fn from(error: TraceError) -> Self {
        match error {
            TraceError::File { path, source } => Self::unwritable(&path, &source),
            other => Self::Machine(other.to_string()),
        }
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
