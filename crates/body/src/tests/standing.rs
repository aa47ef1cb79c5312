//! Static loads.
