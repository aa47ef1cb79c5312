//! What nobody listed is found as an equation that runs; what is taken from the library is not claimed under another
//! name; a sensor that is late is called late.

#![allow(clippy::result_large_err, reason = "a test fails once")]

mod setting;

use headland_calibrate::statistics::Draws;
use headland_diagnose::{Diagnosed, FindingKind, Kind, Options, Verdict};
use headland_plugin::Situation;
use headland_recording::Recording;
use headland_scenario::Scenario;
use headland_sim::simulate;
use headland_trace::{Origin, Trace};
use setting::{
    found, found_of_scenario, named, recorded, recorded_of_scenario, recording_of, recording_of_scenario,
    scenario,
};
use std::path::Path;

/// A wave along the path, the same whichever way it is driven: no listed cause has one.
const WAVE: &str = r#"expression(resistance: "a_n * cos(x / l_m)", constants: {"a_n": 1500.0, "l_m": 3.7})"#;
const WAVE_OVER_TAU_M: f64 = 3.7;
/// A drag that dies away as the vehicle gets faster.
const FADING: &str =
    r#"expression(resistance: "a_n * exp(-v / v0_m_s)", constants: {"a_n": 5000.0, "v0_m_s": 1.3})"#;

/// What the effects of a scenario do along the run that was held out, forward [N].
fn force(text: &str, run: &Trace) -> Vec<f64> {
    let registry = headland_stock::registry();
    let scenario = Scenario::of_text("effects.ron", text, Path::new(""), &registry).unwrap();
    let model = scenario.run(scenario.runs.last().unwrap(), &registry).unwrap().model(&registry).unwrap();
    let get = |name: &str| run.get(name).unwrap();
    let (speed, position, coasting) = (get("speed_m_s"), get("position_m"), get("coasting"));
    // What each remembers, from sample to sample.
    let mut memories: Vec<Vec<f64>> = model
        .effects
        .iter()
        .map(|effect| effect.plugin.states().iter().map(|state| state.initial).collect())
        .collect();
    let at = |index: usize| {
        let situation = Situation {
            time_s: run.time_s()[index],
            position_m: position[index],
            speed_m_s: speed[index],
            mass_kg: model.vehicle.mass_kg,
            gravity_m_s2: model.gravity_m_s2,
            air: model.air,
            coasting: coasting[index] >= 0.5,
            ..Situation::default()
        };
        let step_s = run.time_s()[(index + 1).min(run.len() - 1)] - run.time_s()[index];
        let of = |effect: &dyn headland_plugin::Effect, memory: &mut Vec<f64>| {
            effect.decide(&situation, memory);
            let mut rates = vec![0.0; memory.len()];
            let action = effect.act(&situation, memory, &mut rates);
            for (state, rate) in memory.iter_mut().zip(rates) {
                *state += step_s * rate;
            }
            action.force_n - action.resistance_n
        };
        model.effects.iter().zip(&mut memories).map(|(effect, memory)| of(&*effect.plugin, memory)).sum()
    };
    (0..run.len()).map(at).collect()
}

/// Share of the hidden force that the improved scenario has in the run that was held out; its mean apart, which the
/// coefficient of the soil may hold as well.
fn reproduced(found: &Diagnosed, hidden: &str, recording: &Recording) -> f64 {
    let run = &recording.runs.last().unwrap().trace;
    let (truth, law) = (force(&scenario(0.069, hidden, ""), run), force(&found.scenarios[0], run));
    let mean = |all: &[f64]| all.iter().sum::<f64>() / all.len() as f64;
    let (about, off) = (mean(&truth), mean(&truth) - mean(&law));
    let left: f64 = truth.iter().zip(&law).map(|(truth, law)| (truth - law - off).powi(2)).sum();
    let whole: f64 = truth.iter().map(|truth| (truth - about).powi(2)).sum();
    1.0 - left / whole
}

/// Every second drive goes back along the lane, which is as long as whole waves of [`WAVE`].
fn to_and_fro(mut recording: Recording) -> Recording {
    /// More than any drive takes.
    const WAVES: f64 = 10.0;
    let whole_m = std::f64::consts::TAU * WAVE_OVER_TAU_M * WAVES;
    for run in recording.runs.iter_mut().skip(1).step_by(2) {
        run.reversed = true;
        let mut trace = Trace::new(run.trace.time_s().to_vec()).unwrap();
        for channel in run.trace.channels() {
            let back = |value: &f64| if channel.name == "position_m" { whole_m - value } else { *value };
            let values = channel.values.iter().map(back).collect();
            trace.push(channel.name.clone(), values, Origin::Measured).unwrap();
        }
        run.trace = trace;
    }
    recording
}

fn is_found_as_a_law(hidden: &str, recording: &Recording) {
    let found = found(recording, &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    assert_eq!(said.findings[0].kind, FindingKind::Unlisted, "{}", said.answer);
    let share = reproduced(&found, hidden, recording);
    assert!(share > 0.9, "{share}: {}", said.answer);
    // The equation runs like any other effect.
    let registry = headland_stock::registry();
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    let model = improved.model(&registry).unwrap();
    assert!(simulate(&model, improved.cycle.as_ref().unwrap()).unwrap().trace.get("expression_n").is_some());
}

#[test]
fn a_wave_along_the_path_is_found_as_an_equation_that_runs() {
    is_found_as_a_law(WAVE, &to_and_fro(recorded(0.069, WAVE)));
}

/// What pushes more than the ground resists is a force, and what only resists would not be let drive.
#[test]
fn a_wave_that_pushes_is_found_as_an_equation_that_runs() {
    const PUSHING: &str =
        r#"expression(force: "-a_n * cos(x / l_m)", constants: {"a_n": 12000.0, "l_m": 3.7})"#;
    is_found_as_a_law(PUSHING, &to_and_fro(recorded(0.069, PUSHING)));
}

/// Waves of a road that was driven one way are slopes by their name, however short the formula that draws them.
#[test]
fn a_wave_that_was_driven_one_way_is_not_told_from_slopes() {
    let found = found(&recorded(0.069, WAVE), &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::CannotTell, "{}", said.answer);
    assert!(named(&found, "grade") && named(&found, "unlisted"), "{}", said.answer);
}

#[test]
fn a_drag_that_dies_away_with_speed_is_found_as_an_equation_that_runs() {
    is_found_as_a_law(FADING, &recorded(0.069, FADING));
}

/// A drag that is all there at a walk is a level at nearly every sample, and how it gets there says that it is none.
#[test]
fn a_drag_that_saturates_early_is_found_as_an_equation_that_runs() {
    const SATURATING: &str = r#"expression(resistance: "a_n * (1 - exp(-v / v0_m_s))", constants: {"a_n": 5000.0, "v0_m_s": 1.0})"#;
    is_found_as_a_law(SATURATING, &recorded(0.069, SATURATING));
}

/// Driven up and down over several speeds, with some effects.
fn up_and_down(effects: &str) -> String {
    let reach =
        |speed_m_s: f64| format!("Reach(speed_m_s: {speed_m_s:?}, acceleration_m_s2: 0.5), Hold(for_s: 5),");
    let cycle: String = [4.5, 7.5, 3.5, 1.4, 4.0, 2.5].map(reach).concat();
    scenario(0.069, effects, "").replace("cycle: [", &format!("cycle: [{cycle}"))
}

/// What is found of a force that remembers, in an equation with a word.
fn remembers(hidden: &str, word: &str) {
    let registry = headland_stock::registry();
    let recording = recorded_of_scenario(&up_and_down(hidden), &registry);
    let found = found_of_scenario(&up_and_down(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    let equation = said.findings[0].equation.as_str();
    let share = reproduced(&found, hidden, &recording);
    assert!(share > 0.9 && equation.contains(word), "{share} {equation}: {}", said.answer);
}

/// A flap that opens at one speed stays open until another is reached: at speeds between, the force is what was passed last.
#[test]
fn a_switch_that_latches_is_found_as_an_equation_that_runs() {
    const FLAP: &str = r#"expression(resistance: "a_n * latched(v, open_m_s, closed_m_s)", constants: {"a_n": 900.0, "open_m_s": 5.2, "closed_m_s": 1.9})"#;
    remembers(FLAP, "latched(");
}

/// A drag that takes nine seconds to follow the square of the speed, as oil that has to be stirred.
#[test]
fn what_follows_the_speed_late_is_found_as_an_equation_that_runs() {
    const LATE: &str = r#"expression(resistance: "a_n * lagged((v / v0_m_s)^2, lag_s)", constants: {"a_n": 1800.0, "v0_m_s": 7.0, "lag_s": 9.0})"#;
    remembers(LATE, "lagged(");
}

/// Mud wears off with the way from wherever a run began, which is no place of the lane.
#[test]
fn what_wears_off_with_the_way_is_found_where_places_were_recorded() {
    const MUD: &str =
        r#"expression(resistance: "a_n * exp(-way / l_m)", constants: {"a_n": 3000.0, "l_m": 11.0})"#;
    is_found_as_a_law(MUD, &to_and_fro(recorded(0.069, MUD)));
}

/// A wind is no sum of columns: beside a law its strength was told by half too much, and runs held out denied both.
#[test]
fn a_drag_that_dies_away_is_found_beside_a_wind() {
    let turned = |effects: &str| {
        let mut text = scenario(0.069, effects, "");
        for (from, to) in
            [("0 deg", "20 deg"), ("180 deg", "95 deg"), ("0 deg", "170 deg"), ("180 deg", "260 deg")]
        {
            text = text.replacen(&format!("heading_rad\": \"{from}"), &format!("heading_rad\": \"{to}"), 1);
        }
        text.replace("sd: 0.01,", "sd: 0.004,")
    };
    let hidden = format!("{FADING}, wind(speed_m_s: 10.0, from_rad: 1.3)");
    let mut recording = recorded_of_scenario(&turned(&hidden), &headland_stock::registry());
    for run in &mut recording.runs {
        run.path = None;
    }
    let found =
        found_of_scenario(&turned(""), &recording, &Options::default(), &headland_stock::registry()).unwrap();
    let said = &found.diagnosis;
    let claimed: Vec<&str> = said.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert!(
        claimed.len() == 2 && claimed.contains(&"unlisted") && claimed.contains(&"wind"),
        "{}",
        said.answer
    );
    let wind = said.findings.iter().find(|finding| finding.id == "wind").unwrap();
    let speed_m_s = wind.parameters[0].value;
    assert!((speed_m_s - 10.0).abs() < 1.5, "{speed_m_s}: {}", said.answer);
}

/// Between a level and an aerodynamic drag, which say much of it together: it is said, or named beside what is claimed.
#[test]
fn a_drag_between_two_listed_ones_is_not_claimed_as_those_in_silence() {
    let hidden =
        r#"expression(resistance: "a_n * (v / v0_m_s)^1.5", constants: {"a_n": 2500.0, "v0_m_s": 6.0})"#;
    let found = found(&recorded(0.069, hidden), &Options::default()).unwrap();
    let said = &found.diagnosis;
    let open = [Verdict::Unlisted, Verdict::CannotTell].contains(&said.verdict);
    assert!(open && named(&found, "unlisted"), "{}", said.answer);
}

/// A driveline that loses more the faster it turns: no listed loss of the drive goes with speed alone.
#[test]
fn a_loss_that_goes_with_drive_and_speed_is_found_as_a_share_of_the_drive() {
    /// Share that is lost at the speed below.
    const SHARE: f64 = 0.15;
    const AT_M_S: f64 = 5.0;
    let hidden = format!(
        r#"expression(loss_share: "n * v / v0_m_s", constants: {{"n": {SHARE}, "v0_m_s": {AT_M_S}}})"#
    );
    let found = found(&recorded(0.069, &hidden), &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    assert!(said.findings[0].equation.starts_with("F = |F_drive| ("), "{}", said.findings[0].equation);
    let registry = headland_stock::registry();
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    let model = improved.model(&registry).unwrap();
    for speed_m_s in [3.0, 7.0] {
        let situation = Situation { speed_m_s, ..Situation::default() };
        let told: f64 =
            model.effects.iter().map(|one| one.plugin.act(&situation, &[], &mut []).loss_share).sum();
        let truth = SHARE * speed_m_s / AT_M_S;
        assert!((told / truth - 1.0).abs() < 0.1, "{speed_m_s} m/s: {told}, {truth}: {}", said.answer);
    }
}

/// A coupling that locks above a force loses a share of it there, and nothing below.
#[test]
fn a_loss_above_a_force_is_found_as_a_share_of_the_drive() {
    const SHARE: f64 = 0.12;
    const ABOVE_N: f64 = 11e3;
    let hidden = format!(
        r#"expression(loss_share: "n * (F_drive > f_n)", constants: {{"n": {SHARE}, "f_n": {ABOVE_N}}})"#
    );
    let found = found(&recorded(0.069, &hidden), &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    assert!(said.findings[0].depends_on.contains(&"tractive_force_n".to_owned()), "{}", said.answer);
    let registry = headland_stock::registry();
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    let model = improved.model(&registry).unwrap();
    for (tractive_force_n, truth) in [(9e3, 0.0), (13e3, SHARE)] {
        let situation = Situation { tractive_force_n, ..Situation::default() };
        let told: f64 =
            model.effects.iter().map(|one| one.plugin.act(&situation, &[], &mut []).loss_share).sum();
        assert!((told - truth).abs() < 0.1 * SHARE, "{tractive_force_n} N: {told}: {}", said.answer);
    }
}

/// A loss with the square of the force is no loss in proportion to it, which would be the listed one.
#[test]
fn a_loss_that_goes_with_the_square_of_the_force_is_found_as_a_share_of_it() {
    const PER_N: f64 = 4e-6;
    let hidden =
        format!(r#"expression(loss_share: "abs(F_drive) / f_n", constants: {{"f_n": {:?}}})"#, 1.0 / PER_N);
    let recording = recorded(0.069, &hidden);
    let found = found(&recording, &Options::default()).unwrap();
    let [law] = &found.diagnosis.findings[..] else { panic!("{}", found.diagnosis.answer) };
    assert_eq!(law.kind, FindingKind::Unlisted, "{}", found.diagnosis.answer);
    assert_eq!(law.depends_on, ["tractive_force_n"], "{:?}", law.equation);
    let registry = headland_stock::registry();
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    let model = improved.run(&improved.runs[0], &registry).unwrap().model(&registry).unwrap();
    for force_n in [6e3, 12e3, -12e3, 17e3] {
        let situation = Situation { tractive_force_n: force_n, speed_m_s: 5.0, ..Situation::default() };
        let share: f64 =
            model.effects.iter().map(|one| one.plugin.act(&situation, &[], &mut []).loss_share).sum();
        let truth = PER_N * force_n.abs();
        assert!(
            (share - truth).abs() < 0.1 * truth,
            "{share} instead of {truth} at {force_n} N: {:?}",
            law.equation
        );
    }
}

/// Wheels that slip the more the faster they turn: the listed slip goes with the pull alone.
#[test]
fn a_slip_that_grows_with_speed_is_found_between_wheels_and_ground() {
    const PER_N: f64 = 5e-6;
    const AT_M_S: f64 = 5.0;
    let hidden = format!(
        r#"expression(slip: "F_drive / f_n * (v / v0_m_s)^2", constants: {{"f_n": {:?}, "v0_m_s": {AT_M_S}}})"#,
        1.0 / PER_N
    );
    let channels = ["speed_m_s", "wheel_speed_m_s", "tractive_force_n", "heading_rad"];
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" | "wheel_speed_m_s" => value + 0.01 * draws.normal(),
        _ => value,
    };
    let recording = recording_of((0.069, &hidden), &headland_stock::registry(), &channels, (29, &noisy));
    let found = found(&recording, &Options::default()).unwrap();
    let [law] = &found.diagnosis.findings[..] else { panic!("{}", found.diagnosis.answer) };
    assert_eq!((law.kind, law.balance), (FindingKind::Unlisted, Kind::Slip), "{}", found.diagnosis.answer);
    assert!(law.equation.starts_with("s = "), "{}", law.equation);
    let registry = headland_stock::registry();
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    let model = improved.run(&improved.runs[0], &registry).unwrap().model(&registry).unwrap();
    for (speed_m_s, force_n) in [(3.0, 9e3), (7.0, 9e3), (7.0, 5e3)] {
        let situation = Situation { tractive_force_n: force_n, speed_m_s, ..Situation::default() };
        let told: f64 = model.effects.iter().map(|one| one.plugin.act(&situation, &[], &mut []).slip).sum();
        let truth = PER_N * force_n * (speed_m_s / AT_M_S).powi(2);
        assert!((told / truth - 1.0).abs() < 0.1, "{speed_m_s} m/s: {told}, {truth}: {}", law.equation);
    }
    // Along the run that was held out it is what its wheels ran ahead by.
    let along = found.effects.last().unwrap();
    assert!(along.trace.get("unlisted_m_s").is_some());
}

/// What holds back on slopes, up and down alike, is a law of the slope that the scenario knows.
#[test]
fn a_drag_on_known_slopes_is_found_as_an_equation() {
    const HIDDEN: &str = r#"expression(resistance: "a_n * (v / v0_m_s) * abs(slope)", constants: {"a_n": 50000.0, "v0_m_s": 5.0})"#;
    const LENGTH_M: f64 = 70.0;
    let height_m =
        |at_m: f64| 0.6 * (std::f64::consts::TAU * at_m / LENGTH_M).sin() + 0.3 * (at_m / 9.0).cos();
    let point = |at_m: f64| format!("(position_m: {at_m:?}, elevation_m: {:?}), ", height_m(at_m));
    let points = (0..=20).map(|number| point(10.0 * f64::from(number))).collect::<Vec<_>>().concat();
    let hills = format!("Profile(heading_rad: 0.0, points: [{points}])");
    let on_hills = |effects: &str| scenario(0.069, effects, "").replacen("Flat(heading_rad: 0.0)", &hills, 1);
    let registry = headland_stock::registry();
    let recording = recorded_of_scenario(&on_hills(HIDDEN), &registry);
    let found = found_of_scenario(&on_hills(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let law = said.findings.iter().find(|finding| finding.id == "unlisted");
    let law = law.unwrap_or_else(|| panic!("{}", said.answer));
    assert!(law.equation.contains("slope"), "{}: {}", law.equation, said.answer);
}

/// The same tractor with an engine instead of a battery.
fn with_an_engine(effects: &str) -> String {
    const ENGINE: &str = r#"EngineCvt(
            displacement_m3: 8e-3, willans_efficiency: 0.42, willans_friction_pa: "1.7 bar", lower_heating_value_j_kg: 42.8e6,
            full_load: [(speed_rad_s: 80, torque_n_m: 900), (speed_rad_s: 150, torque_n_m: 1100), (speed_rad_s: 220, torque_n_m: 800)],
            idle_speed_rad_s: 80, load_share: 0.9, transmission_efficiency: 0.9, max_force_n: 100000, accessory_power_w: 3000,
            alternator_efficiency: 0.6, wheel_radius_m: 0.9, rotating_mass_kg: 0,
        ),
    ),
    ground"#;
    let text = scenario(0.069, effects, "");
    let (before, rest) = text.split_once("ElectricSingleSpeed").unwrap();
    let (_, after) = rest.split_once("ground").unwrap();
    format!("{before}{ENGINE}{after}")
}

/// Sensors of speed and fuel with noise; all else as it is.
fn speed_and_fuel(fuel_noise_kg_s: f64) -> impl Fn(&str, f64, &mut Draws) -> f64 {
    move |name, value, draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "fuel_rate_kg_s" => value + fuel_noise_kg_s * draws.normal(),
        _ => value,
    }
}

/// The teeth of a variator between points that lie off any grid: bells at some speeds follow them, which changes of range would be.
#[test]
fn teeth_of_a_variator_are_no_changes_of_range() {
    const NODES_M_S: [f64; 2] = [2.3, 4.9];
    let hidden = format!("variator_loss(loss: 0.25, node_speeds_m_s: {NODES_M_S:?}, upstream: true)");
    let registry = headland_stock::registry();
    let speed_and_fuel = speed_and_fuel(1e-5);
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "tractive_force_n" => value + 100.0 * draws.normal(),
        _ => speed_and_fuel(name, value, draws),
    };
    let channels = ["speed_m_s", "tractive_force_n", "fuel_rate_kg_s"];
    let recording = recording_of_scenario(&with_an_engine(&hidden), &registry, &channels, (5, &noisy));
    let found = found_of_scenario(&with_an_engine(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let variator = said.findings.iter().find(|one| one.id == "variator_loss");
    let variator = variator.unwrap_or_else(|| panic!("{}", said.answer));
    let nodes: Vec<f64> = variator.parameters.iter().skip(1).map(|one| one.value).collect();
    let near = |node: &f64| nodes.iter().any(|told| (told - node).abs() < 0.2);
    assert!(NODES_M_S.iter().all(near), "{nodes:?}: {}", said.answer);
    assert!(said.findings.iter().all(|one| one.id != "shift_transient"), "{}", said.answer);
}

/// A fan that takes over where no wind cools any more, and only fuel tells of it.
#[test]
fn a_consumer_by_a_law_of_speed_is_found_in_the_fuel_and_in_watts() {
    const FAN: &str =
        r#"expression(shaft_power: "p_w * exp(-v / v0_m_s)", constants: {"p_w": 50000.0, "v0_m_s": 2.5})"#;
    let registry = headland_stock::registry();
    let noisy = speed_and_fuel(1e-4);
    let channels = ["speed_m_s", "position_m", "heading_rad", "fuel_rate_kg_s"];
    let recording = recording_of_scenario(&with_an_engine(FAN), &registry, &channels, (5, &noisy));
    // These drives pass every place at one speed, and a function of the place would say the same.
    let without = ["grade", "soft_ground"].map(str::to_owned).to_vec();
    let options = Options { without, ..Options::default() };
    let found = found_of_scenario(&with_an_engine(""), &recording, &options, &registry).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    let model = improved.model(&registry).unwrap();
    let power_w = |speed_m_s: f64| {
        let situation = Situation { speed_m_s, ..Situation::default() };
        model.effects.iter().map(|one| one.plugin.act(&situation, &[], &mut []).shaft_power_w).sum::<f64>()
    };
    // What is the same at every speed belongs to the consumers that are known.
    let told = power_w(2.0) - power_w(6.0);
    let truth = 50_000.0 * ((-2.0_f64 / 2.5).exp() - (-6.0_f64 / 2.5).exp());
    assert!((told / truth - 1.0).abs() < 0.15, "{told} W, {truth} W: {}", said.answer);
}

/// Drives of the electric tractor at many speeds, those that come back at others.
fn at_many_speeds(hidden: &str) -> String {
    const LEVELS_M_S: [u32; 10] = [6, 3, 8, 4, 9, 2, 7, 5, 9, 3];
    let level =
        |speed_m_s: u32| format!("Reach(speed_m_s: {speed_m_s}, acceleration_m_s2: 0.4), Hold(for_s: 8), ");
    let text = scenario(0.069, hidden, "");
    let (before, rest) = text.split_once("cycle: [").unwrap();
    let (_, after) = rest.split_once("effects").unwrap();
    let back = r#""180 deg""#;
    let others = r#""180 deg", "cycle.0.speed_m_s": 4.5, "cycle.4.speed_m_s": 3.5, "cycle.8.speed_m_s": 5.5"#;
    let cycle = LEVELS_M_S.map(level).concat();
    format!("{before}cycle: [{cycle}],\n    effects{after}").replace(back, others)
}

/// What is found in those drives with something hidden in them, by the torque of the motor and the battery.
fn found_at_many_speeds(hidden: &str) -> Diagnosed {
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "motor_torque_n_m" => value + 0.5 * draws.normal(),
        "battery_voltage_v" | "battery_current_a" => value + 0.1 * draws.normal(),
        _ => value,
    };
    let channels = ["speed_m_s", "position_m", "motor_torque_n_m", "battery_voltage_v", "battery_current_a"];
    let registry = headland_stock::registry();
    let recording = recording_of_scenario(&at_many_speeds(hidden), &registry, &channels, (8, &noisy));
    found_of_scenario(&at_many_speeds(""), &recording, &Options::default(), &registry).unwrap()
}

/// A fan that sets in at a speed, in a car whose battery has another resistance: what that brings in the voltage is no reason to
/// miss what is left of the power.
#[test]
fn a_consumer_above_a_speed_is_found_beside_another_resistance_of_the_battery() {
    const HIDDEN: &str = r#"battery_resistance(resistance_ohm: 0.09), expression(
        auxiliary_power: "p_w * tanh(max(v - v0_m_s, 0) / v1_m_s)",
        constants: {"p_w": 900.0, "v0_m_s": 4.0, "v1_m_s": 1.0})"#;
    let found = found_at_many_speeds(HIDDEN);
    let said = &found.diagnosis;
    assert!(named(&found, "battery_resistance") && named(&found, "unlisted"), "{}", said.answer);
    let law = said.findings.iter().find(|finding| finding.id == "unlisted").unwrap();
    assert_eq!((law.balance, law.depends_on.clone()), (Kind::Battery, vec!["speed_m_s".to_owned()]));
}

/// What heats and cools by the square of how far the air is from 19.2 °C, on ten days of one temperature each: a heater's ramp is nearly the
/// same, and a level of each run is all of it, and neither foretells another day.
#[test]
fn a_consumer_by_the_temperature_of_each_day_is_a_law_and_no_level_of_each_run() {
    const PER_K2_W: f64 = 12.0;
    const COMFORT_C: f64 = 19.2;
    const DAYS_C: [f64; 10] = [-7.3, 25.1, 4.2, 28.7, -2.9, 14.8, 26.4, 8.6, 20.3, 0.7];
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "motor_torque_n_m" => value + 0.5 * draws.normal(),
        _ => value + 0.02 * draws.normal(),
    };
    let channels = ["speed_m_s", "motor_torque_n_m", "battery_voltage_v", "battery_current_a"];
    let registry = headland_stock::registry();
    let text = scenario(0.069, "", "");
    let of = |seed: u64| recording_of_scenario(&text, &registry, &channels, (seed, &noisy));
    let mut recording = of(8);
    recording.runs.extend(of(9).runs);
    for (number, (run, air_c)) in recording.runs.iter_mut().zip(DAYS_C).enumerate() {
        (run.id, run.path, run.held_out) = (format!("d{number}"), None, number % 4 == 2);
        let power_w = PER_K2_W * (air_c - COMFORT_C).powi(2);
        let voltage_v = run.trace.get("battery_voltage_v").unwrap().to_vec();
        let mut current_a = run.trace.remove("battery_current_a").unwrap().values;
        for (current_a, voltage_v) in current_a.iter_mut().zip(voltage_v) {
            *current_a += power_w / voltage_v;
        }
        run.trace.push("battery_current_a", current_a, Origin::Measured).unwrap();
        let air_c = vec![air_c; run.trace.len()];
        run.trace.push("air_temperature_c", air_c, Origin::Measured).unwrap();
    }
    let found = found_of_scenario(&text, &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    let [law] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(law.depends_on, ["air_temperature_c"], "{}", said.answer);
    let held_out = said.fit.held_out.as_ref().unwrap();
    assert!(held_out.rmse_after < 0.2 * held_out.rmse_before, "{held_out:?}");
}

/// Every drive loses some of its power with the square of its force, and that is free: three to four times what is usual is told by its
/// size, which what is usual would hide.
#[test]
fn a_loss_by_the_square_of_the_force_that_is_not_small_is_told_by_its_size() {
    const POWER_W: f64 = 4200.0;
    let hidden = format!(
        r#"expression(auxiliary_power: "p_w * (F_drive / f_n)^2", constants: {{"p_w": {POWER_W:?}, "f_n": 10000.0}})"#
    );
    let found = found_at_many_speeds(&hidden);
    let said = &found.diagnosis;
    let [law] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!(law.kind, FindingKind::Unlisted, "{}", said.answer);
    assert_eq!(law.depends_on, ["tractive_force_n"], "{:?}", law.equation);
    let at_10_kn_w = 100.0 * law.parameters[0].value;
    assert!((at_10_kn_w / POWER_W - 1.0).abs() < 0.15, "{at_10_kn_w} W: {}", said.answer);
}

/// An engine that was driven just before starts warm: two of four runs start cold, and only fuel tells of it.
#[test]
fn an_engine_that_starts_cold_in_some_runs_is_found_with_its_friction() {
    const COLD: &str = "cold_start(cold_torque_n_m: 300.0, time_constant_s: 90.0)";
    const TORQUE_N_M: f64 = 300.0;
    let registry = headland_stock::registry();
    let noisy = speed_and_fuel(1e-4);
    let channels = ["speed_m_s", "position_m", "heading_rad", "fuel_rate_kg_s", "engine_speed_rad_s"];
    let of =
        |effects: &str| recording_of_scenario(&with_an_engine(effects), &registry, &channels, (6, &noisy));
    let (mut recording, warm) = (of(COLD), of(""));
    // One each way: slopes would be as cold in one direction.
    for run in [1, 2] {
        recording.runs[run] = warm.runs[run].clone();
    }
    let found =
        found_of_scenario(&with_an_engine(""), &recording, &Options::default(), &registry).unwrap().diagnosis;
    assert_eq!(found.findings[0].id, "cold_start", "{}", found.answer);
    let torque = &found.findings[0].parameters[0];
    assert!((torque.value / TORQUE_N_M - 1.0).abs() < 0.2, "{torque:?}: {}", found.answer);
}

/// Runs with force, torque of the engine and fuel, each noisy.
fn with_a_shaft(hidden: &str, torque_noise_n_m: f64, fuel_noise_kg_s: f64) -> Recording {
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "fuel_rate_kg_s" => value + fuel_noise_kg_s * draws.normal(),
        "engine_torque_n_m" => value + torque_noise_n_m * draws.normal(),
        "tractive_force_n" => value + 100.0 * draws.normal(),
        _ => value,
    };
    let channels = [
        "speed_m_s",
        "position_m",
        "heading_rad",
        "tractive_force_n",
        "engine_torque_n_m",
        "engine_speed_rad_s",
        "fuel_rate_kg_s",
    ];
    let registry = headland_stock::registry();
    recording_of_scenario(&with_an_engine(hidden), &registry, &channels, (7, &noisy))
}

/// What takes power at the shaft takes fuel for it, and where the fuel is known far better it shows there: runs held out are
/// asked about the fuel then, not about the shaft.
#[test]
fn a_fan_at_the_shaft_that_shows_most_in_the_fuel_is_claimed() {
    const POWER_W: f64 = 15e3;
    const AT_M_S: f64 = 8.0;
    let hidden = format!(
        r#"expression(auxiliary_power: "p_w * (v / v0_m_s)^3", constants: {{"p_w": {POWER_W}, "v0_m_s": {AT_M_S}}})"#
    );
    let recording = with_a_shaft(&hidden, 60.0, 2e-5);
    let registry = headland_stock::registry();
    let found =
        found_of_scenario(&with_an_engine(""), &recording, &Options::default(), &registry).unwrap().diagnosis;
    assert_eq!(found.verdict, Verdict::Unlisted, "{}", found.answer);
    assert_eq!(found.findings[0].balance, Kind::Fuel, "{}", found.answer);
    let errors = found.fit.held_out.unwrap();
    assert!(errors.rmse_after < 0.2 * errors.rmse_before, "{}", found.answer);
}

/// Fuel alone says as much of friction in the engine as of a consumer; the torque at its shaft tells them apart, each by the
/// balance in which it shows first.
#[test]
fn torque_beside_fuel_tells_a_consumer_from_friction_in_the_engine() {
    let registry = headland_stock::registry();
    for (hidden, id, balance, amount) in [
        ("auxiliary_power(power_w: 9e3)", "auxiliary_power", Kind::Shaft, 9e3),
        ("engine_friction(torque_n_m: 90.0)", "engine_friction", Kind::Fuel, 90.0),
    ] {
        let recording = with_a_shaft(hidden, 12.0, 1e-4);
        let found =
            found_of_scenario(&with_an_engine(""), &recording, &Options::default(), &registry).unwrap();
        let said = &found.diagnosis;
        let ids: Vec<&str> = said.findings.iter().map(|finding| finding.id.as_str()).collect();
        assert_eq!(ids, [id], "{}", said.answer);
        assert_eq!(said.findings[0].balance, balance, "{}", said.answer);
        let value = said.findings[0].parameters[0].value;
        assert!((value / amount - 1.0).abs() < 0.1, "{value}: {}", said.answer);
    }
}

/// A force that is told too large asks more of the engine than its torque and its fuel say, also where that is more than full
/// load gives at the speed that was recorded: one scale says all three, and no mass and no friction beside it.
#[test]
fn a_force_sensor_with_a_wrong_scale_is_told_by_motion_shaft_and_fuel_alike() {
    const SCALE: f64 = 1.25;
    let mut recording = with_a_shaft("", 12.0, 1e-4);
    for run in &mut recording.runs {
        let force = run.trace.remove("tractive_force_n").unwrap();
        let read = force.values.iter().map(|force| SCALE * force).collect();
        run.trace.push("tractive_force_n", read, Origin::Measured).unwrap();
    }
    let registry = headland_stock::registry();
    let found =
        found_of_scenario(&with_an_engine(""), &recording, &Options::default(), &registry).unwrap().diagnosis;
    assert_eq!(found.verdict, Verdict::SensorArtefact, "{}", found.answer);
    let ids: Vec<&str> = found.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert_eq!(ids, ["force_scale"], "{}", found.answer);
    let scale = found.findings[0].parameters[0].value;
    assert!((scale / SCALE - 1.0).abs() < 0.01, "{scale}: {}", found.answer);
}

/// A loss between the engine and the wheels whose force was measured: nothing of it is in the motion, and all of it at the shaft.
#[test]
fn a_loss_upstream_of_a_measured_force_is_told_by_the_shaft() {
    const LOSS: f64 = 0.16;
    let recording = with_a_shaft(&format!("driveline_efficiency(loss: {LOSS}, upstream: true)"), 12.0, 1e-4);
    let registry = headland_stock::registry();
    let found = found_of_scenario(&with_an_engine(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let ids: Vec<&str> = said.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert_eq!(ids, ["driveline_efficiency"], "{}", said.answer);
    assert_eq!(said.findings[0].balance, Kind::Shaft, "{}", said.answer);
    let value = said.findings[0].parameters[0].value;
    assert!((value / LOSS - 1.0).abs() < 0.2, "{value}: {}", said.answer);
    assert!(found.scenarios.iter().all(|text| text.contains("upstream: true")));
}

/// A flow meter that is late tells of fuel what the engine did before.
#[test]
fn a_fuel_rate_that_comes_late_is_a_latency() {
    const LATE: usize = 24;
    let mut recording = with_a_shaft("", 12.0, 1e-4);
    for run in &mut recording.runs {
        let fuel = run.trace.remove("fuel_rate_kg_s").unwrap();
        let late = (0..fuel.values.len()).map(|index| fuel.values[index.saturating_sub(LATE)]).collect();
        run.trace.push("fuel_rate_kg_s", late, Origin::Measured).unwrap();
    }
    let late_s = LATE as f64 * recording.runs[0].trace.period_s();
    let registry = headland_stock::registry();
    let found =
        found_of_scenario(&with_an_engine(""), &recording, &Options::default(), &registry).unwrap().diagnosis;
    assert_eq!(found.verdict, Verdict::SensorArtefact, "{}", found.answer);
    let latency = &found.findings[0];
    assert_eq!((latency.id.as_str(), latency.depends_on[0].as_str()), ("latency", "fuel_rate_kg_s"));
    let value = latency.parameters[0].value;
    assert!((value / late_s - 1.0).abs() < 0.2, "{value} for {late_s}: {}", found.answer);
}

/// Where the true cause is not in the library, no other is claimed as if it were certain.
#[test]
fn without_the_true_cause_no_listed_one_is_claimed_in_silence() {
    for (hidden, id) in
        [("wind(speed_m_s: 6.2, from_rad: 0.4)", "wind"), ("neutral_drag(force_n: 900.0)", "neutral_drag")]
    {
        let without = Options { without: vec![id.to_owned()], ..Options::default() };
        let found = found(&recorded(0.07, hidden), &without).unwrap();
        assert!(!named(&found, id), "{id}: {}", found.diagnosis.answer);
        let honest = [Verdict::None, Verdict::Unlisted, Verdict::CannotTell];
        assert!(honest.contains(&found.diagnosis.verdict), "{id}: {}", found.diagnosis.answer);
    }
}

/// Soft ground that had dried when the run that was held out was driven: better by the level of the soil's resistance, which
/// is calibrated, that run is worse with the map than without it.
#[test]
fn a_map_that_does_not_help_the_run_that_was_held_out_is_not_claimed() {
    const LEVEL: f64 = 0.08;
    // It gets softer and firmer again, as no spell by the clock does.
    let patch = "soft_ground(positions_m: [25.0, 33.0, 41.0, 49.0, 57.0, 65.0], \
                 coefficients: [0.008, 0.02, 0.03, 0.018, 0.006])";
    let (mut recording, dry) = (recorded(LEVEL, patch), recorded(LEVEL, ""));
    let shown = found(&recording, &Options::default()).unwrap();
    assert!(named(&shown, "soft_ground"), "{}", shown.diagnosis.answer);
    let held_out = recording.runs.iter().position(|run| run.held_out).unwrap();
    recording.runs[held_out] = dry.runs[held_out].clone();
    let found = found(&recording, &Options::default()).unwrap();
    let errors = found.diagnosis.fit.held_out.as_ref().unwrap();
    assert!(errors.rmse_after < errors.rmse_before, "{}", found.diagnosis.answer);
    let maps = ["soft_ground", "grade"];
    let claimed = found.diagnosis.findings.iter().any(|finding| maps.contains(&finding.id.as_str()));
    assert!(!claimed, "{}", found.diagnosis.answer);
}

/// The speed arrives so much late [s].
const LATE_S: f64 = 0.3;

#[test]
fn a_speed_that_arrives_late_is_called_late_by_so_much() {
    let mut late = recorded(0.07, "");
    for run in &mut late.runs {
        let late_s = run.trace.time_s()[0] + LATE_S;
        let samples = run.trace.time_s().partition_point(|time| *time < late_s);
        let mut trace = Trace::new(run.trace.time_s().to_vec()).unwrap();
        for channel in run.trace.channels() {
            let value = |index: usize| {
                channel.values
                    [if channel.name == "speed_m_s" { index.saturating_sub(samples) } else { index }]
            };
            let values: Vec<f64> = (0..channel.values.len()).map(value).collect();
            trace.push(channel.name.clone(), values, Origin::Measured).unwrap();
        }
        run.trace = trace;
    }
    let found = found(&late, &Options::default()).unwrap().diagnosis;
    assert_eq!(found.verdict, Verdict::SensorArtefact, "{}", found.answer);
    let latency = &found.findings.iter().find(|finding| finding.id == "latency").unwrap().parameters[0];
    assert!((latency.value / LATE_S - 1.0).abs() < 0.2, "{latency:?}");
}

#[test]
fn a_law_has_the_same_bits_at_one_thread_and_at_two() {
    let recording = recorded(0.069, WAVE);
    let text = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| found(&recording, &Options::default())).unwrap();
        (serde_json::to_string(&found.diagnosis).unwrap(), found.scenarios)
    };
    assert_eq!(text(1), text(2));
}

/// A fan on the crankshaft takes what the engine's speed says, whatever the vehicle's is, and only fuel tells of it.
#[test]
fn a_fan_on_the_crankshaft_is_found_by_the_speed_of_the_engine() {
    const POWER_W: f64 = 12e3;
    const AT_RAD_S: f64 = 200.0;
    let hidden = format!(
        r#"expression(shaft_power: "p_w * (engine_speed / n_rad_s)^3", constants: {{"p_w": {POWER_W}, "n_rad_s": {AT_RAD_S}}})"#
    );
    let kept = |effects: &str| {
        let text = with_an_engine(effects);
        let (before, rest) = text.split_once("cycle: [").unwrap();
        let (_, after) = rest.split_once("effects: [").unwrap();
        let at = |speed_m_s: f64, engine_rad_s: f64| {
            format!(
                "With(engine_speed_rad_s: {engine_rad_s}, phases: [\
                 Reach(speed_m_s: {speed_m_s}, acceleration_m_s2: 0.4), Hold(for_s: 12)]), "
            )
        };
        let cycle: String =
            [(3.0, 210.0), (6.0, 150.0), (2.0, 120.0), (7.0, 190.0), (4.0, 100.0), (5.0, 210.0)]
                .map(|(speed_m_s, engine_rad_s)| at(speed_m_s, engine_rad_s))
                .concat();
        format!("{before}cycle: [{cycle}],\n    effects: [{after}")
    };
    let registry = headland_stock::registry();
    let noisy = speed_and_fuel(5e-5);
    let channels = ["speed_m_s", "tractive_force_n", "engine_speed_rad_s", "fuel_rate_kg_s"];
    let mut recording = recording_of_scenario(&kept(&hidden), &registry, &channels, (8, &noisy));
    recording.runs.remove(2);
    let found = found_of_scenario(&kept(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    assert!(said.findings[0].depends_on.contains(&"engine_speed_rad_s".to_owned()), "{}", said.answer);
    let improved = Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry).unwrap();
    let model = improved.model(&registry).unwrap();
    let power_w = |engine_rad_s: f64| -> f64 {
        let at = Situation { engine_speed_rad_s: Some(engine_rad_s), ..Situation::default() };
        let of = |one: &headland_sim::Named<dyn headland_plugin::Effect>| {
            let action = one.plugin.act(&at, &[], &mut []);
            action.auxiliary_power_w + action.shaft_power_w
        };
        model.effects.iter().map(of).sum()
    };
    // What is the same at every speed belongs to the consumers that are known.
    let told = power_w(200.0) - power_w(120.0);
    assert!(told > 5e3 && told < 2e4, "{told}: {}", said.answer);
}

/// Drives with one channel more, by time and run, and a drag that the drive has to overcome, by the speed, its force and that
/// channel.
fn dragged(
    name: &str,
    channel: impl Fn(f64, usize) -> f64,
    drag_n: impl Fn(f64, f64, f64) -> f64,
) -> Recording {
    let mut recording = recorded(0.069, "");
    for (number, run) in recording.runs.iter_mut().enumerate() {
        let along: Vec<f64> = run.trace.time_s().iter().map(|t| channel(*t, number)).collect();
        let mut force = run.trace.remove("tractive_force_n").unwrap().values;
        let speed = run.trace.get("speed_m_s").unwrap();
        for ((force, v), value) in force.iter_mut().zip(speed).zip(&along) {
            *force += drag_n(v.max(0.0), *force, *value);
        }
        let coasting = run.trace.remove("coasting").unwrap();
        let until = coasting.values.iter().position(|on| *on > 0.5).unwrap() - 1;
        run.trace.push("tractive_force_n", force, Origin::Measured).unwrap();
        run.trace.push(name, along, Origin::Measured).unwrap();
        run.trace = run.trace.slice(0.0, run.trace.time_s()[until]);
    }
    recording
}

/// Oil that a cooler, which comes and goes, warms and cools within each run, and a drag by the speed and by its temperature.
fn dragged_by_oil(drag_n: impl Fn(f64, f64) -> f64) -> Recording {
    let oil_c = |t: f64, run: usize| 35.0 + 15.0 * (t / 9.0 + 1.3 * run as f64).sin();
    dragged("oil_temperature_c", oil_c, |v, _, oil_c| drag_n(v, oil_c))
}

/// Gears between wheels that turn unlike each other lose a share of the drive in turns: no force of the turn alone, and no
/// efficiency.
#[test]
fn a_loss_of_the_drive_in_turns_is_found_as_a_share_of_it() {
    /// Share that is lost where the path turns like this [1/m].
    const SHARE: f64 = 0.2;
    const AT_PER_M: f64 = 0.1;
    let curvature_per_m = |t: f64, run: usize| 0.1 * (t / 4.0 + run as f64).sin();
    let lost_n = |_: f64, force_n: f64, kappa: f64| SHARE * (kappa / AT_PER_M).abs() * force_n.abs();
    let found = found(&dragged("curvature_per_m", curvature_per_m, lost_n), &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    assert!(said.findings[0].equation.starts_with("F = |F_drive| ("), "{}", said.findings[0].equation);
    assert!(said.findings[0].depends_on.contains(&"curvature_per_m".to_owned()), "{}", said.answer);
}

/// A wheel that rubs in bends to the right alone, which some of the runs take in a moment: nothing in nearly all rows, and far more
/// than chance in those.
#[test]
fn a_drag_in_short_bends_one_way_is_found() {
    /// How long a bend lasts to either side of its middle [s], and how it turns [1/m].
    const LASTS_S: f64 = 1.2;
    const TURNS_PER_M: f64 = 0.06;
    let bend = |t: f64, at_s: f64| TURNS_PER_M * (-((t - at_s) / LASTS_S).powi(2)).exp();
    let curvature_per_m = |t: f64, run: usize| {
        let right = if run.is_multiple_of(2) { bend(t, 10.0 + run as f64) } else { 0.0 };
        // No hand is so steady that a force would stand still.
        right - bend(t, 21.0 + run as f64) + 5e-4 * (9.0 * t).sin()
    };
    let rubs_n = |v: f64, _: f64, kappa: f64| 2500.0 * (v * v * kappa).max(0.0);
    let found = found(&dragged("curvature_per_m", curvature_per_m, rubs_n), &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    let law = &said.findings[0];
    assert!(law.depends_on.contains(&"curvature_per_m".to_owned()), "{}", said.answer);
    assert!(law.equation.contains("max("), "{}", law.equation);
}

/// The overrun brake of a trailer pushes back where the vehicle slows down by more than a little: a force that makes the acceleration
/// which it goes by. A mass acts to either side.
#[test]
fn an_overrun_brake_is_found_by_the_acceleration_that_it_makes() {
    /// Force for each m/s² [kg], and where it begins [m/s²].
    const BRAKE_KG: f64 = 4700.0;
    const BEYOND_M_S2: f64 = 0.17;
    let brake = format!(
        "expression(resistance: \"m_kg * max(-acceleration - a_m_s2, 0)\", \
         constants: {{\"m_kg\": {BRAKE_KG:?}, \"a_m_s2\": {BEYOND_M_S2:?}}})"
    );
    let found = found(&recorded(0.069, &brake), &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    let law = &said.findings[0];
    assert!(law.equation.contains("acceleration") && law.equation.contains("max("), "{}", law.equation);
    let value = |name: &str| law.parameters.iter().find(|one| one.name == name).unwrap().value;
    let slope_kg = value("a1_n") / value("acceleration2_m_s2");
    assert!((slope_kg / BRAKE_KG - 1.0).abs() < 0.1, "{slope_kg}: {}", law.equation);
    assert!((value("acceleration1_m_s2") + BEYOND_M_S2).abs() < 0.04, "{}", law.equation);
}

/// Oil that was recorded to warm up thins: a drag by its temperature, which no clock and no start says.
#[test]
fn oil_that_was_recorded_drags_by_its_temperature() {
    /// Drag at the temperature below, by the speed [N s/m], and how it fades [K].
    const DRAG_N_S_M: f64 = 900.0;
    const AT_C: f64 = 20.0;
    const FADES_K: f64 = 14.0;
    let recording = dragged_by_oil(|v, oil_c| DRAG_N_S_M * v * (-(oil_c - AT_C) / FADES_K).exp());
    let found = found(&recording, &Options::default()).unwrap();
    let (said, findings) = (&found.diagnosis, &found.diagnosis.findings);
    assert!(findings.len() == 1 && findings[0].id == "driveline_temperature", "{}", said.answer);
    assert!(findings[0].depends_on.contains(&"oil_temperature_c".to_owned()), "{}", said.answer);
    for (name, truth) in [("cold_viscous_n_s_m", DRAG_N_S_M), ("temperature_scale_k", FADES_K)] {
        let one = findings[0].parameters.iter().find(|one| one.name == name).unwrap();
        assert!(one.ci95[0] < truth && truth < one.ci95[1], "{one:?}");
        assert!(one.ci95[1] - one.ci95[0] < 0.2 * truth, "{one:?}");
    }
}

/// What was found first is a law that names a channel, and so says the verdict.
fn is_told_by(recording: &Recording, channels: &[&str]) {
    let found = found(recording, &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(said.verdict, Verdict::Unlisted, "{}", said.answer);
    for channel in channels {
        assert!(said.findings[0].depends_on.contains(&(*channel).to_owned()), "{}", said.answer);
    }
}

/// What comes on where the oil is hot is no oil that thins.
#[test]
fn a_drag_above_a_temperature_of_the_oil_is_found_as_an_equation() {
    let recording = dragged_by_oil(|v, oil_c| 150.0 * v * (1.0 + ((oil_c - 38.0) / 2.0).tanh()));
    is_told_by(&recording, &["oil_temperature_c"]);
}

/// Tyres that are let down and pumped up on the way roll the harder the softer they are.
#[test]
fn a_drag_by_the_pressure_of_the_tyres_is_found_as_an_equation() {
    let pressure_pa = |t: f64, run: usize| 1.3e5 + 0.5e5 * (t / 9.0 + 1.3 * run as f64).sin();
    let recording = dragged("tyre_pressure_pa", pressure_pa, |v, _, pa| 1500.0 * v * (-pa / 0.5e5).exp());
    is_told_by(&recording, &["tyre_pressure_pa"]);
}

/// A wind that was measured from the side of a lane to the north, of which the scenario alone knows where it leads: the vehicle crabs.
#[test]
fn a_drag_by_the_wind_from_the_side_is_found_where_the_terrain_knows_the_heading() {
    let wind_m_s = |t: f64, run: usize| 5.0 + 3.0 * (t / 5.0 + 0.9 * run as f64).sin();
    let mut recording = dragged("wind_speed_m_s", wind_m_s, |v, _, wind_m_s| 45.0 * v * wind_m_s);
    for run in &mut recording.runs {
        run.trace.remove("heading_rad");
        let from_east = vec![std::f64::consts::FRAC_PI_2; run.trace.len()];
        run.trace.push("wind_direction_rad", from_east, Origin::Measured).unwrap();
    }
    is_told_by(&recording, &["wind_speed_m_s"]);
}

/// A slope across the path rubs the flanks of the wheels, to either side alike, and the harder the more is driven by the power take-off.
#[test]
fn a_drag_by_the_roll_and_the_power_of_the_take_off_is_found_as_an_equation() {
    let roll_rad = |t: f64, run: usize| 0.12 * (t / 5.0 + 0.7 * run as f64).sin();
    let taken_w = |t: f64, run: usize| 3e4 + 2e4 * (t / 9.0 + 1.3 * run as f64).sin();
    let mut recording = dragged("pto_power_w", taken_w, |_, _, _| 0.0);
    for (run, recorded) in recording.runs.iter_mut().enumerate() {
        let trace = &mut recorded.trace;
        let rolls: Vec<f64> = trace.time_s().iter().map(|t| roll_rad(*t, run)).collect();
        let power_w = trace.get("pto_power_w").unwrap().to_vec();
        let mut force_n = trace.remove("tractive_force_n").unwrap().values;
        for ((force_n, roll_rad), power_w) in force_n.iter_mut().zip(&rolls).zip(power_w) {
            *force_n += roll_rad.sin().abs() * power_w;
        }
        trace.push("tractive_force_n", force_n, Origin::Measured).unwrap();
        trace.push("roll_rad", rolls, Origin::Measured).unwrap();
    }
    is_told_by(&recording, &["roll_rad", "pto_power_w"]);
}

/// The same where each run has a pressure of its own: levels that differ for no reason say as much in more numbers.
#[test]
fn levels_of_runs_that_a_pressure_says_are_told_by_it() {
    const PRESSURES_PA: [f64; 5] = [0.8e5, 1.9e5, 1.1e5, 1.5e5, 0.9e5];
    let pressure_pa = |_: f64, run: usize| PRESSURES_PA[run % PRESSURES_PA.len()];
    let recording = dragged("tyre_pressure_pa", pressure_pa, |v, _, pa| 1500.0 * v * (-pa / 0.5e5).exp());
    let found = found(&recording, &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert!(
        said.findings.iter().any(|one| one.depends_on.contains(&"tyre_pressure_pa".to_owned())),
        "{}",
        said.answer
    );
}

/// A law that is many times what is left open of the drag area, and much like it: it is no other drag area, and says in one term what
/// two listed laws would patch.
#[test]
fn a_law_like_a_free_parameter_is_not_that_parameter() {
    let text = |effects: &str| {
        let free = r#"free: [(name: "vehicle.drag_area_m2", sd: 0.6, bounds: (2, 12)),"#;
        scenario(0.03, effects, "").replacen("free: [", free, 1)
    };
    let hidden = r#"expression(resistance: "a_n * (abs(v) / v1_m_s)^1.5", constants: {"a_n": 2800.0, "v1_m_s": 10.0})"#;
    let recording = recorded_of_scenario(&text(hidden), &headland_stock::registry());
    let registry = headland_stock::registry();
    let found = found_of_scenario(&text(""), &recording, &Options::default(), &registry).unwrap();
    let said = &found.diagnosis;
    let [law] = &said.findings[..] else { panic!("{}", said.answer) };
    assert_eq!((law.kind, said.verdict), (FindingKind::Unlisted, Verdict::Unlisted), "{}", said.answer);
    assert!(law.equation.contains("^1.5"), "{}", law.equation);
}
