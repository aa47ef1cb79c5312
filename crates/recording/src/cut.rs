//! Cutting a log into runs: by the stretches that are named, or where it was put together without saying so.

use crate::describe::{Segment, Split};
use crate::look::counted;
use crate::{Notice, NoticeKind};
use headland_trace::Trace;

/// Pieces shorter than this are left out unless the description says otherwise (s).
const SHORTEST_S: f64 = 10.0;

/// The stretches of a trace that are runs, with their times (s), and what to say about it.
pub(crate) fn pieces(
    trace: Trace,
    segments: &[Segment],
    split: Option<&Split>,
    run: &str,
    notices: &mut Vec<Notice>,
) -> Vec<Trace> {
    if !segments.is_empty() {
        return segments.iter().map(|segment| trace.slice(segment.from_s, segment.to_s)).collect();
    }
    let Some(split) = split else { return vec![trace] };
    let time = trace.time_s();
    let speed = trace.get("speed_m_s").or_else(|| trace.get("wheel_speed_m_s"));
    let cuts: Vec<usize> = (1..time.len())
        .filter(|index| {
            let gap = split.gap_s.is_some_and(|gap_s| time[*index] - time[index - 1] > gap_s);
            let jump = split.speed_jump_m_s.is_some_and(|jump| {
                speed.is_some_and(|speed| (speed[*index] - speed[index - 1]).abs() > jump)
            });
            gap || jump
        })
        .collect();
    let mut ends = cuts.clone();
    ends.push(time.len());
    if cuts.is_empty() {
        return vec![trace];
    }
    let (mut start, mut left_out) = (0, 0);
    let mut found = Vec::new();
    for end in ends {
        let piece = trace.slice(time[start], time[end - 1]);
        if piece.duration_s() >= split.shortest_s.unwrap_or(SHORTEST_S) {
            found.push(piece);
        } else {
            left_out += 1;
        }
        start = end;
    }
    if !cuts.is_empty() {
        let mut text =
            format!("the log is cut at {}, the first at {} s", counted(cuts.len(), "place"), time[cuts[0]]);
        if left_out > 0 {
            let shortest = split.shortest_s.unwrap_or(SHORTEST_S);
            text = format!("{text}; {} shorter than {shortest} s left out", counted(left_out, "piece"));
        }
        notices.push(Notice::new(run, NoticeKind::Split, text).count(cuts.len()).first(time[cuts[0]]));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    fn drive() -> Trace {
        let mut trace =
            Trace::new((0..40).map(f64::from).map(|t| if t < 30.0 { t } else { t + 20.0 }).collect())
                .unwrap();
        let speed = (0..40).map(|row| if row < 15 { 10.0 } else { 3.0 }).collect();
        trace.push("speed_m_s", speed, Origin::Measured).unwrap();
        trace
    }

    #[test]
    fn a_log_is_cut_where_speed_jumps_or_time_does() {
        let split = Split { speed_jump_m_s: Some(3.0), gap_s: Some(5.0), shortest_s: Some(0.0) };
        let mut notices = Vec::new();
        let found = pieces(drive(), &[], Some(&split), "r", &mut notices);
        assert_eq!(found.iter().map(Trace::len).collect::<Vec<_>>(), [15, 15, 10]);
        assert_eq!(
            (notices[0].kind, notices[0].count, notices[0].first_s),
            (NoticeKind::Split, 2, Some(15.0))
        );
    }

    #[test]
    fn short_pieces_are_left_out_and_told() {
        let split = Split { speed_jump_m_s: Some(3.0), gap_s: Some(5.0), shortest_s: None };
        let mut notices = Vec::new();
        assert_eq!(pieces(drive(), &[], Some(&split), "r", &mut notices).len(), 2);
        assert!(notices[0].text.contains("1 piece shorter than 10 s"), "{}", notices[0].text);
    }

    #[test]
    fn segments_hold_both_their_ends() {
        let segments = [Segment { from_s: 2.0, to_s: 4.0 }, Segment { from_s: 6.0, to_s: 6.5 }];
        let found = pieces(drive(), &segments, None, "r", &mut Vec::new());
        assert_eq!(found[0].time_s(), [2.0, 3.0, 4.0]);
        assert_eq!(found[1].time_s(), [6.0]);
    }
}
