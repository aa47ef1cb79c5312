//! Every piece of RON in the documentation, read by what reads it in a file.
//!
//! A fence is marked `ron scenario`, `ron recording` (with the logs beside it as `csv NAME`) or `ron`, for a piece that has
//! to be RON and no more.

use crate::{Block, blocks, root};
use headland_batch::{Comparison, Plan, Status};
use headland_scenario::{Document, Scenario};
use headland_sim::End;

fn of_mark(mark: &str) -> Vec<Block> {
    let found: Vec<Block> = blocks().into_iter().filter(|block| block.mark == mark).collect();
    assert!(!found.is_empty(), "the documentation has no block marked `{mark}`");
    found
}

#[test]
fn every_ron_block_says_what_it_is() {
    for block in blocks().iter().filter(|block| block.mark.starts_with("ron")) {
        let known = ["ron", "ron scenario", "ron comparison", "ron recording"].contains(&block.mark.as_str());
        assert!(known, "{}:{}: `{}`", block.page, block.line, block.mark);
    }
}

/// As if the block lay in `scenarios/`, so that it can include what is there.
#[test]
fn every_scenario_of_the_documentation_reads_and_runs() {
    let registry = headland_stock::registry();
    for block in of_mark("ron scenario") {
        let name = format!("{}:{}", block.page, block.line);
        let folder = root().join("scenarios");
        let whole = Scenario::of_text(&name, &block.text, &folder, &registry)
            .unwrap_or_else(|error| panic!("{name}: {}", error.told()));
        let runs: Vec<Scenario> = if whole.runs.is_empty() {
            vec![whole]
        } else {
            whole.runs.iter().map(|run| whole.run(run, &registry).unwrap()).collect()
        };
        for scenario in runs {
            let Some(cycle) = &scenario.cycle else { continue };
            let outcome = scenario.fidelity.simulate(&scenario.model(&registry).unwrap(), cycle).unwrap();
            assert_eq!(outcome.end, End::Finished, "{name}");
        }
    }
}

/// As if the block lay in `scenarios/`: every scenario that it stands for reads, and the first run of each ends well.
#[test]
fn every_comparison_of_the_documentation_reads_and_runs() {
    let registry = headland_stock::registry();
    for block in of_mark("ron comparison") {
        let name = format!("{}:{}", block.page, block.line);
        let comparison = Comparison::of_text(&name, &block.text, &root().join("scenarios"))
            .unwrap_or_else(|error| panic!("{name}: {}", error.told()));
        let plan = Plan::new(comparison, &registry, 1).unwrap_or_else(|error| panic!("{name}: {error}"));
        let runs = plan.points() * u64::from(plan.comparison.times);
        for number in (0..plan.total()).step_by(usize::try_from(runs).unwrap()) {
            let (row, _) = headland_batch::run(&plan, &registry, number);
            assert_eq!(row.status, Status::Finished, "{name}: {}", row.error);
        }
    }
}

/// The description is read beside the logs that the page shows: blocks marked `csv NAME`.
#[test]
fn every_recording_of_the_documentation_reads_the_log_beside_it() {
    for block in of_mark("ron recording") {
        let folder = tempfile::tempdir().unwrap();
        for log in blocks().iter().filter(|log| log.page == block.page) {
            if let Some(name) = log.mark.strip_prefix("csv ") {
                std::fs::write(folder.path().join(name), &log.text).unwrap();
            }
        }
        let path = folder.path().join("recording.ron");
        std::fs::write(&path, &block.text).unwrap();
        let recording = headland_recording::load(&path)
            .unwrap_or_else(|error| panic!("{}:{}: {error}", block.page, block.line));
        assert!(recording.runs.iter().all(|run| run.trace.len() > 1), "{}:{}", block.page, block.line);
    }
}

#[test]
fn every_other_piece_of_the_documentation_is_ron() {
    for block in of_mark("ron") {
        let text = format!("({})", block.text);
        let name = format!("{}:{}", block.page, block.line);
        if let Err(error) = Document::of_text(&name, &text, &root().join("scenarios")) {
            panic!("{name}: {}", error.told());
        }
    }
}
