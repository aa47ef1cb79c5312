//! Vehicles of which speed and fuel were recorded, once a second: the heavy truck on the road, the Camry on a dynamometer.

use super::table::{line, percent, table};
use super::vehicle::{Told, calibrated};
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
    let mut text = before_and_after(&told);
    text += &what_is_left(
        &told,
        "The rest is what a level road without a known load cannot say: the slopes are not in the log.",
    );
    text.push('\n');
    text += &told.remarks();
    Ok(text)
}

/// The run of the Camry that begins cold, and what of it was driven once more when hot [s].
const COLD_RUN: &str = "61811011";
const COLD_S: (f64, f64) = (0.0, 505.0);
const HOT_S: (f64, f64) = (1974.0, 2479.0);

/// The Camry: no slopes, no wind, no load; one run begins cold.
pub fn camry(registry: &Registry, scenarios: &Path, say: Say) -> Result<String, Failure> {
    let told = calibrated(
        registry,
        &scenarios.join("camry.ron"),
        &scenarios.join("recordings/camry_dyno.ron"),
        say,
    )?;
    let mut text = before_and_after(&told);
    text += &what_is_left(&told, "The model shifts no gears and knows no temperature of the engine.");
    text.push('\n');
    if let Some(cold) = told.after.iter().find(|pair| pair.comparison.run == COLD_RUN) {
        text += &cold_start(cold);
    }
    text += &told.remarks();
    Ok(text)
}

/// The same 505 s, cold and hot: the model knows no temperature.
fn cold_start(pair: &Pair) -> String {
    let (Some(measured), Some(modelled)) = (pair.measured.get(FUEL), pair.outcome.trace.get(FUEL)) else {
        return String::new();
    };
    let time = pair.measured.time_s();
    let grams = |values: &[f64], (from, to): (f64, f64)| -> f64 {
        let within = |at: &usize| (from..to).contains(&time[*at]) && values[*at].is_finite();
        let step = |at: usize| time[(at + 1).min(time.len() - 1)] - time[at];
        (0..time.len()).filter(within).map(|at| 1e3 * values[at] * step(at)).sum()
    };
    let row = |what: &str, span| {
        let (one, other) = (grams(measured, span), grams(modelled, span));
        vec![what.to_owned(), short(one), short(other), percent(Some(other / one - 1.0))]
    };
    let columns = ["the first 505 s of its first run", "measured g", "modelled g", "error %"];
    let cold = grams(measured, COLD_S) / grams(measured, HOT_S) - 1.0;
    format!(
        "{}\nThe same speeds took {} % more fuel from a cold start than hot, which is what the model, without a \
         temperature, cannot say.\n\n",
        table(&columns, &[row("from a cold start", COLD_S), row("once more, hot", HOT_S)]),
        short(100.0 * cold)
    )
}

fn before_and_after(told: &Told) -> String {
    let mut text = format!("## {}\n\n{}.\n\n", told.recording.about, told.scenario.about);
    text += &told.parameters();
    text.push('\n');
    text += &told.signals();
    let _ = writeln!(text, "\n{}", told.totals(FUEL));
    text += &told.runs(FUEL, &[]);
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
