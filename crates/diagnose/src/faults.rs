//! Faults that a channel shows by itself: a value that sticks, steps that are too coarse, samples that are lost.

use crate::filled::filled;
use crate::recorded::Recorded;
use crate::report::Interval;
use headland_calibrate::statistics::{quantile_of_sorted, sorted};
use headland_trace::Trace;

/// A fault of a channel.
#[derive(Clone, Debug)]
pub struct Fault {
    /// The contract's identifier.
    pub id: &'static str,
    /// The channel.
    pub channel: String,
    /// Step of a coarse channel, share of lost time, or seconds that it stuck.
    pub size: f64,
    /// Unit of the size.
    pub unit: String,
    /// Where.
    pub stretches: Vec<Interval>,
}

/// A value is stuck that stays the same for so long [s] and so many samples.
const STUCK_S: f64 = 1.0;
const STUCK_SAMPLES: usize = 15;
/// Where it leaps to the next value, by so many times all but a few of its steps, it was stuck for a shorter time as well.
const LEAP: f64 = 5.0;
const STUCK_BEFORE_A_LEAP_S: f64 = 0.5;
const STUCK_SAMPLES_BEFORE_A_LEAP: usize = 6;
/// And so many times as long as the channel usually holds a value: sensors are slower than the log, and coarse.
const HELD: f64 = 8.0;
/// What is usual: all but this share of the samples.
const UNUSUAL: f64 = 0.05;
/// White noise turns back two times of three, and a signal that rises above it less often.
const TURNS: f64 = 0.25;
/// A channel whose noise lets no more than this share of its samples repeat the one before is never still by itself,
const NOISY: f64 = 0.02;
/// and one that is still for more than this share of the samples is renewed that slowly.
const MOSTLY: f64 = 0.3;
/// A channel is coarse where this share of the samples repeats the one before while the vehicle moves.
const REPEATED: f64 = 0.35;
/// A coarse channel mostly changes by fewer steps than this.
const FEW_STEPS: f64 = 2.5;
/// A gap is so many times the usual period.
const GAP: f64 = 3.5;
/// Lost time that matters, as a share.
const LOST: f64 = 0.01;
/// Buses give torques in steps of about a per cent of their range; that is no fault.
const BUS: f64 = 0.025;
/// Below this the vehicle stands, and channels may well be still [m/s].
const SLOWEST_M_S: f64 = 0.5;

/// The channels that are looked at; of a battery's current only whether it sticks.
pub const LOOKED_AT: [&str; 6] = [
    "speed_m_s",
    "wheel_speed_m_s",
    "tractive_force_n",
    "specific_force_m_s2",
    "motor_torque_n_m",
    "engine_torque_n_m",
];

/// The faults of all runs, and the samples that may be used.
pub fn faults(drives: &[Recorded]) -> (Vec<Fault>, Vec<Vec<bool>>) {
    let known = |drive: &Recorded| match &drive.unknown {
        unknown if unknown.is_empty() => vec![true; drive.measured.trace.len()],
        unknown => unknown.iter().map(|unknown| !unknown).collect(),
    };
    let mut usable: Vec<Vec<bool>> = drives.iter().map(known).collect();
    let mut all = Vec::new();
    all.extend(stuck(drives, "battery_current_a", &mut usable));
    for name in LOOKED_AT {
        if let Some(fault) = stuck(drives, name, &mut usable) {
            all.push(fault);
        } else if let Some(fault) = coarse(drives, name) {
            all.push(fault);
        }
        all.extend(missing(drives, name));
        all.extend(nought(drives, name, &mut usable));
    }
    all.extend(lost(drives));
    all.extend(filled(drives, &mut usable));
    (all, usable)
}

/// A channel of a run that is its own, and no other one that stands in for it.
fn own<'a>(drive: &'a Recorded, name: &str) -> Option<&'a [f64]> {
    let other = name == "speed_m_s" && drive.stands_in.contains(&true);
    drive.measured.trace.get(name).filter(|_| !other)
}

/// Where samples of a run lie.
pub fn place(drive: &Recorded, from: usize, to: usize) -> Interval {
    let time_s = drive.measured.trace.time_s();
    Interval {
        run: drive.measured.id.clone(),
        from_s: time_s[from],
        to_s: time_s[to],
        from_position_m: drive.position_m[from],
        to_position_m: drive.position_m[to],
    }
}

/// Stretches of equal values, first and last sample.
fn still(values: &[f64]) -> Vec<(usize, usize)> {
    let mut all = Vec::new();
    let mut from = 0;
    for index in 1..=values.len() {
        if index == values.len() || values[index] != values[from] {
            if index - from > 1 {
                all.push((from, index - 1));
            }
            from = index;
        }
    }
    all
}

/// For how many samples a channel holds a value, all but the longest stretches that make up [`UNUSUAL`] of the samples and
/// the one that is longest of all.
fn usual_length(equal: &[(usize, usize)], samples: usize) -> f64 {
    let mut lengths: Vec<usize> = equal.iter().map(|(from, to)| to - from + 1).collect();
    lengths.sort_unstable();
    let longest = lengths.pop().unwrap_or(1);
    let beyond = UNUSUAL * (samples - longest.min(samples)) as f64;
    let mut seen = 0;
    while let Some(length) = lengths.pop() {
        seen += length;
        if seen as f64 > beyond {
            return length as f64;
        }
    }
    1.0
}

/// Whether the noise of a channel moves it to and fro all the time, but for a few long stretches.
fn noisy(values: &[f64], equal: &[(usize, usize)]) -> bool {
    let samples = values.len();
    if turns(values) < TURNS {
        return false;
    }
    let repeats = |long: bool| -> usize {
        let own =
            equal.iter().map(|(from, to)| to - from).filter(|length| (*length >= STUCK_SAMPLES) == long);
        own.sum()
    };
    let share = |count: usize| count as f64 / samples as f64;
    share(repeats(false)) < NOISY && share(repeats(true)) < MOSTLY
}

/// How many of its moves a channel takes back with the next one, as a share.
fn turns(values: &[f64]) -> f64 {
    let moves = values.windows(2).map(|pair| pair[1] - pair[0]);
    let moves: Vec<f64> = moves.filter(|step| step.is_finite() && *step != 0.0).collect();
    let turns = moves.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    turns as f64 / moves.len().max(1) as f64
}

/// All but [`UNUSUAL`] of the steps of a channel are smaller.
fn usual_step(values: &[f64]) -> f64 {
    let steps = changes(values);
    if steps.is_empty() { f64::INFINITY } else { quantile_of_sorted(&steps, 1.0 - UNUSUAL) }
}

/// By how much a channel changes where it does, the least first.
fn changes(values: &[f64]) -> Vec<f64> {
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    sorted(&steps.filter(|step| step.is_finite() && *step > 0.0).collect::<Vec<_>>())
}

/// Whether the noise of a channel, which is renewed as rarely as it may be, is so much coarser than its resolution that no two
/// values in a row are the same by chance.
fn renews(values: &[f64]) -> bool {
    /// Steps of noise are so many times the smallest step.
    const COARSE: f64 = 5.0;
    /// White noise takes back two moves of three; what else moves the channel takes back few.
    const TAKEN_BACK: f64 = 0.4;
    let steps = changes(values);
    // The smallest but for a few: rounding makes steps of next to nothing.
    !steps.is_empty()
        && quantile_of_sorted(&steps, 0.5) > COARSE * quantile_of_sorted(&steps, 0.02)
        && turns(values) > TAKEN_BACK
}

fn stuck(drives: &[Recorded], name: &str, usable: &mut [Vec<bool>]) -> Option<Fault> {
    let mut stretches = Vec::new();
    let mut runs = 0;
    let mut seconds = 0.0;
    let (mut noisy_everywhere, mut leaps_everywhere) = (true, true);
    for (run, drive) in drives.iter().enumerate() {
        let trace: &Trace = &drive.measured.trace;
        let Some(values) = own(drive, name) else { continue };
        let time_s = trace.time_s();
        let equal = still(values);
        let own_noise = noisy(values, &equal);
        noisy_everywhere &= own_noise || renews(values);
        let enough = if own_noise { 0.0 } else { HELD * usual_length(&equal, values.len()) };
        let leap = LEAP * usual_step(values);
        let leaps = |to: usize| values.get(to + 1).is_some_and(|next| (next - values[to]).abs() > leap);
        let long: Vec<(usize, usize)> = equal
            .iter()
            .copied()
            .filter(|(from, to)| {
                let moving = (*from..=*to).all(|index| drive.motion.value[index] > SLOWEST_M_S);
                let (samples, long_s) = if leaps(*to) {
                    (STUCK_SAMPLES_BEFORE_A_LEAP, STUCK_BEFORE_A_LEAP_S)
                } else {
                    (STUCK_SAMPLES, STUCK_S)
                };
                moving
                    && values[*from] != 0.0
                    && to - from >= samples
                    && (to - from) as f64 >= enough
                    && time_s[*to] - time_s[*from] >= long_s
            })
            .collect();
        if long.is_empty() {
            continue;
        }
        runs += 1;
        leaps_everywhere &= long.iter().all(|(_, to)| leaps(*to));
        // The motion is smoothed over samples before and after, and what is stuck spoils it there as well.
        let beside_s = if name.contains("speed") { drive.measured.how.smoothing_s } else { 0.0 };
        for (from, to) in long {
            seconds += time_s[to] - time_s[from];
            stretches.push(place(drive, from, to));
            let first = time_s.partition_point(|time| *time < time_s[from] - beside_s);
            let end = time_s.partition_point(|time| *time <= time_s[to] + beside_s);
            usable[run][first..end].fill(false);
        }
    }
    // What every run shows is how the vehicle was driven, and no fault, but where noise alone would have moved the channel, and
    // where it has to catch up each time.
    (runs > 0 && (noisy_everywhere || leaps_everywhere || 2 * runs <= drives.len().max(2))).then(|| Fault {
        id: "stuck_channel",
        channel: name.to_owned(),
        size: seconds,
        unit: "s".to_owned(),
        stretches,
    })
}

fn coarse(drives: &[Recorded], name: &str) -> Option<Fault> {
    let (mut repeated, mut count) = (0usize, 0usize);
    let mut steps: Vec<f64> = Vec::new();
    for drive in drives {
        let Some(values) = own(drive, name) else { continue };
        for (index, pair) in values.windows(2).enumerate() {
            let step = (pair[1] - pair[0]).abs();
            if drive.motion.value[index] > SLOWEST_M_S && step.is_finite() && pair[0] != 0.0 {
                count += 1;
                if step == 0.0 {
                    repeated += 1;
                } else {
                    steps.push(step);
                }
            }
        }
    }
    steps.sort_by(f64::total_cmp);
    // The smallest but for a few: rounding makes steps of next to nothing.
    let step = *steps.get(steps.len() / 50)?;
    let whole = |value: &&f64| ((**value / step) - (**value / step).round()).abs() < 0.05;
    let multiples = steps.iter().filter(whole).count() as f64 / steps.len() as f64;
    // A channel that is held between samples repeats itself too, but then changes by many of its smallest steps.
    let usual = steps[steps.len() / 2];
    let torque = name.ends_with("_n_m") || name == "tractive_force_n";
    let coarse = (!torque || step > BUS * reach(drives, name))
        && repeated as f64 > REPEATED * count as f64
        && multiples > 0.97
        && usual < FEW_STEPS * step
        && steps.len() > 50;
    coarse.then(|| Fault {
        id: "quantisation",
        channel: name.to_owned(),
        size: step,
        unit: headland_units::unit_of_name(name).map_or_else(|| "1".to_owned(), |unit| unit.symbol),
        stretches: Vec::new(),
    })
}

/// How far a channel reaches over all runs.
fn reach(drives: &[Recorded], name: &str) -> f64 {
    let values = || {
        let traces = drives.iter().filter_map(|drive| own(drive, name));
        traces.flatten().copied().filter(|value| value.is_finite())
    };
    values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
}

/// Values of a channel that are missing now and then.
fn missing(drives: &[Recorded], name: &str) -> Option<Fault> {
    let (mut lost, mut count) = (0usize, 0usize);
    let mut stretches = Vec::new();
    for drive in drives {
        let Some(values) = own(drive, name) else { continue };
        count += values.len();
        let mut index = 0;
        while index < values.len() {
            if values[index].is_finite() {
                index += 1;
                continue;
            }
            let from = index;
            while index < values.len() && !values[index].is_finite() {
                index += 1;
            }
            lost += index - from;
            stretches.push(place(drive, from.saturating_sub(1), index.min(values.len() - 1)));
        }
    }
    // A channel that is missing for most of the time was not logged there, or not asked.
    (lost as f64 > LOST * count as f64 && 2 * lost < count).then(|| Fault {
        id: "dropout",
        channel: name.to_owned(),
        size: lost as f64 / count as f64,
        unit: "1".to_owned(),
        stretches,
    })
}

/// Values of a channel that leap to nought now and then and back to where they were: what is lost is written as nought by
/// some loggers.
fn nought(drives: &[Recorded], name: &str, usable: &mut [Vec<bool>]) -> Option<Fault> {
    /// No driver lets go for so short a time and comes back to the same force [s].
    const LONGEST_S: f64 = 3.0;
    /// Back to where it was: within this share of it.
    const SAME: f64 = 0.5;
    /// Once may be chance.
    const FEWEST: usize = 2;
    let mut stretches = Vec::new();
    let (mut lost, mut count) = (0usize, 0usize);
    let mut samples: Vec<(usize, usize, usize)> = Vec::new();
    for (run, drive) in drives.iter().enumerate() {
        let Some(values) = own(drive, name) else { continue };
        count += values.len();
        let time_s = drive.measured.trace.time_s();
        let leap = LEAP * usual_step(values);
        for (from, to) in still(values) {
            let (Some(before), Some(after)) = (from.checked_sub(1).map(|at| values[at]), values.get(to + 1))
            else {
                continue;
            };
            let moving = (from..=to).all(|index| drive.motion.value[index] > SLOWEST_M_S);
            let back = (after - before).abs() < SAME * before.abs().max(after.abs());
            let leaps = before.abs().min(after.abs()) > leap;
            if values[from] == 0.0 && moving && back && leaps && time_s[to] - time_s[from] < LONGEST_S {
                samples.push((run, from, to));
                stretches.push(place(drive, from, to));
                lost += to - from + 1;
            }
        }
    }
    if samples.len() < FEWEST {
        return None;
    }
    for (run, from, to) in samples {
        usable[run][from..=to].fill(false);
    }
    Some(Fault {
        id: "dropout",
        channel: name.to_owned(),
        size: lost as f64 / count as f64,
        unit: "1".to_owned(),
        stretches,
    })
}

fn lost(drives: &[Recorded]) -> Option<Fault> {
    let (mut gaps_s, mut whole_s) = (0.0, 0.0);
    let mut stretches = Vec::new();
    for drive in drives {
        let time_s = drive.measured.trace.time_s();
        let mut periods: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
        periods.sort_by(f64::total_cmp);
        let Some(usual) = periods.get(periods.len() / 2).copied() else { continue };
        whole_s += drive.measured.trace.duration_s();
        for (index, pair) in time_s.windows(2).enumerate() {
            if pair[1] - pair[0] > GAP * usual {
                gaps_s += pair[1] - pair[0];
                stretches.push(place(drive, index, index + 1));
            }
        }
    }
    (gaps_s > LOST * whole_s).then(|| Fault {
        id: "dropout",
        channel: "time_s".to_owned(),
        size: gaps_s / whole_s,
        unit: "1".to_owned(),
        stretches,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_calibrate::statistics::Draws;

    /// Noise about a slow wave, with thirty samples that are all the same.
    fn stuck_at(from: usize, noise: f64) -> Vec<f64> {
        let of = |index: usize| (0.02 * index as f64).sin() + noise * ((index * 7919 % 101) as f64 - 50.0);
        (0..400).map(|index| of(if (from..from + 30).contains(&index) { from } else { index })).collect()
    }

    #[test]
    fn only_where_noise_moves_a_channel_is_it_never_still_by_itself() {
        let told = |values: &[f64]| noisy(values, &still(values));
        assert!(told(&stuck_at(100, 0.01)));
        assert!(!told(&stuck_at(100, 0.0)), "a smooth channel may stay where it is");
        let held: Vec<f64> = stuck_at(500, 0.01).iter().flat_map(|value| [*value; 20]).collect();
        assert!(!told(&held), "a channel that is renewed slowly is not stuck");
    }

    #[test]
    fn where_noise_moves_a_channel_that_is_renewed_slowly_is_known_all_the_same() {
        let held = |noise: f64| -> Vec<f64> {
            let mut draws = Draws::new(7, 0);
            let of = |index: usize| 1e4 * ((0.002 * index as f64).sin() + noise * draws.normal());
            (0..400).map(of).flat_map(|value| [value.round(); 5]).collect()
        };
        assert!(renews(&held(0.01)));
        assert!(!renews(&held(0.0)), "a smooth channel stays where it is when it has arrived");
        let coarse: Vec<f64> = held(0.01).iter().map(|value| 1e4 * (value / 1e4).round()).collect();
        assert!(!renews(&coarse), "a coarse channel stays where it is");
    }
}
