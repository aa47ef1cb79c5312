//! What can go wrong with a coast-down analysis.

use headland_trace::TraceError;

/// A study that cannot be analysed.
#[derive(Debug, thiserror::Error)]
pub enum CoastDownError {
    /// There is nothing to analyse.
    #[error("the study has no run; expected at least one")]
    NoRun,
    /// Two runs have one name.
    #[error("run `{run}` stands twice; every run needs a name of its own")]
    Twice {
        /// The run.
        run: String,
    },
    /// The trace does not hold what is needed.
    #[error("run `{run}`: {source}")]
    Trace {
        /// The run.
        run: String,
        /// What is missing.
        source: TraceError,
    },
    /// A constant is impossible.
    #[error("run `{run}`: `{name}` is {found}, expected {expected}")]
    Constant {
        /// The run.
        run: String,
        /// The constant.
        name: &'static str,
        /// Its value.
        found: f64,
        /// What would be possible.
        expected: &'static str,
    },
    /// A setting is impossible.
    #[error("setting `{name}` is {found}, expected {expected}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// Its value.
        found: f64,
        /// What would be possible.
        expected: &'static str,
    },
    /// The vehicle does not roll out anywhere in the run.
    #[error(
        "run `{run}`: no coast-down found: {samples} usable samples and a drop of {drop_m_s:.2} m/s, expected at \
         least {least_samples} samples and {least_drop_m_s} m/s"
    )]
    NoCoasting {
        /// The run.
        run: String,
        /// Samples in its longest stretch.
        samples: usize,
        /// Speed lost in it [m/s].
        drop_m_s: f64,
        /// Samples needed.
        least_samples: usize,
        /// Speed loss needed [m/s].
        least_drop_m_s: f64,
    },
    /// The search did not settle.
    #[error("the fit of {model} did not settle after {linearisations} linearisations")]
    NotSettled {
        /// Which model.
        model: &'static str,
        /// How long it was tried.
        linearisations: usize,
    },
    /// The runs cannot determine the model at all.
    #[error("the runs cannot determine {model}: its parameters have no separate effect on speed")]
    Undetermined {
        /// Which model.
        model: &'static str,
    },
}
