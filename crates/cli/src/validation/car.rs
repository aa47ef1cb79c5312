//! The BMW i3: 28 trips in summer and winter.

use super::table::{line, table};
use super::vehicle::{Told, calibrated};
use crate::failure::Failure;
use crate::fitted::errors;
use crate::held::Pair;
use crate::page::short;
use crate::say::Say;
use headland_calibrate::statistics::{mean, median};
use headland_plugin::Registry;
use headland_recording::NoticeKind;
use headland_units::constants::STANDARD_GRAVITY_M_S2;
use std::fmt::Write;
use std::path::Path;

const TORQUE: &str = "motor_torque_n_m";
const POWER: &str = "battery_power_w";

/// The part of the page.
pub fn part(registry: &Registry, scenarios: &Path, say: Say) -> Result<String, Failure> {
    let told =
        calibrated(registry, &scenarios.join("bmw_i3.ron"), &scenarios.join("recordings/bmw_i3.ron"), say)?;
    let temperature = |pair: &Pair| short(temperature_c(pair));
    let missing = |pair: &Pair| short(missing_power_w(pair));
    let mut text = format!("## {}\n\n{}.\n\n", told.recording.about, told.scenario.about);
    text += &told.parameters();
    text.push('\n');
    text += &told.signals();
    let _ = writeln!(text, "\n{}", told.totals(POWER));
    text += &told.runs(POWER, &[("air °C", &temperature), ("battery power not modelled, W", &missing)]);
    let _ = writeln!(text, "\n### What is left over\n");
    text += &winter(&told);
    text += &slope(&told);
    text += &out_of_step(&told);
    text += &told.remarks();
    Ok(text)
}

fn temperature_c(pair: &Pair) -> f64 {
    let values = pair.measured.get("air_temperature_c").unwrap_or(&[]);
    let values: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    mean(&values)
}

/// Mean power that the battery gave and the model did not [W].
fn missing_power_w(pair: &Pair) -> f64 {
    pair.comparison.total(POWER).map_or(f64::NAN, |total| (total.measured - total.modelled) / total.covered_s)
}

fn winter(told: &Told) -> String {
    let points: Vec<(f64, f64)> = told
        .after
        .iter()
        .map(|pair| (temperature_c(pair), missing_power_w(pair)))
        .filter(|(temperature, power)| temperature.is_finite() && power.is_finite())
        .collect();
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    let (slope, correlation) = line(&x, &y);
    let middle = median(&x);
    let half = |cold: bool| -> Vec<f64> {
        points
            .iter()
            .filter(|(temperature, _)| (*temperature < middle) == cold)
            .map(|(_, power)| *power)
            .collect()
    };
    let sense = if slope < 0.0 { "more power the colder it is" } else { "no more power in the cold" };
    format!(
        "- **Battery power against air temperature.** Over {} trips the battery gives {} W a kelvin beyond the model \
         (correlation {}): {sense}. In the colder half of the trips (below {} °C) the model misses {} W on average, in the \
         warmer half {} W. Heating and air conditioning are not logged; this is what they look like.\n",
        points.len(),
        short(slope),
        short(correlation),
        short(middle),
        short(mean(&half(true))),
        short(mean(&half(false)))
    )
}

fn slope(told: &Told) -> String {
    let number = |path: &str| told.scenario.document().number(path).unwrap_or(f64::NAN);
    let per_torque = number("vehicle.driveline.gear_ratio") / number("vehicle.driveline.wheel_radius_m");
    let weight = told.value("mass_kg") * STANDARD_GRAVITY_M_S2;
    let rms: Vec<f64> =
        told.after.iter().filter_map(|pair| errors(pair, TORQUE)).map(|found| found.0).collect();
    let force = median(&rms) * per_torque;
    let mut text = format!(
        "- **Torque.** The residual of the middle trip is {} N m, a force of {} N at the wheels: as much as a grade of {} \
         %. The road's slope is not logged and the scenario is level.\n",
        short(median(&rms)),
        short(force),
        short(100.0 * force / weight)
    );
    if let Some(rows) = same_road(told) {
        text += "- **The same road again.** Where the residual belongs to the road, trips on one road repeat it. \
                 Correlation of the residual torque in stretches of 100 m between trips that share a path (at the best \
                 shift of the start, at most 1 km):\n\n";
        text += &table(&["trips", "stretches", "correlation", "shift m"], &rows);
        text.push('\n');
    }
    text
}

/// Length of a stretch [m], and the most of them that a start is shifted by.
const STRETCH_M: f64 = 100.0;
const MOST_SHIFT: usize = 10;

fn same_road(told: &Told) -> Option<Vec<Vec<String>>> {
    let mut rows = Vec::new();
    let path = |index: usize| told.recording.runs.get(index).and_then(|run| run.path.as_deref());
    let profiles: Vec<Vec<f64>> = told.after.iter().map(profile).collect();
    for one in 0..profiles.len() {
        for other in one + 1..profiles.len() {
            if path(one).is_none() || path(one) != path(other) {
                continue;
            }
            let Some((shift, correlation, stretches)) = best(&profiles[one], &profiles[other]) else {
                continue;
            };
            let name = |index: usize| told.after[index].comparison.run.clone();
            rows.push(vec![
                format!("{} and {}", name(one), name(other)),
                stretches.to_string(),
                short(correlation),
                short(shift * STRETCH_M),
            ]);
        }
    }
    (!rows.is_empty()).then_some(rows)
}

/// Mean residual torque by stretch of road; NaN where nothing was compared.
fn profile(pair: &Pair) -> Vec<f64> {
    let get = |trace: &headland_trace::Trace, name: &str| trace.get(name).unwrap_or(&[]).to_vec();
    let position = get(&pair.outcome.trace, "position_m");
    let (measured, modelled) = (get(&pair.measured, TORQUE), get(&pair.outcome.trace, TORQUE));
    let first = position.first().copied().unwrap_or(0.0);
    let mut sums: Vec<(f64, f64)> = Vec::new();
    for ((position, measured), modelled) in position.iter().zip(&measured).zip(&modelled) {
        let residual = modelled - measured;
        if !residual.is_finite() || !position.is_finite() {
            continue;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a place along a road, at least 0"
        )]
        let stretch = ((position - first) / STRETCH_M).max(0.0) as usize;
        if sums.len() <= stretch {
            sums.resize(stretch + 1, (0.0, 0.0));
        }
        sums[stretch].0 += residual;
        sums[stretch].1 += 1.0;
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// Shift in stretches, correlation, stretches.
fn best(one: &[f64], other: &[f64]) -> Option<(f64, f64, usize)> {
    let at = |shift_one: usize, shift_other: usize| {
        let pairs = one.iter().skip(shift_one).zip(other.iter().skip(shift_other));
        let (x, y): (Vec<f64>, Vec<f64>) =
            pairs.filter(|(x, y)| x.is_finite() && y.is_finite()).map(|(x, y)| (*x, *y)).unzip();
        let signed = shift_other as f64 - shift_one as f64;
        (x.len() > 2 * MOST_SHIFT).then(|| (signed, line(&x, &y).1, x.len()))
    };
    let ahead = (0..=MOST_SHIFT).filter_map(|shift| at(0, shift));
    let behind = (1..=MOST_SHIFT).filter_map(|shift| at(shift, 0));
    ahead.chain(behind).max_by(|a, b| a.1.total_cmp(&b.1))
}

fn out_of_step(told: &Told) -> String {
    let rms: Vec<f64> =
        told.after.iter().map(|pair| errors(pair, TORQUE).map_or(f64::NAN, |found| found.0)).collect();
    let limit = 2.0 * median(&rms);
    let far: Vec<String> = told
        .after
        .iter()
        .zip(&rms)
        .filter(|(_, rms)| **rms > limit)
        .map(|(pair, rms)| format!("{} ({} N m)", pair.comparison.run, short(*rms)))
        .collect();
    let noticed: Vec<String> = told
        .recording
        .notices
        .iter()
        .filter(|notice| notice.kind == NoticeKind::Lag && !notice.run.is_empty())
        .map(|notice| format!("  - {notice}"))
        .collect();
    if far.is_empty() && noticed.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "- **Logs with a fault.** Torque is off by more than twice the middle trip in: {}.",
        if far.is_empty() { "none".to_owned() } else { far.join(", ") }
    );
    if noticed.is_empty() {
        text.push('\n');
    } else {
        let _ = writeln!(text, " What the logs show of themselves:\n{}", noticed.join("\n"));
    }
    text
}
