//! A measured and a modelled trace, compared channel by channel.
//!
//! Every number is a function of paired samples: the model is brought to the time base of the recording, a pair that
//! lacks either value is dropped and counted, and nothing is filled in. All errors are modelled minus measured, so a
//! positive bias means that the model is too high. A channel that was an input of the model is reported as driven and
//! never counted as validated.
//!
//! No single number is enough: totals are blind to errors that cancel, a cumulative probability is blind to the order
//! in time, and every error of a shape grows with a delay. So each comparison carries all of them.

pub mod align;
pub mod autocorrelation;
pub mod cdf;
pub mod direction;
pub mod dtw;
mod error;
pub mod iso18571;
pub mod lag;
mod metrics;
mod requirement;
mod runs;
pub mod sprague_geers;
pub mod statistics;
mod summary;
pub mod theil;
pub mod total;

pub use align::{Aligned, Dropped, align};
pub use autocorrelation::{LjungBox, autocorrelation_lag1, effective_sample_size, ljung_box};
pub use cdf::{CdfComparison, CdfPoint, band_half_width, cdf_comparison};
pub use error::CompareError;
pub use iso18571::{Grade, IsoRating, iso18571};
pub use lag::{Lag, cross_correlation_lag};
pub use metrics::{Metrics, Regression, metrics};
pub use requirement::{Metric, Relation, Requirement};
pub use runs::{ChannelComparison, RunComparison, Skipped, WhySkipped, compare_runs, compare_traces};
pub use sprague_geers::{Russell, SpragueGeers, russell, sprague_geers};
pub use statistics::quantile;
pub use summary::{ChannelSummary, Check, Summary, summarise};
pub use theil::{Theil, theil};
pub use total::{CRITERION, Total, integral, integral_unit, total};
