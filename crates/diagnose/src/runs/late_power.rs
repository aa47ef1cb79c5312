//! A power that is measured late: a flow meter behind a pump and a filter, a battery's current from another bus, or from a logger
//! whose clock runs apart.
//!
//! y(t) = a x(t − d), or a x(t − r t), both without what lasts: y the power that was measured, x the one that the nominal model
//! makes of the rest of the recording, as fast as it is or following with a time constant. What an engine or a pump takes time for
//! follows with a time constant; a delay is what no time constant explains. d or r and the time constant are looked for on a grid, a
//! by least squares; that residuals of one second are alike is taken for granted. What is told is how late the power is in the
//! mean, by both.
//!
//! Source: time delays by correlation of prefiltered signals; Ljung, *System Identification* (1999), section 6.4 and example 17.2.

use crate::balances::balance::Kind;
use crate::causes::clocks::DRIFT;
use crate::causes::sensors::{interpolate, with_channel};
use crate::proof::refine::HALF_95;
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::soundness::faults::{Fault, place};
use crate::soundness::voltage::fast;
use crate::told::report::Interval;
use crate::{Case, DiagnoseError};
use headland_recording::renewed_s;

/// The fault that it can be beside that of a clock.
const LATENCY: &str = "latency";
/// The power of a battery, and the two that it is made of.
const BATTERY: [&str; 3] = ["battery_power_w", "battery_current_a", "battery_voltage_v"];
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

/// How a power is late.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    /// By as much all the time [s].
    Delay(f64),
    /// By this share of the time since the begin.
    Drift(f64),
}

/// How late a power is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Late {
    /// Those of its channels that are late.
    channels: &'static [&'static str],
    /// By how much.
    by: By,
    /// Its standard deviation [s], or as a share of the time.
    sd: f64,
}

impl By {
    /// When what happens at a time is recorded, in a run that begins at `first_s` [s].
    fn recorded_s(self, time_s: f64, first_s: f64) -> f64 {
        match self {
            Self::Delay(delay_s) => time_s + delay_s,
            Self::Drift(rate) => first_s + (time_s - first_s) / (1.0 - rate),
        }
    }
}

/// A measured power and the modelled one, on one period and without what lasts.
struct Pair {
    measured: Vec<f64>,
    modelled: Vec<f64>,
}

/// The powers that are late.
pub fn late(case: &Case) -> Vec<Late> {
    let powers: [(Kind, &'static [&'static str]); 2] =
        [(Kind::Fuel, &["fuel_rate_kg_s"]), (Kind::Battery, &BATTERY)];
    let of = |(kind, channels): (Kind, &'static [&'static str])| {
        let runs = case.runs.iter().zip(&case.nominal);
        let pairs: Vec<Pair> = runs.filter_map(|(run, said)| pair(run, said, kind, channels[0])).collect();
        // An engine follows in its own time, which differs from begin to end of a drive as its load does: fuel tells of no clock.
        let clocks = kind == Kind::Battery && case.wanted(DRIFT);
        let (by, sd) = told(&pairs, clocks)?;
        let renewal_s =
            case.runs.iter().map(|run| renewed_s(&run.measured.trace, channels[0])).fold(0.0, f64::max);
        let (id, late_s) = match by {
            By::Delay(delay_s) => (LATENCY, delay_s),
            By::Drift(rate) => (DRIFT, rate.abs() * case.longest_s()),
        };
        let matters = case.wanted(id) && late_s > LEAST_S.max(2.0 * renewal_s);
        let alone = matters && kind == Kind::Battery && is_current_alone(&batteries(&case.runs), by);
        let channels = if alone { &BATTERY[..2] } else { channels };
        matters.then_some(Late { channels, by, sd })
    };
    powers.into_iter().filter_map(of).collect()
}

/// Time, current and voltage of every run that has them.
fn batteries(runs: &[Recorded]) -> Vec<[&[f64]; 3]> {
    fn of(run: &Recorded) -> Option<[&[f64]; 3]> {
        let trace = &run.measured.trace;
        Some([trace.time_s(), trace.get(BATTERY[1])?, trace.get(BATTERY[2])?])
    }
    runs.iter().filter_map(of).collect()
}

/// Whether the current is late and the voltage is not, which falls as the current rises: it follows the current as it is set right
/// better than the one that was recorded.
fn is_current_alone(batteries: &[[&[f64]; 3]], by: By) -> bool {
    /// Share of what the recorded current leaves of the voltage.
    const BETTER: f64 = 0.9;
    let left = |by: Option<By>| -> f64 {
        let (mut voltages, mut currents, mut products) = (0.0, 0.0, 0.0);
        for [time_s, current_a, voltage_v] in batteries {
            let in_time = by.map(|by| sooner(time_s, current_a, by));
            let current = fast(time_s, in_time.as_deref().unwrap_or(current_a));
            let voltage = fast(time_s, voltage_v);
            for (current, voltage) in current.iter().zip(voltage) {
                if current.is_finite() && voltage.is_finite() {
                    voltages += voltage * voltage;
                    currents += current * current;
                    products += current * voltage;
                }
            }
        }
        let followed = if currents > 0.0 { products.min(0.0).powi(2) / currents } else { 0.0 };
        voltages - followed
    };
    left(Some(by)) < BETTER * left(None)
}

/// Samples as they would have been recorded in time; of what a late sensor would have said after the end the last is told.
fn sooner(time_s: &[f64], samples: &[f64], by: By) -> Vec<f64> {
    time_s.iter().map(|time| interpolate(time_s, samples, by.recorded_s(*time, time_s[0]))).collect()
}

/// Sets a late power right in all runs.
pub fn set_right(case: &mut Case, late: Late, usable: &mut [Vec<bool>]) -> Result<Fault, DiagnoseError> {
    for (run, usable) in case.raw.iter_mut().zip(usable) {
        let time_s = run.measured.trace.time_s().to_vec();
        let recorded_s: Vec<f64> = time_s.iter().map(|time| late.by.recorded_s(*time, time_s[0])).collect();
        for name in late.channels {
            let Some(samples) = run.measured.trace.get(name) else { continue };
            let sooner = sooner(&time_s, samples, late.by);
            run.measured.trace = with_channel(&run.measured.trace, name, sooner)?;
        }
        // What is made of a current that was late and a voltage that was not is made anew.
        let trace = &run.measured.trace;
        if late.channels == &BATTERY[..2]
            && let Some((current_a, voltage_v)) = trace.get(BATTERY[1]).zip(trace.get(BATTERY[2]))
        {
            let power_w =
                current_a.iter().zip(voltage_v).map(|(current, voltage)| current * voltage).collect();
            run.measured.trace = with_channel(trace, BATTERY[0], power_w)?;
        }
        // What a late sensor would have said after the end nobody knows.
        for (usable, time) in usable.iter_mut().zip(&recorded_s) {
            *usable &= *time <= time_s[time_s.len() - 1];
        }
    }
    case.runs.clone_from(&case.raw);
    let (id, size, unit) = match late.by {
        By::Delay(delay_s) => {
            let own = |name: &&&str| **name != BATTERY[0];
            case.late_powers.extend(late.channels.iter().filter(own).map(|name| (*name, delay_s)));
            (LATENCY, delay_s, "s")
        }
        // No description of a recording knows of clocks.
        By::Drift(rate) => (DRIFT, rate, "1"),
    };
    case.suppose()?;
    let stretch = |run: &Recorded| place(run, 0, run.measured.trace.len() - 1);
    let stretches: Vec<Interval> = case.runs.iter().map(stretch).collect();
    let half = HALF_95 * late.sd;
    Ok(Fault {
        id,
        channel: late.channels[late.channels.len().min(2) - 1].to_owned(),
        size,
        ci95: Some([size - half, size + half]),
        leaps: false,
        unit: unit.to_owned(),
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

/// How much of what was measured is left with each of some ways to be late.
struct Left {
    /// Sums of squares, each with the time constant that suits it best.
    squares: Vec<f64>,
    /// Those time constants [s].
    following_s: Vec<f64>,
}

impl Left {
    /// With ways by which a sample was made so many steps before it was recorded.
    fn with(
        followed: &[(f64, Vec<Vec<f64>>)],
        measured: &[Vec<f64>],
        (count, margin): (usize, usize),
        before: impl Fn(usize, usize) -> usize,
    ) -> Self {
        let mut left = Self { squares: vec![f64::INFINITY; count], following_s: vec![0.0; count] };
        for (constant_s, following) in followed {
            for way in 0..count {
                let (mut square, mut cross, mut own) = (0.0, 0.0, 0.0);
                for (measured, modelled) in measured.iter().zip(following) {
                    // The same samples of what was measured for every way.
                    for index in margin..measured.len().saturating_sub(margin) {
                        let (value, model) = (measured[index], modelled[before(way, index)]);
                        square += value * value;
                        cross += value * model;
                        own += model * model;
                    }
                }
                let explained = if own > 0.0 && cross > 0.0 { cross * cross / own } else { 0.0 };
                if square - explained < left.squares[way] {
                    (left.squares[way], left.following_s[way]) = (square - explained, *constant_s);
                }
            }
        }
        left
    }

    /// The way that leaves least, and how far around it is as good.
    fn best(&self, independent: f64) -> Option<(usize, usize)> {
        let ways = 0..self.squares.len();
        let best = ways.clone().min_by(|one, other| self.squares[*one].total_cmp(&self.squares[*other]))?;
        let by_one = self.squares[best] * (2.0 / independent).exp();
        let near = ways.filter(|way| self.squares[*way] < by_one);
        Some((best, near.map(|way| way.abs_diff(best)).max().unwrap_or(0).max(1)))
    }

    /// The same way between those of the grid.
    fn place(&self, best: usize) -> f64 {
        best as f64 + between(&self.squares, best)
    }
}

/// The sample that a clock which runs apart gives as the one at `index`.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
fn drifted(index: usize, rate: f64) -> usize {
    (index as f64 * (1.0 - rate)).round() as usize
}

/// What suits all runs best, a delay or, where there are `clocks`, one that runs apart, and its standard deviation; none where
/// neither is needed.
// Steps of grids.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
fn told(pairs: &[Pair], clocks: bool) -> Option<(By, f64)> {
    /// A clock that runs apart is in these steps late by a tenth of a second more or less at the end of the longest run.
    const RATES_EACH_WAY: usize = 40;
    /// Growth of ln p from which on it is the clock: a bus that is late is the commoner fault.
    const CLEARLY: f64 = 20.0;
    let steps = (LONGEST_S / STEP_S) as usize;
    let measured: Vec<Vec<f64>> = pairs.iter().map(|pair| band(&pair.measured)).collect();
    let samples: usize = measured.iter().map(|one| one.len().saturating_sub(2 * steps)).sum();
    let independent = samples as f64 * STEP_S / INDEPENDENT_S;
    let whole: f64 = measured
        .iter()
        .flat_map(|one| one.iter().skip(steps).take(one.len().saturating_sub(2 * steps)))
        .map(|value| value * value)
        .sum();
    if samples == 0 || whole == 0.0 {
        return None;
    }
    let longest = measured.iter().map(Vec::len).max().unwrap_or(0) as f64;
    let gain = |before: f64, after: f64| 0.5 * independent * (before / after).ln();
    let with = |constant_s: f64| {
        let following = pairs.iter().map(|pair| band(&follow(&pair.modelled, constant_s)));
        (constant_s, following.collect::<Vec<_>>())
    };
    let followed = FOLLOWING_S.map(with);
    let delays = Left::with(&followed, &measured, (steps + 1, steps), |delay, index| index - delay);
    let (delay, delay_off) = delays.best(independent)?;
    let told = |left: &Left, best: usize, ends: &[usize]| {
        gain(delays.squares[0], left.squares[best]) >= LEAST_GAIN
            && left.squares[best] <= (1.0 - EXPLAINED) * whole
            && !ends.contains(&best)
    };
    if clocks {
        // Late by so many steps in a step.
        let rate_of =
            |way: f64| (way - RATES_EACH_WAY as f64) * steps as f64 / (RATES_EACH_WAY as f64 * longest);
        let drifts = Left::with(&followed, &measured, (2 * RATES_EACH_WAY + 1, steps), |way, index| {
            drifted(index, rate_of(way as f64))
        });
        let (drift, drift_off) = drifts.best(independent)?;
        if gain(delays.squares[delay], drifts.squares[drift]) > CLEARLY
            && told(&drifts, drift, &[0, 2 * RATES_EACH_WAY])
        {
            let step = rate_of(drift as f64 + 1.0) - rate_of(drift as f64);
            return Some((By::Drift(rate_of(drifts.place(drift))), drift_off as f64 * step / 2.0));
        }
    }
    if !told(&delays, delay, &[steps]) {
        return None;
    }
    // A time constant takes the place of a part of a delay where it smooths a noisy model as well; both are late alike.
    let following_s = delays.following_s[delay];
    let whole_s = delays.place(delay) * STEP_S + following_s;
    Some((By::Delay(whole_s), (delay_off as f64 * STEP_S / 2.0).max(following_s / BETWEEN)))
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
        let delay_s = |pairs: &[Pair]| match told(pairs, true).unwrap() {
            (By::Delay(delay_s), sd) => (delay_s, sd),
            other => panic!("{other:?}"),
        };
        let (found_s, sd) = delay_s(&pairs(24, 0.0, 3.0));
        assert!((found_s - 1.2).abs() <= 0.5 * STEP_S && sd < 0.2, "{found_s} ± {sd}");
        let (found_s, _) = delay_s(&pairs(24, 1.0, 3.0));
        assert!((found_s - 2.2).abs() <= 4.0 * STEP_S, "{found_s}");
        assert_eq!(told(&pairs(0, 0.0, 3.0), true), None);
        // The least of (x − 1.3)² between points of a grid; at an end there is none beside it.
        let values: Vec<f64> = (0..4).map(|x| (f64::from(x) - 1.3).powi(2)).collect();
        assert!((between(&values, 1) - 0.3).abs() < 1e-12);
        assert_eq!(between(&values, 0), 0.0);
        assert_eq!(told(&pairs(0, 2.0, 3.0), true), None);
    }

    /// A pack of 0.08 Ω: where a bus is late both are, and where a sensor is the current alone.
    #[test]
    fn a_voltage_that_is_in_time_stays_as_it_is() {
        let time_s: Vec<f64> = (0..3000).map(|index| 0.1 * f64::from(index)).collect();
        let current = |time_s: f64| 60.0 * (0.5 * time_s).sin() + 25.0 * (1.3 * time_s).cos();
        let late = |by_s: f64| time_s.iter().map(|time| current(time - by_s)).collect::<Vec<f64>>();
        let voltage =
            |by_s: f64| late(by_s).iter().map(|current| 312.0 - 0.08 * current).collect::<Vec<f64>>();
        let alone = |by_s: f64| is_current_alone(&[[&time_s, &late(0.8), &voltage(by_s)]], By::Delay(0.8));
        assert!(alone(0.0) && !alone(0.8));
        // A voltage that tells nothing of the current does not tell which of them is late.
        let level = vec![312.0; time_s.len()];
        assert!(!is_current_alone(&[[&time_s, &late(0.8), &level]], By::Delay(0.8)));
    }

    /// Late by a hundredth of the time since the begin, or early: 1.2 s at the end of two minutes.
    #[test]
    fn a_clock_that_runs_apart_is_told_from_a_delay() {
        for rate in [0.01, -0.01] {
            let mut all = pairs(0, 0.0, 3.0);
            for pair in &mut all {
                let last = pair.measured.len() - 1;
                let own = (0..=last).map(|index| pair.measured[drifted(index, rate).min(last)]).collect();
                pair.measured = own;
            }
            let Some((By::Drift(found), sd)) = told(&all, true) else { panic!("no drift at {rate}") };
            assert!((found - rate).abs() < 2.0 * sd && sd < 1e-3, "{found} ± {sd} for {rate}");
            assert!((By::Drift(found).recorded_s(100.0, 0.0) - 100.0 / (1.0 - found)).abs() < 1e-9);
        }
    }
}
