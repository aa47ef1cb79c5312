//! Large logs are streamed: memory holds the kept columns and never the text.

use super::help::{Place, headland};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::process::Stdio;
use std::time::Duration;

const MEGABYTE: u64 = 1 << 20;

/// Writes a log of about this size, a roll-out and then a stand, and reads it; gives bytes and greatest memory [MB].
fn read(size_mb: u64) -> (u64, u64) {
    let place = Place::new();
    place.write(
        "recording.ron",
        r#"(
    about: "a long log",
    runs: [(id: "r1", file: "long.csv", segments: [(from_s: 0.0, to_s: 20.0)])],
    channels: [(column: "speed", is: "speed_m_s")],
    keep_others: false,
    known: [(name: "mass_kg", value: 1000)],
)"#,
    );
    let path = place.path("long.csv");
    let mut file = BufWriter::new(File::create(&path).unwrap());
    writeln!(file, "time_s,speed,a,b,c,remark").unwrap();
    // Words that nobody keeps make the rows as long as those of a logger that writes everything.
    let padding = "lorem ".repeat(30);
    let (mut written, mut row) = (0_u64, 0_u32);
    while written < size_mb * MEGABYTE {
        let time_s = f64::from(row) * 0.1;
        let line = format!("{time_s:.1},{:.4},1.0,2.0,3.0,{padding}\n", (10.0 - 0.3 * time_s).max(0.0));
        file.write_all(line.as_bytes()).unwrap();
        written += line.len() as u64;
        row += 1;
    }
    file.flush().unwrap();
    let arguments = ["coastdown", &place.path("recording.ron"), "--out", &place.path("out"), "--quiet"];
    let mut child = headland().args(arguments).stdout(Stdio::null()).spawn().unwrap();
    let mut most_mb = 0;
    let status = loop {
        most_mb = most_mb.max(memory_mb(child.id()));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    assert!(status.success());
    (written, most_mb)
}

/// Greatest resident memory of a process so far [MB]; 0 where the system does not tell.
fn memory_mb(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse::<u64>().ok());
    kilobytes.unwrap_or(0) / 1024
}

#[test]
fn a_log_of_50_mb_takes_far_less_memory_than_its_text() {
    let (bytes, memory) = read(50);
    eprintln!("{} MB of text, {memory} MB of memory", bytes / MEGABYTE);
    // About 20 MB are the program; two columns of a quarter million rows are 4 MB.
    assert!(memory < 45, "{memory} MB");
}

#[test]
#[ignore = "writes and reads 2 GB"]
fn a_log_of_2_gb_takes_what_its_numbers_take() {
    let (bytes, memory) = read(2048);
    eprintln!("{} MB of text, {memory} MB of memory", bytes / MEGABYTE);
    assert!(memory < 600, "{memory} MB");
}
