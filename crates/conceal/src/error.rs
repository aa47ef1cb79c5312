//! What can go wrong.

use headland_trace::TraceError;
use std::path::PathBuf;

/// A case that could not be written, or a score that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ConcealError {
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A JSON document is not what it should be.
    #[error("{}: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// A trace could not be written or read.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The program under test could not be started.
    #[error("`{}` could not be started: {source}", program.display())]
    Program {
        /// The program.
        program: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A log lacks a column.
    #[error("{}: no column that begins with `{column}`", path.display())]
    Column {
        /// The log.
        path: PathBuf,
        /// How its header begins.
        column: String,
    },
    /// There is no case to score.
    #[error("{} holds no case: expected folders with `truth.json`", folder.display())]
    NoCase {
        /// Where cases were looked for.
        folder: PathBuf,
    },
}
