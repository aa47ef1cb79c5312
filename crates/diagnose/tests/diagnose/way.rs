//! Speeds beside places that were measured: the way says what their scale is.

use super::several::ids;
use super::{changed, found, recorded};
use headland_diagnose::{Diagnosed, Options, Verdict};
use headland_recording::Recording;

/// Every speed so many times what it was.
fn scaled(sound: &Recording, scale: f64) -> Recording {
    changed(sound, "speed_m_s", |value, _, _| scale * value)
}

fn told(recording: &Recording, options: &Options) -> Diagnosed {
    found(recording, options).unwrap()
}

#[test]
fn a_scale_that_the_way_denies_is_taken_out_before_anything_else_and_told() {
    let hurt = scaled(&recorded(0.069, "neutral_drag(force_n: 1500.0)"), 1.035);
    let found = told(&hurt, &Options::default());
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Both, "{}", said.answer);
    let mut all = ids(&found);
    all.sort_unstable();
    assert_eq!(all, ["neutral_drag", "speed_scale"], "{}", said.answer);
    let scale = said.findings.iter().find(|finding| finding.id == "speed_scale").unwrap();
    let scale = &scale.parameters[0];
    assert!(scale.ci95[0] < 1.035 && 1.035 < scale.ci95[1] && scale.ci95[1] < 1.045, "{scale:?}");
    // The description that is written holds it, as any scale of a sensor.
    assert!(found.corrections.iter().any(|(channel, _, by, _)| channel == "speed_m_s" && *by == scale.value));
}

#[test]
fn a_scale_is_left_in_where_it_may_not_be_claimed_and_where_the_way_confirms_the_speed() {
    let without = Options { without: vec!["speed_scale".to_owned()], ..Options::default() };
    let found = told(&scaled(&recorded(0.069, ""), 1.035), &without);
    assert!(
        !ids(&found).contains(&"speed_scale") && found.corrections.is_empty(),
        "{}",
        found.diagnosis.answer
    );
    let found = told(&recorded(0.07, "wind(speed_m_s: 6.2, from_rad: 0.4)"), &Options::default());
    assert!(
        found.diagnosis.tried.iter().all(|tried| tried.id != "speed_scale"),
        "{}",
        found.diagnosis.answer
    );
}
