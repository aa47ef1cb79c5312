//! What a model says of a recorded run, sample by sample.

use crate::DiagnoseError;
use crate::balances::balance::{FUEL_J_KG, Kind};
use crate::runs::recorded::{Recorded, force};
use crate::soundness::voltage::{residual_v, resistance_ohm};
use headland_sim::{Drive, Inputs, Model, Replay, replay_channels};
use headland_trace::{Origin, Trace};
use rayon::prelude::*;

/// What a model says of one run.
#[derive(Clone, Debug)]
pub struct Said {
    /// Force against the motion, inertia left out [N].
    pub resistance_n: Vec<f64>,
    /// Mass in inertia [kg].
    pub effective_mass_kg: Vec<f64>,
    /// Mass that has weight: the same without what rotates [kg].
    pub mass_kg: Vec<f64>,
    /// Slope's part of the specific force [m/s²].
    pub slope_m_s2: Vec<f64>,
    /// Sine of the slope of the ground that is known; NaN where none is.
    pub sin_slope: Vec<f64>,
    /// Force at the wheels that this model's driveline makes of a recorded torque [N]; none where the force itself was
    /// recorded.
    pub force_n: Option<Vec<f64>>,
    /// Speed of the wheels' circumference [m/s].
    pub wheel_speed_m_s: Vec<f64>,
    /// Power from the battery [W].
    pub battery_w: Option<Vec<f64>>,
    /// State of charge.
    pub charge: Option<Vec<f64>>,
    /// Power at the crankshaft [W].
    pub engine_w: Option<Vec<f64>>,
    /// Resistance of the battery [Ω].
    pub resistance_ohm: Option<f64>,
    /// What it leaves of the recorded voltage, fast parts only [V].
    pub voltage_left_v: Vec<f64>,
    /// Mass flow of fuel [kg/s].
    pub fuel_kg_s: Option<Vec<f64>>,
}

/// What is read of a model.
const CHANNELS: [&str; 17] = [
    "speed_m_s",
    "wheel_speed_m_s",
    "acceleration_m_s2",
    "effective_mass_kg",
    "grade",
    "grade_n",
    "grade_constant_n",
    "rotating_inertia_kg",
    "coasting",
    "tractive_force_n",
    "brake_force_n",
    "battery_voltage_v",
    "battery_current_a",
    "state_of_charge",
    "engine_torque_n_m",
    "engine_speed_rad_s",
    "fuel_rate_kg_s",
];

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
        Ok::<_, DiagnoseError>(replay_channels(model, trace, how, &CHANNELS).map_err(failed)?.trace)
    };
    let modelled = replayed(&how)?;
    let get = |name: &str| modelled.get(name).map_or_else(|| vec![f64::NAN; modelled.len()], <[f64]>::to_vec);
    let (tractive, acceleration, mass) =
        (get("tractive_force_n"), get("acceleration_m_s2"), get("effective_mass_kg"));
    let brake = modelled.get("brake_force_n");
    let resistance = |i: usize| tractive[i] - brake.map_or(0.0, |brake| brake[i]) - mass[i] * acceleration[i];
    let resistance_n = (0..tractive.len()).map(resistance).collect();
    let powers = kinds.iter().any(|kind| kind.is_power() || *kind == Kind::Voltage);
    let by_torque = drive != Drive::Torque
        && trace.get("motor_torque_n_m").is_some()
        && model.driveline.force_of_torque_n(1.0, 1.0).is_some();
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
    let engine = (powered.get("engine_torque_n_m"), powered.get("engine_speed_rad_s"));
    let engine_w = match engine {
        (Some(torque), Some(speed)) => Some(torque.iter().zip(speed).map(|(t, omega)| t * omega).collect()),
        _ => None,
    };
    let slips = kinds.contains(&Kind::Slip) && run.forward().is_none();
    let pulled = if slips { pulled(run, &modelled)? } else { None };
    let wheel_speed_m_s = match pulled {
        Some(trace) => {
            let how = Replay { drive: Drive::Force, window_s: Some(POINTWISE_S), ..how };
            replay_channels(model, &trace, &how, &["wheel_speed_m_s"])
                .map_err(|error| DiagnoseError::Replay { run: run.measured.id.clone(), error })?
                .trace
                .get("wheel_speed_m_s")
                .map(<[f64]>::to_vec)
        }
        None => None,
    };
    let force_n = match trace.get("tractive_force_n") {
        Some(_) => None,
        None => force(trace, model, &run.motion.value),
    };
    let mass_kg = at_rest(model, &modelled, &mass);
    Ok(Said {
        force_n,
        charge: powered.get("state_of_charge").map(<[f64]>::to_vec),
        engine_w,
        voltage_left_v: resistance_ohm.map_or_else(Vec::new, |ohm| residual_v(run, ohm)),
        resistance_ohm,
        resistance_n,
        slope_m_s2: slope(model, &modelled, &mass_kg),
        sin_slope: sin_slope(&modelled),
        mass_kg,
        wheel_speed_m_s: wheel_speed_m_s.unwrap_or_else(|| get("wheel_speed_m_s")),
        battery_w,
        fuel_kg_s: powered.get("fuel_rate_kg_s").map(<[f64]>::to_vec),
        effective_mass_kg: mass,
    })
}

/// The run with the force that its engine makes at the wheels, where one is known and the wheels of the model slip; where it
/// is not known, with the one that the motion takes.
fn pulled(run: &Recorded, modelled: &Trace) -> Result<Option<Trace>, DiagnoseError> {
    let Some(pull) = &run.pull_n else { return Ok(None) };
    let get = |name: &str| modelled.get(name).unwrap_or(&[]);
    let turns = get("wheel_speed_m_s").iter().zip(get("speed_m_s"));
    if turns.filter(|(one, other)| one.is_finite() && other.is_finite()).all(|(one, other)| one == other) {
        return Ok(None);
    }
    let force = pull.iter().zip(get("tractive_force_n"));
    let force = force.map(|(pull, takes)| if pull.is_finite() { *pull } else { *takes }).collect();
    let mut trace = run.measured.trace.clone();
    trace.push("tractive_force_n", force, Origin::Measured)?;
    Ok(Some(trace))
}

impl Said {
    /// The first effective mass of the run, where it has any [kg].
    pub fn first_mass_kg(&self) -> Option<f64> {
        self.effective_mass_kg.iter().copied().find(|mass| mass.is_finite())
    }

    /// Power of the fuel [W].
    pub fn fuel_w(&self) -> Vec<f64> {
        self.fuel_kg_s.iter().flatten().map(|fuel| FUEL_J_KG * fuel).collect()
    }

    /// Power that the state of charge says is drawn, as the battery of a run nominally holds it [W].
    pub fn drawn_w(&self, run: &Recorded) -> Option<Vec<f64>> {
        let (charge, energy_j) = (self.charge.as_ref()?, run.charge_j?);
        let time_s = run.measured.trace.time_s();
        let last = charge.len().saturating_sub(1);
        let one = |index: usize| {
            let (from, to) = (index.saturating_sub(1), (index + 1).min(last));
            -energy_j * (charge[to] - charge[from]) / (time_s[to] - time_s[from])
        };
        Some((0..charge.len()).map(one).collect())
    }
}

/// The slope's part of the specific force [m/s²]; slopes that effects add are slopes to an accelerometer as well.
fn slope(model: &Model, modelled: &Trace, mass_kg: &[f64]) -> Vec<f64> {
    let mut slope: Vec<f64> = sin_slope(modelled).iter().map(|sine| model.gravity_m_s2 * sine).collect();
    for name in ["grade_n", "grade_constant_n"] {
        for ((slope, force), mass) in slope.iter_mut().zip(modelled.get(name).unwrap_or(&[])).zip(mass_kg) {
            *slope -= force / mass;
        }
    }
    slope
}

/// Sine of the slope of the ground, sample by sample.
fn sin_slope(modelled: &Trace) -> Vec<f64> {
    match modelled.get("grade") {
        Some(grade) => grade.iter().map(|grade| grade / grade.hypot(1.0)).collect(),
        None => vec![f64::NAN; modelled.len()],
    }
}

/// The mass in inertia without what the vehicle, its driveline and effects add to it by rotating [kg].
fn at_rest(model: &Model, modelled: &Trace, effective_mass_kg: &[f64]) -> Vec<f64> {
    let value = |name: &str, index: usize| modelled.get(name).map_or(0.0, |values| values[index]);
    let of = |(index, effective_kg): (usize, &f64)| {
        let driveline_kg = model.driveline.rotating_mass_kg(value("coasting", index) >= 0.5);
        let rotating_kg = model.vehicle.rotating_mass_kg + driveline_kg + value("rotating_inertia_kg", index);
        effective_kg - rotating_kg
    };
    effective_mass_kg.iter().enumerate().map(of).collect()
}

/// Every recorded circumstance, whatever the scenario's replay is told.
pub fn inputs(trace: &Trace, how: &Replay) -> Vec<Inputs> {
    let mut also = how.also.clone();
    let circumstances = [
        Inputs::Coasting,
        Inputs::Curvature,
        Inputs::Roll,
        Inputs::VerticalAcceleration,
        Inputs::AirTemperature,
        Inputs::OilTemperature,
        Inputs::StateOfCharge,
        Inputs::TyrePressure,
        Inputs::Heading,
        Inputs::EngineSpeed,
    ];
    for input in circumstances {
        if !also.contains(&input) && input.whole(trace) {
            also.push(input);
        }
    }
    also
}
