//! Faults of sensors and logs.

use crate::case::{amount, every_second};
use crate::dice::Dice;
use crate::family::{Family, Needs};
use crate::plan::Plan;
use crate::sensor::Artefact;

/// The faults of the `number`th faulty case, and what they need of the recording: every fourth case has two.
pub fn choose(family: Family, number: usize, needs: &mut Needs, dice: &mut Dice) -> Vec<&'static str> {
    const IDS: [&str; 9] = [
        "latency",
        "accelerometer_bias",
        "speed_scale",
        "force_scale",
        "stuck_channel",
        "quantisation",
        "clock_drift",
        "accelerometer_tilt",
        "dropout",
    ];
    // Families go round every four cases and faults every nine, so that every fault meets every family.
    let first = IDS[number % IDS.len()];
    let mut ids = vec![first];
    while number % 4 == 3 && ids.len() < 2 {
        let other = IDS[dice.below(IDS.len())];
        if other != first {
            ids.push(other);
        }
    }
    for id in &ids {
        match *id {
            "accelerometer_bias" | "accelerometer_tilt" => needs.accelerometer = true,
            "force_scale" => needs.force = true,
            "speed_scale" => {
                needs.position = true;
                needs.wheel_speed = family == Family::Transport;
            }
            _ => {}
        }
    }
    ids
}

/// Draws a fault for a plan.
pub fn draw(id: &'static str, plan: &Plan, dice: &mut Dice) -> Artefact {
    let electric = plan.vehicle.electric.is_some();
    let drive = if electric {
        "motor_torque_n_m"
    } else if plan.has("tractive_force_n") {
        "tractive_force_n"
    } else {
        "engine_torque_n_m"
    };
    // What a family logs beside speed: a fault is as likely to hit one channel as another.
    let others: Vec<&'static str> =
        ["motor_torque_n_m", "tractive_force_n", "battery_current_a", "fuel_rate_kg_s", "wheel_speed_m_s"]
            .into_iter()
            .filter(|name| plan.has(name))
            .collect();
    let any = |dice: &mut Dice| {
        if dice.chance(0.5) || others.is_empty() { "speed_m_s" } else { others[dice.below(others.len())] }
    };
    let none = Artefact { id, channels: Vec::new(), amount: 0.0, spells: Vec::new(), told: Vec::new() };
    let of = |channels: Vec<&'static str>, value: f64, name: &str, unit: &str| Artefact {
        channels,
        amount: value,
        told: amount(name, value, unit),
        ..none.clone()
    };
    let runs = plan.runs.len();
    let seconds = if plan.family == "coast" { 4.5 } else { plan.runs[0].stop.after_s };
    match id {
        "latency" => {
            let late = if electric { dice.within(0.25, 0.8) } else { dice.within(0.12, 0.4) };
            of(vec![any(dice)], late, "latency_s", "s")
        }
        // Scales are told as a recording describes them: measured over true.
        "speed_scale" => scaled(of(vec!["speed_m_s"], dice.sign() * dice.within(0.02, 0.06), "scale", "1")),
        "force_scale" => scaled(of(vec![drive], dice.sign() * dice.within(0.05, 0.14), "scale", "1")),
        "accelerometer_bias" => {
            of(vec!["specific_force_m_s2"], dice.sign() * dice.within(0.06, 0.3), "bias_m_s2", "m/s²")
        }
        "accelerometer_tilt" => {
            let gain = dice.within(0.004, 0.012);
            let total = gain + plan.vehicle.pitch_gain_rad_s2_m;
            let mut tilt = of(vec!["specific_force_m_s2"], total, "pitch_rad_s2_m", "rad s²/m");
            tilt.amount = gain * plan.vehicle.gravity_m_s2;
            tilt
        }
        "clock_drift" => {
            let channel = if others.is_empty() { drive } else { others[dice.below(others.len())] };
            let rate = if electric { dice.within(0.002, 0.006) } else { dice.within(0.005, 0.012) };
            of(vec![channel], dice.sign() * rate, "rate", "1")
        }
        "quantisation" => match any(dice) {
            "speed_m_s" => of(vec!["speed_m_s"], dice.within(0.2, 0.5), "step_m_s", "m/s"),
            // Ten to twenty-five times what is usual.
            channel => {
                let usual = plan.sensor(channel).map_or(1.0, |sensor| sensor.step.max(0.3 * sensor.white));
                of(vec![channel], usual * dice.within(10.0, 25.0), "step", "its own")
            }
        },
        "dropout" => {
            let held = if dice.chance(0.5) { 1.0 } else { 0.0 };
            let spells = every_second(runs, |_| {
                let from = dice.within(1.0, 0.6 * seconds);
                (from, from + dice.within(0.06, 0.14) * seconds.min(30.0), held)
            });
            Artefact { channels: vec![any(dice)], spells, ..none }
        }
        _ => {
            let channel = any(dice);
            let spells = every_second(runs, |_| {
                let from = dice.within(1.0, 0.5 * seconds);
                (from, from + dice.within(0.2, 0.35) * seconds, 1.0)
            });
            Artefact { channels: vec![channel], spells, ..none }
        }
    }
}

fn scaled(mut fault: Artefact) -> Artefact {
    for told in &mut fault.told {
        told.value += 1.0;
    }
    fault
}
