//! Prints what a description gives: `cargo run -p headland-recording --example told -- scenarios/recordings/twizy.ron`.
#![expect(clippy::print_stdout, reason = "an example prints")]

use std::path::Path;

fn main() -> Result<(), headland_recording::RecordingError> {
    for argument in std::env::args().skip(1) {
        let recording = headland_recording::load(Path::new(&argument))?;
        println!("{argument}: {}", recording.about);
        for run in &recording.runs {
            let channels: Vec<&str> =
                run.trace.channels().iter().map(|channel| channel.name.as_str()).collect();
            println!(
                "  {}: {} rows, {:.1} s, {}",
                run.id,
                run.trace.len(),
                run.trace.duration_s(),
                channels.join(" ")
            );
        }
        for notice in &recording.notices {
            println!("  {:9} {notice}", notice.kind.name());
        }
    }
    Ok(())
}
