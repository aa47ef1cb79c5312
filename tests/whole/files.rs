//! What lies in the project, and what must not stand in it.

use crate::{files_below, root};
use std::path::Path;

const TOP: [&str; 19] = [
    ".ci",
    ".git",
    ".gitignore",
    "ARCHITECTURE.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "benches",
    "crates",
    "docs",
    "rustfmt.toml",
    "scenarios",
    "target",
    "terrain",
    "tests",
];

#[test]
fn the_top_folder_holds_what_it_is_meant_to_hold() {
    for entry in std::fs::read_dir(root()).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        assert!(TOP.contains(&name.as_str()) || name == "out", "`{name}` has no place at the top");
    }
    for name in TOP.iter().filter(|name| ![".git", "target"].contains(name)) {
        assert!(root().join(name).exists(), "`{name}` is missing");
    }
}

#[test]
fn every_folder_of_crates_is_a_crate() {
    for entry in std::fs::read_dir(root().join("crates")).unwrap() {
        let path = entry.unwrap().path();
        assert!(path.join("Cargo.toml").is_file() && path.join("src").is_dir(), "{}", path.display());
    }
}

/// Files as text; pictures and other bytes are left out.
fn texts() -> Vec<(String, String)> {
    let name = |path: &Path| path.strip_prefix(root()).unwrap().display().to_string();
    files_below(root())
        .iter()
        .filter(|path| path.file_name().is_some_and(|file| file != "Cargo.lock"))
        .filter_map(|path| Some((name(path), std::fs::read_to_string(path).ok()?)))
        .collect()
}

fn vendored(name: &str) -> bool {
    name.contains("/assets/")
        && (name.ends_with(".min.js") || name.contains("LICENSE") || name.contains("NOTICE"))
}

/// A path of one machine helps nobody on another. The words are put together here so that this file passes.
#[test]
fn no_file_names_a_place_on_one_machine() {
    let places: Vec<String> =
        ["work", "tmp", "home", "root", "Users"].iter().map(|folder| format!("/{folder}/")).collect();
    for (name, text) in texts().iter().filter(|(name, _)| !vendored(name)) {
        for (index, line) in text.lines().enumerate() {
            for place in &places {
                // Part of an address or of a relative path is not the top of a file system.
                let at_top = line.match_indices(place.as_str()).any(|(at, _)| {
                    line[..at]
                        .chars()
                        .next_back()
                        .is_none_or(|before| !(before.is_alphanumeric() || "./_-}".contains(before)))
                });
                assert!(!at_top, "{name}:{}: {line}", index + 1);
            }
        }
    }
}

/// Where packages come from is the business of the machine that builds.
#[test]
fn no_file_names_a_package_registry() {
    let hosts: Vec<String> =
        [["crates", "io"], ["pypi", "org"], ["npmjs", "org"], ["npmjs", "com"], ["pythonhosted", "org"]]
            .iter()
            .map(|parts| parts.join("."))
            .collect();
    for (name, text) in texts().iter().filter(|(name, _)| !vendored(name)) {
        for host in &hosts {
            assert!(!text.contains(host.as_str()), "{name} names {host}");
        }
    }
}

#[test]
fn every_foreign_asset_brings_its_licence() {
    let mut assets = 0;
    for path in files_below(&root().join("crates")) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Some(stem) = name.strip_suffix(".min.js") else { continue };
        assets += 1;
        let head: String = std::fs::read_to_string(&path).unwrap().chars().take(1200).collect();
        assert!(head.contains("icense"), "{} does not begin with its licence", path.display());
        let licence = path.with_file_name(format!("LICENSE-{stem}"));
        assert!(licence.is_file(), "{} is missing", licence.display());
    }
    assert!(assets > 0, "the drawing library of the reports was not found");
}

#[test]
fn the_licences_are_whole() {
    let apache = crate::read("LICENSE-APACHE");
    assert!(apache.contains("Version 2.0, January 2004") && apache.contains("END OF TERMS AND CONDITIONS"));
    let mit = crate::read("LICENSE-MIT");
    assert!(mit.contains("The Headland developers") && mit.contains("WITHOUT WARRANTY OF ANY KIND"));
}
