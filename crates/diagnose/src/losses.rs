//! What every electric drive does beside a single efficiency: losses that go with the square of force or of speed, and a
//! current that is measured a moment earlier or later than the torque. They are small, nobody would call them missing
//! physics, and a consumer that is switched must not have to explain them; so they are free in every battery balance.
//!
//! Source of the terms: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.3: copper losses with the
//! square of the torque, iron and windage losses with speed.

use crate::Case;
use crate::balance::{Kind, System, longest_period_s};
use crate::recorded::Recorded;
use crate::sensors::Small;
use headland_sim::local_fit;

/// A loss that nobody would call wrong, as a share of the drive's power, both as root mean squares.
const SMALL: f64 = 0.05;

/// The small losses, where there is a battery balance and a force is known.
pub fn small_losses(case: &Case, system: &System) -> Vec<Small> {
    if !system.has(Kind::Battery) || case.runs.iter().any(|run| run.force_n.is_none()) {
        return Vec::new();
    }
    let of = |id: &'static str, samples: &dyn Fn(&Recorded) -> Vec<f64>, sd: Option<f64>| {
        let all: Vec<Vec<f64>> = case.runs.iter().map(samples).collect();
        let usual =
            sd.unwrap_or_else(|| SMALL * rms(&case.runs.iter().map(power).collect::<Vec<_>>()) / rms(&all));
        let silent = || vec![Vec::new(); all.len()];
        let column = system.column(|kind| if kind == Kind::Battery { all.clone() } else { silent() });
        Small { id, column, sd: usual }
    };
    let products = |run: &Recorded, of: fn(f64, f64) -> f64| -> Vec<f64> {
        let force = run.force_n.as_deref().unwrap_or(&[]);
        force.iter().zip(&run.motion.value).map(|(force, speed)| of(*force, *speed)).collect()
    };
    let late = |run: &Recorded| {
        let time_s = run.measured.trace.time_s();
        let known: Vec<f64> =
            power(run).iter().map(|power| if power.is_finite() { *power } else { 0.0 }).collect();
        local_fit(time_s, &known, run.measured.how.smoothing_s).slope
    };
    let smalls = vec![
        of("battery_lag", &late, Some(longest_period_s(&case.runs))),
        of("battery_force_squared", &|run| products(run, |force, _| force * force), None),
        of("battery_speed_squared", &|run| products(run, |_, speed| speed * speed), None),
        of("battery_power_size", &|run| products(run, |force, speed| (force * speed).abs()), None),
    ];
    smalls.into_iter().filter(|small| small.sd.is_finite() && small.sd > 0.0).collect()
}

/// Power at the wheels [W].
fn power(run: &Recorded) -> Vec<f64> {
    let force = run.force_n.as_deref().unwrap_or(&[]);
    force.iter().zip(&run.motion.value).map(|(force, speed)| force * speed).collect()
}

fn rms(runs: &[Vec<f64>]) -> f64 {
    let finite: Vec<f64> = runs.iter().flatten().copied().filter(|value| value.is_finite()).collect();
    (finite.iter().map(|value| value * value).sum::<f64>() / finite.len().max(1) as f64).sqrt()
}
