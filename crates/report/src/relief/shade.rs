//! Heights as colours, shaded by a light from the north-west.
//!
//! Source: Horn, "Hill shading and the reflectance map", Proceedings of the IEEE 69 (1981), 14-47: brightness as the cosine
//! between the light and the normal of the ground.

use super::Ground;

/// Colours from low to high.
const TONES: [[f64; 3]; 4] =
    [[196.0, 216.0, 186.0], [231.0, 232.0, 200.0], [233.0, 211.0, 168.0], [206.0, 166.0, 126.0]];
/// What is not known.
const UNKNOWN: [u8; 3] = [238, 238, 238];
/// Direction of the light: from the north-west, half way up.
const LIGHT: [f64; 3] = [-0.5, 0.5, 0.707];
/// Steepest slope that is shaded fully; gentler ground is exaggerated so that it shows.
const FULL_SLOPE: f64 = 0.5;
/// How much of the colour the shade may take away.
const SHADE: f64 = 0.55;

/// A PNG in base 64, rows from north to south.
pub(crate) fn picture(ground: &Ground, (low, high): (f64, f64)) -> String {
    let (columns, rows) = (ground.columns, ground.rows());
    let slopes: Vec<[f64; 2]> =
        (0..rows * columns).map(|at| slope(ground, at % columns, at / columns)).collect();
    let steepest = slopes
        .iter()
        .map(|slope| slope[0].hypot(slope[1]))
        .filter(|slope| !slope.is_nan())
        .fold(0.0, f64::max);
    let exaggeration = if steepest > 0.0 { (FULL_SLOPE / steepest).max(1.0) } else { 1.0 };
    let mut bytes = Vec::with_capacity(3 * rows * columns);
    for row in (0..rows).rev() {
        for column in 0..columns {
            let at = row * columns + column;
            let height = ground.heights_m[at];
            if height.is_nan() {
                bytes.extend(UNKNOWN);
                continue;
            }
            let share = if high > low { (height - low) / (high - low) } else { 0.0 };
            let [east, north] =
                slopes[at].map(|slope| if slope.is_nan() { 0.0 } else { exaggeration * slope });
            let normal = east.hypot(north).hypot(1.0);
            let light = (-LIGHT[0] * east - LIGHT[1] * north + LIGHT[2]) / normal;
            let brightness = 1.0 + SHADE * (light - LIGHT[2]);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a colour")]
            bytes.extend(tone(share).map(|colour| (colour * brightness).clamp(0.0, 255.0).round() as u8));
        }
    }
    base64(&png(columns, rows, &bytes))
}

fn tone(share: f64) -> [f64; 3] {
    let along = share.clamp(0.0, 1.0) * (TONES.len() - 1) as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between the tones")]
    let index = (along as usize).min(TONES.len() - 2);
    let t = along - index as f64;
    [0, 1, 2].map(|channel| (1.0 - t) * TONES[index][channel] + t * TONES[index + 1][channel])
}

/// Rise per metre to the east and to the north, from the neighbours.
fn slope(ground: &Ground, column: usize, row: usize) -> [f64; 2] {
    let at = |column: usize, row: usize| ground.heights_m[row * ground.columns + column];
    let (west, east) = (column.saturating_sub(1), (column + 1).min(ground.columns - 1));
    let (south, north) = (row.saturating_sub(1), (row + 1).min(ground.rows() - 1));
    let rise = |change: f64, cells: usize, cell_m: f64| {
        if cells == 0 { 0.0 } else { change / (cells as f64 * cell_m) }
    };
    [
        rise(at(east, row) - at(west, row), east - west, ground.cell_m[0]),
        rise(at(column, north) - at(column, south), north - south, ground.cell_m[1]),
    ]
}

/// Writing to memory does not fail; what is left out then is the picture alone.
fn png(columns: usize, rows: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let (Ok(width), Ok(height)) = (u32::try_from(columns), u32::try_from(rows)) else { return file };
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let _ = encoder.write_header().and_then(|mut writer| writer.write_image_data(bytes));
    file
}

/// Base 64 of RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let bits = chunk
            .iter()
            .enumerate()
            .fold(0_usize, |bits, (at, byte)| bits | usize::from(*byte) << (16 - 8 * at));
        for letter in 0..4 {
            let filled = letter <= chunk.len();
            text.push(if filled { char::from(LETTERS[bits >> (18 - 6 * letter) & 63]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of RFC 4648, section 10.
    #[test]
    fn base_64_is_that_of_its_standard() {
        for (plain, coded) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn a_slope_to_the_light_is_brighter_than_one_away_from_it() {
        let rising =
            Ground { corner_m: [0.0; 2], cell_m: [1.0; 2], columns: 3, heights_m: [0.0, 0.1, 0.2].repeat(2) };
        assert_eq!(slope(&rising, 1, 0).map(|rise| (rise * 1e9).round()), [1e8, 0.0]);
        assert_eq!(tone(0.0), TONES[0]);
        assert_eq!(tone(1.0), TONES[3]);
        assert!(picture(&rising, (0.0, 0.2)).starts_with("iVBORw0KGgo"), "the signature of a PNG");
    }
}
