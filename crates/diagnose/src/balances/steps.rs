//! When between two samples a force changed.
//!
//! A pedal is pressed and an implement let down within less than the second after which many a logger writes its next value. The
//! samples show the force before and after, and nothing shows when it changed: a step by ΔF somewhere within T leaves an impulse
//! open, evenly distributed within ±½ ΔF T about that of a straight line, whose variance is (ΔF T)²/12. A row that holds such a
//! step is as loud as that makes it, and a spell that is no more than that is none.
//! Source: the variance of an even distribution; Oppenheim and Schafer, *Discrete-Time Signal Processing* (2010), section 4.8, for
//! the same of quantised amplitudes.

use headland_recording::{renewed_s, spacing};
use headland_trace::Trace;

/// Time from one value of a series to the next that was measured [s]: values are held between, or lie on straight lines where
/// they were filled in.
pub fn step_s(trace: &Trace, name: &str) -> f64 {
    /// A bend by less than this share of the range is a straight line.
    const STRAIGHT: f64 = 1e-9;
    let held_s = renewed_s(trace, name);
    let values = trace.get(name).unwrap_or(&[]);
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let range = finite().fold(f64::NEG_INFINITY, f64::max) - finite().fold(f64::INFINITY, f64::min);
    let bends = |index: &usize| {
        let bend = values[index - 1] - 2.0 * values[*index] + values[index + 1];
        bend.abs() > STRAIGHT * range
    };
    let bent: Vec<usize> = (1..values.len().saturating_sub(1)).filter(bends).collect();
    spacing(&bent).map_or(held_s, |samples| held_s.max(samples as f64 * trace.period_s()))
}

/// Variance of the impulse that is not known of a series, for each second of it, sample by sample [unit² s]; nought where it is
/// not known itself.
pub fn unsure(values: &[f64], time_s: &[f64], step_s: f64) -> Vec<f64> {
    /// A step is seen by all windows that hold a part of it: T (ΔF/T)² over its length and that of the window, ⅔ ΔF² T, for
    /// the (ΔF T)²/12 of it.
    const SHARE: f64 = 1.5 / 12.0;
    let at = |when_s: f64| {
        let next = time_s.partition_point(|time| *time < when_s).clamp(1, time_s.len() - 1);
        let share = ((when_s - time_s[next - 1]) / (time_s[next] - time_s[next - 1])).clamp(0.0, 1.0);
        values[next - 1] + share * (values[next] - values[next - 1])
    };
    if time_s.len() < 2 {
        return vec![0.0; time_s.len()];
    }
    let of = |time: &f64| {
        let change = at(time + 0.5 * step_s) - at(time - 0.5 * step_s);
        if change.is_finite() { SHARE * step_s * change * change } else { 0.0 }
    };
    time_s.iter().map(of).collect()
}

/// Variance of the impulse that is not known between two times [unit² s²].
fn open_between(open: &[f64], time_s: &[f64], (from_s, to_s): (f64, f64)) -> f64 {
    let steps = open.iter().zip(time_s.windows(2)).filter(|(_, step)| (from_s..=to_s).contains(&step[0]));
    steps.map(|(open, step)| open * (step[1] - step[0])).sum()
}

/// What is open of the force of a run.
pub struct Open {
    each: Vec<f64>,
    step_s: f64,
}

impl Open {
    /// Of a force whose values come so far apart.
    pub fn of(force_n: &[f64], time_s: &[f64], step_s: f64) -> Self {
        Self { each: unsure(force_n, time_s, step_s), step_s }
    }

    /// Standard deviation of the mean force of a spell by steps of the recorded force in it or at its edges [N].
    pub fn spell_n(&self, time_s: &[f64], (from_s, to_s): (f64, f64)) -> f64 {
        let around = (from_s - self.step_s, to_s + self.step_s);
        open_between(&self.each, time_s, around).sqrt() / (to_s - from_s).max(self.step_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    /// Half a minute at 10 Hz, of which every fifth value was measured and 4 kN are let down after four seconds.
    fn filled() -> (Vec<f64>, Vec<f64>) {
        let time_s: Vec<f64> = (0..301).map(|index| 0.1 * f64::from(index)).collect();
        let wobble = |knot: f64| (7.0 * knot).sin();
        let force = |time: f64| {
            let knot = (time / 0.5 + 1e-9).floor();
            let value = |knot: f64| if knot > 8.0 { 4000.0 } else { 0.0 } + wobble(knot);
            let share = time / 0.5 - knot;
            value(knot) + share * (value(knot + 1.0) - value(knot))
        };
        let values = time_s.iter().map(|time| force(*time)).collect();
        (time_s, values)
    }

    #[test]
    fn values_that_were_filled_in_are_no_measurements() {
        let (time_s, values) = filled();
        let mut trace = Trace::new(time_s).unwrap();
        trace.push("tractive_force_n", values, Origin::Measured).unwrap();
        assert!((step_s(&trace, "tractive_force_n") - 0.5).abs() < 1e-9);
    }

    #[test]
    fn a_step_leaves_a_twelfth_of_its_square_open() {
        let (time_s, values) = filled();
        let open = open_between(&unsure(&values, &time_s, 0.5), &time_s, (0.0, 30.0));
        let expected = (4000.0_f64 * 0.5).powi(2) / 12.0;
        assert!((open / expected - 1.0).abs() < 0.05, "{open} against {expected}");
    }

    #[test]
    fn a_force_that_stays_leaves_nothing_open() {
        let time_s: Vec<f64> = (0..20).map(f64::from).collect();
        assert!(unsure(&[300.0; 20], &time_s, 1.0).iter().all(|one| *one == 0.0));
        assert!(unsure(&[f64::NAN; 20], &time_s, 1.0).iter().all(|one| *one == 0.0));
    }
}
