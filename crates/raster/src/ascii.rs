//! ASCII grids.
//!
//! Source: the ASCII raster format of Esri, *ArcGIS* documentation: a header of names and numbers, then rows from north to
//! south.

use crate::{Raster, Source};
use headland_plugin::Refusal;

const GRID: &str = "an ASCII grid beside the scenario";

/// What the header says.
#[derive(Default)]
struct Header {
    columns: Option<f64>,
    rows: Option<f64>,
    /// East and north, and whether of the centre of the corner cell.
    east: Option<(f64, bool)>,
    north: Option<(f64, bool)>,
    cell: [Option<f64>; 2],
    unknown: Option<f64>,
}

impl Header {
    /// Takes an entry; `false` where the name is none of a header.
    fn take(&mut self, name: &str, value: f64) -> bool {
        match name.to_ascii_lowercase().as_str() {
            "ncols" => self.columns = Some(value),
            "nrows" => self.rows = Some(value),
            "xllcorner" => self.east = Some((value, false)),
            "xllcenter" => self.east = Some((value, true)),
            "yllcorner" => self.north = Some((value, false)),
            "yllcenter" => self.north = Some((value, true)),
            "cellsize" => self.cell = [Some(value); 2],
            "dx" => self.cell[0] = Some(value),
            "dy" => self.cell[1] = Some(value),
            "nodata_value" => self.unknown = Some(value),
            _ => return false,
        }
        true
    }
}

/// Reads one.
pub(crate) fn read(source: &Source) -> Result<Raster, Refusal> {
    let text = std::fs::read_to_string(source.path).map_err(|error| source.unreadable(&error, GRID))?;
    let in_line = |number: usize, found: &str| format!("which has `{found}` in line {}", number + 1);
    let (mut header, mut values) = (Header::default(), Vec::new());
    let mut in_header = true;
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        if in_header && line.trim_start().starts_with(|c: char| c.is_ascii_alphabetic()) {
            let (name, value) = (words.next().unwrap_or(""), words.next().unwrap_or(""));
            let parsed = value.parse::<f64>().ok().filter(|value| value.is_finite());
            if words.next().is_some() || !parsed.is_some_and(|value| header.take(name, value)) {
                return Err(source.refuse(&in_line(number, line.trim()), "a name of a header and its number"));
            }
            continue;
        }
        in_header &= words.clone().next().is_none();
        for word in words {
            let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
            let value = value.ok_or_else(|| source.refuse(&in_line(number, word), "a number"))?;
            values.push(if header.unknown == Some(value) { f64::NAN } else { value });
        }
    }
    let said = |name: &str, value: Option<f64>| {
        let found = format!("whose header has no `{name}`");
        value.ok_or_else(|| source.refuse(&found, "ncols, nrows, xllcorner, yllcorner and cellsize"))
    };
    let columns = said("ncols", header.columns)?;
    let rows = said("nrows", header.rows)?;
    for (name, count) in [("ncols", columns), ("nrows", rows)] {
        if !(count >= 1.0 && count.fract() == 0.0) {
            return Err(source.refuse(&format!("whose `{name}` is {count}"), "a whole number, 1 or more"));
        }
    }
    if columns * rows != values.len() as f64 {
        let expected = format!("{columns} columns times {rows} rows");
        return Err(source.refuse(&format!("with {} values", values.len()), &expected));
    }
    let cell_m = [said("cellsize", header.cell[0])?, said("cellsize", header.cell[1])?];
    if let Some(cell) = cell_m.iter().find(|cell| **cell <= 0.0) {
        return Err(source.refuse(&format!("whose cells are {cell} m wide"), "more than 0"));
    }
    let centre = |(at, is_centre): (f64, bool), cell: f64| if is_centre { at } else { at + 0.5 * cell };
    let east = said("xllcorner", header.east.map(|east| centre(east, cell_m[0])))?;
    let north = said("yllcorner", header.north.map(|north| centre(north, cell_m[1])))?;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as many as there are values")]
    let columns = columns as usize;
    Ok(Raster::from_north(columns, [east, north], cell_m, &values))
}

#[cfg(test)]
mod tests {
    use headland_plugin::Bounds;
    use std::path::Path;

    const GOOD: &str = "ncols 3\nNROWS 2\nxllcorner 1000\nyllcorner 2000\ncellsize 10\nnodata_value -9999\n\
                        1 2 3\n4 -9999 6\n";

    fn read(text: &str) -> Result<crate::Raster, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("map.asc"), text).unwrap();
        crate::read(folder.path(), "map.asc", None).map_err(|refusal| refusal.to_string())
    }

    #[test]
    fn the_last_row_lies_in_the_south_and_samples_in_the_middle_of_their_cells() {
        let grid = read(GOOD).unwrap();
        assert_eq!(grid.bounds(), Bounds { east_m: [1005.0, 1025.0], north_m: [2005.0, 2015.0] });
        assert_eq!(grid.nearest(1005.0, 2005.0), Some(4.0));
        assert_eq!(grid.nearest(1025.0, 2015.0), Some(3.0));
        assert_eq!(grid.nearest(1015.0, 2005.0), None);
        let centred =
            read(&GOOD.replace("xllcorner", "xllcenter").replace("yllcorner", "yllcenter")).unwrap();
        assert_eq!(centred.bounds().east_m, [1000.0, 1020.0]);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_line() {
        for (from, to, told) in [
            ("4 -9999 6", "4 x 6", "`x` in line 8, expected a number"),
            ("4 -9999 6", "4 6", "with 5 values, expected 3 columns times 2 rows"),
            ("cellsize 10\n", "", "no `cellsize`"),
            ("cellsize 10", "cellsize -10", "-10 m wide"),
            ("NROWS 2", "nrows two", "`nrows two` in line 2"),
            ("ncols 3", "nkols 3", "`nkols 3` in line 1"),
            ("ncols 3", "ncols 2.5", "`ncols` is 2.5"),
        ] {
            let refusal = read(&GOOD.replace(from, to)).unwrap_err();
            assert!(refusal.contains(told), "{refusal}");
        }
        let missing = crate::read(Path::new("nowhere"), "map.asc", None).unwrap_err().to_string();
        assert!(missing.contains("cannot be read"), "{missing}");
        let kind = crate::read(Path::new("nowhere"), "map.bmp", None).unwrap_err().to_string();
        assert!(kind.contains(".asc, .tif or .png"), "{kind}");
    }
}
