//! What can be wrong with a description or with a log, and where.

use headland_trace::TraceError;
use std::fmt;
use std::path::{Path, PathBuf};

/// A place in a file. Lines and columns count from 1; 0 says that the file as a whole is meant.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

impl Place {
    /// A file as a whole.
    pub fn file(path: &Path) -> Self {
        Self::new(path, 0, 0)
    }

    /// A place in a file.
    pub fn new(path: &Path, line: usize, column: usize) -> Self {
        Self { path: path.to_owned(), line, column }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        match (self.line, self.column) {
            (0, _) => Ok(()),
            (line, 0) => write!(f, ":{line}"),
            (line, column) => write!(f, ":{line}:{column}"),
        }
    }
}

/// A recording that cannot be read. The text says what was found and expected; its last line is the place.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file system refused: missing, not readable.
    #[error("cannot read `{}`: {source}\n  {at}", path.display())]
    File {
        /// Where the file is named, or the file itself.
        at: Place,
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A folder stands where a file was expected.
    #[error("`{}` is a folder, expected a file\n  {at}", path.display())]
    Folder {
        /// Where it is named.
        at: Place,
        /// The folder.
        path: PathBuf,
    },
    /// The description is not what the schema says.
    #[error("{reason}\n  {at}")]
    Description {
        /// Where.
        at: Place,
        /// What was found and expected.
        reason: String,
    },
    /// The folder of recordings that the description speaks of is not there.
    #[error("no folder `{}`, expected the recordings; set {variable} to where they lie\n  {at}", folder.display())]
    NoRecordings {
        /// Where the description asks for it.
        at: Place,
        /// The folder that was looked for.
        folder: PathBuf,
        /// The variable that can name another.
        variable: String,
    },
    /// An environment variable that the description names is not set.
    #[error("the environment variable `{name}` is not set\n  {at}")]
    Variable {
        /// Where.
        at: Place,
        /// The variable.
        name: String,
    },
    /// A name that has to be unique stands twice.
    #[error("{what} `{name}` stands twice, expected each once\n  {at}")]
    Twice {
        /// Where the second stands.
        at: Place,
        /// Run, channel or column.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A field holds a value that it cannot have.
    #[error("`{field}` is {found}, expected {expected}\n  {at}")]
    Value {
        /// Where.
        at: Place,
        /// The field.
        field: String,
        /// What was found.
        found: String,
        /// What would do.
        expected: String,
    },
    /// A text is no unit.
    #[error("no unit `{text}`: {reason}\n  {at}")]
    Unit {
        /// Where.
        at: Place,
        /// The text.
        text: String,
        /// Which part is not known.
        reason: String,
    },
    /// A unit measures something else than its channel holds.
    #[error("`{unit}` does not fit `{channel}`: expected a unit of {expected}\n  {at}")]
    UnitMisfit {
        /// Where.
        at: Place,
        /// The unit that was found.
        unit: String,
        /// The channel.
        channel: String,
        /// The unit that the channel has, and what else could be meant.
        expected: String,
    },
    /// A channel's name is a known one misspelt.
    #[error(
        "no channel `{name}`; did you mean `{suggestion}`? A name of your own has to differ in more than one letter\n  {at}"
    )]
    Misspelt {
        /// Where.
        at: Place,
        /// The name that was found.
        name: String,
        /// The known one.
        suggestion: String,
    },
    /// A log lacks a column.
    #[error("no column `{column}` in {}; {hint}\n  {at}", file.display())]
    NoColumn {
        /// Where the column is named.
        at: Place,
        /// The column.
        column: String,
        /// The log.
        file: PathBuf,
        /// The nearest column, or all of them.
        hint: String,
    },
    /// A log has no column of time.
    #[error(
        "no time column among {present}; expected one named `time_s` or `Time`, or `time: (column: \"...\")` in the description\n  {at}"
    )]
    NoTime {
        /// The log's header.
        at: Place,
        /// The columns that are there.
        present: String,
    },
    /// Date cells whose day and month could be either way round.
    #[error(
        "`{found}` in column `{column}` could be day/month or month/day; write `time: (order: dmy)` or `mdy`\n  {at}"
    )]
    DateOrder {
        /// The first such cell.
        at: Place,
        /// The column.
        column: String,
        /// What it holds.
        found: String,
    },
    /// The format is known and cannot be read yet.
    #[error("{format} is not supported yet; csv and parquet are\n  {at}")]
    Unsupported {
        /// Where it is asked for.
        at: Place,
        /// The format.
        format: &'static str,
    },
    /// A log holds no row.
    #[error("{what}, expected a header and rows\n  {at}")]
    Empty {
        /// The log.
        at: Place,
        /// What is there.
        what: &'static str,
    },
    /// A log begins with numbers instead of names.
    #[error(
        "the first row starts with the number `{found}`, expected the columns' names; write `format: csv(names: [...])` to give them\n  {at}"
    )]
    NoHeader {
        /// The row.
        at: Place,
        /// Its first cell.
        found: String,
    },
    /// A row has another number of cells than the header.
    #[error("{found} cells in this row, expected {expected} as in the header\n  {at}")]
    Uneven {
        /// The row.
        at: Place,
        /// Its cells.
        found: usize,
        /// Cells of the header.
        expected: usize,
    },
    /// A cell does not hold what its column should.
    #[error("`{found}` in column `{column}`, expected {expected}\n  {at}")]
    Cell {
        /// The cell.
        at: Place,
        /// The column.
        column: String,
        /// What it holds.
        found: String,
        /// What it should.
        expected: &'static str,
    },
    /// Time runs backwards.
    #[error("time runs backwards: {before_s} s is followed by {after_s} s\n  {at}")]
    Backwards {
        /// The later row.
        at: Place,
        /// Time of the row before (s).
        before_s: f64,
        /// Its time (s).
        after_s: f64,
    },
    /// A byte that the encoding does not have.
    #[error(
        "a byte that is no {encoding}, expected text; name the file's encoding, as in `format: csv(encoding: \"windows-1252\")`\n  {at}"
    )]
    Encoding {
        /// The line.
        at: Place,
        /// The encoding that was tried.
        encoding: &'static str,
    },
    /// The compressed data are damaged, or the disk failed while reading.
    #[error("reading stopped: {reason}\n  {at}")]
    Read {
        /// Where.
        at: Place,
        /// Why.
        reason: String,
    },
    /// A trace could not be built, or a Parquet file not read.
    #[error("{source}\n  {at}")]
    Trace {
        /// The log, or where it is named.
        at: Place,
        /// Why.
        source: TraceError,
    },
}

impl RecordingError {
    /// Where it is.
    pub fn place(&self) -> &Place {
        match self {
            Self::File { at, .. }
            | Self::Folder { at, .. }
            | Self::Description { at, .. }
            | Self::NoRecordings { at, .. }
            | Self::Variable { at, .. }
            | Self::Twice { at, .. }
            | Self::Value { at, .. }
            | Self::Unit { at, .. }
            | Self::UnitMisfit { at, .. }
            | Self::Misspelt { at, .. }
            | Self::NoColumn { at, .. }
            | Self::NoTime { at, .. }
            | Self::DateOrder { at, .. }
            | Self::Unsupported { at, .. }
            | Self::Empty { at, .. }
            | Self::NoHeader { at, .. }
            | Self::Uneven { at, .. }
            | Self::Cell { at, .. }
            | Self::Backwards { at, .. }
            | Self::Encoding { at, .. }
            | Self::Read { at, .. }
            | Self::Trace { at, .. } => at,
        }
    }

    /// File, line and column (from 1), where it has a line: enough to print the line and a mark under it.
    pub fn location(&self) -> Option<(PathBuf, usize, usize)> {
        let at = self.place();
        (at.line > 0).then(|| (at.path.clone(), at.line, at.column.max(1)))
    }
}
