//! Where the time of a row comes from.

use crate::cells::{Cell, number};
use crate::clock::{DAY_S, clock_s, date_s, date_time_s, order_of};
use crate::column_unit::{Header, key, unit_in_words};
use crate::describe::{DateOrder, TimeDescription};
use crate::plan::Columns;
use crate::{Notice, NoticeKind, Place, RecordingError};
use headland_units::{Dimension, Unit, parse_unit};

/// How a row tells its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TimePlan {
    /// Not at all: rows are this far apart (s).
    Period(f64),
    /// A number of this many seconds each; counted from the first row where it is an epoch.
    Number { column: usize, unit_s: f64, epoch: bool },
    /// A date and a clock time in one cell.
    DateTime { column: usize, order: Option<DateOrder> },
    /// A date and a clock time in two cells.
    DateAndClock { date: usize, clock: usize, order: Option<DateOrder> },
    /// A clock time alone; past midnight it goes on.
    Clock { column: usize },
}

/// Headers that mean time, as `key` writes them.
const NAMES: &[(&str, &str)] = &[
    ("time", "s"),
    ("t", "s"),
    ("timestamp", "s"),
    ("timestamps", "s"),
    ("datetime", "s"),
    ("date_time", "s"),
    ("elapsed_time", "s"),
    ("elapsed", "s"),
    ("epoch", "s"),
    ("utc", "s"),
    ("gps_time", "s"),
    ("zeit", "s"),
    ("seconds", "s"),
    ("secs", "s"),
    ("sec", "s"),
    ("milliseconds", "ms"),
    ("millis", "ms"),
    ("minutes", "min"),
    ("hours", "h"),
];

/// Seconds since 1970 from which a number is an epoch: 2001-09-09.
const EPOCH_FROM: f64 = 1e9;

impl TimePlan {
    /// Columns that it reads.
    pub fn columns(&self) -> Vec<usize> {
        match *self {
            Self::Period(_) => Vec::new(),
            Self::Number { column, .. } | Self::DateTime { column, .. } | Self::Clock { column } => {
                vec![column]
            }
            Self::DateAndClock { date, clock, .. } => vec![date, clock],
        }
    }

    /// The time that a row tells, from a row that told `origin`: to the microsecond where both are far from zero, as
    /// more digits of a date are not held by a double.
    pub fn since(&self, origin: f64, now: f64) -> f64 {
        match *self {
            Self::Number { unit_s, epoch: false, .. } => now * unit_s + 0.0,
            Self::Number { unit_s, .. } => microseconds((now - origin) * unit_s),
            Self::Period(_) => now,
            _ => microseconds(now - origin),
        }
    }

    /// What a row tells, in its own unit; the column that does not, and what was expected of it.
    pub fn read<'a>(
        &self,
        row: usize,
        comma: bool,
        cell: impl Fn(usize) -> &'a str,
    ) -> Result<f64, (usize, &'static str)> {
        match *self {
            Self::Period(period_s) => Ok(row as f64 * period_s),
            Self::Number { column, .. } => match number(cell(column), comma) {
                Cell::Number(value) => Ok(value),
                _ => Err((column, "a time as a number")),
            },
            Self::DateTime { column, order } => date_time_s(cell(column), order)
                .ok_or((column, "a date and a time, as in 2023-10-23 06:50:50")),
            Self::DateAndClock { date, clock, order } => {
                let day = date_s(cell(date), order).ok_or((
                    date,
                    "a date; where dates are damaged, `time: (clock: \"...\")` does without them",
                ))?;
                Ok(day + clock_s(cell(clock)).ok_or((clock, "a clock time, as in 06:50:50.2"))?)
            }
            Self::Clock { column } => clock_s(cell(column)).ok_or((column, "a clock time, as in 06:50:50.2")),
        }
    }

    /// A clock that has passed midnight since the row before goes on.
    pub fn after(&self, before_s: f64, mut now_s: f64) -> f64 {
        if let Self::Clock { .. } = self {
            while now_s < before_s - DAY_S / 2.0 {
                now_s += DAY_S;
            }
        }
        now_s
    }

    /// Finds out how the rows of a log tell their time.
    pub fn of(
        described: Option<(&TimeDescription, &Place)>,
        columns: &Columns<'_>,
        sample: &[Vec<String>],
        comma: bool,
        run: &str,
        notices: &mut Vec<Notice>,
    ) -> Result<Self, RecordingError> {
        let default = TimeDescription::default();
        let header = Place::new(columns.path, columns.line, 0);
        let (wanted, at) = described.unwrap_or((&default, &header));
        if let Some(period_s) = wanted.period_s {
            if !(period_s > 0.0 && period_s.is_finite()) {
                return Err(RecordingError::Value {
                    at: at.clone(),
                    field: "period_s".to_owned(),
                    found: period_s.to_string(),
                    expected: "seconds between rows, more than 0".to_owned(),
                });
            }
            return Ok(Self::Period(period_s));
        }
        let find = |name: &Option<String>| name.as_ref().map(|name| columns.need(name, at)).transpose();
        if let Some(clock) = find(&wanted.clock)? {
            return match find(&wanted.date)? {
                Some(date) => {
                    let order = order(wanted.order, date, columns, sample, |cell| order_of(cell).is_some())?;
                    Ok(Self::DateAndClock { date, clock, order })
                }
                None => Ok(Self::Clock { column: clock }),
            };
        }
        let column = match find(&wanted.column)? {
            Some(column) => column,
            None => guess(columns).ok_or_else(|| RecordingError::NoTime {
                at: Place::new(columns.path, columns.line, 0),
                present: columns.list(),
            })?,
        };
        let first = sample
            .iter()
            .filter_map(|row| row.get(column))
            .find(|cell| !matches!(number(cell, comma), Cell::Missing))
            .map_or("", String::as_str);
        if let Cell::Number(value) = number(first, comma) {
            return numeric(wanted, at, columns, column, value, run, notices);
        }
        if clock_s(first).is_some() {
            let date = match find(&wanted.date)? {
                Some(date) => Some(date),
                None => columns
                    .names
                    .iter()
                    .position(|name| matches!(key(name).as_str(), "date" | "datum" | "day")),
            };
            return Ok(match date {
                Some(date) => {
                    let order = order(wanted.order, date, columns, sample, |cell| order_of(cell).is_some())?;
                    Self::DateAndClock { date, clock: column, order }
                }
                None => Self::Clock { column },
            });
        }
        let whole = |cell: &str| date_time_s(cell, None).is_some();
        let order = order(wanted.order, column, columns, sample, whole)?;
        Ok(Self::DateTime { column, order })
    }
}

fn microseconds(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// The column whose header means time: `time_s`, else the first of the names that are known.
fn guess(columns: &Columns<'_>) -> Option<usize> {
    columns.names.iter().position(|name| name == "time_s").or_else(|| {
        columns.names.iter().position(|name| NAMES.iter().any(|(known, _)| Header::of(name).key() == *known))
    })
}

fn numeric(
    wanted: &TimeDescription,
    at: &Place,
    columns: &Columns<'_>,
    column: usize,
    first: f64,
    run: &str,
    notices: &mut Vec<Notice>,
) -> Result<TimePlan, RecordingError> {
    let read = |text: &str| -> Result<Unit, RecordingError> {
        let unit = unit_in_words(text).map_err(|text| RecordingError::Unit {
            at: at.clone(),
            reason: parse_unit(&text).map_or_else(|error| error.to_string(), |_| String::new()),
            text,
        })?;
        fits(unit, at)
    };
    let unit_s = match (&wanted.unit, columns.unit(column)) {
        (Some(text), _) => read(text)?.factor,
        (None, Some(Ok(unit))) => fits(unit, at)?.factor,
        (None, Some(Err(text))) => read(&text)?.factor,
        (None, None) => {
            // Epochs of 2001 and later in seconds, milli-, micro- or nanoseconds lie three digits apart.
            let guessed =
                [(1e18, "ns", 1e-9), (1e15, "µs", 1e-6), (1e12, "ms", 1e-3), (EPOCH_FROM, "s", 1.0)];
            if let Some((_, symbol, factor)) = guessed.iter().find(|(from, ..)| first.abs() >= *from) {
                let text = format!("`{}` is taken to be {symbol} since 1970", columns.names[column]);
                notices.push(Notice::new(run, NoticeKind::Assumed, text));
                *factor
            } else {
                let key = Header::of(&columns.names[column]).key();
                let unit = NAMES.iter().find(|(name, _)| *name == key).map_or("s", |(_, unit)| unit);
                let text = format!("`{}` is taken to be in {unit}", columns.names[column]);
                notices.push(Notice::new(run, NoticeKind::Assumed, text));
                read(unit)?.factor
            }
        }
    };
    Ok(TimePlan::Number { column, unit_s, epoch: (first * unit_s).abs() >= EPOCH_FROM })
}

fn fits(unit: Unit, at: &Place) -> Result<Unit, RecordingError> {
    if unit.dimension == Dimension::of(0, 0, 1, 0, 0, 0) {
        return Ok(unit);
    }
    Err(RecordingError::UnitMisfit {
        at: at.clone(),
        unit: unit.symbol,
        channel: "time_s".to_owned(),
        expected: "s".to_owned(),
    })
}

/// The order of day and month: as described, else as the first row that shows it.
fn order(
    wanted: Option<DateOrder>,
    column: usize,
    columns: &Columns<'_>,
    sample: &[Vec<String>],
    clear: impl Fn(&str) -> bool,
) -> Result<Option<DateOrder>, RecordingError> {
    if wanted.is_some() {
        return Ok(wanted);
    }
    let cells = || sample.iter().filter_map(|row| row.get(column));
    let shown = cells()
        .find(|cell| clear(cell))
        .and_then(|cell| order_of(cell.split(['T', ' ']).next().unwrap_or_default()));
    if shown.is_some() {
        return Ok(shown);
    }
    match cells().find(|cell| {
        date_s(cell.split(['T', ' ']).next().unwrap_or_default(), Some(DateOrder::Dmy)).is_some()
    }) {
        Some(found) => Err(RecordingError::DateOrder {
            at: Place::new(columns.path, columns.line + 1, 0),
            column: columns.names[column].clone(),
            found: found.clone(),
        }),
        None => Ok(None),
    }
}
