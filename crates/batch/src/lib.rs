//! Comparisons: variants × cycles × grounds × points × repetitions, run in parallel and told in one table.
//!
//! [`Comparison`] is what is written, [`Plan`] the runs that it stands for, each a number. [`execute`] runs what the
//! [`Journal`] does not hold yet; [`table`] and [`Summary`] are made from the journal, so that neither order, threads nor
//! interruptions leave a trace in them.

#![allow(clippy::result_large_err, reason = "a comparison is refused once, not in a loop")]

mod combine;
mod comparison;
mod draw;
mod entry;
mod error;
mod execute;
mod form;
mod frame;
mod identity;
mod journal;
mod measure;
mod plan;
#[cfg(test)]
mod plan_tests;
mod points;
mod row;
mod schema;
mod spread;
mod statistics;
mod summary;
pub mod table;

pub use comparison::{Accounting, Comparison};
pub use entry::Entry;
pub use error::BatchError;
pub use execute::{Progress, Settings, execute, run, trace_path};
pub use form::definitions;
pub use journal::{FILE as JOURNAL, Identity, Journal};
pub use measure::Measure;
pub use plan::{MOST_RUNS, Plan, Setting, Spec};
pub use points::{Drawn, Listed, Points};
pub use row::{Row, Status, account_column, account_of_column};
pub use schema::{Charge, Electricity, Fuel};
pub use spread::{Scatter, Spread};
pub use statistics::{Line, Statistics};
pub use summary::{Cell, Choice, Effect, Summary};
