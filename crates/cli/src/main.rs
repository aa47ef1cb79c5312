//! The program `headland`.

use std::process::ExitCode;

fn main() -> ExitCode {
    headland::run(&headland_stock::registry(), std::env::args_os())
}
