//! Engines that the wheels drive: where a vehicle slows down harder than its resistances do, the model's engine takes all of it
//! and no fuel. A driver brakes as well, and where nobody recorded it the engine may take less and go on to burn: what it does then
//! says nothing of forces and consumers.

use crate::recorded::Recorded;
use crate::said::Said;

/// Whether the model's engine takes no fuel at a sample whose force follows from the motion, in a run whose brakes were not
/// recorded.
pub fn overruns(run: &Recorded, said: &Said, sample: usize) -> bool {
    let told = run.force_n.as_ref().is_some_and(|force_n| force_n[sample].is_finite());
    let known = told || run.measured.trace.get("brake").is_some();
    !known && said.fuel_kg_s.as_ref().is_some_and(|fuel_kg_s| fuel_kg_s[sample] <= 0.0)
}
