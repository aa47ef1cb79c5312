//! Holes in a time base.

use super::{counted, median, short};
use crate::{Notice, NoticeKind};
use headland_trace::Trace;

/// A step longer than so many median steps is a gap.
const GAP: f64 = 3.0;

/// Tells steps of time that are longer than three times the median.
pub(super) fn gaps(trace: &Trace, run: &str, notices: &mut Vec<Notice>) {
    let time = trace.time_s();
    let usual = median(time.windows(2).map(|pair| pair[1] - pair[0]).collect());
    let gaps: Vec<(f64, f64)> = time
        .windows(2)
        .filter(|pair| pair[1] - pair[0] > GAP * usual)
        .map(|pair| (pair[0], pair[1] - pair[0]))
        .collect();
    let Some(first) = gaps.first() else { return };
    let longest = gaps.iter().fold(*first, |best, gap| if gap.1 > best.1 { *gap } else { best });
    let total: f64 = gaps.iter().map(|gap| gap.1).sum();
    let text = format!(
        "{} in time, {} s in all; the longest, {} s, starts at {} s (rows are {} s apart)",
        counted(gaps.len(), "gap"),
        short(total),
        short(longest.1),
        short(longest.0),
        short(usual)
    );
    notices.push(Notice::new(run, NoticeKind::Gap, text).count(gaps.len()).first(first.0));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_counted_and_the_longest_is_named() {
        let trace = Trace::new(vec![0.0, 1.0, 2.0, 3.0, 10.0, 11.0, 12.0, 20.5, 21.5]).unwrap();
        let mut notices = Vec::new();
        gaps(&trace, "r", &mut notices);
        assert_eq!((notices[0].count, notices[0].first_s), (2, Some(3.0)));
        assert!(notices[0].text.contains("8.5 s, starts at 12 s"), "{}", notices[0].text);
    }

    #[test]
    fn an_uneven_base_without_holes_is_not_told() {
        let trace = Trace::new(vec![0.0, 1.0, 2.5, 3.0, 4.9, 6.0]).unwrap();
        let mut notices = Vec::new();
        gaps(&trace, "r", &mut notices);
        assert!(notices.is_empty());
    }
}
