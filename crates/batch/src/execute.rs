//! Running what is not finished yet, on all threads.
//!
//! Each thread takes the next number; one more writes what is finished to the journal, what came within a twentieth of a second at
//! once. A run sees nothing of any other, so its numbers do not depend on when or where it ran.

use crate::error::BatchError;
use crate::journal::Journal;
use crate::plan::Plan;
use crate::row::{Row, Status};
use headland_plugin::Registry;
use headland_scenario::Scenario;
use headland_sim::End;
use headland_trace::{Run, Trace, write_parquet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

/// How a batch is run.
pub struct Settings<'a> {
    /// Whether the trace of every run is kept, in `runs/<number>/trace.parquet`.
    pub traces: bool,
    /// Whether to stop, without finishing what is being run.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Told after rows were written.
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

/// How far a batch is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Runs that are finished, those of earlier times included.
    pub finished: u64,
    /// Runs of this time that did not reach the end of their cycle.
    pub unfinished: u64,
    /// All runs.
    pub total: u64,
}

/// Rows that wait for the disk; no thread runs ahead of it by more. A disk that is slow for a tenth of a second holds up nobody.
const WAITING_ROWS: usize = 2048;

/// So long rows are gathered before they are written: each writing waits for the disk, and takes time from the runs.
const GATHERED: Duration = Duration::from_millis(50);

/// Runs everything that is not finished yet.
///
/// # Errors
/// [`BatchError::Interrupted`], or what the journal or a trace refuses. What was finished is in the journal.
pub fn execute(
    plan: &Plan,
    registry: &Registry,
    journal: &mut Journal,
    settings: &Settings<'_>,
) -> Result<(), BatchError> {
    let folder = journal.folder().to_owned();
    let done = Done::of(plan, journal);
    let next = AtomicU64::new(0);
    let halt = AtomicBool::new(false);
    let trouble: Mutex<Option<BatchError>> = Mutex::new(None);
    let (sender, receiver) = sync_channel(WAITING_ROWS);
    let fail = |error: BatchError| {
        halt.store(true, Ordering::SeqCst);
        if let Ok(mut trouble) = trouble.lock() {
            trouble.get_or_insert(error);
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(|| {
            if let Err(error) = write(journal, &receiver, plan.total(), settings.progress) {
                fail(error);
            }
            // Whoever still sends must not wait for a reader that has gone.
            for _ in receiver {}
        });
        rayon::broadcast(|_| {
            let sender = sender.clone();
            while !halt.load(Ordering::SeqCst) {
                if (settings.stop)() {
                    fail(BatchError::Interrupted);
                    return;
                }
                let number = next.fetch_add(1, Ordering::SeqCst);
                if number >= plan.total() {
                    return;
                }
                let trace_file = settings.traces.then(|| trace_path(&folder, number));
                let traced = trace_file.as_deref().is_none_or(holds_something);
                if done.has(number) && traced {
                    continue;
                }
                // One that is interrupted is run again as a whole.
                let Some((row, trace)) = run_unless(plan, registry, number, settings.stop) else {
                    fail(BatchError::Interrupted);
                    return;
                };
                if let (Some(path), Some(trace)) = (trace_file, trace)
                    && let Err(error) = keep(&path, number, trace)
                {
                    fail(error);
                    return;
                }
                if !done.has(number) && sender.send(row).is_err() {
                    return;
                }
            }
        });
        drop(sender);
    });
    match trouble.into_inner() {
        Ok(Some(error)) => Err(error),
        _ => Ok(()),
    }
}

fn write(
    journal: &mut Journal,
    receiver: &Receiver<Row>,
    total: u64,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<(), BatchError> {
    let mut unfinished = 0;
    let mut rows = Vec::new();
    while let Ok(row) = receiver.recv() {
        let written_by = Instant::now() + GATHERED;
        rows.push(row);
        while rows.len() < WAITING_ROWS
            && let Ok(row) = receiver.recv_timeout(written_by.saturating_duration_since(Instant::now()))
        {
            rows.push(row);
        }
        unfinished += rows.iter().filter(|row| row.status != Status::Finished).count() as u64;
        journal.append(&rows)?;
        rows.clear();
        progress(Progress { finished: journal.finished(), unfinished, total });
    }
    Ok(())
}

/// One bit a run.
struct Done(Vec<u64>);

impl Done {
    fn of(plan: &Plan, journal: &Journal) -> Self {
        let words = usize::try_from(plan.total() / 64).unwrap_or(0) + 1;
        let mut bits = vec![0; words];
        for number in (0..plan.total()).filter(|number| journal.has(*number)) {
            if let Some(word) = usize::try_from(number / 64).ok().and_then(|index| bits.get_mut(index)) {
                *word |= 1 << (number % 64);
            }
        }
        Self(bits)
    }

    fn has(&self, number: u64) -> bool {
        let word = usize::try_from(number / 64).ok().and_then(|index| self.0.get(index));
        word.is_some_and(|word| word >> (number % 64) & 1 == 1)
    }
}

/// Simulates one run, whatever happens in it.
pub fn run(plan: &Plan, registry: &Registry, number: u64) -> (Row, Option<Trace>) {
    let whole = run_unless(plan, registry, number, &|| false);
    whole.unwrap_or_else(|| (Row::without(number, Status::Failed, "it was interrupted".to_owned()), None))
}

/// As [`run`]; `None` where `stop` says so before it has ended.
fn run_unless(
    plan: &Plan,
    registry: &Registry,
    number: u64,
    stop: &dyn Fn() -> bool,
) -> Option<(Row, Option<Trace>)> {
    let spec = plan.spec(number);
    let simulated = catch_unwind(AssertUnwindSafe(|| {
        let read = plan.document(spec).and_then(|document| Scenario::with_model(document, registry));
        let (scenario, model) = match read {
            Ok(both) => both,
            Err(error) => return Some((Row::without(number, Status::Refused, error.to_string()), None)),
        };
        let Some(cycle) = &scenario.cycle else {
            return Some((Row::without(number, Status::Refused, "there is no cycle".to_owned()), None));
        };
        Some(match scenario.fidelity.simulate_unless(&model, cycle, stop) {
            Ok(outcome) if matches!(outcome.end, End::Interrupted { .. }) => return None,
            Ok(outcome) if outcome.ledger.turnover_j().is_finite() => {
                (Row::of(number, &outcome, &plan.comparison.accounting), Some(outcome.trace))
            }
            Ok(_) => {
                let error = "its energies are no finite numbers; look at the parameters of the models";
                (Row::without(number, Status::Refused, error.to_owned()), None)
            }
            Err(error) => (Row::without(number, Status::Failed, error.to_string()), None),
        })
    }));
    simulated.unwrap_or_else(|panic| {
        let words = panic
            .downcast_ref::<String>()
            .map(String::as_str)
            .or_else(|| panic.downcast_ref::<&str>().copied())
            .unwrap_or("a model panicked without a word");
        Some((Row::without(number, Status::Failed, words.to_owned()), None))
    })
}

/// Where the trace of a run lies, below the folder of the batch.
pub fn trace_path(folder: &Path, number: u64) -> PathBuf {
    folder.join("runs").join(format!("{number:06}")).join("trace.parquet")
}

fn holds_something(path: &Path) -> bool {
    path.metadata().is_ok_and(|file| file.len() > 0)
}

fn keep(path: &Path, number: u64, trace: Trace) -> Result<(), BatchError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .map_err(|source| BatchError::File { path: folder.to_owned(), source })?;
    }
    Ok(write_parquet(path, &[Run { id: number.to_string(), trace }])?)
}
