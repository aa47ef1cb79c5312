//! What was chosen, without linearising, on runs that were held out; and what of it is taken back.

pub(crate) mod denied;
pub(crate) mod elsewhere;
pub(crate) mod forward;
pub(crate) mod in_doubt;
pub(crate) mod mirror;
pub(crate) mod prove;
pub(crate) mod proven;
pub(crate) mod refine;
pub(crate) mod simpler;
pub(crate) mod widths;
pub(crate) mod withdraw;
