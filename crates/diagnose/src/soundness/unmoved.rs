//! Runs whose speed was held: the force changes, and the vehicle does not speed up or slow down by it, since whoever holds the
//! speed answers what holds the vehicle back. Of such runs a fit would make a mass as large as it may be, for the heavier a
//! vehicle is, the less a force moves it. They tell no mass, and not which sensor is late.
//!
//! b = Σ (F/m − R/m)(dv/dt) / Σ (F/m − R/m)², about the means of each run: 1 where the force moves a vehicle of the mass m, 0 where
//! it moves nothing. Noise of the force makes it less than 1, never so much. Source: the slope of a straight line whose
//! regressor holds errors; Fuller, *Measurement Error Models* (1987), section 1.1.

use crate::runs::recorded::{Recorded, SLOWEST_M_S};

/// What is averaged before the two are compared [s]: longer than any sensor is late.
const BLOCK_S: f64 = 2.0;
/// Fewer blocks tell nothing.
const FEWEST: usize = 60;
/// Below this, with so many standard errors, the force moves nothing.
const MOVES: f64 = 0.3;
const SIGMAS: f64 = 3.0;
/// And the speed is held where what was recorded of its changes is at most this share of what the force would make, in the root
/// mean square: over hills a driver pushes while the vehicle slows down, and that is no held speed.
const HELD: f64 = 0.25;

/// Causes that only an acceleration tells, or how it follows a force: whoever holds the speed makes the force follow the speed.
pub const UNTOLD: [&str; 7] =
    ["mass", "rotating_inertia", "payload_change", "latency", "clock_drift", "speed_scale", "force_scale"];

/// Share of what a mass may be wrong by within which it stays then.
pub const UNMOVED: f64 = 1e-3;

/// Whether a free parameter is a mass.
pub fn is_mass(name: &str) -> bool {
    name.ends_with("mass_kg")
}

/// How much the force of the runs that are fitted moves the vehicle, where that is so little that no mass can be told.
pub fn moved(runs: &[Recorded], fit: &[bool]) -> Option<f64> {
    let mut pairs: Vec<(f64, f64)> = Vec::new();
    for run in runs.iter().zip(fit).filter(|(_, fit)| **fit).map(|(run, _)| run) {
        let own = blocks(run);
        let count = own.len().max(1) as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| own.iter().map(of).sum::<f64>() / count;
        let (made, told) = (mean(|pair| pair.0), mean(|pair| pair.1));
        pairs.extend(own.iter().map(|pair| (pair.0 - made, pair.1 - told)));
    }
    if pairs.len() < FEWEST {
        return None;
    }
    let square: f64 = pairs.iter().map(|(made, _)| made * made).sum();
    let slope = pairs.iter().map(|(made, told)| made * told).sum::<f64>() / square;
    let left: f64 = pairs.iter().map(|(made, told)| (told - slope * made).powi(2)).sum();
    let error = (left / pairs.len() as f64 / square).sqrt();
    let recorded: f64 = pairs.iter().map(|(_, told)| told * told).sum();
    (slope + SIGMAS * error < MOVES && recorded < HELD * HELD * square).then_some(slope)
}

/// What the recorded force makes of the speed in each block, and what was recorded of it [m/s²].
fn blocks(run: &Recorded) -> Vec<(f64, f64)> {
    let Some(force) = &run.force_n else { return Vec::new() };
    let time_s = run.measured.trace.time_s();
    let driven = |index: usize| {
        force[index].is_finite()
            && force[index] != 0.0
            && run.motion.value[index].abs() > SLOWEST_M_S
            && run.acceleration_m_s2[index].is_finite()
    };
    let mut all = Vec::new();
    let mut from = 0;
    while from + 1 < time_s.len() {
        let to = (from + 1..time_s.len()).find(|index| time_s[*index] - time_s[from] >= BLOCK_S);
        let Some(to) = to else { break };
        if (from..=to).all(driven) {
            let made = run.acceleration_m_s2[from..to].iter().sum::<f64>() / (to - from) as f64;
            let told = (run.motion.value[to] - run.motion.value[from]) / (time_s[to] - time_s[from]);
            all.push((made, told));
        }
        from = to;
    }
    all
}
