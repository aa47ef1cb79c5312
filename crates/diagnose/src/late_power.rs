//! A power that is measured late: a flow meter behind a pump and a filter, a battery's current from another bus.
//!
//! y(t) = a x(t − d), both without what lasts: y the power that was measured, x the one that the nominal model makes of the rest of
//! the recording, as fast as it is or following with a time constant. What an engine or a pump takes time for follows with a time
//! constant; a delay is what no time constant explains. d and the time constant are looked for on a grid, a by least squares; that
//! residuals of one second are alike is taken for granted. What is told is how late the power is in the mean, by both.
//!
//! Source: time delays by correlation of prefiltered signals; Ljung, *System Identification* (1999), section 6.4 and example 17.2.

use crate::balance::Kind;
use crate::faults::{Fault, place};
use crate::recorded::Recorded;
use crate::refine::HALF_95;
use crate::report::Interval;
use crate::said::Said;
use crate::sensors::{interpolate, with_channel};
use crate::{Case, DiagnoseError};
use headland_recording::renewed_s;

/// The fault that it is.
const LATENCY: &str = "latency";
/// Signals are brought to one period [s], and delays are tried in steps of it.
const STEP_S: f64 = 0.05;
/// The longest delay that is tried [s].
const LONGEST_S: f64 = 4.0;
/// What lasts longer is left out [s]: causes that are not known yet.
const LASTING_S: f64 = 15.0;
/// What is shorter is noise [s].
const SHORT_S: f64 = 0.5;
/// Time constants with which a power may follow [s].
const FOLLOWING_S: [f64; 6] = [0.0, 0.25, 0.5, 1.0, 2.0, 4.0];
/// Two of them lie so far apart, as a share of each.
const BETWEEN: f64 = 4.0;
/// Residuals are independent after so long [s].
const INDEPENDENT_S: f64 = 1.0;
/// Growth of ln p from which on a delay is one.
const LEAST_GAIN: f64 = 20.0;
/// Less is what every bus and filter does [s].
const LEAST_S: f64 = 0.3;
/// The model has to explain this share of the power's variance, or there is nothing to compare.
const EXPLAINED: f64 = 0.3;

/// How late a power is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Late {
    /// Its channels.
    channels: &'static [&'static str],
    /// The delay [s].
    value: f64,
    /// Its standard deviation [s].
    sd: f64,
}

/// A measured power and the modelled one, on one period and without what lasts.
struct Pair {
    measured: Vec<f64>,
    modelled: Vec<f64>,
}

/// The powers that are late.
pub fn late(case: &Case) -> Vec<Late> {
    let powers: [(Kind, &'static [&'static str]); 2] = [
        (Kind::Fuel, &["fuel_rate_kg_s"]),
        (Kind::Battery, &["battery_power_w", "battery_current_a", "battery_voltage_v"]),
    ];
    if !case.wanted(LATENCY) {
        return Vec::new();
    }
    let of = |(kind, channels): (Kind, &'static [&'static str])| {
        let runs = case.runs.iter().zip(&case.nominal);
        let pairs: Vec<Pair> = runs.filter_map(|(run, said)| pair(run, said, kind, channels[0])).collect();
        let (value, sd) = told(&pairs)?;
        let renewal_s =
            case.runs.iter().map(|run| renewed_s(&run.measured.trace, channels[0])).fold(0.0, f64::max);
        (value > LEAST_S.max(2.0 * renewal_s)).then_some(Late { channels, value, sd })
    };
    powers.into_iter().filter_map(of).collect()
}

/// Sets a late power right in all runs.
pub fn set_right(case: &mut Case, late: Late, usable: &mut [Vec<bool>]) -> Result<Fault, DiagnoseError> {
    for (run, usable) in case.raw.iter_mut().zip(usable) {
        let time_s = run.measured.trace.time_s().to_vec();
        for name in late.channels {
            let Some(samples) = run.measured.trace.get(name) else { continue };
            let sooner = time_s.iter().map(|time| interpolate(&time_s, samples, time + late.value)).collect();
            run.measured.trace = with_channel(&run.measured.trace, name, sooner)?;
        }
        // What a late sensor would have said after the end nobody knows.
        for (usable, time) in usable.iter_mut().zip(&time_s) {
            *usable &= time + late.value <= time_s[time_s.len() - 1];
        }
    }
    case.runs.clone_from(&case.raw);
    let own = |name: &&&str| **name != "battery_power_w";
    case.late_powers.extend(late.channels.iter().filter(own).map(|name| (*name, late.value)));
    case.suppose()?;
    let stretch = |run: &Recorded| place(run, 0, run.measured.trace.len() - 1);
    let stretches: Vec<Interval> = case.runs.iter().map(stretch).collect();
    let half = HALF_95 * late.sd;
    Ok(Fault {
        id: LATENCY,
        channel: late.channels[late.channels.len().min(2) - 1].to_owned(),
        size: late.value,
        ci95: Some([late.value - half, late.value + half]),
        leaps: false,
        unit: "s".to_owned(),
        stretches,
    })
}

fn pair(run: &Recorded, said: &Said, kind: Kind, channel: &str) -> Option<Pair> {
    let trace = &run.measured.trace;
    let measured = trace.get(channel)?;
    let modelled = match kind {
        // What the engine was measured to do is nearer to its fuel than what wheels say.
        Kind::Fuel => run.engine_w.as_ref().or(said.fuel_kg_s.as_ref())?,
        _ => said.battery_w.as_ref()?,
    };
    let time_s = trace.time_s();
    let whole = (time_s[time_s.len() - 1] - time_s[0]) / STEP_S;
    // Counts of a grid.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
    let count = whole as usize;
    let even = |samples: &[f64]| -> Option<Vec<f64>> {
        let known: (Vec<f64>, Vec<f64>) =
            time_s.iter().zip(samples).filter(|(_, sample)| sample.is_finite()).unzip();
        // A channel that is mostly unknown has nothing to compare.
        if 2 * known.0.len() < samples.len() || known.0.len() < 2 {
            return None;
        }
        Some(
            (0..count)
                .map(|index| interpolate(&known.0, &known.1, time_s[0] + STEP_S * index as f64))
                .collect(),
        )
    };
    let (measured, modelled) = (even(measured)?, even(modelled)?);
    (count as f64 * STEP_S > 2.0 * LASTING_S).then_some(Pair { measured, modelled })
}

/// The delay that suits all runs best and its standard deviation; none where no delay is needed.
fn told(pairs: &[Pair]) -> Option<(f64, f64)> {
    // Steps of a grid.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
    let steps = (LONGEST_S / STEP_S) as usize;
    let measured: Vec<Vec<f64>> = pairs.iter().map(|pair| band(&pair.measured)).collect();
    let samples: usize = measured.iter().map(|one| one.len().saturating_sub(steps)).sum();
    let independent = samples as f64 * STEP_S / INDEPENDENT_S;
    let variance = measured.iter().flatten().map(|value| value * value).sum::<f64>();
    if samples == 0 || variance == 0.0 {
        return None;
    }
    // Sum of squares with each delay, and the time constant that suits it best.
    let mut left = vec![f64::INFINITY; steps + 1];
    let mut following_s = vec![0.0; steps + 1];
    let mut whole = f64::INFINITY;
    for constant_s in FOLLOWING_S {
        let following: Vec<Vec<f64>> =
            pairs.iter().map(|pair| band(&follow(&pair.modelled, constant_s))).collect();
        for (delay, (left, following_s)) in left.iter_mut().zip(&mut following_s).enumerate() {
            let (mut square, mut cross, mut own) = (0.0, 0.0, 0.0);
            for (measured, modelled) in measured.iter().zip(&following) {
                // The same samples of what was measured for every delay.
                for (index, value) in measured.iter().enumerate().skip(steps) {
                    let model = modelled[index - delay];
                    square += value * value;
                    cross += value * model;
                    own += model * model;
                }
            }
            whole = square;
            let explained = if own > 0.0 && cross > 0.0 { cross * cross / own } else { 0.0 };
            if square - explained < *left {
                (*left, *following_s) = (square - explained, constant_s);
            }
        }
    }
    let best = (0..=steps).min_by(|one, other| left[*one].total_cmp(&left[*other]))?;
    let gain = 0.5 * independent * (left[0] / left[best]).ln();
    if gain < LEAST_GAIN || left[best] > (1.0 - EXPLAINED) * whole || best == steps {
        return None;
    }
    let by_one = left[best] * (2.0 / independent).exp();
    let near = (0..=steps).filter(|delay| left[*delay] < by_one);
    let farthest = near.map(|delay| delay.abs_diff(best)).max().unwrap_or(0).max(1);
    // A time constant takes the place of a part of a delay where it smooths a noisy model as well; both are late alike.
    let whole_s = (best as f64 + between(&left, best)) * STEP_S + following_s[best];
    Some((whole_s, (farthest as f64 * STEP_S / 2.0).max(following_s[best] / BETWEEN)))
}

/// Where the least of some values lies beside that of the grid, in steps: that of the parabola through it and its neighbours.
fn between(values: &[f64], least: usize) -> f64 {
    let Some((before, after)) = least.checked_sub(1).map(|at| values[at]).zip(values.get(least + 1)) else {
        return 0.0;
    };
    let bend = before - 2.0 * values[least] + after;
    if bend > 0.0 { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) } else { 0.0 }
}

/// A signal without what lasts and without what is short.
fn band(samples: &[f64]) -> Vec<f64> {
    let (short, lasting) = (mean_over(samples, SHORT_S), mean_over(samples, LASTING_S));
    short.iter().zip(&lasting).map(|(one, other)| one - other).collect()
}

/// Means over a time around each sample.
fn mean_over(samples: &[f64], time_s: f64) -> Vec<f64> {
    // Steps of a grid.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
    let half = (0.5 * time_s / STEP_S) as usize;
    let mut sums = vec![0.0];
    for sample in samples {
        sums.push(sums[sums.len() - 1] + sample);
    }
    let one = |index: usize| {
        let (from, to) = (index.saturating_sub(half), (index + half + 1).min(samples.len()));
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..samples.len()).map(one).collect()
}

/// What follows with a time constant [s].
fn follow(samples: &[f64], constant_s: f64) -> Vec<f64> {
    if constant_s == 0.0 {
        return samples.to_vec();
    }
    let kept = (-STEP_S / constant_s).exp();
    let mut state = samples.first().copied().unwrap_or(0.0);
    let one = |sample: &f64| {
        state = sample + (state - sample) * kept;
        state
    };
    samples.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_calibrate::statistics::Draws;

    /// A power that wanders, and what is measured of it.
    fn pairs(delay: usize, constant_s: f64, noise: f64) -> Vec<Pair> {
        let one = |run: u64| {
            let mut draws = Draws::new(9, run);
            let wander: Vec<f64> = (0..2400).map(|_| draws.normal()).collect();
            let modelled: Vec<f64> = mean_over(&wander, 2.0).iter().map(|value| 100.0 * value).collect();
            let late = follow(&modelled, constant_s);
            let measured =
                (0..late.len()).map(|index| 0.9 * late[index.saturating_sub(delay)] + noise * draws.normal());
            Pair { measured: measured.collect(), modelled }
        };
        (0..4).map(one).collect()
    }

    #[test]
    fn a_delay_is_found_and_a_power_that_follows_is_none() {
        let (delay_s, sd) = told(&pairs(24, 0.0, 3.0)).unwrap();
        assert!((delay_s - 1.2).abs() <= 0.5 * STEP_S && sd < 0.2, "{delay_s} ± {sd}");
        let (delay_s, _) = told(&pairs(24, 1.0, 3.0)).unwrap();
        assert!((delay_s - 2.2).abs() <= 4.0 * STEP_S, "{delay_s}");
        assert_eq!(told(&pairs(0, 0.0, 3.0)), None);
        // The least of (x − 1.3)² between points of a grid; at an end there is none beside it.
        let values: Vec<f64> = (0..4).map(|x| (f64::from(x) - 1.3).powi(2)).collect();
        assert!((between(&values, 1) - 0.3).abs() < 1e-12);
        assert_eq!(between(&values, 0), 0.0);
        assert_eq!(told(&pairs(0, 2.0, 3.0)), None);
    }
}
