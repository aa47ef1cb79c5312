//! What can go wrong with a comparison.

/// Two signals or two traces that cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// The time base and the two signals differ in length.
    #[error("{time} times, {measured} measured and {modelled} modelled values, expected as many of each")]
    Length {
        /// Samples of the time base.
        time: usize,
        /// Measured samples.
        measured: usize,
        /// Modelled samples.
        modelled: usize,
    },
    /// Time does not increase.
    #[error("time does not increase at sample {index}: {before} s is followed by {after} s")]
    Time {
        /// Index of the later sample.
        index: usize,
        /// Time of the sample before [s].
        before: f64,
        /// Time found [s].
        after: f64,
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
    #[error("no channel in common; measured: {}; modelled: {}", measured.join(", "), modelled.join(", "))]
    NoSharedChannel {
        /// The measured channels.
        measured: Vec<String>,
        /// The modelled channels.
        modelled: Vec<String>,
    },
    /// The traces share channels, and no moment of time.
    #[error(
        "no overlap in time: measured from {} s to {} s, modelled from {} s to {} s",
        measured_s.0, measured_s.1, modelled_s.0, modelled_s.1
    )]
    NoOverlap {
        /// First and last measured time [s].
        measured_s: (f64, f64),
        /// First and last modelled time [s].
        modelled_s: (f64, f64),
    },
}
