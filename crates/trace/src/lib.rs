//! Named, unit-suffixed channels on a time base: what a simulation makes, what a log is read into, and what comparing,
//! diagnosing, plotting and storing take.
//!
//! A value that was not measured is NaN here and null in a file; nothing is ever filled in.

mod channel;
mod error;
pub mod names;
mod parquet_file;
mod trace;

pub use channel::{Channel, Origin};
pub use error::TraceError;
pub use parquet_file::{read_parquet, write_parquet};
pub use trace::{Run, Trace};
