//! Engines whose vehicle rolls: what a measured force asks of them then, no scenario says. What a transmission passes on of a force
//! that drives the engine is not what it passes on the other way, if it passes on any; and where next to nothing drives, the noise of
//! the force has both signs, so that a model makes power of it that was never there. Nobody would call either missing physics, and a
//! loss of the driveline must not have to explain them.

use crate::Case;
use crate::balance::{Kind, System};
use crate::losses::any_value;
use crate::recorded::Recorded;
use crate::sensors::Small;
use headland_calibrate::statistics::{NORMAL_OF_MEDIAN, median};

const FORCE: &str = "tractive_force_n";
/// Samples to either side whose mean says how far a force is from nought.
const BESIDE: usize = 2;

/// What is free of the power of an engine whose vehicle rolls, where the force was measured at the wheels.
pub fn undriven_powers(case: &Case, system: &System) -> Vec<Small> {
    /// Of the power at the wheels: nothing of it may come.
    const OVERRUN: f64 = 1.0;
    /// Of speed times noise: what an efficiency of nine tenths makes of either half of it.
    const NOISE: f64 = 0.1;
    /// Power of the fuel over that of the shaft.
    const FUEL: f64 = 2.5;
    let all = |of: &dyn Fn(&Recorded) -> Vec<f64>| case.runs.iter().map(of).collect::<Vec<_>>();
    let (overrun, noise) = (all(&overrun_w), all(&|run| noise_w(run, declared_n(case))));
    let smalls = [
        (Kind::Shaft, "overrun_shaft", &overrun, OVERRUN),
        (Kind::Fuel, "overrun_fuel", &overrun, OVERRUN * FUEL),
        (Kind::Shaft, "noise_shaft", &noise, NOISE),
        (Kind::Fuel, "noise_fuel", &noise, NOISE * FUEL),
    ];
    let of = |(kind, id, samples, sd): (Kind, &'static str, &Vec<Vec<f64>>, f64)| {
        let silent = || vec![Vec::new(); samples.len()];
        let column = system.column(|own| if own == kind { samples.clone() } else { silent() });
        Small { id, column, sd }
    };
    smalls.into_iter().map(of).filter(any_value).collect()
}

/// Power at the wheels where they drive the engine by what was measured [W].
fn overrun_w(run: &Recorded) -> Vec<f64> {
    let Some(force_n) = run.force_n.as_ref().filter(|_| run.measured.trace.get(FORCE).is_some()) else {
        return Vec::new();
    };
    let of = |(sample, speed): (usize, &f64)| (-around_n(force_n, sample) * speed).max(0.0);
    run.motion.value.iter().enumerate().map(of).collect()
}

/// The mean of a force about a sample [N].
fn around_n(force_n: &[f64], sample: usize) -> f64 {
    let around = &force_n[sample.saturating_sub(BESIDE)..=(sample + BESIDE).min(force_n.len() - 1)];
    around.iter().sum::<f64>() / around.len() as f64
}

/// Speed times the noise of the force, where that force is hardly more than its noise [W].
///
/// The mean of what a normal variable about m has on one side of nought is σ φ(m/σ) + m Φ(m/σ). Beside what m itself has there it is
/// highest at nought and gone at twice the noise, on either side; a bell draws it.
fn noise_w(run: &Recorded, declared_n: Option<f64>) -> Vec<f64> {
    let trace = &run.measured.trace;
    let (Some(measured), Some(force_n)) = (trace.get(FORCE), &run.force_n) else { return Vec::new() };
    let noise_n = declared_n.unwrap_or_else(|| shown_n(measured));
    if noise_n <= 0.0 {
        return Vec::new();
    }
    let of = |(sample, speed): (usize, &f64)| {
        let ratio = around_n(force_n, sample) / noise_n;
        let bump = speed * noise_n * (-0.5 * ratio * ratio).exp();
        if bump.is_finite() { bump } else { 0.0 }
    };
    run.motion.value.iter().enumerate().map(of).collect()
}

/// The noise of the force as its sensor is described [N].
fn declared_n(case: &Case) -> Option<f64> {
    case.sensors.iter().find(|(name, _)| name == FORCE).and_then(|(_, sensor)| sensor.noise)
}

/// The noise that neighbouring samples of a force show, by the median of their second differences [N].
fn shown_n(force_n: &[f64]) -> f64 {
    /// Variance of a second difference over that of a sample.
    const SECOND: f64 = 6.0;
    let differences: Vec<f64> = force_n
        .windows(3)
        .map(|three| (three[0] - 2.0 * three[1] + three[2]).abs())
        .filter(|difference| difference.is_finite())
        .collect();
    if differences.is_empty() { 0.0 } else { NORMAL_OF_MEDIAN * median(&differences) / SECOND.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::shown_n;
    use headland_calibrate::statistics::Draws;

    #[test]
    fn noise_about_a_line_is_what_it_is() {
        let mut draws = Draws::new(1, 1);
        let force_n: Vec<f64> = (0..4000).map(|at| f64::from(at) + 250.0 * draws.normal()).collect();
        let shown = shown_n(&force_n);
        assert!((shown / 250.0 - 1.0).abs() < 0.06, "{shown}");
        assert_eq!(shown_n(&[1.0, 2.0]), 0.0);
    }
}
