//! Which of two clocks runs apart: that of the speed or that of the force. Between the two a balance of motion cannot choose, so a third
//! channel has to: an accelerometer that goes with the speed as it was recorded, or the power of the engine, which goes with whichever
//! of the two it was logged beside.

use crate::causes::sensors::interpolate;
use crate::runs::recorded::Recorded;
use crate::soundness::voltage::fast;

/// The fault.
pub const DRIFT: &str = "clock_drift";
/// What drives.
pub const FORCE: &str = "tractive_force_n";

/// When a clock that runs apart by a share of the time says what happens at a sample [s].
pub fn drifted(time_s: &[f64], index: usize, rate: f64) -> f64 {
    time_s[index] + rate * (time_s[index] - time_s[0])
}

/// When the force that belongs to a sample was recorded, where it is its clock that runs apart, and the speed's would do so by `rate` [s].
pub fn drifted_force(time_s: &[f64], index: usize, rate: f64) -> f64 {
    time_s[0] + (time_s[index] - time_s[0]) / (1.0 + rate)
}

/// Whether a clock that runs apart by `rate` against the force, as a balance of motion has it, is that of the force: by what an
/// accelerometer says, and else by the power of the engine. Without either the speed's is named.
pub fn force_runs_apart(runs: &[Recorded], rate: f64) -> bool {
    if !runs.iter().all(|run| run.measured.trace.get(FORCE).is_some()) {
        return false;
    }
    let moved = |run: &Recorded, values: &[f64], when: fn(&[f64], usize, f64) -> f64| -> Vec<f64> {
        let time_s = run.measured.trace.time_s();
        (0..values.len()).map(|index| interpolate(time_s, values, when(time_s, index, rate))).collect()
    };
    let felt = |run: &Recorded| run.measured.trace.get("specific_force_m_s2").map(<[f64]>::to_vec);
    let slope = |run: &Recorded| run.motion.slope.clone();
    let late = |run: &Recorded| moved(run, &run.motion.slope, drifted);
    if let (Some(kept), Some(late)) = (together(runs, &felt, &slope), together(runs, &felt, &late)) {
        return kept > late;
    }
    let engine = |run: &Recorded| run.engine_w.clone();
    let power = |run: &Recorded, force_late: bool| -> Vec<f64> {
        let force_n = run.measured.trace.get(FORCE).unwrap_or_default();
        let speed = &run.motion.value;
        let pairs: (Vec<f64>, Vec<f64>) = if force_late {
            (moved(run, force_n, drifted_force), speed.clone())
        } else {
            (force_n.to_vec(), moved(run, speed, drifted))
        };
        pairs.0.iter().zip(&pairs.1).map(|(force_n, speed)| force_n * speed).collect()
    };
    let of_force = together(runs, &engine, &|run| power(run, true));
    let of_speed = together(runs, &engine, &|run| power(run, false));
    of_force.zip(of_speed).is_some_and(|(force, speed)| force > speed)
}

/// A channel of a run.
type Channel<'a> = &'a dyn Fn(&Recorded) -> Vec<f64>;

/// Correlation of what is faster than a minute in two channels of all runs that have the first; none where none has.
fn together(runs: &[Recorded], one: &dyn Fn(&Recorded) -> Option<Vec<f64>>, other: Channel) -> Option<f64> {
    let (mut ones, mut others, mut products) = (0.0, 0.0, 0.0);
    for run in runs {
        let Some(own) = one(run) else { continue };
        let time_s = run.measured.trace.time_s();
        for (own, other) in fast(time_s, &own).into_iter().zip(fast(time_s, &other(run))) {
            if own.is_finite() && other.is_finite() {
                ones += own * own;
                others += other * other;
                products += own * other;
            }
        }
    }
    (ones > 0.0 && others > 0.0).then(|| products / (ones * others).sqrt())
}
