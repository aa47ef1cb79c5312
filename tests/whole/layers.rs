//! The layers of ARCHITECTURE.md, held against what Cargo knows.

use crate::{read, root};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// What a crate may depend on.
#[derive(Debug, PartialEq)]
enum Allowed {
    All,
    These(BTreeSet<String>),
}

/// The crate table: `| names | one line | names, '-' or 'all' |`, each name in backticks.
fn table() -> BTreeMap<String, Allowed> {
    let names =
        |cell: &str| -> BTreeSet<String> { cell.split('`').skip(1).step_by(2).map(str::to_owned).collect() };
    let mut table = BTreeMap::new();
    for line in read("ARCHITECTURE.md").lines() {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        let [crates, _, may] = cells[..] else { continue };
        for name in names(crates) {
            let allowed = if may == "all" { Allowed::All } else { Allowed::These(names(may)) };
            assert!(may == "-" || allowed != Allowed::These(BTreeSet::new()), "`{name}` has no third cell");
            assert!(table.insert(name.clone(), allowed).is_none(), "`{name}` has two rows");
        }
    }
    table
}

fn packages() -> Vec<Value> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

/// Our crates, by the name of their folder.
fn crates() -> BTreeMap<String, Value> {
    packages()
        .into_iter()
        .filter_map(|package| {
            let name = package["name"].as_str()?.strip_prefix("headland-")?.to_owned();
            Some((name, package))
        })
        .collect()
}

/// The crates of ours that a package names in its dependencies; `tests` for those that only its tests use.
fn edges(package: &Value, tests: bool) -> BTreeSet<String> {
    let dependencies = package["dependencies"].as_array().unwrap();
    dependencies
        .iter()
        .filter(|dependency| (dependency["kind"] == "dev") == tests)
        .filter_map(|dependency| dependency["name"].as_str()?.strip_prefix("headland-").map(str::to_owned))
        .collect()
}

#[test]
fn no_crate_depends_on_what_the_table_does_not_allow() {
    let table = table();
    assert!(table.len() > 10, "the table of ARCHITECTURE.md was not found");
    for (name, package) in crates() {
        let allowed = table.get(&name).unwrap_or_else(|| panic!("ARCHITECTURE.md has no row for `{name}`"));
        let Allowed::These(allowed) = allowed else { continue };
        let beyond: Vec<_> = edges(&package, false).difference(allowed).cloned().collect();
        assert!(beyond.is_empty(), "`{name}` depends on {beyond:?}, which ARCHITECTURE.md does not allow");
    }
}

#[test]
fn the_table_names_no_crate_that_does_not_exist() {
    let crates = crates();
    for (name, allowed) in table() {
        assert!(crates.contains_key(&name), "the row of `{name}` stands for nothing");
        if let Allowed::These(allowed) = allowed {
            for other in allowed {
                assert!(
                    crates.contains_key(&other),
                    "the row of `{name}` allows `{other}`, which does not exist"
                );
            }
        }
    }
}

#[test]
fn the_table_allows_no_circle() {
    let table = table();
    let mut placed: BTreeSet<String> = BTreeSet::new();
    while placed.len() < table.len() {
        let next = table.iter().find(|(name, allowed)| {
            !placed.contains(*name)
                && match allowed {
                    Allowed::All => placed.len() + 1 == table.len(),
                    Allowed::These(these) => these.is_subset(&placed),
                }
        });
        let (name, _) = next.unwrap_or_else(|| panic!("a circle among the crates beyond {placed:?}"));
        placed.insert(name.clone());
    }
}

#[test]
fn families_of_plugins_never_see_each_other_not_even_in_tests() {
    const FAMILIES: [&str; 5] = ["soil", "terrain", "driveline", "task", "effect"];
    let crates = crates();
    for family in FAMILIES {
        for tests in [false, true] {
            let seen = edges(&crates[family], tests);
            assert!(FAMILIES.iter().all(|other| !seen.contains(*other)), "`{family}` sees {seen:?}");
        }
    }
}

#[test]
fn only_view_imports_rerun_and_only_body_rapier() {
    for (name, package) in crates() {
        let imports =
            |what: &str| package["dependencies"].as_array().unwrap().iter().any(|one| one["name"] == what);
        assert_eq!(imports("rerun"), name == "view", "`{name}`");
        assert_eq!(imports("rapier3d-f64"), name == "body", "`{name}`");
    }
}

#[test]
fn every_crate_lies_in_a_folder_of_its_name_and_says_what_it_is() {
    for (name, package) in crates() {
        let manifest = package["manifest_path"].as_str().unwrap().replace('\\', "/");
        assert!(manifest.ends_with(&format!("/crates/{name}/Cargo.toml")), "{manifest}");
        let description = package["description"].as_str().unwrap_or("");
        assert!(description.len() > 10, "`{name}` has no description");
        assert_eq!(package["license"], "MIT OR Apache-2.0", "`{name}`");
        assert_eq!(package["rust_version"], "1.95", "`{name}`");
    }
}

#[test]
fn every_crate_has_the_lints_of_the_workspace() {
    for name in crates().keys() {
        let manifest = read(format!("crates/{name}/Cargo.toml"));
        assert!(manifest.contains("[lints]\nworkspace = true"), "`{name}`");
    }
}

/// Rerun is hundreds of crates: a bare build leaves it out, and nothing else.
#[test]
fn a_bare_build_leaves_out_view_alone() {
    let manifest = read("Cargo.toml");
    let members = manifest.lines().find(|line| line.starts_with("default-members")).unwrap();
    for name in crates().keys() {
        let default = members.contains(&format!("\"crates/{name}\""));
        assert_eq!(default, name != "view", "`{name}` in default-members of Cargo.toml");
    }
}
