//! Why a batch cannot begin, or cannot go on.

use headland_scenario::ScenarioError;
use headland_trace::TraceError;
use std::path::PathBuf;

/// A batch that cannot begin or go on. What was finished stays in the journal.
#[derive(Debug, thiserror::Error)]
pub enum BatchError {
    /// The comparison, or a scenario that it stands for, cannot be used.
    #[error("{0}")]
    Scenario(#[from] ScenarioError),
    /// A scenario of the comparison cannot be used, though each piece of it can.
    #[error("{of}: {error}")]
    Combination {
        /// Variant, cycle and ground.
        of: String,
        /// Why.
        error: ScenarioError,
    },
    /// A comparison of more runs than anybody waits for.
    #[error("{} has {found} runs, expected at most {most}", path.display())]
    TooMany {
        /// The comparison.
        path: PathBuf,
        /// How many.
        found: u128,
        /// How many may be.
        most: u64,
    },
    /// The folder holds the runs of another comparison.
    #[error(
        "{} holds {finished} finished runs of another batch; different: {}",
        folder.display(),
        different.join(", ")
    )]
    Another {
        /// The folder.
        folder: PathBuf,
        /// Runs that are finished there.
        finished: u64,
        /// What is different.
        different: Vec<String>,
    },
    /// Another program works in the folder.
    #[error("another batch is at work in {}", folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// A file in the place of the journal that is none.
    #[error("{} is no journal of a batch, expected one or nothing", path.display())]
    NoJournal {
        /// The file.
        path: PathBuf,
    },
    /// The folder was taken away while runs were written to it.
    #[error(
        "{} vanished after {finished} runs were finished; {}",
        folder.display(),
        if *rescued { "it was made again with all of them" } else { "it could not be made again" }
    )]
    Vanished {
        /// The folder.
        folder: PathBuf,
        /// Runs that are finished.
        finished: u64,
        /// Whether the folder was made again with all of them.
        rescued: bool,
    },
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The table of results cannot be written.
    #[error("{}: {reason}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A trace cannot be written.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The user interrupted.
    #[error("interrupted")]
    Interrupted,
}
