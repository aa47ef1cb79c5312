//! Runs as a Rerun recording: the vehicle on its path over the ground, its forces as arrows, and its channels as plots,
//! all on one timeline called `time`, in seconds.
//!
//! [`write()`] makes the file, [`show`] starts the viewer on it, [`open`] does both, [`serve`] serves it to browsers. Of a run with its recording both
//! vehicles are drawn, the recorded one transparent, and both lines stand in the same plot. [`write_diagnosis`] makes the file of a
//! diagnosis: where a model and a recording part, and what was found there.

mod axis;
mod balance;
mod blueprint;
mod colour;
mod entity;
mod error;
mod file;
mod flow;
mod forces;
mod ground;
mod groups;
mod implement;
mod lanes;
mod layout;
mod mesh;
mod mismatch;
mod path;
mod plots;
mod recorder;
mod relief;
mod ruts;
mod scene;
mod server;
mod setting;
#[cfg(all(test, unix))]
mod stand_in;
mod strip;
mod summary;
mod surroundings;
mod thin;
mod tractor;
mod trailer;
mod turn;
mod vehicle;
mod viewer;
mod wheel_channel;
mod wheels;

pub use error::ViewError;
pub use file::write;
pub use ground::Ground;
pub use mismatch::{Diagnosis, Effect, Left, Shown, write_diagnosis};
pub use scene::{Axis, Body, ForceArrow, Scene};
pub use server::{Server, serve};
pub use setting::{Implement, Relief, Rig, RigWheel, Setting, Towed};
pub use viewer::{VIEWER_VERSION, open, show};
