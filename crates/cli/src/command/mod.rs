//! One file a command.

pub mod check;
pub mod plugins;
pub mod run;
