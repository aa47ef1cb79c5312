//! The model brought to the time base of the recording.

use crate::direction::{full_turn, nearest, unwrapped};
use headland_trace::{Channel, Trace};

/// Pairs of one channel that have both values, at times of the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Aligned {
    /// Time of each pair (s).
    pub time_s: Vec<f64>,
    /// What was measured, in the unit of the channel; a direction without its jumps.
    pub measured: Vec<f64>,
    /// What the model says, linear between its samples; a direction within half a turn of the measured one.
    pub modelled: Vec<f64>,
    /// Samples of the recording that are no pair.
    pub dropped: Dropped,
}

/// Samples of a recording that have no counterpart; each is counted once, under the first that applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Dropped {
    /// Before the first or after the last sample of the model.
    pub outside: usize,
    /// Not measured.
    pub not_measured: usize,
    /// Not computed: the model has no value there, or none on one side.
    pub not_modelled: usize,
}

impl Dropped {
    /// All of them.
    pub fn total(self) -> usize {
        self.outside + self.not_measured + self.not_modelled
    }
}

impl Aligned {
    /// Modelled minus measured, in the unit of the channel.
    pub fn errors(&self) -> Vec<f64> {
        self.modelled.iter().zip(&self.measured).map(|(modelled, measured)| modelled - measured).collect()
    }
}

/// Pairs a channel of two traces at the times of the measured one, the model linear between its samples and nothing
/// outside them. `None` where either trace lacks the channel.
pub fn align(measured: &Trace, modelled: &Trace, channel: &str) -> Option<Aligned> {
    Some(align_channels(
        (measured.time_s(), measured.channel(channel)?),
        (modelled.time_s(), modelled.channel(channel)?),
    ))
}

/// As [`align`], of two channels with their time bases.
pub(crate) fn align_channels(measured: (&[f64], &Channel), modelled: (&[f64], &Channel)) -> Aligned {
    let turn = full_turn(&measured.1.name);
    let (base, values) = modelled;
    let straight = turn.map_or_else(|| values.values.clone(), |turn| unwrapped(&values.values, turn));
    let mut aligned = Aligned {
        time_s: Vec::with_capacity(measured.0.len()),
        measured: Vec::new(),
        modelled: Vec::new(),
        dropped: Dropped::default(),
    };
    for (time, y) in measured.0.iter().zip(&measured.1.values) {
        let Some(m) = interpolated(base, &straight, *time) else {
            aligned.dropped.outside += 1;
            continue;
        };
        if !y.is_finite() {
            aligned.dropped.not_measured += 1;
        } else if m.is_finite() {
            aligned.time_s.push(*time);
            aligned.measured.push(*y);
            aligned.modelled.push(m);
        } else {
            aligned.dropped.not_modelled += 1;
        }
    }
    if let Some(turn) = turn {
        aligned.measured = unwrapped(&aligned.measured, turn);
        for (m, y) in aligned.modelled.iter_mut().zip(&aligned.measured) {
            *m = nearest(*m, *y, turn);
        }
    }
    aligned
}

/// Linear between the samples of an increasing base; `None` outside it, NaN beside a NaN.
pub(crate) fn interpolated(base: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let right = base.partition_point(|point| *point < at);
    if *base.get(right)? == at {
        return Some(values[right]);
    }
    let left = right.checked_sub(1)?;
    let share = (at - base[left]) / (base[right] - base[left]);
    Some(values[left] + share * (values[right] - values[left]))
}

/// Both signals on `count` evenly spaced times from the first pair to the last, linear between pairs, and the step (s).
///
/// For the metrics that need even sampling. A gap between pairs is bridged by a straight line in both signals alike.
/// `None` of fewer than two pairs or fewer than two times.
pub(crate) fn evenly(aligned: &Aligned, count: usize) -> Option<(Vec<f64>, Vec<f64>, f64)> {
    let (first, last) = (*aligned.time_s.first()?, *aligned.time_s.last()?);
    if count < 2 || aligned.time_s.len() < 2 {
        return None;
    }
    let step = (last - first) / (count - 1) as f64;
    let times = (0..count).map(|index| (first + step * index as f64).min(last));
    let (mut measured, mut modelled) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for time in times {
        measured.push(interpolated(&aligned.time_s, &aligned.measured, time)?);
        modelled.push(interpolated(&aligned.time_s, &aligned.modelled, time)?);
    }
    Some((measured, modelled, step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;
    use std::f64::consts::PI;

    fn trace(time_s: &[f64], name: &str, values: &[f64]) -> Trace {
        let mut trace = Trace::new(time_s.to_vec()).unwrap();
        trace.push(name, values.to_vec(), Origin::Predicted).unwrap();
        trace
    }

    /// The model knows 0 s to 2 s and is lost around 1.5 s; the recording has -1 s to 3 s and misses 0.5 s.
    #[test]
    fn what_has_no_counterpart_is_dropped_and_counted() {
        let nan = f64::NAN;
        let measured =
            trace(&[-1.0, 0.0, 0.25, 0.5, 1.25, 2.0, 3.0], "speed_m_s", &[9., 1., 2., nan, 3., 4., 9.]);
        let modelled = trace(&[0.0, 1.0, 1.5, 2.0], "speed_m_s", &[0.0, 4.0, nan, 8.0]);
        let aligned = align(&measured, &modelled, "speed_m_s").unwrap();
        assert_eq!(aligned.time_s, [0.0, 0.25, 2.0]);
        assert_eq!(aligned.measured, [1.0, 2.0, 4.0]);
        assert_eq!(aligned.modelled, [0.0, 1.0, 8.0]);
        assert_eq!(aligned.errors(), [-1.0, -1.0, 4.0]);
        assert_eq!(aligned.dropped, Dropped { outside: 2, not_measured: 1, not_modelled: 1 });
        assert_eq!(aligned.dropped.total(), 4);
        assert!(align(&measured, &modelled, "grade").is_none());
    }

    /// Measured just west of north, modelled 0.2 rad further; between 6.2 and 0.1 the model passes north, not south.
    #[test]
    fn headings_are_compared_across_north() {
        let measured = trace(&[0.0, 1.0, 2.0], "heading_rad", &[6.2, 6.25, 0.1]);
        let modelled = trace(&[0.0, 2.0], "heading_rad", &[6.2, 0.1]);
        let aligned = align(&measured, &modelled, "heading_rad").unwrap();
        let middle = f64::midpoint(6.2, 0.1 + 2.0 * PI);
        assert!((aligned.errors()[1] - (middle - 6.25)).abs() < 1e-12, "{aligned:?}");
        assert!(aligned.errors()[2].abs() < 1e-12);
        assert!((aligned.measured[2] - (0.1 + 2.0 * PI)).abs() < 1e-12);
    }

    /// 0.1 rad measured and 6.2 rad modelled are 0.183185 apart, on the other side of north.
    #[test]
    fn a_heading_that_starts_across_north_is_near() {
        let measured = trace(&[0.0, 1.0], "heading_rad", &[0.1, 0.2]);
        let modelled = trace(&[0.0, 1.0], "heading_rad", &[6.2, 6.25]);
        let errors = align(&measured, &modelled, "heading_rad").unwrap().errors();
        assert!((errors[0] + 0.183_185).abs() < 1e-6, "{errors:?}");
    }

    #[test]
    fn even_times_reach_from_the_first_pair_to_the_last() {
        let uneven = trace(&[0.0, 1.0, 4.0], "speed_m_s", &[0.0, 2.0, 8.0]);
        let aligned = align(&uneven, &uneven, "speed_m_s").unwrap();
        let (measured, modelled, step) = evenly(&aligned, 5).unwrap();
        assert_eq!(measured, [0.0, 2.0, 4.0, 6.0, 8.0]);
        assert_eq!((modelled, step), (measured, 1.0));
        assert!(evenly(&aligned, 1).is_none());
    }
}
