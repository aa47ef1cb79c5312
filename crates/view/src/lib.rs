//! Runs as a Rerun recording: the vehicle on its path over the ground, its forces as arrows, and its channels as plots,
//! all on one timeline called `time`, in seconds.
//!
//! [`write()`] makes the file, [`show`] starts the viewer on it, [`open`] does both. Of a run with its recording both
//! vehicles are drawn, the recorded one transparent, and both lines stand in the same plot.

mod blueprint;
mod colour;
mod entity;
mod error;
mod file;
mod forces;
mod ground;
mod groups;
mod lanes;
mod mesh;
mod path;
mod plots;
mod recorder;
mod scene;
mod strip;
mod summary;
mod surroundings;
mod thin;
mod tractor;
mod vehicle;
mod viewer;

pub use error::ViewError;
pub use file::write;
pub use ground::Ground;
pub use scene::{Axis, Body, ForceArrow, Scene};
pub use viewer::{VIEWER_VERSION, open, show};
