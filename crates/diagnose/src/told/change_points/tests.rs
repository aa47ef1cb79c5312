//! Noise shows nothing, and what stands out of it is found where it is.

use super::*;
use crate::balances::noise::Shape;
use headland_calibrate::statistics::Draws;

const SENSOR: Noise = Noise { shape: Shape::Differenced, sensor: 4.0, process: 0.0, persistence: 0.0 };
const MIXED: Noise = Noise { shape: Shape::Differenced, sensor: 4.0, process: 0.5, persistence: 0.88 };
const SMOOTH: Noise = Noise { shape: Shape::Averaged, sensor: 0.3, process: 2.0, persistence: 0.96 };

/// Noise as the balance has it: a moving average and a process that remembers.
fn noise(of: &Noise, rows: usize, seed: u64) -> Vec<Sample> {
    let mut draws = Draws::new(seed, 5);
    let theta: f64 = if of.shape == Shape::Differenced { -1.0 } else { 2.0 - 3.0_f64.sqrt() };
    let size = (of.sensor / (1.0 + theta * theta)).sqrt();
    let mut last = draws.normal();
    let mut process = of.process.sqrt() * draws.normal();
    (0..rows)
        .map(|cell| {
            let white = draws.normal();
            let value = process + size * (white + theta * last);
            last = white;
            let fresh = (of.process * (1.0 - of.persistence * of.persistence)).sqrt();
            process = of.persistence * process + fresh * draws.normal();
            Sample { value, cell, linked: cell > 0 }
        })
        .collect()
}

#[test]
fn noise_shows_a_stretch_about_once_in_a_hundred_times() {
    for of in [SENSOR, MIXED, SMOOTH] {
        let seeds = 200;
        let shown = (0..seeds)
            .filter(|seed| {
                let mut samples = noise(&of, 300, *seed);
                for sample in &mut samples {
                    sample.cell /= 3;
                }
                !stretches(&of, &samples, 100, penalty(300)).is_empty()
            })
            .count();
        assert!(shown <= 6, "{shown} of {seeds} with {of:?}");
    }
}

#[test]
fn sorted_into_cells_noise_shows_nothing_either() {
    let shown = (0..100)
        .filter(|seed| {
            let mut samples = noise(&MIXED, 600, 1000 + seed);
            for (index, sample) in samples.iter_mut().enumerate() {
                // To and fro over thirty cells.
                let place = (index / 5) % 60;
                sample.cell = if place < 30 { place } else { 59 - place };
                sample.linked = index % 300 != 0;
            }
            !stretches(&MIXED, &samples, 30, penalty(600)).is_empty()
        })
        .count();
    assert!(shown <= 4, "{shown} of 100");
}

#[test]
fn a_step_is_found_at_its_edges_with_its_height() {
    let mut found_right = 0;
    for seed in 0..20 {
        let mut samples = noise(&MIXED, 300, seed);
        for sample in &mut samples[120..180] {
            sample.value += 3.0;
        }
        let found = stretches(&MIXED, &samples, 300, penalty(300));
        assert_eq!(found.len(), 1, "seed {seed}: {found:?}");
        let near = |place: usize, expected: usize| place.abs_diff(expected) <= 3;
        found_right += usize::from(
            near(found[0].from, 120)
                && near(found[0].to, 180)
                && (found[0].mean - 3.0).abs() < 3.0 * found[0].sd,
        );
    }
    assert!(found_right >= 18, "{found_right} of 20");
}

#[test]
fn a_stretch_of_the_road_is_found_in_runs_to_and_fro() {
    let mut samples = noise(&MIXED, 1200, 9);
    for (index, sample) in samples.iter_mut().enumerate() {
        let place = index % 300;
        let forward = (index / 300) % 2 == 0;
        sample.cell = (if forward { place } else { 299 - place }) / 10;
        sample.linked = place != 0;
        if (12..18).contains(&sample.cell) {
            sample.value += 2.0;
        }
    }
    let found = stretches(&MIXED, &samples, 30, penalty(1200));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].from, found[0].to), (12, 18));
}

/// A mean that lasts is one stretch, though the process would let each half of it speak for itself.
#[test]
fn a_mean_of_all_rows_is_one_stretch() {
    let mut samples = noise(&SMOOTH, 300, 4);
    for sample in &mut samples {
        sample.value += 14.0;
    }
    let found = stretches(&SMOOTH, &samples, 300, penalty(300));
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].from, found[0].to), (0, 300));
}
