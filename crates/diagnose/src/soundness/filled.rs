//! Gaps of a log that somebody filled with straight lines: every channel runs along its chord, as no driver and no sensor does.

use crate::runs::recorded::Recorded;
use crate::soundness::faults::{Fault, LOOKED_AT, place};
use headland_calibrate::statistics::{median, sorted};

/// Shorter straight lines are no gap: so long [s], and so many samples.
const LEAST_S: f64 = 3.0;
const LEAST_SAMPLES: usize = 20;
/// A line is straight where no sample is further from its chord than this share of the channel's usual second difference,
const STRAIGHT: f64 = 0.25;
/// or than so many of the steps in which it is written: half a one of its own, and as much of the ends of the chord.
const ROUNDED: f64 = 1.05;
/// A channel that changes by less than this share of its standard deviation, or by so few of its steps, says nothing.
const MOVES: f64 = 0.01;
const STEPS: f64 = 10.0;
/// So many channels have to move along straight lines, and no other may bend: of a vehicle that speeds up evenly fewer do.
const FEWEST: usize = 3;
/// What is lost in all, as a share of the time, that matters.
const LOST: f64 = 1e-3;

/// Channels that sensors measure, beside those in which faults are looked for; what is made of others bends where they do not.
const BESIDE: [&str; 4] = ["engine_speed_rad_s", "battery_voltage_v", "battery_current_a", "throttle"];

/// A channel of a run, and what is usual of it.
struct Channel<'a> {
    values: &'a [f64],
    /// How far a sample may be from the chord.
    straight: f64,
    /// What is no movement.
    still: f64,
}

impl<'a> Channel<'a> {
    /// None where it never changes.
    fn of(values: &'a [f64]) -> Option<Self> {
        let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let bends = values.windows(3).map(|three| (three[2] - 2.0 * three[1] + three[0]).abs());
        let bends: Vec<f64> = bends.filter(|bend| *bend > 0.0).collect();
        if bends.is_empty() {
            return None;
        }
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        let sd = (known.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / known.len() as f64).sqrt();
        let levels = sorted(&known);
        let steps = levels.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
        let step = steps.fold(f64::INFINITY, f64::min);
        Some(Self {
            values,
            straight: (STRAIGHT * median(&bends)).max(ROUNDED * step),
            still: (MOVES * sd).max(STEPS * step),
        })
    }

    /// Whether it moves between two samples; none where it does not run along the chord.
    fn moves(&self, time_s: &[f64], from: usize, to: usize) -> Option<bool> {
        let change = self.values[to] - self.values[from];
        let on_chord = |index: usize| {
            let share = (time_s[index] - time_s[from]) / (time_s[to] - time_s[from]);
            (self.values[index] - self.values[from] - share * change).abs() <= self.straight
        };
        (from..=to).all(on_chord).then_some(change.abs() > self.still)
    }
}

/// Gaps that were filled; their samples may not be used.
pub fn filled(drives: &[Recorded], usable: &mut [Vec<bool>]) -> Option<Fault> {
    let (mut lost_s, mut whole_s) = (0.0, 0.0);
    let mut stretches = Vec::new();
    for (drive, usable) in drives.iter().zip(usable) {
        let trace = &drive.measured.trace;
        let time_s = trace.time_s();
        whole_s += trace.duration_s();
        let channels = LOOKED_AT
            .iter()
            .chain(&BESIDE)
            .filter_map(|name| Channel::of(trace.get(name)?))
            .collect::<Vec<_>>();
        for (from, to) in straight(time_s, &channels) {
            usable[from..=to].fill(false);
            lost_s += time_s[to] - time_s[from];
            stretches.push(place(drive, from, to));
        }
    }
    (lost_s > LOST * whole_s).then(|| Fault {
        id: "dropout",
        channel: "time_s".to_owned(),
        size: lost_s,
        ci95: None,
        leaps: false,
        unit: "s".to_owned(),
        stretches,
    })
}

/// First and last sample of the stretches in which all channels run along straight lines, and some of them move.
fn straight(time_s: &[f64], channels: &[Channel]) -> Vec<(usize, usize)> {
    let mut all: Vec<(usize, usize)> = Vec::new();
    let mut from = 0;
    while from + LEAST_SAMPLES < time_s.len() {
        let long = |to: &usize| time_s[*to] - time_s[from] >= LEAST_S;
        let Some(to) = (from + LEAST_SAMPLES..time_s.len()).find(long) else { break };
        let moving: Option<Vec<bool>> =
            channels.iter().map(|channel| channel.moves(time_s, from, to)).collect();
        if moving.is_some_and(|moving| moving.iter().filter(|moves| **moves).count() >= FEWEST) {
            match all.last_mut() {
                Some(last) if from <= last.1 + 1 => last.1 = to,
                _ => all.push((from, to)),
            }
        }
        from += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_calibrate::statistics::Draws;

    /// Period in samples, and the step in which it is written.
    const WAVES: [(f64, f64); 3] = [(31.0, 1e-3), (47.0, 1e-2), (23.0, 1e-3)];

    /// Three channels of 600 samples, waves of several periods in finer and coarser steps, with noise.
    fn wave(noise: f64) -> (Vec<f64>, [Vec<f64>; 3]) {
        let mut draws = Draws::new(3, 0);
        let mut of = |period: f64, step: f64| -> Vec<f64> {
            let value = |index: u32| 10.0 * (f64::from(index) / period).sin();
            (0..600).map(|index| ((value(index) + noise * draws.normal()) / step).round() * step).collect()
        };
        ((0..600).map(|index| 0.1 * f64::from(index)).collect(), WAVES.map(|(period, step)| of(period, step)))
    }

    fn found(time_s: &[f64], channels: &[Vec<f64>; 3]) -> Vec<(usize, usize)> {
        let all: Vec<Channel> = channels.iter().filter_map(|values| Channel::of(values)).collect();
        straight(time_s, &all)
    }

    #[test]
    fn a_gap_that_was_filled_is_found_and_its_edges() {
        for noise in [0.0, 0.05] {
            let (time_s, mut channels) = wave(noise);
            for (values, (_, step)) in channels.iter_mut().zip(WAVES) {
                let (first, last) = (values[200], values[320]);
                for (place, value) in values[200..=320].iter_mut().enumerate() {
                    let straight = first + (last - first) * place as f64 / 120.0;
                    *value = (straight / step).round() * step;
                }
            }
            let gaps = found(&time_s, &channels);
            let [(from, to)] = gaps[..] else { panic!("{gaps:?}") };
            assert!(from.abs_diff(200) <= 4 && to.abs_diff(320) <= 4, "{from} to {to}");
        }
    }

    /// A wave is nearly straight where it passes nought; two channels may run along lines.
    #[test]
    fn waves_noise_and_two_lines_are_no_gap() {
        for noise in [0.0, 0.05] {
            let (time_s, mut channels) = wave(noise);
            assert!(found(&time_s, &channels).is_empty());
            for values in &mut channels[..2] {
                *values = time_s.iter().map(|time| if *time < 20.0 { *time } else { 40.0 - time }).collect();
            }
            assert!(found(&time_s, &channels).is_empty());
        }
    }
}
