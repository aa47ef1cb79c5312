//! The commands that the documentation tells people to type.

use crate::{Block, blocks, read, root};
use std::ffi::OsString;
use std::process::{Command, ExitCode};

/// What stands behind `headland` in the lines of shell blocks.
fn commands() -> Vec<(Block, Vec<String>)> {
    const CALLS: [&str; 5] = [
        "cargo run -p headland-cli -- ",
        "cargo run --release -p headland-cli -- ",
        "cargo run -p headland-cli --features rerun -- ",
        "target/release/headland ",
        "headland ",
    ];
    let mut found = Vec::new();
    for block in blocks() {
        if !["sh", "text", "console"].contains(&block.mark.as_str()) {
            continue;
        }
        for line in block.text.lines() {
            let line = line.trim().trim_start_matches("$ ");
            if block.mark != "sh" && !block.text.lines().any(|other| other.trim() == format!("$ {line}")) {
                continue;
            }
            let Some(call) = CALLS.iter().find_map(|call| line.strip_prefix(call)) else { continue };
            let words = words_of(call);
            let Block { page, line, mark, .. } = &block;
            let place = Block { page: page.clone(), line: *line, mark: mark.clone(), text: String::new() };
            found.push((place, words));
        }
    }
    found
}

/// As a shell splits a line: at spaces outside double quotes, up to a comment or to where it is written to.
fn words_of(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (index, piece) in line.split('"').enumerate() {
        if index % 2 == 1 {
            words.push(piece.to_owned());
        } else {
            words.extend(piece.split_whitespace().map(str::to_owned));
        }
    }
    let end = words.iter().position(|word| word == "#" || word == ">").unwrap_or(words.len());
    words.truncate(end);
    words
}

/// With `--help` behind it a command is read and not carried out; an option that does not exist is refused before.
#[test]
fn the_program_knows_every_command_and_option_of_the_documentation() {
    let registry = headland_stock::registry();
    let commands = commands();
    assert!(commands.len() > 5, "the documentation shows {} commands", commands.len());
    for (block, words) in commands {
        let arguments = ["headland".to_owned()].into_iter().chain(words.clone()).chain(["--help".to_owned()]);
        let status = headland::run(&registry, arguments.map(OsString::from));
        assert_eq!(
            format!("{status:?}"),
            format!("{:?}", ExitCode::SUCCESS),
            "{}:{}: headland {}",
            block.page,
            block.line,
            words.join(" ")
        );
    }
}

/// Files of `scenarios/` and `docs/` that commands name are there.
#[test]
fn the_files_of_the_commands_exist() {
    for (block, words) in commands() {
        for word in words.iter().filter(|word| word.starts_with("scenarios/") || word.starts_with("docs/")) {
            assert!(root().join(word).exists(), "{}:{}: {word}", block.page, block.line);
        }
    }
}

/// Links between pages lead somewhere.
#[test]
fn the_links_of_the_documentation_lead_to_files() {
    let mut pages: Vec<String> =
        ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"].map(String::from).into();
    pages.extend(
        crate::files_below(&root().join("docs"))
            .iter()
            .filter(|path| path.extension().is_some_and(|end| end == "md"))
            .map(|path| path.strip_prefix(root()).unwrap().display().to_string()),
    );
    for page in pages {
        let folder = root().join(&page).parent().unwrap().to_owned();
        for link in read(&page).split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let file = link.split('#').next().unwrap();
            if file.is_empty() || file.contains("://") {
                continue;
            }
            assert!(folder.join(file).exists(), "{page}: {link}");
        }
    }
}

/// `.ci/run` runs the test command of the README, word for word.
#[test]
fn the_test_command_of_the_readme_is_what_is_run_on_every_change() {
    let readme = read("README.md");
    let command = readme.lines().map(str::trim).find(|line| line.starts_with("cargo test")).unwrap();
    assert!(read(".ci/run").lines().any(|line| line.trim() == command), "`{command}` is not in .ci/run");
}

/// A shell that cannot read the script could not run it.
#[test]
fn the_script_of_every_change_is_sound_shell() {
    if let Ok(status) = Command::new("bash").arg("-n").arg(root().join(".ci/run")).status() {
        assert!(status.success());
    }
}
