//! From a description to its runs.

use crate::correct::correct;
use crate::describe::{Format, Purpose, TimeDescription};
use crate::layout::{Layout, Wanted};
use crate::plan::{Columns, Plan, outputs};
use crate::rows::Rows;
use crate::source::{Source, open};
use crate::time_plan::TimePlan;
use crate::validate::Described;
use crate::{
    Check, CheckedRun, Notice, NoticeKind, Place, RecordedRun, Recording, RecordingError, Sensor, cut,
    folder, look, parquet_log,
};
use headland_trace::{Origin, Trace};
use std::path::{Path, PathBuf};

/// Rows of each log that a check looks at.
const CHECKED_ROWS: usize = 1000;

/// One log, read: traces by the name that they have in it, how it was read, and what was seen.
pub(crate) struct Log {
    /// A text log is one trace without a name; a Parquet file may hold several runs.
    pub traces: Vec<(Option<String>, Trace)>,
    pub sensors: Vec<(String, Sensor)>,
    pub format: String,
}

/// Reads the runs of a description.
///
/// # Errors
/// [`RecordingError`]: the description or one of its logs cannot be used; it says what, where, and what was expected.
pub fn load(path: &Path) -> Result<Recording, RecordingError> {
    let described = Described::read(path)?;
    let mut notices = notes(&described);
    let mut runs: Vec<RecordedRun> = Vec::new();
    for index in 0..described.text.runs.len() {
        let (_, log) = read_log(&described, index, None, &mut notices)?;
        let run = &described.text.runs[index];
        for (name, trace) in log.traces {
            let id = name.map_or_else(|| run.id.clone(), |name| format!("{}.{name}", run.id));
            look::at_log(&trace, &id, &mut notices);
            let trace = correct(trace, &log.sensors).map_err(|source| broken(&described, index, source))?;
            let split = run.split.as_ref().or(described.text.split.as_ref());
            let span = span(&trace);
            let pieces = cut::pieces(trace, &run.segments, split, &id, &mut notices);
            let several = pieces.len() > 1;
            for (number, piece) in pieces.into_iter().enumerate() {
                if piece.len() < 2 {
                    let at = described.at(&format!("runs[{index}].segments[{number}]"));
                    return Err(RecordingError::Value {
                        at,
                        field: format!("segment {} of `{id}`", number + 1),
                        found: format!("{} rows", piece.len()),
                        expected: format!("at least 2; the log goes from {span}"),
                    });
                }
                let id = if several { format!("{id}.{}", number + 1) } else { id.clone() };
                look::at_run(&piece, &id, &mut notices);
                runs.push(RecordedRun {
                    id,
                    trace: piece,
                    path: run.path.clone(),
                    reversed: run.reversed,
                    held_out: run.purpose == Purpose::HeldOut,
                    known: described.known(Some(index))?,
                    sensors: log.sensors.clone(),
                });
            }
        }
    }
    look::at_recording(&runs, &mut notices);
    let known = described.known(None)?;
    Ok(Recording { about: described.text.about.clone(), path: path.to_owned(), runs, known, notices })
}

/// Checks a description, the columns of its logs and their first rows, without reading the logs to their end.
///
/// # Errors
/// As [`load`], for what stands in the first rows.
pub fn check(path: &Path) -> Result<Check, RecordingError> {
    let described = Described::read(path)?;
    let mut notices = notes(&described);
    let mut runs = Vec::new();
    for index in 0..described.text.runs.len() {
        let (file, log) = read_log(&described, index, Some(CHECKED_ROWS), &mut notices)?;
        let first = log.traces.first().map(|(_, trace)| trace);
        runs.push(CheckedRun {
            id: described.text.runs[index].id.clone(),
            file,
            format: log.format,
            channels: first.map_or_else(Vec::new, |trace| {
                trace.channels().iter().map(|channel| channel.name.clone()).collect()
            }),
            rows: log.traces.iter().map(|(_, trace)| trace.len()).sum(),
        });
    }
    look::merge(&mut notices);
    Ok(Check { about: described.text.about.clone(), runs, notices })
}

fn notes(described: &Described) -> Vec<Notice> {
    let shared = described.text.notes.iter().map(|text| Notice::new("", NoticeKind::Note, text.clone()));
    let own =
        described.text.runs.iter().flat_map(|run| {
            run.notes.iter().map(|text| Notice::new(&run.id, NoticeKind::Note, text.clone()))
        });
    shared.chain(own).collect()
}

fn span(trace: &Trace) -> String {
    match (trace.time_s().first(), trace.time_s().last()) {
        (Some(first), Some(last)) => format!("{first} to {last} s"),
        _ => "nothing".to_owned(),
    }
}

fn broken(described: &Described, run: usize, source: headland_trace::TraceError) -> RecordingError {
    RecordingError::Trace { at: described.at(&format!("runs[{run}].file")), source }
}

fn read_log(
    described: &Described,
    index: usize,
    limit: Option<usize>,
    notices: &mut Vec<Notice>,
) -> Result<(PathBuf, Log), RecordingError> {
    let run = &described.text.runs[index];
    let at = described.at(&format!("runs[{index}].file"));
    let folder = described.text.folder.as_deref();
    let path = folder::of_description(described.path(), folder, &described.at("folder"))?.join(&run.file);
    let format = described.text.format.as_ref();
    let format_at = described.at("format");
    let encoding = match format {
        Some(Format::Csv { encoding, .. }) => encoding.as_deref(),
        _ => None,
    };
    let channels = described.channels(index);
    let source = open(&path, &at, encoding, &format_at)?;
    let log = match source {
        Source::Parquet if matches!(format, Some(Format::Csv { .. })) => {
            return Err(RecordingError::Value {
                at: format_at,
                field: "format".to_owned(),
                found: "csv".to_owned(),
                expected: format!("parquet, which {} is", path.display()),
            });
        }
        Source::Text(_) if matches!(format, Some(Format::Parquet)) => {
            return Err(RecordingError::Value {
                at: format_at,
                field: "format".to_owned(),
                found: "parquet".to_owned(),
                expected: format!("csv, which {} seems to be", path.display()),
            });
        }
        Source::Parquet => parquet_log::read(&path, &channels, described.text.keep_others, &run.id, notices)?,
        Source::Text(text) => {
            let layout = Layout::of(&text.start, &path, &Wanted::of(format, &format_at)?)?;
            let columns = Columns {
                path: &path,
                names: &layout.header,
                units: &layout.units,
                line: layout.header_line,
            };
            let (time, time_at) = time_description(described, &channels);
            let time = TimePlan::of(
                time.as_ref().map(|time| (time, &time_at)),
                &columns,
                &layout.sample,
                layout.decimal_comma,
                &run.id,
                notices,
            )?;
            let taken = time.columns();
            let outputs = outputs(&channels, described.text.keep_others, &taken, &columns, &run.id, notices)?;
            let plan = Plan { time, outputs };
            let format = told(&layout, text.encoding, text.gzip);
            let table = Rows::new(&path, &layout, &plan, &run.id).read(
                text.into_reader(layout.skip),
                limit,
                notices,
            )?;
            let bad = |source| RecordingError::Trace { at: Place::file(&path), source };
            let mut trace = Trace::new(table.time_s).map_err(bad)?;
            for (output, values) in plan.outputs.iter().zip(table.columns) {
                if let Some(values) = values {
                    trace.push(output.name.clone(), values, Origin::Measured).map_err(bad)?;
                }
            }
            let sensors = plan
                .outputs
                .iter()
                .filter_map(|output| Some((output.name.clone(), output.sensor?)))
                .collect();
            Log { traces: vec![(None, trace)], sensors, format }
        }
    };
    Ok((path, log))
}

/// What is said about time: in `time`, else by a channel that is `time_s`.
fn time_description(
    described: &Described,
    channels: &[(crate::describe::ChannelDescription, Place)],
) -> (Option<TimeDescription>, Place) {
    if described.text.time.is_some() {
        return (described.text.time.clone(), described.at("time"));
    }
    match channels.iter().find(|(channel, _)| channel.is == "time_s") {
        Some((channel, at)) => {
            let time = TimeDescription {
                column: channel.column.clone().or_else(|| Some("time_s".to_owned())),
                unit: channel.unit.clone(),
                ..TimeDescription::default()
            };
            (Some(time), at.clone())
        }
        None => (None, Place::default()),
    }
}

/// How a text log was read, for people.
fn told(layout: &Layout, encoding: &str, gzip: bool) -> String {
    let delimiter = match layout.delimiter {
        b'\t' => "tab".to_owned(),
        other => format!("\"{}\"", char::from(other)),
    };
    let comma = if layout.decimal_comma { ", decimal comma" } else { "" };
    let packed = if gzip { ", gzip" } else { "" };
    format!("csv, delimiter {delimiter}{comma}, {}{packed}", encoding.to_lowercase())
}
