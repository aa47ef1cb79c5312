//! The descriptions in `scenarios/recordings`, read where the recordings are at hand.

use headland_recording::{NoticeKind, Recording, load};
use std::env;
use std::path::{Path, PathBuf};

/// A described recording; `None`, said on standard error, where its logs are not at hand.
fn published(name: &str) -> Option<Recording> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join("..");
    let logs =
        env::var_os("HEADLAND_RECORDINGS").map_or_else(|| root.join("../shared/recordings"), PathBuf::from);
    if !logs.is_dir() {
        #[expect(clippy::print_stderr, reason = "a skipped test says so")]
        {
            eprintln!("skipped: no recordings in {}; set HEADLAND_RECORDINGS", logs.display());
        }
        return None;
    }
    Some(
        load(&root.join("scenarios").join("recordings").join(format!("{name}.ron")))
            .unwrap_or_else(|e| panic!("{e}")),
    )
}

fn told(recording: &Recording, kind: NoticeKind, run: &str, part: &str) -> bool {
    recording
        .notices
        .iter()
        .any(|notice| notice.kind == kind && notice.run == run && notice.text.contains(part))
}

fn largest(recording: &Recording, channel: &str) -> f64 {
    let values = recording.runs.iter().flat_map(|run| run.trace.get(channel).unwrap_or_default());
    values.copied().filter(|value| !value.is_nan()).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn every_description_is_tried_here() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/recordings");
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "ron"))
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    let expected = [
        "baja_coastdown",
        "bmw_i3",
        "camry_dyno",
        "camry_phases",
        "class8_trucks",
        "compton_challenge",
        "husky_farm",
        "tractor_t7165",
        "twizy",
    ];
    assert_eq!(names, expected);
}

#[test]
fn the_electric_car_has_28_trips_and_three_that_do_not_fit_themselves() {
    let Some(recording) = published("bmw_i3") else { return };
    assert_eq!(recording.runs.len(), 28);
    assert_eq!(recording.runs.iter().filter(|run| run.path.as_deref() == Some("FTM route")).count(), 4);
    assert!((30.0..45.0).contains(&largest(&recording, "speed_m_s")));
    assert!(told(&recording, NoticeKind::Jump, "TripB02", "at 2 places"));
    for trip in ["TripA13", "TripB02", "TripB13"] {
        assert!(told(&recording, NoticeKind::Lag, trip, "battery power and motor torque"), "{trip}");
    }
    assert!(!told(&recording, NoticeKind::Lag, "TripB03", ""));
    assert!(told(&recording, NoticeKind::Nan, "TripB28", "1625 of 13665"));
    assert!(!recording.notices.iter().any(|notice| notice.kind == NoticeKind::Sign));
    assert!(told(&recording, NoticeKind::Note, "", "friction brakes are not logged"));
}

#[test]
fn the_truck_is_cut_where_its_drives_were_joined() {
    let Some(recording) = published("class8_trucks") else { return };
    assert_eq!(recording.runs.len(), 18);
    assert!(told(&recording, NoticeKind::Split, "veh002", "17 places"));
    let jump = recording.runs.iter().flat_map(|run| run.trace.get("speed_m_s").unwrap().windows(2));
    assert!(jump.map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max) <= 3.0);
}

#[test]
fn the_tractor_has_two_columns_that_are_no_second_measurement() {
    let Some(recording) = published("tractor_t7165") else { return };
    assert_eq!(recording.runs.len(), 1);
    assert_eq!(recording.notices.iter().filter(|notice| notice.kind == NoticeKind::Duplicate).count(), 2);
    assert!((2.0..15.0).contains(&largest(&recording, "wheel_speed_m_s")));
    assert!((200.0..280.0).contains(&largest(&recording, "engine_speed_rad_s")));
}

#[test]
fn the_quadricycle_repeats_its_position_speed_and_jumps() {
    let Some(recording) = published("twizy") else { return };
    assert_eq!(recording.runs.len(), 11);
    assert!(
        recording.notices.iter().any(|n| n.kind == NoticeKind::Coarse && n.text.contains("gps_speed_m_s"))
    );
    assert!(told(&recording, NoticeKind::Jump, "T2_03_30_2021", "at 148 places"));
    assert_eq!(recording.notices.iter().filter(|n| n.kind == NoticeKind::Text).count(), 2);
}

/// The cold first 505 s take about a seventh more fuel than their hot repeat.
#[test]
fn the_phases_of_the_dynamometer_leave_out_where_the_engine_is_off() {
    let Some(recording) = published("camry_phases") else { return };
    assert_eq!(recording.runs.len(), 6);
    let fuel_kg = |id: &str, seconds: f64| -> f64 {
        let run = recording.runs.iter().find(|run| run.id == id).unwrap();
        let (time, rate) = (run.trace.time_s(), run.trace.get("fuel_rate_kg_s").unwrap());
        let pairs = time.windows(2).zip(rate.windows(2));
        let pairs = pairs.filter(|(time, _)| time[1] - run.trace.time_s()[0] <= seconds);
        pairs.map(|(time, rate)| 0.5 * (rate[0] + rate[1]) * (time[1] - time[0])).sum()
    };
    let ratio = fuel_kg("61811011_cold", 505.0) / fuel_kg("61811011_hot", 505.0);
    assert!((1.12..1.19).contains(&ratio), "{ratio}");
    for run in &recording.runs {
        let off = |rates: &[f64]| rates.iter().all(|rate| *rate == 0.0);
        let longest = run.trace.get("fuel_rate_kg_s").unwrap().windows(60).any(off);
        assert!(!longest, "the engine of {} is off for a minute", run.id);
    }
}

#[test]
fn the_bicycle_covers_the_distance_that_its_speed_says() {
    let Some(recording) = published("compton_challenge") else { return };
    assert_eq!(recording.runs.len(), 2);
    for run in &recording.runs {
        let (time, speed, way) =
            (run.trace.time_s(), run.trace.get("speed_m_s").unwrap(), run.trace.get("position_m").unwrap());
        let driven: f64 =
            (1..time.len()).map(|i| 0.5 * (speed[i] + speed[i - 1]) * (time[i] - time[i - 1])).sum();
        let logged = way[way.len() - 1] - way[0];
        // Speed is rounded to 0.1 km/h and distance to 1 m.
        assert!((driven / logged - 1.0).abs() < 0.01, "{driven} against {logged}");
    }
}

#[test]
fn the_field_robot_has_18_runs_at_half_a_metre_a_second() {
    let Some(recording) = published("husky_farm") else { return };
    assert_eq!(recording.runs.len(), 18);
    for run in &recording.runs {
        let speed = run.trace.get("wheel_speed_m_s").unwrap();
        let mean = speed.iter().sum::<f64>() / speed.len() as f64;
        assert!((0.4..0.6).contains(&mean), "{}: {mean}", run.id);
    }
}

#[test]
fn the_buggy_has_a_transducer_whose_zero_differs_from_run_to_run() {
    let Some(recording) = published("baja_coastdown") else { return };
    assert_eq!(recording.runs.len(), 8);
    assert!(recording.notices.iter().any(|notice| {
        notice.kind == NoticeKind::Offset
            && notice.channel.as_deref() == Some("wheel_force_x_n")
            && notice.text.contains("differently in 8 runs")
    }));
    assert!((8.0..15.0).contains(&largest(&recording, "speed_m_s")));
}

/// The dynamometer's fuel over the first 505 s of the cold test is 392.6 cm³.
#[test]
fn the_car_on_the_dynamometer_takes_the_fuel_that_is_known_of_it() {
    let Some(recording) = published("camry_dyno") else { return };
    assert_eq!(recording.runs.len(), 4);
    let cold = recording.run("61811011").unwrap().trace.slice(0.0, 505.0);
    let cubic_centimetres = cold.get("fuel_rate_kg_s").unwrap().iter().sum::<f64>() / 744.0 * 1e6;
    assert!((cubic_centimetres - 392.6).abs() < 2.0, "{cubic_centimetres}");
}
