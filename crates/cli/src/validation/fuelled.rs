//! Vehicles of which speed and fuel were recorded, once a second: the heavy truck on the road, the Camry on a dynamometer.

use super::table::{line, percent, table};
use super::vehicle::{More, Told, calibrated};
use crate::failure::Failure;
use crate::held::Pair;
use crate::page::short;
use crate::say::Say;
use headland_calibrate::statistics::mean;
use headland_plugin::Registry;
use std::fmt::Write;
use std::path::Path;

const FUEL: &str = "fuel_rate_kg_s";
/// Length of the blocks in which fuel is averaged [s].
const BLOCK_S: f64 = 30.0;

/// The truck: no slopes, no load.
pub fn truck(registry: &Registry, scenarios: &Path, say: Say) -> Result<String, Failure> {
    let told = calibrated(
        registry,
        &scenarios.join("class8_truck.ron"),
        &scenarios.join("recordings/class8_trucks.ron"),
        say,
    )?;
    let grade = |pair: &Pair| percent(grade_that_closes(&told, pair));
    let mut text = before_and_after(&told, &[("mean grade that would take the rest, %", &grade)]);
    text += &what_is_left(
        &told,
        "The rest is what a level road without a known load cannot say: the slopes are not in the log. The last column above \
         says how little of a slope, from end to end, would take what a run has too much or too little.",
    );
    text.push('\n');
    text += &told.remarks();
    Ok(text)
}

/// A vehicle that went less far has no grade [m].
const SHORTEST_WAY_M: f64 = 100.0;

/// The mean grade of a run that would take what the measured fuel is more than the modelled.
fn grade_that_closes(told: &Told, pair: &Pair) -> Option<f64> {
    let total = pair.comparison.total(FUEL)?;
    let driveline = |name: &str| told.scenario.document().number(&format!("vehicle.driveline.{name}"));
    let work_j = (total.measured - total.modelled)
        * driveline("lower_heating_value_j_kg")?
        * told.value("willans_efficiency")
        * driveline("transmission_efficiency")?;
    let travelled = pair.outcome.trace.get("position_m")?;
    let way_m = travelled.last()? - travelled.first()?;
    if way_m < SHORTEST_WAY_M {
        return None;
    }
    let gravity = told
        .scenario
        .document()
        .number("gravity_m_s2")
        .unwrap_or(headland_units::constants::STANDARD_GRAVITY_M_S2);
    Some(work_j / (told.value("mass_kg") * gravity * way_m))
}

/// The run of the Camry that begins cold, the one that begins with the same speeds once more when hot, and for how long [s].
const COLD_RUN: &str = "61811011_cold";
const HOT_RUN: &str = "61811011_hot";
const SAME_SPEEDS_S: f64 = 505.0;

/// The Camry: no slopes, no wind, no load; one run begins cold.
pub fn camry(registry: &Registry, scenarios: &Path, say: Say) -> Result<String, Failure> {
    let told = calibrated(
        registry,
        &scenarios.join("camry.ron"),
        &scenarios.join("recordings/camry_phases.ron"),
        say,
    )?;
    let mut text = before_and_after(&told, &[]);
    text += &what_is_left(&told, "The model shifts no gears and knows no temperature of the engine.");
    text += &by_power(&told);
    text.push('\n');
    let run = |name: &str| told.after.iter().find(|pair| pair.comparison.run == name);
    if let (Some(cold), Some(hot)) = (run(COLD_RUN), run(HOT_RUN)) {
        text += &cold_start(cold, hot);
    }
    text += &told.remarks();
    Ok(text)
}

/// The same speeds, cold and hot: the model knows no temperature.
fn cold_start(cold: &Pair, hot: &Pair) -> String {
    let grams = |pair: &Pair, values: &[f64]| -> f64 {
        let time = pair.measured.time_s();
        let within = |at: &usize| time[*at] < time[0] + SAME_SPEEDS_S && values[*at].is_finite();
        let step = |at: usize| time[(at + 1).min(time.len() - 1)] - time[at];
        (0..time.len()).filter(within).map(|at| 1e3 * values[at] * step(at)).sum()
    };
    let both = |pair: &Pair| {
        let (measured, modelled) = (pair.measured.get(FUEL)?, pair.outcome.trace.get(FUEL)?);
        Some((grams(pair, measured), grams(pair, modelled)))
    };
    let (Some(cold), Some(hot)) = (both(cold), both(hot)) else { return String::new() };
    let row = |what: &str, (measured, modelled): (f64, f64)| {
        vec![what.to_owned(), short(measured), short(modelled), percent(Some(modelled / measured - 1.0))]
    };
    let columns = ["the first 505 s of its first test", "measured g", "modelled g", "error %"];
    format!(
        "{}\nThe same speeds took {} % more fuel from a cold start than hot, which is what the model, without a \
         temperature, cannot say.\n\n",
        table(&columns, &[row("from a cold start", cold), row("once more, hot", hot)]),
        short(100.0 * (cold.0 / hot.0 - 1.0))
    )
}

/// Bounds of power at the wheels between which fuel is compared [W].
const BANDS_W: [f64; 4] = [1e3, 10e3, 20e3, 40e3];

/// Fuel by the power at the wheels: whether a test that was held out asks for what no fitted one did.
fn by_power(told: &Told) -> String {
    let sums = |held_out: bool, band: usize| -> Option<(f64, f64)> {
        let (mut measured_kg, mut modelled_kg) = (0.0, 0.0);
        let pairs = told.after.iter().filter(|pair| pair.comparison.run != COLD_RUN);
        for pair in pairs.filter(|pair| pair.held_out == held_out) {
            let channel = |name: &str| pair.outcome.trace.get(name);
            let (modelled, force, speed) =
                (channel(FUEL)?, channel("tractive_force_n")?, channel("speed_m_s")?);
            let (measured, time) = (pair.measured.get(FUEL)?, pair.measured.time_s());
            for at in 0..time.len().saturating_sub(1) {
                let power_w = force[at] * speed[at];
                let found = BANDS_W.iter().filter(|bound| power_w >= **bound).count();
                if found == band && measured[at].is_finite() && modelled[at].is_finite() {
                    let step_s = time[at + 1] - time[at];
                    measured_kg += measured[at] * step_s;
                    modelled_kg += modelled[at] * step_s;
                }
            }
        }
        Some((measured_kg, modelled_kg))
    };
    let kilowatts = |bound: &f64| short(bound / 1e3);
    let rows: Vec<Vec<String>> = (0..=BANDS_W.len())
        .map(|band| {
            let from = band.checked_sub(1).and_then(|below| BANDS_W.get(below)).map(kilowatts);
            let name = match (from, BANDS_W.get(band).map(kilowatts)) {
                (Some(from), Some(to)) => format!("{from} to {to}"),
                (Some(from), None) => format!("{from} and more"),
                (None, to) => format!("below {}", to.unwrap_or_default()),
            };
            let mut row = vec![name];
            for held_out in [false, true] {
                let (measured, modelled) = sums(held_out, band).unwrap_or_default();
                let error = (measured > 0.0).then(|| modelled / measured - 1.0);
                row.extend([
                    if measured > 0.0 { short(1e3 * measured) } else { "–".to_owned() },
                    percent(error),
                ]);
            }
            row
        })
        .collect();
    format!(
        "\n### By power at the wheels\n\nFuel of the hot tests, those that were fitted and the one that was not. The latter asks \
         for powers that no other does, and for more fuel at the same power, as an automatic transmission does that shifts \
         down for hard accelerations; the model has no gears. The engine's speed, which would prove it, is not in the log.\n\n{}",
        table(&["kW", "fitted: measured g", "error %", "held out: measured g", "error %"], &rows)
    )
}

fn before_and_after(told: &Told, more: &[More]) -> String {
    let mut text = format!("## {}\n\n{}.\n\n", told.recording.about, told.scenario.about);
    text += &told.parameters();
    text.push('\n');
    text += &told.signals();
    let _ = writeln!(text, "\n{}", told.totals(FUEL));
    text += &told.runs(FUEL, more);
    text
}

fn what_is_left(told: &Told, words: &str) -> String {
    let rows: Vec<Vec<String>> = [("before", &told.before), ("after", &told.after)]
        .into_iter()
        .map(|(name, pairs)| {
            let blocks = blocks(pairs);
            vec![
                name.to_owned(),
                blocks.len().to_string(),
                short(explained(&blocks)),
                short(correlation(&blocks)),
            ]
        })
        .collect();
    format!(
        "\n### What is left over\n\nFuel in blocks of 30 s: how much of its variance the model explains. {words}\n\n{}",
        table(&["", "blocks", "share of variance explained", "correlation"], &rows)
    )
}

/// Measured and modelled fuel of each block [kg/s].
fn blocks(pairs: &[Pair]) -> Vec<(f64, f64)> {
    let mut blocks = Vec::new();
    for pair in pairs {
        let (Some(measured), Some(modelled)) = (pair.measured.get(FUEL), pair.outcome.trace.get(FUEL)) else {
            continue;
        };
        let time = pair.measured.time_s();
        let mut from = 0;
        while from < time.len() {
            let end = time.partition_point(|at| *at < time[from] + BLOCK_S);
            let present: Vec<(f64, f64)> = (from..end)
                .map(|at| (measured[at], modelled[at]))
                .filter(|(one, other)| one.is_finite() && other.is_finite())
                .collect();
            if 2 * present.len() > end - from {
                let (one, other): (Vec<f64>, Vec<f64>) = present.into_iter().unzip();
                blocks.push((mean(&one), mean(&other)));
            }
            from = end;
        }
    }
    blocks
}

/// 1 − Σ(modelled − measured)² / Σ(measured − mean)².
fn explained(blocks: &[(f64, f64)]) -> f64 {
    let middle = mean(&blocks.iter().map(|(measured, _)| *measured).collect::<Vec<_>>());
    let error: f64 = blocks.iter().map(|(measured, modelled)| (modelled - measured).powi(2)).sum();
    let all: f64 = blocks.iter().map(|(measured, _)| (measured - middle).powi(2)).sum();
    1.0 - error / all
}

fn correlation(blocks: &[(f64, f64)]) -> f64 {
    let (measured, modelled): (Vec<f64>, Vec<f64>) = blocks.iter().copied().unzip();
    line(&measured, &modelled).1
}
