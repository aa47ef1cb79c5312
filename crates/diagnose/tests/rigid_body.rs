//! Recordings of a rigid body, given to a diagnosis that knows one dimension: it names what one dimension lacks.

use headland_calibrate::statistics::Draws;
use headland_diagnose::{Diagnosed, Options, Silent, diagnose};
use headland_recording::{RecordedRun, Recording};
use headland_scenario::{Fidelity, Scenario};
use headland_trace::{Origin, Trace};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// What is logged, and the noise of its sensor: of speeds as receivers and wheel sensors have it, of force and attitude as load
/// cells and inertial units.
type Channels = &'static [(&'static str, f64)];

const TURNING: Channels = &[
    ("speed_m_s", 0.02),
    ("curvature_per_m", 0.0),
    ("position_m", 0.0),
    ("heading_rad", 0.0),
    ("coasting", 0.0),
];
const COASTING: Channels = &[
    ("speed_m_s", 0.02),
    ("position_m", 0.0),
    ("coasting", 0.0),
    ("grade", 0.0),
    ("roll_rad", 0.002),
    ("vertical_acceleration_m_s2", 0.05),
];
const PULLING: Channels = &[
    ("speed_m_s", 0.02),
    ("wheel_speed_m_s", 0.01),
    ("position_m", 0.0),
    ("tractive_force_n", 100.0),
    ("drawbar_force_n", 0.0),
    ("grade", 0.0),
    ("roll_rad", 0.002),
    ("vertical_acceleration_m_s2", 0.05),
];
/// A recording ends before the vehicle rocks to its rest [m/s].
const SLOWEST_M_S: f64 = 0.3;

fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios")
}

/// Slope that the centre of gravity goes by over a metre, as a receiver of satellites has it.
fn grade(position_m: &[f64], height_m: &[f64]) -> Vec<f64> {
    let height = |at_m: f64| {
        let after = position_m.partition_point(|position| *position < at_m).clamp(1, position_m.len() - 1);
        let (from_m, to_m) = (position_m[after - 1], position_m[after]);
        let share = if to_m > from_m { ((at_m - from_m) / (to_m - from_m)).clamp(0.0, 1.0) } else { 0.0 };
        height_m[after - 1] + share * (height_m[after] - height_m[after - 1])
    };
    let ends = (position_m[0], position_m[position_m.len() - 1]);
    let at = |position: &f64| {
        let (back_m, ahead_m) = ((position - 0.5).max(ends.0), (position + 0.5).min(ends.1));
        let sine = (height(ahead_m) - height(back_m)) / (ahead_m - back_m).max(0.1);
        sine / (1.0 - sine * sine).sqrt()
    };
    position_m.iter().map(at).collect()
}

/// What a logger would have of a run of the rigid body.
fn logged(trace: &Trace, number: u64, channels: Channels) -> Trace {
    let get = |name: &str| trace.get(name).unwrap_or_else(|| panic!("{name}"));
    let speed = get("speed_m_s");
    let rows = speed.iter().take_while(|speed| **speed > SLOWEST_M_S).count();
    let mut draws = Draws::new(5, number);
    let mut log = Trace::new(trace.time_s()[..rows].to_vec()).unwrap();
    for (name, noise) in channels {
        let exact = match *name {
            "curvature_per_m" => {
                get("yaw_rate_rad_s").iter().zip(speed).map(|(yaw, speed)| yaw / speed).collect()
            }
            "grade" => grade(get("position_m"), get("height_m")),
            name => get(name).to_vec(),
        };
        let noisy = exact[..rows].iter().map(|value| value + noise * draws.normal()).collect();
        log.push(*name, noisy, Origin::Measured).unwrap();
    }
    log
}

/// Drives runs of a scenario as a rigid body, the last of them to be held out.
fn recorded(scenario: &Scenario, runs: &[&str], channels: Channels) -> Recording {
    let registry = headland_stock::registry();
    assert!(matches!(scenario.fidelity, Fidelity::RigidBody { .. }));
    let recorded = runs.iter().enumerate().map(|(number, id)| {
        let spec = scenario.runs.iter().find(|spec| spec.id == *id).unwrap();
        let own = scenario.run(spec, &registry).unwrap();
        let outcome =
            own.fidelity.simulate(&own.model(&registry).unwrap(), own.cycle.as_ref().unwrap()).unwrap();
        RecordedRun {
            id: (*id).to_owned(),
            trace: logged(&outcome.trace, number as u64, channels),
            path: None,
            reversed: false,
            held_out: number + 1 == runs.len(),
            known: Vec::new(),
            sensors: Vec::new(),
        }
    });
    Recording {
        about: "runs of the rigid body".to_owned(),
        path: PathBuf::from("recording.ron"),
        runs: recorded.collect(),
        known: Vec::new(),
        notices: Vec::new(),
    }
}

fn diagnosed(nominal: &Scenario, recording: &Recording) -> Diagnosed {
    diagnose(nominal, recording, &headland_stock::registry(), &Options::default(), &Silent).unwrap()
}

/// Runs of `scenarios/coast_down_turns.ron`, diagnosed with the same scenario.
fn turns(runs: &[&str]) -> Diagnosed {
    turns_with(runs, TURNING)
}

fn turns_with(runs: &[&str], channels: Channels) -> Diagnosed {
    let path = scenarios().join("coast_down_turns.ron");
    let scenario = Scenario::read(&path, &headland_stock::registry()).unwrap();
    diagnosed(&scenario, &recorded(&scenario, runs, channels))
}

/// A scenario of this ground, begin and cycle; `more` are runs or what is free.
fn scenario(ground: &str, begin: &str, more: &str) -> Scenario {
    let text = format!(
        "(about: \"it\", vehicle: include(\"vehicles/xerion_3800_body.ron\"), ground: ({ground}), air: (density_kg_m3: 1.2), \
         {begin}, {more}, simulation: (fidelity: RigidBody(record_s: \"50 ms\"), step_s: \"2 ms\"))"
    );
    Scenario::of_text("it.ron", &text, &scenarios(), &headland_stock::registry())
        .unwrap_or_else(|error| panic!("{}", error.told()))
}

/// Pulls on the level, uphill, and along slopes to both sides, diagnosed without a word of slopes or pulls but the logs'.
fn pulls(runs: &[&str]) -> Diagnosed {
    const GROUND: &str =
        "terrain: Flat, soil: Brixius(cone_index_pa: \"1400 kPa\", construction: Radial, pass_factor: 1.5)";
    const BEGIN: &str = "start: (position_m: 0, speed_m_s: 1.5), \
        cycle: [Drive(speed_m_s: 2, acceleration_m_s2: 0.2, until: Elapsed(for_s: 16))]";
    let run = |id: &str, terrain: &str, pull_n: f64| {
        format!(
            "(id: \"{id}\", with: {{\"ground.terrain\": {terrain}, \"tasks.pull.force_n\": {pull_n:?}}}), "
        )
    };
    let aslant = |grade: f64, uphill_deg: f64| {
        format!(
            "AbLines(heading_rad: 0, length_m: 90, spacing_m: 14, lanes: 1, side: Right, turn_radius_m: 7, \
             turn_ramp_m: 6, grade: {grade:?}, uphill_rad: \"{uphill_deg} deg\")"
        )
    };
    let all = [
        run("level-1", "Flat", 6e3),
        run("level-2", "Flat", 26e3),
        run("level-3", "Flat", 15e3),
        run("climb-1", "ConstantGrade(grade: 0.08)", 8e3),
        run("climb-2", "ConstantGrade(grade: 0.05)", 22e3),
        run("right-1", &aslant(0.16, 270.0), 12e3),
        run("left-1", &aslant(0.22, 90.0), 24e3),
        run("left-2", &aslant(0.19, 90.0), 5e3),
    ]
    .concat();
    let driven = scenario(GROUND, BEGIN, &format!("tasks: {{\"pull\": Drawbar(force_n: 0)}}, runs: [{all}]"));
    diagnosed(&scenario(GROUND, BEGIN, "replay: (drive: Force)"), &recorded(&driven, runs, PULLING))
}

/// A road of random height: as many waves as there are to each octave of length from half a metre to 16 m, each as high as a
/// spectral density of ISO 8608 that falls with the square of the wave number has it; `density_m3` is that of 0.1 waves a metre.
fn road(density_m3: f64, seed: u64) -> String {
    const OCTAVES: u32 = 5;
    const EACH: u32 = 12;
    let mut draws = Draws::new(seed, 1);
    let waves: Vec<(f64, f64, f64)> = (0..OCTAVES * EACH)
        .map(|wave| {
            let per_m = 0.0625 * 2f64.powf(f64::from(wave) / f64::from(EACH));
            let band_per_m = per_m * std::f64::consts::LN_2 / f64::from(EACH);
            let height_m = (2.0 * density_m3 * (0.1 / per_m).powi(2) * band_per_m).sqrt();
            (per_m, height_m, std::f64::consts::TAU * draws.uniform())
        })
        .collect();
    let mut text = String::from("Profile(heading_rad: 0, points: [");
    for step in -50..400 {
        let at_m = 0.2 * f64::from(step);
        let wave = |(per_m, height_m, phase): &(f64, f64, f64)| {
            height_m * (std::f64::consts::TAU * per_m * at_m + phase).sin()
        };
        let height_m: f64 = waves.iter().map(wave).sum();
        write!(text, "(position_m: {at_m:?}, elevation_m: {height_m:?}), ").unwrap();
    }
    text + "])"
}

/// Coast-downs over a rough road and over a smooth one of the same soil, diagnosed with level ground and the slopes of the log.
fn coast_downs(runs: &[&str]) -> Diagnosed {
    /// Between the classes D and E: a field.
    const DENSITY_M3: f64 = 2048e-6;
    const GROUND: &str = "terrain: Flat, soil: Constant(coefficient: 0.05)";
    const BEGIN: &str = "start: (position_m: 0, speed_m_s: 6), cycle: [Coast(until: Stopped)]";
    let road = road(DENSITY_M3, 7);
    let run = |(id, speed_m_s): (&str, f64)| {
        let terrain = if id.starts_with("rough") { &road } else { "Flat" };
        format!(
            "(id: \"{id}\", with: {{\"ground.terrain\": {terrain}, \"start.speed_m_s\": {speed_m_s:?}}}), "
        )
    };
    let all = [
        ("rough-1", 7.0),
        ("rough-2", 6.0),
        ("rough-3", 5.0),
        ("rough-4", 6.5),
        ("rough-5", 5.5),
        ("smooth-1", 7.0),
        ("smooth-2", 5.0),
        ("smooth-3", 6.0),
        ("smooth-4", 5.5),
    ]
    .map(run)
    .concat();
    let driven = scenario(GROUND, BEGIN, &format!("runs: [{all}]"));
    let nominal = scenario(
        GROUND,
        BEGIN,
        "free: [(name: \"ground.soil.coefficient\", sd: 0.005, bounds: (0.01, 0.2))], replay: (drive: Coast)",
    );
    diagnosed(&nominal, &recorded(&driven, runs, COASTING))
}

/// Value of a parameter of a finding, and its interval.
fn parameter(found: &Diagnosed, id: &str, name: &str) -> (f64, [f64; 2]) {
    let said = &found.diagnosis;
    let finding = said.findings.iter().find(|finding| finding.id == id);
    let finding = finding.unwrap_or_else(|| panic!("no {id}: {}", said.answer));
    let parameter = finding.parameters.iter().find(|parameter| parameter.name == name);
    let parameter = parameter.unwrap_or_else(|| panic!("no {name}: {}", said.answer));
    (parameter.value, parameter.ci95)
}

fn names_none_of(found: &Diagnosed, ids: &[&str]) {
    let said = &found.diagnosis;
    assert!(said.findings.iter().all(|finding| !ids.contains(&finding.id.as_str())), "{}", said.answer);
}

/// The vehicle's tyres hold 6 per rad of the 127.7 kN that it weighs, 766 kN/rad, about no slip; in the fastest turns they
/// come near to what friction holds, and are softer.
#[test]
fn turns_of_a_rigid_body_are_the_drag_of_its_tyres_in_curves() {
    let found = turns(&["right-1", "right-3", "left-1", "left-2", "straight-1", "right-2"]);
    let (stiffness, _) = parameter(&found, "cornering_drag", "cornering_stiffness_n_per_rad");
    let said = &found.diagnosis;
    assert!((0.7 * 766e3..766e3).contains(&stiffness), "{stiffness}: {}", said.answer);
    let held_out = said.fit.held_out.as_ref().unwrap();
    assert!(held_out.rmse_after < 0.75 * held_out.rmse_before, "{}", said.answer);
}

/// What is driven straight on has no such drag: nothing is made of the turns that are not there.
#[test]
fn straight_coast_downs_of_a_rigid_body_show_no_drag_in_curves() {
    names_none_of(&turns(&["straight-1", "straight-2"]), &["cornering_drag"]);
}

/// A chassis leans in its turns by what turns it, which a side slope would explain as well with tyres too soft to be any.
#[test]
fn turns_of_a_vehicle_whose_lean_is_logged_are_no_side_slope() {
    const LEANING: Channels = &[
        ("speed_m_s", 0.02),
        ("curvature_per_m", 0.0),
        ("position_m", 0.0),
        ("heading_rad", 0.0),
        ("coasting", 0.0),
        ("roll_rad", 0.002),
        ("vertical_acceleration_m_s2", 0.05),
    ];
    let runs = ["right-1", "right-3", "left-1", "left-2", "straight-1", "right-2"];
    let found = turns_with(&runs, LEANING);
    parameter(&found, "cornering_drag", "cornering_stiffness_n_per_rad");
    names_none_of(&found, &["side_slope", "roughness"]);
}

/// The tyres have 766 kN/rad. A chassis that leans a twentieth further than its ground shows a tenth more, and ground that carries
/// less of the weight as much again.
#[test]
fn side_slopes_of_a_rigid_body_are_named_as_they_are() {
    let found = pulls(&["level-1", "level-2", "climb-1", "right-1", "left-1", "left-2"]);
    let (stiffness, _) = parameter(&found, "side_slope", "cornering_stiffness_n_per_rad");
    assert!((766e3..1.25 * 766e3).contains(&stiffness), "{stiffness}: {}", found.diagnosis.answer);
    names_none_of(&found, &["rolling_resistance", "roughness", "drawbar_load", "mass"]);
}

#[test]
fn pulls_and_climbs_of_a_rigid_body_show_no_side_slope_and_no_roughness() {
    let found = pulls(&["level-1", "level-2", "climb-1", "level-3", "climb-2"]);
    names_none_of(&found, &["side_slope", "roughness"]);
}

/// The tyres' own damping over stiffness is 9 ms. The vehicle pitches as well, which its vertical acceleration does not tell:
/// what the rigid body loses in its tyres on such roads is that of 12 to 23 ms.
#[test]
fn rough_ground_under_a_rigid_body_is_named_by_what_shakes_it() {
    let found = coast_downs(&["rough-1", "rough-2", "rough-3", "rough-4", "smooth-1", "smooth-2", "rough-5"]);
    let (time_constant_s, [low_s, high_s]) = parameter(&found, "roughness", "time_constant_s");
    let said = &found.diagnosis;
    assert!(low_s < 0.023 && high_s > 0.012, "{time_constant_s}: {}", said.answer);
    let held_out = said.fit.held_out.as_ref().unwrap();
    assert!(held_out.rmse_after < 0.75 * held_out.rmse_before, "{}", said.answer);
    names_none_of(&found, &["side_slope"]);
}

#[test]
fn smooth_ground_under_a_rigid_body_shows_no_roughness_and_no_side_slope() {
    names_none_of(
        &coast_downs(&["smooth-1", "smooth-2", "smooth-3", "smooth-4"]),
        &["roughness", "side_slope"],
    );
}
