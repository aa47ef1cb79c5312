//! The rows of a text log, streamed into columns.

use crate::cells::{Cell, number};
use crate::layout::Layout;
use crate::plan::Plan;
use crate::source::failed;
use crate::{Notice, NoticeKind, Place, RecordingError};
use std::io::Read;
use std::path::Path;

/// What a log's rows hold: strictly increasing times and one column a channel.
#[derive(Debug, Default)]
pub(crate) struct Table {
    pub time_s: Vec<f64>,
    /// As many as the plan has outputs; `None` for a column that turned out to be text.
    pub columns: Vec<Option<Vec<f64>>>,
}

/// A row that repeats a time.
#[derive(Default)]
struct Repeats {
    count: usize,
    first_s: f64,
    first_line: usize,
}

/// Reads all rows, or the first `limit`.
pub(crate) fn read(
    stream: impl Read,
    path: &Path,
    layout: &Layout,
    plan: &Plan,
    limit: Option<usize>,
    run: &str,
    notices: &mut Vec<Notice>,
) -> Result<Table, RecordingError> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(layout.delimiter)
        .comment(layout.comment)
        .buffer_capacity(1 << 16)
        .from_reader(stream);
    let mut record = csv::StringRecord::new();
    let mut table = Table { time_s: Vec::new(), columns: vec![Some(Vec::new()); plan.outputs.len()] };
    let mut numbers_seen = vec![false; plan.outputs.len()];
    let mut repeats = Repeats::default();
    let (mut empty_rows, mut row, mut line, mut origin_s) = (0, 0, layout.skip, None);
    while limit.is_none_or(|limit| row < limit) {
        match reader.read_record(&mut record) {
            Ok(true) => {}
            Ok(false) => break,
            Err(error) => return Err(stopped(path, line, error)),
        }
        line = layout.skip
            + record.position().map_or(0, |position| usize::try_from(position.line()).unwrap_or(0));
        if record.len() == 1 && record[0].trim().is_empty() {
            continue;
        }
        if record.len() != layout.header.len() {
            let at = Place::new(path, line, 0);
            return Err(RecordingError::Uneven { at, found: record.len(), expected: layout.header.len() });
        }
        if record.iter().all(|cell| cell.trim().is_empty()) {
            empty_rows += 1;
            continue;
        }
        let cell_error = |column: usize, expected| RecordingError::Cell {
            at: Place::new(path, line, character(&record, column)),
            column: layout.header[column].clone(),
            found: record[column].trim().to_owned(),
            expected,
        };
        let mut now_s = plan
            .time
            .seconds(row, layout.decimal_comma, |column| &record[column])
            .map_err(|(column, expected)| cell_error(column, expected))?;
        let origin = *origin_s.get_or_insert(if plan.time.from_first() { now_s } else { 0.0 });
        row += 1;
        now_s -= origin;
        if let Some(before_s) = table.time_s.last().copied() {
            now_s = plan.time.after(before_s, now_s);
            if now_s < before_s {
                return Err(RecordingError::Backwards {
                    at: Place::new(path, line, 0),
                    before_s,
                    after_s: now_s,
                });
            }
            if now_s == before_s {
                if repeats.count == 0 {
                    (repeats.first_s, repeats.first_line) = (now_s, line);
                }
                repeats.count += 1;
                continue;
            }
        }
        table.time_s.push(now_s);
        for (index, (output, kept)) in plan.outputs.iter().zip(&mut table.columns).enumerate() {
            let Some(values) = kept else { continue };
            let text = output
                .columns
                .iter()
                .find(|column| number(&record[**column], layout.decimal_comma) == Cell::Text);
            if let Some(column) = text {
                if output.strict || numbers_seen[index] {
                    return Err(cell_error(*column, "a number, or nothing where there is no value"));
                }
                *kept = None;
                let text = format!(
                    "column `{}` holds text (`{}`) and is left out",
                    output.name,
                    record[*column].trim()
                );
                notices.push(Notice::new(run, NoticeKind::Text, text).channel(&output.name));
                continue;
            }
            let cells =
                output.columns.iter().map(|column| match number(&record[*column], layout.decimal_comma) {
                    Cell::Number(value) => value,
                    _ => f64::NAN,
                });
            let value = output.value(cells);
            numbers_seen[index] |= !value.is_nan();
            values.push(value);
        }
    }
    if table.time_s.is_empty() {
        let what = "the file has a header and no rows";
        return Err(RecordingError::Empty { at: Place::new(path, layout.header_line, 0), what });
    }
    if repeats.count > 0 {
        let mut text = format!(
            "{} rows repeat the time of the row before and are left out; the first is line {}",
            repeats.count, repeats.first_line
        );
        if repeats.count > table.time_s.len() {
            text.push_str("; the clock is coarser than the rows, `time: (period_s: ...)` would keep them");
        }
        notices
            .push(Notice::new(run, NoticeKind::Repeated, text).count(repeats.count).first(repeats.first_s));
    }
    if empty_rows > 0 {
        let text = format!("{empty_rows} rows hold nothing and are left out");
        notices.push(Notice::new(run, NoticeKind::Nan, text).count(empty_rows));
    }
    Ok(table)
}

/// Where in its line a cell starts, as far as the cells before it stand without quotes.
fn character(record: &csv::StringRecord, column: usize) -> usize {
    record.iter().take(column).map(|cell| cell.chars().count() + 1).sum::<usize>() + 1
}

fn stopped(path: &Path, line: usize, error: csv::Error) -> RecordingError {
    let text = error.to_string();
    match error.into_kind() {
        csv::ErrorKind::Io(error) => failed(path, line, &error),
        _ => RecordingError::Read { at: Place::new(path, line, 0), reason: text },
    }
}
