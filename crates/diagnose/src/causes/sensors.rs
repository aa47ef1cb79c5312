//! What a sensor's fault does to the rows, and recordings as they would be without it.

use crate::balances::balance::{Kind, change, longest_renewal_s};
use crate::balances::gram::Column;
use crate::causes::catalogue::{MOST_SCALE, MOST_SPEED_SCALE};
use crate::causes::clocks::{DRIFT, FORCE, drifted, drifted_force, force_runs_apart};
use crate::runs::placed;
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::runs::standin::with_stand_in;
use crate::{Case, DiagnoseError, System};
use headland_trace::{Channel, Trace};
use headland_units::constants::STANDARD_GRAVITY_M_S2;

/// The body pitches on its tyres while it speeds up, and the accelerometer with it.
pub const PITCH: &str = "pitch";
/// How much, usually [rad s²/m]: 0.0015 to 0.0023 rad at 0.7 m/s², for a tractor 1.3 m high on 3.6 m of wheelbase.
pub const PITCH_RAD_S2_M: f64 = 0.004;
/// A scale that nobody would call wrong.
const SMALL_SCALE: f64 = 0.005;
/// An offset of an accelerometer that nobody would call wrong [m/s²]: half of what the least vibration makes of it, 1 to 10 mg.
const SMALL_BIAS_M_S2: f64 = 0.005;

/// A fault that is free in every diagnosis.
pub struct Small {
    /// Which.
    pub id: &'static str,
    /// Its column.
    pub column: Column,
    /// Its usual size.
    pub sd: f64,
}

/// A latency that every speed sensor has [s]: that of its filter; of a slow one half a sampling period, as what is averaged or held
/// over one has it, and a receiver's delay; never more than a period.
pub fn small_latency_s(case: &Case) -> f64 {
    /// GNSS speed sensors are 15 to 20 ms late by their data sheets, more with a filter.
    const FILTER_S: f64 = 0.03;
    /// Raw receivers are 50 to 250 ms late.
    const RECEIVER_S: f64 = 0.05;
    let period_s = longest_renewal_s(&case.runs, "speed_m_s");
    period_s.min(0.5 * period_s + RECEIVER_S).max(FILTER_S)
}

/// Whether what has this size is no fault: less than anybody would mind, or more than any sensor is wrong by. What drives comes late
/// only where something drives.
pub fn is_no_fault(case: &Case, id: &str, value: f64) -> bool {
    match id {
        "latency" => value.abs() <= small_latency_s(case) || value < 0.0 && !case.fitted_is_driven(),
        DRIFT => value.abs() * case.longest_s() <= small_latency_s(case),
        "speed_scale" => !(SMALL_SCALE..=MOST_SPEED_SCALE).contains(&value.abs()),
        "force_scale" => !(SMALL_SCALE..=MOST_SCALE).contains(&value.abs()),
        "accelerometer_bias" => value.abs() <= 2.0 * SMALL_BIAS_M_S2,
        "accelerometer_tilt" => value.abs() * STANDARD_GRAVITY_M_S2 <= 2.0 * SMALL_BIAS_M_S2,
        _ => false,
    }
}

/// What every sensor does a little: a sampling period of latency, half a per cent of scale, half a thousandth of gravity. Nobody would call it a
/// fault, and it must not be taken for physics; so it is free throughout.
pub fn small_faults(case: &Case, system: &System) -> Result<Vec<Small>, DiagnoseError> {
    let small = [
        (Kind::Motion, "latency", small_latency_s(case)),
        (Kind::Motion, "force_scale", SMALL_SCALE),
        (Kind::Motion, "speed_scale", SMALL_SCALE),
        (Kind::Parity, PITCH, PITCH_RAD_S2_M),
        (Kind::Parity, "accelerometer_bias", SMALL_BIAS_M_S2),
    ];
    let mut all = Vec::new();
    // What was corrected before is free by far more than a little, and once is enough.
    for (kind, id, sd) in small {
        if system.has(kind) && !case.corrections.iter().any(|correction| correction.id == id) {
            let mut column = fault(case, system, id, sd)?;
            if id == "latency" {
                // What drives a battery's current has latencies of its own.
                system.silence(&mut column, |own| own == Kind::Motion);
            }
            all.push(Small { id, column, sd });
        }
    }
    Ok(all)
}

/// What a fault of size `step` does to every row, over `step`.
///
/// The acceleration is the one that force and model make: the recorded one would bring its noise into the column.
pub fn fault(case: &Case, system: &System, id: &str, step: f64) -> Result<Column, DiagnoseError> {
    // Tried on the speed, whichever way: what moves the force would bring the noise of its sensor into the column.
    let corrected = moved(&case.runs, id, step, false)?;
    let said = case.said_of(&corrected, case.study.scenario(), &case.study.priors())?;
    Ok(system.column(|kind| {
        (0..case.runs.len())
            .map(|run| {
                let (before, after) = (&case.runs[run], &corrected[run]);
                let samples = match kind {
                    Kind::Motion => motion(id, step, (before, &case.nominal[run]), (after, &said[run])),
                    Kind::Parity => less("specific_force_m_s2", before, after),
                    Kind::Slip => {
                        as_modelled(less("wheel_speed_m_s", before, after), before, &case.nominal[run])
                    }
                    // What drives the motor turns with the wheels: a wrong speed is a wrong power.
                    Kind::Voltage => Vec::new(),
                    Kind::Shaft | Kind::Battery | Kind::Charge | Kind::Fuel => {
                        change(kind, before, &said[run], &case.nominal[run])
                    }
                };
                samples.iter().map(|value| value / step).collect()
            })
            .collect()
    }))
}

/// What a correction takes of the speed of the wheels, with the speed that the model has instead of the measured one, whose
/// noise is in the residual already: a column that shares it would explain it.
fn as_modelled(less: Vec<f64>, run: &Recorded, said: &Said) -> Vec<f64> {
    let Some(measured) = run.measured.trace.get("wheel_speed_m_s") else { return less };
    let one = |((less, measured), modelled): ((f64, &f64), &f64)| {
        if less == 0.0 || *measured == 0.0 || !modelled.is_finite() {
            less
        } else {
            less * modelled / measured
        }
    };
    less.into_iter().zip(measured).zip(&said.wheel_speed_m_s).map(one).collect()
}

/// The channel as it was less as it is, corrected.
fn less(name: &str, before: &Recorded, after: &Recorded) -> Vec<f64> {
    match (before.measured.trace.get(name), after.measured.trace.get(name)) {
        (Some(before), Some(after)) => before.iter().zip(after).map(|(one, other)| one - other).collect(),
        _ => Vec::new(),
    }
}

/// What a correction changes in the balance of motion, sample by sample [N].
fn motion(
    id: &str,
    step: f64,
    (run, model): (&Recorded, &Said),
    (after, remodelled): (&Recorded, &Said),
) -> Vec<f64> {
    let time_s = run.measured.trace.time_s();
    let force = |run: &Recorded, index: usize| run.force_n.as_ref().map_or(0.0, |force| force[index]);
    let faster = |index: usize| {
        let made = run.acceleration_m_s2[index];
        match id {
            "latency" => interpolate(time_s, &run.acceleration_m_s2, time_s[index] + step) - made,
            DRIFT => interpolate(time_s, &run.acceleration_m_s2, drifted(time_s, index, step)) - made,
            // With a wheel speed beside it, it is that sensor whose scale is wrong.
            "speed_scale" if run.measured.trace.get("wheel_speed_m_s").is_none() => {
                made / (1.0 + step) - made
            }
            _ => 0.0,
        }
    };
    (0..model.resistance_n.len())
        .map(|index| {
            force(run, index) - force(after, index) + remodelled.resistance_n[index]
                - model.resistance_n[index]
                + model.effective_mass_kg[index] * faster(index)
        })
        .collect()
}

/// Whether a latency is one of the force: a speed does not come early, so what drives comes late. Where force is made of a
/// torque, the whole bus is late with it, and the speed is moved against the bus.
pub fn late_force(run: &Recorded, id: &str, value: f64) -> bool {
    id == "latency" && value < 0.0 && run.measured.trace.get("tractive_force_n").is_some()
}

/// The channel that a fault is corrected in, and its samples without it; that of the `force` where it may be, or is, one of it.
fn without(run: &Recorded, id: &str, value: f64, force: bool) -> Option<(&'static str, Vec<f64>)> {
    let trace = &run.measured.trace;
    let time_s = trace.time_s();
    let each = |name: &'static str, change: &dyn Fn(usize, f64) -> f64| {
        let samples = trace.get(name)?;
        Some((name, samples.iter().enumerate().map(|(index, sample)| change(index, *sample)).collect()))
    };
    let scaled = |_: usize, sample: f64| sample / (1.0 + value);
    match id {
        "latency" if force && late_force(run, id, value) => {
            let force = trace.get("tractive_force_n")?;
            each("tractive_force_n", &|index, _| interpolate(time_s, force, time_s[index] - value))
        }
        "latency" => {
            let speed = trace.get("speed_m_s")?;
            each("speed_m_s", &|index, _| interpolate(time_s, speed, time_s[index] + value))
        }
        DRIFT if force => {
            let force = trace.get(FORCE)?;
            each(FORCE, &|index, _| interpolate(time_s, force, drifted_force(time_s, index, value)))
        }
        DRIFT => {
            let speed = trace.get("speed_m_s")?;
            each("speed_m_s", &|index, _| interpolate(time_s, speed, drifted(time_s, index, value)))
        }
        "speed_scale" if trace.get("wheel_speed_m_s").is_some() => each("wheel_speed_m_s", &scaled),
        "speed_scale" => each("speed_m_s", &scaled),
        "accelerometer_bias" => each("specific_force_m_s2", &|_, sample| sample - value),
        "accelerometer_tilt" => {
            each("specific_force_m_s2", &|_, sample| sample - STANDARD_GRAVITY_M_S2 * value.sin())
        }
        PITCH => each("specific_force_m_s2", &|index, sample| {
            sample - STANDARD_GRAVITY_M_S2 * value * run.acceleration_m_s2[index]
        }),
        _ => None,
    }
}

/// The runs as they would have been recorded without a fault of this size.
pub fn corrected(runs: &[Recorded], id: &str, value: f64) -> Result<Vec<Recorded>, DiagnoseError> {
    moved(runs, id, value, true)
}

/// The same; a latency or a clock that is one of the force is taken from the force, or else from the speed, the other way.
fn moved(runs: &[Recorded], id: &str, value: f64, force: bool) -> Result<Vec<Recorded>, DiagnoseError> {
    let force = force && (id != DRIFT || force_runs_apart(runs, value));
    let one = |run: &Recorded| {
        let mut changed = run.clone();
        if let Some((name, samples)) = without(run, id, value, force) {
            changed.measured.trace = with_channel(&run.measured.trace, name, samples)?;
            if name == "wheel_speed_m_s" && !run.stands_in.is_empty() {
                changed.measured.trace = with_stand_in(&changed.measured.trace, &run.stands_in)?;
            }
        }
        if id == DRIFT {
            let time_s = run.measured.trace.time_s();
            let last_s = time_s[time_s.len() - 1];
            let recorded_s = if force { drifted_force } else { drifted };
            for (index, compared) in changed.measured.compared.iter_mut().enumerate() {
                *compared &= recorded_s(time_s, index, value) <= last_s;
            }
        }
        if id == "latency" {
            // What a late sensor would have said after the end nobody knows.
            let time_s = run.measured.trace.time_s();
            let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
            let ahead_s = if force && late_force(run, id, value) { -value } else { value };
            for (compared, time_s) in changed.measured.compared.iter_mut().zip(time_s) {
                *compared &= (first..=last).contains(&(time_s + ahead_s));
            }
        }
        if force && (id == DRIFT || late_force(run, id, value)) {
            follow_force(&mut changed);
        } else if ["latency", DRIFT].contains(&id) {
            // Places that are told by the clock of the speed are set right with it.
            let time_s = run.measured.trace.time_s();
            let at = |index: usize| {
                if id == "latency" { time_s[index] + value } else { drifted(time_s, index, value) }
            };
            placed::go_along(&mut changed, &(0..time_s.len()).map(at).collect::<Vec<f64>>())?;
        }
        if id == "force_scale" {
            for sample in changed.force_n.iter_mut().flatten() {
                *sample /= 1.0 + value;
            }
            // A force that was measured at the wheels says nothing of the sensor of a torque beside it.
            let measured = run.measured.trace.get("tractive_force_n").is_some();
            let names: &[&str] =
                if measured { &["tractive_force_n"] } else { &["motor_torque_n_m", "engine_torque_n_m"] };
            for name in names {
                let trace = &changed.measured.trace;
                if let Some(samples) = trace.get(name) {
                    let samples = samples.iter().map(|sample| sample / (1.0 + value)).collect();
                    changed.measured.trace = with_channel(trace, name, samples)?;
                }
            }
        }
        changed.follow();
        Ok(changed)
    };
    runs.iter().map(one).collect()
}

/// The force of a run from its channel, once that was changed; in neutral none drives.
fn follow_force(run: &mut Recorded) {
    let trace = &run.measured.trace;
    let (Some(force), Some(own)) = (trace.get("tractive_force_n"), run.force_n.as_mut()) else { return };
    let coasting = trace.get("coasting");
    for (index, (own, force)) in own.iter_mut().zip(force).enumerate() {
        *own = if coasting.is_some_and(|values| values[index] >= 0.5) { 0.0 } else { *force };
    }
}

/// The trace with other values of a channel.
pub fn with_channel(trace: &Trace, name: &str, values: Vec<f64>) -> Result<Trace, DiagnoseError> {
    let mut changed = Trace::new(trace.time_s().to_vec())?;
    let mut values = Some(values);
    for Channel { name: own, values: kept, origin } in trace.channels() {
        let values = if own == name { values.take().unwrap_or_default() } else { kept.clone() };
        changed.push(own.clone(), values, *origin)?;
    }
    Ok(changed)
}

/// What lies between samples, or at an end of them.
pub fn interpolate(times: &[f64], values: &[f64], at: f64) -> f64 {
    let right = times.partition_point(|time| *time < at).clamp(1, times.len() - 1);
    let share = ((at - times[right - 1]) / (times[right] - times[right - 1])).clamp(0.0, 1.0);
    values[right - 1] + share * (values[right] - values[right - 1])
}
