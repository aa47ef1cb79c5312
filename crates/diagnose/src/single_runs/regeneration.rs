//! Brakes that take over where a drive may give back no more: while somebody brakes, the drive gives back the same power all
//! the time, and never more than that at any other.
//!
//! Source: blending of brakes; Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.3.

use crate::Case;
use crate::runs::recorded::Recorded;
use crate::single_runs::brakes::{WINDOW_S, averaged};
use crate::single_runs::events::Event;
use headland_calibrate::statistics::{NORMAL_OF_MEDIAN, mean, median, quantile_of_sorted, sorted};

/// Fewer samples tell of no limit.
const FEWEST: usize = 30;
/// While somebody brakes, power stays within this share of the limit …
const SAME: f64 = 0.1;
/// … for this share of the time,
const MOSTLY: f64 = 0.7;
/// beyond walking pace, at which drives give back less [m/s].
const WALKING_M_S: f64 = 3.0;
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
            if *speed < WALKING_M_S {
                continue;
            }
            if own.iter().any(|event| (event.from_s..=event.to_s).contains(time_s)) {
                within.push(back_w);
            } else {
                outside.push(back_w);
            }
        }
    }
    limit_of(&within, &outside, greatest_w, events.len())
}

/// Leaves out what was recorded at the limit: brakes too weak to be told may have held back there.
pub fn leave_out(case: &Case, events: &[Event], sound: &mut [Vec<bool>]) {
    let Some((limit_w, _)) = limit_w(case, events) else { return };
    for (run, sound) in case.runs.iter().zip(sound) {
        let force = run.force_n.as_deref().unwrap_or(&[]);
        for ((sound, force), speed) in sound.iter_mut().zip(force).zip(&run.motion.value) {
            let at_limit = -force * speed >= (1.0 - SAME) * limit_w;
            *sound &= !at_limit;
        }
    }
}

/// Spells of a run at the limit beside those that are known, too weak to be told without it: whatever holds the vehicle back there
/// beside `left_n`, what is left of the model [N], is its brakes. A mean over [`WINDOW_S`] has a noise of `noise_n`.
pub fn weak(
    run: &Recorded,
    (limit_w, noise_n): (f64, f64),
    left_n: &[f64],
    known: impl Fn(f64) -> bool,
) -> Vec<Event> {
    /// Standard deviations from which on it is no noise.
    const SIGMAS: f64 = 6.0;
    let (Some(force_n), time_s) = (&run.force_n, run.measured.trace.time_s()) else { return Vec::new() };
    let back_w: Vec<f64> =
        force_n.iter().zip(&run.motion.value).map(|(force, speed)| -force * speed).collect();
    let back_w = averaged(time_s, &back_w);
    let at_limit = |sample: &usize| {
        back_w[*sample] >= (1.0 - SAME) * limit_w
            && left_n.get(*sample).is_some_and(|left_n| left_n.is_finite())
    };
    let samples: Vec<usize> =
        (0..time_s.len()).filter(|sample| at_limit(sample) && !known(time_s[*sample])).collect();
    let stretches = samples.chunk_by(|one, other| other - one == 1);
    let event = |stretch: &[usize]| {
        let (from_s, to_s) = (time_s[stretch[0]], time_s[stretch[stretch.len() - 1]]);
        let force_n = mean(&stretch.iter().map(|sample| left_n[*sample]).collect::<Vec<f64>>());
        let sd_n = noise_n / ((to_s - from_s) / WINDOW_S).max(1.0).sqrt();
        let gain = 0.5 * (force_n / sd_n).powi(2);
        Event { run: run.number, from_s, to_s, force_n, sd_n, gain, course: Vec::new() }
    };
    let told = |event: &Event| event.to_s - event.from_s >= WINDOW_S && event.force_n > SIGMAS * event.sd_n;
    stretches.map(event).filter(told).collect()
}

/// The limit of powers that are given back [W] while somebody brakes in so many spells, and at other times, by a drive that
/// drives with so much at most.
fn limit_of(within: &[f64], outside: &[f64], greatest_w: f64, spells: usize) -> Option<(f64, f64)> {
    if within.len() < FEWEST || outside.is_empty() {
        return None;
    }
    let limit_w = median(within);
    let deviations: Vec<f64> = within.iter().map(|power| (power - limit_w).abs()).collect();
    let same = deviations.iter().filter(|deviation| **deviation < SAME * limit_w).count() as f64;
    let beyond = quantile_of_sorted(&sorted(outside), HARDLY);
    let limits = limit_w > NOTHING * greatest_w
        && same >= MOSTLY * within.len() as f64
        && beyond < (1.0 + SAME) * limit_w;
    limits.then(|| {
        // What is known of a median of as many samples as there are spells: within one they are alike.
        (limit_w, NORMAL_OF_MEDIAN * median(&deviations) / (spells as f64).sqrt())
    })
}

#[cfg(test)]
mod tests {
    use super::limit_of;

    fn powers(of: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..100).map(|index| of(f64::from(index))).collect()
    }

    #[test]
    fn the_same_power_whenever_somebody_brakes_is_a_limit() {
        let braking = powers(|index| 4200.0 + 40.0 * (7.0 * index).sin());
        let driving = powers(|index| 4100.0 - 300.0 * index);
        let (limit_w, sd_w) = limit_of(&braking, &driving, 25_000.0, 9).unwrap();
        assert!((limit_w - 4200.0).abs() < 20.0 && sd_w < 20.0, "{limit_w} {sd_w}");
    }

    #[test]
    fn a_drive_that_gives_back_more_at_other_times_or_another_power_each_time_is_not_limited() {
        let braking = powers(|_| 4200.0);
        assert!(limit_of(&braking, &powers(|index| 9000.0 - 300.0 * index), 25_000.0, 9).is_none());
        assert!(limit_of(&powers(|index| 80.0 * index), &powers(|_| 0.0), 25_000.0, 9).is_none());
        // In neutral nothing is given back at all.
        assert!(limit_of(&powers(|_| 0.0), &powers(|_| 0.0), 25_000.0, 9).is_none());
        assert!(limit_of(&braking[..20], &powers(|_| 0.0), 25_000.0, 9).is_none());
    }
}
