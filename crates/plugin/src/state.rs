//! What a model remembers.

/// One state of a model; the simulation integrates it.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Name, ending in its unit; it becomes a channel of the trace.
    pub name: &'static str,
    /// Value at the start of a run.
    pub initial: f64,
}
