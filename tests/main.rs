//! Tests of the whole: what no single crate can hold.

#![allow(clippy::unwrap_used, reason = "a test stops where its subject is missing")]

#[path = "whole/commands.rs"]
mod commands;
#[path = "whole/cvt_map.rs"]
mod cvt_map;
#[path = "whole/days.rs"]
mod days;
#[path = "whole/evidence.rs"]
mod evidence;
#[path = "whole/files.rs"]
mod files;
#[path = "whole/hybrids.rs"]
mod hybrids;
#[path = "whole/layers.rs"]
mod layers;
#[path = "whole/managements.rs"]
mod managements;
#[path = "whole/models.rs"]
mod models;
#[path = "whole/scenarios.rs"]
mod scenarios;
#[path = "whole/schema.rs"]
mod schema;
#[path = "whole/snippets.rs"]
mod snippets;
#[path = "whole/soil_files.rs"]
mod soil_files;
#[path = "whole/terrain_files.rs"]
mod terrain_files;
#[path = "whole/terrain_formulas.rs"]
mod terrain_formulas;
#[path = "whole/terrains.rs"]
mod terrains;
#[path = "whole/wheels.rs"]
mod wheels;

use std::path::{Path, PathBuf};

/// The folder of the workspace.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A file of the project.
fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Every file below a folder of the project that is not built or fetched, in order of name.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    const MADE: [&str; 5] = [".git", "target", "out", "__pycache__", "node_modules"];
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if !MADE.contains(&name.as_str()) {
                found.extend(files_below(&path));
            }
        } else {
            found.push(path);
        }
    }
    found
}

/// A fenced block of a Markdown page.
struct Block {
    page: String,
    line: usize,
    /// What stands behind the fence, as in `ron scenario`.
    mark: String,
    text: String,
}

/// The fenced blocks of README, ARCHITECTURE, CONTRIBUTING and everything in `docs/`.
fn blocks() -> Vec<Block> {
    let mut pages: Vec<PathBuf> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].iter().map(|name| root().join(name)).collect();
    pages.extend(
        files_below(&root().join("docs"))
            .into_iter()
            .filter(|path| path.extension().is_some_and(|end| end == "md")),
    );
    pages.iter().flat_map(|page| blocks_of(page)).collect()
}

fn blocks_of(page: &Path) -> Vec<Block> {
    let name = page.strip_prefix(root()).unwrap().display().to_string();
    let text = std::fs::read_to_string(page).unwrap();
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for (index, line) in text.lines().enumerate() {
        match (line.trim_start().strip_prefix("```"), open.take()) {
            (Some(mark), None) => {
                let (page, mark) = (name.clone(), mark.trim().to_owned());
                open = Some(Block { page, line: index + 1, mark, text: String::new() });
            }
            (Some(_), Some(block)) => blocks.push(block),
            (None, Some(mut block)) => {
                block.text.push_str(line);
                block.text.push('\n');
                open = Some(block);
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "{name}: a fence is not closed");
    blocks
}
