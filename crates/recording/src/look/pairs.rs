//! What two channels show about each other.

use super::{median, short, speed};
use crate::{Notice, NoticeKind};
use headland_trace::Trace;

/// Length of the windows in which torque is held against acceleration (s).
const WINDOW_S: f64 = 60.0;
/// Half the time over which speed is differentiated (s).
const SLOPE_S: f64 = 0.3;
/// Correlations of a window that fits and of one that does not.
const FITS: f64 = 0.8;
const MISFITS: f64 = 0.4;
/// A delay that is worth telling (s), and how far it is looked for.
const LEAST_LAG_S: f64 = 0.3;
const MOST_LAG_S: f64 = 3.0;
/// Powers part where they differ by so many usual differences, by this share of the largest, in so many rows.
const PARTED: f64 = 3.0;
const PARTED_SHARE: f64 = 0.1;
const PARTED_ROWS: usize = 20;
/// How much better the shifted channels have to agree.
const BETTER: f64 = 0.05;

/// Tells channels with the same values.
pub(super) fn duplicates(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    let all = trace.channels();
    for (index, channel) in all.iter().enumerate() {
        let first = channel.values.iter().find(|value| !value.is_nan());
        let constant = channel.values.iter().all(|value| value.is_nan() || Some(value) == first);
        if constant {
            continue;
        }
        let same = |a: &f64, b: &f64| a == b || (a.is_nan() && b.is_nan());
        let twin = all[..index]
            .iter()
            .find(|other| other.values.iter().zip(&channel.values).all(|(a, b)| same(a, b)));
        if let Some(twin) = twin {
            let text = format!(
                "`{}` holds the same values as `{}`: not a second measurement",
                channel.name, twin.name
            );
            notices.push(
                Notice::new(run, NoticeKind::Duplicate, text).channel(&channel.name).count(trace.len()),
            );
        }
    }
}

/// Tells a battery current that charges while the motor drives.
pub(super) fn sign(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    let (Some(current), Some(torque), Some(speed)) =
        (trace.get("battery_current_a"), trace.get("motor_torque_n_m"), speed(trace))
    else {
        return;
    };
    let power: Vec<f64> = torque.iter().zip(speed).map(|(torque, speed)| torque * speed).collect();
    let likeness = correlation(current, &power);
    if likeness < -0.5 {
        let text = format!(
            "`battery_current_a` falls when the motor drives (correlation {}); discharge is positive here, `scale: -1.0` \
             turns it",
            short(likeness)
        );
        notices.push(Notice::new(run, NoticeKind::Sign, text).channel("battery_current_a"));
    }
}

/// Tells where a drive torque and the acceleration that it should cause do not belong together, or do so later.
pub(super) fn torque_against_speed(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    let name = ["motor_torque_n_m", "tractive_force_n", "engine_torque_n_m"]
        .into_iter()
        .find(|name| trace.get(name).is_some());
    let (Some(name), Some(speed)) = (name, trace.get("speed_m_s")) else { return };
    let (Some(torque), time) = (trace.get(name), trace.time_s()) else { return };
    let step = median(time.windows(2).map(|pair| pair[1] - pair[0]).collect());
    if !(step > 0.0 && step <= 0.5 * LEAST_LAG_S) {
        return;
    }
    let rows = |seconds: f64| rows_in(seconds, step);
    let half = rows(SLOPE_S);
    let slope: Vec<f64> = (0..speed.len())
        .map(|row| match (row.checked_sub(half), speed.get(row + half)) {
            (Some(before), Some(after)) if speed[row].abs() > 1.0 => {
                (after - speed[before]) / (time[row + half] - time[before])
            }
            _ => f64::NAN,
        })
        .collect();
    let window = rows(WINDOW_S);
    let mut fits = Vec::new();
    let mut bad = Vec::new();
    for start in (0..slope.len()).step_by(window) {
        let end = (start + window).min(slope.len());
        let counted = (start..end).filter(|row| !slope[*row].is_nan() && !torque[*row].is_nan()).count();
        if counted < window / 3 {
            continue;
        }
        let likeness = correlation(&torque[start..end], &slope[start..end]);
        if likeness.is_nan() {
            continue;
        }
        fits.push(likeness);
        if likeness < MISFITS {
            bad.push((time[start], likeness));
        }
    }
    let count = fits.len();
    if median(fits) < FITS {
        return;
    }
    if let Some((first, likeness)) = bad.first() {
        let places: Vec<String> = bad.iter().map(|(start, _)| short(*start)).collect();
        let text = format!(
            "`{name}` and the change of `speed_m_s` do not belong together in {} of {count} windows of {WINDOW_S} s, from \
             {} s (correlation {} in the first)",
            bad.len(),
            places.join(", "),
            short(*likeness)
        );
        notices.push(Notice::new(run, NoticeKind::Lag, text).channel(name).count(bad.len()).first(*first));
    }
    lag(name, torque, &slope, step, run, notices);
}

/// Tells rows in which what the battery gives and what the motor does part, beyond what a run's own spread explains.
pub(super) fn battery_against_motor(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    let (Some(current), Some(voltage), Some(torque), Some(speed)) = (
        trace.get("battery_current_a"),
        trace.get("battery_voltage_v"),
        trace.get("motor_torque_n_m"),
        trace.get("speed_m_s"),
    ) else {
        return;
    };
    let battery: Vec<f64> = current.iter().zip(voltage).map(|(current, voltage)| current * voltage).collect();
    let motor: Vec<f64> = torque.iter().zip(speed).map(|(torque, speed)| torque * speed).collect();
    let Some((slope, zero)) = straight(&motor, &battery) else { return };
    let rest: Vec<f64> =
        motor.iter().zip(&battery).map(|(motor, battery)| battery - zero - slope * motor).collect();
    let usual = median(rest.iter().map(|rest| rest.abs()).collect());
    let size =
        battery.iter().filter(|power| !power.is_nan()).fold(0.0_f64, |most, power| most.max(power.abs()));
    let limit = (PARTED * usual).max(PARTED_SHARE * size);
    let rows: Vec<usize> = (0..rest.len()).filter(|row| rest[*row].abs() > limit).collect();
    let Some(first) = rows.first() else { return };
    if rows.len() < PARTED_ROWS {
        return;
    }
    let text = format!(
        "battery power and motor torque times speed part by more than {} W in {} rows, first at {} s: one of them is late \
         or wrong there",
        short(limit.round()),
        rows.len(),
        short(trace.time_s()[*first])
    );
    let notice = Notice::new(run, NoticeKind::Lag, text).channel("motor_torque_n_m").count(rows.len());
    notices.push(notice.first(trace.time_s()[*first]));
}

/// Slope and zero of the straight line through points, by least squares.
fn straight(x: &[f64], y: &[f64]) -> Option<(f64, f64)> {
    let pairs = || x.iter().zip(y).filter(|(x, y)| !x.is_nan() && !y.is_nan());
    let count = pairs().count() as f64;
    let (mean_x, mean_y) =
        (pairs().map(|(x, _)| x).sum::<f64>() / count, pairs().map(|(_, y)| y).sum::<f64>() / count);
    let xx: f64 = pairs().map(|(x, _)| (x - mean_x).powi(2)).sum();
    let xy: f64 = pairs().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    (xx > 0.0).then(|| (xy / xx, mean_y - mean_x * xy / xx))
}

/// Tells a delay between a torque and its acceleration. Both are shifted by whole rows.
fn lag(name: &str, torque: &[f64], slope: &[f64], step: f64, run: &str, notices: &mut Vec<Notice>) {
    let most = rows_in(MOST_LAG_S, step).min(torque.len() / 4);
    let shifted = |rows: usize, torque_late: bool| {
        let end = torque.len() - rows;
        if torque_late {
            correlation(&torque[rows..], &slope[..end])
        } else {
            correlation(&torque[..end], &slope[rows..])
        }
    };
    let now = shifted(0, true);
    let mut best = (now, 0.0);
    for rows in 1..=most {
        for (late, sign) in [(true, 1.0), (false, -1.0)] {
            let likeness = shifted(rows, late);
            if likeness > best.0 {
                best = (likeness, sign * rows as f64 * step);
            }
        }
    }
    if best.1.abs() >= LEAST_LAG_S && best.0 > now + BETTER {
        let which = if best.1 > 0.0 { "later" } else { "earlier" };
        let text = format!(
            "`{name}` is {} s {which} than the change of `speed_m_s` (correlation {} instead of {})",
            short(best.1.abs()),
            short(best.0),
            short(now)
        );
        notices.push(Notice::new(run, NoticeKind::Lag, text).channel(name));
    }
}

/// How many rows of `step` seconds make up a time; at least one.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive whole number")]
fn rows_in(seconds: f64, step: f64) -> usize {
    (seconds / step).round().max(1.0) as usize
}

/// Pearson's correlation over the pairs of which both are there; NaN where one does not vary.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let pairs = || a.iter().zip(b).filter(|(a, b)| !a.is_nan() && !b.is_nan());
    let count = pairs().count() as f64;
    let (mean_a, mean_b) =
        (pairs().map(|(a, _)| a).sum::<f64>() / count, pairs().map(|(_, b)| b).sum::<f64>() / count);
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (a, b) in pairs() {
        aa += (a - mean_a).powi(2);
        bb += (b - mean_b).powi(2);
        ab += (a - mean_a) * (b - mean_b);
    }
    ab / (aa * bb).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    /// dv/dt = 0.6 cos(0.3 t) + 0.6 cos(0.47 t): two periods that do not repeat within the lags that are tried.
    fn drive(delay_s: f64, broken_until_s: f64) -> Trace {
        let time: Vec<f64> = (0..3000).map(|row| f64::from(row) * 0.1).collect();
        let speed =
            time.iter().map(|t| 10.0 + 2.0 * (0.3 * t).sin() + 0.6 / 0.47 * (0.47 * t).sin()).collect();
        let torque = |t: f64| 100.0 * (0.6 * (0.3 * t).cos() + 0.6 * (0.47 * t).cos());
        let torque = time
            .iter()
            .map(|t| torque(*t - delay_s) * if *t < broken_until_s { -1.0 } else { 1.0 })
            .collect();
        let mut trace = Trace::new(time).unwrap();
        trace.push("speed_m_s", speed, Origin::Measured).unwrap();
        trace.push("motor_torque_n_m", torque, Origin::Measured).unwrap();
        trace
    }

    fn told(trace: &Trace) -> Vec<Notice> {
        let mut notices = Vec::new();
        torque_against_speed(trace, "r", &mut notices);
        notices
    }

    #[test]
    fn torque_that_causes_acceleration_is_not_told() {
        assert!(told(&drive(0.0, 0.0)).is_empty());
    }

    #[test]
    fn a_late_torque_is_told_with_its_delay() {
        let notices = told(&drive(1.0, 0.0));
        assert_eq!(notices.len(), 1, "{notices:?}");
        assert!(notices[0].text.contains("is 1 s later"), "{}", notices[0].text);
    }

    #[test]
    fn windows_that_do_not_belong_together_are_told() {
        let notices = told(&drive(0.0, 59.0));
        assert_eq!((notices[0].count, notices[0].first_s), (1, Some(0.0)), "{notices:?}");
    }

    #[test]
    fn a_current_that_charges_while_driving_is_told() {
        let mut trace = drive(0.0, 0.0);
        let current: Vec<f64> = trace.get("motor_torque_n_m").unwrap().iter().map(|torque| -torque).collect();
        trace.push("battery_current_a", current, Origin::Measured).unwrap();
        let mut notices = Vec::new();
        sign(&trace, "r", &mut notices);
        assert_eq!(notices.len(), 1);
        assert_eq!(notices[0].kind, NoticeKind::Sign);
    }

    /// For 2 s the current says that nothing is drawn while the motor drives.
    #[test]
    fn powers_that_part_are_told() {
        let mut trace = drive(0.0, 0.0);
        let (torque, speed) = (trace.get("motor_torque_n_m").unwrap(), trace.get("speed_m_s").unwrap());
        let current =
            |row: usize| if (10..30).contains(&row) { 0.0 } else { torque[row] * speed[row] / 40.0 + 1.0 };
        let current: Vec<f64> = (0..trace.len()).map(current).collect();
        trace.push("battery_current_a", current, Origin::Measured).unwrap();
        trace.push("battery_voltage_v", vec![400.0; 3000], Origin::Measured).unwrap();
        let mut notices = Vec::new();
        battery_against_motor(&trace, "r", &mut notices);
        assert_eq!((notices[0].count, notices[0].first_s), (20, Some(1.0)), "{notices:?}");
    }

    #[test]
    fn the_same_values_twice_are_told() {
        let mut trace = drive(0.0, 0.0);
        let copy = trace.get("speed_m_s").unwrap().to_vec();
        trace.push("gps", copy, Origin::Measured).unwrap();
        let mut notices = Vec::new();
        duplicates(&trace, "r", &mut notices);
        assert_eq!(notices.iter().map(|notice| notice.channel.as_deref()).collect::<Vec<_>>(), [Some("gps")]);
    }
}
