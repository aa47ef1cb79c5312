//! Where a mismatch sits: stretches of runs in which an effect works, and conditions under which the residual differs.

use crate::runs::recorded::Recorded;
use crate::told::report::Interval;

/// An effect counts as present where it is more than this share of its greatest size.
const PRESENT: f64 = 0.3;
/// Stretches that lie closer together than this share of a run are one.
const NEAR: f64 = 0.05;

/// The stretches of every run in which a reconstructed effect works.
pub fn stretches(drives: &[Recorded], runs: &[Vec<f64>]) -> Vec<Interval> {
    let mut sizes: Vec<f64> =
        runs.iter().flatten().map(|value| value.abs()).filter(|value| value.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    // The greatest size, but for a few samples that may be wild.
    let greatest = sizes.get(sizes.len().saturating_sub(1 + sizes.len() / 50)).copied().unwrap_or(0.0);
    let mut all = Vec::new();
    if greatest == 0.0 {
        return all;
    }
    for (drive, values) in drives.iter().zip(runs) {
        let time_s = drive.measured.trace.time_s();
        let duration_s = drive.measured.trace.duration_s();
        let mut open: Option<(usize, usize)> = None;
        let mut close = |stretch: Option<(usize, usize)>| {
            if let Some((from, to)) = stretch
                && to > from
            {
                all.push(Interval {
                    run: drive.measured.id.clone(),
                    from_s: time_s[from],
                    to_s: time_s[to],
                    from_position_m: drive.position_m[from],
                    to_position_m: drive.position_m[to],
                });
            }
        };
        for (index, value) in values.iter().enumerate() {
            if value.abs() < PRESENT * greatest {
                continue;
            }
            open = match open {
                Some((from, to)) if time_s[index] - time_s[to] <= NEAR * duration_s => Some((from, index)),
                before => {
                    close(before);
                    Some((index, index))
                }
            };
        }
        close(open);
    }
    all
}
