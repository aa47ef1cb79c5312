//! The scale of a speed, by the way that was measured beside it: where a run was says how far it came, and the integral of its
//! speed says so too.
//!
//! Runs are cut into pieces. In each the way w is a parabola of the driven distance d = ∫ v dt, of one coordinate or of two,
//! so that a bend is no shorter way: ln |dw/dd| = −k + τ a/v − b/v, where k is the scale of the speed, τ how late it comes and
//! b its offset. A speed that comes late is too fast wherever the vehicle slows down, which is no scale.

use headland_calibrate::laid::{first_place, places};
use headland_calibrate::statistics::median;
use headland_recording::RecordedRun;
use headland_trace::Trace;
use nalgebra::{Matrix3, Vector3};

/// What the way says of the scale of the speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Measured speed over true speed, less one.
    pub value: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// Half a per cent is what good sensors are off by, and a slope of 10 % makes as much in a way on the map: a scale that is
/// wrong is wrong by twice that, and one that is right is within it with its interval.
const WRONG: f64 = 0.01;
/// No sensor is wrong by more: speed and place are then of different vehicles, or of other units.
const MOST: f64 = 0.25;
/// So many standard deviations: other runs may differ by what none of these shows.
const CLEARLY: f64 = 5.0;
/// Runs differ from each other by less than this share of a scale that is wrong.
const ALIKE: f64 = 0.3;

/// Length of a piece [m]; a grid of a metre, as of five digits of a degree, is a hundredth of it. Short runs have shorter ones.
const PIECES_M: [f64; 2] = [50.0, 20.0];
/// Fewer places make no parabola that is better than its ends.
const PLACES: usize = 8;
/// Fewer pieces in all tell nothing.
const FEWEST: usize = 8;
/// Below this an offset of a sensor is a scale [m/s].
const SLOWEST_M_S: f64 = 1.0;
/// Samples further apart do not tell what the speed was between them [s].
const GAP_S: f64 = 1.5;
/// A piece that bends by more than this is no parabola [rad].
const BEND_RAD: f64 = 0.8;
/// How late a speed usually is against a place [s], and how far off where the vehicle stands [m/s].
const LATE_S: f64 = 0.3;
const OFFSET_M_S: f64 = 0.02;
/// A standard deviation over a median deviation, of normal noise.
const NORMAL: f64 = 1.4826;

impl Scale {
    /// Whether the speed is wrong by more than a good sensor is.
    pub fn is_wrong(&self) -> bool {
        let size = self.value.abs();
        size > WRONG.max(CLEARLY * self.sd) && size < MOST
    }

    /// Whether it is right, as far as anybody would mind.
    pub fn is_right(&self) -> bool {
        self.value.abs() + 2.0 * self.sd < WRONG
    }
}

/// A piece of a run.
struct Piece {
    run: usize,
    /// ln of driven distance over way.
    ratio: f64,
    /// What a speed that comes a second late, and one that is a metre per second too fast, add to it.
    late: f64,
    offset: f64,
    /// What the noise of the speed alone adds to it.
    noise: f64,
}

/// The scale of `speed_m_s`, where places tell it that were measured by themselves.
pub fn scale(runs: &[RecordedRun]) -> Option<Scale> {
    let of_length = |piece_m: f64| -> Vec<Piece> {
        let runs = runs.iter().enumerate();
        runs.flat_map(|(run, recorded)| pieces(run, &recorded.trace, piece_m)).collect()
    };
    let pieces = PIECES_M.into_iter().map(of_length).find(|pieces| pieces.len() >= FEWEST)?;
    let (first, sd) = fitted(&pieces)?;
    // A place that was made of the speed follows it more closely than its noise lets any other one.
    let noise = median(&pieces.iter().map(|piece| piece.noise).collect::<Vec<_>>());
    if sd < ALIKE * noise {
        return None;
    }
    let (mean, covariance) = first;
    let apart = apart(&pieces, &mean);
    let scale = Scale { value: mean[0].exp_m1(), sd: (covariance[(0, 0)] + apart.powi(2)).sqrt() };
    let runs = f64::from(u32::try_from(runs_of(&pieces).len()).unwrap_or(u32::MAX));
    let alike = apart * runs.sqrt() < ALIKE * scale.value.abs().max(WRONG);
    alike.then_some(scale)
}

fn runs_of(pieces: &[Piece]) -> Vec<usize> {
    let mut runs: Vec<usize> = pieces.iter().map(|piece| piece.run).collect();
    runs.dedup();
    runs
}

/// Scale, latency and offset with their covariance, and the standard deviation of a piece, of which those that stray count
/// little (Student's t of four degrees of freedom).
#[allow(clippy::type_complexity, reason = "a mean with its covariance, and what it was weighted by")]
fn fitted(pieces: &[Piece]) -> Option<((Vector3<f64>, Matrix3<f64>), f64)> {
    /// Rounds in which weights settle.
    const ROUNDS: usize = 12;
    const FREEDOM: f64 = 4.0;
    /// Before anything was measured a scale may have any value.
    const ANY: f64 = 1.0;
    let row = |piece: &Piece| Vector3::new(1.0, piece.late, piece.offset);
    let prior = Matrix3::from_diagonal(&Vector3::new(ANY, LATE_S, OFFSET_M_S).map(|sd| sd.powi(-2)));
    let middle = median(&pieces.iter().map(|piece| piece.ratio).collect::<Vec<_>>());
    let mut mean = Vector3::new(middle, 0.0, 0.0);
    let (mut covariance, mut sd) = (Matrix3::zeros(), 0.0);
    for _ in 0..ROUNDS {
        let left: Vec<f64> = pieces.iter().map(|piece| piece.ratio - row(piece).dot(&mean)).collect();
        let sizes: Vec<f64> = left.iter().map(|left| left.abs()).collect();
        // Numbers are written with so many digits.
        sd = (NORMAL * median(&sizes)).max(1e-7);
        let (mut products, mut right) = (prior, Vector3::zeros());
        for (piece, left) in pieces.iter().zip(&left) {
            let weight = (FREEDOM + 1.0) / (FREEDOM + (left / sd).powi(2)) / sd.powi(2);
            products += row(piece) * row(piece).transpose() * weight;
            right += row(piece) * (weight * piece.ratio);
        }
        covariance = products.try_inverse()?;
        mean = covariance * right;
    }
    Some(((mean, covariance), sd))
}

/// Standard error of the mean over runs, by how they differ from each other; nought where there is one.
fn apart(pieces: &[Piece], mean: &Vector3<f64>) -> f64 {
    let left = |piece: &Piece| piece.ratio - Vector3::new(1.0, piece.late, piece.offset).dot(mean);
    let of_run =
        |run: &usize| median(&pieces.iter().filter(|piece| piece.run == *run).map(left).collect::<Vec<_>>());
    let middles: Vec<f64> = runs_of(pieces).iter().map(of_run).collect();
    if middles.len() < 2 {
        return 0.0;
    }
    let middle = median(&middles);
    let sizes: Vec<f64> = middles.iter().map(|one| (one - middle).abs()).collect();
    NORMAL * median(&sizes) / (middles.len() as f64).sqrt()
}

/// Coordinates of the way [m]: one along a path, or east and north. An odometer that turns with wheels that are recorded is of
/// these, and says nothing of the speed over ground.
fn coordinates(trace: &Trace) -> Option<Vec<Vec<f64>>> {
    if let Some(position) = trace.get("position_m").filter(|_| trace.get("wheel_speed_m_s").is_none()) {
        return Some(vec![position.to_vec()]);
    }
    let (east, north) = places(trace, first_place(trace))?;
    Some(vec![east, north])
}

/// The pieces of a run, each of this length; none where it does not know where it was.
fn pieces(run: usize, trace: &Trace, piece_m: f64) -> Vec<Piece> {
    let (Some(speed), Some(way)) = (trace.get("speed_m_s"), coordinates(trace)) else { return Vec::new() };
    let time_s = trace.time_s();
    let noise = noise(speed);
    let mut all = Vec::new();
    let mut from = 0;
    let mut driven = vec![0.0];
    for index in 1..speed.len() {
        let mean = 0.5 * (speed[index] + speed[index - 1]);
        let passed_s = time_s[index] - time_s[index - 1];
        // What is not finite is not faster either.
        let drives = speed[index].min(speed[index - 1]) > SLOWEST_M_S && mean.is_finite();
        if !drives || passed_s > GAP_S {
            (from, driven) = (index, vec![0.0]);
            continue;
        }
        let far = driven[driven.len() - 1] + mean * passed_s;
        driven.push(far);
        if far >= piece_m {
            let span = from..=index;
            let way: Vec<&[f64]> = way.iter().map(|one| &one[span.clone()]).collect();
            all.extend(piece(run, &time_s[span.clone()], &speed[span], &driven, &way, noise));
            (from, driven) = (index, vec![0.0]);
        }
    }
    all
}

fn piece(
    run: usize,
    time_s: &[f64],
    speed: &[f64],
    driven: &[f64],
    way: &[&[f64]],
    noise: f64,
) -> Option<Piece> {
    let last = driven.len() - 1;
    let (half_m, lasts_s) = (0.5 * driven[last], time_s[last] - time_s[0]);
    let over: Vec<f64> = driven.iter().map(|driven| driven / half_m - 1.0).collect();
    let parts = way.iter().map(|way| parabola(&over, way)).collect::<Option<Vec<_>>>()?;
    let (slope, bend) =
        parts.iter().fold((0.0, 0.0), |(slope, bend), one| (one[1].hypot(slope), one[2].hypot(bend)));
    // Along an arc the slope of least squares is short by (h/R)²/10, with h half its length. On one coordinate nothing bends.
    let turned = if way.len() > 1 { 2.0 * bend / slope } else { 0.0 };
    let ratio = (half_m / (slope * (1.0 + turned.powi(2) / 10.0))).ln();
    let mean_m_s = driven[last] / lasts_s;
    let quickens = parabola(&over, speed)?[1] * 2.0 / lasts_s;
    // A walk of white noise, as the slope of least squares meets it: (6/5) σ² Δt / T.
    let walk = (1.2 / last as f64).sqrt() * noise / mean_m_s;
    let able = turned < BEND_RAD && ratio.is_finite();
    able.then_some(Piece { run, ratio, late: -quickens / mean_m_s, offset: 1.0 / mean_m_s, noise: walk })
}

/// Parabola of least squares through the values that are known, over −1 to 1.
fn parabola(over: &[f64], values: &[f64]) -> Option<Vector3<f64>> {
    let (mut products, mut right, mut count) = (Matrix3::zeros(), Vector3::zeros(), 0);
    // Where it begins is of no matter, and large numbers would take the digits.
    let first = values.iter().copied().find(|value| value.is_finite())?;
    for (over, value) in over.iter().zip(values).filter(|(_, value)| value.is_finite()) {
        let row = Vector3::new(1.0, *over, over * over);
        products += row * row.transpose();
        right += row * (value - first);
        count += 1;
    }
    if count < PLACES {
        return None;
    }
    Some(products.try_inverse()? * right)
}

/// Standard deviation of a channel's noise, by how it bends from sample to sample.
fn noise(values: &[f64]) -> f64 {
    let bends = values.windows(3).map(|three| (three[2] - 2.0 * three[1] + three[0]).abs());
    let bends: Vec<f64> = bends.filter(|bend| bend.is_finite()).collect();
    // The second difference of white noise has six times its variance.
    if bends.is_empty() { 0.0 } else { NORMAL * median(&bends) / 6f64.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_calibrate::statistics::Draws;
    use headland_trace::Origin;

    /// How a run is recorded.
    #[derive(Clone, Copy)]
    struct How {
        scale: f64,
        late_s: f64,
        /// Radius of the way; none where it is straight and a chainage says where it is.
        radius_m: Option<f64>,
        noise_m: f64,
        /// Whether the chainage is the integral of the recorded speed.
        made: bool,
    }

    const GOOD: How = How { scale: 1.0, late_s: 0.0, radius_m: None, noise_m: 0.05, made: false };

    /// Four runs to and fro that slow down from 11 to 3 m/s.
    fn runs(how: How) -> Vec<RecordedRun> {
        (0..4).map(|run| recorded(run, how)).collect()
    }

    fn recorded(run: u64, how: How) -> RecordedRun {
        let mut draws = Draws::new(9, run);
        let time_s: Vec<f64> = (0..800).map(|index| 0.05 * f64::from(index)).collect();
        let far_m = |time_s: f64| 11.0 * time_s - 0.1 * time_s * time_s;
        let speed: Vec<f64> = time_s
            .iter()
            .map(|time_s| how.scale * (11.0 - 0.2 * (time_s - how.late_s)) + 0.03 * draws.normal())
            .collect();
        let mut trace = Trace::new(time_s.clone()).unwrap();
        let mut noise = || how.noise_m * draws.normal();
        let way = if run % 2 == 1 { -1.0 } else { 1.0 };
        if how.made {
            let made = headland_sim::travelled(&time_s, &speed);
            trace.push("position_m", made, Origin::Measured).unwrap();
        } else if let Some(radius_m) = how.radius_m {
            let turned = |time_s: &f64| far_m(*time_s) / radius_m;
            let east = time_s.iter().map(|at| way * radius_m * turned(at).sin() + noise()).collect();
            trace.push("east_m", east, Origin::Measured).unwrap();
            let north = time_s.iter().map(|at| radius_m * turned(at).cos() + noise()).collect();
            trace.push("north_m", north, Origin::Measured).unwrap();
        } else {
            let along = time_s.iter().map(|at| 400.0 + way * far_m(*at) + noise()).collect();
            trace.push("position_m", along, Origin::Measured).unwrap();
        }
        trace.push("speed_m_s", speed, Origin::Measured).unwrap();
        RecordedRun {
            id: format!("r{run}"),
            trace,
            path: Some("lane".to_owned()),
            reversed: run % 2 == 1,
            held_out: false,
            known: Vec::new(),
            sensors: Vec::new(),
        }
    }

    fn told(how: How) -> Scale {
        scale(&runs(how)).unwrap()
    }

    #[test]
    fn a_scale_is_told_by_a_chainage_and_on_a_bend() {
        for (scale, radius_m) in [(1.035, None), (0.96, Some(60.0)), (0.96, Some(2000.0))] {
            let found = told(How { scale, radius_m, ..GOOD });
            assert!((found.value - (scale - 1.0)).abs() < (2.5 * found.sd).max(1e-3), "{found:?}");
            assert!(found.is_wrong() && !found.is_right(), "{found:?}");
        }
        let found = told(GOOD);
        assert!(found.is_right() && !found.is_wrong(), "{found:?}");
    }

    /// At 3 m/s a speed that comes half a second late is 3 % too fast.
    #[test]
    fn a_speed_that_comes_late_is_no_scale() {
        let found = told(How { late_s: 0.5, ..GOOD });
        assert!(!found.is_wrong() && found.value.abs() < 0.01, "{found:?}");
    }

    #[test]
    fn a_place_that_was_made_of_the_speed_says_nothing() {
        assert_eq!(scale(&runs(How { made: true, ..GOOD })), None);
    }

    #[test]
    fn scales_that_differ_from_run_to_run_are_none() {
        let mixed: Vec<RecordedRun> =
            (0..4).map(|run| recorded(run, How { scale: 1.0 + 0.02 * run as f64, ..GOOD })).collect();
        assert!(scale(&mixed).is_none_or(|scale| !scale.is_wrong() && !scale.is_right()));
    }

    /// Five digits of a degree, once a second.
    #[test]
    fn a_coarse_grid_of_places_widens_the_interval_and_moves_nothing() {
        let mut runs = runs(How { scale: 1.05, radius_m: Some(500.0), noise_m: 0.3, ..GOOD });
        for run in &mut runs {
            for name in ["east_m", "north_m"] {
                let channel = run.trace.remove(name).unwrap();
                let coarse = channel.values.iter().enumerate().map(|(index, value)| {
                    if index % 10 == 0 { (value / 1.1).round() * 1.1 } else { f64::NAN }
                });
                run.trace.push(name, coarse.collect(), Origin::Measured).unwrap();
            }
        }
        let found = scale(&runs).unwrap();
        assert!((found.value - 0.05).abs() < 3.0 * found.sd && found.is_wrong(), "{found:?}");
    }
}
