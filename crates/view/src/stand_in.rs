//! Scripts that stand in for the viewer in tests.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A program called `rerun` in a folder. A shell writes it, not this process: what another test starts while a file is open
/// for writing here would hold it open as well, and a program that is open for writing cannot be started.
pub(crate) fn program(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("rerun");
    let writes = r#"printf '#!/bin/sh\n%s\n' "$1" > "$0" && chmod 755 "$0""#;
    let status = Command::new("sh").args(["-c", writes]).arg(&path).arg(text).status().unwrap();
    assert!(status.success(), "{status}");
    path
}
