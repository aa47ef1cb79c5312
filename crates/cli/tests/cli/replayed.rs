//! What a replay is told by a recording, against motions that are known in closed form.

use super::help::Place;

/// A cart without air drag.
fn scenario(place: &Place, effects: &str) {
    let text = super::help::SCENARIO.replacen("drag_area_m2: 2.0", "drag_area_m2: 0.0", 1).replacen(
        "    free:",
        &format!("    effects: [{effects}],\n    free:"),
        1,
    );
    place.write("scenario.ron", &text);
}

/// Rows of 0.1 s for so long.
fn log(head: &str, long_s: u32, row: impl Fn(f64) -> Vec<f64>) -> String {
    let line = |at: u32| {
        let time_s = 0.1 * f64::from(at);
        let cells = std::iter::once(time_s).chain(row(time_s)).map(|cell| format!("{cell:.6}"));
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    head.to_owned() + "\n" + &(0..=10 * long_s).map(line).collect::<String>()
}

/// Root mean square of the error of speed [m/s], and what was told beside it.
fn compared(place: &Place) -> (f64, String) {
    let output = place.compare();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told = String::from_utf8(output.stdout).unwrap();
    let document = place.json("out/comparison.json");
    (document["channels"][0]["rmse"].as_f64().unwrap(), told)
}

/// 1000 kg that roll at 10 m/s, driven by just their resistance of 196 N, are braked by 2 m/s² for 3 s and roll on.
#[test]
fn a_braked_stretch_is_followed_and_the_model_goes_on_from_there() {
    let place = Place::new();
    scenario(&place, "");
    place.write("recording.ron", r#"(about: "braked", runs: [(id: "r1", file: "r1.csv")])"#);
    let speed = |time_s: f64| 10.0 - 2.0 * (time_s - 10.0).clamp(0.0, 3.0);
    let braked = |time_s: f64| f64::from((10.0..13.0).contains(&time_s));
    let resistance_n = 0.02 * 1000.0 * 9.806_65;
    place.write(
        "r1.csv",
        &log("time_s,speed_m_s,tractive_force_n,brake", 30, |time_s| {
            vec![speed(time_s), resistance_n, braked(time_s)]
        }),
    );
    let (error_m_s, told) = compared(&place);
    // The fit of the recorded speed rounds the ends of the stretch off.
    assert!(error_m_s < 0.1, "{error_m_s}: {told}");
    assert!(told.contains("30 of 301 samples") && told.contains("brakes"), "{told}");
    // Nobody who does not tell it of brakes is followed.
    let text = std::fs::read_to_string(place.path("scenario.ron")).unwrap();
    let end = text.trim_end().strip_suffix(')').unwrap();
    place.write("scenario.ron", &format!("{end}    replay: (inputs: []),\n)"));
    assert!(compared(&place).0 > 2.0);
}

/// Two coast-downs of one lane: v̇ = −c g, c of the second pass less by c₁ (1 − q).
#[test]
fn passes_of_one_path_are_counted() {
    let place = Place::new();
    scenario(&place, "multipass(coefficient: 0.01, factor: 0.5)");
    let runs = r#"(
    about: "two passes",
    runs: [(id: "r1", file: "r1.csv", path: "lane"), (id: "r2", file: "r2.csv", path: "lane"), (id: "r3", file: "r1.csv", path: "fresh")],
)"#;
    place.write("recording.ron", runs);
    for (name, coefficient) in [("r1.csv", 0.02), ("r2.csv", 0.015)] {
        let speed = |time_s: f64| 10.0 - coefficient * 9.806_65 * time_s;
        place.write(name, &log("time_s,speed_m_s,coasting", 20, |time_s| vec![speed(time_s), 1.0]));
    }
    let (error_m_s, told) = compared(&place);
    assert!(error_m_s < 1e-3, "{error_m_s}: {told}");
}

/// A cart of a tonne that is pulled by what it resists with another tonne on it, ten rows a second, of which some say the load.
fn weighed(place: &Place, says: impl Fn(u32) -> bool) {
    place.write("recording.ron", r#"(about: "a load", runs: [(id: "r1", file: "r1.csv")])"#);
    let row = |row: u32| {
        let payload = if says(row) { "1000" } else { "" };
        format!("{:.1},10,{:.3},{payload}\n", 0.1 * f64::from(row), 0.02 * 2000.0 * 9.806_65)
    };
    let rows: String = (0..=200).map(row).collect();
    place.write("r1.csv", &format!("time_s,speed_m_s,tractive_force_n,payload_kg\n{rows}"));
}

/// A tonne on a cart of a tonne, weighed once a second in a log of ten rows a second: it rolls on where both are pulled by
/// what they resist.
#[test]
fn what_is_logged_less_often_is_told_to_the_model_too() {
    let place = Place::new();
    scenario(&place, "");
    weighed(&place, |row| row.is_multiple_of(10));
    let (error_m_s, told) = compared(&place);
    assert!(told.contains("`payload_kg` has a new value in one row of 10"), "{told}");
    // Without it, the cart alone would be pulled by 196 N too many: 4 m/s in 20 s.
    assert!(error_m_s < 1e-3, "{error_m_s}: {told}");
}

/// The same log with a gap of ten seconds, which no line bridges: it is left out, and no brakes are blamed.
#[test]
fn a_gap_in_what_drives_the_model_is_left_out_by_its_own_name() {
    let place = Place::new();
    scenario(&place, "");
    weighed(&place, |row| !(50..150).contains(&row));
    let (_, told) = compared(&place);
    assert!(told.contains("100 of 201 samples") && told.contains("longer than can be bridged"), "{told}");
    assert!(!told.contains("least_acceleration_m_s2"), "{told}");
}

/// A cart that is pulled over waves of 40 m at walking speed by a force that is 30 N more than it takes: soon the model meets them
/// early, unless it begins anew from time to time.
#[test]
fn a_model_that_meets_slopes_early_says_so() {
    let place = Place::new();
    scenario(&place, "");
    let waves =
        |at: i32| (0.02 * 20.0 / std::f64::consts::PI) * (f64::from(at) * std::f64::consts::PI / 20.0).sin();
    let point = |at: i32| format!("(position_m: {at}.0, elevation_m: {:.6}), ", waves(at));
    let points = (-10..130).map(point).collect::<Vec<_>>().concat();
    let text = std::fs::read_to_string(place.path("scenario.ron")).unwrap();
    let hilly =
        text.replacen("terrain: Flat", &format!("terrain: Profile(heading_rad: 0, points: [{points}])"), 1);
    assert_ne!(text, hilly, "the terrain of the tests' scenario");
    place.write("scenario.ron", &hilly);
    place.write("recording.ron", r#"(about: "waves", runs: [(id: "r1", file: "r1.csv")])"#);
    let pulled_n = |at_m: f64| {
        let grade = 0.02 * (at_m * std::f64::consts::PI / 20.0).cos();
        1000.0 * 9.806_65 * (0.02 + grade) / grade.hypot(1.0) + 30.0
    };
    place.write(
        "r1.csv",
        &log("time_s,speed_m_s,position_m,tractive_force_n", 50, |time_s| {
            vec![2.0, 2.0 * time_s, pulled_n(2.0 * time_s)]
        }),
    );
    let (error_m_s, told) = compared(&place);
    assert!(error_m_s > 0.3 && told.contains("the next one early: in r1"), "{error_m_s}: {told}");
    place.write("scenario.ron", &hilly.replacen("    free:", "    replay: (window_s: 10),\n    free:", 1));
    let (error_m_s, told) = compared(&place);
    assert!(error_m_s < 0.3 && !told.contains("early"), "{error_m_s}: {told}");
}

/// A scenario that says no heading knows how far a run came, and not where: 200 m due north of a place of its own.
#[test]
fn where_a_run_was_is_not_held_against_a_straight_path() {
    let place = Place::new();
    scenario(&place, "");
    place.write("recording.ron", r#"(about: "north", runs: [(id: "r1", file: "r1.csv")])"#);
    let head = "time_s,position_m,speed_m_s,tractive_force_n,east_m,north_m";
    let log = log(head, 20, |time_s| {
        vec![10.0 * time_s, 10.0, 0.02 * 1000.0 * 9.806_65, 500.0, 700.0 + 10.0 * time_s]
    });
    place.write("r1.csv", &log);
    compared(&place);
    let document = place.json("out/comparison.json");
    let judged: Vec<&str> =
        document["channels"].as_array().unwrap().iter().filter_map(|one| one["channel"].as_str()).collect();
    assert!(judged.contains(&"position_m") && !judged.contains(&"east_m"), "{judged:?}");
}

/// A turn of 0.2 rad/s at 10 m/s: a side force of 2000 N drags by 2000²/100 000 = 40 N.
#[test]
fn curvature_is_made_of_the_rate_of_turn() {
    let place = Place::new();
    scenario(&place, "cornering_drag(cornering_stiffness_n_per_rad: 1e5)");
    place.write("recording.ron", r#"(about: "a turn", runs: [(id: "r1", file: "r1.csv")])"#);
    let turns = |time_s: f64| (10.0..30.0).contains(&time_s);
    let force_n = |time_s: f64| 0.02 * 1000.0 * 9.806_65 + if turns(time_s) { 40.0 } else { 0.0 };
    let log = log("time_s,speed_m_s,tractive_force_n,yaw_rate_rad_s", 40, |time_s| {
        vec![10.0, force_n(time_s), if turns(time_s) { 0.2 } else { 0.0 }]
    });
    place.write("r1.csv", &log);
    let (error_m_s, told) = compared(&place);
    assert!(told.contains("it is made of `yaw_rate_rad_s`"), "{told}");
    // Without it 40 N would speed 1000 kg up by 0.8 m/s in 20 s.
    assert!(error_m_s < 0.03, "{error_m_s}: {told}");
}

/// A lane of 300 m due north whose second half climbs by 2 %: the second run begins there, as its latitude says.
#[test]
fn runs_of_one_path_lie_where_they_were() {
    /// Of a radius of 6 371 km [m].
    const OF_A_DEGREE_M: f64 = 111_194.93;
    let place = Place::new();
    scenario(&place, "grade(positions_m: [0.0, 149.9, 150.1, 300.0], grades: [0.0, 0.0, 0.02, 0.02])");
    let runs = r#"(
    about: "a lane",
    runs: [(id: "r1", file: "r1.csv", path: "lane"), (id: "r2", file: "r2.csv", path: "lane")],
)"#;
    place.write("recording.ron", runs);
    for (name, from_m, long_s) in [("r1.csv", 0.0, 30), ("r2.csv", 150.0, 15)] {
        let head = "time_s,speed_m_s,tractive_force_n,latitude_deg,longitude_deg";
        let log = log(head, long_s, |time_s| {
            let at_m = from_m + 10.0 * time_s;
            let climb_n = if at_m > 150.0 { 0.02 * 1000.0 * 9.806_65 } else { 0.0 };
            vec![10.0, 0.02 * 1000.0 * 9.806_65 + climb_n, at_m / OF_A_DEGREE_M, 11.0]
        });
        place.write(name, &log);
    }
    let (error_m_s, told) = compared(&place);
    assert!(told.contains("In r1, r2 the distance along the path is made of where they were"), "{told}");
    // Laid from its begin, the second would be 0.2 m/s² too fast.
    assert!(error_m_s < 0.2, "{error_m_s}: {told}");
}

/// All that is told without being asked, and the speed of the engine beside it.
#[test]
fn all_inputs_and_one_more_are_asked_for() {
    let place = Place::new();
    let text = super::help::SCENARIO.trim_end().strip_suffix(')').unwrap().to_owned();
    place.write("scenario.ron", &format!("{text}    replay: (inputs: [All, Grade]),\n)"));
    let (_, told) = compared(&place);
    assert!(told.contains("driven   coasting"), "{told}");
    place.write("scenario.ron", &format!("{text}    replay: (inputs: [All, EngineSpeed]),\n)"));
    let told = super::help::refused(
        2,
        &["compare", &place.path("scenario.ron"), "--recording", &place.path("recording.ron")],
    );
    assert!(told.contains("engine_speed_rad_s"), "{told}");
}
