//! The balances: what was measured against what the model says, row by row.

use crate::noise::Shape;
use crate::rows::{Chunk, chunks};
use crate::{DiagnoseError, gram::Column};
use headland_calibrate::study::{Measured, Study};
use headland_plugin::Registry;
use headland_scenario::Scenario;
use headland_sim::{Drive, Inputs, LocalFit, Model, Replay, local_fit, replay};
use headland_trace::Trace;
use nalgebra::DVector;
use rayon::prelude::*;
use serde::Serialize;

/// Which balance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Specific force against acceleration and slope.
    Parity,
    /// Wheel speed against speed over ground.
    Slip,
    /// Forces against the change of momentum.
    Motion,
    /// Engine power against power at the wheels.
    Shaft,
    /// Battery power against what drives and auxiliaries take.
    Battery,
    /// Fuel against the engine's work.
    Fuel,
}

impl Kind {
    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parity => "parity",
            Self::Slip => "slip",
            Self::Motion => "motion",
            Self::Shaft => "shaft",
            Self::Battery => "battery",
            Self::Fuel => "fuel",
        }
    }

    /// Unit of its residual.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Parity => "m/s²",
            Self::Slip => "m/s",
            Self::Motion => "N",
            Self::Shaft | Self::Battery | Self::Fuel => "W",
        }
    }

    /// From the ground up: a mismatch lives in the first that does not close.
    pub const ORDER: [Self; 5] = [Self::Parity, Self::Slip, Self::Motion, Self::Battery, Self::Fuel];
}

/// One recorded run with its motion.
#[derive(Clone, Debug)]
pub struct Drive0 {
    /// The run.
    pub measured: Measured,
    /// Smoothed speed and acceleration.
    pub motion: LocalFit,
    /// Acceleration that the recorded force and the nominal model make [m/s²]; the recorded one where no force is known.
    ///
    /// Regressors are made of it: made of the recorded acceleration they would explain their own noise.
    pub acceleration_m_s2: Vec<f64>,
    /// Position along the path [m].
    pub position_m: Vec<f64>,
    /// The ground that it drove over: runs of the same number share it.
    pub path: usize,
    /// How many runs drove this path before.
    pub pass: usize,
    /// Force at the wheels that was measured [N]; NaN where it is not known.
    pub force_n: Option<Vec<f64>>,
}

/// A balance over all runs.
pub struct Balance {
    /// Which.
    pub kind: Kind,
    /// Rows of all runs, those held out among them.
    pub chunks: Vec<Chunk>,
    /// Covariance of sensor noise.
    pub shape: Shape,
    /// Measured minus modelled, with the nominal model.
    pub residual: Column,
}

/// What a model says of one run, sample by sample.
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
    /// Power in the fuel [W], as its mass flow times a constant.
    pub fuel_kg_s: Option<Vec<f64>>,
}

impl Balance {
    /// The residual of other recordings of the same runs, on the same rows.
    pub fn residual_of(&self, drives: &[Drive0], said: &[Said]) -> Column {
        let of = |chunk: &Chunk| residual(self.kind, &drives[chunk.run], &said[chunk.run], chunk);
        self.chunks.iter().map(of).collect()
    }
}

/// Below this speed friction at rest decides, and no balance of motion holds [m/s].
const SLOWEST_M_S: f64 = 0.4;
/// Rows wanted of a run.
const ROWS_PER_RUN: f64 = 300.0;
/// Window of the forward replay that gives powers at recorded torque [s].
const POWER_WINDOW_S: f64 = 1.0;
/// Window of the forward replay that gives resistances at recorded force [s].
const MOTION_WINDOW_S: f64 = 0.5;
/// Lower heating value that turns fuel into watts in residuals [J/kg]: diesel, EN 590; a scale only.
pub const FUEL_J_KG: f64 = 42.8e6;

/// Prepares the runs of a study.
pub fn drives(study: &Study, recording: &headland_recording::Recording, model: &Model) -> Vec<Drive0> {
    let mut paths: Vec<Option<String>> = Vec::new();
    let mut passes: Vec<usize> = Vec::new();
    let mut all = Vec::new();
    for (measured, recorded) in study.runs.iter().zip(&recording.runs) {
        let path = match &recorded.path {
            Some(path) => paths.iter().position(|known| known.as_ref() == Some(path)),
            None => None,
        };
        let path = path.unwrap_or_else(|| {
            paths.push(recorded.path.clone());
            passes.push(0);
            paths.len() - 1
        });
        let pass = passes[path];
        passes[path] += 1;
        let time_s = measured.trace.time_s();
        let speed = measured.trace.get("speed_m_s").map(<[f64]>::to_vec).unwrap_or_default();
        let motion = local_fit(time_s, &speed, measured.how.smoothing_s);
        let force_n = force(&measured.trace, model, &motion.value);
        all.push(Drive0 {
            position_m: Vec::new(),
            acceleration_m_s2: motion.slope.clone(),
            motion,
            path,
            pass,
            force_n,
            measured: measured.clone(),
        });
    }
    all
}

/// The force at the wheels that a recording knows.
fn force(trace: &Trace, model: &Model, speed: &[f64]) -> Option<Vec<f64>> {
    let mut force = match (
        trace.get("tractive_force_n"),
        trace.get("motor_torque_n_m"),
        trace.get("engine_torque_n_m"),
    ) {
        (Some(force), _, _) => Some(force.to_vec()),
        (None, Some(torque), _) | (None, None, Some(torque)) => {
            let of = |(torque, speed): (&f64, &f64)| model.driveline.force_of_torque_n(*torque, *speed);
            torque.iter().zip(speed).map(of).collect::<Option<Vec<f64>>>()
        }
        _ => None,
    };
    if let Some(coasting) = trace.get("coasting") {
        let free = |value: f64| value >= 0.5;
        match &mut force {
            Some(force) => {
                for (force, coasting) in force.iter_mut().zip(coasting) {
                    if free(*coasting) {
                        *force = 0.0;
                    }
                }
            }
            None if coasting.iter().any(|value| free(*value)) => {
                force =
                    Some(coasting.iter().map(|value| if free(*value) { 0.0 } else { f64::NAN }).collect());
            }
            None => {}
        }
    }
    force
}

/// What the model says of every run. `text` gives the scenario's document for a run.
pub fn said(
    registry: &Registry,
    drives: &[Drive0],
    kinds: &[Kind],
    scenario_of: impl Fn(usize) -> Result<Model, DiagnoseError> + Sync,
    trace_of: impl Fn(usize) -> Option<Trace> + Sync,
) -> Result<Vec<Said>, DiagnoseError> {
    let _ = registry;
    (0..drives.len())
        .into_par_iter()
        .map(|index| {
            let drive = &drives[index];
            let model = scenario_of(index)?;
            let changed = trace_of(index);
            say(&model, drive, changed.as_ref().unwrap_or(&drive.measured.trace), kinds)
        })
        .collect()
}

fn say(model: &Model, drive: &Drive0, trace: &Trace, kinds: &[Kind]) -> Result<Said, DiagnoseError> {
    // Driven by the recorded force the model's own acceleration holds no noise of the recorded speed.
    let how = match forward(drive) {
        Some(forward) => {
            Replay { drive: forward, window_s: Some(MOTION_WINDOW_S), ..drive.measured.how.clone() }
        }
        None => Replay { drive: Drive::Speed, window_s: None, ..drive.measured.how.clone() },
    };
    let how = Replay { also: inputs(trace, &how), ..how };
    let failed = |error| DiagnoseError::Replay { run: drive.measured.id.clone(), error };
    let modelled = replay(model, trace, &how).map_err(failed)?.trace;
    let unknown = || vec![f64::NAN; modelled.len()];
    let get = |name: &str| modelled.get(name).map_or_else(unknown, <[f64]>::to_vec);
    let (tractive, acceleration, mass) =
        (get("tractive_force_n"), get("acceleration_m_s2"), get("effective_mass_kg"));
    let brake = modelled.get("brake_force_n").map_or_else(|| vec![0.0; tractive.len()], <[f64]>::to_vec);
    let resistance_n =
        (0..tractive.len()).map(|i| tractive[i] - brake[i] - mass[i] * acceleration[i]).collect();
    let mut slope_m_s2: Vec<f64> =
        get("grade").iter().map(|grade| model.gravity_m_s2 * grade / grade.hypot(1.0)).collect();
    // Slopes that effects add are slopes to an accelerometer as well.
    for name in ["grade_n", "grade_constant_n"] {
        for ((slope, force), mass) in slope_m_s2.iter_mut().zip(modelled.get(name).unwrap_or(&[])).zip(&mass)
        {
            *slope -= force / mass;
        }
    }
    let powers = kinds.iter().any(|kind| matches!(kind, Kind::Battery | Kind::Fuel));
    let by_torque =
        trace.get("motor_torque_n_m").is_some() && model.driveline.force_of_torque_n(1.0, 1.0).is_some();
    let powered = if powers && by_torque {
        let how = Replay { drive: Drive::Torque, window_s: Some(POWER_WINDOW_S), ..how };
        replay(model, trace, &how).map_err(failed)?.trace
    } else {
        modelled.clone()
    };
    let battery_w = match (powered.get("battery_voltage_v"), powered.get("battery_current_a")) {
        (Some(voltage), Some(current)) => Some(voltage.iter().zip(current).map(|(u, i)| u * i).collect()),
        _ => None,
    };
    let fuel_kg_s = powered.get("fuel_rate_kg_s").map(<[f64]>::to_vec);
    Ok(Said {
        resistance_n,
        effective_mass_kg: mass,
        slope_m_s2,
        wheel_speed_m_s: get("wheel_speed_m_s"),
        battery_w,
        fuel_kg_s,
    })
}

/// What can drive a run forward.
pub fn forward(drive: &Drive0) -> Option<Drive> {
    let trace = &drive.measured.trace;
    let coasts = trace.get("coasting").is_some_and(|values| values.iter().all(|value| *value >= 0.5));
    if coasts {
        Some(Drive::Coast)
    } else if trace.get("tractive_force_n").is_some() {
        Some(Drive::Force)
    } else if trace.get("motor_torque_n_m").is_some() && drive.force_n.is_some() {
        Some(Drive::Torque)
    } else {
        None
    }
}

/// Every recorded circumstance, whatever the scenario's replay is told.
fn inputs(trace: &Trace, how: &Replay) -> Vec<Inputs> {
    let whole =
        |name: &&str| trace.get(name).is_some_and(|values| values.iter().all(|value| value.is_finite()));
    let mut also = how.also.clone();
    for input in [Inputs::Coasting, Inputs::Curvature, Inputs::AirTemperature, Inputs::Heading] {
        if !also.contains(&input) && input.channels().iter().all(&whole) {
            also.push(input);
        }
    }
    also
}

/// The balances that the channels allow.
pub fn kinds(drives: &[Drive0], said: &[Said]) -> Vec<Kind> {
    let any = |test: &dyn Fn(&Drive0, &Said) -> bool| {
        drives.iter().zip(said).any(|(drive, said)| test(drive, said))
    };
    let has = |drive: &Drive0, name: &str| drive.measured.trace.get(name).is_some();
    Kind::ORDER
        .into_iter()
        .filter(|kind| match kind {
            Kind::Parity => any(&|drive, _| has(drive, "specific_force_m_s2")),
            Kind::Slip => any(&|drive, _| has(drive, "wheel_speed_m_s")),
            Kind::Motion => any(&|drive, _| drive.force_n.is_some()),
            Kind::Battery => any(&|drive, said| has(drive, "battery_power_w") && said.battery_w.is_some()),
            Kind::Fuel => any(&|drive, said| has(drive, "fuel_rate_kg_s") && said.fuel_kg_s.is_some()),
            Kind::Shaft => false,
        })
        .collect()
}

/// Length of a block: short enough to see what happens, long enough to hold two samples.
pub fn block_s(drives: &[Drive0]) -> f64 {
    let mut durations: Vec<f64> = drives.iter().map(|drive| drive.measured.trace.duration_s()).collect();
    durations.sort_by(f64::total_cmp);
    let median = durations.get(durations.len() / 2).copied().unwrap_or(1.0);
    let period = drives.iter().map(period_s).fold(0.0, f64::max);
    (median / ROWS_PER_RUN).max(0.04).min(1.0_f64.max(2.0 * period)).max(2.0 * period)
}

fn period_s(drive: &Drive0) -> f64 {
    drive.measured.trace.duration_s() / (drive.measured.trace.len().max(2) - 1) as f64
}

/// Builds a balance.
pub fn balance(kind: Kind, drives: &[Drive0], said: &[Said], block_s: f64, allowed: &[Vec<bool>]) -> Balance {
    let mut all = Vec::new();
    for (index, (drive, said)) in drives.iter().zip(said).enumerate() {
        let mut usable = usable(kind, drive, said);
        for (usable, allowed) in usable.iter_mut().zip(&allowed[index]) {
            *usable &= allowed;
        }
        all.extend(chunks(index, drive.measured.trace.time_s(), &usable, block_s));
    }
    let shape =
        if matches!(kind, Kind::Motion | Kind::Parity) { Shape::Differenced } else { Shape::Averaged };
    let residual = all
        .iter()
        .map(|chunk| {
            let (drive, said) = (&drives[chunk.run], &said[chunk.run]);
            residual(kind, drive, said, chunk)
        })
        .collect();
    Balance { kind, chunks: all, shape, residual }
}

fn usable(kind: Kind, drive: &Drive0, said: &Said) -> Vec<bool> {
    let trace = &drive.measured.trace;
    let channel = |name: &str| trace.get(name);
    let speed = channel("speed_m_s").unwrap_or(&[]);
    let braked = channel("brake");
    (0..trace.len())
        .map(|i| {
            let moving = drive.motion.value[i].abs() > SLOWEST_M_S && speed[i].is_finite();
            let finite = |values: Option<&[f64]>| values.is_some_and(|values| values[i].is_finite());
            match kind {
                Kind::Motion => {
                    moving
                        && finite(drive.force_n.as_deref())
                        && said.resistance_n[i].is_finite()
                        && drive.measured.compared[i]
                        && braked.is_none_or(|brake| brake[i] < 0.5)
                }
                Kind::Parity => moving && finite(channel("specific_force_m_s2")),
                Kind::Slip => {
                    moving && finite(channel("wheel_speed_m_s")) && finite(Some(&said.wheel_speed_m_s))
                }
                Kind::Battery => finite(channel("battery_power_w")) && finite(said.battery_w.as_deref()),
                Kind::Fuel => {
                    finite(channel("fuel_rate_kg_s"))
                        && finite(said.fuel_kg_s.as_deref())
                        && drive.measured.compared[i]
                }
                Kind::Shaft => false,
            }
        })
        .collect()
}

pub fn residual(kind: Kind, drive: &Drive0, said: &Said, chunk: &Chunk) -> DVector<f64> {
    let trace = &drive.measured.trace;
    let time_s = trace.time_s();
    let zero = vec![0.0; trace.len()];
    let channel = |name: &str| trace.get(name).unwrap_or(&zero);
    let one = |row: &crate::rows::Row| match kind {
        Kind::Motion => {
            let force = drive.force_n.as_deref().unwrap_or(&zero);
            let slope = row.slope(time_s, channel("speed_m_s"));
            row.mean(force) - row.mean(&said.resistance_n) - row.mean(&said.effective_mass_kg) * slope
        }
        Kind::Parity => {
            let slope = row.slope(time_s, channel("speed_m_s"));
            row.mean(channel("specific_force_m_s2")) - slope - row.mean(&said.slope_m_s2)
        }
        Kind::Slip => row.mean(channel("wheel_speed_m_s")) - row.mean(&said.wheel_speed_m_s),
        Kind::Battery => {
            row.mean(channel("battery_power_w")) - row.mean(said.battery_w.as_deref().unwrap_or(&zero))
        }
        Kind::Fuel => {
            FUEL_J_KG
                * (row.mean(channel("fuel_rate_kg_s")) - row.mean(said.fuel_kg_s.as_deref().unwrap_or(&zero)))
        }
        Kind::Shaft => 0.0,
    };
    DVector::from_iterator(chunk.rows.len(), chunk.rows.iter().map(one))
}

/// What a change of the model does to the residual, sample by sample: minus what the model says more.
pub fn change(kind: Kind, drive: &Drive0, before: &Said, after: &Said) -> Vec<f64> {
    let minus = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(one, other)| one - other).collect();
    let count = before.resistance_n.len();
    match kind {
        Kind::Motion => (0..count)
            .map(|i| {
                before.resistance_n[i] - after.resistance_n[i]
                    + (before.effective_mass_kg[i] - after.effective_mass_kg[i]) * drive.acceleration_m_s2[i]
            })
            .collect(),
        Kind::Parity => minus(&before.slope_m_s2, &after.slope_m_s2),
        Kind::Slip => minus(&before.wheel_speed_m_s, &after.wheel_speed_m_s),
        Kind::Battery => match (&before.battery_w, &after.battery_w) {
            (Some(before), Some(after)) => minus(before, after),
            _ => vec![0.0; count],
        },
        Kind::Fuel => match (&before.fuel_kg_s, &after.fuel_kg_s) {
            (Some(before), Some(after)) => {
                before.iter().zip(after).map(|(one, other)| FUEL_J_KG * (one - other)).collect()
            }
            _ => vec![0.0; count],
        },
        Kind::Shaft => vec![0.0; count],
    }
}

/// Samples brought to rows.
pub fn column(chunks: &[Chunk], samples: &[Vec<f64>]) -> Column {
    chunks
        .iter()
        .map(|chunk| {
            let of = |row: &crate::rows::Row| {
                let mean = row.mean(&samples[chunk.run]);
                if mean.is_finite() { mean } else { 0.0 }
            };
            DVector::from_iterator(chunk.rows.len(), chunk.rows.iter().map(of))
        })
        .collect()
}

/// Where each run is, sample by sample [m].
pub fn locate(drives: &mut [Drive0], scenario: &Scenario) {
    let _ = scenario;
    for drive in drives {
        let trace = &drive.measured.trace;
        let from_m = drive.measured.how.reversed_from_m;
        let travelled = |values: &[f64]| -> Vec<f64> {
            let mut sum = 0.0;
            let mut all = vec![0.0];
            for (time, speed) in trace.time_s().windows(2).zip(values.windows(2)) {
                let step = 0.5 * (speed[0] + speed[1]) * (time[1] - time[0]);
                sum += if step.is_finite() { step } else { 0.0 };
                all.push(sum);
            }
            all
        };
        drive.position_m = match (trace.get("position_m"), from_m) {
            (Some(position), None) => position.to_vec(),
            (Some(position), Some(_)) if position.last() < position.first() => position.to_vec(),
            (Some(position), Some(from_m)) => position.iter().map(|position| from_m - position).collect(),
            (None, None) => travelled(&drive.motion.value),
            (None, Some(from_m)) => travelled(&drive.motion.value).iter().map(|far| from_m - far).collect(),
        };
    }
}
