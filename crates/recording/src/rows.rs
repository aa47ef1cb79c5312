//! The rows of a text log, streamed into columns.

use crate::cells::{Cell, number};
use crate::ends::LineEnds;
use crate::layout::Layout;
use crate::plan::Plan;
use crate::source::failed;
use crate::{Notice, NoticeKind, Place, RecordingError};
use csv::StringRecord;
use std::io::Read;
use std::path::Path;

/// What a log's rows hold: strictly increasing times and one column a channel.
#[derive(Debug, Default)]
pub(crate) struct Table {
    pub time_s: Vec<f64>,
    /// As many as the plan has outputs; `None` for a column that turned out to be text.
    pub columns: Vec<Option<Vec<f64>>>,
}

/// A log that is being read.
pub(crate) struct Rows<'a> {
    path: &'a Path,
    layout: &'a Layout,
    plan: &'a Plan,
    run: &'a str,
    table: Table,
    numbers_seen: Vec<bool>,
    read: usize,
    origin: Option<f64>,
    repeats: usize,
    first_repeat: (f64, usize),
    without_values: usize,
}

impl<'a> Rows<'a> {
    pub fn new(path: &'a Path, layout: &'a Layout, plan: &'a Plan, run: &'a str) -> Self {
        let outputs = plan.outputs.len();
        Self {
            path,
            layout,
            plan,
            run,
            table: Table { time_s: Vec::new(), columns: vec![Some(Vec::new()); outputs] },
            numbers_seen: vec![false; outputs],
            read: 0,
            origin: None,
            repeats: 0,
            first_repeat: (0.0, 0),
            without_values: 0,
        }
    }

    /// Reads all rows, or the first `limit`.
    pub fn read(
        mut self,
        stream: impl Read,
        limit: Option<usize>,
        notices: &mut Vec<Notice>,
    ) -> Result<Table, RecordingError> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(self.layout.delimiter)
            .comment(self.layout.comment)
            .buffer_capacity(1 << 16)
            .from_reader(LineEnds::new(stream));
        let mut record = StringRecord::new();
        let mut line = self.layout.skip;
        while limit.is_none_or(|limit| self.read < limit) {
            match reader.read_record(&mut record) {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => return Err(stopped(self.path, line, error)),
            }
            // Where a record begins counts blank lines and comments before it; where it ends is the line behind it.
            let behind = usize::try_from(reader.position().line()).unwrap_or(0);
            let within = record.iter().map(|cell| cell.matches('\n').count()).sum::<usize>();
            // A quotation that is never closed has no line behind it.
            let unclosed = record.iter().next_back().is_some_and(|cell| cell.ends_with('\n'));
            line = self.layout.skip + (behind + usize::from(unclosed)).saturating_sub(1 + within);
            if record.len() == 1 && record[0].trim().is_empty() {
                continue;
            }
            self.row(&record, line, notices)?;
        }
        self.tell(notices);
        if self.table.time_s.is_empty() {
            let at = Place::new(self.path, self.layout.header_line, 0);
            return Err(RecordingError::Empty { at, what: "the file has a header and no rows" });
        }
        Ok(self.table)
    }

    fn row(
        &mut self,
        record: &StringRecord,
        line: usize,
        notices: &mut Vec<Notice>,
    ) -> Result<(), RecordingError> {
        if record.len() != self.layout.header.len() {
            let at = Place::new(self.path, line, 0);
            return Err(RecordingError::Uneven {
                at,
                found: record.len(),
                expected: self.layout.header.len(),
            });
        }
        if record.iter().all(|cell| cell.trim().is_empty()) {
            self.without_values += 1;
            return Ok(());
        }
        let comma = self.layout.decimal_comma;
        let mut now_s = self
            .plan
            .time
            .read(self.read, comma, |column| &record[column])
            .map_err(|(column, expected)| self.cell(record, line, column, expected))?;
        now_s = self.plan.time.since(*self.origin.get_or_insert(now_s), now_s);
        self.read += 1;
        if let Some(before_s) = self.table.time_s.last().copied() {
            now_s = self.plan.time.after(before_s, now_s);
            if now_s < before_s {
                let at = Place::new(self.path, line, 0);
                return Err(RecordingError::Backwards { at, before_s, after_s: now_s });
            }
            if now_s == before_s {
                if self.repeats == 0 {
                    self.first_repeat = (now_s, line);
                }
                self.repeats += 1;
                return Ok(());
            }
        }
        self.table.time_s.push(now_s);
        for (index, output) in self.plan.outputs.iter().enumerate() {
            let Some(kept) = &mut self.table.columns[index] else { continue };
            let mut text = None;
            let value =
                output.value(output.columns.iter().map(|column| match number(&record[*column], comma) {
                    Cell::Number(value) => value,
                    Cell::Missing => f64::NAN,
                    Cell::Text => {
                        text = text.or(Some(*column));
                        f64::NAN
                    }
                }));
            if let Some(column) = text {
                if output.strict || self.numbers_seen[index] {
                    return Err(self.cell(
                        record,
                        line,
                        column,
                        "a number, or nothing where there is no value",
                    ));
                }
                self.table.columns[index] = None;
                let found = record[column].trim();
                let text = format!("column `{}` holds text (`{found}`) and is left out", output.name);
                notices.push(Notice::new(self.run, NoticeKind::Text, text).channel(&output.name));
                continue;
            }
            self.numbers_seen[index] |= !value.is_nan();
            kept.push(value);
        }
        Ok(())
    }

    fn cell(
        &self,
        record: &StringRecord,
        line: usize,
        column: usize,
        expected: &'static str,
    ) -> RecordingError {
        // Where the cell starts, as far as the cells before it stand without quotes.
        let character = record.iter().take(column).map(|cell| cell.chars().count() + 1).sum::<usize>() + 1;
        RecordingError::Cell {
            at: Place::new(self.path, line, character),
            column: self.layout.header[column].clone(),
            found: shortened(&record[column]),
            expected,
        }
    }

    fn tell(&self, notices: &mut Vec<Notice>) {
        if self.repeats > 0 {
            let mut text = format!(
                "rows that repeat the time of the row before are left out: {}, the first in line {}",
                self.repeats, self.first_repeat.1
            );
            if self.repeats > self.table.time_s.len() {
                text.push_str(
                    "; the clock is coarser than the rows, `time: (period_s: ...)` would keep them",
                );
            }
            let notice = Notice::new(self.run, NoticeKind::Repeated, text).count(self.repeats);
            notices.push(notice.first(self.first_repeat.0));
        }
        if self.without_values > 0 {
            let text = format!("rows without any value are left out: {}", self.without_values);
            notices.push(Notice::new(self.run, NoticeKind::Nan, text).count(self.without_values));
        }
    }
}

/// The first line of a cell, if it is no longer than a line that one reads: a quotation mark that is never closed takes in all the
/// rest of a file.
fn shortened(cell: &str) -> String {
    const MOST: usize = 60;
    let first = cell.trim().lines().next().unwrap_or_default();
    let short: String = first.chars().take(MOST).collect();
    if short.len() < cell.trim().len() { format!("{short}…") } else { short }
}

fn stopped(path: &Path, line: usize, error: csv::Error) -> RecordingError {
    let text = error.to_string();
    match error.into_kind() {
        csv::ErrorKind::Io(error) => failed(path, line, &error),
        _ => RecordingError::Read { at: Place::new(path, line, 0), reason: text },
    }
}
