//! Fewer points that look the same: the least and the greatest of each bucket, so that no peak is lost.

/// Buckets along the horizontal axis: one for each pixel of a wide plot.
pub(crate) const BUCKETS: usize = 1000;

/// Samples to draw of columns over `x`, ascending: for each of `buckets` equal parts of the range of `x`, where each
/// column is least and greatest, and where one of them first has a gap. All samples, if they are at most four a bucket.
///
/// Where `x` does not increase, the buckets are equal in number of samples.
pub(crate) fn extremes(x: &[f64], columns: &[&[f64]], buckets: usize) -> Vec<usize> {
    let samples = x.len();
    if samples <= 4 * buckets {
        return (0..samples).collect();
    }
    let (first, last) = (x[0], x[samples - 1]);
    let increasing = last > first && x.windows(2).all(|pair| pair[1] >= pair[0]);
    let bucket = |index: usize| -> usize {
        let share =
            if increasing { (x[index] - first) / (last - first) } else { index as f64 / samples as f64 };
        floor(share * buckets as f64).min(buckets - 1)
    };
    let mut kept = vec![0];
    let mut start = 0;
    while start < samples {
        let own = bucket(start);
        let end = (start + 1..samples).find(|index| bucket(*index) != own).unwrap_or(samples);
        for column in columns {
            let (mut least, mut greatest, mut gap) = (None::<usize>, None::<usize>, None);
            for index in start..end {
                let value = column[index];
                if !value.is_finite() {
                    gap.get_or_insert(index);
                    continue;
                }
                if least.is_none_or(|at| value < column[at]) {
                    least = Some(index);
                }
                if greatest.is_none_or(|at| value > column[at]) {
                    greatest = Some(index);
                }
            }
            kept.extend([least, greatest, gap].into_iter().flatten());
        }
        start = end;
    }
    kept.push(samples - 1);
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// Points to draw of a cloud: the first in each cell of a `columns` by `rows` grid over its range, and the outermost of
/// each column of the grid. Points without a place are left out.
pub(crate) fn cloud(x: &[f64], y: &[f64], columns: usize, rows: usize) -> Vec<usize> {
    let placed: Vec<usize> = (0..x.len()).filter(|at| x[*at].is_finite() && y[*at].is_finite()).collect();
    if placed.len() <= columns * rows {
        return placed;
    }
    let cell = |values: &[f64], cells: usize| -> Vec<usize> {
        let (low, high) = placed
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), at| (l.min(values[*at]), h.max(values[*at])));
        let width = if high > low { high - low } else { 1.0 };
        values.iter().map(|value| floor((value - low) / width * cells as f64).min(cells - 1)).collect()
    };
    let (across, up) = (cell(x, columns), cell(y, rows));
    let mut taken = vec![false; columns * rows];
    let mut outer: Vec<Option<(usize, usize)>> = vec![None; columns];
    let mut kept = Vec::new();
    for at in placed {
        if !std::mem::replace(&mut taken[across[at] * rows + up[at]], true) {
            kept.push(at);
        }
        let (low, high) = outer[across[at]].get_or_insert((at, at));
        if y[at] < y[*low] {
            *low = at;
        }
        if y[at] > y[*high] {
            *high = at;
        }
    }
    kept.extend(outer.into_iter().flatten().flat_map(|(low, high)| [low, high]));
    kept.sort_unstable();
    kept.dedup();
    kept
}

/// The whole part of a number that is at least 0; 0 for NaN.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a cell number: small and not negative"
)]
fn floor(value: f64) -> usize {
    value.max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_spike_among_a_hundred_thousand_samples_stays() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y: Vec<f64> = x.iter().map(|x| (x * 1e-3).sin()).collect();
        y[41_234] = 9.0;
        y[77_777] = -9.0;
        let kept = extremes(&x, &[&y], 500);
        assert!(kept.contains(&41_234) && kept.contains(&77_777));
        assert!(kept.contains(&0) && kept.contains(&99_999));
        assert!(kept.len() <= 2 * 500 + 2, "{}", kept.len());
        assert!(kept.windows(2).all(|pair| pair[1] > pair[0]));
    }

    #[test]
    fn a_gap_stays_a_gap() {
        let x: Vec<f64> = (0..10_000).map(f64::from).collect();
        let mut y = vec![1.0; 10_000];
        y[5_003..5_006].fill(f64::NAN);
        assert!(extremes(&x, &[&y], 100).contains(&5_003));
    }

    #[test]
    fn buckets_follow_an_uneven_time_base() {
        let mut x: Vec<f64> = (0..9_000).map(|at| f64::from(at) * 1e-3).collect();
        x.extend((0..1_000).map(|at| 10.0 + f64::from(at)));
        let y: Vec<f64> = (0..10_000).map(|at| f64::from(at % 7)).collect();
        let kept = extremes(&x, &[&y], 100);
        let late = kept.iter().filter(|at| x[**at] >= 10.0).count();
        assert!(late > 150, "the sparse 99 % of the time keep their share of points: {late}");
    }

    #[test]
    fn short_series_are_left_alone() {
        assert_eq!(extremes(&[1.0, 2.0], &[&[f64::NAN, 2.0]], 1000), [0, 1]);
        assert!(extremes(&[], &[&[]], 1000).is_empty());
    }

    #[test]
    fn a_cloud_keeps_its_outline() {
        let x: Vec<f64> = (0..50_000).map(|at| (f64::from(at) * 0.618_034).fract()).collect();
        let mut y: Vec<f64> = (0..50_000).map(|at| (f64::from(at) * 0.414_214).fract()).collect();
        y[123] = 5.0;
        y[456] = f64::NAN;
        let kept = cloud(&x, &y, 50, 40);
        assert!(kept.contains(&123) && !kept.contains(&456));
        assert!(kept.len() <= 50 * 40 + 100, "{}", kept.len());
    }
}
