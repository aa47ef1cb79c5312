//! Traces as Parquet: a `run` column, `time_s`, and a column for each channel; null where a run lacks a value.

use crate::{Origin, Run, Trace, TraceError};
use arrow_array::{
    Array, ArrayRef, Float64Array, RecordBatch, StringArray, cast::AsArray, types::Float64Type,
};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::{ArrowWriter, arrow_reader::ParquetRecordBatchReaderBuilder};
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use std::collections::HashMap;
use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

/// Metadata key of a column's origin.
const ORIGIN: &str = "origin";

/// Writes runs to a file, which appears whole or not at all.
///
/// # Errors
/// [`TraceError::File`] where the file system refuses, [`TraceError::Format`] where the channels cannot be stored.
pub fn write_parquet(path: &Path, runs: &[Run]) -> Result<(), TraceError> {
    let file_error = |source| TraceError::File { path: path.to_owned(), source };
    let mut names: Vec<(&str, Origin)> = Vec::new();
    for channel in runs.iter().flat_map(|run| run.trace.channels()) {
        if !names.iter().any(|(name, _)| *name == channel.name) {
            names.push((&channel.name, channel.origin));
        }
    }
    let mut fields =
        vec![Field::new("run", DataType::Utf8, false), Field::new("time_s", DataType::Float64, false)];
    fields.extend(names.iter().map(|(name, origin)| {
        let origin = match origin {
            Origin::Measured => "measured",
            Origin::Driven => "driven",
            Origin::Predicted => "predicted",
        };
        Field::new(*name, DataType::Float64, true)
            .with_metadata(HashMap::from([(ORIGIN.to_owned(), origin.to_owned())]))
    }));
    let schema = Arc::new(Schema::new(fields));
    let part = path.with_extension("parquet.part");
    let file = File::create(&part).map_err(file_error)?;
    let written = write_runs(file, &schema, &names, runs).map_err(|error| told(path, error));
    let written = written.and_then(|()| fs::rename(&part, path).map_err(file_error));
    if written.is_err() {
        // Half a file helps nobody; that it may stay behind must not hide why it is half.
        let _ = fs::remove_file(&part);
    }
    written
}

/// The runs one after the other, each a batch of rows.
fn write_runs(
    file: File,
    schema: &Arc<Schema>,
    names: &[(&str, Origin)],
    runs: &[Run],
) -> Result<(), ParquetError> {
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = ArrowWriter::try_new(file, Arc::clone(schema), Some(properties))?;
    for Run { id, trace } in runs {
        let samples = trace.len();
        let mut columns: Vec<ArrayRef> = vec![
            Arc::new(StringArray::from_iter_values(std::iter::repeat_n(id, samples))),
            Arc::new(Float64Array::from_iter_values(trace.time_s().iter().copied())),
        ];
        columns.extend(names.iter().map(|(name, _)| -> ArrayRef {
            match trace.get(name) {
                Some(values) => Arc::new(
                    values.iter().map(|value| (!value.is_nan()).then_some(*value)).collect::<Float64Array>(),
                ),
                None => Arc::new(Float64Array::new_null(samples)),
            }
        }));
        writer.write(&RecordBatch::try_new(Arc::clone(schema), columns)?)?;
    }
    writer.close().map(drop)
}

/// An error of the Parquet writer; where the file system refused, it is told as that.
fn told(path: &Path, error: ParquetError) -> TraceError {
    let format = |reason: String| TraceError::Format { path: path.to_owned(), reason };
    let ParquetError::External(inner) = error else { return format(error.to_string()) };
    match inner.downcast::<std::io::Error>() {
        Ok(source) => TraceError::File { path: path.to_owned(), source: *source },
        Err(other) => format(other.to_string()),
    }
}

/// Reads the runs of a file. A file without a `run` column holds one run, named after the file.
///
/// Integer and single-precision columns are widened; columns that are not numbers are passed over.
///
/// # Errors
/// [`TraceError::File`], [`TraceError::Format`], or what [`Trace::new`] refuses.
pub fn read_parquet(path: &Path) -> Result<Vec<Run>, TraceError> {
    let format = |reason: String| TraceError::Format { path: path.to_owned(), reason };
    let file = File::open(path).map_err(|source| TraceError::File { path: path.to_owned(), source })?;
    let reader = ParquetRecordBatchReaderBuilder::try_new(file)
        .and_then(ParquetRecordBatchReaderBuilder::build)
        .map_err(|error| format(error.to_string()))?;
    let fallback =
        path.file_stem().map_or_else(|| "run".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let mut runs: Vec<(String, Vec<f64>, Vec<Vec<f64>>)> = Vec::new();
    let mut names: Vec<(String, Origin)> = Vec::new();
    for batch in reader {
        let batch = batch.map_err(|error| format(error.to_string()))?;
        let schema = batch.schema();
        let time = schema
            .index_of("time_s")
            .map_err(|_| format("no column `time_s`, expected one with seconds".to_owned()))?;
        let time =
            numbers(batch.column(time)).ok_or_else(|| format("`time_s` holds no numbers".to_owned()))?;
        let mut columns = Vec::new();
        let mut batch_names = Vec::new();
        for (field, column) in schema.fields().iter().zip(batch.columns()) {
            if field.name() == "time_s" || field.name() == "run" {
                continue;
            }
            if let Some(values) = numbers(column) {
                let origin = match field.metadata().get(ORIGIN).map(String::as_str) {
                    Some("driven") => Origin::Driven,
                    Some("predicted") => Origin::Predicted,
                    _ => Origin::Measured,
                };
                batch_names.push((field.name().clone(), origin));
                columns.push(values);
            }
        }
        names = batch_names;
        let ids = batch.column_by_name("run").and_then(|column| column.as_string_opt::<i32>());
        for (row, time) in time.iter().enumerate() {
            let id = ids.map_or(fallback.as_str(), |ids| ids.value(row));
            if runs.last().is_none_or(|(last, ..)| last != id) {
                runs.push((id.to_owned(), Vec::new(), vec![Vec::new(); columns.len()]));
            }
            let Some((_, times, values)) = runs.last_mut() else { continue };
            times.push(*time);
            for (kept, column) in values.iter_mut().zip(&columns) {
                kept.push(column[row]);
            }
        }
    }
    runs.into_iter()
        .map(|(id, times, columns)| {
            let mut trace = Trace::new(times)?;
            for ((name, origin), values) in names.iter().zip(columns) {
                if values.iter().any(|value| !value.is_nan()) {
                    trace.push(name.clone(), values, *origin)?;
                }
            }
            Ok(Run { id, trace })
        })
        .collect()
}

/// The column as doubles, null as NaN; `None` where it holds no numbers.
fn numbers(column: &ArrayRef) -> Option<Vec<f64>> {
    use arrow_array::types::{
        Float32Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type,
    };
    macro_rules! widen {
        ($($kind:ident => $primitive:ty),*) => {
            match column.data_type() {
                DataType::Float64 => Some(
                    column.as_primitive::<Float64Type>().iter().map(|value| value.unwrap_or(f64::NAN)).collect(),
                ),
                DataType::Int64 => Some(
                    column
                        .as_primitive::<Int64Type>()
                        .iter()
                        .map(|value| value.map_or(f64::NAN, |value| value as f64))
                        .collect(),
                ),
                $(DataType::$kind => Some(
                    column
                        .as_primitive::<$primitive>()
                        .iter()
                        .map(|value| value.map_or(f64::NAN, f64::from))
                        .collect(),
                ),)*
                _ => None,
            }
        };
    }
    widen!(Float32 => Float32Type, Int8 => Int8Type, Int16 => Int16Type, Int32 => Int32Type, UInt8 => UInt8Type,
        UInt16 => UInt16Type, UInt32 => UInt32Type)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(id: &str, name: &str, values: Vec<f64>, origin: Origin) -> Run {
        let mut trace = Trace::new((0..values.len()).map(|step| step as f64 * 0.1).collect()).unwrap();
        trace.push(name, values, origin).unwrap();
        Run { id: id.to_owned(), trace }
    }

    #[test]
    fn runs_come_back_as_they_went() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("trace.parquet");
        let runs = [
            run("a", "speed_m_s", vec![1.0, 0.1 + 0.2, -0.0], Origin::Driven),
            run("b", "grade", vec![0.5, 0.25], Origin::Predicted),
        ];
        write_parquet(&path, &runs).unwrap();
        assert_eq!(read_parquet(&path).unwrap(), runs);
        assert!(!path.with_extension("parquet.part").exists());
    }

    #[test]
    fn a_missing_value_stays_missing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("trace.parquet");
        write_parquet(&path, &[run("a", "speed_m_s", vec![1.0, f64::NAN, 3.0], Origin::Measured)]).unwrap();
        let back = read_parquet(&path).unwrap();
        assert!(back[0].trace.get("speed_m_s").unwrap()[1].is_nan());
    }

    #[test]
    fn a_folder_and_a_text_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        assert!(read_parquet(folder.path()).is_err());
        let text = folder.path().join("text.parquet");
        std::fs::write(&text, "time_s\n1\n").unwrap();
        assert!(read_parquet(&text).unwrap_err().to_string().contains("text.parquet"));
    }
}
