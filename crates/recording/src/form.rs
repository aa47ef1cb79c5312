//! What a description of a recording looks like, for programs that help to write one.

use crate::describe::Description;
use serde::{Deserialize, Deserializer};

/// A description as it reads itself, for whoever asks what it looks like; what it says is not to be seen.
#[derive(Debug)]
pub struct DescriptionForm;

impl<'de> Deserialize<'de> for DescriptionForm {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Description::deserialize(deserializer).map(|_| Self)
    }
}

/// Path and words of every field of a description; lists are looked through, variants are a step of a path.
pub const ABOUT: &[(&str, &str)] = &[
    ("about", "one line on what was recorded"),
    (
        "folder",
        "where the files lie, from the description; `${NAME}` is an environment variable, `${NAME:-folder}` with one for when it is not set",
    ),
    ("runs", "one for each log"),
    ("runs.id", "what it is called"),
    ("runs.file", "the log"),
    ("runs.segments", "the stretches to use; several become id.1, id.2"),
    ("runs.segments.from_s", "in the log's time"),
    ("runs.segments.to_s", "in the log's time"),
    ("runs.split", "where this log was joined of several drives"),
    ("runs.split.speed_jump_m_s", "a jump of speed that parts two drives"),
    ("runs.split.gap_s", "a gap in time that parts two drives"),
    ("runs.split.shortest_s", "drives that are shorter are left out"),
    ("runs.path", "names the ground: runs that share it drove the same"),
    ("runs.reversed", "whether it drove the path from its end"),
    ("runs.use", "what it is for"),
    ("runs.use.fit", "it may be fitted to"),
    ("runs.use.held_out", "it is kept out of every fit"),
    ("runs.channels", "columns of this run alone"),
    ("runs.known", "what is known of this run alone"),
    ("runs.notes", "sentences for whoever uses the run"),
    ("format", "where a guess is wrong"),
    ("format.csv", "delimited text"),
    ("format.csv.delimiter", "between two cells"),
    ("format.csv.encoding", "of the text"),
    ("format.csv.decimal", "point or comma"),
    ("format.csv.skip_lines", "before the header"),
    ("format.csv.comment", "what begins a line that says nothing"),
    ("format.csv.names", "of the columns, where there is no header"),
    ("format.parquet", "as it says itself"),
    ("format.mdf4", "refused, with what to convert it with"),
    ("format.candump", "refused, with what to convert it with"),
    ("format.candump.dbc", "the database of its messages"),
    ("time", "which column is the time"),
    ("time.column", "its header"),
    ("time.date", "header of the date"),
    ("time.clock", "header of the time of day"),
    ("time.order", "of day, month and year in a date"),
    ("time.order.ymd", "year, month, day"),
    ("time.order.dmy", "day, month, year"),
    ("time.order.mdy", "month, day, year"),
    ("time.unit", "of the column"),
    ("time.period_s", "between two rows, where rows have no time"),
    ("channels", "which column is which quantity"),
    ("keep_others", "whether columns that are not described are kept; they are without"),
    ("split", "where logs were joined of several drives"),
    ("split.speed_jump_m_s", "a jump of speed that parts two drives"),
    ("split.gap_s", "a gap in time that parts two drives"),
    ("split.shortest_s", "drives that are shorter are left out"),
    ("known", "what is known and not logged"),
    ("notes", "sentences for whoever uses the recording"),
];

/// The same for a channel and for what is known, which stand in several places.
pub const ABOUT_PARTS: &[(&str, &str)] = &[
    ("channels.column", "its header; that of the channel's name without"),
    ("channels.columns", "several headers"),
    ("channels.combine", "what becomes of several columns"),
    ("channels.combine.mean", "their mean"),
    ("channels.combine.sum", "their sum"),
    ("channels.is", "the channel's name, which its unit ends"),
    ("channels.unit", "where the header has none or a wrong one"),
    ("channels.scale", "value = column × scale + offset, in the column's unit"),
    ("channels.offset", "value = column × scale + offset, in the column's unit"),
    ("channels.density_kg_m3", "turns a volume flow into a mass flow"),
    ("channels.radius_m", "turns a speed of rotation into a speed"),
    ("channels.optional", "whether the column may be missing"),
    ("channels.sensor", "its errors, which are taken out, in the unit of the channel"),
    ("channels.sensor.noise", "standard deviation"),
    ("channels.sensor.latency_s", "how late a value comes"),
    ("channels.sensor.scale", "raw = true × scale + bias"),
    ("channels.sensor.bias", "raw = true × scale + bias"),
    ("known.name", "of what is known, which its unit ends"),
    ("known.value", "a number, or a text with a unit"),
    ("known.sd", "one standard deviation"),
];
