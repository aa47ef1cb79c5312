//! Recordings that were hurt: an error that says what is wrong, or an answer, and never a cause that is not there.

use super::{changed, found, recorded};
use headland_diagnose::{Options, Verdict};
use headland_recording::Recording;
use headland_trace::Trace;

/// The error that a recording is refused with.
fn error(recording: &Recording) -> String {
    found(recording, &Options::default()).unwrap_err().to_string()
}

/// A recording with its time base changed.
fn timed(recording: &Recording, time: impl Fn(usize, f64) -> f64) -> Recording {
    let mut changed = recording.clone();
    for run in &mut changed.runs {
        let times = run.trace.time_s().iter().enumerate().map(|(index, at)| time(index, *at)).collect();
        let mut trace = Trace::new(times).unwrap();
        for channel in run.trace.channels() {
            trace.push(channel.name.clone(), channel.values.clone(), channel.origin).unwrap();
        }
        run.trace = trace;
    }
    changed
}

#[test]
fn a_run_without_speed_is_left_out_and_said_and_refused_where_none_has_any() {
    let mut recording = recorded(0.07, "");
    recording.runs[2].trace.remove("speed_m_s");
    let told = found(&recording, &Options::default()).unwrap().diagnosis;
    assert!(told.notes.iter().any(|note| note.contains("In r2 no speed was recorded")), "{:?}", told.notes);
    for run in &mut recording.runs {
        run.trace.remove("speed_m_s");
    }
    let told = error(&recording);
    assert!(told.contains("run `r0`: there is no channel `speed_m_s`"), "{told}");
    let told = error(&changed(&recorded(0.07, ""), "speed_m_s", |_, _, _| f64::NAN));
    assert!(told.contains("run `r0`: channel `speed_m_s` has fewer than two values"), "{told}");
}

#[test]
fn a_clock_that_jumps_by_years_is_refused_with_both_times() {
    let told =
        error(&timed(&recorded(0.07, ""), |index, at| if index == 0 { at } else { 1.0e300 * (1.0 + at) }));
    assert!(told.contains("run `r0`: `time_s` jumps from 0.0 s to 1."), "{told}");
}

#[test]
fn a_vehicle_that_speeds_up_without_its_force_contradicts_it() {
    let told = super::refused(&changed(&recorded(0.07, ""), "tractive_force_n", |_, _, _| 0.0));
    assert!(told.contains("more than its recorded force can"), "{told}");
}

#[test]
fn what_is_lost_or_held_makes_no_cause() {
    type Hurt = (&'static str, fn(&Recording) -> Recording);
    let hurts: [Hurt; 6] = [
        ("a force in kilonewtons", |sound| changed(sound, "tractive_force_n", |value, _, _| 1e-3 * value)),
        ("a stretch without speed", |sound| {
            changed(sound, "speed_m_s", |value, trace, index| {
                if (trace.len() / 3..trace.len() / 2).contains(&index) { f64::NAN } else { value }
            })
        }),
        ("a stretch without force", |sound| {
            changed(sound, "tractive_force_n", |value, trace, index| {
                if (trace.len() / 4..trace.len() / 2).contains(&index) { f64::NAN } else { value }
            })
        }),
        ("no speed but zero", |sound| changed(sound, "speed_m_s", |_, _, _| 0.0)),
        ("one speed", |sound| changed(sound, "speed_m_s", |_, _, _| 5.0)),
        ("two samples", |sound| {
            let mut short = sound.clone();
            for run in &mut short.runs {
                let end_s = run.trace.time_s()[1];
                run.trace = run.trace.slice(0.0, end_s);
            }
            short
        }),
    ];
    let sound = recorded(0.07, "");
    for (what, hurt) in hurts {
        if let Ok(found) = found(&hurt(&sound), &Options::default()) {
            let told = found.diagnosis;
            // Values that are missing may be told of, as what they are.
            let causes = told.findings.iter().filter(|finding| finding.id != "dropout").count();
            assert_eq!(causes, 0, "{what}: {}", told.answer);
            let quiet = matches!(told.verdict, Verdict::None | Verdict::CannotTell);
            assert!(quiet || told.verdict == Verdict::SensorArtefact, "{what}: {}", told.answer);
        }
    }
}
