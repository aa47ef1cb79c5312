//! The balances in rows, side by side, with their noise.

pub(crate) mod balance;
pub(crate) mod gram;
pub(crate) mod likeliest;
pub(crate) mod loudness;
pub(crate) mod noise;
pub(crate) mod rows;
pub(crate) mod steps;
