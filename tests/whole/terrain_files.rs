//! The maps of `terrain/`, as files.
//!
//! `HEADLAND_WRITE=1 cargo test --test whole terrain` writes them anew. What is compared is what the files hold, so that
//! another compression of the same picture is the same map.

use crate::root;
use crate::terrain_formulas::{Map, maps, moisture_of_the_field, soils_of_the_field};
use headland_raster::{Picture, Raster};
use std::fmt::Write;
use std::path::Path;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

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

    pub fn read(&self) -> Raster {
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
