//! Every layout in which people have their logs.

use crate::{Folder, alike, lines};
use flate2::{Compression, write::GzEncoder};
use headland_recording::NoticeKind;
use headland_trace::{Origin, Run, Trace, write_parquet};
use std::io::Write;

const SPEED: &str = r#"channels: [(column: "Speed", is: "speed_m_s", unit: "km/h")]"#;

#[test]
fn headers_that_are_channel_names_need_no_channels() {
    let folder = Folder::log("time_s,speed_m_s,grade\n0,1.5,0.01\n0.5,2,0.02\n", "");
    assert_eq!(folder.values("time_s"), [0.0, 0.5]);
    assert_eq!(folder.values("speed_m_s"), [1.5, 2.0]);
    assert_eq!(folder.values("grade"), [0.01, 0.02]);
    assert!(folder.load().unwrap().notices.is_empty());
}

#[test]
fn every_delimiter_and_both_decimal_marks_are_seen() {
    for log in [
        "time_s,Speed\n0,36.5\n1.5,72\n",
        "time_s;Speed\n0;36.5\n1.5;72\n",
        "time_s;Speed\n0;36,5\n1,5;72\n",
        "time_s\tSpeed\n0\t36,5\n1,5\t72\n",
        "time_s|Speed\r\n0|36.5\r\n1.5|72\r\n",
        "\"time_s\",\"Speed\"\n\"0\",\"36.5\"\n\"1.5\",\"72\"",
        "time_s,Speed\n\n0,36.5\n\n1.5,72\n\n",
    ] {
        let folder = Folder::log(log, SPEED);
        assert!(alike(&folder.values("speed_m_s"), &[36.5 / 3.6, 20.0]), "{log}");
        assert!(alike(&folder.values("time_s"), &[0.0, 1.5]), "{log}");
    }
}

#[test]
fn what_the_description_says_goes_before_what_is_guessed() {
    let log = "# made by hand\ntime_s Speed\n! skipped\n0 36,5\n1,5 72\n";
    let fields =
        format!(r#"format: csv(delimiter: " ", decimal: ",", skip_lines: 1, comment: "!"), {SPEED}"#);
    assert!(alike(&Folder::log(log, &fields).values("speed_m_s"), &[36.5 / 3.6, 20.0]));
    let names = format!(r#"format: csv(names: ["time_s", "Speed"]), {SPEED}"#);
    assert!(alike(&Folder::log("0,36\n1,72\n", &names).values("speed_m_s"), &[10.0, 20.0]));
}

#[test]
fn encodings_are_seen_or_named() {
    let channels = r#"channels: [(column: "Temp. [°C]", is: "air_temperature_c")]"#;
    let text = "time_s,Temp. [°C]\n0,17.5\n1,18\n";
    let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let utf16: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let bom = format!("\u{feff}{text}").into_bytes();
    for log in [text.as_bytes().to_vec(), latin.clone(), utf16, bom] {
        assert_eq!(Folder::log(&log, channels).values("air_temperature_c"), [17.5, 18.0]);
    }
    let named = format!(r#"format: csv(encoding: "latin-1"), {channels}"#);
    assert_eq!(Folder::log(&latin, &named).values("air_temperature_c"), [17.5, 18.0]);
}

#[test]
fn gzip_is_seen_by_its_first_bytes() {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(b"time_s,speed_m_s\n0,1\n1,2\n").unwrap();
    assert_eq!(Folder::log(packed.finish().unwrap(), "").values("speed_m_s"), [1.0, 2.0]);
}

#[test]
fn units_stand_in_headers_in_every_spelling() {
    for header in ["Speed [km/h]", "Speed (km/h)", "Speed_kmh", "Speed km/h", "Speed {km/h}", "speed_kph"] {
        let fields = format!(r#"channels: [(column: "{header}", is: "speed_m_s")]"#);
        let folder = Folder::log(format!("time_s,{header}\n0,36\n1,72\n"), &fields);
        assert!(alike(&folder.values("speed_m_s"), &[10.0, 20.0]), "{header}");
    }
    let folder = Folder::log("time_s,v (mph)\n0,1\n1,2\n", r#"channels: [(column: "v", is: "speed_m_s")]"#);
    assert!(alike(&folder.values("speed_m_s"), &[0.447_04, 0.894_08]));
}

#[test]
fn units_may_stand_in_a_row_of_their_own() {
    let log = "Time;v;Torque\ns;km/h;Nm\n0;36;5\n1;72;6\n";
    let fields = r#"channels: [(column: "v", is: "speed_m_s"), (column: "Torque", is: "engine_torque_n_m")]"#;
    assert!(alike(&Folder::log(log, fields).values("speed_m_s"), &[10.0, 20.0]));
}

#[test]
fn a_header_that_names_a_channel_and_its_unit_is_read_as_it_and_told() {
    let folder = Folder::log("time_s,Wheel Speed [mph]\n0,1\n1,2\n", "");
    assert!(alike(&folder.values("wheel_speed_m_s"), &[0.447_04, 0.894_08]));
    assert!(folder.load().unwrap().notices.iter().any(|notice| notice.kind == NoticeKind::Assumed));
}

#[test]
fn a_quoted_comma_is_part_of_a_name() {
    let log = "\"time_s\",\"Wheel,Speed\",\"F, x\"\n0,60,1\n1,120,2\n";
    let fields = r#"channels: [(column: "Wheel,Speed", is: "speed_m_s", unit: "rpm", radius_m: 0.5)]"#;
    let folder = Folder::log(log, fields);
    let turn = std::f64::consts::TAU * 0.5;
    assert!(alike(&folder.values("speed_m_s"), &[turn, 2.0 * turn]));
    assert_eq!(folder.values("F, x"), [1.0, 2.0]);
}

#[test]
fn lines_before_the_header_are_passed_over() {
    let log = "Datalogger 3000\nVehicle: tractor, red\nSampled 2024\n\nTime [s],Speed [km/h]\n0,36\n1,72\n";
    let fields = r#"channels: [(column: "Speed [km/h]", is: "speed_m_s")]"#;
    assert!(alike(&Folder::log(log, fields).values("speed_m_s"), &[10.0, 20.0]));
}

#[test]
fn other_columns_pass_through_or_are_left_out() {
    let log = "time_s,Speed,Boost [bar],Mode\n0,36,1.5,N\n1,72,1.6,D\n";
    let folder = Folder::log(log, SPEED);
    assert_eq!(folder.values("Boost [bar]"), [1.5, 1.6]);
    let notices = folder.load().unwrap().notices;
    assert!(notices.iter().any(|n| n.kind == NoticeKind::Text && n.channel.as_deref() == Some("Mode")));
    let narrow = Folder::log(log, &format!("keep_others: false, {SPEED}")).load().unwrap();
    assert_eq!(narrow.runs[0].trace.channels().len(), 1);
}

#[test]
fn a_parquet_file_holds_one_run_or_several() {
    let folder = Folder::of(&[(
        "recording.ron",
        br#"(about: "p", runs: [(id: "p", file: "log.parquet")], format: parquet,
            channels: [(column: "v", is: "speed_m_s", unit: "km/h")])"#,
    )]);
    let run = |id: &str| {
        let mut trace = Trace::new(vec![0.0, 1.0]).unwrap();
        trace.push("v", vec![36.0, 72.0], Origin::Predicted).unwrap();
        Run { id: id.to_owned(), trace }
    };
    write_parquet(&folder.path("log.parquet"), &[run("a")]).unwrap();
    assert!(alike(&folder.values("speed_m_s"), &[10.0, 20.0]));
    assert_eq!(folder.load().unwrap().runs[0].id, "p");
    assert_eq!(folder.load().unwrap().runs[0].trace.channel("speed_m_s").unwrap().origin, Origin::Measured);
    write_parquet(&folder.path("log.parquet"), &[run("a"), run("b")]).unwrap();
    let ids: Vec<String> = folder.load().unwrap().runs.into_iter().map(|run| run.id).collect();
    assert_eq!(ids, ["p.a", "p.b"]);
}

#[test]
fn a_log_longer_than_what_is_looked_at_is_read_whole() {
    let log = lines("time_s;speed_m_s;note", 60_000, |row| format!("{row};{},25;ä", row % 7));
    assert!(log.len() > 3 << 18);
    let folder = Folder::log(log, "");
    let speed = folder.values("speed_m_s");
    assert_eq!((speed.len(), speed[59_999]), (60_000, 59_999_f64 % 7.0 + 0.25));
}
