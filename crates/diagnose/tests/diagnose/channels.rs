//! Runs that lack a channel, and balances from channels that are not powers or forces themselves.

use super::setting::{
    found, found_of_scenario, found_with, named, recording_of, recording_of_scenario, scenario,
};
use headland_calibrate::statistics::Draws;
use headland_diagnose::{Diagnosed, Options};
use headland_recording::{Recording, Sensor};
use headland_trace::Origin;
use headland_units::constants::STANDARD_GRAVITY_M_S2;

/// The five drives with these channels, each sample changed as is said: name, sample, a draw of noise.
fn recorded(effects: &str, channels: &[&str], sensor: impl Fn(&str, f64, f64) -> f64) -> Recording {
    let noisy = |name: &str, value: f64, draws: &mut Draws| sensor(name, value, draws.normal());
    recording_of((0.069, effects), &headland_stock::registry(), channels, (23, &noisy))
}

fn noted(found: &Diagnosed, what: &str) -> bool {
    found.diagnosis.notes.iter().any(|note| note.contains(what))
}

#[test]
fn slip_is_told_along_a_run_whose_speed_over_ground_nobody_recorded() {
    let channels = ["speed_m_s", "wheel_speed_m_s", "tractive_force_n", "heading_rad"];
    let noisy = |name: &str, value: f64, noise: f64| match name {
        "speed_m_s" | "wheel_speed_m_s" => value + 0.01 * noise,
        _ => value,
    };
    let mut recording = recorded("wheel_slip(coefficient: 0.5)", &channels, noisy);
    let ground = recording.runs[1].trace.remove("speed_m_s").unwrap().values;
    let wheels = recording.runs[1].trace.get("wheel_speed_m_s").unwrap().to_vec();
    let found = found(&recording, &Options::default()).unwrap();
    assert!(named(&found, "wheel_slip"), "{:?}", found.diagnosis.answer);
    assert!(noted(&found, "In r1 no speed over ground was recorded"), "{:?}", found.diagnosis.notes);
    let along = found.effects.iter().find(|run| run.id == "r1").unwrap();
    let slip = along.trace.get("wheel_slip_m_s").unwrap();
    let told = |index: usize| (wheels[index] - slip[index].abs()) / ground[index] - 1.0;
    let driven: Vec<f64> =
        (0..slip.len()).filter(|index| ground[*index] > 2.0).map(|index| told(index).abs()).collect();
    let mean = driven.iter().sum::<f64>() / driven.len() as f64;
    assert!(mean < 0.01, "{mean}");
}

/// A slip of some hundredths where the drives pull hardest, whether it is in proportion to the pull or grows with its square; a wrong
/// scale of a speed beside a straight one would say the latter too.
#[test]
fn slip_has_its_law_and_its_size_beside_a_mass_that_the_model_is_built_with() {
    let channels = ["speed_m_s", "wheel_speed_m_s", "tractive_force_n", "heading_rad"];
    let noisy = |name: &str, value: f64, noise: f64| match name {
        "speed_m_s" | "wheel_speed_m_s" => value + 0.01 * noise,
        _ => value,
    };
    for (name, value) in [("coefficient", 0.4), ("quadratic", 1.5)] {
        let hidden = format!("wheel_slip({name}: {value:?}), mass(extra_mass_kg: 1500)");
        let found = found(&recorded(&hidden, &channels, noisy), &Options::default()).unwrap();
        let answer = &found.diagnosis.answer;
        let slip = found.diagnosis.findings.iter().find(|one| one.id == "wheel_slip");
        let told = slip.unwrap_or_else(|| panic!("{answer}")).parameters.iter();
        let told: Vec<_> = told.filter(|one| one.value.abs() > 0.02).collect();
        let [one] = told[..] else { panic!("{answer}: {told:?}") };
        assert!(one.name == name && (one.value / value - 1.0).abs() < 0.03, "{name}: {one:?}");
        assert!(named(&found, "mass") && found.diagnosis.findings.len() == 2, "{answer}");
    }
}

#[test]
fn a_run_that_no_balance_can_use_is_left_out_and_said() {
    let mut recording = super::recorded(0.07, "");
    for name in ["tractive_force_n", "coasting"] {
        recording.runs[2].trace.remove(name);
    }
    let found = found(&recording, &Options::default()).unwrap();
    assert!(
        noted(&found, "In r2 nothing was recorded that a balance could use"),
        "{:?}",
        found.diagnosis.notes
    );
    assert!(!found.diagnosis.fit.fitted.runs.contains(&"r2".to_owned()));
    assert!(found.effects.iter().any(|run| run.id == "r2"));
}

/// 40 kW for half a minute of 432 MJ, in steps of 4.3 kJ.
#[test]
fn a_consumer_is_found_by_the_state_of_charge_alone() {
    const STEP: f64 = 1e-5;
    let channels = ["speed_m_s", "heading_rad", "position_m", "state_of_charge"];
    let sensed = |name: &str, value: f64, noise: f64| match name {
        "speed_m_s" => value + 0.01 * noise,
        "state_of_charge" => STEP * (value / STEP).floor(),
        _ => value,
    };
    let recording = recorded("auxiliary_power(power_w: 40000.0)", &channels, sensed);
    let found = found(&recording, &Options::default()).unwrap();
    assert!(named(&found, "auxiliary_power"), "{}", found.diagnosis.answer);
    let finding = &found.diagnosis.findings[0];
    let balance = serde_json::to_value(finding).unwrap()["balance"].clone();
    assert_eq!(balance, "battery");
    // A charge that changes a few times in a run says nothing of powers.
    let coarse = |name: &str, value: f64, noise: f64| match name {
        "state_of_charge" => 200.0 * STEP * (value / STEP / 200.0).floor(),
        _ => sensed(name, value, noise),
    };
    let recording = recorded("auxiliary_power(power_w: 40000.0)", &channels, coarse);
    let refused = super::found(&recording, &Options::default()).unwrap_err().to_string();
    assert!(refused.contains("no balance can be made"), "{refused}");
}

/// Every step of a coarse speed is an acceleration that nothing made.
#[test]
fn a_coarse_speed_contradicts_no_force() {
    const STEP_M_S: f64 = 0.4;
    let coarse = super::changed(&super::recorded(0.07, ""), "speed_m_s", |speed, _, _| {
        STEP_M_S * (speed / STEP_M_S).round()
    });
    let found = found(&coarse, &Options::default()).unwrap();
    assert!(named(&found, "quantisation"), "{}", found.diagnosis.answer);
    assert_eq!(found.diagnosis.findings.len(), 1, "{}", found.diagnosis.answer);
}

/// A bus gives forces in steps of about a per cent of their range; a sensor whose noise is known to be far less does not.
#[test]
fn steps_are_a_fault_where_they_hide_the_noise_that_is_known() {
    const STEP_N: f64 = 250.0;
    let mut recording = super::changed(&super::recorded(0.07, ""), "tractive_force_n", |force, _, _| {
        STEP_N * (force / STEP_N).round()
    });
    let silent = found(&recording, &Options::default()).unwrap();
    assert!(!named(&silent, "quantisation"), "{}", silent.diagnosis.answer);
    let known = Sensor { noise: Some(0.2 * STEP_N), ..Sensor::default() };
    for run in &mut recording.runs {
        run.sensors.push(("tractive_force_n".to_owned(), known));
    }
    let told = found(&recording, &Options::default()).unwrap();
    assert!(named(&told, "quantisation"), "{}", told.diagnosis.answer);
}

/// Each drive bends to one side and back in bows of 40 m, of 1/16 m at most, and its force pays for that.
fn bending(stiffness_n_per_rad: f64, noise_rad: f64) -> Recording {
    const MASS_KG: f64 = 13_000.0;
    const BOW_M: f64 = 40.0;
    const MOST_PER_M: f64 = 1.0 / 16.0;
    let mut recording = super::recorded(0.07, "");
    for (number, run) in recording.runs.iter_mut().enumerate() {
        let mut draws = Draws::new(31, number as u64);
        let (speed, position) = (run.trace.get("speed_m_s").unwrap(), run.trace.get("position_m").unwrap());
        let curvature = |position_m: f64| {
            let wave = (std::f64::consts::TAU * position_m / BOW_M).sin();
            MOST_PER_M * wave.signum() * wave.abs().min(0.8)
        };
        let mut heading = run.trace.get("heading_rad").unwrap()[0];
        let mut headings = Vec::new();
        let mut forces = Vec::new();
        let force = run.trace.get("tractive_force_n").unwrap();
        for index in 0..run.trace.len() {
            let at = curvature(position[index]);
            if index > 0 {
                heading += at * (position[index] - position[index - 1]);
            }
            headings.push((heading + noise_rad * draws.normal()).rem_euclid(std::f64::consts::TAU));
            forces.push(force[index] + (MASS_KG * speed[index].powi(2) * at).powi(2) / stiffness_n_per_rad);
        }
        for (name, values) in [("heading_rad", headings), ("tractive_force_n", forces)] {
            run.trace.remove(name);
            run.trace.push(name, values, Origin::Measured).unwrap();
        }
        // What rolls free pays with its speed.
        run.trace.remove("coasting");
    }
    recording
}

/// Whether or not the scenario lists what it is told: what nobody recorded nobody could list.
#[test]
fn drag_in_curves_is_told_by_the_heading_where_no_curvature_was_recorded() {
    let recording = bending(400_000.0, 0.01);
    for more in ["", "replay: (inputs: [Heading]),"] {
        let found = found_with(&recording, &Options::default(), more, &headland_stock::registry()).unwrap();
        let finding = &found.diagnosis.findings[0];
        assert_eq!(finding.id, "cornering_drag", "{}", found.diagnosis.answer);
        assert!((finding.parameters[0].value / 400_000.0 - 1.0).abs() < 0.1, "{:?}", finding.parameters);
        assert!(noted(&found, "it is made of `heading_rad`"), "{:?}", found.diagnosis.notes);
    }
}

#[test]
fn a_straight_lane_has_no_curvature_however_noisy_its_heading_is() {
    let noisy = |name: &str, value: f64, noise: f64| match name {
        "speed_m_s" => value + 0.02 * noise,
        "heading_rad" => value + 0.05 * noise,
        _ => value,
    };
    let recording = recorded("", &["speed_m_s", "tractive_force_n", "heading_rad"], noisy);
    let found = found(&recording, &Options::default()).unwrap();
    assert!(!noted(&found, "curvature_per_m"), "{:?}", found.diagnosis.notes);
    assert!(!named(&found, "cornering_drag"), "{}", found.diagnosis.answer);
}

/// A receiver of 5 Hz in a log of 20 Hz, whose cells are empty in between or repeat its last value.
fn renewed_rarely(recording: &Recording, held: bool) -> Recording {
    const EVERY: usize = 4;
    let mut recording = recording.clone();
    for run in &mut recording.runs {
        for name in ["speed_m_s", "position_m", "heading_rad"] {
            let values = run.trace.remove(name).unwrap().values;
            let rare = |row: usize| {
                if held || row.is_multiple_of(EVERY) { values[row - row % EVERY] } else { f64::NAN }
            };
            run.trace.push(name, (0..values.len()).map(rare).collect(), Origin::Measured).unwrap();
        }
    }
    recording
}

#[test]
fn a_speed_that_is_new_in_one_row_of_several_tells_as_much_as_if_it_were_logged_alone() {
    let hidden = super::recorded(0.07, "aerodynamic_drag(extra_area_m2: 6.0)");
    for (held, recording) in [(true, &hidden), (false, &hidden)] {
        let found = found(&renewed_rarely(recording, held), &Options::default()).unwrap();
        assert!(named(&found, "aerodynamic_drag"), "{}", found.diagnosis.answer);
        assert!(noted(&found, "the speed is new in one row of several"), "{:?}", found.diagnosis.notes);
        // An effect is told in every row of the log.
        assert!(
            found.effects.iter().zip(&recording.runs).all(|(one, run)| one.trace.len() == run.trace.len())
        );
        let drag = found.effects[0].trace.get("aerodynamic_drag_n");
        assert!(drag.is_none_or(|drag| drag.iter().all(|force| force.is_finite())));
    }
    let nothing = found(&renewed_rarely(&super::recorded(0.07, ""), true), &Options::default()).unwrap();
    assert!(nothing.diagnosis.findings.is_empty(), "{}", nothing.diagnosis.answer);
}

/// A fan that a plan of the runs switches on and off is the listed consumer, whatever formula could draw it.
#[test]
fn a_consumer_that_is_on_for_a_while_in_each_run_is_told_as_that() {
    let channels = ["speed_m_s", "position_m", "motor_torque_n_m", "battery_voltage_v", "battery_current_a"];
    let noisy = |name: &str, value: f64, noise: f64| match name {
        "speed_m_s" => value + 0.01 * noise,
        "battery_current_a" => value + 0.5 * noise,
        _ => value,
    };
    let hidden = "auxiliary_power(times_s: [7.3, 21.4], powers_w: [6200.0])";
    let found = found(&recorded(hidden, &channels, noisy), &Options::default()).unwrap();
    let ids: Vec<&str> = found.diagnosis.findings.iter().map(|finding| finding.id.as_str()).collect();
    assert_eq!(ids, ["auxiliary_power"], "{}", found.diagnosis.answer);
}

/// For some seconds of one run the battery gives a third of what the motor takes: nothing that consumes does that, and what it does
/// everywhere else is told as if those seconds had not been logged.
#[test]
fn where_a_battery_gives_less_than_the_motor_takes_it_tells_of_no_consumer() {
    const POWER_W: f64 = 6000.0;
    let hidden = format!("auxiliary_power(power_w: {POWER_W:?})");
    let longer = |effects: &str| {
        let text = scenario(0.069, effects, "");
        text.replace("Hold(for_s: 6)", "Hold(for_s: 80)")
    };
    let channels = ["speed_m_s", "position_m", "motor_torque_n_m", "battery_voltage_v", "battery_current_a"];
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.01 * draws.normal(),
        "motor_torque_n_m" => value + 0.3 * draws.normal(),
        "battery_current_a" => value + 0.5 * draws.normal(),
        _ => value,
    };
    let registry = headland_stock::registry();
    let mut recording = recording_of_scenario(&longer(&hidden), &registry, &channels, (37, &noisy));
    let broken = &mut recording.runs[1].trace;
    let mut current = broken.remove("battery_current_a").unwrap();
    for (current_a, time_s) in current.values.iter_mut().zip(broken.time_s()) {
        if (60.0..66.0).contains(time_s) {
            *current_a /= 3.0;
        }
    }
    broken.push("battery_current_a", current.values, Origin::Measured).unwrap();
    let found = found_of_scenario(&longer(""), &recording, &Options::default(), &registry).unwrap();
    assert!(
        noted(&found, "The battery gives less than the drive takes from it in r1 from "),
        "{:?}",
        found.diagnosis.notes
    );
    let [consumer] = &found.diagnosis.findings[..] else { panic!("{}", found.diagnosis.answer) };
    assert_eq!(consumer.id, "auxiliary_power", "{}", found.diagnosis.answer);
    let power = consumer.parameters.iter().find(|one| one.name == "power_w").unwrap();
    assert!((power.value - POWER_W).abs() < 0.02 * POWER_W, "{power:?}");
}

/// What is found of a slope with an accelerometer that reads so much too much.
fn felt_on_a_slope(grade: f64, bias_m_s2: f64) -> Diagnosed {
    let channels =
        ["speed_m_s", "position_m", "heading_rad", "tractive_force_n", "coasting", "acceleration_m_s2"];
    let noisy = |name: &str, value: f64, noise: f64| match name {
        "speed_m_s" => value + 0.01 * noise,
        "acceleration_m_s2" => value + STANDARD_GRAVITY_M_S2 * grade.atan().sin() + bias_m_s2 + 0.02 * noise,
        _ => value,
    };
    let mut recording = recorded(&format!("grade_constant(grade: {grade})"), &channels, noisy);
    for run in &mut recording.runs {
        let felt = run.trace.remove("acceleration_m_s2").unwrap();
        run.trace.push("specific_force_m_s2", felt.values, Origin::Measured).unwrap();
    }
    found(&recording, &Options::default()).unwrap()
}

/// Whether the interval of a finding holds the truth, and is no wider than a share of it.
fn told(found: &Diagnosed, id: &str, truth: f64, share: f64) {
    let finding = found.diagnosis.findings.iter().find(|finding| finding.id == id);
    let Some(finding) = finding else { panic!("{}", found.diagnosis.answer) };
    let [low, high] = finding.parameters[0].ci95;
    assert!(low < truth && truth < high && high - low < share * truth, "{:?}", finding.parameters);
}

/// What rotates has no weight: of 800 kg of it in 13 t an accelerometer would tell a sixteenth of a slope wrongly. By half a
/// thousandth of gravity any accelerometer may be off, so that much is open.
#[test]
fn a_slope_has_the_same_size_in_the_accelerometer_and_in_the_forces() {
    const GRADE: f64 = 0.012;
    let found = felt_on_a_slope(GRADE, 0.0);
    assert_eq!(found.diagnosis.findings.len(), 1, "{}", found.diagnosis.answer);
    told(&found, "grade_constant", GRADE, 0.13);
    let value = found.diagnosis.findings[0].parameters[0].value;
    assert!((value - GRADE).abs() < GRADE / 64.0, "{value}");
}

/// The fault stays out of the last fit of the slope, which would have to be half of both.
#[test]
fn a_slope_has_its_size_beside_an_accelerometer_that_reads_too_much() {
    let found = felt_on_a_slope(0.012, 0.15);
    assert_eq!(found.diagnosis.findings.len(), 2, "{}", found.diagnosis.answer);
    told(&found, "grade_constant", 0.012, 0.2);
    told(&found, "accelerometer_bias", 0.15, 0.2);
}
