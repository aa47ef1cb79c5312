//! GeoTIFF.
//!
//! Source: *OGC GeoTIFF Standard 1.1*, OGC 19-008r4, for the tags and keys; the tag of values that are not known is GDAL's.
//!
//! Read are pictures of one channel, of any depth, on a grid along east and north, in metres, or in degrees, which are laid
//! on a plane about the sample in the south-west.

use crate::ellipsoid::plane;
use crate::{Raster, Source};
use headland_plugin::Refusal;
use std::fs::File;
use std::io::BufReader;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

const GEOTIFF: &str = "a GeoTIFF of one channel beside the scenario";

/// Keys of the directory of keys, and what they may say.
const MODEL_TYPE: u16 = 1024;
const PROJECTED: u16 = 1;
const GEOGRAPHIC: u16 = 2;
const RASTER_TYPE: u16 = 1025;
const IS_POINT: u16 = 2;
const ANGULAR_UNITS: u16 = 2054;
const DEGREE: u16 = 9102;
const LINEAR_UNITS: u16 = 3076;
const VERTICAL_UNITS: u16 = 4099;
const METRE: u16 = 9001;

/// Reads one.
pub(crate) fn read(source: &Source) -> Result<Raster, Refusal> {
    let broken = |error: &dyn std::fmt::Display| source.unreadable(error, GEOTIFF);
    let file = File::open(source.path).map_err(|error| broken(&error))?;
    let mut decoder = Decoder::new(BufReader::new(file)).map_err(|error| broken(&error))?;
    let (columns, rows) = decoder.dimensions().map_err(|error| broken(&error))?;
    let unknown = decoder
        .get_tag_ascii_string(Tag::GdalNodata)
        .ok()
        .map(|text| text.trim_matches(['\0', ' ']).parse::<f64>().map_err(|_| text))
        .transpose()
        .map_err(|text| source.refuse(&format!("whose unknown values are `{text}`"), "a number"))?;
    let grid = Georeference::of(source, &mut decoder)?;
    let image = decoder.read_image().map_err(|error| broken(&error))?;
    let mut values = numbers(image).ok_or_else(|| source.refuse("of complex or half numbers", GEOTIFF))?;
    if values.len() != columns as usize * rows as usize {
        return Err(source.refuse(&format!("with {} values", values.len()), "one for each pixel"));
    }
    for value in &mut values {
        if Some(*value) == unknown || !value.is_finite() {
            *value = f64::NAN;
        }
    }
    // The corner of the picture lies in the north-west.
    let half = if grid.is_point { 0.0 } else { 0.5 };
    let west = grid.tie[0] + half * grid.scale[0];
    let south = grid.tie[1] - (f64::from(rows) - 1.0 + half) * grid.scale[1];
    if grid.is_geographic {
        let origin = (south, west);
        let cell_m = plane(origin, (south + grid.scale[1], west + grid.scale[0]));
        let mut raster = Raster::from_north(columns as usize, [0.0; 2], cell_m, &values);
        raster.geographic = Some(origin);
        return Ok(raster);
    }
    Ok(Raster::from_north(columns as usize, [west, south], grid.scale, &values))
}

fn numbers(image: DecodingResult) -> Option<Vec<f64>> {
    fn all<T: Copy>(values: &[T], number: impl Fn(T) -> f64) -> Vec<f64> {
        values.iter().map(|value| number(*value)).collect()
    }
    Some(match image {
        DecodingResult::U8(values) => all(&values, f64::from),
        DecodingResult::U16(values) => all(&values, f64::from),
        DecodingResult::U32(values) => all(&values, f64::from),
        DecodingResult::I8(values) => all(&values, f64::from),
        DecodingResult::I16(values) => all(&values, f64::from),
        DecodingResult::I32(values) => all(&values, f64::from),
        DecodingResult::F32(values) => all(&values, f64::from),
        DecodingResult::F64(values) => values,
        DecodingResult::U64(_) | DecodingResult::I64(_) | DecodingResult::F16(_) => return None,
    })
}

/// Where the picture lies.
struct Georeference {
    /// East and north of its north-western corner, or of the centre of the pixel there.
    tie: [f64; 2],
    scale: [f64; 2],
    is_point: bool,
    is_geographic: bool,
}

impl Georeference {
    fn of(source: &Source, decoder: &mut Decoder<BufReader<File>>) -> Result<Self, Refusal> {
        const TIED: &str = "one that says where it lies: a scale, and one point that ties it";
        let scale = decoder.get_tag_f64_vec(Tag::ModelPixelScaleTag).unwrap_or_default();
        let tie = decoder.get_tag_f64_vec(Tag::ModelTiepointTag).unwrap_or_default();
        let ([across, along, ..], [column, row, _, east, north, _]) = (scale.as_slice(), tie.as_slice())
        else {
            let found = format!("with {} numbers of its scale and {} of its ties", scale.len(), tie.len());
            return Err(source.refuse(&found, TIED));
        };
        if !(*across > 0.0 && *along > 0.0 && across.is_finite() && along.is_finite()) {
            return Err(source.refuse(&format!("whose cells are {across} by {along}"), "more than 0"));
        }
        let keys = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap_or_default();
        // After four numbers of the directory itself, four for each key: its name, where its value is, how many, the value.
        let key = |name: u16| {
            keys.as_chunks::<4>()
                .0
                .iter()
                .skip(1)
                .find(|entry| entry[0] == name && entry[1] == 0)
                .map(|entry| entry[3])
        };
        let is_geographic = match key(MODEL_TYPE) {
            Some(PROJECTED) => false,
            Some(GEOGRAPHIC) => true,
            other => {
                let found = other.map_or("no type".to_owned(), |other| format!("the type {other}"));
                let expected = "a map in metres (type 1) or in degrees (type 2)";
                return Err(source.refuse(&format!("whose model has {found}"), expected));
            }
        };
        let units = [
            (LINEAR_UNITS, METRE, !is_geographic),
            (VERTICAL_UNITS, METRE, true),
            (ANGULAR_UNITS, DEGREE, is_geographic),
        ];
        for (name, usual, counts) in units {
            if let Some(other) = key(name).filter(|unit| counts && *unit != usual) {
                let found = format!("whose key {name} says the unit {other}");
                return Err(source.refuse(&found, &format!("{usual}, metres or degrees")));
            }
        }
        Ok(Self {
            tie: [east - column * across, north + row * along],
            scale: [*across, *along],
            is_point: key(RASTER_TYPE) == Some(IS_POINT),
            is_geographic,
        })
    }
}

#[cfg(test)]
mod tests {
    use headland_plugin::Bounds;
    use tiff::encoder::{TiffEncoder, colortype};
    use tiff::tags::Tag;

    const KEYS: [u16; 12] = [1, 1, 0, 2, 1024, 0, 1, 1, 1025, 0, 1, 1];

    /// 3 by 2 pixels of 10 m by 20 m; the north-western corner at 5000 m east, 7000 m north.
    fn read(keys: &[u16], scale: &[f64], tie: [f64; 2]) -> Result<crate::Raster, String> {
        let folder = tempfile::tempdir().unwrap();
        let file = std::fs::File::create(folder.path().join("map.tif")).unwrap();
        let mut encoder = TiffEncoder::new(file).unwrap();
        let mut image = encoder.new_image::<colortype::Gray32Float>(3, 2).unwrap();
        let tags = image.encoder();
        tags.write_tag(Tag::ModelPixelScaleTag, scale).unwrap();
        tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, tie[0], tie[1], 0.0][..]).unwrap();
        tags.write_tag(Tag::GeoKeyDirectoryTag, keys).unwrap();
        tags.write_tag(Tag::GdalNodata, "-1").unwrap();
        image.write_data(&[1.5, 2.0, 3.0, 4.0, -1.0, f32::NAN]).unwrap();
        crate::read(folder.path(), "map.tif", None).map_err(|refusal| refusal.to_string())
    }

    const SCALE: [f64; 3] = [10.0, 20.0, 0.0];
    const TIE: [f64; 2] = [5000.0, 7000.0];

    fn key(index: usize, value: u16) -> [u16; 12] {
        let mut keys = KEYS;
        keys[index] = value;
        keys
    }

    #[test]
    fn areas_are_known_by_their_corners_and_points_by_their_centres() {
        let areas = read(&KEYS, &SCALE, TIE).unwrap();
        assert_eq!(areas.bounds(), Bounds { east_m: [5005.0, 5025.0], north_m: [6970.0, 6990.0] });
        assert_eq!(areas.nearest(5005.0, 6990.0), Some(1.5));
        assert_eq!(areas.nearest(5005.0, 6970.0), Some(4.0));
        assert_eq!((areas.nearest(5015.0, 6970.0), areas.nearest(5025.0, 6970.0)), (None, None));
        let points = read(&key(11, 2), &SCALE, TIE).unwrap();
        assert_eq!(points.bounds(), Bounds { east_m: [5000.0, 5020.0], north_m: [6980.0, 7000.0] });
    }

    /// At 45° 0.001° are 111.13 m to the north and 78.85 m to the east.
    #[test]
    fn degrees_become_metres_about_the_sample_in_the_south_west() {
        let map = read(&key(7, 2), &[0.001, 0.001, 0.0], [7.0, 45.001]).unwrap();
        let [east, north] = map.cell_m();
        assert!((east - 78.85).abs() < 0.01 && (north - 111.13).abs() < 0.01, "{east} {north}");
        let (latitude, longitude) = map.geographic().unwrap();
        assert!((latitude - 44.9995).abs() < 1e-9 && (longitude - 7.0005).abs() < 1e-9);
        assert_eq!(map.bounds().east_m[0], 0.0);
    }

    #[test]
    fn a_map_that_does_not_say_where_it_lies_or_in_what_unit_is_refused() {
        let untied = read(&KEYS, &[10.0], TIE).unwrap_err();
        assert!(untied.contains("1 numbers of its scale and 6 of its ties"), "{untied}");
        let model = read(&key(7, 3), &SCALE, TIE).unwrap_err();
        assert!(model.contains("the type 3"), "{model}");
        let feet = [&KEYS[..], &[3076, 0, 1, 9002]].concat();
        assert!(read(&feet, &SCALE, TIE).unwrap_err().contains("key 3076 says the unit 9002"));
        assert!(read(&KEYS, &[10.0, 0.0, 0.0], TIE).unwrap_err().contains("10 by 0"));
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("map.tif"), "no picture").unwrap();
        assert!(
            crate::read(folder.path(), "map.tif", None).unwrap_err().to_string().contains("cannot be read")
        );
    }
}
