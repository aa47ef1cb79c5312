//! Parameter estimation from recordings.
//!
//! [`coastdown`] turns coast-downs into rolling resistance and road loads with honest intervals.
//! The statistics underneath know nothing of vehicles and serve any estimation: [`least_squares`] minimises,
//! [`clusters`] pools runs and gives intervals that survive run-to-run variation, [`separable`] says what the
//! data cannot tell apart, [`statistics`] holds quantiles and seeded draws. Of what a recording lacks [`curved`] makes the
//! curvature, [`laid`] the distance along a path that several runs share, and [`sparse`] what lies between values that come
//! less often than rows.

pub mod clusters;
pub mod coastdown;
pub mod curved;
pub mod cvt_map;
pub mod fit;
pub mod laid;
pub mod least_squares;
pub mod separable;
pub mod sparse;
pub mod statistics;
pub mod study;
