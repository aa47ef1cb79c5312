//! The maps of `terrain/`, made from formulas and a seed.
//!
//! `HEADLAND_WRITE=1 cargo test --test whole terrains` writes them anew. What is compared is what the files hold, so that
//! another compression of the same picture is the same map.

use crate::root;
use headland_raster::{Picture, Raster};
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::Path;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

/// Samples of a map, rows from south to north, and how it is written.
struct Map {
    file: &'static str,
    columns: u32,
    cell_m: f64,
    heights_m: Vec<f64>,
    /// Black and white of a picture [m].
    range: Option<(f64, f64)>,
    /// The step between two heights that the file can hold [m].
    step_m: f64,
}

fn maps() -> [Map; 4] {
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
fn rolling_field() -> Map {
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
const ROUGHNESS_M3: f64 = 4096e-6;
const REFERENCE_PER_M: f64 = 0.1;

/// 51.2 m by 12.8 m that are rough alike in every direction.
///
/// Along any line G(n) = G₀ (n/n₀)⁻². A ground that is so along all lines has the variance C n⁻² for each wavenumber n, all
/// directions together, with G(k) = ∫ 2 C n⁻² / (π √(n² − k²)) dn over n > k = 2 C / (π k²).
fn rough_ground() -> Map {
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
fn soils_of_the_field() -> Vec<u8> {
    let class = |height: &f64| if *height > 9.5 { 1 } else { 2 * u8::from(*height < 7.0) };
    rolling_field().heights_m.iter().map(class).collect()
}

/// How moist it is, at every fifth sample: the lower the wetter, and wetter to the north.
fn moisture_of_the_field() -> Vec<f64> {
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

/// `HEADLAND_WRITE=1` writes them anew.
#[test]
fn the_maps_of_soils_and_moisture_are_what_their_formulas_say() {
    let folder = root().join("terrain");
    let (soils, moisture) = ("rolling_field_soils.png", "rolling_field_moisture.asc");
    if std::env::var_os("HEADLAND_WRITE").is_some() {
        let bytes: Vec<u8> = soils_of_the_field().chunks_exact(101).rev().flatten().copied().collect();
        let mut encoder = png::Encoder::new(std::fs::File::create(folder.join(soils)).unwrap(), 101, 81);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        // Colours for people: brown loam, pale sand, dark clay.
        encoder.set_palette(vec![160, 120, 80, 225, 200, 150, 90, 80, 75]);
        encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
        let mut text = "ncols 21\nnrows 17\nxllcenter 0\nyllcenter 0\ncellsize 25\n".to_owned();
        for row in moisture_of_the_field().chunks_exact(21).rev() {
            let row: Vec<String> = row.iter().map(|moisture| format!("{moisture:.3}")).collect();
            let _ = writeln!(text, "{}", row.join(" "));
        }
        std::fs::write(folder.join(moisture), text).unwrap();
    }
    let picture = Picture { cell_m: 5.0, range: None };
    let read = headland_raster::read(&folder, soils, Some(&picture)).unwrap();
    assert!(read.values().iter().copied().eq(soils_of_the_field().into_iter().map(f64::from)));
    let read = headland_raster::read(&folder, moisture, None).unwrap();
    for (found, wanted) in read.values().iter().zip(moisture_of_the_field()) {
        assert!((found - wanted).abs() < 5.1e-4, "{found} {wanted}");
    }
}

impl Map {
    /// Rows from north to south.
    fn southward(&self) -> impl Iterator<Item = &[f64]> {
        self.heights_m.chunks_exact(self.columns as usize).rev()
    }

    fn write(&self, path: &Path) {
        match (self.range, path.extension().unwrap().to_str().unwrap()) {
            (Some(range), "png") => self.write_picture(path, range),
            (None, "asc") => self.write_grid(path),
            (None, "tif") => self.write_tiff(path),
            other => panic!("{other:?}"),
        }
    }

    fn write_picture(&self, path: &Path, (black_m, white_m): (f64, f64)) {
        let mut bytes = Vec::new();
        for height in self.southward().flatten() {
            let level = (65_535.0 * (height - black_m) / (white_m - black_m)).round();
            assert!((0.0..=65_535.0).contains(&level), "{}: {height} m is out of range", self.file);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 16 bits")]
            bytes.extend((level as u16).to_be_bytes());
        }
        let rows = self.heights_m.len() / self.columns as usize;
        let mut encoder = png::Encoder::new(
            std::fs::File::create(path).unwrap(),
            self.columns,
            u32::try_from(rows).unwrap(),
        );
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Sixteen);
        encoder.set_compression(png::Compression::High);
        encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
    }

    fn write_grid(&self, path: &Path) {
        let rows = self.heights_m.len() / self.columns as usize;
        let mut text = format!(
            "ncols {}\nnrows {rows}\nxllcenter 0\nyllcenter 0\ncellsize {}\n",
            self.columns, self.cell_m
        );
        for row in self.southward() {
            let row: Vec<String> = row.iter().map(|height| format!("{height:.2}")).collect();
            let _ = writeln!(text, "{}", row.join(" "));
        }
        std::fs::write(path, text).unwrap();
    }

    /// With keys that say: projected, pixels are points, metres.
    fn write_tiff(&self, path: &Path) {
        const KEYS: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 2, 3076, 0, 1, 9001];
        let rows = self.heights_m.len() / self.columns as usize;
        let north_m = self.cell_m * (rows - 1) as f64;
        let mut encoder = TiffEncoder::new(std::fs::File::create(path).unwrap())
            .unwrap()
            .with_compression(tiff::encoder::Compression::Deflate(tiff::encoder::DeflateLevel::Best));
        let mut image =
            encoder.new_image::<colortype::Gray32Float>(self.columns, u32::try_from(rows).unwrap()).unwrap();
        let tags = image.encoder();
        tags.write_tag(Tag::ModelPixelScaleTag, &[self.cell_m, self.cell_m, 0.0][..]).unwrap();
        tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 0.0, north_m, 0.0][..]).unwrap();
        tags.write_tag(Tag::GeoKeyDirectoryTag, &KEYS[..]).unwrap();
        #[allow(clippy::cast_possible_truncation, reason = "to a hundredth of a millimetre")]
        let heights: Vec<f32> = self.southward().flatten().map(|height| *height as f32).collect();
        image.write_data(&heights).unwrap();
    }

    fn read(&self) -> Raster {
        let picture = self.range.map(|range| Picture { cell_m: self.cell_m, range: Some(range) });
        headland_raster::read(&root().join("terrain"), self.file, picture.as_ref())
            .unwrap_or_else(|refusal| panic!("{refusal}"))
    }
}

#[test]
fn the_maps_are_what_their_formulas_say() {
    for map in maps() {
        let path = root().join("terrain").join(map.file);
        if std::env::var_os("HEADLAND_WRITE").is_some() {
            map.write(&path);
        }
        let read = map.read();
        assert_eq!(read.columns(), map.columns as usize, "{}", map.file);
        assert_eq!(read.values().len(), map.heights_m.len(), "{}", map.file);
        for (found, wanted) in read.values().iter().zip(&map.heights_m) {
            assert!((found - wanted).abs() < 0.51 * map.step_m, "{}: {found} m, {wanted} m", map.file);
        }
        let place = read.place_m(1, 1);
        assert!((place[0] - map.cell_m).abs() < 1e-9 && (place[1] - map.cell_m).abs() < 1e-9, "{place:?}");
    }
}

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
