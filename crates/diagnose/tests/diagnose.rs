//! What is hidden in simulated recordings is found, what is not there is not, and what cannot be known is said.
//!
//! The recordings come from the simulator with noise of the sensors added; harder ones, of another plant, are made by
//! the generator of concealed cases.

#![allow(clippy::result_large_err, reason = "a test fails once")]

#[path = "diagnose/beside.rs"]
mod beside;
#[path = "diagnose/channels.rs"]
mod channels;
#[path = "diagnose/coasts.rs"]
mod coasts;
#[path = "diagnose/engine.rs"]
mod engine;
#[path = "diagnose/foretold.rs"]
mod foretold;
#[path = "diagnose/ground.rs"]
mod ground;
#[path = "diagnose/hurt.rs"]
mod hurt;
#[path = "diagnose/roads.rs"]
mod roads;
mod setting;
#[path = "diagnose/several.rs"]
mod several;
#[path = "diagnose/way.rs"]
mod way;

use headland_calibrate::statistics::Draws;
use headland_diagnose::{Options, Verdict};
use headland_recording::Recording;
use headland_scenario::Scenario;
use headland_trace::{Origin, Trace};
use setting::{found, named, recorded};
use std::path::Path;

#[test]
fn a_nominal_parameter_that_is_a_little_wrong_is_calibrated_and_nothing_is_claimed() {
    let found = found(&recorded(0.0712, ""), &Options::default()).unwrap();
    assert_eq!(found.diagnosis.verdict, Verdict::None, "{}", found.diagnosis.answer);
    let coefficient = &found.diagnosis.calibrated[0];
    assert!(coefficient.ci95[0] < 0.0712 && 0.0712 < coefficient.ci95[1], "{coefficient:?}");
    let held = found.diagnosis.fit.held_out.unwrap();
    assert!(held.rmse_after < 0.3 * held.rmse_before, "{held:?}");
}

#[test]
fn a_wind_is_found_with_its_direction_and_shown_on_the_run_that_was_held_out() {
    let found = found(&recorded(0.07, "wind(speed_m_s: 6.2, from_rad: 0.4)"), &Options::default()).unwrap();
    assert_eq!(found.diagnosis.findings[0].id, "wind", "{}", found.diagnosis.answer);
    let speed = &found.diagnosis.findings[0].parameters[0];
    assert!(speed.ci95[0] < 6.2 && 6.2 < speed.ci95[1], "{speed:?}");
    let held = found.diagnosis.fit.held_out.as_ref().unwrap();
    assert!(held.rmse_after < 2.5 * held.noise && held.rmse_before > 4.0 * held.noise, "{held:?}");
    // What was found runs in the scenario.
    let registry = headland_stock::registry();
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    assert_eq!(improved.model(&registry).unwrap().effects.len(), 1);
}

#[test]
fn a_drag_above_a_speed_is_found_between_the_points_of_the_grid() {
    let hidden = "speed_threshold(force_n: 830.0, threshold_m_s: 5.37, width_m_s: 0.6)";
    let found = found(&recorded(0.069, hidden), &Options::default()).unwrap();
    assert!(named(&found, "speed_threshold"), "{}", found.diagnosis.answer);
    let threshold =
        found.diagnosis.findings[0].parameters.iter().find(|one| one.name == "threshold_m_s").unwrap();
    assert!((threshold.value - 5.37).abs() < 0.4, "{threshold:?}");
}

#[test]
fn the_same_seed_gives_the_same_bits_at_any_thread_count() {
    let recording = recorded(0.07, "neutral_drag(force_n: 700.0)");
    let text = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| found(&recording, &Options::default())).unwrap();
        serde_json::to_string(&found.diagnosis).unwrap()
    };
    let one = text(1);
    assert_eq!(one, text(3));
    assert!(one.contains("\"neutral_drag\""), "{one}");
}

#[test]
fn a_cause_that_is_left_out_of_the_library_is_not_claimed() {
    let recording = recorded(0.07, "wind(speed_m_s: 6.2, from_rad: 0.4)");
    let without = Options { without: vec!["wind".to_owned()], ..Options::default() };
    assert!(!named(&found(&recording, &without).unwrap(), "wind"));
    let misspelt = Options { without: vec!["wnid".to_owned()], ..Options::default() };
    let error = found(&recording, &misspelt).unwrap_err().to_string();
    assert!(error.contains("did you mean `wind`?"), "{error}");
}

#[test]
fn channels_that_make_no_balance_are_refused_with_what_it_would_take() {
    let mut recording = recorded(0.07, "");
    for run in &mut recording.runs {
        run.trace.remove("tractive_force_n");
        run.trace.remove("coasting");
    }
    let error = found(&recording, &Options::default()).unwrap_err().to_string();
    assert!(error.contains("tractive_force_n"), "{error}");
}

/// A recording with one channel changed.
fn changed(recording: &Recording, name: &str, change: impl Fn(f64, &Trace, usize) -> f64) -> Recording {
    let mut changed = recording.clone();
    for run in &mut changed.runs {
        let mut trace = Trace::new(run.trace.time_s().to_vec()).unwrap();
        for channel in run.trace.channels() {
            let values = channel.values.iter().enumerate().map(|(index, value)| {
                if channel.name == name { change(*value, &run.trace, index) } else { *value }
            });
            trace.push(channel.name.clone(), values.collect::<Vec<f64>>(), channel.origin).unwrap();
        }
        run.trace = trace;
    }
    changed
}

/// What is said of a recording of which nothing can be concluded.
fn refused(recording: &Recording) -> String {
    let found = found(recording, &Options::default()).unwrap().diagnosis;
    assert_eq!(found.verdict, Verdict::CannotTell, "{}", found.answer);
    assert!(found.findings.is_empty(), "{:?}", found.findings);
    found.answer
}

#[test]
fn a_position_that_moves_otherwise_than_the_speed_contradicts_it() {
    let said = refused(&changed(&recorded(0.07, ""), "position_m", |value, _, _| 2.0 * value));
    assert!(said.contains("Speed and position contradict each other"), "{said}");
    assert!(said.contains("2.0"), "{said}");
}

#[test]
fn a_vehicle_that_speeds_up_while_it_is_flagged_as_coasting_is_no_finding() {
    let said = refused(&changed(&recorded(0.07, ""), "coasting", |_, _, _| 1.0));
    assert!(said.contains("flagged as coasting"), "{said}");
}

#[test]
fn a_recording_of_another_vehicle_is_no_finding() {
    let said = refused(&changed(&recorded(0.07, ""), "tractive_force_n", |value, _, _| 2.5 * value));
    assert!(said.contains("not of this vehicle"), "{said}");
    let said = refused(&changed(&recorded(0.07, ""), "tractive_force_n", |value, _, _| 0.3 * value));
    assert!(said.contains("not of this vehicle"), "{said}");
}

#[test]
fn a_force_of_which_more_is_lost_the_faster_it_goes_is_that_of_this_vehicle() {
    let lossy = changed(&recorded(0.07, ""), "tractive_force_n", |value, trace, index| {
        value * (1.0 + 0.25 * trace.get("speed_m_s").unwrap()[index])
    });
    let said = found(&lossy, &Options::default()).unwrap().diagnosis.answer;
    assert!(!said.contains("not of this vehicle"), "{said}");
}

#[test]
fn a_force_that_drives_the_other_way_is_no_finding() {
    let said = refused(&changed(&recorded(0.07, ""), "tractive_force_n", |value, _, _| -value));
    assert!(said.contains("contradict each other"), "{said}");
}

#[test]
fn where_nothing_varies_nothing_is_claimed() {
    let mut steady = changed(&recorded(0.07, ""), "heading_rad", |_, _, _| 0.0);
    for (number, run) in steady.runs.iter_mut().enumerate() {
        let mut draws = Draws::new(5, number as u64);
        let time_s: Vec<f64> = (0..800).map(|index| 0.05 * f64::from(index)).collect();
        let mut trace = Trace::new(time_s.clone()).unwrap();
        let speed: Vec<f64> = time_s.iter().map(|_| 5.0 + 0.02 * draws.normal()).collect();
        let position: Vec<f64> = time_s.iter().map(|time| 5.0 * time).collect();
        let channels = [
            ("speed_m_s", speed),
            ("position_m", position),
            ("heading_rad", vec![0.0; 800]),
            ("tractive_force_n", time_s.iter().map(|_| 11_500.0 + 50.0 * draws.normal()).collect()),
            ("coasting", vec![0.0; 800]),
        ];
        for (name, values) in channels {
            trace.push(name, values, Origin::Measured).unwrap();
        }
        run.trace = trace;
    }
    let said = refused(&steady);
    assert!(said.contains("Nothing varies"), "{said}");
    // A force without any noise is a channel that sticks, and nothing is left to conclude from.
    let said = refused(&changed(&steady, "tractive_force_n", |_, _, _| 11_500.0));
    assert!(said.contains("0 short intervals"), "{said}");
}

#[test]
fn of_a_single_run_no_cause_is_claimed() {
    let mut single = recorded(0.07, "wind(speed_m_s: 6.2, from_rad: 0.4)");
    single.runs.truncate(1);
    let said = refused(&single);
    assert!(said.contains("none can be held out"), "{said}");
}

/// The mismatch of a drag above a speed sits at speeds above it, and nothing is left of it afterwards.
#[test]
fn the_map_shows_the_speeds_at_which_a_drag_sets_in() {
    use headland_diagnose::{Kind, Over};
    let hidden = "speed_threshold(force_n: 1500.0, threshold_m_s: 5.4, width_m_s: 0.6)";
    let found = found(&recorded(0.069, hidden), &Options::default()).unwrap().diagnosis;
    assert_eq!(found.first_balance, Some(Kind::Motion));
    let speeds: Vec<_> = found.mismatch.iter().filter(|one| one.over == Over::Speed).collect();
    let strongest = speeds.iter().max_by(|one, other| one.sigma.total_cmp(&other.sigma)).unwrap();
    assert!(strongest.from > 4.0 && strongest.to > 7.0 && strongest.mean > 500.0, "{strongest:?}");
    let size = |all: &[headland_diagnose::Mismatch]| {
        all.iter().filter(|one| one.over == Over::Speed).map(|one| one.sigma.abs()).fold(0.0, f64::max)
    };
    assert!(size(&found.mismatch_left) < 0.2 * size(&found.mismatch), "{:?}", found.mismatch_left);
}

#[test]
fn nothing_stands_out_of_a_recording_in_which_nothing_is_missing() {
    let found = found(&recorded(0.0712, ""), &Options::default()).unwrap().diagnosis;
    assert!(found.mismatch.is_empty() && found.first_balance.is_none(), "{:?}", found.mismatch);
}

#[test]
fn an_effect_comes_with_a_band_that_holds_it() {
    let found = found(&recorded(0.07, "wind(speed_m_s: 6.2, from_rad: 0.4)"), &Options::default()).unwrap();
    let trace = &found.effects[0].trace;
    let get = |name: &str| trace.get(name).unwrap();
    let (low, value, high) = (get("wind_n_low"), get("wind_n"), get("wind_n_high"));
    assert!(value.iter().zip(low).zip(high).all(|((value, low), high)| low <= value && value <= high));
    assert!(low.iter().zip(high).any(|(low, high)| high - low > 1.0));
}
