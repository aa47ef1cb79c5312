//! Runs from a Parquet file.

use crate::describe::ChannelDescription;
use crate::load::Log;
use crate::plan::{Columns, outputs};
use crate::{Notice, Place, RecordingError};
use headland_trace::{Origin, Trace, read_parquet};
use std::path::Path;

/// Reads the runs of a Parquet file whose time is the column `time_s` and maps their columns as those of a text log.
pub(crate) fn read(
    path: &Path,
    channels: &[(ChannelDescription, Place)],
    keep_others: bool,
    run: &str,
    notices: &mut Vec<Notice>,
) -> Result<Log, RecordingError> {
    let bad = |source| RecordingError::Trace { at: Place::file(path), source };
    let runs = read_parquet(path).map_err(bad)?;
    if runs.is_empty() {
        return Err(RecordingError::Empty { at: Place::file(path), what: "the file has no rows" });
    }
    let several = runs.len() > 1;
    let mut log = Log { traces: Vec::new(), sensors: Vec::new(), format: "parquet".to_owned() };
    for (number, read) in runs.into_iter().enumerate() {
        let names: Vec<String> = read.trace.channels().iter().map(|channel| channel.name.clone()).collect();
        let columns = Columns { path, names: &names, units: &[], line: 0 };
        let mut seen = Vec::new();
        let outputs = outputs(channels, keep_others, &[], &columns, run, &mut seen)?;
        if number == 0 {
            notices.append(&mut seen);
        }
        let mut trace = Trace::new(read.trace.time_s().to_vec()).map_err(bad)?;
        for output in &outputs {
            let values = (0..trace.len())
                .map(|row| {
                    output
                        .value(output.columns.iter().map(|column| read.trace.channels()[*column].values[row]))
                })
                .collect();
            trace.push(output.name.clone(), values, Origin::Measured).map_err(bad)?;
        }
        log.sensors =
            outputs.iter().filter_map(|output| Some((output.name.clone(), output.sensor?))).collect();
        log.traces.push((several.then_some(read.id), trace));
    }
    Ok(log)
}
