//! What happens once, in a single run: brakes and spells.

pub(crate) mod brakes;
pub(crate) mod course;
pub(crate) mod events;
pub(crate) mod regeneration;
pub(crate) mod spells;
