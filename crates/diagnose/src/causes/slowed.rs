//! Slopes that go with speed: uphill and on soft ground a vehicle slows down, downhill it runs.
//!
//! Where one run alone drove a path, and a power alone tells what held it back, a map that knows nothing of that takes fast
//! stretches for level ones, and the resistances that grow with speed have to be what the hills were. So beside the map, which
//! forgets itself along the path, the slope may go with the speed and its square. What resistances do with speed is then known
//! from what was known of them before, as it is.
//!
//! Source of the effect: a vehicle at full load climbs at the speed at which its power lasts, as in Wong, *Theory of Ground
//! Vehicles* (2008), section 3.5.

use crate::Case;
use crate::balances::balance::System;
use crate::balances::gram::Column;
use crate::causes::catalogue::{Cause, Form};
use crate::causes::profile::Function;
use crate::runs::recorded::{Recorded, share_paths};

/// Usual part of a slope that goes with speed, as a share of the usual slope.
const USUAL: f64 = 0.5;

/// What the speed of a run is among those of all runs that move.
struct Speeds {
    mean_m_s: f64,
    sd_m_s: f64,
}

impl Speeds {
    /// None where all drove as fast.
    fn of(runs: &[Recorded]) -> Option<Self> {
        let moving = || runs.iter().flat_map(|run| &run.motion.value).copied().filter(|speed| *speed > 0.0);
        let count = moving().count() as f64;
        let mean_m_s = moving().sum::<f64>() / count;
        let sd_m_s = (moving().map(|speed| (speed - mean_m_s).powi(2)).sum::<f64>() / count).sqrt();
        (sd_m_s > 0.0).then_some(Self { mean_m_s, sd_m_s })
    }

    /// The first and the second Hermite polynomial of a speed, each of a mean square of about one.
    fn laws(&self, speed_m_s: f64) -> [f64; 2] {
        let speed = (speed_m_s - self.mean_m_s) / self.sd_m_s;
        [speed, (speed * speed - 1.0) / std::f64::consts::SQRT_2]
    }
}

/// What stands beside a map of a path, from what the map of one does to each row: columns, and how large each usually is.
/// None but for powers, of paths that one run alone drove.
pub fn with_speed(case: &Case, system: &System, cause: &Cause, signature: &Column) -> Vec<(Column, f64)> {
    let chunks = || system.chunks.iter().zip(signature);
    let touches = |values: &nalgebra::DVector<f64>| values.iter().any(|value| *value != 0.0);
    let powers = chunks().all(|(chunk, values)| system.kind(chunk).is_power() || !touches(values));
    if cause.form != Form::OverPosition || !powers || share_paths(&case.runs, &case.fit) {
        return Vec::new();
    }
    let Some(speeds) = Speeds::of(&case.runs) else { return Vec::new() };
    let of = |law: usize| -> Column {
        let chunk = |(chunk, values): (&crate::balances::rows::Chunk, &nalgebra::DVector<f64>)| {
            let speed_m_s = &case.runs[chunk.run].motion.value;
            let laws = chunk.rows.iter().map(|row| speeds.laws(row.mean(speed_m_s))[law]);
            let laws = laws.map(|law| if law.is_finite() { law } else { 0.0 });
            nalgebra::DVector::from_iterator(values.len(), laws).component_mul(values)
        };
        chunks().map(chunk).collect()
    };
    (0..2).map(|law| (of(law), USUAL * cause.terms[0].scale)).collect()
}

/// A map with what goes with speed in it, from the share of each law, at the speeds of the run that drove there.
pub fn joined(case: &Case, function: Function, shares: &[f64]) -> Function {
    let (false, Some(speeds)) = (shares.is_empty(), Speeds::of(&case.runs)) else { return function };
    let mut joined = function;
    for group in 0..joined.groups.len() {
        let own = || case.runs.iter().filter(|run| run.path == group);
        let Some(run) = own().find(|run| case.fit[run.number]).or_else(|| own().next()) else { continue };
        let told = |speed_m_s: f64| -> f64 {
            speeds.laws(speed_m_s).iter().zip(shares).map(|(law, share)| law * share).sum()
        };
        let places = run.position_m.iter().zip(&run.motion.value);
        let told: Vec<(f64, f64)> = places
            .filter(|(place, speed)| place.is_finite() && speed.is_finite())
            .map(|(place, speed)| (*place, told(*speed)))
            .collect();
        joined.add(group, &told);
    }
    joined
}
