//! The battery's voltage against its current: what is left of U + R I when everything slow is taken out.
//!
//! U = U₀ − R I. The open-circuit voltage U₀ follows charge and temperature, which nobody logs well enough; within a
//! minute it stands still. So only the fast parts are compared, and only the resistance shows in them.
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.5, the internal-resistance model.

use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use headland_trace::Trace;

/// What is slower than twice this is taken out [s].
const SLOW_S: f64 = 30.0;

/// The part of samples that is faster than a minute: what is left of them when their mean around is taken away.
pub fn fast(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let (mut from, mut to) = (0, 0);
    let (mut sum, mut count) = (0.0, 0usize);
    (0..values.len())
        .map(|index| {
            while to < values.len() && time_s[to] <= time_s[index] + SLOW_S {
                if values[to].is_finite() {
                    (sum, count) = (sum + values[to], count + 1);
                }
                to += 1;
            }
            while time_s[from] < time_s[index] - SLOW_S {
                if values[from].is_finite() {
                    (sum, count) = (sum - values[from], count - 1);
                }
                from += 1;
            }
            values[index] - sum / count.max(1) as f64
        })
        .collect()
}

/// The resistance that a modelled battery has [Ω]: how its voltage follows its current.
pub fn resistance_ohm(modelled: &Trace) -> Option<f64> {
    let (voltage, current) = (modelled.get("battery_voltage_v")?, modelled.get("battery_current_a")?);
    let (voltage, current) = (fast(modelled.time_s(), voltage), fast(modelled.time_s(), current));
    let known = || voltage.iter().zip(&current).filter(|(u, i)| u.is_finite() && i.is_finite());
    let square: f64 = known().map(|(_, current)| current * current).sum();
    let product: f64 = known().map(|(voltage, current)| voltage * current).sum();
    (square > 0.0).then(|| -product / square)
}

/// U + R I of a recorded run, fast parts only [V].
pub fn residual_v(run: &Recorded, resistance_ohm: f64) -> Vec<f64> {
    let trace = &run.measured.trace;
    let part = |name: &str| fast(trace.time_s(), trace.get(name).unwrap_or(&[]));
    let (voltage, current) = (part("battery_voltage_v"), part("battery_current_a"));
    voltage.iter().zip(&current).map(|(voltage, current)| voltage + resistance_ohm * current).collect()
}

/// Power that a changed battery loses more than the one before, ΔR I² [W].
pub fn lost_w(run: &Recorded, before: &Said, after: &Said) -> Vec<f64> {
    let more_ohm = match (before.resistance_ohm, after.resistance_ohm) {
        (Some(before), Some(after)) => after - before,
        _ => 0.0,
    };
    let current = run.measured.trace.get("battery_current_a").unwrap_or(&[]);
    current.iter().map(|current| more_ohm * current * current).collect()
}

/// What a resistance that loses this power takes from the fast part of the voltage, the other way round as residuals have
/// it [V].
pub fn drop_v(run: &Recorded, lost_w: &[f64]) -> Vec<f64> {
    let trace = &run.measured.trace;
    drop_of(trace.time_s(), trace.get("battery_current_a").unwrap_or(&[]), lost_w)
}

fn drop_of(time_s: &[f64], current_a: &[f64], lost_w: &[f64]) -> Vec<f64> {
    let drop = |(lost, current): (&f64, &f64)| if *current == 0.0 { 0.0 } else { -lost / current };
    let drops: Vec<f64> = lost_w.iter().zip(current_a).map(drop).collect();
    fast(time_s, &drops)
}

/// What so much more resistance in the model does to the residual [V].
pub fn change_v(run: &Recorded, more_ohm: f64) -> Vec<f64> {
    let trace = &run.measured.trace;
    let current = fast(trace.time_s(), trace.get("battery_current_a").unwrap_or(&[]));
    current.iter().map(|current| more_ohm * current).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_and_a_slow_drift_go_and_a_pulse_stays() {
        let time_s: Vec<f64> = (0..2000).map(|index| 0.1 * f64::from(index)).collect();
        let slow: Vec<f64> = time_s.iter().map(|time| 360.0 - 0.01 * time).collect();
        assert!(fast(&time_s, &slow)[1000].abs() < 1e-9);
        let pulsed: Vec<f64> = slow
            .iter()
            .enumerate()
            .map(|(index, value)| value - if index == 1000 { 3.0 } else { 0.0 })
            .collect();
        assert!((fast(&time_s, &pulsed)[1000] + 3.0).abs() < 0.01);
    }

    /// What a resistance loses and what it does to the voltage tell the same resistance.
    #[test]
    fn power_lost_and_voltage_dropped_belong_together() {
        let time_s: Vec<f64> = (0..2000).map(|index| 0.1 * f64::from(index)).collect();
        let current: Vec<f64> = time_s.iter().map(|time| 40.0 * (0.7 * time).sin() + 10.0).collect();
        let lost: Vec<f64> = current.iter().map(|current| 0.05 * current * current).collect();
        for (drop, current) in drop_of(&time_s, &current, &lost).iter().zip(fast(&time_s, &current)) {
            assert!((drop + 0.05 * current).abs() < 1e-9);
        }
    }

    #[test]
    fn the_resistance_of_a_modelled_battery_is_found_again() {
        let time_s: Vec<f64> = (0..3000).map(|index| 0.1 * f64::from(index)).collect();
        let current: Vec<f64> = time_s.iter().map(|time| 40.0 * (0.7 * time).sin() + 10.0).collect();
        let voltage =
            time_s.iter().zip(&current).map(|(time, current)| 370.0 - 0.02 * time - 0.12 * current).collect();
        let mut trace = Trace::new(time_s).unwrap();
        trace.push("battery_voltage_v", voltage, headland_trace::Origin::Predicted).unwrap();
        trace.push("battery_current_a", current, headland_trace::Origin::Predicted).unwrap();
        assert!((resistance_ohm(&trace).unwrap() - 0.12).abs() < 1e-3);
    }
}
