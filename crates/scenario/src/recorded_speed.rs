//! A recorded drive: speed over time from a CSV file.

use csv::{ReaderBuilder, StringRecord, Trim};
use std::path::Path;

/// The columns that the file has to have; others are passed over.
const COLUMNS: [&str; 2] = ["time_s", "speed_m_s"];

/// Times [s] and speeds [m/s] of a file, the times as they were recorded.
///
/// # Errors
/// What was found and what was expected.
pub fn read(path: &Path, name: &str) -> Result<(Vec<f64>, Vec<f64>), (String, String)> {
    let unreadable = |error: &dyn std::fmt::Display| {
        (format!("`{name}`, which cannot be read: {error}"), "a CSV file beside the scenario".to_owned())
    };
    let text = std::fs::read_to_string(path).map_err(|error| unreadable(&error))?;
    // Line feeds are counted: each line ends with one, and with nothing else.
    let text = text.replace("\r\n", "\n").replace('\r', "\n") + "\n";
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
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
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(|error| unreadable(&error))? {
        // Where a row begins counts blank lines and comments before it; where it ends is the line behind it.
        let line = reader.position().line() - 1;
        for ((place, column), list) in places.iter().zip(COLUMNS).zip([&mut times, &mut speeds]) {
            let text = record.get(*place).unwrap_or_default();
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| {
                (format!("`{name}` with `{text}` in line {line}"), format!("a number as {column}"))
            })?;
            list.push(value);
        }
        let refuse = |what: String, expected: &str| {
            Err((format!("`{name}` with {what} in line {line}"), expected.to_owned()))
        };
        match (times.as_slice(), speeds.last()) {
            ([.., before, now], _) if now <= before => {
                return refuse(format!("{now} s after {before} s"), "increasing times");
            }
            (_, Some(speed)) if *speed < 0.0 => {
                return refuse(format!("{speed} m/s"), "a speed of 0 or more");
            }
            _ => {}
        }
    }
    Ok((times, speeds))
}
