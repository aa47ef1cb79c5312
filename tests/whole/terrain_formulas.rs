//! The maps of `terrain/` as formulas and a seed make them.

use std::f64::consts::{PI, TAU};

/// Samples of a map, rows from south to north, and how it is written.
pub struct Map {
    pub file: &'static str,
    pub columns: u32,
    pub cell_m: f64,
    pub heights_m: Vec<f64>,
    /// Black and white of a picture [m].
    pub range: Option<(f64, f64)>,
    /// The step between two heights that the file can hold [m].
    pub step_m: f64,
}

pub fn maps() -> [Map; 4] {
    [rolling_field(), valley(), terraces(), rough_ground()]
}

fn sampled(columns: u32, rows: u32, cell_m: f64, height_m: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (f64::from(column) * cell_m, f64::from(row) * cell_m)))
        .map(|(east, north)| height_m(east, north))
        .collect()
}

/// Numbers from 0 to 1: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA (2014), 453.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A wave over the map.
struct Wave {
    amplitude_m: f64,
    east_rad_m: f64,
    north_rad_m: f64,
    phase_rad: f64,
}

/// Waves from long to short, each in a direction of its own; `variance` is what those between two wavenumbers [1/m] have.
fn waves(seed: u64, count: u32, from: f64, to: f64, variance: impl Fn(f64, f64) -> f64) -> Vec<Wave> {
    let mut dice = Dice(seed);
    let ratio = (to / from).powf(1.0 / f64::from(count));
    (0..count)
        .map(|number| {
            let low = from * ratio.powf(f64::from(number));
            let (direction, phase_rad, within) = (TAU * dice.roll(), TAU * dice.roll(), dice.roll());
            let wavenumber = TAU * low * ratio.powf(within);
            let (sin, cos) = direction.sin_cos();
            Wave {
                amplitude_m: (2.0 * variance(low, low * ratio)).sqrt(),
                east_rad_m: wavenumber * sin,
                north_rad_m: wavenumber * cos,
                phase_rad,
            }
        })
        .collect()
}

fn sum(waves: &[Wave], east: f64, north: f64) -> f64 {
    waves
        .iter()
        .map(|wave| {
            wave.amplitude_m * (wave.east_rad_m * east + wave.north_rad_m * north + wave.phase_rad).sin()
        })
        .sum()
}

/// 500 m by 400 m of gentle hills: 24 waves of 120 m to 600 m, the longer the higher.
pub fn rolling_field() -> Map {
    let waves = waves(4, 24, 1.0 / 600.0, 1.0 / 120.0, |low, high| 7e-3 * (1.0 / low - 1.0 / high));
    let heights_m = sampled(101, 81, 5.0, |east, north| 8.0 + sum(&waves, east, north));
    Map {
        file: "rolling_field.png",
        columns: 101,
        cell_m: 5.0,
        heights_m,
        range: Some((0.0, 16.0)),
        step_m: 16.0 / 65_535.0,
    }
}

/// 600 m by 400 m: a winding valley between two ridges of 16 m, falling to the south.
fn valley() -> Map {
    let heights_m = sampled(61, 41, 10.0, |east, north| {
        let middle = 300.0 + 60.0 * (TAU * north / 500.0).sin();
        let away = (east - middle) / 110.0;
        200.0 + 0.01 * north + 16.0 * (1.0 - (-away * away).exp())
    });
    Map { file: "valley.asc", columns: 61, cell_m: 10.0, heights_m, range: None, step_m: 0.01 }
}

/// 160 m by 120 m of a hillside in five terraces, 24 m deep and 1.8 m above each other, that follow its bends.
fn terraces() -> Map {
    let heights_m = sampled(81, 61, 2.0, |east, north| {
        let up = north + 7.0 * (TAU * east / 160.0).cos();
        let bank = |edge: f64| {
            let t = ((up - edge) / 8.0 + 0.5).clamp(0.0, 1.0);
            1.8 * t * t * (3.0 - 2.0 * t)
        };
        300.0 + 0.015 * up + [0.0, 24.0, 48.0, 72.0, 96.0, 120.0].map(bank).iter().sum::<f64>()
    });
    Map { file: "terraces.tif", columns: 81, cell_m: 2.0, heights_m, range: None, step_m: 1e-4 }
}

/// Roughness of class E of ISO 8608, *Mechanical vibration - Road surface profiles*: the geometric mean at 0.1 cycles/m [m³].
pub const ROUGHNESS_M3: f64 = 4096e-6;
pub const REFERENCE_PER_M: f64 = 0.1;

/// 51.2 m by 12.8 m that are rough alike in every direction.
///
/// Along any line G(n) = G₀ (n/n₀)⁻². A ground that is so along all lines has the variance C n⁻² for each wavenumber n, all
/// directions together, with G(k) = ∫ 2 C n⁻² / (π √(n² − k²)) dn over n > k = 2 C / (π k²).
pub fn rough_ground() -> Map {
    let c = 0.5 * PI * ROUGHNESS_M3 * REFERENCE_PER_M * REFERENCE_PER_M;
    let waves = waves(8608, 400, 1.0 / 40.0, 1.0, |low, high| c * (1.0 / low - 1.0 / high));
    let heights_m = sampled(257, 65, 0.2, |east, north| sum(&waves, east, north));
    Map {
        file: "rough_ground.png",
        columns: 257,
        cell_m: 0.2,
        heights_m,
        range: Some((-0.5, 0.5)),
        step_m: 1.0 / 65_535.0,
    }
}

/// Which soil lies on the rolling field: 1 where it is high, 2 in its hollows, else 0.
pub fn soils_of_the_field() -> Vec<u8> {
    let class = |height: &f64| if *height > 9.5 { 1 } else { 2 * u8::from(*height < 7.0) };
    rolling_field().heights_m.iter().map(class).collect()
}

/// How moist it is, at every fifth sample: the lower the wetter, and wetter to the north.
pub fn moisture_of_the_field() -> Vec<f64> {
    let field = rolling_field();
    let mut all = Vec::new();
    for row in (0..81).step_by(5) {
        for column in (0..101).step_by(5) {
            let height = field.heights_m[row * 101 + column];
            all.push(0.30 - 0.012 * (height - 8.0) + 0.03 * (row as f64 - 40.0) / 40.0);
        }
    }
    all
}
