//! What a recording is once it is read.

use crate::Notice;
use headland_trace::Trace;
use std::path::PathBuf;

/// The runs of a description, read.
#[derive(Clone, Debug)]
pub struct Recording {
    /// What it is, in the words of its description.
    pub about: String,
    /// The description's file.
    pub path: PathBuf,
    /// Its runs, in the order in which they are described.
    pub runs: Vec<RecordedRun>,
    /// What is known and not logged, shared by all runs.
    pub known: Vec<Known>,
    /// What was seen in the logs and a reader should know. Nothing of it was repaired.
    pub notices: Vec<Notice>,
}

impl Recording {
    /// The run of this name.
    pub fn run(&self, id: &str) -> Option<&RecordedRun> {
        self.runs.iter().find(|run| run.id == id)
    }
}

/// One run: a drive without interruption.
#[derive(Clone, Debug)]
pub struct RecordedRun {
    /// Name, unique in the recording. A piece of a log that was cut has its number behind a dot: `r2.1`.
    pub id: String,
    /// Its channels, in the units that end their names. Time is the log's own: pieces keep the time of their log.
    pub trace: Trace,
    /// Runs that share a path drove the same ground.
    pub path: Option<String>,
    /// Whether it drove its path from the end to the start.
    pub reversed: bool,
    /// Whether it must not be used to choose or to fit anything.
    pub held_out: bool,
    /// What is known of this run: its own entries, and the shared ones that it does not override.
    pub known: Vec<Known>,
    /// What is known of the sensors: channel and sensor.
    pub sensors: Vec<(String, Sensor)>,
}

impl RecordedRun {
    /// A known quantity of this run.
    pub fn known(&self, name: &str) -> Option<&Known> {
        self.known.iter().find(|known| known.name == name)
    }

    /// What is known of the sensor behind a channel.
    pub fn sensor(&self, channel: &str) -> Option<&Sensor> {
        self.sensors.iter().find(|(name, _)| name == channel).map(|(_, sensor)| sensor)
    }
}

/// A quantity that is known and not logged.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Name, ending in its unit.
    pub name: String,
    /// Value, in the unit of the name.
    pub value: f64,
    /// One standard deviation, in the unit of the name; `None` where the description gives none.
    pub sd: Option<f64>,
}

/// What is known of a sensor, in the unit that ends its channel's name.
///
/// Latency, scale and bias have been taken out of the trace already: corrected = (raw − bias) / scale, shifted by
/// −latency. Noise is what is left.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// One standard deviation of a sample.
    pub noise: Option<f64>,
    /// How late a value is (s).
    pub latency_s: Option<f64>,
    /// What it reads, divided by what is true.
    pub scale: Option<f64>,
    /// What it reads where the truth is zero.
    pub bias: Option<f64>,
}

/// What checking a description found without reading whole logs.
#[derive(Clone, Debug)]
pub struct Check {
    /// What the recording is, in the words of its description.
    pub about: String,
    /// Its runs, before any are cut.
    pub runs: Vec<CheckedRun>,
    /// What the descriptions and the first rows show.
    pub notices: Vec<Notice>,
}

/// One run of a checked description.
#[derive(Clone, Debug)]
pub struct CheckedRun {
    /// Name.
    pub id: String,
    /// Its log.
    pub file: PathBuf,
    /// How the log is read, for people: `csv, delimiter ";", windows-1252, gzip`.
    pub format: String,
    /// Channels that it gives, time left out.
    pub channels: Vec<String>,
    /// Rows that were looked at.
    pub rows: usize,
}
