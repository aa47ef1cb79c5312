//! What sensors read when there is nothing to read.

use super::{median, short, speed};
use crate::{Notice, NoticeKind, RecordedRun};
use headland_units::{Dimension, parse_unit, unit_of_name};

/// The vehicle stands (m/s).
const STANDS_M_S: f64 = 0.3;
/// How long it has to stand for its readings to count (s).
const LEAST_S: f64 = 1.0;
/// So long before a vehicle moves off, and after it stopped, something drives or holds it already (s).
const ABOUT_TO_S: f64 = 1.0;
/// The reading at standstill that is worth telling, as a share of the largest reading.
const SHARE: f64 = 0.02;

/// Tells forces, moments, accelerations and rates that do not read zero while the vehicle stands, and whether they do
/// so differently from run to run.
pub(super) fn offsets(runs: &[RecordedRun], notices: &mut Vec<Notice>) {
    let mut names: Vec<&str> = Vec::new();
    for channel in runs.iter().flat_map(|run| run.trace.channels()) {
        if reads_zero_at_rest(&channel.name) && !names.contains(&channel.name.as_str()) {
            names.push(&channel.name);
        }
    }
    for name in names {
        let mut found = Vec::new();
        for run in runs {
            let Some(reading) = at_rest(run, name) else { continue };
            found.push(reading);
        }
        let (least, most) =
            found.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), reading| {
                (least.min(reading.0), most.max(reading.0))
            });
        let largest = found.iter().map(|reading| reading.1).fold(0.0, f64::max);
        if found.is_empty() || least.abs().max(most.abs()) <= SHARE * largest {
            continue;
        }
        let text = if found.len() == 1 {
            format!("`{name}` reads {} while the vehicle stands", short(least))
        } else if most - least <= SHARE * largest {
            format!("`{name}` reads {} while the vehicle stands, alike in {} runs", short(least), found.len())
        } else {
            format!(
                "`{name}` reads {} to {} while the vehicle stands, differently in {} runs",
                short(least),
                short(most),
                found.len()
            )
        };
        let run = if runs.len() == 1 { runs[0].id.as_str() } else { "" };
        notices.push(Notice::new(run, NoticeKind::Offset, text).channel(name).count(found.len()));
    }
}

/// Whether a channel should read zero while the vehicle stands: no torque of a machine that may run or hold it.
fn reads_zero_at_rest(name: &str) -> bool {
    let Some(unit) = unit_of_name(name) else { return false };
    let machine = ["engine", "motor", "pto", "vertical"].iter().any(|word| name.contains(word));
    let is = |text: &str| parse_unit(text).is_ok_and(|known| known.dimension == unit.dimension);
    let of_engine_speed = unit.dimension == Dimension::of(0, 0, -1, 0, 0, 1) && !name.contains("yaw");
    !machine
        && !of_engine_speed
        && (is("N") || is("N m") || is("m/s^2") || is("rad/s"))
        && !name.ends_with("_j")
}

/// The reading at standstill and the largest reading, both in the middle of what was read.
fn at_rest(run: &RecordedRun, name: &str) -> Option<(f64, f64)> {
    let (values, speed, time) = (run.trace.get(name)?, speed(&run.trace)?, run.trace.time_s());
    let moves = |row: usize| speed[row].abs() >= STANDS_M_S;
    let mut still: Vec<bool> = (0..time.len()).map(|row| speed[row].abs() < STANDS_M_S).collect();
    let mut moved_s = f64::NEG_INFINITY;
    for row in 0..time.len() {
        moved_s = if moves(row) { time[row] } else { moved_s };
        still[row] &= time[row] - moved_s >= ABOUT_TO_S;
    }
    let mut moves_s = f64::INFINITY;
    for row in (0..time.len()).rev() {
        moves_s = if moves(row) { time[row] } else { moves_s };
        still[row] &= moves_s - time[row] >= ABOUT_TO_S;
    }
    let standing = |row: usize| still[row];
    let stood_s: f64 = (1..time.len())
        .filter(|row| standing(*row) && standing(row - 1))
        .map(|row| time[row] - time[row - 1])
        .sum();
    let moved = (0..time.len()).any(|row| speed[row].abs() > 1.0);
    if stood_s < LEAST_S || !moved {
        return None;
    }
    let reading = median((0..time.len()).filter(|row| standing(*row)).map(|row| values[row]).collect());
    let largest = values.iter().map(|value| value.abs()).filter(|value| !value.is_nan()).fold(0.0, f64::max);
    (!reading.is_nan()).then_some((reading, largest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::{Origin, Trace};

    fn run(id: &str, offset_n: f64) -> RecordedRun {
        let mut trace = Trace::new((0..200).map(|row| f64::from(row) * 0.1).collect()).unwrap();
        trace
            .push(
                "speed_m_s",
                (0..200).map(|row| if row < 50 { 0.0 } else { 5.0 }).collect(),
                Origin::Measured,
            )
            .unwrap();
        let force = (0..200).map(|row| offset_n + if row < 50 { 0.0 } else { 800.0 }).collect();
        trace.push("wheel_force_n", force, Origin::Measured).unwrap();
        RecordedRun {
            id: id.to_owned(),
            trace,
            path: None,
            reversed: false,
            held_out: false,
            known: Vec::new(),
            sensors: Vec::new(),
        }
    }

    #[test]
    fn offsets_that_differ_between_runs_are_told_once() {
        let mut notices = Vec::new();
        offsets(&[run("a", -170.0), run("b", 30.0)], &mut notices);
        assert_eq!(notices.len(), 1);
        assert!(notices[0].text.contains("reads -170 to 30") && notices[0].text.contains("differently"));
    }

    /// A tractor that pulls away: its force is there for most of a second before it moves.
    #[test]
    fn a_force_that_moves_a_vehicle_off_is_no_offset() {
        let mut off = run("a", 0.0);
        let force = (0..200).map(|row| if row < 42 { 0.0 } else { 800.0 }).collect();
        off.trace.remove("wheel_force_n");
        off.trace.push("wheel_force_n", force, Origin::Measured).unwrap();
        // And one that is logged from the moment on at which somebody drives.
        let mut begun = run("b", 0.0);
        begun.trace.remove("speed_m_s");
        let speed = (0..200).map(|row| 0.02 * f64::from(row)).collect();
        begun.trace.push("speed_m_s", speed, Origin::Measured).unwrap();
        begun.trace.remove("wheel_force_n");
        begun.trace.push("wheel_force_n", vec![800.0; 200], Origin::Measured).unwrap();
        let mut notices = Vec::new();
        offsets(&[off, begun], &mut notices);
        assert!(notices.is_empty(), "{notices:?}");
    }

    #[test]
    fn a_transducer_that_reads_zero_is_not_told() {
        let mut notices = Vec::new();
        offsets(&[run("a", 0.0), run("b", 5.0)], &mut notices);
        assert!(notices.is_empty(), "{notices:?}");
    }
}
