//! Logs as they were recorded: gzipped or plain CSV.

use crate::error::ConcealError;
use flate2::read::GzDecoder;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A log.
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a log.
    ///
    /// # Errors
    /// [`ConcealError::File`].
    pub fn read(path: &Path) -> Result<Self, ConcealError> {
        let failed = |source| ConcealError::File { path: path.to_owned(), source };
        let mut file = File::open(path).map_err(failed)?;
        let mut bytes = Vec::new();
        if path.extension().is_some_and(|end| end == "gz") {
            GzDecoder::new(file).read_to_end(&mut bytes).map_err(failed)?;
        } else {
            file.read_to_end(&mut bytes).map_err(failed)?;
        }
        // Degree signs are all that is not ASCII; headers are found by what comes before them.
        let text = String::from_utf8_lossy(&bytes);
        let mut lines = text.trim_start_matches('\u{feff}').lines().map(cells);
        let names = lines.next().unwrap_or_default();
        Ok(Self { names, rows: lines.filter(|row| row.len() > 1).collect() })
    }

    /// The cells of a column whose header begins like this.
    pub fn text(&self, header: &str) -> Option<Vec<&str>> {
        let column = self.names.iter().position(|name| name.starts_with(header))?;
        Some(self.rows.iter().map(|row| row.get(column).map_or("", String::as_str)).collect())
    }

    /// The numbers of a column whose header begins like this; NaN where there is none.
    pub fn numbers(&self, header: &str) -> Option<Vec<f64>> {
        let number = |cell: &str| cell.trim().parse().unwrap_or(f64::NAN);
        Some(self.text(header)?.into_iter().map(number).collect())
    }

    /// As [`Table::numbers`].
    ///
    /// # Errors
    /// [`ConcealError::Column`] where there is none.
    pub fn need(&self, path: &Path, header: &str) -> Result<Vec<f64>, ConcealError> {
        let missing = || ConcealError::Column { path: path.to_owned(), column: header.to_owned() };
        self.numbers(header).ok_or_else(missing)
    }
}

/// Cells of a line; quotes may hold commas.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            _ => {
                if let Some(last) = cells.last_mut() {
                    last.push(letter);
                }
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::cells;

    #[test]
    fn quotes_may_hold_a_comma() {
        assert_eq!(cells("\"Time\",\"Wheel,Speed\",3"), ["Time", "Wheel,Speed", "3"]);
    }
}
