//! Engines that the wheels drive: where a vehicle slows down harder than its resistances do, the model's engine takes all of it
//! and no fuel. A driver brakes as well, and where nobody recorded it the engine may take less and go on to burn: what it does then
//! says nothing of forces and consumers. Nor does it where the force was measured at wheels that brakes hold as well. And where the
//! vehicle's engine cut its fuel the model's may burn some, on a slope that the scenario does not know: the fuel says no more there
//! than that the wheels drove the engine, however hard they did. A run that drove up there tells how steep it is. Where both cut their fuel
//! it says nothing at all: it has no noise there, which is not that of an engine that works, and no consumer shows in it.
//!
//! An engine that idles while the vehicle slows down has nothing to do with its wheels: it is out of gear, or the driver brakes. What
//! the motion asks for there, and with it every gust and every hump, is none of its fuel.

use crate::Case;
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::soundness::faults::SLOWEST_M_S;
use headland_calibrate::statistics::{mean, median, quantile_of_sorted, sorted};
use std::collections::BTreeSet;

/// Share of the fuel that an engine takes elsewhere: one that takes more than this has not cut it off.
const BURNS: f64 = 0.05;
/// Less than this share of it is no fuel.
const NOTHING: f64 = 0.02;
/// Places that are no further apart are one [m].
const ONE_PLACE_M: f64 = 20.0;

/// The samples at which the model's engine takes no fuel and that of the vehicle may: the force follows from the motion in a run
/// whose brakes were not recorded, or the fuel itself says that the engine went on to burn. Then whatever slows the wheels may be
/// their brakes; and so it may where both the force at the wheels and the engine's own torque were measured and hold back, but for
/// a switch that says that nobody braked. By fuel alone none of them says anything.
pub fn overruns(run: &Recorded, said: &Said) -> Vec<bool> {
    let Some(modelled) = &said.fuel_kg_s else { return vec![false; run.measured.trace.len()] };
    let switch = run.measured.trace.get("brake");
    let brake = switch.is_some();
    let measured = run.measured.trace.get("fuel_rate_kg_s");
    let burns = measured.is_some_and(|measured| goes_on_to_burn(measured, modelled));
    let idles = idles(run, modelled);
    let of = |(sample, modelled): (usize, &f64)| {
        let force_n = run.force_n.as_ref().map_or(f64::NAN, |force_n| force_n[sample]);
        let cut = *modelled <= 0.0;
        let held_back = run.engine_w.as_ref().is_some_and(|power_w| power_w[sample] < 0.0) && force_n < 0.0;
        let may_brake = switch.is_none_or(|switch| switch[sample] >= 0.5 || switch[sample].is_nan());
        let overruns = cut && !force_n.is_finite() && !brake || burns && (cut || force_n < 0.0);
        is_silent(*modelled, run.engine_w.is_some()) || overruns || held_back && may_brake || idles[sample]
    };
    modelled.iter().enumerate().map(of).collect()
}

/// Whether the fuel that is measured says nothing where the model's engine takes so much [kg/s]: none, and nobody recorded its torque.
fn is_silent(modelled_kg_s: f64, by_torque: bool) -> bool {
    modelled_kg_s <= 0.0 && !by_torque
}

/// The samples at which an engine idles, in a run whose force follows from the motion.
fn idles(run: &Recorded, modelled: &[f64]) -> Vec<bool> {
    let trace = &run.measured.trace;
    let nowhere = vec![false; trace.len()];
    let Some(fuel_kg_s) = trace.get("fuel_rate_kg_s") else { return nowhere };
    if run.force_is_known() || trace.get("coasting").is_some() {
        return nowhere;
    }
    let moves = |sample: usize| run.motion.value[sample] > SLOWEST_M_S && fuel_kg_s[sample] > 0.0;
    let moving: Vec<usize> = (0..trace.len()).filter(|sample| moves(*sample)).collect();
    let mut idles = nowhere;
    for sample in lowest(&moving, &run.motion.slope, fuel_kg_s, modelled) {
        idles[sample] = true;
    }
    idles
}

/// Those of some samples at which the fuel is as low as it gets, where that is a good part of them, and the vehicle slows down all
/// that time as it does when it rolls freely: the model's engine takes as much. One that rolls at a steady speed with as little works
/// for it.
fn lowest(moving: &[usize], slope_m_s2: &[f64], fuel_kg_s: &[f64], modelled: &[f64]) -> Vec<usize> {
    /// Share of the samples that take less: the noise of a sensor.
    const LEAST: f64 = 0.05;
    /// Fuel of an idling engine is the same within this share of it.
    const SAME: f64 = 0.05;
    /// Share of the time that it is low, and of that time that the vehicle slows down.
    const OFTEN: f64 = 0.05;
    const SLOWS: f64 = 0.95;
    /// What the model's engine takes there differs by less than this share.
    const ALIKE: f64 = 0.25;
    let of = |samples: &[usize], values: &[f64]| -> Vec<f64> {
        samples.iter().map(|sample| values[*sample]).collect()
    };
    let least_kg_s = quantile_of_sorted(&sorted(&of(moving, fuel_kg_s)), LEAST);
    let low = |sample: &usize| (fuel_kg_s[*sample] / least_kg_s - 1.0).abs() < SAME;
    let low: Vec<usize> = moving.iter().copied().filter(low).collect();
    let slows = low.iter().filter(|sample| slope_m_s2[**sample] < 0.0).count() as f64;
    let apart = (mean(&of(&low, modelled)) / mean(&of(&low, fuel_kg_s)) - 1.0).abs();
    let count = low.len() as f64;
    let idles = count > OFTEN * moving.len() as f64 && slows > SLOWS * count && apart < ALIKE;
    if idles { low } else { Vec::new() }
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

/// Leaves samples out at which an engine cut its fuel in a place of a shared path where one burnt some as well, as those that come
/// from the other side do. Where one run alone drove a path, nothing else tells that it went downhill.
pub fn leave_out(case: &Case, usable: &mut [Vec<bool>]) {
    let burnt: Vec<Vec<Burnt>> = case.runs.iter().map(|run| burnt(run).unwrap_or_default()).collect();
    #[expect(clippy::cast_possible_truncation, reason = "a place of some kilometres")]
    let place =
        |run: &Recorded, sample: usize| (run.path, (run.position_m[sample] / ONE_PLACE_M).round() as i64);
    let is_shared = |run: &&Recorded| case.runs.iter().filter(|other| other.path == run.path).count() > 1;
    let samples_of = |wanted: Burnt| {
        let of_run = |run: &Recorded| {
            let own = burnt[run.number].iter().enumerate().filter(|(_, burnt)| **burnt == wanted);
            own.map(|(sample, _)| (run.number, sample, place(run, sample))).collect::<Vec<_>>()
        };
        case.runs.iter().filter(is_shared).flat_map(of_run).collect::<Vec<_>>()
    };
    let told: BTreeSet<_> = samples_of(Burnt::Some).into_iter().map(|(_, _, place)| place).collect();
    for (number, sample, place) in samples_of(Burnt::Nothing) {
        if told.contains(&place) {
            usable[number][sample] = false;
        }
    }
}

/// What an engine took at a sample.
#[derive(Clone, Copy, PartialEq)]
enum Burnt {
    Nothing,
    Some,
    /// Nobody knows, or the vehicle stood, or what drives it was measured.
    NoMatter,
}

/// What the engine of a run took, sample by sample; none where that was not recorded, or its torque was as well.
fn burnt(run: &Recorded) -> Option<Vec<Burnt>> {
    if run.engine_w.is_some() {
        return None;
    }
    let fuel_kg_s = run.measured.trace.get("fuel_rate_kg_s")?;
    let least_kg_s = NOTHING * usual_kg_s(fuel_kg_s);
    let of = |(sample, own_kg_s): (usize, &f64)| {
        let follows = run.force_n.as_ref().is_none_or(|force_n| !force_n[sample].is_finite());
        match run.motion.value[sample] > SLOWEST_M_S && follows && own_kg_s.is_finite() {
            true if *own_kg_s > least_kg_s => Burnt::Some,
            true => Burnt::Nothing,
            false => Burnt::NoMatter,
        }
    };
    Some(fuel_kg_s.iter().enumerate().map(of).collect())
}

/// What an engine takes in the middle of the time that it takes any [kg/s].
fn usual_kg_s(measured: &[f64]) -> f64 {
    let burnt: Vec<f64> = measured.iter().copied().filter(|own| *own > 0.0).collect();
    if burnt.is_empty() { 0.0 } else { median(&burnt) }
}

#[cfg(test)]
mod tests {
    use super::{goes_on_to_burn, is_silent, lowest};

    /// Fuel without force of vehicles that free-wheel when they slow down was told as another rolling resistance by its speed where
    /// nothing was missing.
    #[test]
    fn an_engine_idles_where_its_fuel_is_lowest_while_the_vehicle_rolls_out() {
        let moving: Vec<usize> = (0..100).collect();
        let rolls = |sample: usize| sample % 10 < 4;
        let of = |idle: f64, works: f64| -> Vec<f64> {
            moving.iter().map(|sample| if rolls(*sample) { idle } else { works }).collect()
        };
        let (fuel, slows) = (of(4e-4, 2e-3), of(-0.2, 0.1));
        let rolled: Vec<usize> = moving.iter().copied().filter(|sample| rolls(*sample)).collect();
        assert_eq!(lowest(&moving, &slows, &fuel, &of(4.3e-4, 2e-3)), rolled);
        // A steady speed, and brakes or a consumer that the model does not know.
        assert!(lowest(&moving, &of(0.001, 0.1), &fuel, &fuel).is_empty());
        assert!(lowest(&moving, &slows, &fuel, &of(1e-4, 2e-3)).is_empty());
        assert!(lowest(&[], &[], &[], &[]).is_empty());
    }

    /// Rows without noise were taken for those of a fuel that is known as well everywhere, and consumers of 6.5 kW were told where nothing
    /// was hidden.
    #[test]
    fn fuel_that_is_cut_off_says_nothing() {
        assert!(is_silent(0.0, false) && !is_silent(2e-4, false));
        // Its torque says how hard the wheels drive it.
        assert!(!is_silent(0.0, true) && !is_silent(f64::NAN, false));
    }

    #[test]
    fn an_engine_that_idles_where_the_model_cuts_its_fuel_burns() {
        let modelled = [0.0, 0.0, 0.0, 2e-3, 3e-3, f64::NAN];
        assert!(goes_on_to_burn(&[4e-4, 4e-4, 0.0, 2e-3, 3e-3, 1e-3], &modelled));
        assert!(!goes_on_to_burn(&[4e-4, 0.0, 0.0, 2e-3, 3e-3, 1e-3], &modelled));
        assert!(!goes_on_to_burn(&[2e-3, 3e-3], &[2e-3, 3e-3]));
        assert!(!goes_on_to_burn(&[f64::NAN, 3e-3], &[0.0, 3e-3]));
    }
}
