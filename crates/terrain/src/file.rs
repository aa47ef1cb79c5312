//! Points of a profile from a CSV file.

use csv::{ReaderBuilder, StringRecord, Trim};
use headland_plugin::Refusal;
use std::path::Path;

/// The columns that a profile's file has to have; others are passed over.
const COLUMNS: [&str; 2] = ["position_m", "elevation_m"];

/// Reads position and elevation from `folder/file`.
///
/// # Errors
/// [`Refusal`] of the parameter `file` names the line and what it found.
pub(crate) fn read(folder: &Path, file: &str) -> Result<Vec<(f64, f64)>, Refusal> {
    let refuse = |found: String, expected: String| Refusal { parameter: "file".to_owned(), found, expected };
    let unreadable = |error: &dyn std::fmt::Display| {
        refuse(
            format!("`{file}`, which cannot be read: {error}"),
            "a CSV file beside the scenario".to_owned(),
        )
    };
    let text = std::fs::read_to_string(folder.join(file)).map_err(|error| unreadable(&error))?;
    // Line feeds are counted: each line ends with one, and with nothing else.
    let text = text.replace("\r\n", "\n").replace('\r', "\n") + "\n";
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|error| unreadable(&error))?.clone();
    let place = |name: &str| {
        headers.iter().position(|header| header == name).ok_or_else(|| {
            let found: Vec<&str> = headers.iter().collect();
            refuse(
                format!("`{file}` with the columns {}", found.join(", ")),
                format!("the columns {} and {}", COLUMNS[0], COLUMNS[1]),
            )
        })
    };
    let places = [place(COLUMNS[0])?, place(COLUMNS[1])?];
    let mut points: Vec<(f64, f64)> = Vec::new();
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| unreadable(&error))? {
        // Where a row begins counts blank lines and comments before it; where it ends is the line behind it.
        let line = reader.position().line() - 1;
        let number = |column: usize| {
            let text = record.get(places[column]).unwrap_or_default();
            text.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| {
                refuse(
                    format!("`{file}` with `{text}` in line {line}"),
                    format!("a number as {}", COLUMNS[column]),
                )
            })
        };
        let (position_m, elevation_m) = (number(0)?, number(1)?);
        if let Some((before_m, _)) = points.last().filter(|(before_m, _)| *before_m >= position_m) {
            return Err(refuse(
                format!("`{file}` at {position_m} m after {before_m} m in line {line}"),
                "positions that increase".to_owned(),
            ));
        }
        points.push((position_m, elevation_m));
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn read_text(text: &str) -> Result<Vec<(f64, f64)>, String> {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("x.csv"), text).unwrap();
        read(folder.path(), "x.csv").map_err(|refusal| refusal.to_string())
    }

    #[test]
    fn columns_are_found_by_name_in_any_order() {
        let points = read_text("# surveyed\nelevation_m, note, position_m\n1.5, a, 0\n2.5, b, 10\n").unwrap();
        assert_eq!(points, [(0.0, 1.5), (10.0, 2.5)]);
    }

    #[test]
    fn text_in_a_number_is_refused_with_its_line() {
        let message = read_text("position_m,elevation_m\n0,1\n10,high\n").unwrap_err();
        assert_eq!(message, "`file` is `x.csv` with `high` in line 3, expected a number as elevation_m");
        assert!(read_text("position_m,elevation_m\n0,NaN\n").is_err());
    }

    /// A reader that counts line feeds as they are read stands one line before a row of a file from Windows.
    #[test]
    fn lines_are_counted_alike_however_they_end_and_whatever_stands_between() {
        let text = "# surveyed\nposition_m,elevation_m\n0,1\n\n# a bridge\n10,high\n";
        for ends in ["\n", "\r\n", "\r"] {
            let message = read_text(&text.replace('\n', ends)).unwrap_err();
            assert!(message.contains("`high` in line 6"), "{message}");
        }
    }

    #[test]
    fn positions_that_do_not_increase_are_refused_with_their_line() {
        let message = read_text("position_m,elevation_m\r\n0,1\r\n10,2\r\n5,3\r\n").unwrap_err();
        assert_eq!(
            message,
            "`file` is `x.csv` at 5 m after 10 m in line 4, expected positions that increase"
        );
    }

    #[test]
    fn a_missing_column_is_refused_with_those_that_were_found() {
        let message = read_text("position_m,height\n0,1\n").unwrap_err();
        assert!(message.contains("position_m, height") && message.contains("elevation_m"), "{message}");
    }

    #[test]
    fn rows_of_uneven_length_and_missing_files_are_refused() {
        assert!(read_text("position_m,elevation_m\n0,1\n10\n").is_err());
        assert!(read(Path::new("."), "no such file.csv").is_err());
    }
}
