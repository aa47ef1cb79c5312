//! How a text log is laid out: delimiter, decimal mark, where its header stands. Guessed where the description is silent.

use crate::cells::{Cell, number};
use crate::clock::{clock_s, date_s, date_time_s};
use crate::column_unit::unit_in_words;
use crate::describe::{DateOrder, Format};
use crate::{Place, RecordingError};
use std::path::Path;

/// Delimiters that are tried, the likelier first.
const DELIMITERS: [u8; 4] = [b'\t', b';', b',', b'|'];

/// Lines that are looked at.
const LOOK_LINES: usize = 400;

/// How a text log is laid out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    /// Between cells.
    pub delimiter: u8,
    /// Whether `1,5` is a number.
    pub decimal_comma: bool,
    /// First character of lines that are passed over.
    pub comment: Option<u8>,
    /// Names of the columns.
    pub header: Vec<String>,
    /// A row of units below the header, where there is one.
    pub units: Vec<String>,
    /// Line of the header, from 1; 0 where the description gives the names.
    pub header_line: usize,
    /// Lines before the first row.
    pub skip: usize,
    /// The first rows.
    pub sample: Vec<Vec<String>>,
}

/// What a description says about a text log.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wanted {
    pub delimiter: Option<u8>,
    pub decimal_comma: Option<bool>,
    pub skip_lines: Option<usize>,
    pub comment: Option<u8>,
    pub names: Option<Vec<String>>,
}

impl Wanted {
    /// Reads a description's `format`, which stands at `at`.
    pub fn of(format: Option<&Format>, at: &Place) -> Result<Self, RecordingError> {
        let Some(Format::Csv { delimiter, decimal, skip_lines, comment, names, .. }) = format else {
            return Ok(Self::default());
        };
        let byte = |field: &str, text: &Option<String>| match text.as_deref().map(str::as_bytes) {
            None => Ok(None),
            Some(b"tab" | b"\\t") => Ok(Some(b'\t')),
            Some([byte]) => Ok(Some(*byte)),
            Some(other) => Err(RecordingError::Value {
                at: at.clone(),
                field: field.to_owned(),
                found: format!("\"{}\"", String::from_utf8_lossy(other)),
                expected: "one character, such as \";\", or \"tab\"".to_owned(),
            }),
        };
        let decimal_comma = match decimal.as_deref() {
            None => None,
            Some(",") => Some(true),
            Some(".") => Some(false),
            Some(other) => {
                return Err(RecordingError::Value {
                    at: at.clone(),
                    field: "decimal".to_owned(),
                    found: format!("\"{other}\""),
                    expected: "\",\" or \".\"".to_owned(),
                });
            }
        };
        Ok(Self {
            delimiter: byte("delimiter", delimiter)?,
            decimal_comma,
            skip_lines: *skip_lines,
            comment: byte("comment", comment)?,
            names: names.clone(),
        })
    }
}

impl Layout {
    /// Looks at the beginning of a log.
    pub fn of(start: &str, path: &Path, wanted: &Wanted) -> Result<Self, RecordingError> {
        let skipped = wanted.skip_lines.unwrap_or(0);
        let lines: Vec<(usize, &str)> = start
            .lines()
            .enumerate()
            .skip(skipped)
            .filter(|(_, line)| !line.trim().is_empty())
            .filter(|(_, line)| wanted.comment.is_none_or(|mark| line.as_bytes().first() != Some(&mark)))
            .take(LOOK_LINES)
            .collect();
        if lines.is_empty() {
            return Err(RecordingError::Empty { at: Place::file(path), what: "the file is empty" });
        }
        let tried: Vec<u8> = wanted.delimiter.map_or_else(|| DELIMITERS.to_vec(), |one| vec![one]);
        let mut best: Option<(f64, u8, Vec<Vec<String>>, usize)> = None;
        for delimiter in tried {
            let rows: Vec<Vec<String>> = lines.iter().map(|(_, line)| cells(line, delimiter)).collect();
            let width = usual_width(&rows);
            let score = score(&rows, width);
            if best.as_ref().is_none_or(|(known, ..)| score > *known) {
                best = Some((score, delimiter, rows, width));
            }
        }
        let Some((_, delimiter, rows, width)) = best else {
            return Err(RecordingError::Empty { at: Place::file(path), what: "the file is empty" });
        };
        let fixed = wanted.skip_lines.is_some() || wanted.names.is_some();
        let head = if wanted.names.is_some() { 0 } else { header_row(&rows, width, fixed) };
        let mut first = head;
        let (header, header_line) = if let Some(names) = &wanted.names {
            (names.clone(), 0)
        } else {
            let found = &rows[head];
            if found.iter().filter(|cell| !cell.is_empty()).all(|cell| is_value(cell)) {
                let at = Place::new(path, lines[head].0 + 1, 1);
                return Err(RecordingError::NoHeader { at, found: found[0].clone() });
            }
            first += 1;
            (names(found), lines[head].0 + 1)
        };
        let mut units = Vec::new();
        if header_line > 0 && rows.get(first).is_some_and(|row| row.len() == header.len() && is_units(row)) {
            units = rows[first].iter().map(|cell| bare_unit(cell).to_owned()).collect();
            first += 1;
        }
        if first >= rows.len() {
            let what = "the file has a header and no rows";
            return Err(RecordingError::Empty { at: Place::new(path, header_line, 0), what });
        }
        let sample = rows[first..].to_vec();
        let decimal_comma =
            wanted.decimal_comma.unwrap_or_else(|| delimiter != b',' && has_decimal_commas(&sample));
        Ok(Self {
            delimiter,
            decimal_comma,
            comment: wanted.comment,
            header,
            units,
            header_line,
            skip: lines[first].0,
            sample,
        })
    }
}

/// The cells of one line.
fn cells(line: &str, delimiter: u8) -> Vec<String> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(delimiter)
        .from_reader(line.as_bytes());
    let mut record = csv::StringRecord::new();
    match reader.read_record(&mut record) {
        Ok(true) => record.iter().map(|cell| cell.trim().to_owned()).collect(),
        _ => vec![line.to_owned()],
    }
}

fn names(row: &[String]) -> Vec<String> {
    let mut names = row.to_vec();
    if let Some(first) = names.first_mut()
        && let Some(bare) = first.strip_prefix('#')
    {
        *first = bare.trim().to_owned();
    }
    names
}

/// Whether a cell of a row of values: a number, a date, a time or nothing.
fn is_value(cell: &str) -> bool {
    !matches!(number(cell, true), Cell::Text)
        || clock_s(cell).is_some()
        || [None, Some(DateOrder::Dmy), Some(DateOrder::Mdy)]
            .into_iter()
            .any(|order| date_s(cell, order).is_some() || date_time_s(cell, order).is_some())
}

fn is_number_or_time(cell: &str) -> bool {
    !cell.is_empty() && is_value(cell)
}

/// The number of cells that most rows have.
fn usual_width(rows: &[Vec<String>]) -> usize {
    let mut widths: Vec<usize> = rows.iter().map(Vec::len).collect();
    widths.sort_unstable();
    let mut best = (0, 0);
    for group in widths.chunk_by(|a, b| a == b) {
        if group.len() >= best.0 {
            best = (group.len(), group[0]);
        }
    }
    best.1
}

/// How well a delimiter explains the rows: values in its cells, rows of one width, more than one column.
fn score(rows: &[Vec<String>], width: usize) -> f64 {
    let even: Vec<&Vec<String>> = rows.iter().filter(|row| row.len() == width).collect();
    let cells = even.iter().map(|row| row.len()).sum::<usize>().max(1);
    let values = even.iter().flat_map(|row| row.iter()).filter(|cell| is_value(cell)).count();
    let share = even.len() as f64 / rows.len() as f64;
    let columns = if width > 1 { 1.0 } else { 0.0 };
    share + values as f64 / cells as f64 + columns
}

/// The row of names: as wide as the rows, without values, and followed by values.
fn header_row(rows: &[Vec<String>], width: usize, fixed: bool) -> usize {
    if fixed {
        return 0;
    }
    let has_values = |row: &Vec<String>| row.iter().any(|cell| is_number_or_time(cell));
    let candidate = (0..rows.len()).find(|index| {
        let row = &rows[*index];
        let next = rows.get(index + 1);
        let after = rows.get(index + 2);
        row.len() == width
            && !has_values(row)
            && next.is_some_and(|next| {
                has_values(next) || (is_units(next) && after.is_none_or(has_values) && next.len() == width)
            })
    });
    candidate.unwrap_or(0)
}

fn bare_unit(cell: &str) -> &str {
    cell.trim().trim_start_matches(['[', '(', '{']).trim_end_matches([']', ')', '}']).trim()
}

/// Whether a row holds units: at least one, and nothing else that is not empty. A `1` is the unit of what has none beside more
/// units than there are of it, though not of the first column: that is a time or a counter.
fn is_units(row: &[String]) -> bool {
    const OF_NONE: &str = "1";
    let texts: Vec<&str> = row.iter().map(|cell| bare_unit(cell)).filter(|unit| !unit.is_empty()).collect();
    let (ones, texts): (Vec<&str>, Vec<&str>) = texts.into_iter().partition(|unit| *unit == OF_NONE);
    let counts = row.first().is_some_and(|cell| bare_unit(cell) == OF_NONE);
    !counts
        && texts.len() > ones.len()
        && texts.iter().all(|unit| unit.parse::<f64>().is_err() && unit_in_words(unit).is_ok())
        && texts.iter().any(|unit| *unit != "-")
}

/// Whether numbers are written with commas: some cells are, and none has a point.
fn has_decimal_commas(rows: &[Vec<String>]) -> bool {
    let cells = || rows.iter().flatten().filter(|cell| matches!(number(cell, true), Cell::Number(_)));
    cells().any(|cell| cell.contains(',')) && !cells().any(|cell| cell.contains('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(text: &str) -> Result<Layout, RecordingError> {
        Layout::of(text, Path::new("log.csv"), &Wanted::default())
    }

    #[test]
    fn delimiter_and_decimal_mark_are_seen_together() {
        for (text, delimiter, comma) in [
            ("a,b\n1.5,2\n2.5,3\n", b',', false),
            ("a;b\n1,5;2,25\n2,5;3\n", b';', true),
            ("a\tb\n1,5\t2\n", b'\t', true),
            ("a|b\n1|2\n", b'|', false),
            ("\"Wheel,Speed\",b\n1,2\n", b',', false),
        ] {
            let found = layout(text).unwrap();
            assert_eq!((found.delimiter, found.decimal_comma), (delimiter, comma), "{text}");
            assert_eq!(found.header.len(), 2, "{text}");
        }
    }

    #[test]
    fn preamble_and_a_row_of_units_are_passed_over() {
        let text =
            "Logger v2, serial 17\nDriver;Smith\n\nTime;Speed;Mode\n[s];[km/h];\n0,0;3,5;N\n0,1;3,6;N\n";
        let found = layout(text).unwrap();
        assert_eq!(found.header, ["Time", "Speed", "Mode"]);
        assert_eq!(found.units, ["s", "km/h", ""]);
        assert_eq!((found.header_line, found.skip), (4, 5));
    }

    #[test]
    fn a_one_among_units_is_that_of_a_number_and_no_value() {
        let found = layout("time,speed,force,coasting\ns,m/s,N,1\n0,3,20,1\n").unwrap();
        assert_eq!(
            (found.units.as_slice(), found.skip),
            (["s", "m/s", "N", "1"].map(String::from).as_slice(), 2)
        );
        // A first row of a gear lever in neutral, or of a counter.
        for rows in ["gear,coasting\nN,1\nN,1\n", "count,gear,mode\n1,N,A\n2,N,A\n"] {
            assert!(layout(rows).unwrap().units.is_empty(), "{rows}");
        }
    }

    #[test]
    fn a_log_without_names_is_refused_unless_they_are_given() {
        assert!(matches!(layout("0,1\n1,2\n"), Err(RecordingError::NoHeader { .. })));
        let names = Some(vec!["time_s".to_owned(), "speed_m_s".to_owned()]);
        let found = Layout::of("0,1\n1,2\n", Path::new("x"), &Wanted { names, ..Wanted::default() }).unwrap();
        assert_eq!((found.skip, found.sample.len()), (0, 2));
    }

    #[test]
    fn emptiness_has_two_names() {
        assert!(layout("").unwrap_err().to_string().contains("the file is empty"));
        assert!(layout(" \n\n").unwrap_err().to_string().contains("the file is empty"));
        assert!(layout("time_s,speed_m_s\n").unwrap_err().to_string().contains("a header and no rows"));
    }
}
