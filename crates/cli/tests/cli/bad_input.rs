//! Bad input gets exit status 2 and a message that one would thank for: what, where, and what was meant.

use super::help::{Place, RECORDING, SCENARIO, done, log, refused};

/// Runs the scenario with a piece of it changed.
fn scenario(from: &str, to: &str) -> String {
    assert!(SCENARIO.contains(from));
    let place = Place::new();
    place.write("scenario.ron", &SCENARIO.replace(from, to));
    refused(2, &["run", &place.path("scenario.ron"), "--out", &place.path("out")])
}

/// Compares with a recording of which a piece is changed.
fn recording(description: &str, log: &str) -> String {
    let place = Place::new();
    place.write("recording.ron", description);
    place.write("r1.csv", log);
    let output = place.compare();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{told}");
    told
}

fn holds(told: &str, pieces: &[&str]) {
    for piece in pieces {
        assert!(told.contains(piece), "`{piece}` is missing in\n{told}");
    }
}

#[test]
fn a_misspelt_field_is_shown_with_the_one_that_was_meant() {
    let told = scenario("mass_kg: 1000", "mas_kg: 1000");
    holds(&told, &["scenario.ron:5:9", "mas_kg", "did you mean `mass_kg`", "^^^"]);
}

#[test]
fn a_misspelt_model_is_shown_with_the_one_that_was_meant() {
    let told = scenario("Constant(", "Konstant(");
    holds(&told, &["scenario.ron:12:15", "Konstant", "did you mean `Constant`", "headland plugins soil"]);
}

#[test]
fn a_unit_that_does_not_fit_is_refused_where_it_stands() {
    holds(&scenario("\"36 km/h\"", "\"36 kg\""), &["scenario.ron:15:39", "kg", "m/s"]);
    let told = recording(&RECORDING.replace("\"km/h\"", "\"kg\""), &log());
    holds(&told, &["recording.ron:4:", "`kg`", "speed_m_s"]);
}

#[test]
fn a_mass_that_is_negative_or_no_number_is_refused() {
    holds(&scenario("mass_kg: 1000", "mass_kg: -1000"), &["scenario.ron:5:18", "-1000", "more than 0"]);
    holds(&scenario("mass_kg: 1000", "mass_kg: NaN"), &["scenario.ron:5:18", "NaN"]);
    holds(&scenario("mass_kg: 1000", "mass_kg: heavy"), &["scenario.ron:5:", "heavy"]);
}

#[test]
fn a_missing_column_is_answered_with_those_that_are_there() {
    let told = recording(&RECORDING.replace("\"v\"", "\"speed\""), &log());
    holds(&told, &["recording.ron:4:", "speed", "r1.csv"]);
}

#[test]
fn a_misspelt_channel_is_shown_with_the_one_that_was_meant() {
    let told = recording(&RECORDING.replace("speed_m_s", "spede_m_s"), &log());
    holds(&told, &["recording.ron:4:", "did you mean `speed_m_s`"]);
}

#[test]
fn time_that_runs_backwards_is_refused_with_its_row() {
    let told = recording(RECORDING, &log().replace("\n1.0,", "\n0.5,"));
    holds(&told, &["r1.csv:12", "backwards", "0.5"]);
}

#[test]
fn text_in_the_place_of_a_number_is_refused_with_its_cell() {
    let told = recording(RECORDING, &log().replacen("\n0.5,35.460", "\n0.5,fast", 1));
    holds(&told, &["r1.csv:7", "fast"]);
}

#[test]
fn rows_of_uneven_length_are_refused() {
    let told = recording(RECORDING, &log().replacen("\n0.5,35.460,1", "\n0.5,35.460", 1));
    holds(&told, &["r1.csv:7", "expected 3"]);
}

/// What comes after a start that is no number is no number either; that is said before anything is simulated.
#[test]
fn a_start_that_is_no_number_is_refused_where_it_stands() {
    let told = scenario("speed_m_s: \"36 km/h\"", "speed_m_s: NaN");
    holds(&told, &["`speed_m_s` is NaN", "scenario.ron:15:"]);
}

#[test]
fn text_of_another_encoding_is_refused_with_its_place() {
    let place = Place::new();
    std::fs::write(place.path("scenario.ron"), b"(\n    about: \"M\xfchle\",\n)").unwrap();
    let told = refused(2, &["run", &place.path("scenario.ron")]);
    holds(&told, &["scenario.ron", "0xFC", "line 2, column 14", "expected UTF-8"]);
}

/// Logs from Windows were told one line too early.
#[test]
fn the_line_of_a_cell_is_right_however_lines_end() {
    for ends in ["\n", "\r\n"] {
        let log = "time_s,v\n0,1\n\n1,fast\n".replace('\n', ends);
        holds(&recording(RECORDING, &log), &["r1.csv:4:3"]);
    }
}

#[test]
fn a_quotation_that_is_never_closed_is_shown_by_its_first_line() {
    let told = recording(RECORDING, &format!("time_s,v\n0,1\n1,\"2\n{}", "2,3\n".repeat(1000)));
    holds(&told, &["`2…`", "r1.csv:3:3"]);
    assert!(told.len() < 1000, "{told}");
}

#[test]
fn a_recorded_drive_that_runs_backwards_is_refused_with_its_line() {
    for (rows, pieces) in [
        ("0,0\r\n2,1\r\n1,2\r\n", ["1 s after 2 s in line 4", "increasing times"]),
        ("0,0\r\n2,-1\r\n", ["-1 m/s in line 3", "a speed of 0 or more"]),
    ] {
        let place = Place::new();
        place.write("drive.csv", &format!("time_s,speed_m_s\r\n{rows}"));
        let text = SCENARIO.replace("Coast(until: Elapsed(for_s: 20))", "Follow(file: \"drive.csv\")");
        place.write("scenario.ron", &text);
        let told = refused(2, &["run", &place.path("scenario.ron")]);
        holds(&told, &["`drive.csv`", "scenario.ron:16:"]);
        holds(&told, &pieces);
    }
}

#[test]
fn empty_files_are_refused() {
    holds(&recording(RECORDING, ""), &["r1.csv", "expected a header"]);
    holds(&recording(RECORDING, "time_s,v,coasting\n"), &["r1.csv", "expected"]);
    let place = Place::new();
    place.write("scenario.ron", "");
    let told = refused(2, &["run", &place.path("scenario.ron"), "--out", &place.path("out")]);
    holds(&told, &["scenario.ron", "empty"]);
}

/// Values that are missing are no mistake of the file: they are counted and told.
#[test]
fn missing_values_of_a_log_are_told_and_left_out() {
    let place = Place::new();
    place.write("r1.csv", &log().replacen("\n0.5,35.460,1", "\n0.5,NaN,1", 1));
    assert!(place.compare().status.success());
    let document = place.json("out/comparison.json");
    let told = document["notices"].to_string();
    assert!(told.contains("missing"), "{told}");
}

#[test]
fn a_folder_in_the_place_of_a_file_is_named() {
    let place = Place::new();
    std::fs::create_dir(place.path("folder.ron")).unwrap();
    let folder = place.path("folder.ron");
    holds(&refused(2, &["run", &folder]), &["folder.ron", "is a folder"]);
    let told = refused(2, &["compare", &place.path("scenario.ron"), "--recording", &folder]);
    holds(&told, &["folder.ron", "folder"]);
    std::fs::remove_file(place.path("r1.csv")).unwrap();
    std::fs::create_dir(place.path("r1.csv")).unwrap();
    let told = String::from_utf8_lossy(&place.compare().stderr).into_owned();
    holds(&told, &["r1.csv", "is a folder", "recording.ron:3:"]);
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let place = Place::new();
    holds(&refused(2, &["run", &place.path("none.ron")]), &["none.ron", "cannot read"]);
    std::fs::remove_file(place.path("r1.csv")).unwrap();
    let told = String::from_utf8_lossy(&place.compare().stderr).into_owned();
    holds(&told, &["r1.csv", "recording.ron:3:"]);
}

#[test]
fn a_path_that_cannot_be_written_is_named() {
    let place = Place::new();
    place.write("taken", "a file, not a folder");
    let out = place.path("taken") + "/out";
    let told = refused(2, &["run", &place.path("scenario.ron"), "--out", &out]);
    holds(&told, &["cannot write", "taken/out", "--out names another"]);
}

/// The page of the validation takes minutes to make: that it has no place is said before anything else is looked at.
#[test]
fn a_page_that_cannot_be_written_is_refused_before_it_is_made() {
    let place = Place::new();
    place.write("taken", "");
    let validate = |out: &str| {
        refused(2, &["validate", "--scenarios", &place.path("nowhere"), "--out", &place.path(out)])
    };
    holds(&validate("taken/validation.md"), &["cannot write", "taken/validation.md"]);
    holds(&validate("missing/validation.md"), &["cannot write", "missing/validation.md"]);
    holds(&validate("."), &["cannot write"]);
    // What can be written is neither made nor touched until there is something to write.
    holds(&validate("validation.md"), &["nowhere"]);
    assert!(!std::path::Path::new(&place.path("validation.md")).exists());
    place.write("old.md", "old");
    holds(&validate("old.md"), &["nowhere"]);
    assert_eq!(std::fs::read_to_string(place.path("old.md")).unwrap(), "old");
}

#[test]
fn what_a_requirement_got_wrong_is_said() {
    let place = Place::new();
    let compare = |requirement: &str| {
        let arguments = [
            "--recording",
            &place.path("recording.ron"),
            "--out",
            &place.path("out"),
            "--require",
            requirement,
        ];
        refused(2, &[&["compare", &place.path("scenario.ron")], &arguments[..]].concat())
    };
    holds(&compare("speed_m_s rmsee < 0.2"), &["rmsee", "rmse"]);
    holds(&compare("speed_m_s rmse < 0.2 kg"), &["kg"]);
    holds(&compare("sped_m_s rmse < 0.2"), &["speed_m_s"]);
}

#[test]
fn a_mass_that_nobody_knows_is_asked_for() {
    let place = Place::new();
    place.write("recording.ron", &RECORDING.replace("known: [(name: \"mass_kg\", value: 1000)],", ""));
    let told = refused(2, &["coastdown", &place.path("recording.ron"), "--out", &place.path("out")]);
    holds(&told, &["mass", "known: [(name: \"mass_kg\"", "recording.ron"]);
}

#[test]
fn rerun_that_was_not_built_in_is_said_before_anything_is_simulated() {
    if cfg!(feature = "rerun") {
        return;
    }
    let place = Place::new();
    let told = refused(2, &["run", &place.path("scenario.ron"), "--rerun", "--out", &place.path("out")]);
    holds(&told, &["--features rerun"]);
    assert!(!std::path::Path::new(&place.path("out")).exists());
}

#[test]
fn words_that_the_command_line_does_not_know_are_refused() {
    holds(&refused(2, &["runn"]), &["run"]);
    holds(&refused(2, &["demo", "coastdwn"]), &["did you mean `coastdown`"]);
    holds(&refused(2, &["plugins", "sole"]), &["did you mean `soil`"]);
}

/// A cycle of the project's tractors that cannot be driven to its end; gives what was said, and how long the trace is [s].
fn undriveable(
    vehicle: &str,
    ground: &str,
    start_m_s: f64,
    pull: &str,
    cycle: &str,
    more: &str,
) -> (String, f64) {
    let place = Place::new();
    let scenarios = super::help::top().join("scenarios");
    let text = format!(
        "(about: \"it cannot be driven\", vehicle: include(\"{0}/vehicles/{vehicle}.ron\"), ground: {ground}, \
          air: (density_kg_m3: 1.2), start: (position_m: 0, speed_m_s: {start_m_s}), tasks: [Drawbar(force_n: \"{pull}\")], \
          cycle: [{cycle}], {more} simulation: (fidelity: Longitudinal, step_s: 0.1))",
        scenarios.display()
    );
    place.write("scenario.ron", &text);
    let told = refused(1, &["run", &place.path("scenario.ron"), "--out", &place.path("out")]);
    // What was simulated up to there is kept, with the reason.
    let document = place.json("out/summary.json");
    let stopped = &document["runs"][0]["end"]["Stopped"];
    let reason = stopped["reason"].as_str().unwrap_or_else(|| panic!("{document}"));
    assert!(told.contains(reason), "{told}");
    let end_s = stopped["time_s"].as_f64().unwrap();
    let at = format!("(at {end_s:.2} s and {:.1} m)", stopped["position_m"].as_f64().unwrap());
    holds(&told, &[&at, "is kept"]);
    let runs = headland_trace::read_parquet(std::path::Path::new(&place.path("out/trace.parquet"))).unwrap();
    assert!((runs[0].trace.duration_s() - end_s).abs() < 1e-9, "{end_s}");
    assert!(std::path::Path::new(&place.path("out/report.html")).exists());
    (told, end_s)
}

const FLAT: &str = "(terrain: Flat, soil: Constant(coefficient: 0.06))";

/// A speed that is to be held and is not ends with status 1 too: the way that is missing is said, and all of it is kept.
#[test]
fn a_speed_that_the_drive_does_not_keep_is_an_end_with_status_1() {
    let place = Place::new();
    let scenarios = super::help::top().join("scenarios");
    let scenarios = scenarios.display();
    let text = |pull: &str, cycle: &str| {
        format!(
            "(about: \"too heavy\", vehicle: include(\"{scenarios}/vehicles/xerion_3800.ron\"), ground: {FLAT}, \
              air: (density_kg_m3: 1.2), start: (position_m: 0, speed_m_s: 2), tasks: [Drawbar(force_n: \"{pull}\")], cycle: [{cycle}], \
              simulation: (fidelity: Longitudinal, step_s: 0.1))"
        )
    };
    place.write("held.ron", &text("150 kN", "Hold(for_s: 30)"));
    let told = refused(1, &["run", &place.path("held.ron"), "--out", &place.path("held")]);
    holds(
        &told,
        &["could not keep the speed that is wanted", "of the 60.0 m that its speeds ask for", "is kept"],
    );
    assert_eq!(place.json("held/summary.json")["runs"][0]["phases"][0]["wanted_m"], 60.0);
    place.write(
        "slowed.ron",
        &text("10 kN", "Drive(speed_m_s: 13, acceleration_m_s2: 3, until: Elapsed(for_s: 30))"),
    );
    let told = done(&["run", &place.path("slowed.ron"), "--out", &place.path("slowed")]);
    holds(&told, &["was slowed down: phase 1 made"]);
}

/// Every way in which a cycle cannot be driven ends its run with the time, the place and the reason, and with status 1.
#[test]
fn a_cycle_that_cannot_be_driven_stops_with_time_place_and_reason_and_keeps_what_was_simulated() {
    let uphill = "(terrain: ConstantGrade(grade: 0.3, heading_rad: 0), soil: Constant(coefficient: 0.06))";
    let behind = "Hold(for_s: 4), Drive(speed_m_s: 13, acceleration_m_s2: 3, tolerance_m_s: 0.5, until: Elapsed(for_s: 30))";
    let (told, end_s) = undriveable("xerion_3800", FLAT, 3.0, "10 kN", behind, "");
    holds(&told, &["falls behind what is wanted by", "the drive gives"]);
    assert!(end_s > 4.0);
    let climb = "Drive(speed_m_s: 2, acceleration_m_s2: 1, until: Travelled(distance_m: 9))";
    let (told, _) = undriveable("xerion_3800", uphill, 0.0, "90 kN", climb, "");
    holds(&told, &["the vehicle stands where it is to drive at 2.00 m/s", "do not overcome the resistances"]);

    let soft =
        "(terrain: Flat, soil: Brixius(cone_index_pa: \"450 kPa\", construction: Radial, pass_factor: 1.5))";
    let faster = "Hold(for_s: 4), Reach(speed_m_s: 3, acceleration_m_s2: 3)";
    let (told, end_s) = undriveable("xerion_3800_axles", soft, 0.6, "55 kN", faster, "");
    holds(&told, &["slip past the limit", "at a slip of"]);
    assert!(end_s > 3.9);

    let drained = "runs: [(id: \"run\", with: {\"vehicle.driveline.battery.initial_charge\": 0.105})],";
    let (told, end_s) = undriveable("xerion_3800_electric", FLAT, 3.0, "10 kN", "Hold(for_s: 4000)", drained);
    holds(&told, &["the battery is empty", "it is used down to 0.1"]);
    assert!(end_s > 10.0);

    let valley = format!(
        "(terrain: Heightmap(file: \"{}\", path: Points(points: [(east_m: 40, north_m: 60), (east_m: 150, north_m: 90)])), \
          soil: Constant(coefficient: 0.03))",
        super::help::top().join("terrain/valley.asc").display()
    );
    let (told, end_s) = undriveable("xerion_3800", &valley, 5.0, "1 kN", "Hold(for_s: 4000)", "");
    holds(&told, &["the path ends: it runs from 0 m to 114."]);
    assert!(end_s > 20.0);

    let back = "Hold(for_s: 4), Drive(speed_m_s: 3, acceleration_m_s2: 1, until: Position(position_m: 5))";
    let (told, _) = undriveable("xerion_3800", FLAT, 3.0, "1 kN", back, "");
    holds(&told, &["to end at 5 m, which lies 7.0 m behind the vehicle"]);
}

/// A path that a map does not hold is refused before anything is driven, with where it leaves.
#[test]
fn a_path_that_leaves_its_map_is_refused_with_the_place() {
    let place = Place::new();
    let map = super::help::top().join("terrain/valley.asc");
    let path = "Points(points: [(east_m: 40, north_m: 60), (east_m: 150, north_m: 90), (east_m: 9000, north_m: 190)])";
    let terrain = format!("Heightmap(file: \"{}\", path: {path})", map.display());
    place.write("scenario.ron", &SCENARIO.replace("terrain: Flat", &format!("terrain: {terrain}")));
    let told = refused(2, &["run", &place.path("scenario.ron"), "--out", &place.path("out")]);
    let place_of_it = "578.0 m after its start at 600.2 m east, 201.9 m north, off the map";
    holds(&told, &["scenario.ron:11:", place_of_it, "within 0 to 600 m east and 0 to 400 m north"]);
    assert!(!std::path::Path::new(&place.path("out/trace.parquet")).exists());
}
