//! What one channel shows: missing, stuck, coarse, jumping.

use super::{counted, median, short, speed};
use crate::{Notice, NoticeKind};
use headland_trace::{Channel, Trace};
use std::f64::consts::PI;

/// Speed cannot change by more than this from one row to the next (m/s).
const JUMP_M_S: f64 = 3.0;
/// The vehicle moves (m/s).
const MOVING_M_S: f64 = 1.0;
/// A lively channel that holds one value this long is stuck (s), if that is also this many rows.
const STUCK_S: f64 = 5.0;
const STUCK_ROWS: usize = 25;
/// A spike is this many usual steps high, and this share of the channel's range.
const SPIKE_STEPS: f64 = 20.0;
const SPIKE_SHARE: f64 = 0.25;
/// A channel that changes in fewer than this share of rows, over more levels than a switch has, is coarse.
const COARSE_SHARE: f64 = 0.2;
const SWITCH_LEVELS: usize = 20;

/// Quantities that may rest while the vehicle moves.
const SLOW: &[&str] = &[
    "temperature",
    "pressure",
    "payload",
    "coasting",
    "brake",
    "humidity",
    "mode",
    "wind",
    "latitude",
    "longitude",
];

/// Tells cells without a value.
pub(super) fn missing(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    for channel in trace.channels() {
        let count = channel.values.iter().filter(|value| value.is_nan()).count();
        if count == 0 {
            continue;
        }
        let first = channel.values.iter().position(|value| value.is_nan()).unwrap_or(0);
        let text = if count == trace.len() {
            format!("`{}` holds no value at all", channel.name)
        } else {
            format!("`{}` has no value in {count} of {} rows", channel.name, trace.len())
        };
        let notice = Notice::new(run, NoticeKind::Nan, text).channel(&channel.name).count(count);
        notices.push(notice.first(trace.time_s()[first]));
    }
}

/// Tells speeds that change faster than a vehicle can.
pub(super) fn jumps(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    for name in ["speed_m_s", "wheel_speed_m_s"] {
        let Some(values) = trace.get(name) else { continue };
        let jumps: Vec<usize> =
            (1..values.len()).filter(|row| (values[*row] - values[row - 1]).abs() > JUMP_M_S).collect();
        let Some(first) = jumps.first() else { continue };
        let text = format!(
            "`{name}` changes by more than {JUMP_M_S} m/s from one row to the next at {}; first from {} to {} m/s \
             at {} s",
            counted(jumps.len(), "place"),
            short(values[first - 1]),
            short(values[*first]),
            short(trace.time_s()[*first])
        );
        let notice = Notice::new(run, NoticeKind::Jump, text).channel(name).count(jumps.len());
        notices.push(notice.first(trace.time_s()[*first]));
    }
}

/// Quantities whose values go round: the difference of two is the shorter way.
const ROUND: &[&str] = &["heading", "direction", "angle", "yaw_rad"];

/// Whether a quantity may rest while the vehicle moves.
fn is_slow(channel: &Channel) -> bool {
    let name = channel.name.to_lowercase();
    SLOW.iter().any(|slow| name.contains(slow))
}

/// Whether the vehicle moves in a row; where there is no speed it is taken to.
fn moves(trace: &Trace, row: usize) -> bool {
    speed(trace).is_none_or(|speed| speed[row].abs() > MOVING_M_S)
}

/// Tells channels that hold one value throughout a log in which the vehicle moves.
pub(super) fn constant(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    if trace.len() < STUCK_ROWS || !(0..trace.len()).any(|row| moves(trace, row)) {
        return;
    }
    for channel in trace.channels().iter().filter(|channel| !is_slow(channel)) {
        let first = channel.values[0];
        if channel.values.iter().all(|value| *value == first) {
            let text = format!("`{}` is {} throughout", channel.name, short(first));
            let notice = Notice::new(run, NoticeKind::Stuck, text).channel(&channel.name).count(trace.len());
            notices.push(notice.first(trace.time_s()[0]));
        }
    }
}

/// Tells a channel that rests although it otherwise changes with most rows.
pub(super) fn stuck(trace: &Trace, channel: &Channel, run: &str, notices: &mut Vec<Notice>) {
    let (time, values) = (trace.time_s(), &channel.values);
    if is_slow(channel) || values.len() < STUCK_ROWS {
        return;
    }
    let moving = |row: usize| moves(trace, row);
    let changes = (1..values.len()).filter(|row| values[*row] != values[row - 1] && moving(*row)).count();
    let rows = (1..values.len()).filter(|row| moving(*row)).count();
    if (changes as f64) < 0.5 * rows as f64 {
        return;
    }
    let mut longest = (0, 0);
    let (mut count, mut found, mut start) = (0, None, 0);
    for row in 1..=values.len() {
        if row < values.len() && values[row] == values[start] {
            continue;
        }
        let held = row - start;
        let long = held >= STUCK_ROWS && time[row - 1] - time[start] >= STUCK_S;
        if long && values[start] != 0.0 && (start..row).all(moving) {
            count += 1;
            found = found.or(Some(start));
            if held > longest.1 {
                longest = (start, held);
            }
        }
        start = row;
    }
    if let Some(first) = found {
        let held_s = time[longest.0 + longest.1 - 1] - time[longest.0];
        let text = format!(
            "`{}` rests at {} for {} s from {} s while the vehicle moves; {} like this",
            channel.name,
            short(values[longest.0]),
            short(held_s),
            short(time[longest.0]),
            counted(count, "stretch")
        );
        notices.push(
            Notice::new(run, NoticeKind::Stuck, text).channel(&channel.name).count(count).first(time[first]),
        );
    }
}

/// Tells single samples that stand far away from both their neighbours.
pub(super) fn spikes(trace: &Trace, channel: &Channel, run: &str, notices: &mut Vec<Notice>) {
    let values = &channel.values;
    let round = channel.name.ends_with("_rad") && ROUND.iter().any(|name| channel.name.contains(name));
    let step =
        |from: f64, to: f64| if round { (to - from + PI).rem_euclid(2.0 * PI) - PI } else { to - from };
    let steps: Vec<f64> =
        values.windows(2).map(|pair| step(pair[0], pair[1]).abs()).filter(|step| *step > 0.0).collect();
    let usual = median(steps);
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    if sorted.len() < STUCK_ROWS {
        return;
    }
    let range = sorted[sorted.len() * 99 / 100] - sorted[sorted.len() / 100];
    let height = (SPIKE_STEPS * usual).max(SPIKE_SHARE * range);
    let spikes: Vec<usize> = (1..values.len() - 1)
        .filter(|row| {
            let (before, after) = (step(values[row - 1], values[*row]), step(values[row + 1], values[*row]));
            before * after > 0.0 && before.abs().min(after.abs()) > height && height > 0.0
        })
        .collect();
    if let Some(first) = spikes.first() {
        let text = format!(
            "`{}` has {} far from both neighbours; first {} between {} and {} at {} s",
            channel.name,
            counted(spikes.len(), "single sample"),
            short(values[*first]),
            short(values[first - 1]),
            short(values[first + 1]),
            short(trace.time_s()[*first])
        );
        let notice = Notice::new(run, NoticeKind::Spike, text).channel(&channel.name).count(spikes.len());
        notices.push(notice.first(trace.time_s()[*first]));
    }
}

/// Tells a channel that changes seldom and in steps.
pub(super) fn coarse(trace: &Trace, channel: &Channel, run: &str, notices: &mut Vec<Notice>) {
    if is_slow(channel) {
        return;
    }
    let values = &channel.values;
    let mut levels: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup();
    let moving = |row: usize| moves(trace, row);
    let rows = (1..values.len()).filter(|row| moving(*row)).count();
    let steps: Vec<f64> = (1..values.len())
        .filter(|row| moving(*row))
        .map(|row| (values[row] - values[row - 1]).abs())
        .filter(|step| *step > 0.0)
        .collect();
    if levels.len() < SWITCH_LEVELS || steps.is_empty() || steps.len() as f64 > COARSE_SHARE * rows as f64 {
        return;
    }
    let text = format!(
        "`{}` changes in {} of {rows} rows while the vehicle moves, mostly by {}: its slope is known over longer times only",
        channel.name,
        steps.len(),
        short(median(steps.clone()))
    );
    notices.push(Notice::new(run, NoticeKind::Coarse, text).channel(&channel.name).count(steps.len()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    fn drive(name: &str, value: impl Fn(u32) -> f64) -> Trace {
        let mut trace = Trace::new((0..600).map(|row| f64::from(row) * 0.1).collect()).unwrap();
        let speed = (0..600).map(|row| 5.0 + (f64::from(row) * 0.05).sin()).collect();
        trace.push("speed_m_s", speed, Origin::Measured).unwrap();
        trace.push(name, (0..600).map(value).collect(), Origin::Measured).unwrap();
        trace
    }

    fn seen(trace: &Trace) -> Vec<(NoticeKind, usize, Option<f64>)> {
        let mut notices = Vec::new();
        super::super::at_log(trace, "r", &mut notices);
        super::super::at_run(trace, "r", &mut notices);
        notices.iter().map(|notice| (notice.kind, notice.count, notice.first_s)).collect()
    }

    #[test]
    fn a_lively_channel_that_rests_is_stuck() {
        let torque =
            |row: u32| if (200..300).contains(&row) { 40.0 } else { (f64::from(row) * 0.3).sin() * 50.0 };
        assert_eq!(seen(&drive("force_n", torque)), [(NoticeKind::Stuck, 1, Some(20.0))]);
        assert_eq!(seen(&drive("force_n", |row| (f64::from(row) * 0.3).sin() * 50.0)), []);
    }

    #[test]
    fn a_channel_that_never_changes_is_stuck_unless_it_may_rest() {
        assert_eq!(seen(&drive("force_n", |_| 40.0)), [(NoticeKind::Stuck, 600, Some(0.0))]);
        assert_eq!(seen(&drive("air_temperature_c", |_| 17.5)), []);
    }

    #[test]
    fn a_single_sample_far_away_is_a_spike() {
        let value = |row: u32| if row == 77 { 900.0 } else { (f64::from(row) * 0.3).sin() * 50.0 };
        assert_eq!(seen(&drive("force_n", value)), [(NoticeKind::Spike, 1, Some(7.7))]);
    }

    #[test]
    fn missing_values_are_counted() {
        let value = |row: u32| if row % 100 == 50 { f64::NAN } else { (f64::from(row) * 0.3).sin() };
        assert_eq!(seen(&drive("force_n", value)), [(NoticeKind::Nan, 6, Some(5.0))]);
    }

    #[test]
    fn a_charge_in_steps_is_coarse() {
        let value = |row: u32| 0.9 - f64::from(row / 20) * 0.0002;
        assert_eq!(seen(&drive("state_of_charge", value)), [(NoticeKind::Coarse, 29, None)]);
    }

    #[test]
    fn a_speed_that_jumps_is_told() {
        let mut trace = Trace::new((0..100).map(|row| f64::from(row) * 0.1).collect()).unwrap();
        let speed = (0..100)
            .map(|row| if row < 50 { 9.0 + f64::from(row) * 0.01 } else { 1.0 + f64::from(row) * 0.01 });
        trace.push("speed_m_s", speed.collect(), Origin::Measured).unwrap();
        assert_eq!(seen(&trace), [(NoticeKind::Jump, 1, Some(5.0))]);
    }
}
