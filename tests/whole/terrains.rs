//! The grounds of the project: their pictures, and whether they are as steep and as rough as they claim.

use crate::root;
use crate::terrain_formulas::{REFERENCE_PER_M, ROUGHNESS_M3, maps, rough_ground};
use std::f64::consts::TAU;

/// Scenarios whose ground has a picture in `docs/pictures/terrain`.
const PICTURES: [&str; 10] = [
    "rolling_field",
    "soils_from_a_map",
    "through_the_valley",
    "along_the_terrace",
    "rough_ground",
    "over_the_ridge",
    "transport",
    "ploughing",
    "cultivating",
    "mowing",
];

/// `HEADLAND_WRITE=1` draws them anew.
#[test]
fn the_pictures_show_the_ground_as_it_is() {
    let registry = headland_stock::registry();
    let draft = tempfile::tempdir().unwrap();
    for name in PICTURES {
        let kept = root().join(format!("docs/pictures/terrain/{name}.svg"));
        let drawn = draft.path().join("ground.svg");
        let scenario = root().join(format!("scenarios/{name}.ron"));
        let words = ["headland", "terrain", scenario.to_str().unwrap(), "--picture", drawn.to_str().unwrap()];
        let status = headland::run(&registry, words.map(std::ffi::OsString::from));
        assert_eq!(format!("{status:?}"), format!("{:?}", std::process::ExitCode::SUCCESS), "{name}");
        if std::env::var_os("HEADLAND_WRITE").is_some() {
            std::fs::create_dir_all(kept.parent().unwrap()).unwrap();
            std::fs::copy(&drawn, &kept).unwrap();
        }
        let same = std::fs::read(&drawn).unwrap() == std::fs::read(&kept).unwrap_or_default();
        assert!(same, "{} is out of date; HEADLAND_WRITE=1 draws it anew", kept.display());
        assert!(crate::read("docs/terrains.md").contains(&format!("pictures/terrain/{name}.svg")), "{name}");
    }
}

#[test]
fn what_is_driven_over_is_as_steep_as_farmland_is() {
    for (map, most) in maps().iter().zip([0.15, 0.18, 0.45, 0.30]) {
        let smoothed = map.read().smoothed().unwrap();
        let bounds = smoothed.bounds();
        let mut steepest = 0.0_f64;
        for i in 0..=200 {
            for j in 0..=200 {
                let at = |ends: [f64; 2], part: i32| ends[0] + (ends[1] - ends[0]) * f64::from(part) / 200.0;
                let spot = smoothed.at(at(bounds.east_m, i), at(bounds.north_m, j)).unwrap();
                steepest = steepest.max(spot.rise_east.hypot(spot.rise_north));
            }
        }
        assert!(steepest > 0.5 * most && steepest < most, "{}: {steepest}", map.file);
    }
}

/// The variance along lines, at each wavelength: a Fourier sum of each row and column, all lines together, held against
/// G₀ (n/n₀)⁻² between 8 m and 1.6 m. One sample of ground is not the mean of all: a factor of two either way.
#[test]
fn the_rough_ground_is_as_rough_as_its_class_in_both_directions() {
    let map = rough_ground();
    let (columns, rows) = (257, map.heights_m.len() / 257);
    let east: Vec<Vec<f64>> = map.heights_m.chunks_exact(columns).map(|row| row[..256].to_vec()).collect();
    let north: Vec<Vec<f64>> =
        (0..columns).map(|c| (0..rows - 1).map(|r| map.heights_m[r * columns + c]).collect()).collect();
    for (lines, wavelengths) in [(east, [6.4, 3.2, 1.6]), (north, [6.4, 3.2, 1.6])] {
        for wavelength in wavelengths {
            let mut density = 0.0;
            let mut count = 0.0;
            let length = 0.2 * lines[0].len() as f64;
            // The octave about it, in whole waves of the line, with Hann's window.
            let (low, high) = (length / wavelength / 1.41, length / wavelength * 1.41);
            let mut k = low.ceil();
            while k <= high {
                for line in &lines {
                    let (mut re, mut im, mut weight) = (0.0, 0.0, 0.0);
                    let mean = line.iter().sum::<f64>() / line.len() as f64;
                    for (i, height) in line.iter().enumerate() {
                        let phase = TAU * i as f64 / line.len() as f64;
                        let window = 0.5 - 0.5 * phase.cos();
                        weight += window * window;
                        re += window * (height - mean) * (k * phase).cos();
                        im += window * (height - mean) * (k * phase).sin();
                    }
                    let n = k / length;
                    let found = 2.0 * 0.2 * (re * re + im * im) / weight;
                    density += found / (ROUGHNESS_M3 * (n / REFERENCE_PER_M).powi(-2));
                    count += 1.0;
                }
                k += 1.0;
            }
            let ratio = density / count;
            assert!(ratio > 0.5 && ratio < 2.0, "{wavelength} m: {ratio} times the class");
        }
    }
}
