//! Rows that stray, and functions drawn once more beside them.

pub(crate) mod straying;
pub(crate) mod student;
pub(crate) mod tails;
