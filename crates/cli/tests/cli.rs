//! The program as its users meet it: commands in, files and exit status out.
#![expect(clippy::print_stderr, reason = "a test that is skipped, or that measures, says so")]

#[path = "cli/bad_input.rs"]
mod bad_input;
#[cfg(unix)]
#[path = "cli/batch.rs"]
mod batch;
#[path = "cli/commands.rs"]
mod commands;
#[path = "cli/help.rs"]
mod help;
#[cfg(unix)]
#[path = "cli/interruption.rs"]
mod interruption;
#[path = "cli/large.rs"]
mod large;
#[path = "cli/optimum.rs"]
mod optimum;
#[path = "cli/replayed.rs"]
mod replayed;
#[path = "cli/scenarios.rs"]
mod scenarios;
