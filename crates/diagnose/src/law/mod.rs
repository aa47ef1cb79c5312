//! A law of its own, for what nothing listed explains.

pub(crate) mod beside_courses;
pub(crate) mod foretells;
pub(crate) mod formula;
pub(crate) mod nameable;
mod small_laws;
mod sound;
mod standing;
pub(crate) mod unlisted;
mod window;
