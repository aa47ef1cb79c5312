//! What a command says: results on standard output, progress and mistakes on standard error.

use crate::failure::Failure;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::io::{IsTerminal, Write};

/// The voice of a command.
#[derive(Clone, Copy, Debug)]
pub struct Say {
    quiet: bool,
    json: bool,
}

impl Say {
    /// A voice.
    pub fn new(quiet: bool, json: bool) -> Self {
        Self { quiet, json }
    }

    /// The result: `text` for a person, or the document.
    pub fn result(self, text: &str, document: &impl Serialize) -> Result<(), Failure> {
        let mut out = std::io::stdout().lock();
        let written = if self.json {
            let json = serde_json::to_string_pretty(document)
                .map_err(|error| Failure::Machine(format!("cannot write JSON: {error}")))?;
            writeln!(out, "{json}")
        } else {
            writeln!(out, "{}", text.trim_end())
        };
        match written.and_then(|()| out.flush()) {
            // A reader that has read enough, such as `head`, is no failure.
            Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
                Err(Failure::Machine(format!("cannot write to standard output: {error}")))
            }
            _ => Ok(()),
        }
    }

    /// A line of progress.
    pub fn progress(self, line: &str) {
        if !self.quiet {
            let _ = writeln!(std::io::stderr(), "{line}");
        }
    }

    /// A bar of progress: drawn on a terminal, a plain line at the start and the end otherwise.
    pub fn bar(self, what: &str, length: usize) -> ProgressBar {
        if self.quiet || !std::io::stderr().is_terminal() {
            if !self.quiet {
                self.progress(&format!("{what}: {length}"));
            }
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::with_draw_target(Some(length as u64), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}") {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        bar
    }

    /// Why the command did not end well.
    pub fn failure(failure: &Failure) {
        let word = if matches!(failure, Failure::Requirement(_)) { "not met" } else { "error" };
        let _ = writeln!(std::io::stderr(), "{word}: {failure}");
    }
}
