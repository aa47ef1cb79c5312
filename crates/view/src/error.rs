//! What can go wrong between runs and a picture of them.

use std::path::PathBuf;

/// A scene that cannot be drawn, a file that cannot be written, a viewer that cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// There is nothing to draw.
    #[error("there is no run to draw")]
    NoRun,
    /// Two runs have the same name.
    #[error("run `{run}` stands twice")]
    Twice {
        /// The name.
        run: String,
    },
    /// A run says nowhere where the vehicle is.
    #[error(
        "run `{run}` has no path: expected `position_m`, or `east_m` and `north_m`; there are: {}",
        present.join(", ")
    )]
    NoPath {
        /// The run.
        run: String,
        /// The channels that are there.
        present: Vec<String>,
    },
    /// The channels of the path never hold numbers at the same sample.
    #[error("run `{run}` has no sample at which each of {} is a number", channels.join(", "))]
    NoPose {
        /// The run.
        run: String,
        /// The channels of the path.
        channels: Vec<&'static str>,
    },
    /// A force that no run has.
    #[error("no run has the force `{channel}`; there are: {}", present.join(", "))]
    Force {
        /// The channel.
        channel: String,
        /// The channels of the first run.
        present: Vec<String>,
    },
    /// A vehicle of no size.
    #[error("`{name}` of the vehicle is {found}, expected a number above 0")]
    Body {
        /// Which measure.
        name: &'static str,
        /// Its value.
        found: f64,
    },
    /// A ground with the wrong number of heights.
    #[error("the ground has {found} heights, expected {expected}")]
    GroundSize {
        /// Number of heights.
        found: usize,
        /// What the positions ask for.
        expected: usize,
    },
    /// A number of the ground that is none, or does not increase where it has to.
    #[error("the ground's `{name}` is {found} at index {index}, expected {expected}")]
    GroundValue {
        /// Which number.
        name: &'static str,
        /// Where it stands.
        index: usize,
        /// Its value.
        found: f64,
        /// What it has to be.
        expected: &'static str,
    },
    /// Numbers that stand row by row and are not as many.
    #[error("`{name}` of run `{run}` has {found} rows, expected {expected}")]
    Rows {
        /// The run.
        run: String,
        /// What the numbers are.
        name: &'static str,
        /// How many there are.
        found: usize,
        /// How many times there are.
        expected: usize,
    },
    /// Rerun refused the data.
    #[error("the recording could not be encoded: {reason}")]
    Encode {
        /// In Rerun's words.
        reason: String,
    },
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// There is no viewer.
    #[error(
        "no `rerun` on the PATH to show {} with; `pip install rerun-sdk=={version}` brings it",
        path.display()
    )]
    NoViewer {
        /// The file that was to be shown.
        path: PathBuf,
        /// The viewer's version that fits.
        version: &'static str,
    },
    /// The viewer is of a version that may not read the file.
    #[error(
        "{} is of version {found}, expected {version}; `pip install rerun-sdk=={version}` brings it",
        viewer.display()
    )]
    OtherViewer {
        /// The viewer.
        viewer: PathBuf,
        /// Its version.
        found: String,
        /// The version that fits.
        version: &'static str,
    },
    /// A viewer that is served does not answer.
    #[error("{} does not answer after {seconds} s", viewer.display())]
    Silent {
        /// The viewer.
        viewer: PathBuf,
        /// How long was waited [s].
        seconds: u64,
    },
    /// The viewer ended as soon as it was started.
    #[error("{} ended at once ({status}); it needs a display and a graphics driver", viewer.display())]
    Ended {
        /// The viewer.
        viewer: PathBuf,
        /// How.
        status: std::process::ExitStatus,
    },
}
