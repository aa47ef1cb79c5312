//! Progress of a batch, with the time that is left.

use crate::say::Say;
use headland_batch::Progress;
use indicatif::ProgressBar;
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Between lines of progress where nobody looks at a terminal.
const BETWEEN_LINES: Duration = Duration::from_secs(5);

/// Progress of a batch.
pub struct Pace {
    say: Say,
    bar: ProgressBar,
    begun: Instant,
    /// Runs that were finished before.
    before: u64,
    told: Mutex<Instant>,
}

impl Pace {
    /// Begins, with so many runs finished before.
    pub fn new(say: Say, total: u64, before: u64) -> Self {
        let bar = if std::io::stderr().is_terminal() {
            say.bar("runs", usize::try_from(total).unwrap_or(usize::MAX))
        } else {
            ProgressBar::hidden()
        };
        bar.set_position(before);
        bar.reset_eta();
        let begun = Instant::now();
        Self { say, bar, begun, before, told: Mutex::new(begun) }
    }

    /// Tells how far it is: a bar on a terminal, a line now and then otherwise.
    pub fn tell(&self, progress: Progress) {
        self.bar.set_position(progress.finished);
        if std::io::stderr().is_terminal() {
            return;
        }
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.elapsed() >= BETWEEN_LINES {
            *told = Instant::now();
            self.say.progress(&line(progress, self.before, self.begun.elapsed()));
        }
    }

    /// Takes the bar away.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

fn line(progress: Progress, before: u64, since: Duration) -> String {
    let Progress { finished, unfinished, total } = progress;
    let done = finished.saturating_sub(before);
    let left = if done > 0 {
        let seconds = since.as_secs_f64() * total.saturating_sub(finished) as f64 / done as f64;
        format!(", {} left", duration(seconds))
    } else {
        String::new()
    };
    let short = if unfinished > 0 { format!(", {unfinished} without an end") } else { String::new() };
    format!("{finished} of {total} runs{short}{left}")
}

/// `45 s`, `12 min`, `3.2 h`
fn duration(seconds: f64) -> String {
    if seconds < 100.0 {
        format!("{seconds:.0} s")
    } else if seconds < 5400.0 {
        format!("{:.0} min", seconds / 60.0)
    } else {
        format!("{:.1} h", seconds / 3600.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_that_is_left_counts_only_what_was_done_since_it_began() {
        let progress = Progress { finished: 500, unfinished: 2, total: 1000 };
        assert_eq!(
            line(progress, 400, Duration::from_secs(10)),
            "500 of 1000 runs, 2 without an end, 50 s left"
        );
        assert_eq!(line(progress, 500, Duration::from_secs(10)), "500 of 1000 runs, 2 without an end");
        assert_eq!((duration(1200.0), duration(7200.0)), ("20 min".to_owned(), "2.0 h".to_owned()));
    }
}
