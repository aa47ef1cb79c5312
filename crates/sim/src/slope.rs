//! Value and slope of a noisy series at each of its samples, and its sum.

/// A local fit.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalFit {
    /// Smoothed value at each sample, in the unit of the series.
    pub value: Vec<f64>,
    /// Slope at each sample, in that unit per second.
    pub slope: Vec<f64>,
}

/// Distance at each sample [m], by the trapezoidal rule. Between two speeds that are known a speed that is not lies on the line
/// from one to the other; before the first and behind the last it counts nothing.
pub fn travelled(time_s: &[f64], speed_m_s: &[f64]) -> Vec<f64> {
    let mut positions = vec![0.0; time_s.len().max(1)];
    let mut position = 0.0;
    let mut last: Option<usize> = None;
    let known = time_s.len().min(speed_m_s.len());
    for index in (0..known).filter(|index| speed_m_s[*index].is_finite()) {
        if let Some(last) = last {
            let gap_s = time_s[index] - time_s[last];
            let slope_m_s2 = (speed_m_s[index] - speed_m_s[last]) / gap_s;
            for between in last + 1..index {
                let passed_s = time_s[between] - time_s[last];
                positions[between] = position + passed_s * (speed_m_s[last] + 0.5 * slope_m_s2 * passed_s);
            }
            position += 0.5 * (speed_m_s[last] + speed_m_s[index]) * gap_s;
            positions[index] = position;
        }
        last = Some(index);
    }
    if let Some(last) = last {
        positions[last..].fill(position);
    }
    positions
}

/// Where a run begins whose recorded places [m] fall along it, as a chainage does on the way back; none where they grow. The first and
/// the last that are known decide: a log may have a place in one row of several.
pub fn chainage_from_m(position_m: &[f64]) -> Option<f64> {
    let mut known = position_m.iter().copied().filter(|place| place.is_finite());
    let first = known.next()?;
    known.next_back().filter(|last| *last < first).map(|_| first)
}

/// Fits a parabola to the samples within `half_width_s` of each sample, by least squares.
///
/// The base may be uneven. With fewer than four samples in reach a straight line is fitted; a lone one has no slope,
/// and where there is none, or the series ended before, value and slope are NaN.
/// Source: Savitzky and Golay, *Analytical Chemistry* 36 (1964) 1627, here for an uneven base.
pub fn local_fit(time_s: &[f64], values: &[f64], half_width_s: f64) -> LocalFit {
    let mut fit =
        LocalFit { value: Vec::with_capacity(values.len()), slope: Vec::with_capacity(values.len()) };
    let (mut first, mut end) = (0, 0);
    for (index, &at) in time_s.iter().enumerate() {
        while time_s[first] < at - half_width_s && first < index {
            first += 1;
        }
        while end < time_s.len() && time_s[end] <= at + half_width_s {
            end += 1;
        }
        let low = first.min(index.saturating_sub(1));
        let high = end.max((index + 2).min(time_s.len()));
        let known = low.min(values.len())..high.min(values.len());
        let (value, slope) = parabola(&time_s[low..high], &values[known], at);
        fit.value.push(value);
        fit.slope.push(slope);
    }
    fit
}

/// Value and slope at `at` of the parabola (or line) of least squares.
fn parabola(time_s: &[f64], values: &[f64], at: f64) -> (f64, f64) {
    let mut moments = [0.0; 5];
    let mut sums = [0.0; 3];
    for (time, value) in time_s.iter().zip(values).filter(|(_, value)| value.is_finite()) {
        let t = time - at;
        let mut power = 1.0;
        for (index, moment) in moments.iter_mut().enumerate() {
            *moment += power;
            if index < 3 {
                sums[index] += power * value;
            }
            power *= t;
        }
    }
    let [s0, s1, s2, s3, s4] = moments;
    let [y0, y1, y2] = sums;
    if s0 >= 4.0 {
        let determinant = s0 * (s2 * s4 - s3 * s3) - s1 * (s1 * s4 - s2 * s3) + s2 * (s1 * s3 - s2 * s2);
        if determinant.abs() > 1e-12 * s0 * s2 * s4 {
            let value = (y0 * (s2 * s4 - s3 * s3) - s1 * (y1 * s4 - y2 * s3) + s2 * (y1 * s3 - y2 * s2))
                / determinant;
            let slope = (s0 * (y1 * s4 - y2 * s3) - y0 * (s1 * s4 - s2 * s3) + s2 * (s1 * y2 - s2 * y1))
                / determinant;
            return (value, slope);
        }
    }
    let determinant = s0 * s2 - s1 * s1;
    if determinant > 0.0 {
        ((y0 * s2 - y1 * s1) / determinant, (s0 * y1 - s1 * y0) / determinant)
    } else {
        (y0 / s0, f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chainage_falls_whatever_row_ends_the_log() {
        const NONE: f64 = f64::NAN;
        assert_eq!(chainage_from_m(&[NONE, 900.0, NONE, 400.0, NONE]), Some(900.0));
        assert_eq!(chainage_from_m(&[0.0, NONE, 400.0, NONE]), None);
        assert_eq!(chainage_from_m(&[NONE, 3.0]), None);
    }

    #[test]
    fn a_parabola_on_an_uneven_base_is_met_exactly() {
        let time: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.1 + 0.02 * f64::from(i % 3)).collect();
        let values: Vec<f64> = time.iter().map(|t| 3.0 - 2.0 * t + 0.5 * t * t).collect();
        let fit = local_fit(&time, &values, 0.45);
        for (index, t) in time.iter().enumerate() {
            assert!((fit.slope[index] - (t - 2.0)).abs() < 1e-8, "{t}");
            assert!((fit.value[index] - values[index]).abs() < 1e-8);
        }
    }

    #[test]
    fn where_the_series_ended_before_or_is_unknown_nothing_is_known() {
        let fit = local_fit(&[0.0, 1.0, 2.0, 3.0], &[1.0, 3.0], 0.1);
        assert_eq!(fit.slope[..1], [2.0]);
        assert!(fit.value[3].is_nan() && fit.slope[3].is_nan());
        assert!(local_fit(&[0.0, 1.0], &[], 5.0).value.iter().all(|value| value.is_nan()));
        assert!(local_fit(&[0.0, 1.0], &[f64::NAN; 2], 5.0).slope.iter().all(|slope| slope.is_nan()));
    }

    /// From 4 to 2 m/s in 2 s are 6 m, whether the speed between was recorded or not.
    #[test]
    fn a_gap_of_the_speed_is_crossed_at_what_lies_between() {
        let time_s = [0.0, 1.0, 2.0, 3.0, 4.0];
        assert_eq!(travelled(&time_s, &[4.0, 3.0, 2.0, 2.0, 2.0]), [0.0, 3.5, 6.0, 8.0, 10.0]);
        assert_eq!(travelled(&time_s, &[4.0, f64::NAN, 2.0, 2.0, f64::NAN]), [0.0, 3.5, 6.0, 8.0, 8.0]);
        assert_eq!(travelled(&time_s, &[f64::NAN, 3.0, 2.0, f64::NAN, 2.0]), [0.0, 0.0, 2.5, 4.5, 6.5]);
        assert_eq!(travelled(&time_s, &[f64::NAN; 5]), [0.0; 5]);
    }

    #[test]
    fn two_samples_give_a_line() {
        let fit = local_fit(&[0.0, 1.0], &[1.0, 3.0], 0.1);
        assert_eq!(fit.slope, [2.0, 2.0]);
    }
}
