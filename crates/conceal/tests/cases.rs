//! Sets of cases: the same bits from the same seed, whole folders, and a score that goes over them.

use headland_conceal::{Probe, Truth, generate, kind_of, score};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

fn bits(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(path).unwrap()))
        .collect()
}

#[test]
fn the_same_seed_makes_the_same_bits_and_another_seed_others() {
    let folder = tempfile::tempdir().unwrap();
    let make = |name: &str, seed| {
        let into = folder.path().join(name);
        generate(seed, 3, Probe::No).unwrap().write(&into).unwrap();
        bits(&into)
    };
    let first = make("a", 11);
    assert_eq!(first, make("b", 11));
    assert_ne!(first["run_01.csv"], make("c", 12)["run_01.csv"]);
}

/// Of a hundred: 35 with one cause, 20 with two, 15 unlisted, 20 empty, 10 faulty, each numbered on its own.
#[test]
fn kinds_are_dealt_in_their_shares() {
    let mut numbers: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for case in 0..100 {
        let (kind, number) = kind_of(case);
        numbers.entry(kind.name()).or_default().push(number);
    }
    let counts: Vec<(&str, usize)> = numbers.iter().map(|(kind, all)| (*kind, all.len())).collect();
    let expected = [
        ("artefact", 10),
        ("empty", 20),
        ("single", 35),
        ("two", 10),
        ("two_sensor", 5),
        ("two_unlisted", 5),
        ("unlisted", 15),
    ];
    assert_eq!(counts, expected);
    assert!(numbers.values().all(|all| all.iter().copied().eq(0..all.len())));
}

#[test]
fn a_case_holds_known_channels_and_a_truth_that_its_scenario_does_not_tell() {
    for case in 0..8 {
        let made = generate(5, case, Probe::No).unwrap();
        let folder = tempfile::tempdir().unwrap();
        made.write(folder.path()).unwrap();
        let truth = Truth::read(folder.path()).unwrap();
        let ids = |truth: &Truth| truth.hidden.iter().map(|cause| cause.column.clone()).collect::<Vec<_>>();
        assert_eq!((ids(&truth), &truth.held_out), (ids(&made.truth), &made.truth.held_out), "case {case}");
        assert!(truth.held_out.len() <= 4 && made.logs.len() >= truth.held_out.len() + 2, "case {case}");
        for log in &made.logs {
            for channel in log.trace.channels() {
                assert!(headland_trace::names::is_known(&channel.name), "{}", channel.name);
            }
            assert!(log.trace.duration_s() > 2.0, "case {case}, {}", log.id);
        }
        let scenario = fs::read_to_string(folder.path().join("scenario.ron")).unwrap();
        let recording = fs::read_to_string(folder.path().join("recording.ron")).unwrap();
        for cause in &truth.hidden {
            assert!(!scenario.contains(&cause.id) && !recording.contains(&cause.id), "case {case}");
        }
        for prior in truth.nominal.iter().filter(|prior| prior.free) {
            assert!((prior.nominal - prior.truth).abs() <= 1.81 * prior.sd, "{}", prior.path);
            assert!(scenario.contains(&prior.path));
        }
    }
}

/// Speeds stay between walking pace and the motorway, and no hidden cause is nothing or everything.
#[test]
fn no_case_stands_still_or_runs_away() {
    for case in 0..20 {
        let made = generate(2, case, Probe::No).unwrap();
        for run in &made.along {
            let speed = run.trace.get("speed_m_s").unwrap();
            assert!(speed.iter().all(|v| (0.3..45.0).contains(v)), "case {case}, {}", run.id);
        }
        for cause in &made.truth.hidden {
            assert!(cause.strength > 0.05 && cause.strength < 500.0, "case {case}: {cause:?}");
        }
    }
}

/// A program that says nothing was found: empty cases are right, hidden causes missed, and nothing is run twice.
#[cfg(unix)]
#[test]
fn a_set_is_scored_with_a_program_and_goes_on_where_it_stopped() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    for case in [0, 1, 3] {
        generate(1, case, Probe::No).unwrap().write(&folder.path().join(format!("case_{case:03}"))).unwrap();
    }
    let program = folder.path().join("diagnoser");
    // Arguments: diagnose SCENARIO --recording RECORDING --out DIR --quiet
    fs::write(&program, "#!/bin/sh\nprintf '{\"verdict\": \"none\", \"findings\": []}' > \"$6/diagnosis.json\"\necho ran >> \"$6/count\"\n").unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let options = score::Options { program, without_truth: false, run: true, jobs: 2, limit_s: 60.0 };
    let first = score::all(folder.path(), &options, |_| ()).unwrap();
    let again = score::all(folder.path(), &options, |_| ()).unwrap();
    assert_eq!(fs::read_to_string(folder.path().join("case_000/out/count")).unwrap(), "ran\n");
    let found: Vec<_> = again.iter().map(|one| one.outcome.as_ref().unwrap().found.clone()).collect();
    assert_eq!(found, [vec![score::Found::Missed], vec![], vec![score::Found::Missed; 2]]);
    let page = score::page(&first, &options);
    assert!(page.contains("| nothing hidden: a false alarm | 0.0 % |"), "{page}");
    assert!(page.contains("| one cause, of any strength | 0.0 % |"), "{page}");
    assert!(page.contains("case_003"), "{page}");
}

#[test]
fn a_folder_without_cases_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let options = score::Options {
        program: "headland".into(),
        without_truth: false,
        run: false,
        jobs: 1,
        limit_s: 60.0,
    };
    let error = score::all(folder.path(), &options, |_| ()).unwrap_err().to_string();
    assert!(error.contains("holds no case"), "{error}");
}

/// Layouts differ from case to case: numbers of runs, ways, rates, uneven rows, what is told and what is measured.
#[test]
fn no_two_layouts_are_alike() {
    let folder = tempfile::tempdir().unwrap();
    let (mut runs, mut rates, mut told, mut ways) = (Vec::new(), Vec::new(), [0, 0], [0, 0]);
    for case in 0..12 {
        let made = generate(21, case, Probe::No).unwrap();
        made.write(folder.path()).unwrap();
        let recording = fs::read_to_string(folder.path().join("recording.ron")).unwrap();
        told[usize::from(recording.contains("held_out"))] += 1;
        assert_eq!(made.truth.held_out.is_empty(), !recording.contains("held_out"), "case {case}");
        ways[usize::from(recording.contains("reversed"))] += 1;
        runs.push(made.logs.len());
        rates.push((made.logs[0].trace.len() as f64 / made.logs[0].trace.duration_s()).round());
        // What a scenario with the hidden effect needs is whole, or not there.
        if let Some(effects) = &made.truth.oracle {
            let scenario = fs::read_to_string(folder.path().join("oracle.ron")).unwrap();
            assert!(scenario.contains(effects));
        }
        let _ = fs::remove_file(folder.path().join("oracle.ron"));
    }
    runs.sort_unstable();
    runs.dedup();
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    assert!(runs.len() >= 4 && rates.len() >= 3, "{runs:?} {rates:?}");
    assert!(told.iter().chain(&ways).all(|count| *count > 0), "{told:?} {ways:?}");
}
