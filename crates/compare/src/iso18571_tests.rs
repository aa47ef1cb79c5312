//! Ratings by hand, at their limits, and against an independent implementation.

use super::*;
use std::f64::consts::{PI, TAU};

/// A smooth bump of 40 samples between zeros, `late` samples after its place.
fn bump(late: usize) -> Vec<f64> {
    let shape = |step: usize| (0.5 - 0.5 * (TAU * step as f64 / 40.0).cos()).powi(2);
    (0..200)
        .map(|at| if (80 + late..120 + late).contains(&at) { shape(at - 80 - late) } else { 0.0 })
        .collect()
}

/// T is 0 in the first half and 1 in the second, C 20 % larger. Half of the samples are 0.2 apart:
/// Z = (1 + (0.3/0.45)²) / 2 = 0.722222. No shift. ε = 0.2, so E_M = 0.6; ε' = 0.2, so E_S = 0.9.
/// R = 0.4 · 0.722222 + 0.2 (1 + 0.6 + 0.9) = 0.788889: fair.
#[test]
fn a_step_that_is_a_fifth_too_high_is_worked_by_hand() {
    let t: Vec<f64> = (0..100).map(|at| if at < 50 { 0.0 } else { 1.0 }).collect();
    let c: Vec<f64> = t.iter().map(|t| 1.2 * t).collect();
    let rating = iso18571(&t, &c).unwrap();
    assert!((rating.corridor - 0.722_222).abs() < 1e-6, "{rating:?}");
    assert_eq!((rating.phase, rating.shift), (1.0, 0.0));
    assert!((rating.magnitude - 0.6).abs() < 1e-12, "{rating:?}");
    assert!((rating.slope - 0.9).abs() < 1e-12, "{rating:?}");
    assert!((rating.overall - 0.788_889).abs() < 1e-6);
    assert_eq!(rating.grade, Grade::Fair);
}

/// Ten of 200 samples late: E_P = (40 - 10) / 40, and once shifted, the signals are equal.
#[test]
fn a_delay_costs_phase_and_corridor_alone() {
    let (t, c) = (bump(0), bump(10));
    let late = iso18571(&t, &c).unwrap();
    assert!((late.phase - 0.75).abs() < 1e-12);
    assert_eq!((late.magnitude, late.slope, late.shift), (1.0, 1.0, 0.05));
    assert!(late.corridor < 1.0);
    assert_eq!(iso18571(&c, &t).unwrap().shift, -0.05);
}

#[test]
fn a_delay_of_more_than_a_fifth_is_no_longer_followed() {
    let rating = iso18571(&bump(0), &bump(70)).unwrap();
    assert!(rating.phase == 1.0 || rating.phase < 0.01, "{rating:?}");
    assert_eq!(rating.magnitude, 0.0);
}

/// A slowing vehicle with a wobble, and a growing swing; the model of the first is late, that of the second early.
/// Expected: what `objective_rating_metrics` 1.3 (Python) gave for the same 400 samples: corridor, phase, magnitude,
/// slope, overall.
#[test]
fn ratings_agree_with_an_independent_implementation() {
    let sampled = |signal: fn(f64) -> f64| (0..400).map(|k| signal(f64::from(k))).collect::<Vec<f64>>();
    let agrees = |t: &[f64], c: &[f64], expected: [f64; 5]| {
        let rating = iso18571(t, c).unwrap();
        let found = [rating.corridor, rating.phase, rating.magnitude, rating.slope, rating.overall];
        assert!(
            found.iter().zip(expected).all(|(found, e)| (found - e).abs() < 1e-9),
            "{found:?} {expected:?}"
        );
        rating
    };
    let late = agrees(
        &sampled(|k| 8.0 * (-k / 300.0).exp() + 0.5 * (k / 17.0).sin()),
        &sampled(|k| 8.4 * (-k / 260.0).exp() + 0.6 * ((k - 7.0) / 17.0).sin()),
        [0.993_153_861_569, 0.9125, 0.954_552_455_306, 0.910_234_887_7, 0.952_719_013_229],
    );
    assert_eq!((late.shift, late.grade), (7.0 / 400.0, Grade::Excellent));
    let early = agrees(
        &sampled(|k| (k / 25.0).sin() * (1.0 + k / 200.0)),
        &sampled(|k| 1.15 * ((k + 12.0) / 25.5).sin() * (1.0 + k / 230.0) - 0.1),
        [0.638_505_487_462, 0.9125, 0.958_865_638_241, 0.959_153_057_866, 0.821_505_934_206],
    );
    assert_eq!((early.shift, early.grade), (-7.0 / 400.0, Grade::Good));
}

/// The nine-sample mean of a straight line's slope is its slope, ends included.
#[test]
fn slopes_of_a_line_are_its_slope() {
    let line: Vec<f64> = (0..30).map(|at| 3.0 - 0.5 * f64::from(at)).collect();
    assert!(slopes(&line).iter().all(|slope| (slope + 0.5).abs() < 1e-12));
}

/// A unit step between samples 49 and 50: central differences of a half on both, so the smoothed slope is 1/18 where
/// nine samples hold one of them and 1/9 where they hold both.
#[test]
fn a_step_is_smoothed_over_nine_samples() {
    let t: Vec<f64> = (0..100).map(|at| if at < 50 { 0.0 } else { 1.0 }).collect();
    let found = slopes(&t);
    for (at, expected) in
        [(44, 0.0), (45, 1.0 / 18.0), (46, 1.0 / 9.0), (53, 1.0 / 9.0), (54, 1.0 / 18.0), (55, 0.0)]
    {
        assert!((found[at] - expected).abs() < 1e-15, "{at}: {}", found[at]);
    }
}

#[test]
fn equal_signals_are_excellent_and_opposite_ones_poor() {
    let t: Vec<f64> = (0..100).map(|at| (PI * f64::from(at) / 50.0).sin() + 0.2).collect();
    let same = iso18571(&t, &t).unwrap();
    assert_eq!((same.overall, same.grade), (1.0, Grade::Excellent));
    let opposite: Vec<f64> = t.iter().map(|t| -t).collect();
    assert_eq!(iso18571(&t, &opposite).unwrap().grade, Grade::Poor);
}

#[test]
fn what_cannot_be_rated_is_not() {
    assert_eq!(iso18571(&[1.0; 50], &bump(0)[..50]), None);
    assert_eq!(iso18571(&bump(0), &bump(0)[1..]), None);
    assert_eq!(iso18571(&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0]), None);
    let mut holed = bump(0);
    holed[3] = f64::NAN;
    assert_eq!(iso18571(&bump(0), &holed), None);
}

/// Of 100 samples the warping reaches nine to either side: a spike is found there, and not at ten.
#[test]
fn warping_reaches_a_tenth_of_the_length_less_one_sample() {
    let spike = |place: usize| (0..100).map(|at| f64::from(u8::from(at == place))).collect::<Vec<f64>>();
    assert_eq!(magnitude(&spike(50), &spike(59)), 1.0);
    assert_eq!(magnitude(&spike(50), &spike(60)), 0.0);
}
