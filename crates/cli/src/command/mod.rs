//! One file a command.

pub mod batch;
pub mod calibrate;
pub mod check;
pub mod coastdown;
pub mod compare;
pub mod cvt_map;
pub mod demo;
pub mod diagnose;
mod drawn;
pub mod optimum;
pub mod plugins;
pub mod run;
pub mod schema;
pub mod terrain;
pub mod validate;
