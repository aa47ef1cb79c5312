//! Which of two clocks runs apart: that of the speed or that of the force. Between the two a balance of motion cannot choose, so a third
//! channel has to: an accelerometer or places that go with the speed as it was recorded, a switch that says when nothing drives, or the
//! power of the engine, which goes with whichever of the two it was logged beside.

use crate::causes::sensors::interpolate;
use crate::runs::recorded::Recorded;
use crate::soundness::voltage::fast;
use headland_sim::travelled;
use headland_trace::{Channel, Origin};
use nalgebra::{Matrix2, Vector2};

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
/// accelerometer says, else by recorded places, by when the force is nought, and by the power of the engine. Without any of them the
/// speed's is named.
pub fn force_runs_apart(runs: &[Recorded], rate: f64) -> bool {
    /// Mean squares that differ by less are both of noise.
    const MORE_THAN_NOISE: f64 = 1.5;
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
    if let Some(of_speed) = speed_against_places(runs, rate) {
        return !of_speed;
    }
    let as_recorded = |run: &Recorded| run.measured.trace.get(FORCE).unwrap_or_default().to_vec();
    let in_time = |run: &Recorded| moved(run, &as_recorded(run), drifted_force);
    if let (Some(kept), Some(late)) = (while_free(runs, &as_recorded), while_free(runs, &in_time))
        && kept.max(late) > MORE_THAN_NOISE * kept.min(late)
    {
        return late < kept;
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

/// The places of a run, where they were recorded [m].
fn places(run: &Recorded) -> Option<Vec<f64>> {
    let recorded = |channel: &&Channel| channel.name == "position_m" && channel.origin == Origin::Measured;
    run.measured.trace.channels().iter().find(recorded).map(|channel| channel.values.clone())
}

/// Whether the speed of all runs runs apart from their places by rather this rate than by none; none where there are no places, or where
/// they do not tell. Those may be late as well, all of them by as much: what is left of a step D₊ − D₋ of the way is (a + r (t − t₀)) of that
/// of the speed.
fn speed_against_places(runs: &[Recorded], rate: f64) -> Option<bool> {
    /// Half a step takes so long [s].
    const HALF_S: f64 = 1.0;
    /// So many standard deviations tell one from the other.
    const CLEARLY: f64 = 2.0;
    let (mut matrix, mut vector, mut square, mut count) = (Matrix2::zeros(), Vector2::zeros(), 0.0, 0usize);
    for run in runs {
        let Some(places) = places(run) else { continue };
        let time_s = run.measured.trace.time_s();
        let speed = &run.motion.value;
        let way = travelled(time_s, speed);
        let step = |values: &[f64], when_s: f64| {
            let at = |when_s: f64| interpolate(time_s, values, when_s);
            at(when_s + HALF_S) - at(when_s - HALF_S)
        };
        let (first_s, last_s) = (time_s[0] + HALF_S, time_s[time_s.len() - 1] - HALF_S);
        for when_s in time_s.iter().copied().filter(|when_s| (first_s..last_s).contains(when_s)) {
            let left = step(&places, when_s).abs() - step(&way, when_s).abs();
            let faster = step(speed, when_s);
            let own = Vector2::new(faster, faster * (when_s - time_s[0]));
            if left.is_finite() && own.iter().all(|value| value.is_finite()) {
                matrix += own * own.transpose();
                vector += own * left;
                square += left * left;
                count += 1;
            }
        }
    }
    let inverse = matrix.try_inverse()?;
    let told = inverse * vector;
    // Steps overlap, so that so many of them are one at most.
    let lasts_s: f64 = runs.iter().map(|run| run.measured.trace.duration_s()).sum();
    let overlapping = (2.0 * HALF_S * count as f64 / lasts_s).max(1.0);
    let variance = (square - told.dot(&vector)).max(0.0) / count as f64;
    let sd = (variance * inverse[(1, 1)] * overlapping).sqrt();
    let beyond = (told[1] - 0.5 * rate) * rate.signum();
    (count > 2 && beyond.abs() > CLEARLY * sd).then_some(beyond > 0.0)
}

/// Mean square of a force while a switch says that nothing drives, in all runs that have one [N²]; none where none has.
fn while_free(runs: &[Recorded], force: Samples) -> Option<f64> {
    let (mut squares, mut count) = (0.0, 0usize);
    for run in runs {
        let Some(coasting) = run.measured.trace.get("coasting") else { continue };
        let free = force(run).into_iter().zip(coasting).filter(|(_, coasting)| **coasting >= 0.5);
        for (force_n, _) in free.filter(|(force_n, _)| force_n.is_finite()) {
            squares += force_n * force_n;
            count += 1;
        }
    }
    (count > 0).then(|| squares / count as f64)
}

/// A channel of a run.
type Samples<'a> = &'a dyn Fn(&Recorded) -> Vec<f64>;

/// Correlation of what is faster than a minute in two channels of all runs that have the first; none where none has.
fn together(runs: &[Recorded], one: &dyn Fn(&Recorded) -> Option<Vec<f64>>, other: Samples) -> Option<f64> {
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
