//! What can go wrong with a trace.

use std::path::PathBuf;

/// A trace that cannot be built, or a file of traces that cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// Time does not increase.
    #[error("time does not increase at sample {index}: {before} s is followed by {after} s")]
    Time {
        /// Index of the later sample.
        index: usize,
        /// Time of the sample before.
        before: f64,
        /// Time found.
        after: f64,
    },
    /// A channel has the wrong number of samples.
    #[error("channel `{name}` has {found} samples, expected {expected}")]
    Length {
        /// The channel.
        name: String,
        /// Its number of samples.
        found: usize,
        /// Samples of the time base.
        expected: usize,
    },
    /// A channel stands twice in a trace.
    #[error("channel `{name}` stands twice")]
    Twice {
        /// The channel.
        name: String,
    },
    /// A channel that is needed is not there.
    #[error("no channel `{name}`; there are: {}", present.join(", "))]
    Missing {
        /// The channel.
        name: String,
        /// The channels that are there.
        present: Vec<String>,
    },
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file is no Parquet that holds traces.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What was found and expected.
        reason: String,
    },
}
