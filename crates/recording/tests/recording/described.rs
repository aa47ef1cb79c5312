//! What a description can say beyond columns.

use crate::{Folder, alike, lines};
use headland_recording::{Known, Sensor, check};

const LOG: &str = "time_s,speed_m_s,force_n\n0,1,10\n1,2,20\n2,3,30\n3,4,40\n4,5,50\n";

#[test]
fn segments_paths_and_uses_make_runs() {
    let description = br#"(
        about: "two ways",
        runs: [
            (id: "a", file: "log.csv", path: "track", use: held_out),
            (id: "b", file: "log.csv", path: "track", reversed: true, segments: [(from_s: 1.0, to_s: 2.0), (from_s: 3, to_s: 9)]),
            (id: "c", file: "log.csv", segments: [(from_s: 2.0, to_s: 4.0)]),
        ],
    )"#;
    let recording =
        Folder::of(&[("log.csv", LOG.as_bytes()), ("recording.ron", description)]).load().unwrap();
    let runs: Vec<_> = recording
        .runs
        .iter()
        .map(|run| (run.id.as_str(), run.trace.len(), run.path.as_deref(), run.reversed, run.held_out))
        .collect();
    assert_eq!(
        runs,
        [
            ("a", 5, Some("track"), false, true),
            ("b.1", 2, Some("track"), true, false),
            ("b.2", 2, Some("track"), true, false),
            ("c", 3, None, false, false),
        ]
    );
    assert_eq!(recording.run("b.2").unwrap().trace.time_s(), [3.0, 4.0]);
}

#[test]
fn a_log_of_several_drives_is_cut() {
    let log = lines("time_s,speed_m_s", 60, |row| format!("{row},{}", if row < 30 { 20 } else { 5 }));
    let recording = Folder::log(log, "split: (speed_jump_m_s: 3.0)").load().unwrap();
    let runs: Vec<_> = recording.runs.iter().map(|run| (run.id.as_str(), run.trace.len())).collect();
    assert_eq!(runs, [("r.1", 30), ("r.2", 30)]);
}

#[test]
fn scale_and_offset_act_in_the_unit_of_the_column() {
    let fields =
        r#"channels: [(column: "force_n", is: "drawbar_force_n", unit: "kN", scale: 2.0, offset: -1.0)]"#;
    assert!(alike(&Folder::log(LOG, fields).values("drawbar_force_n"), &[19e3, 39e3, 59e3, 79e3, 99e3]));
}

#[test]
fn columns_are_combined() {
    let log = "time_s,l [km/h],r [km/h]\n0,36,72\n1,36,36\n";
    let fields = r#"channels: [(columns: ["l [km/h]", "r [km/h]"], combine: mean, is: "wheel_speed_m_s")]"#;
    assert!(alike(&Folder::log(log, fields).values("wheel_speed_m_s"), &[15.0, 10.0]));
}

#[test]
fn volume_flows_become_mass_flows_with_a_density() {
    let log = "time_s,fuel [L/h]\n0,36\n1,72\n";
    let fields = r#"channels: [(column: "fuel", is: "fuel_rate_kg_s", density_kg_m3: 800.0)]"#;
    assert!(alike(&Folder::log(log, fields).values("fuel_rate_kg_s"), &[0.008, 0.016]));
}

/// As an improved description says it: the speed is read 0.5 s late, 2 % high and 0.1 m/s up.
#[test]
fn a_sensor_that_is_described_is_corrected() {
    let fields = r#"channels: [(column: "speed_m_s", is: "speed_m_s",
        sensor: (noise: 0.03, latency_s: 0.5, scale: 1.02, bias: 0.1))]"#;
    let folder = Folder::log(LOG, fields);
    let expected: Vec<f64> =
        [1.5, 2.5, 3.5, 4.5, f64::NAN].iter().map(|raw: &f64| (raw - 0.1) / 1.02).collect();
    assert!(alike(&folder.values("speed_m_s"), &expected));
    assert_eq!(folder.values("force_n"), [10.0, 20.0, 30.0, 40.0, 50.0]);
    let recording = folder.load().unwrap();
    let sensor = Sensor { noise: Some(0.03), latency_s: Some(0.5), scale: Some(1.02), bias: Some(0.1) };
    assert_eq!(recording.runs[0].sensor("speed_m_s"), Some(&sensor));
}

#[test]
fn a_sensor_needs_no_column_where_the_header_is_the_channel() {
    let folder = Folder::log(LOG, r#"channels: [(is: "speed_m_s", sensor: (bias: 1.0))]"#);
    assert_eq!(folder.values("speed_m_s"), [0.0, 1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn a_run_may_describe_a_channel_for_itself() {
    let description = br#"(about: "x", runs: [
        (id: "a", file: "log.csv"),
        (id: "b", file: "log.csv", channels: [(column: "force_n", is: "drawbar_force_n", sensor: (bias: 10.0))]),
    ], channels: [(column: "force_n", is: "drawbar_force_n")])"#;
    let recording =
        Folder::of(&[("log.csv", LOG.as_bytes()), ("recording.ron", description)]).load().unwrap();
    assert_eq!(recording.runs[0].trace.get("drawbar_force_n").unwrap()[0], 10.0);
    assert_eq!(recording.runs[1].trace.get("drawbar_force_n").unwrap()[0], 0.0);
}

#[test]
fn what_is_known_is_shared_and_overridden() {
    let description = br#"(about: "x", runs: [
        (id: "a", file: "log.csv"),
        (id: "b", file: "log.csv", known: [(name: "mass_kg", value: "1.3 t")]),
    ], known: [(name: "mass_kg", value: 1270, sd: "0.02 t"), (name: "air_temperature_c", value: "50 \u{b0}F")])"#;
    let text = String::from_utf8_lossy(description).replace("\\u{b0}", "°");
    let recording =
        Folder::of(&[("log.csv", LOG.as_bytes()), ("recording.ron", text.as_bytes())]).load().unwrap();
    assert_eq!(recording.known[0], Known { name: "mass_kg".to_owned(), value: 1270.0, sd: Some(20.0) });
    assert!((recording.known[1].value - 10.0).abs() < 1e-9);
    assert_eq!(recording.runs[1].known("mass_kg").unwrap().value, 1300.0);
    assert!(recording.runs[1].known("air_temperature_c").is_some());
}

#[test]
fn an_optional_column_may_be_missing() {
    let fields = r#"channels: [(column: "Heading", is: "heading_rad", unit: "deg", optional: true)]"#;
    assert_eq!(Folder::log(LOG, fields).load().unwrap().runs[0].trace.channels().len(), 2);
}

#[test]
fn a_folder_is_named_relative_to_the_description() {
    let folder = Folder::of(&[(
        "recording.ron",
        br#"(about: "x", folder: "${HEADLAND_NO_SUCH_VARIABLE:-day_1}", runs: [(id: "r", file: "log.csv")])"#,
    )]);
    assert!(folder.refusal().contains("set HEADLAND_NO_SUCH_VARIABLE to where they lie"));
    std::fs::create_dir(folder.path("day_1")).unwrap();
    std::fs::write(folder.path("day_1/log.csv"), LOG).unwrap();
    assert_eq!(folder.values("speed_m_s").len(), 5);
}

#[test]
fn a_check_looks_at_the_first_rows_of_each_log() {
    let folder = Folder::log(LOG, "");
    let checked = check(&folder.path("recording.ron")).unwrap();
    assert_eq!(checked.runs[0].channels, ["speed_m_s", "force_n"]);
    assert_eq!(checked.runs[0].format, "csv, delimiter \",\", utf-8");
    let folder = Folder::log(lines("time_s,speed_m_s", 5000, |row| format!("{row},1")), "");
    assert_eq!(check(&folder.path("recording.ron")).unwrap().runs[0].rows, 1000);
}

#[test]
fn notes_reach_the_reader() {
    let recording = Folder::log(LOG, r#"notes: ["brakes are not logged"]"#).load().unwrap();
    assert_eq!(recording.notices[0].to_string(), "brakes are not logged");
}
