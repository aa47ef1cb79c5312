//! A proposed run, when it is driven, tells what it was said to tell; one that was said to tell nothing does not.
//!
//! The recordings come from the simulator, with noise of the speed sensor added. Each case cannot be told at first.

#![allow(clippy::result_large_err, reason = "a test fails once")]

use headland_calibrate::statistics::Draws;
use headland_diagnose::{Diagnosed, Experiment, Options, Silent, Verdict, diagnose};
use headland_recording::{Known, RecordedRun, Recording};
use headland_scenario::Scenario;
use headland_sim::simulate;
use headland_trace::{Origin, Trace};
use std::path::{Path, PathBuf};

/// One run: what is driven, with what at work.
#[derive(Clone)]
struct Run {
    cycle: String,
    effects: String,
    heading_deg: f64,
    mass_kg: f64,
    reversed: bool,
    /// How well the ground is known.
    coefficient_sd: f64,
    /// Speed at the begin.
    start_m_s: f64,
}

const MASS_KG: f64 = 13_000.0;
const DRIVEN: &str = "Reach(speed_m_s: 8, acceleration_m_s2: 0.6), Hold(for_s: 6), \
                      Reach(speed_m_s: 3, acceleration_m_s2: 0.4), Hold(for_s: 4), Coast(until: SpeedBelow(speed_m_s: 0.5))";

impl Run {
    fn of(effects: &str) -> Self {
        Self {
            cycle: DRIVEN.to_owned(),
            effects: effects.to_owned(),
            heading_deg: 0.0,
            mass_kg: MASS_KG,
            reversed: false,
            coefficient_sd: 0.003,
            start_m_s: 0.0,
        }
    }
}

fn text(run: &Run) -> String {
    let Run { cycle, effects, heading_deg, mass_kg, coefficient_sd, start_m_s, .. } = run;
    format!(
        r#"(
    about: "a tractor",
    vehicle: (
        mass_kg: {mass_kg:?}, rotating_mass_kg: 800, drag_area_m2: 6.0,
        driveline: ElectricSingleSpeed(
            open_circuit_voltage_v: 600, resistance_ohm: 0.05, capacity_a_h: 200, initial_state_of_charge: 0.8,
            max_torque_n_m: 3000, max_regeneration_torque_n_m: 3000, max_power_w: 300000, gear_ratio: 20,
            wheel_radius_m: 0.9, drive_efficiency: 0.9, standby_power_w: 500, rotating_mass_kg: 0,
        ),
    ),
    ground: (
        terrain: Flat(heading_rad: "{heading_deg} deg"),
        soil: LinearSpeedLaw(coefficient: 0.06, speed_scale_m_s: "100 km/h"),
    ),
    air: (density_kg_m3: 1.2),
    start: (position_m: 0, speed_m_s: {start_m_s:?}),
    cycle: [{cycle}],
    effects: [{effects}],
    free: [
        (name: "ground.soil.coefficient", sd: {coefficient_sd:?}, bounds: (0.01, 0.3)),
        (name: "vehicle.mass_kg", sd: 65, bounds: (10000, 16000)),
    ],
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#
    )
}

fn recording(runs: &[Run]) -> Recording {
    let registry = headland_stock::registry();
    let of = |(number, run): (usize, &Run)| {
        let scenario = Scenario::of_text("truth.ron", &text(run), Path::new(""), &registry).unwrap();
        let outcome =
            simulate(&scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap()).unwrap();
        let mut draws = Draws::new(5, number as u64);
        let mut trace = Trace::new(outcome.trace.time_s().to_vec()).unwrap();
        for name in ["speed_m_s", "position_m", "heading_rad", "tractive_force_n", "coasting"] {
            let mut values = outcome.trace.get(name).unwrap().to_vec();
            match name {
                "speed_m_s" => values.iter_mut().for_each(|value| *value += 0.02 * draws.normal()),
                "position_m" if run.reversed => values.iter_mut().for_each(|value| *value = 300.0 - *value),
                _ => {}
            }
            trace.push(name, values, Origin::Measured).unwrap();
        }
        RecordedRun {
            id: format!("r{number}"),
            trace,
            path: Some("lane".to_owned()),
            reversed: run.reversed,
            held_out: number + 1 == runs.len(),
            known: if run.mass_kg > MASS_KG { vec![known(run.mass_kg)] } else { Vec::new() },
            sensors: Vec::new(),
        }
    };
    Recording {
        about: "simulated".to_owned(),
        path: PathBuf::from("recording.ron"),
        runs: runs.iter().enumerate().map(of).collect(),
        known: Vec::new(),
        notices: Vec::new(),
    }
}

fn known(mass_kg: f64) -> Known {
    Known { name: "mass_kg".to_owned(), value: mass_kg, sd: None }
}

fn found(runs: &[Run], only: &[&str]) -> Diagnosed {
    let registry = headland_stock::registry();
    let nominal = text(&Run { coefficient_sd: runs[0].coefficient_sd, ..Run::of("") });
    let scenario = Scenario::of_text("nominal.ron", &nominal, Path::new(""), &registry).unwrap();
    let options = Options { only: only.iter().map(|id| (*id).to_owned()).collect(), ..Options::default() };
    diagnose(&scenario, &recording(runs), &registry, &options, &Silent).unwrap()
}

/// ln p of one cause over that of another, as the first round tried them.
fn odds(found: &Diagnosed, one: &str, other: &str) -> f64 {
    let best = |id: &str| {
        let tried = found.diagnosis.tried.iter().filter(|tried| tried.round == 1 && tried.id == id);
        tried.map(|tried| tried.gain).fold(f64::NEG_INFINITY, f64::max)
    };
    best(one) - best(other)
}

/// A run against two causes, as it was proposed.
fn proposed<'a>(found: &'a Diagnosed, run: &str, [one, other]: [&str; 2]) -> &'a Experiment {
    let about = |experiment: &&Experiment| {
        let [a, b] = &experiment.separates;
        experiment.run == run && ((a == one && b == other) || (a == other && b == one))
    };
    found.diagnosis.experiments.iter().find(about).unwrap()
}

/// Odds of one to twenty, from which on a rival is no longer named.
const TELLS: f64 = 3.0;

/// Three runs of the truth cannot tell it from a rival. The run that is proposed, driven once, tells as much as was said,
/// and the same run once more tells nothing, as was said.
fn it_tells_what_it_promised(
    truth: &Run,
    further: Run,
    [run, words]: [&str; 2],
    pair: [&str; 2],
) -> [f64; 2] {
    let at_first = [truth.clone(), truth.clone(), truth.clone()];
    let before = found(&at_first, &pair);
    assert_eq!(before.diagnosis.verdict, Verdict::CannotTell, "{}", before.diagnosis.answer);
    let next = &before.diagnosis.findings[0].next_experiment;
    assert!(next.starts_with(words) && before.diagnosis.answer.contains(words), "{next}");

    let again = [truth.clone(), truth.clone(), truth.clone(), truth.clone()];
    let useless = proposed(&before, "same_again", pair).expected_ln_odds;
    let observed = odds(&found(&again, &pair), pair[0], pair[1]);
    assert!(useless < TELLS && observed < TELLS, "expected {useless}, observed {observed}");

    let after = found(&[truth.clone(), truth.clone(), further, truth.clone()], &pair);
    let finding = &after.diagnosis.findings[0];
    assert!(finding.id == pair[0] && finding.indistinguishable_from.is_empty(), "{}", after.diagnosis.answer);
    let promised = proposed(&before, run, pair).expected_ln_odds;
    let observed = odds(&after, pair[0], pair[1]);
    assert!(
        promised > TELLS && observed > promised - scatter(promised),
        "promised {promised}, observed {observed}"
    );
    [promised, observed]
}

/// Half a squared length of L with noise of one standard deviation has a standard deviation of √(2L): three of them.
fn scatter(ln_odds: f64) -> f64 {
    3.0 * (2.0 * ln_odds).sqrt()
}

#[test]
fn a_slope_is_told_from_a_dragging_brake_by_the_other_direction() {
    let truth = Run::of("grade_constant(grade: 0.012)");
    let back = Run {
        effects: "grade_constant(grade: -0.012)".to_owned(),
        heading_deg: 180.0,
        reversed: true,
        ..truth.clone()
    };
    let run = ["other_direction", "drive the same lane once in the other direction"];
    it_tells_what_it_promised(&truth, back.clone(), run, ["grade_constant", "brake_drag"]);
    it_tells_what_it_promised(&truth, back, run, ["grade_constant", "rolling_resistance"]);
}

/// A brake drags the other way as well: the same run is proposed, and this time it tells for the brake.
#[test]
fn a_dragging_brake_is_told_from_a_slope_by_the_same_run() {
    let truth = Run::of("brake_drag(force_n: 1600)");
    let back = Run { heading_deg: 180.0, reversed: true, ..truth.clone() };
    let run = ["other_direction", "drive the same lane once in the other direction"];
    it_tells_what_it_promised(&truth, back, run, ["brake_drag", "grade_constant"]);
}

#[test]
fn rotating_parts_are_told_from_mass_by_ballast_with_the_odds_that_were_expected() {
    let truth = Run::of("rotating_inertia(rotating_mass_kg: 1500)");
    let heavy = Run { mass_kg: MASS_KG + 2000.0, ..truth.clone() };
    let run = ["ballast", "drive the same run with 2000 kg of ballast"];
    let [expected, observed] = it_tells_what_it_promised(&truth, heavy, run, ["rotating_inertia", "mass"]);
    assert!((observed - expected).abs() < scatter(expected), "expected {expected}, observed {observed}");
}

/// Drag goes with the square of the wind: what a gale does is not what ten breezes do.
fn a_wind_is_told_by_the_other_direction(speed_m_s: f64) {
    // On ground that is known better than this the strongest of these winds is told by what a law of the ground asks of it.
    let effects = format!("wind(speed_m_s: {speed_m_s:?}, from_rad: 0.0)");
    let truth = Run { coefficient_sd: 0.01, ..Run::of(&effects) };
    let back = Run { heading_deg: 180.0, reversed: true, ..truth.clone() };
    let run = ["other_direction", "drive the same lane once in the other direction"];
    it_tells_what_it_promised(&truth, back, run, ["wind", "rolling_speed_law"]);
}

#[test]
fn a_breeze_is_told_from_a_law_of_the_ground_by_the_other_direction() {
    a_wind_is_told_by_the_other_direction(5.0);
}

#[test]
fn a_strong_wind_is_told_from_a_law_of_the_ground_by_the_other_direction() {
    a_wind_is_told_by_the_other_direction(8.0);
}

#[test]
fn a_gale_is_told_from_a_law_of_the_ground_by_the_other_direction() {
    a_wind_is_told_by_the_other_direction(12.0);
}

/// A vehicle that rolls free rolls otherwise uphill than downhill, and a run that was drafted as if it did not told everything.
#[test]
fn a_coast_down_that_was_rolled_both_ways_tells_no_more_once_it_is_rolled_again() {
    let cycle = "Coast(until: SpeedBelow(speed_m_s: 1))";
    let there = Run {
        cycle: cycle.to_owned(),
        coefficient_sd: 0.01,
        start_m_s: 12.0,
        ..Run::of("grade_constant(grade: 0.006), aerodynamic_drag(extra_area_m2: 4)")
    };
    let back = Run {
        effects: there.effects.replace("0.006", "-0.006"),
        heading_deg: 180.0,
        reversed: true,
        ..there.clone()
    };
    let runs = [there.clone(), back.clone(), there.clone(), back.clone(), there, back];
    let found = found(&runs, &["grade_constant", "aerodynamic_drag", "mass"]);
    let other =
        |one: &&Experiment| one.run == "other_direction" && one.separates.iter().any(|id| id == "mass");
    for one in found.diagnosis.experiments.iter().filter(other) {
        assert!(one.expected_ln_odds < 7.0, "{}", one.sentence);
    }
    assert!(
        found.diagnosis.experiments.iter().any(|one| one.run == "other_direction"),
        "{}",
        found.diagnosis.answer
    );
}

#[test]
fn what_is_known_only_together_is_told_with_its_amounts() {
    let truth = Run::of("rotating_inertia(rotating_mass_kg: 1500)");
    let found = found(&[truth.clone(), truth.clone(), truth], &["mass", "rotating_inertia"]);
    let sentences = &found.diagnosis.null_space;
    let told = sentences.iter().find(|one| one.contains("`rotating_inertia.rotating_mass_kg` by")).unwrap();
    // Force over mass is all that a run of one mass shows: as much inertia more, as much mass less.
    assert!(told.contains("raising `rotating_inertia.rotating_mass_kg` by 780 kg"), "{told}");
    assert!(told.contains("lowering `mass_kg` by 780 kg"), "{told}");
    let mut unique = sentences.clone();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(unique.len(), sentences.len());
}

/// Without a rival the run is proposed that narrows the interval most: with the ground's resistance free, the slope is
/// best known from both directions.
#[test]
fn a_finding_without_rivals_is_told_what_would_narrow_it() {
    let truth = Run::of("grade_constant(grade: 0.012)");
    let found = found(&[truth.clone(), truth.clone(), truth], &["grade_constant"]);
    let next = &found.diagnosis.findings[0].next_experiment;
    let said =
        "drive the same lane once in the other direction: it would narrow the interval of its grade, ±";
    assert!(next.starts_with(said) && next.contains(" now, by a factor of "), "{next}");
    assert!(found.diagnosis.experiments.is_empty());
}
