//! Places that are told sooner or later than speeds. A receiver or a filter that delays one of the two shifts every map of a
//! path by what the vehicle drives meanwhile, to the one side driven to and to the other driven back; a wave of the ground then
//! seems to smear out.
//!
//! Where a run was is p₀ + k D(t) + τ v(t), with D what its speed adds up to: a scale of either sensor makes k, and a speed that
//! is late by τ leaves a place that is ahead by τ v.

use crate::DiagnoseError;
use crate::causes::sensors::{interpolate, with_channel};
use crate::runs::recorded::Recorded;
use headland_sim::travelled;
use nalgebra::{Matrix3, Vector3};

/// Beyond this no filter delays a place, and something else is wrong [s].
const MOST_S: f64 = 2.0;
/// A shift that is so many standard deviations is one.
const CLEARLY: f64 = 4.0;
/// What is less is nobody's concern [s].
const LEAST_S: f64 = 0.005;
/// So many samples tell of a run.
const FEWEST: usize = 50;

/// Shifts the places of all runs to the clock of their speeds, where the runs tell together what lies between the two.
///
/// # Errors
/// Where a trace cannot be put together.
pub fn by_the_clock_of_speed(runs: &mut [Recorded]) -> Result<(), DiagnoseError> {
    let each: Vec<(f64, f64)> = runs.iter().filter_map(ahead).collect();
    let weight: f64 = each.iter().map(|(_, weight)| weight).sum();
    let mean_s = each.iter().map(|(ahead_s, weight)| ahead_s * weight).sum::<f64>() / weight;
    let count = each.len() as f64;
    let scatter = each.iter().map(|(ahead_s, own)| (own * (ahead_s - mean_s)).powi(2)).sum::<f64>();
    let sd_s = (scatter * count / (count - 1.0)).sqrt() / weight;
    let known = each.len() > 1 && sd_s < LEAST_S.max(mean_s.abs() / CLEARLY) && mean_s.abs() < MOST_S;
    if !known {
        return Ok(());
    }
    for run in runs.iter_mut() {
        let Some(places) = run.measured.trace.get("position_m") else { continue };
        let shifted = |places: &[f64]| -> Vec<f64> {
            let way = way(places);
            let drives = |speed: f64| if speed.is_finite() { way * mean_s * speed } else { 0.0 };
            places.iter().zip(&run.motion.value).map(|(place, speed)| place - drives(*speed)).collect()
        };
        let (trace, own) = (shifted(places), shifted(&run.position_m));
        run.measured.trace = with_channel(&run.measured.trace, "position_m", trace)?;
        run.position_m = own;
        run.placed = true;
    }
    Ok(())
}

/// Moves the places of a run to when a speed was said whose clock is set right: `at_s` of every sample.
///
/// # Errors
/// Where a trace cannot be put together.
pub fn go_along(run: &mut Recorded, at_s: &[f64]) -> Result<(), DiagnoseError> {
    let Some(places) = run.measured.trace.get("position_m").filter(|_| run.placed) else { return Ok(()) };
    let time_s = run.measured.trace.time_s();
    let moved =
        |places: &[f64]| at_s.iter().map(|at_s| interpolate(time_s, places, *at_s)).collect::<Vec<f64>>();
    let (trace, own) = (moved(places), moved(&run.position_m));
    run.measured.trace = with_channel(&run.measured.trace, "position_m", trace)?;
    run.position_m = own;
    Ok(())
}

/// 1 where places grow, −1 where they fall.
fn way(position_m: &[f64]) -> f64 {
    let mut known = position_m.iter().copied().filter(|place| place.is_finite());
    match (known.next(), known.next_back()) {
        (Some(first), Some(last)) if last < first => -1.0,
        _ => 1.0,
    }
}

/// By how long the places of a run are ahead of its speed, and the weight of that; none where the run does not tell.
fn ahead(run: &Recorded) -> Option<(f64, f64)> {
    run.measured.trace.get("position_m")?;
    let over_ground = |index: usize| !run.stands_in.get(index).is_some_and(|stands_in| *stands_in);
    let speed = run.motion.value.iter().enumerate();
    let speed: Vec<f64> =
        speed.map(|(index, speed)| if over_ground(index) { *speed } else { f64::NAN }).collect();
    ahead_s(run.measured.trace.time_s(), &speed, &run.position_m)
}

/// By how long places are ahead of speeds [s], and its weight: one over its variance, but for the noise of places, which all
/// runs have alike; none where there are too few samples or all are as fast.
fn ahead_s(time_s: &[f64], speed_m_s: &[f64], position_m: &[f64]) -> Option<(f64, f64)> {
    let way = way(position_m);
    let driven = travelled(time_s, speed_m_s);
    let (mut normal, mut right, mut count) = (Matrix3::zeros(), Vector3::zeros(), 0usize);
    for ((driven, speed), place) in driven.iter().zip(speed_m_s).zip(position_m) {
        if speed.is_finite() && place.is_finite() {
            let row = Vector3::new(1.0, *driven, *speed);
            normal += row * row.transpose();
            right += row * (way * place);
            count += 1;
        }
    }
    let inverse = normal.try_inverse().filter(|_| count >= FEWEST)?;
    let (ahead_s, weight) = ((inverse * right)[2], 1.0 / inverse[(2, 2)]);
    (ahead_s.is_finite() && weight.is_finite() && weight > 0.0).then_some((ahead_s, weight))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 6 m/s, faster and slower by 3, forth and back; the speed is told 0.2 s late and 2 % too large.
    #[test]
    fn a_speed_that_is_late_leaves_places_ahead() {
        let time_s: Vec<f64> = (0..3000).map(|index| 0.02 * f64::from(index)).collect();
        let speed: Vec<f64> = time_s.iter().map(|t| 1.02 * (6.0 + 3.0 * (0.4 * (t - 0.2)).sin())).collect();
        for way in [1.0, -1.0] {
            let place = |t: &f64| 40.0 + way * (6.0 * t - 3.0 / 0.4 * (0.4 * t).cos());
            let places: Vec<f64> = time_s.iter().map(place).collect();
            let (found, weight) = ahead_s(&time_s, &speed, &places).unwrap();
            // The scale of the speed is that of the shift as well.
            assert!((found - 0.2 / 1.02).abs() < 2e-3 && weight > 0.0, "{found}");
        }
    }

    #[test]
    fn who_drives_at_one_speed_tells_no_clock() {
        let time_s: Vec<f64> = (0..3000).map(|index| 0.02 * f64::from(index)).collect();
        let places: Vec<f64> = time_s.iter().map(|t| 5.0 * t).collect();
        let told = ahead_s(&time_s, &vec![5.0; 3000], &places);
        assert!(told.is_none_or(|(_, weight)| weight < 1e-6), "{told:?}");
        assert!(ahead_s(&time_s[..9], &[5.0; 9], &places[..9]).is_none());
    }
}
