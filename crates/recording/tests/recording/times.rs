//! Every way in which logs tell the time.

use crate::{Folder, alike};
use headland_recording::NoticeKind;

fn times(header: &str, cells: [&str; 3], fields: &str) -> Vec<f64> {
    let log = format!("{header};speed_m_s\n{};1\n{};2\n{};3\n", cells[0], cells[1], cells[2]);
    Folder::log(log, fields).values("time_s")
}

#[test]
fn seconds_keep_their_zero() {
    assert_eq!(times("time_s", ["-0.5", "0.25", "2"], ""), [-0.5, 0.25, 2.0]);
    assert_eq!(times("Time [s]", ["10", "11", "12.5"], ""), [10.0, 11.0, 12.5]);
    assert_eq!(times("Time [ms]", ["0", "100", "250"], ""), [0.0, 0.1, 0.25]);
    assert!(alike(&times("Minutes", ["0.5", "1", "2"], ""), &[30.0, 60.0, 120.0]));
    assert!(alike(
        &times("step", ["5", "6", "8"], r#"time: (column: "step", unit: "min")"#),
        &[300.0, 360.0, 480.0]
    ));
    let by_channel = r#"channels: [(column: "clk", is: "time_s", unit: "ms")]"#;
    assert_eq!(times("clk", ["0", "500", "1000"], by_channel), [0.0, 0.5, 1.0]);
}

#[test]
fn epochs_count_from_the_first_row() {
    assert_eq!(times("timestamp", ["1698043850", "1698043851", "1698043852.5"], ""), [0.0, 1.0, 2.5]);
    assert_eq!(times("timestamp", ["1698043850000", "1698043850100", "1698043850200"], ""), [0.0, 0.1, 0.2]);
}

#[test]
fn dates_and_clocks_count_from_the_first_row() {
    let iso = ["2023-10-23T23:59:59Z", "2023-10-24T00:00:00.5Z", "2023-10-24T00:00:02Z"];
    assert_eq!(times("t", iso, ""), [0.0, 1.5, 3.0]);
    let zone = ["2023-10-23T10:00:00+02:00", "2023-10-23T08:00:01Z", "2023-10-23T10:00:02+02:00"];
    assert_eq!(times("t", zone, ""), [0.0, 1.0, 2.0]);
    assert_eq!(
        times("Zeit", ["24.12.2023 06:00:00", "24.12.2023 06:00:01", "24.12.2023 06:00:02"], ""),
        [0.0, 1.0, 2.0]
    );
    let two = ["06/30/2021;23:59:59", "07/01/2021;00:00:00", "07/01/2021;00:00:01"];
    assert_eq!(times("Date;Time", two, ""), [0.0, 1.0, 2.0]);
    assert_eq!(times("Time", ["23:59:59.5", "00:00:00.0", "00:00:01.0"], ""), [0.0, 0.5, 1.5]);
}

#[test]
fn a_date_that_could_be_two_days_has_to_be_told() {
    let cells = ["03/04/2021;10:00:00", "03/04/2021;10:00:01", "03/04/2021;10:00:02"];
    assert_eq!(
        times("Date;Time", cells, r#"time: (date: "Date", clock: "Time", order: mdy)"#),
        [0.0, 1.0, 2.0]
    );
    let log = format!("Date;Time;speed_m_s\n{};1\n{};2\n", cells[0], cells[1]);
    assert!(Folder::log(log, "").refusal().contains("day/month or month/day; write `time: (order: dmy)`"));
}

#[test]
fn rows_without_a_time_need_a_period() {
    let folder = Folder::log("speed_m_s,grade\n1,0\n2,0\n3,0\n", "time: (period_s: 0.02)");
    assert!(alike(&folder.values("time_s"), &[0.0, 0.02, 0.04]));
    assert!(
        Folder::log("speed_m_s,grade\n1,0\n2,0\n", "")
            .refusal()
            .contains("no time column among `speed_m_s`, `grade`")
    );
}

#[test]
fn uneven_time_is_kept_gaps_and_repeats_are_told() {
    let log = "time_s,speed_m_s\n0,1\n0.1,2\n0.1,9\n0.25,3\n0.3,3\n0.4,3\n5,4\n5.1,\n";
    let folder = Folder::log(log, "");
    assert_eq!(folder.values("time_s"), [0.0, 0.1, 0.25, 0.3, 0.4, 5.0, 5.1]);
    assert!(alike(&folder.values("speed_m_s"), &[1.0, 2.0, 3.0, 3.0, 3.0, 4.0, f64::NAN]));
    let notices = folder.load().unwrap().notices;
    let seen: Vec<_> = notices.iter().map(|n| (n.kind, n.count, n.first_s)).collect();
    assert!(seen.contains(&(NoticeKind::Repeated, 1, Some(0.1))), "{seen:?}");
    assert!(seen.contains(&(NoticeKind::Gap, 1, Some(0.4))), "{seen:?}");
    assert!(seen.contains(&(NoticeKind::Nan, 1, Some(5.1))), "{seen:?}");
}
