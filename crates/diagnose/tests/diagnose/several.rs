//! Causes that hide each other, differ from run to run, or are not what they look like; channels of several rates.

use super::setting::{found, found_of_scenario, named, recording_of, recording_of_scenario, scenario};
use super::{changed, recorded};
use headland_calibrate::statistics::Draws;
use headland_diagnose::{Diagnosed, Options, Verdict};
use headland_recording::Recording;
use headland_trace::Origin;

pub fn ids(found: &Diagnosed) -> Vec<&str> {
    found.diagnosis.findings.iter().map(|finding| finding.id.as_str()).collect()
}

/// What is less while driven and more while coasting: each alone leaves the other, which would pass for noise.
#[test]
fn two_causes_that_hide_each_other_are_found_together() {
    let hidden =
        "rolling_resistance(coefficient: -0.008), neutral_drag(force_n: 1500.0, viscous_n_s_m: 60.0)";
    let found = found(&recorded(0.069, hidden), &Options::default()).unwrap();
    assert!(named(&found, "neutral_drag"), "{}", found.diagnosis.answer);
    let held = found.diagnosis.fit.held_out.as_ref().unwrap();
    assert!(held.rmse_after < 3.0 * held.noise && held.rmse_before > 5.0 * held.noise, "{held:?}");
}

/// Two runs, one of each direction, were driven in the wet; nobody said so.
#[test]
fn a_resistance_that_differs_from_run_to_run_is_told_as_that() {
    let (dry, wet) = (recorded(0.069, ""), recorded(0.069, "rolling_resistance(coefficient: 0.02)"));
    let mut mixed = dry.clone();
    for run in [0, 3] {
        mixed.runs[run] = wet.runs[run].clone();
    }
    for (run, recorded) in mixed.runs.iter_mut().enumerate() {
        recorded.path = None;
        recorded.id = format!("r{run}");
    }
    let found = found(&mixed, &Options::default()).unwrap();
    assert!(named(&found, "rolling_resistance"), "{}", found.diagnosis.answer);
    let finding = found.diagnosis.findings.iter().find(|one| one.id == "rolling_resistance").unwrap();
    assert!(finding.sentence.contains("differs from run to run"), "{}", finding.sentence);
    // More in the wet runs than in the dry ones, by 0.02 of the weight.
    let along = |run: &str| {
        let run = found.effects.iter().find(|one| one.id == run).unwrap();
        let values = run.trace.get("rolling_resistance_n").unwrap();
        let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        known[known.len() / 2]
    };
    let expected_n = -0.02 * 13_000.0 * 9.81;
    assert!((along("r3") - along("r2") - expected_n).abs() < 0.15 * expected_n.abs(), "{}", along("r3"));
}

/// One day it blew from the north, and another day from the south; the lane lies between the two. One wind for all runs would be none,
/// and what each run has of it was told as a load or as drag that come and go.
#[test]
fn a_wind_that_turned_between_two_days_is_told_by_what_it_was_in_each_run() {
    const NORTH_M_S: f64 = 7.0;
    const SOUTH_M_S: f64 = 5.0;
    let day = |speed_m_s: f64, from_rad: f64| {
        recorded(0.069, &format!("wind(speed_m_s: {speed_m_s:?}, from_rad: {from_rad:?})"))
    };
    let (first, second) = (day(NORTH_M_S, 0.0), day(SOUTH_M_S, std::f64::consts::PI));
    let mut both = first.clone();
    let count = both.runs.len();
    for (run, recorded) in both.runs.iter_mut().enumerate() {
        if run >= count / 2 {
            *recorded = second.runs[run].clone();
        }
    }
    let found = found(&both, &Options::default()).unwrap();
    let findings = &found.diagnosis.findings;
    assert!(findings.len() == 1 && findings[0].id == "wind", "{}", found.diagnosis.answer);
    assert!(findings[0].sentence.contains("differs from run to run"), "{}", findings[0].sentence);
    // The stronger one, which came from ahead or from behind, and nobody knows what blew across.
    let [speed, .., from] = &findings[0].parameters[..] else { panic!("{:?}", findings[0].parameters) };
    assert!(speed.ci95[0] < NORTH_M_S && NORTH_M_S < speed.ci95[1], "{speed:?}");
    assert!(from.name == "from_rad" && from.ci95[1] - from.ci95[0] > 6.0, "{from:?}");
    // Against the vehicle northwards on the first day, and with it on the second.
    let mean_n = |run: usize| {
        let own = &found.effects[run];
        let values = own.trace.get("wind_n").unwrap();
        let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        known.iter().sum::<f64>() / known.len() as f64
    };
    let northward = |run: usize| if run.is_multiple_of(2) { 1.0 } else { -1.0 };
    for run in 0..count {
        let ahead = if run < count / 2 { northward(run) } else { -northward(run) };
        assert!(mean_n(run) * ahead < 0.0, "run {run}: {} N", mean_n(run));
    }
    let held = found.diagnosis.fit.held_out.as_ref().unwrap();
    assert!(held.rmse_after < 0.3 * held.rmse_before, "{held:?}");
}

/// The force is made of the motor's torque; how much of it comes through the gears is known to a few per cent.
#[test]
fn a_gear_that_loses_a_little_more_is_calibrated_and_no_loss_is_claimed() {
    let with = |efficiency: f64, free: &str| {
        let text = scenario(0.069, "", "")
            .replace("gear_ratio: 20,", &format!("gear_ratio: 20, gear_efficiency: {efficiency:?},"));
        text.replace("    free: [\n", &format!("    free: [\n{free}"))
    };
    let noisy = |name: &str, value: f64, draws: &mut Draws| {
        if name == "speed_m_s" { value + 0.02 * draws.normal() } else { value }
    };
    let channels = ["speed_m_s", "position_m", "heading_rad", "motor_torque_n_m", "coasting"];
    let registry = headland_stock::registry();
    let recording = recording_of_scenario(&with(0.94, ""), &registry, &channels, (31, &noisy));
    let free = "        (name: \"vehicle.driveline.gear_efficiency\", sd: 0.03, bounds: (0.8, 1.0)),\n";
    let found = found_of_scenario(&with(0.97, free), &recording, &Options::default(), &registry).unwrap();
    assert_eq!(found.diagnosis.verdict, Verdict::None, "{}", found.diagnosis.answer);
    let gear = found.diagnosis.calibrated.iter().find(|one| one.name == "gear_efficiency").unwrap();
    assert!(gear.ci95[0] < 0.94 && 0.94 < gear.ci95[1] && gear.ci95[1] - gear.ci95[0] < 0.08, "{gear:?}");
}

/// A tank fills while the vehicle crosses softer ground: a function of time and one of the path, in the same force.
#[test]
fn a_load_that_comes_and_ground_that_gives_way_are_told_beside_each_other() {
    let of_run = |run: usize| {
        let (from_s, to_s) = (3 + 3 * run, 14 + 4 * run);
        recorded(
            0.069,
            &format!(
                "payload_change(times_s: [0, {from_s}, {to_s}, 80], masses_kg: [0, 0, 5000, 5000]), \
                 soft_ground(positions_m: [30, 55, 80, 100], coefficients: [0.03, 0, 0.025])"
            ),
        )
    };
    let mut recording = of_run(0);
    for run in 1..recording.runs.len() {
        recording.runs[run] = of_run(run).runs[run].clone();
    }
    let found = found(&recording, &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert!(ids(&found).contains(&"payload_change"), "{}", said.answer);
    assert!(named(&found, "soft_ground"), "{}", said.answer);
}

/// A speed that sticks for four seconds leaps when it goes on, and nobody braked there; in every run too, and where the noise
/// is too small to have moved it.
#[test]
fn where_a_speed_sticks_nobody_brakes() {
    let stuck = |time_s: f64| (6.0..10.0).contains(&time_s);
    for noise_m_s in [0.02, 2e-4] {
        let noisy = |name: &str, value: f64, draws: &mut Draws| {
            if name == "speed_m_s" { value + noise_m_s * draws.normal() } else { value }
        };
        let channels = ["speed_m_s", "position_m", "heading_rad", "tractive_force_n", "coasting"];
        let recording = recording_of((0.069, ""), &headland_stock::registry(), &channels, (11, &noisy));
        let recording = changed(&recording, "speed_m_s", |value, trace, index| {
            let times = trace.time_s();
            let first = times.iter().position(|time| stuck(*time)).unwrap();
            if stuck(times[index]) { trace.get("speed_m_s").unwrap()[first] } else { value }
        });
        let found = found(&recording, &Options::default()).unwrap();
        let said = &found.diagnosis;
        assert!(said.findings.iter().all(|finding| finding.id == "stuck_channel"), "{}", said.answer);
        assert!(!said.findings.is_empty(), "{}", said.answer);
        // What the sensor did not see is no error of the model.
        let held = said.fit.held_out.as_ref().unwrap();
        assert!(held.rmse_after < 3.0 * held.noise, "{noise_m_s}: {held:?}");
    }
}

#[test]
fn a_speed_that_is_held_for_some_samples_hides_nothing() {
    let held = changed(&recorded(0.069, "neutral_drag(force_n: 1500.0)"), "speed_m_s", |_, trace, index| {
        trace.get("speed_m_s").unwrap()[index - index % 5]
    });
    let found = found(&held, &Options::default()).unwrap();
    assert!(named(&found, "neutral_drag"), "{}", found.diagnosis.answer);
}

#[test]
fn a_force_in_one_row_of_two_is_filled_and_said() {
    let thin =
        changed(&recorded(0.069, "neutral_drag(force_n: 1500.0)"), "tractive_force_n", |value, _, index| {
            if index % 2 == 0 { value } else { f64::NAN }
        });
    let found = found(&thin, &Options::default()).unwrap();
    assert!(named(&found, "neutral_drag"), "{}", found.diagnosis.answer);
    assert!(
        found.diagnosis.notes.iter().any(|note| note.contains("one row of 2")),
        "{:?}",
        found.diagnosis.notes
    );
}

fn noisy_force(effects: &str) -> Recording {
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "tractive_force_n" => value + 60.0 * draws.normal(),
        _ => value,
    };
    let channels = ["speed_m_s", "position_m", "heading_rad", "tractive_force_n"];
    recording_of((0.069, effects), &headland_stock::registry(), &channels, (41, &noisy))
}

#[test]
fn a_force_that_falls_to_nought_now_and_then_is_a_dropout_and_no_brake() {
    let sound = noisy_force("");
    let hurt = changed(&sound, "tractive_force_n", |value, trace, index| {
        let time_s = trace.time_s()[index];
        if (15.0..15.8).contains(&time_s) || (18.0..18.5).contains(&time_s) { 0.0 } else { value }
    });
    let found = found(&hurt, &Options::default()).unwrap();
    assert_eq!(ids(&found), ["dropout"], "{}", found.diagnosis.answer);
}

/// A receiver that says nought for over a second, and now and then for a sample: no brake stops a vehicle from one sample to the
/// next.
#[test]
fn a_speed_that_is_nought_for_a_moment_is_a_dropout_and_no_brake() {
    let lost = |time_s: f64, index: usize| (8.0..9.2).contains(&time_s) || index % 97 == 60;
    let hurt = changed(&recorded(0.069, ""), "speed_m_s", |value, trace, index| {
        if lost(trace.time_s()[index], index) { 0.0 } else { value }
    });
    let found = found(&hurt, &Options::default()).unwrap();
    let said = &found.diagnosis;
    assert_eq!(ids(&found), ["dropout"], "{}", said.answer);
    assert_eq!(
        (said.verdict, said.findings[0].depends_on[0].as_str()),
        (Verdict::SensorArtefact, "speed_m_s")
    );
    // What the receiver lost is neither noise nor an error of the model.
    let held = said.fit.held_out.as_ref().unwrap();
    assert!(held.noise < 0.03 && held.rmse_after < 3.0 * held.noise, "{held:?}");
}

/// A speed that is set right by its latency ends before the other channels do; so it was with every coast-down of ten seconds
/// whose receiver was said to be late by two tenths, and each was told as a sensor that loses samples.
#[test]
fn a_speed_that_ends_before_the_others_is_no_dropout() {
    let ends = changed(&recorded(0.069, ""), "speed_m_s", |value, trace, index| {
        if index * 100 > 96 * trace.len() { f64::NAN } else { value }
    });
    let found = found(&ends, &Options::default()).unwrap();
    assert!(ids(&found).is_empty() && found.diagnosis.verdict == Verdict::None, "{}", found.diagnosis.answer);
}

/// Half a second of latency beside a drag: the fault is taken out before the drag is told.
#[test]
fn a_late_speed_is_told_beside_a_drag() {
    let late = changed(&recorded(0.069, "neutral_drag(force_n: 1500.0)"), "speed_m_s", |_, trace, index| {
        trace.get("speed_m_s").unwrap()[index.saturating_sub(6)]
    });
    let found = found(&late, &Options::default()).unwrap();
    assert!(named(&found, "latency") && named(&found, "neutral_drag"), "{}", found.diagnosis.answer);
}

/// A torque of three tenths of a second before was told as a speed that arrives late, by less than nothing.
#[test]
fn a_late_torque_is_told_as_that() {
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        _ => value + draws.normal(),
    };
    let channels = ["speed_m_s", "motor_torque_n_m"];
    let registry = headland_stock::registry();
    let sound = recording_of((0.069, ""), &registry, &channels, (29, &noisy));
    let late = changed(&sound, "motor_torque_n_m", |_, trace, index| {
        trace.get("motor_torque_n_m").unwrap()[index.saturating_sub(6)]
    });
    let found = found(&late, &Options::default()).unwrap();
    let [latency] = &found.diagnosis.findings[..] else { panic!("{}", found.diagnosis.answer) };
    assert!(
        latency.sentence.contains("a torque that arrives late against the speed"),
        "{}",
        latency.sentence
    );
    assert!((latency.parameters[0].value + 0.3).abs() < 0.05, "{:?}", latency.parameters);
}

/// A drive by hard braking and long stretches, so that a clock that is late by half a second at its end shows.
fn hard_driven() -> String {
    scenario(0.012, "", "")
        .replace("Reach(speed_m_s: 3, acceleration_m_s2: 0.4)", "Reach(speed_m_s: 3, acceleration_m_s2: 1.5)")
        .replace("Hold(for_s: 6)", "Hold(for_s: 25)")
}

/// The drives of it with these channels, one of which was logged by a clock that runs slow by a rate.
fn slowly_clocked(channels: &[&str], (slow, rate): (&str, f64)) -> Recording {
    let noisy = |name: &str, value: f64, draws: &mut Draws| match name {
        "speed_m_s" => value + 0.02 * draws.normal(),
        "tractive_force_n" => value + 60.0 * draws.normal(),
        "acceleration_m_s2" => value + 0.03 * draws.normal(),
        "position_m" => value + 0.1 * draws.normal(),
        _ => value,
    };
    let registry = headland_stock::registry();
    let mut sound = recording_of_scenario(&hard_driven(), &registry, channels, (23, &noisy));
    for run in &mut sound.runs {
        if let Some(felt) = run.trace.remove("acceleration_m_s2") {
            run.trace.push("specific_force_m_s2", felt.values, Origin::Measured).unwrap();
        }
    }
    changed(&sound, slow, |_, trace, index| {
        let (time_s, values) = (trace.time_s(), trace.get(slow).unwrap());
        let at = time_s[index] / (1.0 + rate);
        values[time_s.partition_point(|time| *time < at).min(time_s.len() - 1)]
    })
}

/// Checks that a clock that runs slow is told of the channel that it is one of, and nothing beside it.
fn assert_slow_clock(channels: &[&str], (slow, rate): (&str, f64)) {
    let recording = slowly_clocked(channels, (slow, rate));
    let registry = headland_stock::registry();
    let found = found_of_scenario(&hard_driven(), &recording, &Options::default(), &registry).unwrap();
    assert_eq!(ids(&found), ["clock_drift"], "{}", found.diagnosis.answer);
    let clock = &found.diagnosis.findings[0];
    assert_eq!(clock.depends_on, [slow], "{}", clock.sentence);
    assert!((clock.parameters[0].value / rate - 1.0).abs() < 0.1, "{:?}", clock.parameters);
}

/// The clock of a force falls behind by up to half a second: where the force of braking sets in late, nobody braked. Whose clock it is an
/// accelerometer says that goes with the speed.
#[test]
fn a_force_whose_clock_runs_slow_is_no_brake() {
    let channels = ["speed_m_s", "position_m", "heading_rad", "tractive_force_n", "acceleration_m_s2"];
    assert_slow_clock(&channels, ("tractive_force_n", 0.012));
}

/// Without an accelerometer places say so.
#[test]
fn places_say_that_a_force_is_the_one_whose_clock_runs_slow() {
    let channels = ["speed_m_s", "position_m", "heading_rad", "tractive_force_n"];
    assert_slow_clock(&channels, ("tractive_force_n", 0.012));
}

/// A switch that says when nothing drives goes with the speed, and the force that is recorded meanwhile is one of before: taken for nought
/// it would be lost, and what is lost was told as brakes.
#[test]
fn a_switch_says_that_a_force_is_the_one_whose_clock_runs_slow() {
    let channels = ["speed_m_s", "heading_rad", "tractive_force_n", "coasting"];
    assert_slow_clock(&channels, ("tractive_force_n", 0.012));
}

/// Nine passes to and fro over ground that firms, on a slope of which no map knows: levels of each run follow all of it, and say less.
#[test]
fn passes_on_a_slope_are_no_levels_of_each_run() {
    /// Between two points of the grid of factors.
    const FACTOR: f64 = 0.62;
    const GRADE: f64 = 0.011;
    let mut all: Option<Recording> = None;
    for pass in 1..=9_usize {
        let reversed = pass % 2 == 0;
        let grade = if reversed { -GRADE } else { GRADE };
        let hidden = format!(
            "multipass(coefficient: 0.034, factor: {FACTOR:?}, pass: {pass}.0), grade_constant(grade: {grade:?})"
        );
        let mut one = recorded(0.069, &hidden);
        let mut run = one.runs.swap_remove(usize::from(reversed));
        (run.id, run.reversed, run.held_out) = (format!("r{pass}"), reversed, [3, 6].contains(&pass));
        all.get_or_insert_with(|| Recording { runs: Vec::new(), ..one }).runs.push(run);
    }
    let found = found(&all.unwrap(), &Options::default()).unwrap();
    let mut told = ids(&found);
    told.sort_unstable();
    assert_eq!(told, ["grade_constant", "multipass"], "{}", found.diagnosis.answer);
    let value = |id: &str, name: &str| {
        let one = found.diagnosis.findings.iter().find(|one| one.id == id).unwrap();
        one.parameters.iter().find(|one| one.name == name).unwrap().value
    };
    assert!((value("multipass", "factor") - FACTOR).abs() < 0.02, "{}", found.diagnosis.answer);
    assert!((value("grade_constant", "grade") - GRADE).abs() < 0.001, "{}", found.diagnosis.answer);
}

/// Backward a vehicle accelerates as forward. Where the acceleration of short spurts was not the one that force and resistance make, 520 kg
/// on a loader that shuttles were told as a force sensor's scale.
#[test]
fn a_mass_is_told_backward_as_it_is_forward() {
    const EXTRA_KG: f64 = 1500.0;
    let shuttle = |effects: &str| {
        let text = scenario(0.069, effects, "");
        let (before, rest) = text.split_once("cycle: [").unwrap();
        let (_, after) = rest.split_once("effects: [").unwrap();
        let spurt = |speed: f64| {
            format!(
                "Reach(speed_m_s: {speed:?}, acceleration_m_s2: 1.2), Hold(for_s: 3), \
                 Reach(speed_m_s: 0.8, acceleration_m_s2: 1.2), Hold(for_s: 2), "
            )
        };
        let cycle: String = [2.0, 3.5, 2.5, 4.0, 1.8, 3.0, 2.2, 3.8].into_iter().map(spurt).collect();
        format!("{before}cycle: [{cycle}], effects: [{after}")
    };
    let registry = headland_stock::registry();
    let hidden = shuttle(&format!("mass(extra_mass_kg: {EXTRA_KG:?})"));
    let channels = ["speed_m_s", "tractive_force_n"];
    let noisy = |name: &str, value: f64, draws: &mut Draws| {
        value + draws.normal() * if name == "speed_m_s" { 0.02 } else { 100.0 }
    };
    let told_kg = |way: f64| {
        let sensor = |name: &str, value: f64, draws: &mut Draws| way * noisy(name, value, draws);
        let recording = recording_of_scenario(&hidden, &registry, &channels, (3, &sensor));
        let found = found_of_scenario(&shuttle(""), &recording, &Options::default(), &registry).unwrap();
        let mass = found.diagnosis.findings.iter().find(|one| one.id == "mass");
        mass.unwrap_or_else(|| panic!("{}", found.diagnosis.answer)).parameters[0].clone()
    };
    let (forward, backward) = (told_kg(1.0), told_kg(-1.0));
    for told in [&forward, &backward] {
        assert!(told.ci95[0] < EXTRA_KG && EXTRA_KG < told.ci95[1], "{told:?}");
    }
    assert!((backward.value / forward.value - 1.0).abs() < 0.02, "{forward:?} {backward:?}");
}
