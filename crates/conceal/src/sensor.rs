//! Sensors that lag, hold, quantise, and add white and slowly drifting noise; and the faults that they may have.

use crate::dice::Dice;
use crate::hidden::{Spell, Told};
use crate::plant::{STEP_S, Sample};

/// How a channel is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// Time constant of its low pass [s].
    pub lag_s: f64,
    /// Time between two of its values, repeated in between [s]; 0 for one at each row.
    pub hold_s: f64,
    /// Resolution, in the unit of the channel; 0 for none.
    pub step: f64,
    /// Standard deviation of independent noise.
    pub white: f64,
    /// Standard deviation of drifting noise.
    pub drift: f64,
    /// How long a drift lasts [s].
    pub drift_s: f64,
}

/// A fault of the recording, by the contract's id.
#[derive(Clone, Debug, PartialEq)]
pub struct Artefact {
    /// The contract's id.
    pub id: &'static str,
    /// Channels that have it.
    pub channels: Vec<&'static str>,
    /// Latency [s], scale error, bias, rate of the clock, resolution: as the id says.
    pub amount: f64,
    /// Spells of each run in which values are lost or stuck.
    pub spells: Vec<Spell>,
    /// Its parameters.
    pub told: Vec<Told>,
}

/// One channel of one run, at the rows of its log.
pub fn measure(
    samples: &[Sample],
    pick: fn(&Sample) -> f64,
    sensor: &Sensor,
    faults: &[&Artefact],
    rows_s: &[f64],
    run: usize,
    mut dice: Dice,
) -> Vec<f64> {
    let truth = low_pass(samples, pick, sensor.lag_s);
    let amount = |id: &str| faults.iter().find(|fault| fault.id == id).map(|fault| fault.amount);
    let (latency_s, rate) = (amount("latency").unwrap_or(0.0), amount("clock_drift").unwrap_or(0.0));
    let scale = 1.0
        + amount("speed_scale").unwrap_or(0.0)
        + amount("force_scale").unwrap_or(0.0)
        + amount("accelerometer_tilt").unwrap_or(0.0);
    let bias = amount("accelerometer_bias").unwrap_or(0.0);
    let step = amount("quantisation").unwrap_or(sensor.step);
    let mut drift = sensor.drift * dice.normal();
    let (mut last_s, mut held, mut taken) = (f64::NEG_INFINITY, f64::NAN, None);
    let mut out = Vec::with_capacity(rows_s.len());
    for &row_s in rows_s {
        let slot = if sensor.hold_s > 0.0 { ((row_s + 1e-9) / sensor.hold_s).floor() } else { f64::NAN };
        let at_s = if sensor.hold_s > 0.0 { slot * sensor.hold_s } else { row_s };
        if taken != Some(slot) {
            taken = Some(slot);
            if last_s.is_finite() && sensor.drift > 0.0 {
                let kept = (-(at_s - last_s) / sensor.drift_s).exp();
                drift = kept * drift + sensor.drift * (1.0 - kept * kept).sqrt() * dice.normal();
            }
            last_s = at_s;
            // A clock that runs fast stamps t with (1 + rate) t: what it logs comes later and later.
            let value = lookup(&truth, at_s / (1.0 + rate) - latency_s);
            let noisy = value * scale + bias + drift + sensor.white * dice.normal();
            held = if step > 0.0 { (noisy / step).round() * step } else { noisy };
        }
        out.push(held);
    }
    spoil(&mut out, rows_s, run, faults);
    out
}

/// First-order low pass: a step of 1 has reached 1 − e⁻¹ after `lag_s`.
fn low_pass(samples: &[Sample], pick: fn(&Sample) -> f64, lag_s: f64) -> Vec<f64> {
    let share = if lag_s > 0.0 { 1.0 - (-STEP_S / lag_s).exp() } else { 1.0 };
    let mut value = samples.first().map_or(f64::NAN, pick);
    let follow = |sample: &Sample| {
        value += share * (pick(sample) - value);
        value
    };
    samples.iter().map(follow).collect()
}

/// Straight between the plant's steps; the first and the last value go on.
fn lookup(truth: &[f64], at_s: f64) -> f64 {
    let place = (at_s / STEP_S).clamp(0.0, truth.len().saturating_sub(1) as f64);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the samples")]
    let low = place.floor() as usize;
    let high = (low + 1).min(truth.len() - 1);
    truth[low] + (place - low as f64) * (truth[high] - truth[low])
}

/// Loses or repeats values in the spells of a fault. A spell of amount 0 loses them, any other repeats the last.
fn spoil(values: &mut [f64], rows_s: &[f64], run: usize, faults: &[&Artefact]) {
    for spell in faults.iter().flat_map(|fault| &fault.spells).filter(|spell| spell.run == run) {
        let first = rows_s.partition_point(|row| *row < spell.from_s);
        let end = rows_s.partition_point(|row| *row < spell.to_s);
        let last = values[first.saturating_sub(1).min(values.len() - 1)];
        for value in &mut values[first..end.max(first)] {
            *value = if spell.amount == 0.0 { f64::NAN } else { last };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Vec<Sample> {
        (0..2001).map(|step| Sample { speed_m_s: f64::from(step) * STEP_S, ..Sample::default() }).collect()
    }

    fn take(sensor: Sensor, faults: &[&Artefact]) -> Vec<f64> {
        let rows: Vec<f64> = (0..100).map(|row| f64::from(row) * 0.02).collect();
        measure(&ramp(), |sample| sample.speed_m_s, &sensor, faults, &rows, 0, Dice::new(1, 0))
    }

    fn fault(id: &'static str, amount: f64) -> Artefact {
        Artefact { id, channels: vec!["speed_m_s"], amount, spells: Vec::new(), told: Vec::new() }
    }

    /// Behind a ramp of 1/s a first-order lag is late by its time constant.
    #[test]
    fn a_low_pass_is_late_by_its_time_constant() {
        let late = take(Sensor { lag_s: 0.05, ..Sensor::default() }, &[]);
        assert!((late[90] - (1.8 - 0.05)).abs() < 1e-3, "{}", late[90]);
    }

    #[test]
    fn a_held_value_is_repeated_and_a_step_rounds() {
        let held = take(Sensor { hold_s: 0.1, step: 0.25, ..Sensor::default() }, &[]);
        assert_eq!(held[50..55], [1.0; 5]);
        assert!(held.iter().all(|value| (value * 4.0).fract() == 0.0));
    }

    #[test]
    fn faults_do_what_their_names_say() {
        assert!((take(Sensor::default(), &[&fault("latency", 0.2)])[90] - 1.6).abs() < 1e-9);
        assert!((take(Sensor::default(), &[&fault("speed_scale", -0.1)])[90] - 1.62).abs() < 1e-9);
        assert!((take(Sensor::default(), &[&fault("clock_drift", 0.01)])[90] - 1.8 / 1.01).abs() < 1e-9);
        assert!((take(Sensor::default(), &[&fault("quantisation", 0.5)])[90] - 2.0).abs() < 1e-9);
        let spells = vec![Spell { run: 0, from_s: 1.0, to_s: 1.5, amount: 1.0 }];
        let stuck = take(Sensor::default(), &[&Artefact { spells, ..fault("stuck_channel", 0.0) }]);
        assert!((stuck[74] - 0.98).abs() < 1e-9 && (stuck[75] - 1.5).abs() < 1e-9);
    }

    #[test]
    fn noise_has_the_spread_that_it_states() {
        let sensor = Sensor { white: 0.3, ..Sensor::default() };
        let rows: Vec<f64> = (0..2000).map(|row| f64::from(row) * 1e-3).collect();
        let noisy = measure(&ramp(), |sample| sample.speed_m_s, &sensor, &[], &rows, 0, Dice::new(5, 0));
        let square: f64 = noisy.iter().zip(&rows).map(|(noisy, truth)| (noisy - truth).powi(2)).sum();
        assert!(((square / 2000.0).sqrt() / 0.3 - 1.0).abs() < 0.06);
    }
}
