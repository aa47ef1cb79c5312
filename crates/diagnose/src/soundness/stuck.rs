//! A channel that sticks: the same value for longer than the sensor, its resolution and its noise let it be.

use crate::runs::recorded::Recorded;
use crate::soundness::faults::{Fault, SLOWEST_M_S, own, place};
use headland_calibrate::statistics::{quantile_of_sorted, sorted};
use headland_trace::Trace;

/// A value is stuck that stays the same for so long [s] and so many samples.
const STUCK_S: f64 = 1.0;
const STUCK_SAMPLES: usize = 15;
/// Where it leaps to the next value, by so many times all but a few of its steps, it was stuck for a shorter time as well.
pub const LEAP: f64 = 5.0;
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

/// Stretches of equal values, first and last sample.
pub fn still(values: &[f64]) -> Vec<(usize, usize)> {
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

/// For how many samples a channel holds a value, all but the longest stretches that make up [`UNUSUAL`] of the samples, or a
/// few short ones, and the one that is longest of all.
fn usual_length(equal: &[(usize, usize)], samples: usize) -> f64 {
    /// In a short run that is renewed rarely, so many values repeat by chance.
    const FEW: usize = 3;
    let mut lengths: Vec<usize> = equal.iter().map(|(from, to)| to - from + 1).collect();
    lengths.sort_unstable();
    let longest = lengths.pop().unwrap_or(1);
    let beyond = UNUSUAL * (samples - longest.min(samples)) as f64;
    let (mut seen, mut longer) = (0, 0);
    while let Some(length) = lengths.pop() {
        seen += length;
        longer += 1;
        if seen as f64 > beyond && (longer > FEW || length >= STUCK_SAMPLES) {
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
    taken_back(&moves(values))
}

/// By how much a channel changes where it does.
fn moves(values: &[f64]) -> Vec<f64> {
    let moves = values.windows(2).map(|pair| pair[1] - pair[0]);
    moves.filter(|step| step.is_finite() && *step != 0.0).collect()
}

/// How many of some moves are of another sign than the one before, as a share.
fn taken_back(moves: &[f64]) -> f64 {
    let turns = moves.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    turns as f64 / moves.len().max(1) as f64
}

/// All but [`UNUSUAL`] of the steps of a channel are smaller.
pub fn usual_step(values: &[f64]) -> f64 {
    let steps = changes(values);
    if steps.is_empty() { f64::INFINITY } else { quantile_of_sorted(&steps, 1.0 - UNUSUAL) }
}

/// Whether a channel leaps behind a stretch of equal values, first and last: further than it ever does but there, or about as
/// far as it would have come meanwhile at its usual pace.
fn leaping(values: &[f64]) -> impl Fn(usize, usize) -> bool {
    /// What is caught up is this share of the usual way at least,
    const CAUGHT_UP: f64 = 0.5;
    /// and stands out from the steps of the channel.
    const STANDS_OUT: f64 = 2.0;
    let (usual, steps) = (usual_step(values), changes(values));
    let pace = if steps.is_empty() { f64::INFINITY } else { quantile_of_sorted(&steps, 0.5) };
    move |from, to| {
        let Some(leap) = values.get(to + 1).map(|next| (next - values[to]).abs()) else { return false };
        leap > LEAP * usual || leap > STANDS_OUT * usual && leap > CAUGHT_UP * pace * (to + 1 - from) as f64
    }
}

/// Whether a channel changes by one and the same step, if it does: then it waits for the next one, and what keeps its speed has it wait
/// long.
fn waits(values: &[f64]) -> bool {
    /// Four steps of five are as large as the smallest but for a few.
    const MOST: f64 = 0.8;
    const LEAST: f64 = 0.05;
    const THE_SAME: f64 = 1.05;
    let steps = changes(values);
    !steps.is_empty() && quantile_of_sorted(&steps, MOST) < THE_SAME * quantile_of_sorted(&steps, LEAST)
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
    /// Of changes of moves, which a channel on its way up or down has as well, white noise takes back 73 of a hundred.
    const CHANGES_TAKEN_BACK: f64 = 0.55;
    /// And they are at least this share of the moves: those of a smooth channel are the last digits of a computer's numbers.
    const LEAST_CHANGE: f64 = 0.1;
    // The smallest but for a few: rounding makes steps of next to nothing.
    let coarse = |steps: &[f64]| {
        !steps.is_empty() && quantile_of_sorted(steps, 0.5) > COARSE * quantile_of_sorted(steps, 0.02)
    };
    let bends: Vec<f64> = moves(values).windows(2).map(|pair| pair[1] - pair[0]).collect();
    let steps = changes(values);
    let sizes = sorted(&bends.iter().map(|bend| bend.abs()).filter(|size| *size > 0.0).collect::<Vec<_>>());
    let rough =
        |sizes: &[f64]| quantile_of_sorted(sizes, 0.5) > LEAST_CHANGE * quantile_of_sorted(&steps, 0.5);
    coarse(&steps) && turns(values) > TAKEN_BACK
        || coarse(&sizes) && rough(&sizes) && taken_back(&bends) > CHANGES_TAKEN_BACK
}

/// Stretches, first and last sample, in which a channel stays the same for too long while the vehicle is `moving`: what it does
/// while the vehicle stands still may well stay as it is. One with a noise of its own never does.
fn stuck_while(
    moving: &[bool],
    time_s: &[f64],
    (values, equal): (&[f64], &[(usize, usize)]),
    own_noise: bool,
    leaps: impl Fn(usize, usize) -> bool,
) -> Vec<(usize, usize)> {
    let enough = if own_noise { 0.0 } else { HELD * usual_length(equal, values.len()) };
    let long = |(from, to): &(usize, usize)| {
        let (samples, long_s) = if leaps(*from, *to) {
            (STUCK_SAMPLES_BEFORE_A_LEAP, STUCK_BEFORE_A_LEAP_S)
        } else {
            (STUCK_SAMPLES, STUCK_S)
        };
        let moved = moving[*from..=*to].iter().filter(|moving| **moving).count().saturating_sub(1);
        let moved_s = (time_s[*to] - time_s[*from]) * moved as f64 / (to - from) as f64;
        values[*from] != 0.0 && moved >= samples && moved as f64 >= enough && moved_s >= long_s
    };
    equal.iter().copied().filter(long).collect()
}

/// A channel that sticks, in all runs; its samples are not `usable`.
pub fn stuck(drives: &[Recorded], name: &str, usable: &mut [Vec<bool>]) -> Option<Fault> {
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
        let (leaps, waits) = (leaping(values), waits(values));
        let moving: Vec<bool> =
            drive.motion.value.iter().map(|speed_m_s| speed_m_s.abs() > SLOWEST_M_S).collect();
        let mut long = stuck_while(&moving, time_s, (values, &equal), own_noise, &leaps);
        long.retain(|(from, to)| !waits || leaps(*from, *to));
        if long.is_empty() {
            continue;
        }
        runs += 1;
        leaps_everywhere &= long.iter().all(|(from, to)| leaps(*from, *to));
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
        ci95: None,
        leaps: false,
        unit: "s".to_owned(),
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
    fn a_channel_sticks_that_stays_the_same_while_the_vehicle_moves_though_it_stops_meanwhile() {
        let time_s: Vec<f64> = (0..400).map(|index| 0.1 * f64::from(index)).collect();
        let values = stuck_at(100, 0.01);
        let stuck = |stops: std::ops::Range<usize>| {
            let moving: Vec<bool> = (0..400).map(|index| !stops.contains(&index)).collect();
            stuck_while(&moving, &time_s, (&values, &still(&values)), true, leaping(&values))
        };
        assert_eq!(stuck(0..0), [(100, 129)]);
        assert_eq!(stuck(105..115), [(100, 129)]);
        assert_eq!(stuck(98..127), [], "at a standstill a reading may stay as it is");
    }

    /// On its way down by 0.08 a sample, held for ten samples: it catches up with what it would have come meanwhile.
    /// In steps of 1 km/h, with a noise of a tenth of that, at an even speed and on the way to it.
    #[test]
    fn a_channel_of_coarse_steps_waits_for_the_next_one() {
        let mut draws = Draws::new(5, 0);
        let mut of = |resolution: f64| -> Vec<f64> {
            let speed = |row: usize| 0.05 * row.min(250) as f64 + 0.03 * draws.normal();
            (0..500).map(speed).map(|speed| (speed / resolution).round() * resolution).collect()
        };
        assert!(waits(&of(1.0 / 3.6)));
        assert!(!waits(&of(0.01)));
    }

    #[test]
    fn a_channel_that_catches_up_was_stuck() {
        let held = |at: usize| if (14..24).contains(&at) { 14 } else { at };
        let wavy = |at: usize| 0.06 * ((at * 7919 % 101) as f64 / 50.0 - 1.0);
        let values: Vec<f64> = (0..60).map(|at| 4.4 - 0.06 * held(at) as f64 + wavy(held(at))).collect();
        let leaps = leaping(&values);
        assert!((values[24] - values[23]).abs() < LEAP * usual_step(&values), "the old rule would do");
        assert!(leaps(14, 23));
        let coarse: Vec<f64> = (0..60).map(|at| 0.5 * (0.16 * f64::from(at)).round()).collect();
        let leaps = leaping(&coarse);
        let equal = still(&coarse);
        assert!(equal.len() > 5 && equal.iter().all(|(from, to)| !leaps(*from, *to)), "steps of resolution");
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
        let falling = |noise: f64| -> Vec<f64> {
            held(noise).iter().enumerate().map(|(index, value)| value - (150 * (index / 5)) as f64).collect()
        };
        assert!(
            renews(&falling(0.01)),
            "on its way down it takes no move back, and changes of moves all the same"
        );
        assert!(!renews(&falling(0.0)));
        let coarse: Vec<f64> = held(0.01).iter().map(|value| 1e4 * (value / 1e4).round()).collect();
        assert!(!renews(&coarse), "a coarse channel stays where it is");
    }
}
