//! What can go wrong with a report.

use std::path::PathBuf;

/// A report that cannot be drawn or written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Two arrays that belong together differ in length.
    #[error("plot `{plot}`: {what} of `{series}` has {found} values, expected {expected}")]
    Length {
        /// Title of the plot.
        plot: String,
        /// Name of the series.
        series: String,
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length of the array that it goes with.
        expected: usize,
    },
    /// A flow that is not a positive number.
    #[error("plot `{plot}`: the flow from `{from}` to `{to}` is {value}, expected a number above 0")]
    Flow {
        /// Title of the plot.
        plot: String,
        /// Where it leaves.
        from: String,
        /// Where it arrives.
        to: String,
        /// What was found, in the unit of the plot.
        value: f64,
    },
    /// Flows that run in a circle cannot be laid out from left to right.
    #[error("plot `{plot}`: the flows through `{through}` run in a circle")]
    Circle {
        /// Title of the plot.
        plot: String,
        /// A node of the circle.
        through: String,
    },
    /// A row of a table is longer or shorter than its heading.
    #[error("table `{table}`: row {row} has {found} cells, expected {expected}")]
    Row {
        /// Title of the table.
        table: String,
        /// Number of the row, from 1.
        row: usize,
        /// Its number of cells.
        found: usize,
        /// The number of columns.
        expected: usize,
    },
    /// A trace lacks a channel that the plot is about.
    #[error(transparent)]
    Trace(#[from] headland_trace::TraceError),
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}
