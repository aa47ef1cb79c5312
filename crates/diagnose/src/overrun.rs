//! Engines that the wheels drive: where a vehicle slows down harder than its resistances do, the model's engine takes all of it
//! and no fuel. A driver brakes as well, and where nobody recorded it the engine may take less and go on to burn: what it does then
//! says nothing of forces and consumers. Nor does it where the force was measured at wheels that brakes hold as well.

use crate::recorded::Recorded;
use crate::said::Said;
use headland_calibrate::statistics::median;

/// Share of the fuel that an engine takes elsewhere: one that takes more than this has not cut it off.
const BURNS: f64 = 0.05;

/// The samples at which the model's engine takes no fuel and that of the vehicle may: the force follows from the motion in a run
/// whose brakes were not recorded, or the fuel itself says that the engine went on to burn. Then whatever slows the wheels may be
/// their brakes.
pub fn overruns(run: &Recorded, said: &Said) -> Vec<bool> {
    let Some(modelled) = &said.fuel_kg_s else { return vec![false; run.measured.trace.len()] };
    let brake = run.measured.trace.get("brake").is_some();
    let measured = run.measured.trace.get("fuel_rate_kg_s");
    let burns = measured.is_some_and(|measured| goes_on_to_burn(measured, modelled));
    let of = |(sample, modelled): (usize, &f64)| {
        let force_n = run.force_n.as_ref().map_or(f64::NAN, |force_n| force_n[sample]);
        let cut = *modelled <= 0.0;
        cut && !force_n.is_finite() && !brake || burns && (cut || force_n < 0.0)
    };
    modelled.iter().enumerate().map(of).collect()
}

/// Whether the fuel was not cut off most of the time that the model says so.
fn goes_on_to_burn(measured: &[f64], modelled: &[f64]) -> bool {
    let of = |cut: bool| -> Vec<f64> {
        let pairs = measured.iter().zip(modelled);
        pairs.filter(|(own, said)| own.is_finite() && (**said <= 0.0) == cut).map(|(own, _)| *own).collect()
    };
    let (cut, elsewhere) = (of(true), of(false));
    !cut.is_empty() && !elsewhere.is_empty() && median(&cut) > BURNS * median(&elsewhere)
}

#[cfg(test)]
mod tests {
    use super::goes_on_to_burn;

    #[test]
    fn an_engine_that_idles_where_the_model_cuts_its_fuel_burns() {
        let modelled = [0.0, 0.0, 0.0, 2e-3, 3e-3, f64::NAN];
        assert!(goes_on_to_burn(&[4e-4, 4e-4, 0.0, 2e-3, 3e-3, 1e-3], &modelled));
        assert!(!goes_on_to_burn(&[4e-4, 0.0, 0.0, 2e-3, 3e-3, 1e-3], &modelled));
        assert!(!goes_on_to_burn(&[2e-3, 3e-3], &[2e-3, 3e-3]));
        assert!(!goes_on_to_burn(&[f64::NAN, 3e-3], &[0.0, 3e-3]));
    }
}
