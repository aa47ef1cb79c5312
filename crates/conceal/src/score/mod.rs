//! Runs a diagnosis on cases and holds what it says against what was concealed.

mod diagnosis;
mod judge;
mod page;
mod run;
mod statistics;

pub use diagnosis::{Diagnosis, Finding, Fit, FitPart, Interval};
pub use judge::{Covered, Found, IN_EFFECT, Improvement, Outcome, Reconstruction, judge};
pub use page::page;
pub use run::{Options, Scored, all};
pub use statistics::{correlation, wilson};
