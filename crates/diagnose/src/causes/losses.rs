//! What every electric drive does beside a single efficiency: losses that go with products of powers of force and speed, and
//! a current that is measured a moment earlier or later than the torque. They are small, nobody would call them missing
//! physics, and a consumer that is switched must not have to explain them; so they are free in every battery balance.
//!
//! Source of the terms: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.3: copper losses with the
//! square of the torque, iron and windage losses with speed; Mahmoudi, Soong, Pellegrino and Armando, *IEEE ECCE* (2015) 2791,
//! for loss maps as sums of k Tᵐ ωⁿ, those of the inverter and of a weakened field among them.

use crate::Case;
use crate::balances::balance::{Kind, System, longest_renewal_s, shortest_block_s};
use crate::balances::gram::Column;
use crate::balances::rows::Chunk;
use crate::causes::sensors::Small;
use crate::causes::trial::Pool;
use crate::choosing::search::Found;
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::told::words::quantity;
use headland_sim::local_fit;
use nalgebra::{DMatrix, DVector};

/// What the names of all of them begin with.
pub const SMALL_LOSS: &str = "battery_";
/// The loss that goes with the square of speed.
pub const SPEED_SQUARED: &str = "battery_speed_squared";
/// What each of those goes with that an efficiency does not say.
const LARGE_WITH: [(&str, &str); 6] = [
    ("battery_force_squared", "the square of its force"),
    (SPEED_SQUARED, "the square of speed"),
    ("battery_force_size", "the size of its force"),
    ("battery_power_size", "the size of its power"),
    ("battery_power_speed", "its power and its speed"),
    ("battery_power_force", "its power and its force"),
];
/// A loss that nobody would call wrong, as a share of the drive's power, both as root mean squares.
const SMALL: f64 = 0.025;

/// The small losses, where there is a battery balance and a force is known.
pub fn small_losses(case: &Case, system: &System) -> Vec<Small> {
    if !system.has(Kind::Battery) || !case.runs.iter().all(Recorded::force_is_known) {
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
        of("battery_lag", &late, Some(longest_renewal_s(&case.runs, "battery_power_w"))),
        of("battery_force_squared", &|run| products(run, |force, _| force * force), None),
        of(SPEED_SQUARED, &|run| products(run, |_, speed| speed * speed), None),
        of("battery_force_size", &|run| products(run, |force, _| force.abs()), None),
        of("battery_power_size", &|run| products(run, |force, speed| (force * speed).abs()), None),
        of("battery_power_speed", &|run| products(run, |force, speed| (force * speed).abs() * speed), None),
        of("battery_power_force", &|run| products(run, |force, speed| force * force * speed), None),
    ];
    smalls.into_iter().filter(|small| small.sd.is_finite() && small.sd > 0.0).collect()
}

/// What is said of the small loss that is furthest beyond what is usual, where one clearly is: it was free, and no cause.
pub fn remark(case: &Case, system: &System, pool: &Pool, found: &Found) -> Option<String> {
    /// Times its usual size.
    const LARGE: f64 = 1.5;
    /// In its own standard deviations.
    const SURE: f64 = 4.0;
    let of = |(small, with): (&'static str, &'static str)| {
        let (_, column) = pool.small.iter().find(|(id, _)| *id == small)?;
        let place = found.used.iter().position(|used| used == column)?;
        let value = found.estimate.beta[place].abs();
        let times = value / pool.sd[*column];
        let sure = value > SURE * found.estimate.covariance[(place, place)].sqrt();
        (sure && times > LARGE).then(|| {
            let number = system.kinds.iter().position(|kind| *kind == Kind::Battery);
            let squares = system.mean_squares(&pool.columns[*column], &case.fit);
            (times, with, value * number.map_or(0.0, |number| squares[number]).sqrt())
        })
    };
    let all = LARGE_WITH.into_iter().filter_map(of);
    let (times, with, power_w) = all.max_by(|one, other| one.0.total_cmp(&other.0))?;
    Some(format!(
        "Losses of the electric drive beyond its efficiencies were free throughout, and are no cause: the one that goes with {with} \
         takes {} in the root mean square, {times:.1} times what is usual.",
        quantity(power_w, "W")
    ))
}

/// A power that is made of recorded motion changes at once; what is measured of it follows as fast as engine, pump and
/// whatever estimates it. So a part of it may come late, by about a block or by several: nobody would call that missing
/// physics, and the mass must not have to explain it.
///
/// Source: fuel dynamics as first-order lags; Guzzella and Onder, *Introduction to Modeling and Control of Internal Combustion
/// Engine Systems* (2010), section 2.4.
pub fn slow_powers(case: &Case, system: &System) -> Vec<Small> {
    /// Time constants, in blocks.
    const LATE: [(&str, f64); 2] = [("late_power", 1.0), ("later_power", 4.0)];
    /// Usual share of the power that is late by as much.
    const SHARE: f64 = 0.5;
    let block_s = |kind| shortest_block_s(kind, &case.runs, case.rows);
    let of = |(id, blocks): (&'static str, f64)| {
        let column = system.column(|kind| {
            let of_run = |(run, said): (&Recorded, &Said)| match comes_late(kind, run, said) {
                Some(power) => late(run.measured.trace.time_s(), &power, blocks * block_s(kind)),
                None => Vec::new(),
            };
            case.runs.iter().zip(&case.nominal).map(of_run).collect()
        });
        Small { id, column, sd: SHARE }
    };
    let any = |column: &Column| column.iter().any(|chunk| chunk.iter().any(|value| *value != 0.0));
    LATE.into_iter().map(of).filter(|small| any(&small.column)).collect()
}

/// A power that is made of a recorded force and a recorded speed: either may be written as a mean over the time since the last
/// value, half of that late, and the other at once. F v then knows of F a and of v dF/dt, each for half a sample, and no consumer
/// must have to explain it.
pub fn half_samples(case: &Case, system: &System) -> Vec<Small> {
    /// Work that fuel becomes at the wheels, nearly, as a share of its heat.
    const OF_FUEL: f64 = 0.4;
    let step_s = longest_renewal_s(&case.runs, "tractive_force_n")
        .max(longest_renewal_s(&case.runs, "speed_m_s"))
        .max(longest_renewal_s(&case.runs, "fuel_rate_kg_s"));
    let measured = |run: &Recorded| run.measured.trace.get("tractive_force_n").is_some();
    if !case.runs.iter().all(measured) {
        return Vec::new();
    }
    let of = |id: &'static str, samples: fn(&Recorded) -> Vec<f64>| {
        let column = system.column(|kind| {
            let scale = match kind {
                Kind::Fuel => 1.0 / OF_FUEL,
                Kind::Shaft => 1.0,
                _ => return vec![Vec::new(); case.runs.len()],
            };
            let of_run = |run: &Recorded| samples(run).into_iter().map(|power| scale * power).collect();
            case.runs.iter().map(of_run).collect()
        });
        Small { id, column, sd: 0.5 * step_s }
    };
    let all = [
        of("speed_half_a_sample", |run| {
            run.known_force_n().iter().zip(&run.acceleration_m_s2).map(|(force, a)| force * a).collect()
        }),
        of("force_half_a_sample", |run| {
            let slope =
                local_fit(run.measured.trace.time_s(), &run.known_force_n(), run.measured.how.smoothing_s)
                    .slope;
            slope.iter().zip(&run.motion.value).map(|(slope, speed)| slope * speed).collect()
        }),
    ];
    let any = |column: &Column| column.iter().any(|chunk| chunk.iter().any(|value| *value != 0.0));
    all.into_iter().filter(|small| any(&small.column)).collect()
}

/// What a line between fuel and work leaves of an engine whose noise grows with its power: fuel that bends with power and with
/// power at speed, by what no free parameter could say; `free` are their columns.
///
/// Source: second-order terms of fuel maps; Guzzella and Onder, *Introduction to Modeling and Control of Internal Combustion Engine
/// Systems* (2010), section 2.5.
pub fn bent_engine(case: &Case, system: &System, free: &[Column]) -> Vec<Small> {
    /// Of a power and a speed.
    type Product = fn(f64, f64) -> f64;
    /// Of the power of the fuel, both as root mean squares.
    const BENT: f64 = 0.03;
    if !system.bent {
        return Vec::new();
    }
    let column = |of: Product| {
        system.column(|kind| {
            let of_run = |(run, said): (&Recorded, &Said)| match kind {
                Kind::Fuel => {
                    let powers = said.fuel_w();
                    powers.iter().zip(&run.motion.value).map(|(power, speed)| of(*power, *speed)).collect()
                }
                _ => Vec::new(),
            };
            case.runs.iter().zip(&case.nominal).map(of_run).collect()
        })
    };
    let usual = |column: &Column| root_mean_square(system, &case.fit, column);
    let power = column(|power, _| power);
    let even = column(|_, _| 1.0);
    let known: Vec<&Column> = free.iter().chain([&even, &power]).collect();
    let of = |(id, of): (&'static str, Product)| {
        let column = beyond(system, &case.fit, &column(of), &known)?;
        let sd = BENT * usual(&power) / usual(&column);
        Some(Small { id, column, sd })
    };
    let squared: Product = |power, _| power * power;
    let at_speed: Product = |power, speed| power * speed.abs();
    let bends = [("fuel_power_squared", squared), ("fuel_power_speed", at_speed)];
    bends.into_iter().filter_map(of).filter(|small| small.sd.is_finite() && small.sd > 0.0).collect()
}

/// Root mean square of the fitted rows of fuel, each by its own noise.
fn root_mean_square(system: &System, fit: &[bool], column: &Column) -> f64 {
    let rows = system.chunks.iter().zip(column);
    let own = rows.filter(|(chunk, _)| fit[chunk.run] && system.kind(chunk) == Kind::Fuel);
    let (square, count) = own.fold((0.0, 0usize), |(square, count), (chunk, values)| {
        (square + chunk.alike(values).norm_squared(), count + values.len())
    });
    (square / count.max(1) as f64).sqrt()
}

/// What others leave of a column in the rows of fuel, by least squares over the fitted ones; none where they are one.
fn beyond(system: &System, fit: &[bool], column: &Column, others: &[&Column]) -> Option<Column> {
    /// Of the greatest singular value: what is less is no other direction.
    const LEAST: f64 = 1e-9;
    let size = |column: &Column| root_mean_square(system, fit, column);
    let others: Vec<(&Column, f64)> =
        others.iter().map(|other| (*other, size(other))).filter(|(_, size)| *size > 0.0).collect();
    let mut products = DMatrix::<f64>::zeros(others.len(), others.len());
    let mut sides = DVector::<f64>::zeros(others.len());
    for (index, chunk) in system.chunks.iter().enumerate() {
        if !fit[chunk.run] || system.kind(chunk) != Kind::Fuel {
            continue;
        }
        let own = chunk.alike(&column[index]);
        for (row, (other, one)) in others.iter().enumerate() {
            let other = chunk.alike(&other[index]);
            sides[row] += other.dot(&own) / one;
            for (place, (another, size)) in others.iter().enumerate().take(row + 1) {
                let product = other.dot(&chunk.alike(&another[index])) / (one * size);
                products[(row, place)] += product;
                products[(place, row)] = products[(row, place)];
            }
        }
    }
    let shares = products.svd(true, true).solve(&sides, LEAST).ok()?;
    let of_chunk = |(index, chunk): (usize, &Chunk)| {
        let mut left = column[index].clone();
        if system.kind(chunk) == Kind::Fuel {
            for ((other, size), share) in others.iter().zip(&shares) {
                let share: f64 = *share / *size;
                left.axpy(-share, &other[index], 1.0);
            }
        }
        left
    };
    Some(system.chunks.iter().enumerate().map(of_chunk).collect())
}

/// What every engine's own torque is wrong by: it is no measurement, but what its controller makes of injection and speed.
///
/// A scale and an offset, smaller than those that were found on tractors (Marx et al., 1 to 5 % of the greatest torque), so
/// that what lies beyond is still seen.
pub fn torque_errors(case: &Case, system: &System) -> Vec<Small> {
    /// Of the torque, and of the greatest torque.
    const SCALE: f64 = 0.006;
    const OFFSET: f64 = 0.004;
    let of = |id: &'static str, samples: &dyn Fn(usize) -> Vec<f64>, sd: f64| {
        let column = system.column(|kind| {
            let of_run = |run: usize| if kind == Kind::Shaft { samples(run) } else { Vec::new() };
            (0..case.runs.len()).map(of_run).collect()
        });
        Small { id, column, sd }
    };
    if !system.has(Kind::Shaft) {
        return Vec::new();
    }
    let torques = case.runs.iter().filter_map(|run| run.measured.trace.get("engine_torque_n_m"));
    let greatest = torques.flatten().copied().filter(|torque| torque.is_finite()).fold(0.0, f64::max);
    let power = |run: usize| case.nominal[run].engine_w.clone().unwrap_or_default();
    let speed =
        |run: usize| case.runs[run].measured.trace.get("engine_speed_rad_s").unwrap_or_default().to_vec();
    let errors = vec![of("torque_scale", &power, SCALE), of("torque_offset", &speed, OFFSET * greatest)];
    errors.into_iter().filter(|small| small.sd > 0.0).collect()
}

/// The modelled power of a balance that may come late: of an engine, or of what is made of the motion alone [W].
fn comes_late(kind: Kind, run: &Recorded, said: &Said) -> Option<Vec<f64>> {
    match kind {
        Kind::Shaft => said.engine_w.clone(),
        Kind::Charge if !run.force_is_known() => said.drawn_w(run),
        Kind::Fuel => said.fuel_kg_s.is_some().then(|| said.fuel_w()),
        _ => None,
    }
}

/// What a lag of a time constant [s] adds to samples.
fn late(time_s: &[f64], values: &[f64], constant_s: f64) -> Vec<f64> {
    let mut state = f64::NAN;
    let mut before_s = f64::NAN;
    let one = |(time_s, value): (&f64, &f64)| {
        if value.is_finite() {
            let kept = (-(time_s - before_s) / constant_s).exp();
            state = if state.is_finite() { value + (state - value) * kept } else { *value };
            before_s = *time_s;
        }
        state - value
    };
    time_s.iter().zip(values).map(one).collect()
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

#[cfg(test)]
mod tests {
    use super::late;

    /// After a step of one, a lag of a time constant is behind by e⁻¹ of it one time constant later.
    #[test]
    fn a_lag_is_behind_a_step_and_not_behind_what_stands() {
        let time_s: Vec<f64> = (0..60).map(f64::from).collect();
        let step: Vec<f64> = (0..60).map(|index| if index < 20 { 3.0 } else { 4.0 }).collect();
        let behind = late(&time_s, &step, 5.0);
        assert!(behind[19].abs() < 1e-12 && (behind[24] + (-1.0f64).exp()).abs() < 1e-12);
        assert!(behind[59].abs() < 1e-3);
    }
}
