//! What the clocks of several runs have in common.
//!
//! A tank that fills as fast in every run takes one course of time in all of them, and what some runs tell of it foretells the
//! others. Where every run drives the same speeds at the same times, though, any law of speed takes a course of time as well.

use crate::causes::sensors::interpolate;
use crate::runs::recorded::Recorded;

/// How the runs are driven by the clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cycles {
    /// Their clocks begin at different times, or there is one run alone.
    Apart,
    /// Their clocks begin alike, and each drives in its own way.
    Free,
    /// All drive as fast as each other all the time.
    Same,
}

/// How the runs that are `fit` are driven.
pub fn cycles(runs: &[Recorded], fit: &[bool]) -> Cycles {
    /// Clocks that begin alike differ by less [s].
    const ALIKE_S: f64 = 2.0;
    /// Speeds that are correlated by more are the same cycle.
    const ALIKE: f64 = 0.9;
    /// They are held against each other every so many seconds.
    const STEP_S: f64 = 1.0;
    let begin_s = |run: &Recorded| run.measured.trace.time_s().first().copied().unwrap_or(f64::NAN);
    let fitted: Vec<&Recorded> = runs.iter().zip(fit).filter(|(_, fit)| **fit).map(|(run, _)| run).collect();
    let [first, _, ..] = fitted[..] else { return Cycles::Apart };
    if !runs.iter().all(|run| (begin_s(run) - begin_s(first)).abs() < ALIKE_S) {
        return Cycles::Apart;
    }
    let shortest_s = fitted.iter().map(|run| run.measured.trace.duration_s()).fold(f64::INFINITY, f64::min);
    let speeds = |run: &&Recorded| -> Vec<f64> {
        let times = std::iter::successors(Some(0.0), |time| Some(time + STEP_S));
        let times = times.take_while(|time| *time <= shortest_s);
        times
            .map(|time| interpolate(run.measured.trace.time_s(), &run.motion.value, begin_s(run) + time))
            .collect()
    };
    let speeds: Vec<Vec<f64>> = fitted.iter().map(speeds).collect();
    let same = speeds.iter().skip(1).all(|other| correlation(&speeds[0], other) > ALIKE);
    if same { Cycles::Same } else { Cycles::Free }
}

/// Correlation of two series.
pub fn correlation(one: &[f64], other: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_one, mean_other) = (mean(one), mean(other));
    let (mut squares, mut others, mut products) = (0.0, 0.0, 0.0);
    for (one, other) in one.iter().zip(other) {
        let (one, other) = (one - mean_one, other - mean_other);
        squares += one * one;
        others += other * other;
        products += one * other;
    }
    products / (squares * others).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rises_with_the_other_is_alike_and_what_falls_is_not() {
        let one: Vec<f64> = (0..20).map(f64::from).collect();
        let doubled: Vec<f64> = one.iter().map(|value| 2.0 * value + 3.0).collect();
        let falling: Vec<f64> = one.iter().map(|value| -value).collect();
        assert!((correlation(&one, &doubled) - 1.0).abs() < 1e-12);
        assert!((correlation(&one, &falling) + 1.0).abs() < 1e-12);
    }
}
