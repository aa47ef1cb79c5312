//! A recorded run with its motion, its place and the force that moved it.

use crate::balances::balance::{FUEL_J_KG, Kind};
use crate::balances::steps::{Open, step_s};
use crate::runs::standin::Prepared;
use headland_calibrate::statistics::{quantile_of_sorted, sorted};
use headland_calibrate::study::{Measured, Study, places_m};
use headland_plugin::Shaft;
use headland_sim::{Drive, LocalFit, Model, local_fit};
use headland_trace::{Channel, Origin, Trace};

/// One recorded run with its motion.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// The run.
    pub measured: Measured,
    /// Its number among the runs.
    pub number: usize,
    /// Smoothed speed and acceleration.
    pub motion: LocalFit,
    /// Acceleration that the recorded force and the nominal model make [m/s²]; the recorded one where no force is known.
    ///
    /// Regressors are made of it: made of the recorded acceleration they would explain their own noise.
    pub acceleration_m_s2: Vec<f64>,
    /// Position along the path [m].
    pub position_m: Vec<f64>,
    /// Whether its places are told by the clock of its speed.
    pub placed: bool,
    /// The ground that it drove over: runs of the same number share it.
    pub path: usize,
    /// Force at the wheels that was measured [N]; NaN where it is not known.
    pub force_n: Option<Vec<f64>>,
    /// Samples whose speed is that of the wheels, for want of one over ground; empty where it is none.
    pub stands_in: Vec<bool>,
    /// Samples at which it is not known what the run was driven by; empty where there are none.
    pub unknown: Vec<bool>,
    /// First and last sample of the stretches in which the recorded speed was none that a vehicle can have.
    pub leaps: Vec<(usize, usize)>,
    /// Power at the crankshaft, recorded torque times recorded speed [W], where no force was made of that torque.
    pub engine_w: Option<Vec<f64>>,
    /// Force at the wheels that this power makes [N], as far as the driveline can tell; NaN where it cannot. It makes wheels
    /// slip; the power itself is what is balanced.
    pub pull_n: Option<Vec<f64>>,
    /// What the battery holds nominally [J], where its state of charge is all that is known of it and fine enough to be held
    /// against a power.
    pub charge_j: Option<f64>,
}

/// Below this speed friction at rest decides, and no balance of motion holds [m/s].
pub const SLOWEST_M_S: f64 = 0.4;

/// A gust that passes faster does not take hold of a whole vehicle, and what an anemometer says of it is mostly noise; so
/// much of the time before and after a sample makes its wind [s].
const GUST_S: f64 = 5.0;

/// Prepares the runs of a study.
pub fn recorded(study: &Study, prepared: &Prepared, model: &Model) -> Vec<Recorded> {
    let mut paths: Vec<Option<String>> = Vec::new();
    let mut all = Vec::new();
    let samples = prepared.stands_in.iter().zip(prepared.unknown.iter().zip(&prepared.leaps));
    let described = prepared.recording.runs.iter().zip(samples);
    for (measured, (described, (stands_in, (unknown, leaps)))) in study.runs.iter().zip(described) {
        let path = match &described.path {
            Some(path) => paths.iter().position(|known| known.as_ref() == Some(path)),
            None => None,
        };
        let path = path.unwrap_or_else(|| {
            paths.push(described.path.clone());
            paths.len() - 1
        });
        let speed = measured.trace.get("speed_m_s").map(<[f64]>::to_vec).unwrap_or_default();
        let motion = local_fit(measured.trace.time_s(), &speed, measured.how.smoothing_s);
        let engine = engine(&measured.trace, model);
        all.push(Recorded {
            number: all.len(),
            position_m: places_m(&measured.trace, &motion.value, measured.how.reversed_from_m),
            placed: false,
            acceleration_m_s2: motion.slope.clone(),
            force_n: force(&measured.trace, model, &motion.value),
            stands_in: stands_in.clone(),
            unknown: unknown.clone(),
            leaps: leaps.clone(),
            pull_n: pull(&measured.trace, model),
            engine_w: engine,
            charge_j: charge(&measured.trace, model),
            motion,
            path,
            measured: Measured { trace: without_leaps(&steady_wind(&measured.trace)), ..measured.clone() },
        });
    }
    all
}

/// The trace with its wind averaged, as a vector, over [`GUST_S`] before and after; as it is where none was recorded.
fn steady_wind(trace: &Trace) -> Trace {
    let (Some(speed), Some(from)) = (trace.get("wind_speed_m_s"), trace.get("wind_direction_rad")) else {
        return trace.clone();
    };
    let time_s = trace.time_s();
    let parts = |of: fn(f64) -> f64| -> Vec<f64> {
        let raw: Vec<f64> = speed.iter().zip(from).map(|(speed, from)| speed * of(*from)).collect();
        local_fit(time_s, &raw, GUST_S).value
    };
    let (north, east) = (parts(f64::cos), parts(f64::sin));
    let with = |own: &Channel| -> Option<Vec<f64>> {
        let both = north.iter().zip(&east);
        match own.name.as_str() {
            "wind_speed_m_s" => Some(both.map(|(north, east)| north.hypot(*east)).collect()),
            "wind_direction_rad" => {
                Some(both.map(|(north, east)| east.atan2(*north).rem_euclid(std::f64::consts::TAU)).collect())
            }
            _ => None,
        }
    };
    let Ok(mut made) = Trace::new(time_s.to_vec()) else { return trace.clone() };
    for channel in trace.channels() {
        let values = with(channel).unwrap_or_else(|| channel.values.clone());
        if made.push(channel.name.clone(), values, channel.origin).is_err() {
            return trace.clone();
        }
    }
    made
}

/// The trace without the places at which a state of charge leaps: what manages a battery corrects its estimate now and then,
/// and no power does that.
fn without_leaps(trace: &Trace) -> Trace {
    /// A leap is so many times the change that all but one in a hundred of those between neighbouring samples stay below.
    const LEAP: f64 = 3.0;
    const USUAL: f64 = 0.99;
    let Some(charge) = trace.get("state_of_charge") else { return trace.clone() };
    let time_s = trace.time_s();
    let rate =
        |index: usize| ((charge[index] - charge[index - 1]) / (time_s[index] - time_s[index - 1])).abs();
    let moves: Vec<f64> = (1..charge.len()).map(rate).filter(|rate| *rate > 0.0).collect();
    if moves.is_empty() {
        return trace.clone();
    }
    let most = LEAP * quantile_of_sorted(&sorted(&moves), USUAL);
    let leaps = |index: usize| index > 0 && rate(index) > most;
    let kept = charge.iter().enumerate().map(|(index, charge)| if leaps(index) { f64::NAN } else { *charge });
    let kept: Vec<f64> = kept.collect();
    let mut made = trace.clone();
    let origin = made.remove("state_of_charge").map_or(Origin::Measured, |channel| channel.origin);
    if made.push("state_of_charge", kept, origin).is_err() {
        return trace.clone();
    }
    made
}

impl Recorded {
    /// What steps of its recorded force between two samples leave open; none where no force is known.
    pub fn open(&self) -> Option<Open> {
        let (force_n, step_s) = self.driven(Kind::Motion)?;
        Some(Open::of(&force_n, self.measured.trace.time_s(), step_s))
    }

    /// What was measured of a balance that is driven, in its unit, and the time from one value to the next [s]; none where that
    /// was not measured, and of balances that no pedal changes at once.
    pub fn driven(&self, kind: Kind) -> Option<(Vec<f64>, f64)> {
        let trace = &self.measured.trace;
        let (name, values) = match kind {
            Kind::Motion => {
                let names = ["tractive_force_n", "motor_torque_n_m", "engine_torque_n_m"];
                let name = names.into_iter().find(|name| trace.get(name).is_some())?;
                (name, self.force_n.clone()?)
            }
            Kind::Shaft => ("engine_torque_n_m", self.engine_w.clone()?),
            Kind::Battery => ("battery_power_w", trace.get("battery_power_w")?.to_vec()),
            Kind::Fuel => {
                let name = "fuel_rate_kg_s";
                (name, trace.get(name)?.iter().map(|rate| FUEL_J_KG * rate).collect())
            }
            _ => return None,
        };
        Some((values, step_s(trace, name)))
    }

    /// Everything that follows from the channels, made anew after they were changed.
    pub fn follow(&mut self) {
        if let Some(speed) = self.measured.trace.get("speed_m_s") {
            self.motion = local_fit(self.measured.trace.time_s(), speed, self.measured.how.smoothing_s);
        }
    }

    /// Whether what drives is known most of the time, and not only that nothing does where a vehicle rolls.
    pub fn force_is_known(&self) -> bool {
        self.force_n.as_ref().is_some_and(|force_n| {
            2 * force_n.iter().filter(|force| force.is_finite()).count() > force_n.len()
        })
    }

    /// Force at the wheels as far as it is known, sample by sample, and none elsewhere [N].
    pub fn known_force_n(&self) -> Vec<f64> {
        let known = |force_n: &f64| if force_n.is_finite() { *force_n } else { 0.0 };
        match &self.force_n {
            Some(force_n) => force_n.iter().map(known).collect(),
            None => vec![0.0; self.measured.trace.len()],
        }
    }

    /// What can drive the run forward.
    pub fn forward(&self) -> Option<Drive> {
        let trace = &self.measured.trace;
        let coasts = trace.get("coasting").is_some_and(|values| values.iter().all(|value| *value >= 0.5));
        if coasts {
            Some(Drive::Coast)
        } else if trace.get("tractive_force_n").is_some() {
            Some(Drive::Force)
        } else if trace.get("motor_torque_n_m").is_some() && self.force_n.is_some() {
            Some(Drive::Torque)
        } else {
            None
        }
    }

    /// What drives the run forward where speeds are held against each other: the parts that coast, where nothing else can.
    pub fn shown_forward(&self) -> Option<Drive> {
        self.forward().or((self.measured.how.drive == Drive::Coast).then_some(Drive::Coast))
    }

    /// The acceleration that recorded force and a model's resistance make, where the vehicle moves and both are known; else
    /// the recorded one [m/s²].
    pub fn accelerated_m_s2(&self, resistance_n: &[f64], effective_mass_kg: &[f64]) -> Vec<f64> {
        let Some(force) = &self.force_n else { return self.acceleration_m_s2.clone() };
        let at = |(index, recorded): (usize, &f64)| {
            let made = (force[index] - resistance_n[index]) / effective_mass_kg[index];
            if made.is_finite() && self.motion.value[index].abs() > SLOWEST_M_S { made } else { *recorded }
        };
        self.motion.slope.iter().enumerate().map(at).collect()
    }
}

/// Whether any two of the runs that are fitted drove the same path.
pub fn share_paths(runs: &[Recorded], fit: &[bool]) -> bool {
    let fitted = || runs.iter().zip(fit).enumerate().filter(|(_, (_, fit))| **fit);
    fitted().any(|(one, (run, _))| fitted().any(|(two, (other, _))| two < one && run.path == other.path))
}

/// The force at the wheels that a recording knows, with a model whose driveline makes it of a torque.
pub fn force(trace: &Trace, model: &Model, speed: &[f64]) -> Option<Vec<f64>> {
    let torque = trace.get("motor_torque_n_m").or_else(|| trace.get("engine_torque_n_m"));
    let mut force = match (trace.get("tractive_force_n"), torque) {
        (Some(force), _) => Some(force.to_vec()),
        (None, Some(torque)) => {
            let of = |(torque, speed): (&f64, &f64)| model.driveline.force_of_torque_n(*torque, *speed);
            torque.iter().zip(speed).map(of).collect::<Option<Vec<f64>>>()
        }
        (None, None) => None,
    };
    let Some(coasting) = trace.get("coasting") else { return force };
    let free = |value: f64| value >= 0.5;
    match &mut force {
        Some(force) => {
            for (force, _) in force.iter_mut().zip(coasting).filter(|(_, coasting)| free(**coasting)) {
                *force = 0.0;
            }
        }
        None if coasting.iter().any(|value| free(*value)) => {
            force = Some(coasting.iter().map(|value| if free(*value) { 0.0 } else { f64::NAN }).collect());
        }
        None => {}
    }
    force
}

/// Power at the crankshaft [W], where torque and speed of the engine were recorded and no force is made of the torque.
///
/// Beside fuel only where a force at the wheels was measured: else what is unknown of the motion is most of what both leave,
/// and it would count twice.
fn engine(trace: &Trace, model: &Model) -> Option<Vec<f64>> {
    let has = |name: &str| trace.get(name).is_some();
    if has("fuel_rate_kg_s") && !has("tractive_force_n") {
        return None;
    }
    let (torque, speed) = (trace.get("engine_torque_n_m")?, trace.get("engine_speed_rad_s")?);
    let forced = trace.get("tractive_force_n").is_none()
        && trace.get("motor_torque_n_m").is_none()
        && model.driveline.force_of_torque_n(1.0, 1.0).is_some();
    (!forced).then(|| torque.iter().zip(speed).map(|(torque, speed)| torque * speed).collect())
}

/// Force at the wheels that the recorded power of the engine makes [N], where no force was recorded.
fn pull(trace: &Trace, model: &Model) -> Option<Vec<f64>> {
    if trace.get("tractive_force_n").is_some() || trace.get("motor_torque_n_m").is_some() {
        return None;
    }
    let (torque, speed) = (trace.get("engine_torque_n_m")?, trace.get("engine_speed_rad_s")?);
    let wheels = trace.get("wheel_speed_m_s").or_else(|| trace.get("speed_m_s"))?;
    let taken = |name: &str, index: usize| {
        trace.get(name).map(|values| values[index]).filter(|value| value.is_finite()).unwrap_or(0.0)
    };
    let one = |index: usize| {
        let shaft = Shaft {
            torque_n_m: torque[index],
            speed_rad_s: speed[index],
            wheel_speed_m_s: wheels[index],
            auxiliary_power_w: taken("auxiliary_power_w", index),
            shaft_power_w: taken("pto_power_w", index) + taken("hydraulic_power_w", index),
        };
        model.driveline.force_of_shaft_n(&shaft).unwrap_or(f64::NAN)
    };
    let pull: Vec<f64> = (0..trace.len()).map(one).collect();
    pull.iter().any(|force| force.is_finite()).then_some(pull)
}

/// What the battery holds nominally [J], where nothing but its state of charge was recorded, in steps that are fine enough.
fn charge(trace: &Trace, model: &Model) -> Option<f64> {
    /// A charge that changes less often in a run says nothing about its powers.
    const FEWEST_STEPS: usize = 20;
    if trace.get("battery_power_w").is_some() {
        return None;
    }
    let charge = trace.get("state_of_charge")?;
    let steps = charge.windows(2).filter(|pair| pair[0] != pair[1] && pair[1].is_finite()).count();
    if steps < FEWEST_STEPS { None } else { model.driveline.battery_capacity_j() }
}
