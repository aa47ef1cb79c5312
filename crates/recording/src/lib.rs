//! Field logs as people have them, read into traces by a description that says how.
//!
//! A log stays as it was recorded. Its `recording.ron` names the runs, the file of each, and which column is which
//! channel in which unit; what can be seen in the file (delimiter, encoding, units in headers, preamble) need not be
//! written. [`load`] gives the runs as traces in the units that end the channels' names, together with [`Notice`]s:
//! gaps, repeated samples, missing values, stuck or offset sensors. These are told and never repaired.
//!
//! Logs are streamed through decompression, decoding and parsing row by row: memory holds the kept columns (8 bytes a
//! cell) and never the text, so that a 2 GB file takes what its numbers take; `keep_others: false` keeps the described
//! columns alone.

mod cells;
mod clock;
mod column_unit;
mod conversion;
mod correct;
mod cut;
mod describe;
mod ends;
mod error;
mod folder;
mod form;
mod layout;
mod load;
mod look;
mod notice;
mod parquet_log;
mod places;
mod plan;
mod recording;
mod renewal;
mod rows;
mod source;
mod text;
mod time_plan;
mod validate;
mod words;

pub use error::{Place, RecordingError};
pub use form::{ABOUT, ABOUT_PARTS, DescriptionForm};
pub use load::{check, load};
pub use notice::{Notice, NoticeKind};
pub use recording::{Check, CheckedRun, Known, RecordedRun, Recording, Sensor};
pub use renewal::{renewals, renewed_s, spacing};
