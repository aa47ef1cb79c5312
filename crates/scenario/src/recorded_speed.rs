//! A recorded drive: speed over time from a CSV file.

use csv::{ReaderBuilder, Trim};
use std::path::Path;

/// The columns that the file has to have; others are passed over.
const COLUMNS: [&str; 2] = ["time_s", "speed_m_s"];

/// Times [s] and speeds [m/s] of a file, the times as they were recorded.
///
/// # Errors
/// What was found and what was expected.
pub fn read(path: &Path, name: &str) -> Result<(Vec<f64>, Vec<f64>), (String, String)> {
    let unreadable = |error: &csv::Error| {
        (format!("`{name}`, which cannot be read: {error}"), "a CSV file beside the scenario".to_owned())
    };
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .comment(Some(b'#'))
        .from_path(path)
        .map_err(|error| unreadable(&error))?;
    let headers = reader.headers().map_err(|error| unreadable(&error))?.clone();
    let mut places = [0; COLUMNS.len()];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        let found = headers.iter().position(|header| header == column);
        *place = found.ok_or_else(|| {
            let all: Vec<&str> = headers.iter().collect();
            (format!("`{name}` with the columns {}", all.join(", ")), format!("a column {column}"))
        })?;
    }
    let (mut times, mut speeds) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| unreadable(&error))?;
        for ((place, column), list) in places.iter().zip(COLUMNS).zip([&mut times, &mut speeds]) {
            let text = record.get(*place).unwrap_or_default();
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| {
                let line = record.position().map_or(0, csv::Position::line);
                (format!("`{name}` with `{text}` in line {line}"), format!("a number as {column}"))
            })?;
            list.push(value);
        }
    }
    Ok((times, speeds))
}
