//! Every scenario of the project, read and driven.

use crate::{files_below, root};
use headland_batch::{Comparison, Plan, Status};
use headland_scenario::{Fidelity, Scenario};
use headland_sim::{Driven, End};
use std::path::PathBuf;

/// Files at the top of `scenarios/`; those below it are pieces that they include, and descriptions of recordings.
fn scenarios() -> Vec<PathBuf> {
    let folder = root().join("scenarios");
    let mut files = files_below(&folder);
    files.retain(|path| path.parent() == Some(&folder) && path.extension().is_some_and(|end| end == "ron"));
    files
}

#[test]
fn every_scenario_reads_without_a_remark_and_runs_to_its_end() {
    let registry = headland_stock::registry();
    let files = scenarios();
    assert!(files.len() >= 5, "{files:?}");
    for path in files {
        let name = path.display();
        let whole =
            Scenario::read(&path, &registry).unwrap_or_else(|error| panic!("{name}: {}", error.told()));
        assert!(whole.remarks.is_empty(), "{name}: {:?}", whole.remarks);
        let runs: Vec<Scenario> = if whole.runs.is_empty() {
            vec![whole]
        } else {
            whole.runs.iter().map(|run| whole.run(run, &registry).unwrap()).collect()
        };
        for scenario in runs {
            let Some(cycle) = &scenario.cycle else { continue };
            let outcome = scenario.fidelity.simulate(&scenario.model(&registry).unwrap(), cycle).unwrap();
            assert_eq!(outcome.end, End::Finished, "{name}");
            let short: Vec<String> = outcome.phases.iter().filter_map(Driven::told_short).collect();
            assert!(short.is_empty(), "{name}: {short:?}");
            let rigid = matches!(scenario.fidelity, Fidelity::RigidBody { .. });
            let open = if rigid { 1e-3 } else { 1e-6 };
            assert!(outcome.ledger.relative_residual() < open, "{name}: {:?}", outcome.ledger);
        }
    }
}

/// Every comparison of the project: its scenarios read, and the first run of each configuration reaches its end.
#[test]
fn every_comparison_reads_and_each_of_its_configurations_runs_to_the_end() {
    let registry = headland_stock::registry();
    let folder = root().join("scenarios/comparisons");
    let mut files = files_below(&folder);
    files.retain(|path| path.parent() == Some(&folder));
    assert!(files.len() > 1, "{files:?}");
    for path in files {
        let name = path.display();
        let comparison = Comparison::read(&path).unwrap_or_else(|error| panic!("{name}: {}", error.told()));
        let plan = Plan::new(comparison, &registry, 1).unwrap_or_else(|error| panic!("{name}: {error}"));
        let runs = plan.points() * u64::from(plan.comparison.times);
        for number in (0..plan.total()).step_by(usize::try_from(runs).unwrap()) {
            let (row, _) = headland_batch::run(&plan, &registry, number);
            assert_eq!(
                row.status,
                Status::Finished,
                "{name}: {}: {}",
                plan.called(plan.spec(number)),
                row.error
            );
        }
    }
}

/// What a scenario includes has to be used by one.
#[test]
fn every_piece_is_included_by_a_scenario() {
    let mut files = scenarios();
    for folder in ["comparisons", "vehicles"] {
        files.extend(files_below(&root().join("scenarios").join(folder)));
    }
    let texts: Vec<String> =
        files.iter().map(|path| std::fs::read_to_string(path).unwrap().replace("\"../", "\"")).collect();
    for folder in ["vehicles", "grounds", "cycles", "parts", "soils", "tyres"] {
        for path in files_below(&root().join("scenarios").join(folder)) {
            let include = format!("\"{folder}/{}\"", path.file_name().unwrap().to_string_lossy());
            assert!(texts.iter().any(|text| text.contains(&include)), "nothing includes {include}");
        }
    }
}
