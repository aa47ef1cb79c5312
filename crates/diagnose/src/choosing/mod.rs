//! Sets of causes: what they bring, how they grow, and which of them stands.

pub(crate) mod answering;
pub(crate) mod bend;
pub(crate) mod built;
pub(crate) mod conclude;
pub(crate) mod contest;
pub(crate) mod crossval;
pub(crate) mod exchange;
pub(crate) mod foreseen;
pub(crate) mod held;
pub(crate) mod in_neutral;
pub(crate) mod rivals;
pub(crate) mod search;
pub(crate) mod sharpen;
pub(crate) mod state;
pub(crate) mod stepped;
pub(crate) mod together;
pub(crate) mod windows;
