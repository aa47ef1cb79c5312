//! The table of results: one Parquet file, one row a run, in the order of their numbers.
//!
//! It is made from the journal alone, so it holds nothing of when, where or how often the batch was run.

use crate::error::BatchError;
use crate::journal::Journal;
use crate::plan::{Plan, Setting};
use crate::row::Row;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray, UInt32Array, UInt64Array};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// Rows that are held at a time, and that make a group of the file.
const ROWS: u64 = 4096;

/// Columns of values, in the order of their first appearance by number of run and place in its row.
///
/// # Errors
/// [`BatchError::File`] where the journal cannot be read.
pub fn value_columns(plan: &Plan, journal: &mut Journal) -> Result<Vec<String>, BatchError> {
    let mut columns: Vec<String> = Vec::new();
    for number in 0..plan.total() {
        let Some(row) = journal.row(number)? else { continue };
        let mut behind = 0;
        for (name, _) in &row.values {
            if let Some(place) = columns.iter().position(|column| column == name) {
                behind = place + 1;
            } else {
                // A new account stands behind the one that it follows in its row.
                columns.insert(behind, name.clone());
                behind += 1;
            }
        }
    }
    Ok(columns)
}

/// Columns of parameters and whether each holds numbers throughout.
fn parameter_columns(plan: &Plan) -> Vec<(String, bool)> {
    let listed = plan.comparison.points.sweep.iter().map(|one| (one.path.clone(), numeric(&one.values)));
    let texts: BTreeMap<String, bool> = listed.collect();
    let paths = plan.columns().into_iter().map(str::to_owned);
    paths
        .map(|path| {
            let numbers = texts.get(&path).copied().unwrap_or(true);
            (path, numbers)
        })
        .collect()
}

fn numeric(values: &[String]) -> bool {
    values.iter().all(|value| value.replace('_', "").parse::<f64>().is_ok())
}

/// Writes the table; it appears whole or not at all.
///
/// # Errors
/// [`BatchError::File`], [`BatchError::Table`].
pub fn write(plan: &Plan, journal: &mut Journal, path: &Path) -> Result<(), BatchError> {
    let file_error = |source| BatchError::File { path: path.to_owned(), source };
    let values = value_columns(plan, journal)?;
    let parameters = parameter_columns(plan);
    let schema = Arc::new(schema(&parameters, &values));
    let part = path.with_extension("parquet.part");
    let written = write_rows(plan, journal, (path, &part), (&parameters, &values), &schema)
        .and_then(|()| std::fs::rename(&part, path).map_err(file_error));
    if written.is_err() {
        // The journal has everything that the half of a table has.
        let _ = std::fs::remove_file(&part);
    }
    written
}

fn write_rows(
    plan: &Plan,
    journal: &mut Journal,
    (path, part): (&Path, &Path),
    (parameters, values): (&[(String, bool)], &[String]),
    schema: &Arc<Schema>,
) -> Result<(), BatchError> {
    let file_error = |source| BatchError::File { path: path.to_owned(), source };
    let file = File::create(part).map_err(file_error)?;
    let whole = file.try_clone().map_err(file_error)?;
    let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
    let mut writer = ArrowWriter::try_new(file, Arc::clone(schema), Some(properties))
        .map_err(|error| told(path, error))?;
    let mut first = 0;
    while first < plan.total() {
        let last = (first + ROWS).min(plan.total());
        let mut rows = Vec::new();
        for number in first..last {
            if let Some(row) = journal.row(number)? {
                rows.push(row);
            }
        }
        let columns = columns(plan, parameters, values, &rows);
        let batch = RecordBatch::try_new(Arc::clone(schema), columns)
            .map_err(|error| BatchError::Table { path: path.to_owned(), reason: error.to_string() })?;
        writer.write(&batch).and_then(|()| writer.flush()).map_err(|error| told(path, error))?;
        first = last;
    }
    writer.close().map_err(|error| told(path, error))?;
    whole.sync_all().map_err(file_error)
}

/// An error of the Parquet writer; where the file system refused, it is told as that.
fn told(path: &Path, error: parquet::errors::ParquetError) -> BatchError {
    if let parquet::errors::ParquetError::External(inner) = error {
        return match inner.downcast::<std::io::Error>() {
            Ok(source) => BatchError::File { path: path.to_owned(), source: *source },
            Err(other) => BatchError::Table { path: path.to_owned(), reason: other.to_string() },
        };
    }
    BatchError::Table { path: path.to_owned(), reason: error.to_string() }
}

fn schema(parameters: &[(String, bool)], values: &[String]) -> Schema {
    let text = |name: &str, nullable| Field::new(name, DataType::Utf8, nullable);
    let mut fields = vec![
        Field::new("run", DataType::UInt64, false),
        text("variant", false),
        text("cycle", false),
        text("ground", false),
        Field::new("repetition", DataType::UInt32, false),
    ];
    fields.extend(parameters.iter().map(|(name, numbers)| {
        Field::new(name, if *numbers { DataType::Float64 } else { DataType::Utf8 }, true)
    }));
    fields.extend([text("status", false), text("error", true)]);
    fields.extend(values.iter().map(|name| Field::new(name, DataType::Float64, true)));
    Schema::new(fields)
}

fn columns(plan: &Plan, parameters: &[(String, bool)], values: &[String], rows: &[Row]) -> Vec<ArrayRef> {
    let comparison = &plan.comparison;
    let specs: Vec<_> = rows.iter().map(|row| plan.spec(row.number)).collect();
    let names = |name: &dyn Fn(&crate::plan::Spec) -> String| -> ArrayRef {
        Arc::new(specs.iter().map(|spec| Some(name(spec))).collect::<StringArray>())
    };
    let settings: Vec<Vec<Option<Setting>>> = if parameters.is_empty() {
        Vec::new()
    } else {
        specs.iter().map(|spec| plan.settings(*spec)).collect()
    };
    let mut columns: Vec<ArrayRef> = vec![
        Arc::new(UInt64Array::from_iter_values(rows.iter().map(|row| row.number))),
        names(&|spec| comparison.variants[spec.variant].name.clone()),
        names(&|spec| comparison.cycles[spec.cycle].name.clone()),
        names(&|spec| comparison.grounds[spec.ground].name.clone()),
        Arc::new(UInt32Array::from_iter_values(specs.iter().map(|spec| spec.repetition))),
    ];
    for (index, (_, numbers)) in parameters.iter().enumerate() {
        let column = settings.iter().map(|row| row.get(index).and_then(Option::as_ref));
        columns.push(if *numbers {
            Arc::new(
                column
                    .map(
                        |setting| {
                            if let Some(Setting::Number(value)) = setting { Some(*value) } else { None }
                        },
                    )
                    .collect::<Float64Array>(),
            )
        } else {
            let text = |setting: Option<&Setting>| match setting? {
                Setting::Text(text) => Some(text.clone()),
                Setting::Number(value) => Some(value.to_string()),
            };
            Arc::new(column.map(text).collect::<StringArray>())
        });
    }
    columns.push(Arc::new(StringArray::from_iter_values(rows.iter().map(|row| row.status.name()))));
    let error = |row: &Row| (!row.error.is_empty()).then(|| row.error.clone());
    columns.push(Arc::new(rows.iter().map(error).collect::<StringArray>()));
    for name in values {
        let value = |row: &Row| Some(row.value(name)).filter(|value| value.is_finite());
        columns.push(Arc::new(rows.iter().map(value).collect::<Float64Array>()));
    }
    columns
}
