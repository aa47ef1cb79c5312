//! What can go wrong with a comparison.

/// Two signals or two traces that cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// The signals differ in length.
    #[error("{measured} measured and {modelled} modelled values, expected as many of each")]
    Length {
        /// Measured samples.
        measured: usize,
        /// Modelled samples.
        modelled: usize,
    },
    /// Too few pairs have both values.
    #[error("{found} of {of} pairs have both values, expected 2 or more")]
    TooFew {
        /// Pairs with both values.
        found: usize,
        /// Pairs in all.
        of: usize,
    },
    /// The traces have no channel in common.
    #[error("run `{run}`: no channel in common; measured: {}; modelled: {}", measured.join(", "), modelled.join(", "))]
    NoSharedChannel {
        /// The run.
        run: String,
        /// The measured channels.
        measured: Vec<String>,
        /// The modelled channels.
        modelled: Vec<String>,
    },
    /// The traces share channels, and no moment of time.
    #[error(
        "run `{run}`: no overlap in time: measured from {} s to {} s, modelled from {} s to {} s",
        measured_s.0, measured_s.1, modelled_s.0, modelled_s.1
    )]
    NoOverlap {
        /// The run.
        run: String,
        /// First and last measured time (s); NaN of no samples.
        measured_s: (f64, f64),
        /// First and last modelled time (s); NaN of no samples.
        modelled_s: (f64, f64),
    },
    /// A text is no requirement.
    #[error(
        "`{text}` is no requirement: {reason}; expected a channel, a metric, < <= > or >=, and a limit, as in \"speed_m_s rmse < 0.2\""
    )]
    Requirement {
        /// What was found.
        text: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A requirement cannot be checked against a comparison.
    #[error("requirement `{requirement}`: {reason}")]
    Unchecked {
        /// The requirement.
        requirement: String,
        /// Why not.
        reason: String,
    },
}
