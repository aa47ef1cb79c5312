//! The usual plots, from traces and arrays.
//!
//! A plot whose channels are not there is refused by [`headland_trace::TraceError::Missing`], so that the caller decides
//! whether it is needed.

mod balance;
mod motion;
mod stages;
mod statistics;

pub use balance::{energy_flow, force_budget};
pub use motion::{over_time, path_map, residual_against, residual_over_time};
pub use stages::{Stages, staged_flow};
pub use statistics::{Parameter, correlation, cumulative_probability, parameter_table};
