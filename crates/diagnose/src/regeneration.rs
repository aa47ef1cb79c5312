//! Brakes that take over where a drive may give back no more: while somebody brakes, the drive gives back the same power all
//! the time, and never more than that at any other.
//!
//! Source: blending of brakes; Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.3.

use crate::Case;
use crate::events::Event;
use headland_calibrate::statistics::{NORMAL_OF_MEDIAN, median, quantile_of_sorted, sorted};

/// Fewer samples tell of no limit.
const FEWEST: usize = 30;
/// While somebody brakes, power stays within this share of the limit …
const SAME: f64 = 0.1;
/// … for this share of the time: drives give back less at walking pace.
const MOSTLY: f64 = 0.7;
/// At any other time hardly a sample exceeds it by more.
const HARDLY: f64 = 0.995;
/// A drive that gives back less than this share of what it drives with gives back nothing.
const NOTHING: f64 = 0.01;

/// The power at the wheels that the drive gives back at most [W], with its standard deviation, where it is what makes
/// somebody brake.
pub fn limit_w(case: &Case, events: &[Event]) -> Option<(f64, f64)> {
    if !case.wanted("regeneration_limit") {
        return None;
    }
    let (mut within, mut outside, mut greatest_w) = (Vec::new(), Vec::new(), 0.0_f64);
    for (number, run) in case.runs.iter().enumerate() {
        let own: Vec<&Event> = events.iter().filter(|event| event.run == number).collect();
        let force = run.force_n.as_deref().unwrap_or(&[]);
        for ((time_s, force), speed) in run.measured.trace.time_s().iter().zip(force).zip(&run.motion.value) {
            let back_w = -force * speed;
            if !back_w.is_finite() {
                continue;
            }
            greatest_w = greatest_w.max(-back_w);
            if own.iter().any(|event| (event.from_s..=event.to_s).contains(time_s)) {
                within.push(back_w);
            } else {
                outside.push(back_w);
            }
        }
    }
    if within.len() < FEWEST || outside.is_empty() {
        return None;
    }
    let limit_w = median(&within);
    let deviations: Vec<f64> = within.iter().map(|power| (power - limit_w).abs()).collect();
    let same = deviations.iter().filter(|deviation| **deviation < SAME * limit_w).count() as f64;
    let beyond = quantile_of_sorted(&sorted(&outside), HARDLY);
    let limits = limit_w > NOTHING * greatest_w
        && same >= MOSTLY * within.len() as f64
        && beyond < (1.0 + SAME) * limit_w;
    limits.then(|| {
        // What is known of a median of as many samples as there are spells: within one they are alike.
        let spells = (events.len() as f64).sqrt();
        (limit_w, NORMAL_OF_MEDIAN * median(&deviations) / spells)
    })
}
