//! The search as its callers see it.

mod plant;
mod recovery;
mod refusals;
mod same_numbers;
mod steadiness;
