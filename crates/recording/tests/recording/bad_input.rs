//! What cannot be used is refused with a file, a line, what was found and what was expected.

use crate::Folder;
use headland_recording::{RecordingError, load};
use std::path::Path;

#[test]
fn a_description_that_is_no_description() {
    let refusal = |text: &str| Folder::of(&[("recording.ron", text.as_bytes())]).refusal();
    assert!(refusal("").contains("the file is empty"));
    assert!(
        refusal("(about: \"x\",\n run: [])")
            .contains("no field `run`; did you mean `runs`?\n  recording.ron:2:")
    );
    assert!(refusal("(about: \"x\")").contains("lacks the field `runs`"));
    assert!(refusal("(about: \"x\",\nruns: [)").contains("recording.ron:2:"));
    assert!(refusal("(about: \"x\", runs: [])").contains("`runs` is empty, expected at least one run"));
    let twice = "(about: \"x\", runs: [(id: \"a\", file: \"f\"),\n(id: \"a\", file: \"g\")])";
    assert!(refusal(twice).contains("the run `a` stands twice, expected each once\n  recording.ron:2:6"));
    let cases = [
        ("format: xml", "`xml` is none of the choices here"),
        ("format: mdf4", "mdf4 is not supported yet"),
        ("split: (gap_s: -1.0)", "`gap_s` is -1, expected more than 0"),
        ("known: [(name: \"mass_kg\", value: -3.0)]", "`mass_kg` is -3, expected more than 0"),
        ("known: [(name: \"mass_kg\", value: NaN)]", "`mass_kg` is NaN"),
        ("known: [(name: \"mass_kg\", value: \"3 km/h\")]", "`km/h` does not fit: expected a unit of kg"),
        ("known: [(name: \"mass_kg\", value: 3.0, sd: -1.0)]", "`sd` is -1"),
        ("channels: [(column: \"v\", is: \"sped_m_s\")]", "no channel `sped_m_s`; did you mean `speed_m_s`?"),
        ("channels: [(column: \"v\", is: \"speed_kmh\")]", "did you mean `speed_m_s`?"),
        (
            "channels: [(column: \"v\", is: \"a\"), (column: \"w\", is: \"a\")]",
            "the channel `a` stands twice",
        ),
        ("channels: [(columns: [\"v\", \"w\"], is: \"a\")]", "`combine` is left out"),
        ("channels: [(column: \"v\", is: \"a\", scale: 0.0)]", "`scale` is 0"),
        (
            "channels: [(is: \"speed_m_s\", sensor: (scale: 0.0))]",
            "`scale` is 0, expected a number other than 0",
        ),
        ("channels: [(is: \"speed_m_s\", sensor: (noise: -1.0))]", "`noise` is -1"),
        ("channels: [(is: \"speed_m_s\", sensor: (lag: 1.0))]", "no field `lag`"),
        ("format: csv(delimiter: \"::\")", "`delimiter` is \"::\""),
        ("format: csv(decimal: \"x\")", "`decimal` is \"x\""),
        ("format: csv(encoding: \"klingon\")", "`encoding` is `klingon`, expected a name such as"),
        ("format: parquet", "`format` is parquet, expected csv"),
        ("time: (period_s: 0.0)", "`period_s` is 0, expected seconds between rows"),
    ];
    for (fields, expected) in cases {
        let refusal = Folder::log("time_s,v\n0,1\n1,2\n", fields).refusal();
        assert!(refusal.contains(expected), "{fields}: {refusal}");
        assert!(refusal.contains("recording.ron:2:"), "{fields}: {refusal}");
    }
}

#[test]
fn a_column_that_is_not_there_is_answered_with_the_nearest() {
    let fields = "channels: [\n(column: \"Velocty [km/h]\", is: \"speed_m_s\")]";
    let refusal = Folder::log("time_s,Velocity [km/h]\n0,1\n1,2\n", fields).refusal();
    assert_eq!(
        refusal,
        "no column `Velocty [km/h]` in log.csv; did you mean `Velocity [km/h]`?\n  recording.ron:3:10"
    );
    let far =
        Folder::log("time_s,a,b\n0,1,2\n", "channels: [(column: \"Velocity\", is: \"speed_m_s\")]").refusal();
    assert!(far.contains("there are: `time_s`, `a`, `b`"), "{far}");
}

#[test]
fn a_unit_that_does_not_fit_its_channel() {
    let channel = |header: &str, rest: &str| {
        let fields = format!("channels: [(column: \"{header}\", is: \"speed_m_s\"{rest})]");
        Folder::log(format!("time_s,{header}\n0,1\n1,2\n"), &fields).refusal()
    };
    assert!(channel("v [kg]", "").starts_with("`kg` does not fit `speed_m_s`: expected a unit of m/s\n"));
    assert!(channel("v", ", unit: \"N\"").contains("`N` does not fit"));
    assert!(channel("v [rpm]", "").contains("give `radius_m`"));
    assert!(channel("v [furlong/h]", "").contains("`furlong` in `furlong/h` is no known unit"));
    assert!(channel("v", ", unit: \"parsec\"").contains("no unit `parsec`"));
    let time = Folder::log("Time [kg],speed_m_s\n0,1\n1,2\n", "").refusal();
    assert!(time.contains("`kg` does not fit `time_s`"), "{time}");
}

#[test]
fn rows_that_are_not_rows() {
    let refusal = |log: &str| Folder::log(log, "").refusal();
    assert_eq!(
        refusal("time_s,speed_m_s\n0,1\n2,1\n1,1\n"),
        "time runs backwards: 2 s is followed by 1 s\n  log.csv:4"
    );
    assert_eq!(
        refusal("time_s,speed_m_s\n0,1\n1,1,5\n"),
        "3 cells in this row, expected 2 as in the header\n  log.csv:3"
    );
    assert_eq!(
        refusal("time_s,speed_m_s\n0,1\n1\n"),
        "1 cells in this row, expected 2 as in the header\n  log.csv:3"
    );
    assert_eq!(
        refusal("made by hand\n\ntime_s,speed_m_s\n0,1\n1,fast\n"),
        "`fast` in column `speed_m_s`, expected a number, or nothing where there is no value\n  log.csv:5:3"
    );
    assert!(refusal("time_s,other\n0,1\n1,fast\n").contains("`fast` in column `other`"));
    assert!(refusal("time_s,speed_m_s\n0,1\n,2\n").contains("`` in column `time_s`, expected a time"));
    assert!(refusal("time_s,speed_m_s\n0,1\nNaN,2\n").contains("`NaN` in column `time_s`"));
    assert_eq!(refusal(""), "the file is empty, expected a header and rows\n  log.csv");
    assert_eq!(
        refusal("time_s,speed_m_s\n"),
        "the file has a header and no rows, expected a header and rows\n  log.csv:1"
    );
    assert!(refusal("0,1\n1,2\n").contains("the first row starts with the number `0`"));
}

#[test]
fn files_that_are_not_files() {
    let folder = Folder::of(&[("recording.ron", br#"(about: "x", runs: [(id: "r", file: "log.csv")])"#)]);
    let refusal = folder.refusal();
    assert!(
        refusal.starts_with("cannot read `log.csv`") && refusal.contains("recording.ron:1:"),
        "{refusal}"
    );
    std::fs::create_dir(folder.path("log.csv")).unwrap();
    assert!(folder.refusal().starts_with("`log.csv` is a folder, expected a file\n  recording.ron:1:"));
    assert!(matches!(load(&folder.path("log.csv")), Err(RecordingError::Folder { .. })));
    let missing = load(Path::new("no/such/recording.ron")).unwrap_err();
    assert!(matches!(missing, RecordingError::File { .. }));
    assert_eq!(missing.location(), None);
}

/// Nothing is refused to the superuser, for whom there is nothing to test.
#[cfg(unix)]
#[test]
fn a_log_that_may_not_be_read() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::log("time_s,v\n0,1\n1,2\n", "");
    std::fs::set_permissions(folder.path("log.csv"), std::fs::Permissions::from_mode(0o000)).unwrap();
    if std::fs::read(folder.path("log.csv")).is_err() {
        assert!(
            folder.refusal().starts_with("cannot read `log.csv`: Permission denied"),
            "{}",
            folder.refusal()
        );
    }
}

#[test]
fn bytes_that_are_not_text() {
    assert!(Folder::log([0x50, 0x4b, 3, 4, 0, 0, 1, 2], "").refusal().contains("the file is binary"));
    let named = Folder::log(b"time_s,v\n0,1\n1,\xff\n", "format: csv(encoding: \"utf-8\")").refusal();
    assert!(named.contains("no UTF-8") && named.contains("log.csv:3"), "{named}");
    let cut = Folder::log([0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 0x4b], "").refusal();
    assert!(cut.starts_with("reading stopped"), "{cut}");
    let parquet = Folder::log(b"PAR1 and nothing behind it", "").refusal();
    assert!(parquet.contains("log.csv"), "{parquet}");
    let nothing = Folder::log(b"", "format: parquet").refusal();
    assert_eq!(nothing, "the file is empty, expected a header and rows\n  log.csv");
}

#[test]
fn a_segment_outside_its_log() {
    let description =
        br#"(about: "x", runs: [(id: "r", file: "log.csv", segments: [(from_s: 8.0, to_s: 9.0)])])"#;
    let folder = Folder::of(&[("recording.ron", description), ("log.csv", b"time_s,v\n0,1\n1,2\n")]);
    assert!(
        folder.refusal().contains("expected at least 2; the log goes from 0 to 1 s"),
        "{}",
        folder.refusal()
    );
    let turned = br#"(about: "x", runs: [(id: "r", file: "log.csv", segments: [(from_s: 9.0, to_s: 8.0)])])"#;
    let folder = Folder::of(&[("recording.ron", turned), ("log.csv", b"time_s,v\n0,1\n1,2\n")]);
    assert!(folder.refusal().contains("`to_s` is 8, expected more than from_s, 9"));
}

#[test]
fn every_refusal_of_a_log_has_a_place() {
    let error = Folder::log("time_s,speed_m_s\n0,1\n1,x\n", "").load().unwrap_err();
    let (path, line, column) = error.location().unwrap();
    assert!(path.ends_with("log.csv"));
    assert_eq!((line, column), (3, 3));
}
