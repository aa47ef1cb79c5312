//! Tests of the whole: layering, scenarios, the commands together.

fn main() {}
