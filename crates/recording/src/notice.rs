//! What is told about a log and never repaired.

use std::fmt;

/// What kind of thing was seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NoticeKind {
    /// A step of time more than three times the median.
    Gap,
    /// Rows with the time of the row before; the later ones are dropped.
    Repeated,
    /// Cells that are empty or say that there is no value; they are NaN in the trace.
    Nan,
    /// A channel that holds one value while the vehicle moves, or throughout.
    Stuck,
    /// Single samples far from both neighbours.
    Spike,
    /// Speed that changes by more than 3 m/s from one row to the next.
    Jump,
    /// Two channels with the same values, or two columns of one name.
    Duplicate,
    /// A force, moment, acceleration or rate that does not read zero at standstill.
    Offset,
    /// Two channels that agree better when one of them is shifted in time.
    Lag,
    /// A channel whose sign contradicts another.
    Sign,
    /// A column that holds text and was left out.
    Text,
    /// Something that the description leaves open and that was taken from the file or assumed.
    Assumed,
    /// Where a log was cut into pieces, and pieces that were left out.
    Split,
    /// A channel whose values are few and far apart.
    Coarse,
    /// What the description itself tells its reader.
    Note,
}

impl NoticeKind {
    /// One word for a table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gap => "gap",
            Self::Repeated => "repeated",
            Self::Nan => "missing",
            Self::Stuck => "stuck",
            Self::Spike => "spike",
            Self::Jump => "jump",
            Self::Duplicate => "duplicate",
            Self::Offset => "offset",
            Self::Lag => "lag",
            Self::Sign => "sign",
            Self::Text => "text",
            Self::Assumed => "assumed",
            Self::Split => "split",
            Self::Coarse => "coarse",
            Self::Note => "note",
        }
    }
}

/// One thing that was seen in a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// The run; empty where the recording as a whole is meant.
    pub run: String,
    /// The channel, where it is about one.
    pub channel: Option<String>,
    /// What kind of thing.
    pub kind: NoticeKind,
    /// One sentence for a person.
    pub text: String,
    /// How many samples, rows or places it is about.
    pub count: usize,
    /// Time of the first of them (s), where it has one.
    pub first_s: Option<f64>,
}

impl Notice {
    pub(crate) fn new(run: &str, kind: NoticeKind, text: String) -> Self {
        Self { run: run.to_owned(), channel: None, kind, text, count: 1, first_s: None }
    }

    pub(crate) fn channel(mut self, channel: &str) -> Self {
        self.channel = Some(channel.to_owned());
        self
    }

    pub(crate) fn count(mut self, count: usize) -> Self {
        self.count = count;
        self
    }

    pub(crate) fn first(mut self, time_s: f64) -> Self {
        self.first_s = Some(time_s);
        self
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.run.is_empty() {
            write!(f, "{}: ", self.run)?;
        }
        f.write_str(&self.text)
    }
}
