//! Which samples can be trusted, and which recordings contradict themselves.

pub(crate) mod contradiction;
pub(crate) mod engine_off;
pub(crate) mod faults;
pub(crate) mod filled;
pub(crate) mod stuck;
pub(crate) mod unmoved;
pub(crate) mod unsourced;
pub(crate) mod voltage;
