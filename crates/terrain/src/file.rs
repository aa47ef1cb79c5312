//! Points of a profile from a CSV file.

use csv::{ReaderBuilder, Trim};
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
    let unreadable = |error: &csv::Error| {
        refuse(
            format!("`{file}`, which cannot be read: {error}"),
            "a CSV file beside the scenario".to_owned(),
        )
    };
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .comment(Some(b'#'))
        .from_path(folder.join(file))
        .map_err(|error| unreadable(&error))?;
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
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| unreadable(&error))?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |column: usize| {
            let text = record.get(places[column]).unwrap_or_default();
            text.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| {
                refuse(
                    format!("`{file}` with `{text}` in line {line}"),
                    format!("a number as {}", COLUMNS[column]),
                )
            })
        };
        points.push((number(0)?, number(1)?));
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
