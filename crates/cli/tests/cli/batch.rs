//! A batch survives whatever ends it: killed, interrupted, a full disk, a folder that is gone.

use super::help::{Place, headland, top, word};
use std::io::Write;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Carts that roll out; with the points below some hundred runs of some milliseconds.
const COMPARISON: &str = r#"(
    about: "carts",
    variants: [(name: "light", with: {"vehicle.mass_kg": 500}), (name: "heavy", with: {"vehicle.mass_kg": 2000})],
    cycles: [(name: "roll", cycle: [Coast(until: Elapsed(for_s: 100))])],
    vehicle: (name: "cart", mass_kg: 1000, rotating_mass_kg: 0, drag_area_m2: 2, driveline: Neutral),
    ground: (terrain: Flat, soil: LinearSpeedLaw(coefficient: 0.002, speed_scale_m_s: 20)),
    air: (density_kg_m3: 1.2),
    start: (position_m: 0, speed_m_s: 10),
    sweep: {"vehicle.drag_area_m2": [1.0, 2.0]},
    sample: (count: 20, seed: 3, of: {"start.speed_m_s": (8, 12)}),
    repeat: (times: 4, seed: 1, scatter: {"ground.soil.coefficient": Share(0.1)}),
    simulation: (fidelity: Longitudinal, step_s: 0.01),
)"#;
const RUNS: u64 = 2 * 2 * 20 * 4;

fn place(text: &str) -> Place {
    let place = Place::new();
    place.write("comparison.ron", text);
    place
}

fn batch(place: &Place, out: &str, more: &[&str]) -> Command {
    let mut command = headland();
    command.args(["batch", &place.path("comparison.ron"), "--out", &place.path(out)]).args(more);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn output(mut command: Command) -> Output {
    command.stdout(Stdio::piped()).output().unwrap()
}

fn status(command: Command) -> (Option<i32>, String) {
    let output = output(command);
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn bytes(place: &Place, name: &str) -> Vec<u8> {
    std::fs::read(place.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// What an uninterrupted batch leaves, on one thread.
fn reference(place: &Place) -> [Vec<u8>; 3] {
    let (code, told) = status(batch(place, "reference", &["--threads", "1"]));
    assert_eq!(code, Some(0), "{told}");
    ["results.parquet", "summary.json", "report.html"].map(|name| bytes(place, &format!("reference/{name}")))
}

fn same_as(place: &Place, out: &str, reference: &[Vec<u8>; 3]) {
    for (name, expected) in ["results.parquet", "summary.json", "report.html"].iter().zip(reference) {
        assert!(bytes(place, &format!("{out}/{name}")) == *expected, "{name} of {out} differs");
    }
    let length = |out: &str| bytes(place, &format!("{out}/journal.headland")).len();
    assert_eq!(length(out), length("reference"), "a run stands in the journal twice, or not at all");
}

#[test]
fn results_are_the_same_bytes_at_any_number_of_threads() {
    let place = place(COMPARISON);
    let reference = reference(&place);
    for threads in ["2", "5"] {
        let out = format!("out{threads}");
        assert_eq!(status(batch(&place, &out, &["--threads", threads])).0, Some(0));
        same_as(&place, &out, &reference);
    }
    assert_eq!(status(batch(&place, "other", &["--seed", "2"])).0, Some(0));
    assert!(bytes(&place, "other/results.parquet") != reference[0], "the seed of the command line counts");
}

/// The runs that the journal held when it was opened.
fn already(told: &str) -> u64 {
    let line = told.lines().find(|line| line.contains("finished already"));
    line.map_or(0, |line| line.split(' ').next().unwrap().parse().unwrap())
}

/// Killed at moments that differ from time to time, with no chance to tidy up.
#[test]
fn killed_at_any_moment_it_goes_on_without_losing_or_repeating_a_run() {
    let place = place(COMPARISON);
    let begin = Instant::now();
    let reference = reference(&place);
    let whole = begin.elapsed();
    let (mut kept, mut killed, mut state) = (0, 0, 88_172_645_463_325_252_u64);
    let mut longest = whole.mul_f64(0.3);
    loop {
        let mut child = batch(&place, "out", &["--threads", "2"]).spawn().unwrap();
        // Moments drawn by an xorshift generator.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        std::thread::sleep(longest.mul_f64((state % 1000) as f64 / 1000.0).max(Duration::from_millis(2)));
        child.kill().unwrap();
        let output = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!told.contains("error"), "{told}");
        // One that is killed before it has read its journal tells nothing.
        let found = already(&told);
        assert!(found >= kept || found == 0, "{kept} runs were finished, then {told}");
        kept = kept.max(found);
        killed += u32::from(!output.status.success());
        if output.status.success() {
            if killed > 2 {
                break;
            }
            // The machine was too fast for the moments: again, sooner.
            std::fs::remove_dir_all(place.path("out")).unwrap();
            (kept, killed, longest) = (0, 0, longest.mul_f64(0.5));
        }
    }
    eprintln!("killed {killed} times");
    let (code, told) = status(batch(&place, "out", &[]));
    assert_eq!((code, already(&told)), (Some(0), RUNS), "{told}");
    same_as(&place, "out", &reference);
}

#[test]
fn a_torn_journal_goes_on_behind_its_last_whole_record() {
    let place = place(COMPARISON);
    let reference = reference(&place);
    assert_eq!(status(batch(&place, "out", &[])).0, Some(0));
    let whole = bytes(&place, "out/journal.headland");
    for keep in [5, 60, whole.len() / 3, whole.len() - 1] {
        std::fs::write(place.path("out/journal.headland"), &whole[..keep]).unwrap();
        assert_eq!(status(batch(&place, "out", &[])).0, Some(0));
        same_as(&place, "out", &reference);
    }
    let mut file = std::fs::OpenOptions::new().append(true).open(place.path("out/journal.headland")).unwrap();
    file.write_all(&[7; 100]).unwrap();
    let (code, told) = status(batch(&place, "out", &[]));
    assert!(code == Some(0) && told.contains("100 bytes"), "{told}");
    same_as(&place, "out", &reference);
}

fn interrupted(mut child: Child, after: Duration) -> Option<i32> {
    std::thread::sleep(after);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    child.wait().unwrap().code()
}

#[test]
fn an_interruption_is_130_and_the_same_command_goes_on() {
    let place = place(COMPARISON);
    let reference = reference(&place);
    for wait_ms in [300, 150, 80, 40, 600] {
        let _ = std::fs::remove_dir_all(place.path("out"));
        let child = batch(&place, "out", &["--threads", "1"]).spawn().unwrap();
        if interrupted(child, Duration::from_millis(wait_ms)) == Some(130) {
            assert!(!Path::new(&place.path("out/results.parquet")).exists(), "no table of half a batch");
            assert_eq!(status(batch(&place, "out", &[])).0, Some(0));
            same_as(&place, "out", &reference);
            return;
        }
    }
    panic!("it was never interrupted in time");
}

/// A run that cannot be driven, one that is not physical and a good one: rows, and status 1.
#[test]
fn a_run_that_fails_is_a_row_with_its_error() {
    let text = COMPARISON
        .replace("\"vehicle.drag_area_m2\": [1.0, 2.0]", "\"cycle\": [[Coast(until: Elapsed(for_s: 5))], [Hold(for_s: 5)], [Coast(until: Travelled(distance_m: 1e5))]], \"vehicle.drag_area_m2\": [1.0, -1.0]")
        .replace("count: 20", "count: 1")
        .replace("times: 4", "times: 1");
    let place = place(&text);
    let (code, told) = status(batch(&place, "out", &[]));
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("8 of 12 runs have no end"), "{told}");
    let summary = place.json("out/summary.json");
    let errors: Vec<&str> =
        summary["troubles"].as_array().unwrap().iter().map(|one| one["error"].as_str().unwrap()).collect();
    assert!(errors.iter().any(|error| error.contains("`drag_area_m2` is -1, expected")), "{errors:?}");
    assert!(errors.iter().any(|error| error.contains("come to rest") && error.contains(" m)")), "{errors:?}");
}

/// The page looked at the first point of a configuration, and a batch whose first point is refused ended without one.
#[test]
fn a_first_run_that_is_refused_spoils_nothing() {
    let text = COMPARISON
        .replace("[1.0, 2.0]", "[-1.0, 1.0]")
        .replace("count: 20", "count: 1")
        .replace("times: 4", "times: 1");
    let place = place(&text);
    let (code, told) = status(batch(&place, "out", &[]));
    assert_eq!(code, Some(1), "{told}");
    assert!(told.contains("2 of 4 runs have no end") && told.contains("`drag_area_m2` is -1"), "{told}");
    assert!(Path::new(&place.path("out/report.html")).exists());
}

/// A file that may not grow stands for a full disk: the shell limits its size, and the signal of the limit is ignored.
#[test]
fn a_full_disk_is_3_and_loses_nothing_that_was_finished() {
    let place = place(COMPARISON);
    let reference = reference(&place);
    let script = format!(
        "trap '' XFSZ; ulimit -f 32; exec {} batch {} --out {}",
        env!("CARGO_BIN_EXE_headland"),
        place.path("comparison.ron"),
        place.path("out")
    );
    let mut command = Command::new("bash");
    command.args(["-c", &script]);
    let (code, told) = status(command);
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("runs are finished and kept; the same command goes on"), "{told}");
    let (code, told) = status(batch(&place, "out", &[]));
    assert!(code == Some(0) && already(&told) > 20, "{told}");
    same_as(&place, "out", &reference);
}

#[test]
fn a_folder_that_vanishes_is_3_and_is_made_again() {
    let place = place(COMPARISON);
    let reference = reference(&place);
    for wait_ms in [150, 80, 300, 40, 600] {
        let child = batch(&place, "out", &["--threads", "1"]).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait_ms));
        let _ = std::fs::remove_dir_all(place.path("out"));
        let output = child.wait_with_output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        if output.status.code() == Some(3) && told.contains("made again") {
            let (code, told) = status(batch(&place, "out", &[]));
            assert!(code == Some(0) && already(&told) > 0, "{told}");
            same_as(&place, "out", &reference);
            return;
        }
        let _ = std::fs::remove_dir_all(place.path("out"));
    }
    panic!("the folder never vanished while runs were written");
}

#[test]
fn a_changed_comparison_is_refused_with_what_changed_and_begins_anew_when_told() {
    let place = place(&COMPARISON.replace("count: 20", "count: 2"));
    assert_eq!(status(batch(&place, "out", &[])).0, Some(0));
    let before = bytes(&place, "out/results.parquet");
    let remark = COMPARISON
        .replace("count: 20", "count: 2")
        .replace("about: \"carts\"", "// a remark\n about: \"wagons\"");
    place.write("comparison.ron", &remark);
    let (code, told) = status(batch(&place, "out", &[]));
    assert!(code == Some(0) && already(&told) == 32, "what no result depends on may change: {told}");
    place.write(
        "comparison.ron",
        &remark.replace(
            "\"heavy\", with: {\"vehicle.mass_kg\": 2000",
            "\"heavy\", with: {\"vehicle.mass_kg\": 2500",
        ),
    );
    let (code, told) = status(batch(&place, "out", &[]));
    assert_eq!(code, Some(2), "{told}");
    assert!(
        told.contains("variant `heavy` changed") && told.contains("--anew") && !told.contains("`light`"),
        "{told}"
    );
    assert!(bytes(&place, "out/results.parquet") == before);
    assert_eq!(status(batch(&place, "out", &["--anew"])).0, Some(0));
    assert!(bytes(&place, "out/results.parquet") != before);
}

#[test]
fn traces_are_kept_and_made_up_for_where_they_are_missing() {
    let place = place(&COMPARISON.replace("count: 20", "count: 1").replace("times: 4", "times: 1"));
    assert_eq!(status(batch(&place, "out", &[])).0, Some(0));
    let before = bytes(&place, "out/results.parquet");
    assert_eq!(status(batch(&place, "out", &["--traces"])).0, Some(0));
    let trace = bytes(&place, "out/runs/000002/trace.parquet");
    std::fs::write(place.path("out/runs/000002/trace.parquet"), "").unwrap();
    assert_eq!(status(batch(&place, "out", &["--traces"])).0, Some(0));
    assert!(bytes(&place, "out/runs/000002/trace.parquet") == trace);
    assert!(bytes(&place, "out/results.parquet") == before);
    let runs = headland_trace::read_parquet(Path::new(&place.path("out/runs/000003/trace.parquet"))).unwrap();
    assert!((runs[0].trace.duration_s() - 100.0).abs() < 1e-6);
}

#[test]
fn the_result_is_one_json_document_and_quiet_is_quiet() {
    let place = place(&COMPARISON.replace("count: 20", "count: 1"));
    let output = output(batch(&place, "out", &["--json", "--quiet"]));
    assert!(output.status.success() && output.stderr.is_empty());
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (document["schema"].as_str(), document["runs"].as_u64()),
        (Some("headland.batch/1"), Some(16))
    );
    let heavy = &document["configurations"][1];
    assert_eq!(heavy["variant"], "heavy");
    let time = heavy["measures"].as_array().unwrap().iter().find(|one| one["name"] == "time").unwrap();
    assert_eq!(time["against_baseline"]["pairs"], 8, "{heavy}");
}

/// Two at once would write one journal.
#[test]
fn a_second_batch_in_the_same_folder_is_refused() {
    let place = place(COMPARISON);
    let mut first = batch(&place, "out", &["--threads", "1"]);
    first.process_group(0);
    let mut first = first.spawn().unwrap();
    for _ in 0..200 {
        if Path::new(&place.path("out/journal.headland")).exists() {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(30));
    let (code, told) = status(batch(&place, "out", &[]));
    assert!(code == Some(2) && told.contains("another batch is at work"), "{told}");
    assert!(first.wait().unwrap().success());
}

/// Whether this program draws or not, what cannot be drawn is said before anything is simulated.
#[test]
fn runs_of_a_batch_that_cannot_be_drawn_are_refused_by_number() {
    let place = place(COMPARISON);
    let refused = |more: &[&str], expected: &str| {
        let (code, told) = status(batch(&place, "out", more));
        assert!(code == Some(2) && told.contains(expected), "{code:?} {told}");
        assert!(!Path::new(&place.path("out/results.parquet")).exists());
    };
    refused(&["--drawn", "3"], "--drawn goes with --rerun");
    if cfg!(feature = "rerun") {
        refused(&["--rerun", "--drawn", "320"], "--drawn 320: there is no such run, expected 0 to 319");
        refused(&["--rerun", "--drawn", "3", "--drawn", "3"], "--drawn 3 stands twice");
    } else {
        refused(&["--rerun"], "--features rerun");
    }
}

#[test]
fn runs_of_a_batch_are_drawn_beside_one_another() {
    if cfg!(not(feature = "rerun")) {
        return;
    }
    let place = place(COMPARISON);
    let (code, told) = status(batch(&place, "out", &["--rerun"]));
    assert_eq!(code, Some(0), "{told}");
    let picture = |place: &Place| std::fs::metadata(place.path("out/batch.rrd")).unwrap().len();
    let two = picture(&place);
    // The batch is finished; it is drawn again all the same, now a single run.
    let (code, told) = status(batch(&place, "out", &["--rerun", "--drawn", "319"]));
    assert_eq!(code, Some(0), "{told}");
    assert!(picture(&place) < two, "{} {two}", picture(&place));
}

/// Three drivelines that are equally fast offer no choice between time and fuel; how much of the fuel is made up is told.
#[test]
fn the_page_tells_where_there_is_no_choice_and_how_much_fuel_is_made_up() {
    let place = Place::new();
    let out = place.path("out");
    let (code, told) = status({
        let mut command = headland();
        command.args(["demo", "batch", "--quiet", "--out", &out]).stderr(Stdio::piped());
        command
    });
    assert_eq!(code, Some(0), "{told}");
    let page = String::from_utf8(bytes(&place, "out/report.html")).unwrap();
    assert!(
        page.contains(
            "Ploughing: time differs by less than a thousandth, so fuel alone is left to choose by."
        )
    );
    assert!(page.contains("made up for, of the fuel burnt"));
    assert!(page.contains("Time against fuel: transport"));
    // What the demonstration compares is fuel, not its own correction.
    let summary = place.json("out/summary.json");
    for one in summary["configurations"].as_array().unwrap() {
        assert!(one["charge_made_up"].as_f64().is_none_or(|share| share.abs() < 0.03), "{one}");
    }
    assert!(!page.contains("is the correction for charge"));
}

/// The battery of a hybrid gives a good part of the work: its fuel leans on the correction, and page and terminal say so.
#[test]
fn fuel_that_is_mostly_correction_is_told_as_such() {
    let place = Place::new();
    let out = place.path("first");
    let mut demo = headland();
    demo.args(["demo", "batch", "--quiet", "--out", &out]);
    assert_eq!(status(demo).0, Some(0));
    let short = r#"(
        about: "a short pull",
        variants: [(name: "series", vehicle: include("vehicles/xerion_3800_series.ron"),
            with: {"vehicle.management": LoadLevelling(
                time_constant_s: 20, target_charge: 0.4, charge_gain_w: "200 kW", initial_power_w: "30 kW")})],
        cycles: [(name: "pull", cycle: [Hold(for_s: 60)])],
        grounds: [
            (name: "loam", ground: (terrain: Flat, soil: Constant(coefficient: 0.05))),
            (name: "nowhere", ground: (terrain: Flat, soil: Constant(coefficient: -0.05))),
        ],
        start: (position_m: 0, speed_m_s: "8 km/h"),
        tasks: [Drawbar(force_n: "20 kN")],
        air: (density_kg_m3: 1.2),
        charge: (charging_efficiency: 0.85, discharging_efficiency: 0.85),
        simulation: (fidelity: Longitudinal, step_s: 0.1),
    )"#;
    std::fs::write(place.path("first/scenarios/short.ron"), short).unwrap();
    let mut batch = headland();
    let out = place.path("second");
    batch.args(["batch", &place.path("first/scenarios/short.ron"), "--out", &out]);
    let output = output(batch);
    let (told, noted) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(1), "{told}{noted}");
    assert!(told.contains("series, pull, loam") && told.contains("is the correction for charge"), "{told}");
    assert!(
        noted.contains("1 of 2 combinations cannot be run") && noted.contains("`coefficient` is -0.05"),
        "{noted}"
    );
    let page = String::from_utf8(bytes(&place, "second/report.html")).unwrap();
    assert!(
        page.contains("is the correction for charge")
            && page.contains("Runs without an end")
            && page.contains("is -0.05")
    );
    let check = status({
        let mut check = headland();
        check.args(["check", &place.path("first/scenarios/short.ron")]);
        check
    });
    assert_eq!(check.0, Some(1));
}

/// What a battery loses bears the name of the battery in the ledger. In the picture of flows the two were one, so it ran in a
/// circle, and no batch with a vehicle that a battery alone drives had a page.
#[test]
fn a_batch_with_battery_electric_vehicles_has_its_page() {
    let place = Place::new();
    let comparison = top().join("scenarios/comparisons/battery_electric.ron");
    let mut batch = headland();
    batch.args(["batch", word(&comparison), "--quiet", "--out", &place.path("tractors")]);
    let (code, told) = status(batch);
    assert_eq!(code, Some(0), "{told}");
    let page = String::from_utf8(bytes(&place, "tractors/report.html")).unwrap();
    assert!(page.contains("electric: tillage") && page.contains("battery loss"));
    assert!(!page.contains("is not drawn"));
    let car = format!(
        r#"(
        about: "a car with a battery",
        variants: [include("{}")],
        cycles: [(name: "street", cycle: [Reach(speed_m_s: 10, acceleration_m_s2: 1), Hold(for_s: 10)])],
        ground: (terrain: Flat, soil: Constant(coefficient: 0.01)),
        air: (density_kg_m3: 1.2),
        simulation: (fidelity: Longitudinal, step_s: 0.1),
    )"#,
        word(&top().join("scenarios/vehicles/bmw_i3.ron"))
    );
    place.write("comparison.ron", &car);
    let (code, told) = status(self::batch(&place, "car", &[]));
    assert_eq!(code, Some(0), "{told}");
    let page = String::from_utf8(bytes(&place, "car/report.html")).unwrap();
    assert!(page.contains("battery loss") && !page.contains("is not drawn"));
}

/// A tractor at its limit drives on more slowly; the batch said nothing, though it held other work against the work of others.
#[test]
fn a_configuration_that_falls_short_of_its_way_is_told_as_such() {
    let place = Place::new();
    let comparison = format!(
        r#"(
        about: "a light and a heavy pull",
        variants: [(name: "tractor", vehicle: include("{}"))],
        cycles: [
            (name: "light", tasks: [Drawbar(force_n: "30 kN")]),
            (name: "heavy", tasks: [Drawbar(force_n: "80 kN")]),
        ],
        cycle: [Drive(speed_m_s: "12 km/h", acceleration_m_s2: 0.5, until: Travelled(distance_m: 200))],
        start: (position_m: 0, speed_m_s: "6 km/h"),
        ground: (terrain: Flat, soil: Constant(coefficient: 0.05)),
        air: (density_kg_m3: 1.2),
        simulation: (fidelity: Longitudinal, step_s: 0.1),
    )"#,
        word(&top().join("scenarios/vehicles/xerion_3800.ron"))
    );
    place.write("comparison.ron", &comparison);
    let output = output(batch(&place, "out", &[]));
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{told}{}", String::from_utf8_lossy(&output.stderr));
    assert!(told.contains("note     tractor, heavy") && !told.contains("note     tractor, light"), "{told}");
    let page = String::from_utf8(bytes(&place, "out/report.html")).unwrap();
    assert!(page.contains("Speeds that were not reached") && page.contains("tractor, heavy, ground: "));
    let summary = place.json("out/summary.json");
    let short = |index: usize| summary["configurations"][index]["short_share"].as_f64().unwrap();
    assert!(short(0) == 0.0 && short(1) > 0.05, "{summary}");
}
