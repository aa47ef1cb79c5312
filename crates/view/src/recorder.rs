//! Messages as Rerun stores them, collected in memory.

use crate::ViewError;
use crate::axis::Span;
use rerun::log::{Chunk, LogMsg, RowId};
use rerun::sink::MemorySinkStorage;
use rerun::time::{TimePoint, Timeline};
use rerun::{
    AsComponents, EntityPath, RecordingStream, RecordingStreamBuilder, SerializationResult,
    SerializedComponentColumn, TimeColumn,
};
use std::cell::RefCell;

/// The one timeline [s].
pub(crate) const TIMELINE: &str = "time";

/// A recording, or the blueprint that belongs to it.
pub(crate) struct Recorder {
    stream: RecordingStream,
    storage: MemorySinkStorage,
    spans: RefCell<Vec<(EntityPath, Span)>>,
}

pub(crate) fn encode(error: impl std::fmt::Display) -> ViewError {
    ViewError::Encode { reason: error.to_string() }
}

#[expect(clippy::cast_possible_truncation, reason = "nanoseconds of three centuries fit")]
pub(crate) fn nanoseconds(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}

impl Recorder {
    pub(crate) fn new(builder: RecordingStreamBuilder) -> Result<Self, ViewError> {
        let (stream, storage) = builder.enabled(true).memory().map_err(encode)?;
        Ok(Self { stream, storage, spans: RefCell::default() })
    }

    /// The stream that everything goes through.
    pub(crate) fn stream(&self) -> &RecordingStream {
        &self.stream
    }

    /// What holds at any time.
    pub(crate) fn fixed(&self, at: &EntityPath, what: &dyn AsComponents) -> Result<(), ViewError> {
        self.stream.log_static(at.clone(), what).map_err(encode)
    }

    /// What holds from a time on.
    pub(crate) fn at(&self, at: &EntityPath, time_s: f64, what: &dyn AsComponents) -> Result<(), ViewError> {
        // The stream's own `log` would add the time at which it was written.
        let time = TimePoint::default().with(Timeline::new_duration(TIMELINE), nanoseconds(time_s));
        let chunk =
            Chunk::builder(at.clone()).with_archetype(RowId::new(), time, what).build().map_err(encode)?;
        self.stream.send_chunk(chunk);
        Ok(())
    }

    /// What changes: one row for each time.
    pub(crate) fn rows<C>(
        &self,
        at: &EntityPath,
        times_s: impl IntoIterator<Item = f64>,
        columns: SerializationResult<C>,
    ) -> Result<(), ViewError>
    where
        C: Iterator<Item = SerializedComponentColumn>,
    {
        let times = TimeColumn::new_duration_secs(TIMELINE, times_s);
        self.stream.send_columns(at.clone(), [times], columns.map_err(encode)?).map_err(encode)
    }

    /// Notes from where to where the values of a line go.
    pub(crate) fn note(&self, at: &EntityPath, span: Option<Span>) {
        self.spans.borrow_mut().extend(span.map(|span| (at.clone(), span)));
    }

    /// From where to where all lines below these entities go.
    pub(crate) fn span(&self, below: &[EntityPath]) -> Option<Span> {
        let spans = self.spans.borrow();
        let drawn = spans.iter().filter(|(at, _)| below.iter().any(|above| at.starts_with(above)));
        drawn.map(|(_, span)| *span).reduce(Span::with)
    }

    pub(crate) fn finish(self) -> Vec<LogMsg> {
        self.storage.take()
    }
}
