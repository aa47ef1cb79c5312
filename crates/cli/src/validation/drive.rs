//! The drive of the coast-down study, rebuilt from what it states, and which of the assumptions beside decides.

use super::table::{percent, table};
use crate::command::run::simulate_all;
use crate::failure::Failure;
use crate::page::short;
use headland_calibrate::statistics::{quantile_of_sorted, sorted};
use headland_compare::cdf_comparison;
use headland_plugin::Registry;
use headland_scenario::Scenario;
use headland_sim::Outcome;
use headland_trace::Trace;
use std::fmt::Write;
use std::path::Path;

/// What the study published of it, *Applied Sciences* 16 (2026) 1814: fuel simulated and measured [kg].
const SIMULATED_KG: f64 = 2.51;
const MEASURED_KG: f64 = 2.56;
/// Level of the band around a cumulative probability.
const ALPHA: f64 = 0.05;

/// A speed that was kept.
struct Kept {
    speed_m_s: f64,
    force_n: f64,
    engine_rad_s: f64,
    fuel_kg_s: f64,
}

/// The part of the page.
pub fn part(registry: &Registry, scenarios: &Path) -> Result<String, Failure> {
    let scenario = Scenario::read(&scenarios.join("study_drive.ron"), registry)?;
    let simulated = simulate_all(&scenario, registry)?;
    let Some((_, assumed)) = simulated.runs.first() else {
        return Err(Failure::Input("study_drive.ron has no runs".to_owned()));
    };
    let kept = kept(assumed);
    let (fuel_kg, time_s) = (fuel_kg(&assumed.trace), duration_s(&assumed.trace));
    let mut text = format!(
        "## The drive of the coast-down study\n\n{}. The study gives {MEASURED_KG} kg of fuel measured and {SIMULATED_KG} kg simulated \
         ({} %), and the speeds; it gives no duration, no speed over time, no fuel map and no ratios of the transmission as numbers. \
         **So its fuel is no test that this rebuilding could pass or fail**: what stands here is what its statements and our \
         assumptions make together, and which of them decide.\n\n",
        scenario.about,
        percent(Some(SIMULATED_KG / MEASURED_KG - 1.0))
    );
    let rows: Vec<Vec<String>> = kept.iter().map(row).collect();
    text += &table(
        &["speed km/h", "traction kN", "power at the wheels kW", "engine rpm", "fuel kg/h", "fuel kg/km"],
        &rows,
    );
    let _ = writeln!(
        text,
        "\nThe whole drive takes {} kg in {} s. The unknown duration decides: at this mean rate, {} kg/h, the simulated {SIMULATED_KG} kg are \
         burnt in {} s and the measured {MEASURED_KG} kg in {} s. One assumption changed at a time:\n",
        short(fuel_kg),
        short(time_s),
        short(3600.0 * fuel_kg / time_s),
        short(SIMULATED_KG / fuel_kg * time_s),
        short(MEASURED_KG / fuel_kg * time_s),
    );
    let changes: Vec<Vec<String>> = simulated
        .runs
        .iter()
        .map(|(id, outcome)| {
            let own = self::fuel_kg(&outcome.trace);
            vec![format!("`{id}`"), short(own), percent(Some(own / fuel_kg - 1.0))]
        })
        .collect();
    text += &table(&["run of `scenarios/study_drive.ron`", "fuel kg", "change %"], &changes);
    let worst =
        simulated.runs.iter().map(|(_, outcome)| (self::fuel_kg(&outcome.trace) / fuel_kg - 1.0).abs());
    let _ = writeln!(
        text,
        "\nAn assumption moves the fuel by up to {} %, the study's two figures are {} % apart: without its maps nobody can say from \
         these figures which model is right.\n",
        short(100.0 * worst.fold(0.0, f64::max)),
        short(100.0 * (1.0 - SIMULATED_KG / MEASURED_KG)),
    );
    text += &traction(&scenario, assumed);
    Ok(text)
}

fn row(kept: &Kept) -> Vec<String> {
    vec![
        short(3.6 * kept.speed_m_s),
        short(1e-3 * kept.force_n),
        short(1e-3 * kept.force_n * kept.speed_m_s),
        short(kept.engine_rad_s * 30.0 / std::f64::consts::PI),
        short(3600.0 * kept.fuel_kg_s),
        short(1e3 * kept.fuel_kg_s / kept.speed_m_s),
    ]
}

/// What the phases that keep a speed come to in their end.
fn kept(outcome: &Outcome) -> Vec<Kept> {
    let column = |name: &str| outcome.trace.get(name).unwrap_or_default();
    let (speed, force) = (column("speed_m_s"), column("tractive_force_n"));
    let (engine, fuel) = (column("engine_speed_rad_s"), column(FUEL));
    let mut kept: Vec<Kept> = Vec::new();
    for at in STEADY..speed.len() {
        let steady = (speed[at] - speed[at - STEADY]).abs() < STEADY_M_S && speed[at] > STEADY_M_S;
        if !steady {
            continue;
        }
        let now =
            Kept { speed_m_s: speed[at], force_n: force[at], engine_rad_s: engine[at], fuel_kg_s: fuel[at] };
        match kept.last_mut() {
            Some(last) if (last.speed_m_s - now.speed_m_s).abs() < STEADY_M_S => *last = now,
            _ => kept.push(now),
        }
    }
    kept
}

/// Rows and change of speed [m/s] of what counts as kept: 20 s of the scenario's step.
const STEADY: usize = 400;
const STEADY_M_S: f64 = 1e-3;
const FUEL: &str = "fuel_rate_kg_s";

fn duration_s(trace: &Trace) -> f64 {
    trace.time_s().last().copied().unwrap_or(f64::NAN)
}

/// Fuel by trapezoids.
fn fuel_kg(trace: &Trace) -> f64 {
    let (time, rate) = (trace.time_s(), trace.get(FUEL).unwrap_or_default());
    time.array_windows()
        .zip(rate.array_windows())
        .map(|([t0, t1], [r0, r1]): (&[f64; 2], &[f64; 2])| 0.5 * (t1 - t0) * (r0 + r1))
        .sum()
}

/// The modelled traction against the study's own equation at the same speeds, by cumulative probability.
fn traction(scenario: &Scenario, outcome: &Outcome) -> String {
    let number = |path: &str| scenario.document().number(path).unwrap_or(f64::NAN);
    let (mass, c_w) = (number("vehicle.mass_kg"), number("ground.soil.coefficient"));
    let (area, density) = (number("vehicle.drag_area_m2"), number("air.density_kg_m3"));
    let column = |name: &str| outcome.trace.get(name).unwrap_or_default();
    let (speed, acceleration) = (column("speed_m_s"), column("acceleration_m_s2"));
    let modelled: Vec<f64> = column("tractive_force_n")
        .iter()
        .zip(column("brake_force_n").iter().copied().chain(std::iter::repeat(0.0)))
        .map(|(force, brake)| force - brake)
        .collect();
    let formula: Vec<f64> = speed
        .iter()
        .zip(acceleration)
        .map(|(v, a)| {
            let rolling = c_w * (1.0 + 3.6 * v / 100.0) * mass * STUDY_GRAVITY;
            mass * a + 0.5 * density * area * v * v + rolling
        })
        .collect();
    // At rest nothing rolls.
    let moving = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(speed).filter(|(_, speed)| **speed > STEADY_M_S).map(|(value, _)| *value).collect()
    };
    let (formula, modelled) = (moving(&formula), moving(&modelled));
    let area = cdf_comparison(&formula, &modelled, ALPHA).map_or(f64::NAN, |told| told.area);
    let (formula, modelled) = (sorted(&formula), sorted(&modelled));
    let rows: Vec<Vec<String>> = SHARES
        .iter()
        .map(|share| {
            let (one, other) = (quantile_of_sorted(&formula, *share), quantile_of_sorted(&modelled, *share));
            vec![format!("{} %", short(100.0 * share)), short(1e-3 * one), short(1e-3 * other)]
        })
        .collect();
    format!(
        "Traction over this drive against the study's own equation at the same speeds, m a + F_air + c_w (1 + v/100) G with v in km/h, \
         by cumulative probability: {} N of area between the two curves.\n\n{}\nThat says that the program computes what the study wrote; \
         the traction that was measured is not published as numbers.\n",
        short(area),
        table(&["share of the samples below", "equation kN", "modelled kN"], &rows)
    )
}

/// Where the cumulative curves are told.
const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// As the study has it [m/s²].
const STUDY_GRAVITY: f64 = 9.81;
