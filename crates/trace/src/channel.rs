//! One channel.

/// Where a channel's values come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Origin {
    /// Read from a log.
    #[default]
    Measured,
    /// Handed to the model as an input: it agrees with the recording by construction and validates nothing.
    Driven,
    /// Computed by the model.
    Predicted,
}

/// Values of one quantity, one for each sample of the trace; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Name, ending in its unit.
    pub name: String,
    /// One value a sample, in the unit of the name.
    pub values: Vec<f64>,
    /// Measured, driven or predicted.
    pub origin: Origin,
}
