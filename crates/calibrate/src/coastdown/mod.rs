//! Coast-downs: rolling resistance and road loads from v(t) of a vehicle that rolls out.
//!
//! Two ways lead from the same runs to a coefficient. [`two_stage`] is the aggregation of the reference study, which
//! differentiates speed and pools samples. [`analyse`] fits v(t) itself, without differentiating, gives intervals that
//! hold for ten runs, separates what both directions separate, and says what they do not.
//!
//! m_eff dv/dt = −(f0 + f1 v + f2 v²) − m g θ d − ρ CdA w v d          d = ±1, the direction of the run on its path

mod curve;
mod error;
mod estimate;
mod fit;
mod input;
mod motion;
mod noise;
mod null_space;
mod report;
mod segment;
mod study;
pub mod synthetic;
mod tables;
#[cfg(test)]
mod tests;
mod two_stage;

pub use curve::Curve;
pub use error::CoastDownError;
pub use input::{CoastRun, Constant, Settings, SpeedUnit};
pub use report::{
    CoastDown, Estimate, FitReport, ForceAt, LeftOut, PairRow, RoadLoad, RunRow, SCHEMA, SpeedLaw,
    UnitReading,
};
pub use study::{Study, analyse};
pub use two_stage::{Pool, RunCoefficient, TwoStage};
