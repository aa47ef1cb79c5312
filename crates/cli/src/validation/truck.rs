//! The heavy truck: speed and fuel, once a second.

use super::table::{line, table};
use super::vehicle::calibrated;
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

/// The part of the page.
pub fn part(registry: &Registry, scenarios: &Path, say: Say) -> Result<String, Failure> {
    let told = calibrated(
        registry,
        &scenarios.join("class8_truck.ron"),
        &scenarios.join("recordings/class8_trucks.ron"),
        say,
    )?;
    let mut text = format!("## {}\n\n{}.\n\n", told.recording.about, told.scenario.about);
    text += &told.parameters();
    text.push('\n');
    text += &told.signals();
    let _ = writeln!(text, "\n{}", told.totals(FUEL));
    text += &told.runs(FUEL, &[]);
    let _ = writeln!(text, "\n### What is left over\n");
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
    text += "Fuel in blocks of 30 s: how much of its variance the model explains. The rest is what a level road without a \
             known load cannot say: the slopes are not in the log.\n\n";
    text += &table(&["", "blocks", "share of variance explained", "correlation"], &rows);
    text.push('\n');
    text += &told.remarks();
    Ok(text)
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
