//! Finds the physics that a scenario left out.
