//! Means over blocks of time, and how two of them agree.

use std::ops::Range;

/// Blocks of so many seconds, as ranges of samples; those with gaps are left out.
pub fn blocks(time_s: &[f64], width_s: f64) -> Vec<Range<usize>> {
    /// Share of a block that has to be recorded.
    const RECORDED: f64 = 0.8;
    let Some(start) = time_s.first() else { return Vec::new() };
    let block = |time: f64| ((time - start) / width_s + 1e-9).floor();
    let mut all: Vec<Range<usize>> = Vec::new();
    for index in 0..time_s.len() {
        match all.last_mut() {
            Some(last) if block(time_s[last.start]) == block(time_s[index]) => last.end = index + 1,
            _ => all.push(index..index + 1),
        }
    }
    all.retain(|range| time_s[range.end - 1] - time_s[range.start] > RECORDED * width_s);
    all
}

/// Mean over a range; NaN where a sample is.
pub fn mean(values: &[f64], range: &Range<usize>) -> f64 {
    values[range.clone()].iter().sum::<f64>() / range.len() as f64
}

/// Value of a series somewhere, linear in between; NaN outside.
pub fn at(time_s: &[f64], values: &[f64], when_s: f64) -> f64 {
    /// Times are printed to this [s].
    const SLACK_S: f64 = 0.051;
    let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else { return f64::NAN };
    if when_s < first - SLACK_S || when_s > last + SLACK_S || time_s.len() < 2 {
        return f64::NAN;
    }
    let right = time_s.partition_point(|time| *time < when_s).clamp(1, time_s.len() - 1);
    let share = ((when_s - time_s[right - 1]) / (time_s[right] - time_s[right - 1])).clamp(0.0, 1.0);
    values[right - 1] + share * (values[right] - values[right - 1])
}

/// A series at other times.
pub fn onto(time_s: &[f64], values: &[f64], when_s: &[f64]) -> Vec<f64> {
    when_s.iter().map(|when| at(time_s, values, *when)).collect()
}

/// Pairs of which both are numbers, apart.
pub fn paired(pairs: impl Iterator<Item = (f64, f64)>) -> (Vec<f64>, Vec<f64>) {
    pairs.filter(|(one, other)| one.is_finite() && other.is_finite()).unzip()
}

/// Slope of the least-squares line of `y` over `x`.
pub fn slope(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let both: f64 = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    both / x.iter().map(|x| (x - mean_x).powi(2)).sum::<f64>()
}

/// Standard deviation.
pub fn spread(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt()
}

/// Median of what is a number; NaN where nothing is.
pub fn median(values: &[f64]) -> f64 {
    let mut values: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        count if count % 2 == 1 => values[count / 2],
        count => 0.5 * (values[count / 2 - 1] + values[count / 2]),
    }
}

/// A number for a table.
pub fn short(value: f64) -> String {
    match value.abs() {
        _ if !value.is_finite() => "-".to_owned(),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 1.0 => format!("{value:.2}"),
        size if size >= 0.01 || size == 0.0 => format!("{value:.3}"),
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_their_seconds_and_those_with_gaps_are_left_out() {
        let mut time_s: Vec<f64> = (0..25).map(f64::from).collect();
        assert_eq!(blocks(&time_s, 10.0), [0..10, 10..20]);
        time_s.drain(12..18);
        assert_eq!(blocks(&time_s, 10.0).len(), 2);
        time_s.drain(10..14);
        assert_eq!(blocks(&time_s, 10.0).first(), Some(&(0..10)));
        assert_eq!(blocks(&time_s, 10.0).len(), 1);
    }

    #[test]
    fn a_line_has_its_slope_and_half_way_is_half_way() {
        assert!((slope(&[0.0, 1.0, 2.0], &[1.0, 3.0, 5.0]) - 2.0).abs() < 1e-12);
        assert_eq!(at(&[0.0, 2.0], &[1.0, 5.0], 1.0), 3.0);
        assert!(at(&[0.0, 2.0], &[1.0, 5.0], 3.0).is_nan());
        assert_eq!(median(&[3.0, f64::NAN, 1.0, 2.0]), 2.0);
    }
}
