//! Where a mismatch sits and what was found: in numbers, words and pictures.

pub(crate) mod change_points;
pub(crate) mod level;
pub(crate) mod locate;
pub(crate) mod map;
pub(crate) mod report;
pub(crate) mod words;
