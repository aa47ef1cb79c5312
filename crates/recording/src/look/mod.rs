//! What logs show about themselves: told as notices, never repaired.

mod channels;
mod pairs;
mod standstill;
mod time_base;

use crate::{Notice, NoticeKind, RecordedRun};
use headland_trace::Trace;

/// Looks at a whole log before it is cut.
pub(crate) fn at_log(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    time_base::gaps(trace, run, notices);
    channels::missing(trace, run, notices);
    channels::constant(trace, run, notices);
}

/// Looks at one run.
pub(crate) fn at_run(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    channels::jumps(trace, run, notices);
    for channel in trace.channels() {
        channels::stuck(trace, channel, run, notices);
        channels::spikes(trace, channel, run, notices);
        channels::coarse(trace, channel, run, notices);
    }
    pairs::duplicates(trace, run, notices);
    pairs::sign(trace, run, notices);
    pairs::torque_against_speed(trace, run, notices);
    pairs::battery_against_motor(trace, run, notices);
}

/// Looks at what runs have in common.
pub(crate) fn at_recording(runs: &[RecordedRun], notices: &mut Vec<Notice>) {
    standstill::offsets(runs, notices);
    merge(notices);
}

/// What is told of one channel in run after run, and is a matter of how it is logged, is told once.
pub(crate) fn merge(notices: &mut Vec<Notice>) {
    let mut merged: Vec<(Notice, usize)> = Vec::new();
    for notice in notices.drain(..) {
        let alike = matches!(
            notice.kind,
            NoticeKind::Text
                | NoticeKind::Assumed
                | NoticeKind::Coarse
                | NoticeKind::Duplicate
                | NoticeKind::Sign
        );
        let known = merged.iter_mut().find(|(known, _)| {
            alike && known.kind == notice.kind && known.channel == notice.channel && known.run != notice.run
        });
        match known {
            Some((known, runs)) => {
                known.count += notice.count;
                *runs += 1;
            }
            None => merged.push((notice, 1)),
        }
    }
    notices.extend(merged.into_iter().map(|(mut notice, runs)| {
        if runs > 1 {
            notice.text = format!("{} (likewise in {})", notice.text, counted(runs - 1, "other run"));
        }
        notice
    }));
}

/// `1 place`, `3 places`.
pub(crate) fn counted(count: usize, what: &str) -> String {
    let ending = match (count, what.ends_with("ch")) {
        (1, _) => "",
        (_, true) => "es",
        _ => "s",
    };
    format!("{count} {what}{ending}")
}

/// The speed that a log has: over ground, else of the wheels.
fn speed(trace: &Trace) -> Option<&[f64]> {
    trace.get("speed_m_s").or_else(|| trace.get("wheel_speed_m_s"))
}

/// The middle one of some numbers; NaN of none.
fn median(mut values: Vec<f64>) -> f64 {
    values.retain(|value| !value.is_nan());
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Number with the digits that a person reads.
fn short(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        let digits = if value.abs() >= 100.0 { 1 } else { 4 };
        let text = format!("{value:.digits$}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.3e}")
    }
}
