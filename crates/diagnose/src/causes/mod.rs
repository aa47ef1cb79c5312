//! Causes as regressors: effects, faults of sensors, small losses, functions of place and time.

pub(crate) mod abreast;
pub(crate) mod band;
pub(crate) mod catalogue;
pub(crate) mod clocks;
pub(crate) mod cycles;
pub(crate) mod eliminated;
pub(crate) mod functions;
pub(crate) mod jumps;
pub(crate) mod losses;
pub(crate) mod own;
pub(crate) mod profile;
pub(crate) mod remembered;
pub(crate) mod sensors;
pub(crate) mod slowed;
pub(crate) mod spreading;
pub(crate) mod trial;
pub(crate) mod windowed;
