//! Fewer samples that look the same.

/// The most time points that are kept of a channel.
pub(crate) const MOST: usize = 2000;

/// Samples as Rerun takes them: a row without a value ends the line before it.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Thinned {
    /// Time of each row [s].
    pub times_s: Vec<f64>,
    /// How many values a row has: 1, or 0 where a gap begins.
    pub lengths: Vec<usize>,
    /// The values.
    pub values: Vec<f64>,
}

impl Thinned {
    fn keep(&mut self, time_s: f64, value: f64) {
        self.times_s.push(time_s);
        self.lengths.push(1);
        self.values.push(value);
    }

    fn end_line(&mut self, time_s: f64) {
        if self.lengths.last() == Some(&1) {
            self.times_s.push(time_s);
            self.lengths.push(0);
        }
    }
}

/// At most `most` rows: of each stretch of samples its lowest and its highest, so that no peak is lost.
///
/// Values that are no numbers are left out, and the line is broken there.
pub(crate) fn thin(times_s: &[f64], values: &[f64], most: usize) -> Thinned {
    let mut thinned = Thinned::default();
    let stretch = if values.len() <= most { 1 } else { values.len().div_ceil((most / 2).max(1)) };
    for (times_s, values) in times_s.chunks(stretch).zip(values.chunks(stretch)) {
        let numbers = || values.iter().enumerate().filter(|(_, value)| value.is_finite());
        let low = numbers().min_by(|one, other| one.1.total_cmp(other.1)).map(|(index, _)| index);
        let high = numbers().max_by(|one, other| one.1.total_cmp(other.1)).map(|(index, _)| index);
        if let (Some(low), Some(high)) = (low, high) {
            thinned.keep(times_s[low.min(high)], values[low.min(high)]);
            if low != high {
                thinned.keep(times_s[low.max(high)], values[low.max(high)]);
            }
        } else {
            thinned.end_line(times_s[0]);
        }
    }
    thinned
}

/// At most `most` of `count` indices, evenly spread, both ends among them.
pub(crate) fn spread(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|index| index * (count - 1) / (most - 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_channel_stays_whole_but_for_what_is_no_number() {
        let thinned = thin(&[0.0, 1.0, 2.0, 3.0, 4.0], &[f64::NAN, 5.0, f64::NAN, f64::INFINITY, 7.0], 10);
        let expected =
            Thinned { times_s: vec![1.0, 2.0, 4.0], lengths: vec![1, 0, 1], values: vec![5.0, 7.0] };
        assert_eq!(thinned, expected);
    }

    #[test]
    fn one_spike_among_a_million_is_kept() {
        let times: Vec<f64> = (0..1_000_000).map(f64::from).collect();
        let mut values = vec![1.0; times.len()];
        values[777_777] = 9.0;
        values[123_456] = -9.0;
        let thinned = thin(&times, &values, MOST);
        assert!(thinned.times_s.len() <= MOST, "{}", thinned.times_s.len());
        assert!(thinned.values.contains(&9.0) && thinned.values.contains(&-9.0));
        assert!(thinned.times_s.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn indices_hold_both_ends() {
        assert_eq!(spread(3, 10), [0, 1, 2]);
        assert_eq!(spread(101, 5), [0, 25, 50, 75, 100]);
    }
}
