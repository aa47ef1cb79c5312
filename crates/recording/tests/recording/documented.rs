//! The example of `docs/recordings.md` does what the page says.

use crate::{Folder, alike};
use headland_recording::NoticeKind;
use std::path::Path;

/// The first block of a kind in the page.
fn block(page: &str, kind: &str) -> String {
    let (_, rest) = page.split_once(&format!("```{kind}\n")).unwrap();
    rest.split_once("```").unwrap().0.to_owned()
}

#[test]
fn the_example_of_the_documentation_is_read_as_it_says() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/recordings.md");
    let page = std::fs::read_to_string(page).unwrap();
    let (log, description) = (block(&page, "csv"), block(&page, "ron"));
    let latin: Vec<u8> = log.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let folder = Folder::of(&[
        ("pass_1.txt", log.as_bytes()),
        ("pass_2.txt", latin.as_slice()),
        ("recording.ron", description.as_bytes()),
    ]);
    let recording = folder.load().unwrap();
    let (first, second) = (&recording.runs[0], &recording.runs[1]);
    assert!(alike(first.trace.time_s(), &[0.0, 0.2, 0.4, 0.6, 1.4, 1.6]));
    assert!(alike(&first.trace.get("speed_m_s").unwrap()[..2], &[8.3, 29.74 / 3.6]));
    assert!(alike(&first.trace.get("drawbar_force_n").unwrap()[1..4], &[400.0, f64::NAN, 400.0]));
    assert!(alike(&first.trace.get("fuel_rate_kg_s").unwrap()[..1], &[38.2e-3 / 3600.0 * 832.0]));
    assert!(second.reversed && second.held_out && !first.held_out);
    assert_eq!(first.known("mass_kg").unwrap().sd, Some(100.0));
    let told = |kind, part: &str| {
        recording.notices.iter().any(|notice| notice.kind == kind && notice.text.contains(part))
    };
    assert!(told(NoticeKind::Gap, "the longest, 0.8 s, starts at 0.6 s"), "{:?}", recording.notices);
    assert!(told(NoticeKind::Nan, "`drawbar_force_n` has no value in 1 of 6 rows"));
    assert!(told(NoticeKind::Text, "`Bemerkung`"));
    let misspelt = description.replace("v_GPS", "v_GSP");
    let folder = Folder::of(&[("pass_1.txt", log.as_bytes()), ("recording.ron", misspelt.as_bytes())]);
    assert_eq!(folder.refusal(), block(&page, "text").trim_end());
}
