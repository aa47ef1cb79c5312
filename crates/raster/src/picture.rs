//! Grey pictures.
//!
//! value = lowest + (highest − lowest) · level / 65535, or the level itself where no range is given
//!
//! Source: *Portable Network Graphics (PNG) Specification*, W3C.
//! The pixel in the south-west lies on the origin. Values on a range take 16 bits: with 8 the steps between them are ledges.

use crate::{Raster, Source, refuse};
use headland_plugin::Refusal;
use png::{BitDepth, ColorType, Decoder, Transformations};
use std::fs::File;
use std::io::BufReader;

/// What a picture cannot say itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picture {
    /// How far its pixels are apart [m].
    pub cell_m: f64,
    /// The values of black and of white; without them a pixel counts as its level.
    pub range: Option<(f64, f64)>,
}

/// The level of white with 16 bits.
const WHITE: f64 = 65_535.0;

/// Reads one.
pub(crate) fn read(source: &Source, picture: &Picture) -> Result<Raster, Refusal> {
    const GREY: &str = "a grey PNG of 8 or 16 bits beside the scenario";
    if !(picture.cell_m.is_finite() && picture.cell_m > 0.0) {
        return Err(refuse("cell_m", picture.cell_m.to_string(), "more than 0"));
    }
    let file = File::open(source.path).map_err(|error| source.unreadable(&error, GREY))?;
    let mut decoder = Decoder::new(BufReader::new(file));
    decoder.set_transformations(Transformations::IDENTITY);
    let mut reader = decoder.read_info().map_err(|error| source.unreadable(&error, GREY))?;
    let size = reader.output_buffer_size().ok_or_else(|| source.refuse("which is too large", GREY))?;
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes).map_err(|error| source.unreadable(&error, GREY))?;
    bytes.truncate(frame.buffer_size());
    let levels: Vec<f64> = match (frame.color_type, frame.bit_depth, picture.range) {
        (ColorType::Grayscale, BitDepth::Sixteen, _) => {
            bytes.as_chunks::<2>().0.iter().map(|pair| f64::from(u16::from_be_bytes(*pair))).collect()
        }
        // The colours of a palette are for people: what counts is its index.
        (ColorType::Grayscale | ColorType::Indexed, BitDepth::Eight, None) => {
            bytes.iter().map(|level| f64::from(*level)).collect()
        }
        (colour, depth, range) => {
            let found = format!("whose pixels are {colour:?} of {} bits", depth as u8);
            return Err(source.refuse(&found, if range.is_some() { "grey of 16 bits" } else { GREY }));
        }
    };
    let values: Vec<f64> = match picture.range {
        Some((lowest, highest)) => {
            levels.iter().map(|level| lowest + (highest - lowest) * level / WHITE).collect()
        }
        None => levels,
    };
    Ok(Raster::from_north(frame.width as usize, [0.0; 2], [picture.cell_m; 2], &values))
}

#[cfg(test)]
mod tests {
    use super::Picture;
    use headland_plugin::Bounds;
    use png::{BitDepth, ColorType};

    fn read(
        colour: ColorType,
        depth: BitDepth,
        bytes: &[u8],
        picture: Option<Picture>,
    ) -> Result<crate::Raster, String> {
        let folder = tempfile::tempdir().unwrap();
        let file = std::fs::File::create(folder.path().join("map.png")).unwrap();
        let mut encoder = png::Encoder::new(file, 2, 2);
        encoder.set_color(colour);
        encoder.set_depth(depth);
        if colour == ColorType::Indexed {
            encoder.set_palette(vec![0; 12]);
        }
        encoder.write_header().unwrap().write_image_data(bytes).unwrap();
        crate::read(folder.path(), "map.png", picture.as_ref()).map_err(|refusal| refusal.to_string())
    }

    const HEIGHTS: Picture = Picture { cell_m: 5.0, range: Some((100.0, 165.535)) };
    const CLASSES: Picture = Picture { cell_m: 5.0, range: None };

    /// Levels 0 and 1000 in the north, 65535 and 256 in the south; a level is 1 mm.
    #[test]
    fn black_is_the_lowest_and_white_the_highest_and_the_last_row_lies_in_the_south() {
        let bytes = [0, 0, 0x03, 0xE8, 0xFF, 0xFF, 0x01, 0x00];
        let grid = read(ColorType::Grayscale, BitDepth::Sixteen, &bytes, Some(HEIGHTS)).unwrap();
        assert_eq!(grid.bounds(), Bounds { east_m: [0.0, 5.0], north_m: [0.0, 5.0] });
        for (east, north, value) in
            [(0.0, 5.0, 100.0), (5.0, 5.0, 101.0), (0.0, 0.0, 165.535), (5.0, 0.0, 100.256)]
        {
            assert!((grid.nearest(east, north).unwrap() - value).abs() < 1e-9, "{east} {north}");
        }
    }

    #[test]
    fn classes_are_levels_or_places_in_a_palette() {
        for colour in [ColorType::Grayscale, ColorType::Indexed] {
            let grid = read(colour, BitDepth::Eight, &[0, 1, 2, 3], Some(CLASSES)).unwrap();
            assert_eq!((grid.nearest(0.0, 0.0), grid.nearest(5.0, 5.0)), (Some(2.0), Some(1.0)));
        }
    }

    #[test]
    fn colours_few_bits_and_a_missing_scale_are_refused() {
        let told = |colour, depth, bytes: &[u8], picture| read(colour, depth, bytes, picture).unwrap_err();
        let few = told(ColorType::Grayscale, BitDepth::Eight, &[0; 4], Some(HEIGHTS));
        assert!(few.contains("of 8 bits, expected grey of 16 bits"), "{few}");
        let colours = told(ColorType::Rgb, BitDepth::Eight, &[0; 12], Some(CLASSES));
        assert!(colours.contains("Rgb of 8 bits"), "{colours}");
        let scale = told(ColorType::Grayscale, BitDepth::Eight, &[0; 4], None);
        assert!(scale.contains("`cell_m` is not given"), "{scale}");
        let cell = Picture { cell_m: 0.0, ..CLASSES };
        let flat = told(ColorType::Grayscale, BitDepth::Eight, &[0; 4], Some(cell));
        assert!(flat.contains("`cell_m` is 0, expected more than 0"), "{flat}");
    }
}
