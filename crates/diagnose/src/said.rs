//! What a model says of a recorded run, sample by sample.

use crate::DiagnoseError;
use crate::balance::Kind;
use crate::recorded::Recorded;
use crate::voltage::{residual_v, resistance_ohm};
use headland_sim::{Drive, Inputs, Model, Replay, replay};
use headland_trace::Trace;
use rayon::prelude::*;

/// What a model says of one run.
#[derive(Clone, Debug)]
pub struct Said {
    /// Force against the motion, inertia left out [N].
    pub resistance_n: Vec<f64>,
    /// Mass in inertia [kg].
    pub effective_mass_kg: Vec<f64>,
    /// Slope's part of the specific force [m/s²].
    pub slope_m_s2: Vec<f64>,
    /// Speed of the wheels' circumference [m/s].
    pub wheel_speed_m_s: Vec<f64>,
    /// Power from the battery [W].
    pub battery_w: Option<Vec<f64>>,
    /// Resistance of the battery [Ω].
    pub resistance_ohm: Option<f64>,
    /// What it leaves of the recorded voltage, fast parts only [V].
    pub voltage_left_v: Vec<f64>,
    /// Mass flow of fuel [kg/s].
    pub fuel_kg_s: Option<Vec<f64>>,
}

/// A window of no length: what acts at the recorded speed and force, sample by sample [s].
const POINTWISE_S: f64 = 0.0;

/// What a model says of every run; each may have a model of its own.
pub fn said(
    runs: &[Recorded],
    kinds: &[Kind],
    model_of: impl Fn(usize) -> Result<Model, DiagnoseError> + Sync,
) -> Result<Vec<Said>, DiagnoseError> {
    (0..runs.len()).into_par_iter().map(|run| say(&model_of(run)?, &runs[run], kinds)).collect()
}

fn say(model: &Model, run: &Recorded, kinds: &[Kind]) -> Result<Said, DiagnoseError> {
    let trace = &run.measured.trace;
    // Driven by the recorded force the model's own acceleration holds no noise of the recorded speed.
    let (drive, window_s) = match run.forward() {
        Some(forward) => (forward, Some(POINTWISE_S)),
        None => (Drive::Speed, None),
    };
    let how = Replay { also: inputs(trace, &run.measured.how), drive, window_s, ..run.measured.how.clone() };
    let replayed = |how: &Replay| {
        let failed = |error| DiagnoseError::Replay { run: run.measured.id.clone(), error };
        Ok::<_, DiagnoseError>(replay(model, trace, how).map_err(failed)?.trace)
    };
    let modelled = replayed(&how)?;
    let get = |name: &str| modelled.get(name).map_or_else(|| vec![f64::NAN; modelled.len()], <[f64]>::to_vec);
    let (tractive, acceleration, mass) =
        (get("tractive_force_n"), get("acceleration_m_s2"), get("effective_mass_kg"));
    let brake = modelled.get("brake_force_n");
    let resistance = |i: usize| tractive[i] - brake.map_or(0.0, |brake| brake[i]) - mass[i] * acceleration[i];
    let resistance_n = (0..tractive.len()).map(resistance).collect();
    let powers = kinds.iter().any(|kind| matches!(kind, Kind::Battery | Kind::Voltage | Kind::Fuel));
    let by_torque =
        trace.get("motor_torque_n_m").is_some() && model.driveline.force_of_torque_n(1.0, 1.0).is_some();
    let by_torque = (powers && by_torque)
        .then(|| replayed(&Replay { drive: Drive::Torque, window_s: Some(POINTWISE_S), ..how.clone() }))
        .transpose()?;
    let powered = by_torque.as_ref().unwrap_or(&modelled);
    let battery_w = match (powered.get("battery_voltage_v"), powered.get("battery_current_a")) {
        (Some(voltage), Some(current)) => Some(voltage.iter().zip(current).map(|(u, i)| u * i).collect()),
        _ => None,
    };
    let logged = |name: &str| trace.get(name).is_some();
    let resistance_ohm = (powers && logged("battery_voltage_v") && logged("battery_current_a"))
        .then(|| resistance_ohm(powered))
        .flatten();
    Ok(Said {
        voltage_left_v: resistance_ohm.map_or_else(Vec::new, |ohm| residual_v(run, ohm)),
        resistance_ohm,
        resistance_n,
        slope_m_s2: slope(model, &modelled, &mass),
        wheel_speed_m_s: get("wheel_speed_m_s"),
        battery_w,
        fuel_kg_s: powered.get("fuel_rate_kg_s").map(<[f64]>::to_vec),
        effective_mass_kg: mass,
    })
}

/// The slope's part of the specific force [m/s²]; slopes that effects add are slopes to an accelerometer as well.
fn slope(model: &Model, modelled: &Trace, mass_kg: &[f64]) -> Vec<f64> {
    let part = |grade: &f64| model.gravity_m_s2 * grade / grade.hypot(1.0);
    let mut slope: Vec<f64> = match modelled.get("grade") {
        Some(grade) => grade.iter().map(part).collect(),
        None => vec![f64::NAN; modelled.len()],
    };
    for name in ["grade_n", "grade_constant_n"] {
        for ((slope, force), mass) in slope.iter_mut().zip(modelled.get(name).unwrap_or(&[])).zip(mass_kg) {
            *slope -= force / mass;
        }
    }
    slope
}

/// Every recorded circumstance, whatever the scenario's replay is told.
fn inputs(trace: &Trace, how: &Replay) -> Vec<Inputs> {
    let mut also = how.also.clone();
    for input in [Inputs::Coasting, Inputs::Curvature, Inputs::AirTemperature, Inputs::Heading] {
        if !also.contains(&input) && input.whole(trace) {
            also.push(input);
        }
    }
    also
}
