//! Faults that a channel shows by itself: a value that sticks, steps that are too coarse, samples that are lost.

use crate::proof::refine::HALF_95;
use crate::runs::recorded::Recorded;
use crate::runs::way::Scale;
use crate::soundness::filled::filled;
use crate::soundness::stuck::{LEAP, still, stuck, usual_step};
use crate::told::report::Interval;
use headland_recording::Sensor;

/// A fault of a channel.
#[derive(Clone, Debug)]
pub struct Fault {
    /// The contract's identifier.
    pub id: &'static str,
    /// The channel.
    pub channel: String,
    /// Step of a coarse channel, share of lost time, seconds that it stuck, or a scale.
    pub size: f64,
    /// The interval that holds the size with 95 %, where it was estimated.
    pub ci95: Option<[f64; 2]>,
    /// Whether values leap away there and back, and are not just missing.
    pub leaps: bool,
    /// Unit of the size.
    pub unit: String,
    /// Where.
    pub stretches: Vec<Interval>,
}

/// A channel is coarse where this share of the samples repeats the one before while the vehicle moves.
const REPEATED: f64 = 0.35;
/// A coarse channel mostly changes by fewer steps than this.
const FEW_STEPS: f64 = 2.5;
/// A step over the standard deviation of what it is off by: the square root of twelve.
const ERRORS_IN_A_STEP: f64 = 3.464;
/// A gap is so many times the usual period.
const GAP: f64 = 3.5;
/// Lost time that matters, as a share.
const LOST: f64 = 0.01;
/// Buses give torques and fuel in steps of about a per cent of their range; that is no fault.
const BUS: f64 = 0.025;
/// Below this the vehicle stands, and channels may well be still [m/s].
pub const SLOWEST_M_S: f64 = 0.5;

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
pub fn faults(drives: &[Recorded], sensors: &[(String, Sensor)]) -> (Vec<Fault>, Vec<Vec<bool>>) {
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
        } else {
            all.extend(coarse(drives, name, sensors));
        }
        all.extend(missing(drives, name));
        all.extend(nought(drives, name, &mut usable));
    }
    // It stays the same where an engine idles, and ends where it is pushed.
    all.extend(coarse(drives, "fuel_rate_kg_s", sensors));
    all.extend(leapt(drives));
    all.extend(lost(drives));
    all.extend(filled(drives, &mut usable));
    (all, usable)
}

/// A channel of a run that is its own, and no other one that stands in for it.
pub fn own<'a>(drive: &'a Recorded, name: &str) -> Option<&'a [f64]> {
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

/// First and last of the samples side by side that are flagged, of so many.
pub fn stretches(flagged: impl Fn(usize) -> bool, count: usize) -> Vec<(usize, usize)> {
    let mut all: Vec<(usize, usize)> = Vec::new();
    for index in (0..count).filter(|index| flagged(*index)) {
        match all.last_mut() {
            Some((_, last)) if *last + 1 == index => *last = index,
            _ => all.push((index, index)),
        }
    }
    all
}

fn coarse(drives: &[Recorded], name: &str, sensors: &[(String, Sensor)]) -> Option<Fault> {
    let (mut repeated, mut count) = (0usize, 0usize);
    let mut steps: Vec<f64> = Vec::new();
    for drive in drives {
        let Some(values) = own(drive, name) else { continue };
        for (index, pair) in values.windows(2).enumerate() {
            let step = (pair[1] - pair[0]).abs();
            if drive.motion.value[index].abs() > SLOWEST_M_S && step.is_finite() && pair[0] != 0.0 {
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
    let bus = name.ends_with("_n_m") || ["tractive_force_n", "fuel_rate_kg_s"].contains(&name);
    // More than the noise that is known of a sensor is a fault.
    let noise = sensors.iter().find(|(own, _)| own == name).and_then(|(_, sensor)| sensor.noise);
    let loud = noise.is_some_and(|noise| step > ERRORS_IN_A_STEP * noise);
    let coarse = (!bus || loud || step > BUS * reach(drives, name))
        && repeated as f64 > REPEATED * count as f64
        && multiples > 0.97
        && usual < FEW_STEPS * step
        && steps.len() > 50;
    coarse.then(|| Fault {
        id: "quantisation",
        channel: name.to_owned(),
        size: step,
        ci95: None,
        leaps: false,
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
            // What leaps is told by itself.
            if name.contains("speed")
                && drive.leaps.iter().any(|(first, last)| from <= *last && *first < index)
            {
                continue;
            }
            if at_an_edge(drive, from, index) {
                continue;
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
        ci95: None,
        leaps: false,
        unit: "1".to_owned(),
        stretches,
    })
}

/// Whether values are missing at the begin or the end of a run and for a small part of it: a channel that is set right by its
/// latency ends before the others, and a receiver that starts late loses nothing.
fn at_an_edge(drive: &Recorded, from: usize, to: usize) -> bool {
    /// What is missing for longer was lost, wherever it lies: share of the run.
    const SMALL: f64 = 0.1;
    let samples = drive.measured.trace.len();
    (from == 0 || to == samples) && ((to - from) as f64) < SMALL * samples as f64
}

/// Speeds that leap to where no vehicle can get and back, of which the runs were rid before.
fn leapt(drives: &[Recorded]) -> Option<Fault> {
    /// A stray sample among so many is no fault that matters.
    const MATTERS: f64 = 1e-3;
    let of_wheels = |drive: &&Recorded| !drive.stands_in.is_empty() && !drive.stands_in.contains(&false);
    let leaping = || drives.iter().filter(|drive| !drive.leaps.is_empty());
    let count: usize = drives.iter().map(|drive| drive.measured.trace.len()).sum();
    let lost: usize = leaping().flat_map(|drive| &drive.leaps).map(|(from, to)| to - from + 1).sum();
    let place = |drive: &'_ Recorded| -> Vec<Interval> {
        drive.leaps.iter().map(|(from, to)| place(drive, *from, *to)).collect()
    };
    (lost as f64 > MATTERS * count as f64).then(|| Fault {
        id: "dropout",
        channel: if leaping().all(|drive| of_wheels(&drive)) { "wheel_speed_m_s" } else { "speed_m_s" }
            .to_owned(),
        size: lost as f64 / count as f64,
        ci95: None,
        leaps: true,
        unit: "1".to_owned(),
        stretches: leaping().flat_map(place).collect(),
    })
}

/// A speed whose scale the way says is wrong.
pub fn scaled(scale: &Scale) -> Fault {
    let half = HALF_95 * scale.sd;
    let size = 1.0 + scale.value;
    Fault {
        id: "speed_scale",
        channel: "speed_m_s".to_owned(),
        size,
        ci95: Some([size - half, size + half]),
        leaps: false,
        unit: "1".to_owned(),
        stretches: Vec::new(),
    }
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
            let moving = (from..=to).all(|index| drive.motion.value[index].abs() > SLOWEST_M_S);
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
        ci95: None,
        leaps: true,
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
        ci95: None,
        leaps: false,
        unit: "1".to_owned(),
        stretches,
    })
}

#[cfg(test)]
mod tests {
    use super::stretches;

    #[test]
    fn stretches_are_where_flags_are_side_by_side() {
        let flags = [true, false, true, true];
        assert_eq!(stretches(|index| flags[index], flags.len()), [(0, 0), (2, 3)]);
    }
}
