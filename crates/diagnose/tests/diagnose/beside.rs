//! Causes beside others, at their size, and on runs that they were not fitted to.

use super::setting::{
    found, found_of_scenario, named, recorded, recorded_of_scenario, recording_of, scenario,
};
use headland_calibrate::statistics::Draws;
use headland_diagnose::{FindingKind, Options, Verdict};
use headland_trace::Trace;

/// A storm pushes with the square of its speed: in proportion to a breeze it would be told far too weak or too strong.
#[test]
fn a_storm_is_a_wind_of_its_own_size() {
    let found = found(&recorded(0.07, "wind(speed_m_s: 14.0, from_rad: 0.9)"), &Options::default()).unwrap();
    let findings = &found.diagnosis.findings;
    assert!(findings.len() == 1 && findings[0].id == "wind", "{}", found.diagnosis.answer);
    for (parameter, truth) in findings[0].parameters.iter().zip([14.0, 0.9]) {
        assert!(parameter.ci95[0] < truth && truth < parameter.ci95[1], "{parameter:?}");
    }
    let held = found.diagnosis.fit.held_out.as_ref().unwrap();
    assert!(held.rmse_after < 2.0 * held.noise, "{held:?}");
}

/// On a lane to the north-east and back neither the northern part of a wind is known nor the eastern one, and what blows along the
/// lane is: it was doubted, since each of the two may as well be none.
#[test]
fn a_wind_along_a_lane_is_certain_whatever_blows_across() {
    const SPEED_M_S: f64 = 5.0;
    let wind = format!("wind(speed_m_s: {SPEED_M_S:?}, from_rad: 0.8)");
    let aslant = |text: String| text.replace("\"0 deg\"", "\"45 deg\"").replace("\"180 deg\"", "\"225 deg\"");
    let registry = headland_stock::registry();
    let recording = recorded_of_scenario(&aslant(scenario(0.069, &wind, "")), &registry);
    let nominal = aslant(scenario(0.069, "", ""));
    let found = found_of_scenario(&nominal, &recording, &Options::default(), &registry).unwrap().diagnosis;
    assert_eq!(found.verdict, Verdict::MissingPhysics, "{}", found.answer);
    assert!(found.findings.len() == 1 && found.findings[0].id == "wind", "{}", found.answer);
    let [low, high] = found.findings[0].parameters[0].ci95;
    assert!(low > 0.7 * SPEED_M_S && low < SPEED_M_S && SPEED_M_S < high, "{low} to {high} m/s");
}

/// A wind that meets a lane from both ends, and a roof box: the drag of the box is made in the wind that was found, and without that wind
/// another area beside a law of speed would still blow as it did.
#[test]
fn a_wind_from_both_ends_is_no_law_of_speed_beside_more_drag() {
    let hidden = "wind(speed_m_s: 6.0, from_rad: 0.5), aerodynamic_drag(extra_area_m2: 6.0)";
    let said = found(&recorded(0.069, hidden), &Options::default()).unwrap().diagnosis;
    let wind = said.findings.iter().find(|one| one.id == "wind").unwrap_or_else(|| panic!("{}", said.answer));
    assert!(wind.indistinguishable_from.is_empty(), "{}", said.answer);
    assert!(said.findings.iter().any(|one| one.id == "aerodynamic_drag"), "{}", said.answer);
}

/// What blows across the lane shows by how it bends the drag alone, and no other cause patches what columns lack of that; nor
/// is the vehicle lighter than it is known to be, with which less would be left of any force.
#[test]
fn a_wind_across_leaves_the_mass_where_it_is() {
    let hidden = "wind(speed_m_s: 9.0, from_rad: 2.2), neutral_drag(force_n: 1500.0)";
    let found = found(&recorded(0.07, hidden), &Options::default()).unwrap();
    let findings = &found.diagnosis.findings;
    let ids: Vec<&str> = findings.iter().map(|finding| finding.id.as_str()).collect();
    assert!(ids.len() == 2 && ids.contains(&"wind"), "{}", found.diagnosis.answer);
    let drag = findings.iter().find(|one| one.id == "neutral_drag").unwrap();
    let [low, high] = drag.parameters[0].ci95;
    assert!(low < 1500.0 && 1500.0 < high && high - low < 600.0, "{:?}", drag.parameters);
    let wind = findings.iter().find(|one| one.id == "wind").unwrap();
    for (parameter, truth) in wind.parameters.iter().zip([9.0, 2.2]) {
        assert!(parameter.ci95[0] < truth && truth < parameter.ci95[1], "{parameter:?}");
    }
    let mass = found.diagnosis.calibrated.iter().find(|one| one.name == "mass_kg").unwrap();
    assert!(mass.ci95[0] < 13_000.0 && 13_000.0 < mass.ci95[1], "{mass:?}");
    // It is known to 65 kg.
    assert!(mass.ci95[1] - mass.ci95[0] <= 2.0 * 1.96 * 65.0 + 1e-6, "{mass:?}");
}

/// On slopes a vehicle accelerates otherwise than its force says, and what turns with the wheels resists just that.
#[test]
fn inertia_is_told_beside_slopes() {
    let slopes = "grade(positions_m: [0, 15, 30, 45, 60, 75, 90, 105, 120], \
                  grades: [0, 0.03, 0.045, 0.01, -0.03, -0.045, -0.02, 0.02, 0])";
    let hidden = format!("{slopes}, rotating_inertia(rotating_mass_kg: 1500)");
    let found = found(&recorded(0.069, &hidden), &Options::default()).unwrap();
    assert!(named(&found, "grade") && named(&found, "rotating_inertia"), "{}", found.diagnosis.answer);
}

/// What is carried resists as what turns with the wheels does, and weighs on slopes besides; slopes that were found beside the
/// one are too steep for the other.
#[test]
fn mass_is_told_beside_slopes() {
    let slopes = "grade(positions_m: [0, 15, 30, 45, 60, 75, 90, 105, 120], \
                  grades: [0, 0.03, 0.045, 0.01, -0.03, -0.045, -0.02, 0.02, 0])";
    let hidden = format!("{slopes}, mass(extra_mass_kg: 1500)");
    let found = found(&recorded(0.069, &hidden), &Options::default()).unwrap();
    assert!(named(&found, "grade") && named(&found, "mass"), "{}", found.diagnosis.answer);
}

/// A drag in the runs that are fitted, and none in the one that is held out.
#[test]
fn a_cause_that_makes_an_unseen_run_worse_is_not_claimed() {
    let (with, without) = (recorded(0.069, "brake_drag(force_n: 2500.0)"), recorded(0.069, ""));
    let mut recording = with;
    let places = recording.runs.iter_mut().zip(&without.runs).filter(|(run, _)| run.held_out);
    for (run, other) in places {
        run.trace = other.trace.clone();
    }
    let found = found(&recording, &Options::default()).unwrap().diagnosis;
    assert!(found.verdict == Verdict::CannotTell && found.findings.is_empty(), "{}", found.answer);
    assert!(found.answer.contains("do not have in common"), "{}", found.answer);
    assert!(!found.unproven.is_empty());
}

/// Each run is pulled back for a while of its own, by less than a fiftieth of its weight: what lies between two edges is told
/// by how quiet the rest is.
#[test]
fn pulls_too_weak_to_stand_out_by_themselves_are_told_by_their_edges() {
    let of_run = |run: usize| {
        let from_s = 4.0 + 2.5 * run as f64;
        let force_n = 1300.0 + 150.0 * run as f64;
        let to_s = from_s + 6.0;
        let pull = format!("drawbar_load(force_n: {force_n:?}, from_s: {from_s:?}, to_s: {to_s:?})");
        (recorded(0.069, &pull), force_n, (from_s, to_s))
    };
    let all: Vec<_> = (0..5).map(of_run).collect();
    let mut recording = recorded(0.069, "");
    for (place, (own, ..)) in all.iter().enumerate() {
        recording.runs[place].trace = own.runs[place].trace.clone();
    }
    let found = found(&recording, &Options::default()).unwrap();
    assert!(named(&found, "drawbar_load"), "{}", found.diagnosis.answer);
    let pull = found.diagnosis.findings.iter().find(|one| one.id == "drawbar_load").unwrap();
    for (run, (_, _, (from_s, to_s))) in all.iter().enumerate() {
        let id = format!("r{run}");
        let own: Vec<_> = pull.stretches.iter().filter(|place| place.run == id).collect();
        assert!(own.len() == 1, "{id}: {own:?}");
        assert!((own[0].from_s - from_s).abs() < 0.6 && (own[0].to_s - to_s).abs() < 0.6, "{id}: {own:?}");
    }
}

/// Two lanes, soft in places and dry throughout: a scenario that is right about the dry one foresees it by itself, and better
/// than a map that others taught; without the map they teach that the dry one is soft.
#[test]
fn a_map_is_claimed_though_the_lane_that_is_held_out_has_nothing_on_it() {
    const LEVEL: f64 = 0.069;
    let patches = "soft_ground(positions_m: [20.0, 35.0, 52.0, 65.0], \
                   coefficients: [0.02, 0.0, 0.02])";
    let (mut recording, dry) = (recorded(LEVEL, patches), recorded(LEVEL, ""));
    for place in [3, 4] {
        recording.runs[place].trace = dry.runs[place].trace.clone();
        recording.runs[place].path = Some("other lane".to_owned());
    }
    let found = found(&recording, &Options::default()).unwrap();
    assert!(named(&found, "soft_ground"), "{}", found.diagnosis.answer);
}

/// Two runs teach each other what they share of a lane: where only one of them was, the other says nothing of it, and that is
/// nothing against slopes.
#[test]
fn slopes_are_claimed_though_each_run_saw_only_a_part_of_the_lane() {
    const BOTH_M: std::ops::Range<f64> = 55.0..75.0;
    let hidden = "grade(positions_m: [0.0, 12.0, 26.0, 40.0, 52.0, 66.0, 80.0, 94.0, 108.0, 122.0], \
                  grades: [0.0, 0.02, -0.015, 0.02, -0.02, 0.015, -0.01, 0.015, -0.02, 0.01])";
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.004 * draws.normal(),
        "motor_torque_n_m" => value + 0.5 * draws.normal(),
        "battery_voltage_v" | "battery_current_a" => value + 0.2 * draws.normal(),
        _ => value,
    };
    let channels = [
        "speed_m_s",
        "position_m",
        "heading_rad",
        "motor_torque_n_m",
        "battery_voltage_v",
        "battery_current_a",
    ];
    let mut recording = recording_of((0.069, hidden), &headland_stock::registry(), &channels, (11, &noisy));
    recording.runs.drain(2..4);
    for (run, wanted) in [(0, f64::NEG_INFINITY..BOTH_M.end), (1, BOTH_M.start..f64::INFINITY)] {
        let trace = recording.runs[run].trace.clone();
        let place = |at_m: f64| trace.get("position_m").unwrap().partition_point(|position| *position < at_m);
        let samples = place(wanted.start)..place(wanted.end);
        let mut part = Trace::new(trace.time_s()[samples.clone()].to_vec()).unwrap();
        for channel in trace.channels() {
            part.push(channel.name.clone(), channel.values[samples.clone()].to_vec(), channel.origin)
                .unwrap();
        }
        recording.runs[run].trace = part;
    }
    let found = found(&recording, &Options::default()).unwrap();
    assert!(named(&found, "grade"), "{}", found.diagnosis.answer);
    let fit = found.diagnosis.fit.held_out.unwrap();
    assert!(fit.rmse_after < 0.4 * fit.rmse_before, "{}", found.diagnosis.answer);
}

/// A road that rises and falls as waves do: a map holds the wave as well as everything else that the road does.
#[test]
fn a_wavy_road_is_told_as_slopes_and_not_as_a_formula_beside_them() {
    let height = |x: f64| 0.02 * (x / 4.5).sin() + 0.006 * (x / 2.3 + 1.0).sin() * (1.0 + x / 60.0);
    let (positions, grades): (Vec<f64>, Vec<f64>) =
        (0..=130).map(|metre| (f64::from(metre), height(f64::from(metre)))).unzip();
    let hidden = format!("grade(positions_m: {positions:?}, grades: {grades:?})");
    let found = found(&recorded(0.069, &hidden), &Options::default()).unwrap();
    assert!(named(&found, "grade"), "{}", found.diagnosis.answer);
    let formula = found.diagnosis.findings.iter().any(|finding| finding.id == "unlisted");
    assert!(!formula, "{}", found.diagnosis.answer);
}

/// A force that goes in waves along the lane, which lie elsewhere in every run: nothing that runs share, and no clock that is
/// wrong by hundredths.
#[test]
fn a_fault_of_a_sensor_that_makes_an_unseen_run_worse_is_not_claimed() {
    let of_run = |run: usize| {
        let wave = format!(
            "expression(resistance: \"a_n * sin(x / l_m + phase_rad)\", \
             constants: {{\"a_n\": 1500.0, \"l_m\": 2.1, \"phase_rad\": {:.1}}})",
            1.9 * run as f64
        );
        recorded(0.069, &wave).runs[run].clone()
    };
    let mut recording = recorded(0.069, "");
    recording.runs = [0, 1, 4].map(of_run).into();
    let found = found(&recording, &Options::default()).unwrap().diagnosis;
    let fault = found.findings.iter().any(|finding| finding.kind == FindingKind::Artefact);
    assert!(!fault, "{}", found.answer);
}
