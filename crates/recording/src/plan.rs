//! Which column of a log becomes which channel, and how.

use crate::column_unit::{Header, key, unit_in_words};
use crate::conversion::{line, unit_of};
use crate::describe::{ChannelDescription, Combine};
use crate::time_plan::TimePlan;
use crate::{Notice, NoticeKind, Place, RecordingError, Sensor};
use headland_trace::names;
use headland_units::{Unit, stem, unit_of_name};
use std::path::Path;

/// One channel to be.
#[derive(Clone, Debug)]
pub(crate) struct Output {
    /// Its name.
    pub name: String,
    /// Columns that it is made of.
    pub columns: Vec<usize>,
    /// How, where there are several.
    pub combine: Combine,
    /// Whether text in it is an error from the first row on.
    pub strict: bool,
    /// What is known of its sensor.
    pub sensor: Option<Sensor>,
    gain: f64,
    zero: f64,
}

impl Output {
    /// The channel's value of its columns' values.
    pub fn value(&self, cells: impl Iterator<Item = f64>) -> f64 {
        let sum: f64 = cells.sum();
        let raw = if self.combine == Combine::Mean { sum / self.columns.len() as f64 } else { sum };
        raw * self.gain + self.zero
    }
}

/// What becomes of a log's columns.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// Where time comes from.
    pub time: TimePlan,
    /// The channels.
    pub outputs: Vec<Output>,
}

/// A log's columns as its header shows them.
pub(crate) struct Columns<'a> {
    /// The log.
    pub path: &'a Path,
    /// Headers, trimmed.
    pub names: &'a [String],
    /// Units that stand in a row of their own.
    pub units: &'a [String],
    /// Line of the header.
    pub line: usize,
}

impl Columns<'_> {
    /// A column by its header: exactly, else without regard to its unit, case and spaces where that is one column.
    pub fn find(&self, wanted: &str) -> Option<usize> {
        let wanted = wanted.trim();
        self.names.iter().position(|name| name == wanted).or_else(|| {
            let same = |name: &String| key(name) == key(wanted) || Header::of(name).stem == wanted;
            let mut found = (0..self.names.len()).filter(|index| same(&self.names[*index]));
            found.next().filter(|_| found.next().is_none())
        })
    }

    /// A column that has to be there; `at` is where it is asked for.
    pub fn need(&self, wanted: &str, at: &Place) -> Result<usize, RecordingError> {
        self.find(wanted).ok_or_else(|| {
            let near = self
                .names
                .iter()
                .map(|name| (strsim::jaro_winkler(&key(name), &key(wanted)), name))
                .filter(|(likeness, _)| *likeness > 0.8)
                .max_by(|a, b| a.0.total_cmp(&b.0));
            let hint = match near {
                Some((_, name)) => format!("did you mean `{name}`?"),
                None => format!("there are: {}", self.list()),
            };
            RecordingError::NoColumn {
                at: at.clone(),
                column: wanted.to_owned(),
                file: self.path.to_owned(),
                hint,
            }
        })
    }

    /// All headers, for a message.
    pub fn list(&self) -> String {
        let quoted: Vec<String> =
            self.names.iter().filter(|name| !name.is_empty()).map(|name| format!("`{name}`")).collect();
        quoted.join(", ")
    }

    /// The unit that a column's header, or the row below it, says.
    pub fn unit(&self, column: usize) -> Option<Result<Unit, String>> {
        match self.units.get(column).filter(|unit| !unit.is_empty()) {
            Some(text) => Some(unit_in_words(text)),
            None => Header::of(&self.names[column]).unit,
        }
    }
}

/// The channels of a log: those described, those whose header is a channel's name, and the rest under their own names.
pub(crate) fn outputs(
    described: &[(ChannelDescription, Place)],
    keep_others: bool,
    taken_by_time: &[usize],
    columns: &Columns<'_>,
    run: &str,
    notices: &mut Vec<Notice>,
) -> Result<Vec<Output>, RecordingError> {
    let mut outputs: Vec<Output> = Vec::new();
    let mut used: Vec<usize> = taken_by_time.to_vec();
    for (channel, at) in described.iter().filter(|(channel, _)| channel.is != "time_s") {
        if let Some(output) = from_description(channel, at, columns, run, notices)? {
            used.extend(&output.columns);
            outputs.push(output);
        }
    }
    for (index, name) in columns.names.iter().enumerate() {
        if used.contains(&index) || name.is_empty() {
            continue;
        }
        let (known, text) = known_channel(name, columns.unit(index).as_ref());
        let wanted = known.unwrap_or(name);
        if known.is_none() && !keep_others {
            continue;
        }
        if outputs.iter().any(|output| output.name == wanted) {
            let text = format!("a second column gives `{wanted}`; the first is used, `{name}` is left out");
            notices.push(Notice::new(run, NoticeKind::Duplicate, text).channel(wanted));
            continue;
        }
        if let Some(text) = text {
            notices.push(Notice::new(run, NoticeKind::Assumed, text).channel(wanted));
        }
        let (gain, zero) = match (known.and_then(unit_of_name), columns.unit(index)) {
            (Some(to), Some(Ok(from))) => line(&from, &to),
            (None, Some(Ok(from))) if known.is_some() => (from.factor, from.offset),
            _ => (1.0, 0.0),
        };
        outputs.push(Output {
            name: wanted.to_owned(),
            columns: vec![index],
            combine: Combine::Sum,
            strict: known.is_some(),
            sensor: None,
            gain,
            zero,
        });
    }
    Ok(outputs)
}

/// The channel that a header names by itself, `speed_m_s` or `Speed [km/h]`, and what to say about it.
fn known_channel(
    header: &str,
    unit: Option<&Result<Unit, String>>,
) -> (Option<&'static str>, Option<String>) {
    if let Some(exact) = names::KNOWN.iter().find(|known| known.name == header) {
        return (Some(exact.name), None);
    }
    let Some(Ok(unit)) = unit else { return (None, None) };
    let key = Header::of(header).key();
    let same = names::KNOWN.iter().find(|known| {
        let fits = unit_of_name(known.name)
            .map_or(unit.dimension == headland_units::Dimension::NONE, |own| own.dimension == unit.dimension);
        stem(known.name) == key && fits && known.name != "time_s"
    });
    let text = same.map(|known| format!("column `{header}` is read as `{}`", known.name));
    (same.map(|known| known.name), text)
}

fn from_description(
    channel: &ChannelDescription,
    at: &Place,
    columns: &Columns<'_>,
    run: &str,
    notices: &mut Vec<Notice>,
) -> Result<Option<Output>, RecordingError> {
    let wanted: Vec<&str> = match (&channel.column, &channel.columns) {
        (Some(one), None) => vec![one],
        (None, Some(several)) => several.iter().map(String::as_str).collect(),
        // A correction of a channel whose header already is its name.
        _ => vec![&channel.is],
    };
    if channel.optional && wanted.iter().any(|name| columns.find(name).is_none()) {
        let text = format!("`{}` is not logged here: no column `{}`", channel.is, wanted.join("`, `"));
        notices.push(Notice::new(run, NoticeKind::Assumed, text).channel(&channel.is));
        return Ok(None);
    }
    let mut indices = Vec::new();
    for name in &wanted {
        indices.push(columns.need(name, at)?);
    }
    let unit = unit_of(channel, at, columns, indices[0], run, notices)?;
    for other in &indices[1..] {
        if let (None, Some(Ok(first)), Some(Ok(other_unit))) =
            (&channel.unit, columns.unit(indices[0]), columns.unit(*other))
            && first.symbol != other_unit.symbol
        {
            return Err(RecordingError::UnitMisfit {
                at: at.clone(),
                unit: other_unit.symbol,
                channel: channel.is.clone(),
                expected: format!("{}; columns that are combined need one unit", first.symbol),
            });
        }
    }
    let scale = channel.scale.unwrap_or(1.0);
    let offset = channel.offset.unwrap_or(0.0);
    let (slope, zero) = unit;
    let sensor = channel.sensor.map(|sensor| Sensor {
        noise: sensor.noise,
        latency_s: sensor.latency_s,
        scale: sensor.scale,
        bias: sensor.bias,
    });
    Ok(Some(Output {
        name: channel.is.clone(),
        columns: indices,
        combine: channel.combine.unwrap_or(Combine::Sum),
        strict: true,
        sensor,
        gain: scale * slope,
        zero: offset * slope + zero,
    }))
}
