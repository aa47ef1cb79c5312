//! What a recording holds, as runs that the model can be driven along: their motion, place and force.

pub(crate) mod begun;
pub(crate) mod late_power;
pub(crate) mod leaps;
pub(crate) mod overrun;
pub(crate) mod placed;
pub(crate) mod places;
pub(crate) mod recorded;
pub(crate) mod said;
pub(crate) mod split;
pub(crate) mod standin;
pub(crate) mod thinned;
pub(crate) mod way;
