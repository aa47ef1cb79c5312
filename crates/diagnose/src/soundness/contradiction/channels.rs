//! Channels that cannot both be right.

use super::{FEWEST_ROWS, TOGETHER};
use crate::Case;
use crate::balances::balance::{Kind, System};
use crate::runs::recorded::Recorded;
use headland_calibrate::statistics::median;
use headland_units::constants::STANDARD_GRAVITY_M_S2;

/// Windows over which positions and speeds are held against each other [s].
const WINDOW_S: f64 = 5.0;
/// Windows over which forces and powers are [s]: within them a coarse speed climbs one of its steps at most, which no sample
/// by itself can be asked.
const SECOND_S: f64 = 1.0;
/// Speed and position contradict each other where they differ by more than this share in most windows: no scale of a
/// sensor is that wrong.
const APART: f64 = 0.3;
/// A window in which the vehicle goes less far tells nothing [m].
const SHORTEST_M: f64 = 5.0;
/// A vehicle that coasts faster and faster needs a slope; a steeper one than this is no unrecorded slope of a level path.
const STEEPEST: f64 = 0.12;
/// So long it has to last [s].
const LASTS_S: f64 = 2.0;
/// Faster than this is speeding up [m/s²].
const SPEEDS_UP_M_S2: f64 = 0.1;
/// Places of a path that both directions share [m].
const PLACE_M: f64 = 20.0;
/// A vehicle whose mass is off by this factor is another one: no payload of a road or field vehicle reaches it.
const OTHER_VEHICLE: f64 = 1.8;
/// Force and acceleration have to go together this well for that to be said (squared correlation).
const TOGETHER_ENOUGH: f64 = 0.5;
/// Two channels that ought to rise together and fall together as well as this contradict each other.
const OPPOSED: f64 = -0.7;

/// Runs by name, the first few of them.
fn listed(runs: &[&str]) -> String {
    const SHOWN: usize = 4;
    let first = runs.iter().take(SHOWN).copied().collect::<Vec<_>>().join(", ");
    if runs.len() > SHOWN { format!("{first} and {} more", runs.len() - SHOWN) } else { first }
}

/// Speed and position, window by window.
pub fn positions(case: &Case) -> Option<String> {
    let mut runs: Vec<&str> = Vec::new();
    let mut ratios = Vec::new();
    for drive in &case.runs {
        let trace = &drive.measured.trace;
        let (Some(position), time_s) = (trace.get("position_m"), trace.time_s()) else { continue };
        let speed = &drive.motion.value;
        let (mut told, mut bad) = (0, 0);
        let mut own = Vec::new();
        for (from, to) in windows(time_s, WINDOW_S) {
            let far: f64 = (from..to)
                .map(|i| 0.5 * (speed[i] + speed[i + 1]) * (time_s[i + 1] - time_s[i]))
                .sum::<f64>()
                .abs();
            let moved = (position[to] - position[from]).abs();
            if far.is_finite() && moved.is_finite() && far.max(moved) > SHORTEST_M {
                told += 1;
                bad += usize::from((far - moved).abs() > APART * far.max(moved));
                own.push(moved / far.max(1e-3));
            }
        }
        if 2 * bad > told {
            runs.push(&drive.measured.id);
            ratios.push(median(&own));
        }
    }
    (!runs.is_empty()).then(|| {
        format!(
            "Speed and position contradict each other in {}: the position moves {:.2} times as far as the speed says.",
            listed(&runs),
            median(&ratios)
        )
    })
}

fn flagged(drive: &Recorded) -> Option<&[f64]> {
    drive.measured.trace.get("coasting")
}

/// Vehicles that speed up while nothing drives them, by more than a slope could.
pub fn coasting(case: &Case) -> Option<String> {
    let free = |drive: &Recorded, index: usize| {
        let coasts = flagged(drive).is_some_and(|flags| flags[index] >= 0.5);
        coasts.then_some(0.0)
    };
    let (runs, steepest) = faster_than_driven(case, free);
    (!runs.is_empty()).then(|| {
        format!(
            "{} flagged as coasting while the vehicle speeds up in {}: beside the scenario's path this would take a \
             slope of {:.0} % downhill. The flag or the speed is wrong.",
            if runs.len() == 1 { "Samples are" } else { "Samples of several runs are" },
            listed(&runs),
            100.0 * steepest
        )
    })
}

/// Vehicles that speed up by more than their recorded force and a slope could: a force that was not connected, or is in
/// another unit.
pub fn unforced(case: &Case) -> Option<String> {
    let driven = |drive: &Recorded, index: usize| {
        let coasts = flagged(drive).is_some_and(|flags| flags[index] >= 0.5);
        drive.force_n.as_ref().filter(|_| !coasts).map(|force| force[index])
    };
    let (runs, steepest) = faster_than_driven(case, driven);
    (2 * runs.len() > case.runs.len()).then(|| {
        format!(
            "The vehicle speeds up more than its recorded force can, in {}: beside the scenario's path this would take a \
             slope of {:.0} % downhill. The force is not all that drives, or is not in the unit that it claims.",
            listed(&runs),
            100.0 * steepest
        )
    })
}

/// Runs in which the vehicle speeds up for a while though the `force` [N] of each sample and a slope could not make it,
/// and the steepest slope that it would take.
fn faster_than_driven<'a>(
    case: &'a Case<'_>,
    force: impl Fn(&Recorded, usize) -> Option<f64>,
) -> (Vec<&'a str>, f64) {
    let mut runs: Vec<&str> = Vec::new();
    let mut steepest = 0.0_f64;
    for (drive, said) in case.runs.iter().zip(&case.nominal) {
        let time_s = drive.measured.trace.time_s();
        let mut lasts_s = 0.0;
        let mut slopes = Vec::new();
        for (from, to) in windows(time_s, SECOND_S) {
            let forces: Option<Vec<f64>> = (from..to).map(|i| force(drive, i)).collect();
            let Some(forces) = forces else { continue };
            let mean = |of: &dyn Fn(usize) -> f64| (from..to).map(of).sum::<f64>() / (to - from) as f64;
            let gains = mean(&|i| drive.motion.slope[i]);
            let held_back = mean(&|i| (said.resistance_n[i] - forces[i - from]) / said.effective_mass_kg[i]);
            let slope = (gains + held_back) / STANDARD_GRAVITY_M_S2;
            if gains > SPEEDS_UP_M_S2 && slope > STEEPEST {
                lasts_s += time_s[to] - time_s[from];
                slopes.push(slope);
            }
        }
        if lasts_s > LASTS_S {
            runs.push(&drive.measured.id);
            steepest = steepest.max(median(&slopes));
        }
    }
    (runs, steepest)
}

/// Windows of so long and little more [s], one after the other: first sample and the one behind the last.
fn windows(time_s: &[f64], long_s: f64) -> Vec<(usize, usize)> {
    let mut all = Vec::new();
    let mut from = 0;
    while let Some(to) = (from + 1..time_s.len()).find(|to| time_s[*to] - time_s[from] >= long_s) {
        all.push((from, to));
        from = to;
    }
    all
}

/// Vehicles that speed up coasting at the same place both ways: no slope and no wind does that.
pub fn coasting_both_ways(case: &Case) -> Option<String> {
    use std::collections::BTreeMap;
    // Path and place: seconds and gain of speed, along and against.
    let mut places: BTreeMap<(usize, i64), [(f64, f64); 2]> = BTreeMap::new();
    for drive in &case.runs {
        let Some(flags) = flagged(drive) else { continue };
        let against = usize::from(drive.measured.how.reversed_from_m.is_some());
        let time_s = drive.measured.trace.time_s();
        for i in 1..time_s.len() {
            let (step_s, slope) = (time_s[i] - time_s[i - 1], drive.motion.slope[i]);
            if flags[i] >= 0.5 && slope.is_finite() && drive.position_m[i].is_finite() {
                // Positions of vehicles fit.
                #[allow(clippy::cast_possible_truncation, reason = "metres of a path")]
                let place = (drive.position_m[i] / PLACE_M).floor() as i64;
                let own = &mut places.entry((drive.path, place)).or_default()[against];
                own.0 += step_s;
                own.1 += step_s * slope;
            }
        }
    }
    let both = |ways: &&[(f64, f64); 2]| {
        ways.iter().all(|(lasts_s, gained)| *lasts_s > 1.0 && *gained > SPEEDS_UP_M_S2 * lasts_s)
    };
    let lasts_s: f64 = places.values().filter(both).map(|ways| ways[0].0 + ways[1].0).sum();
    (lasts_s > 2.0 * LASTS_S).then(|| {
        format!(
            "For {lasts_s:.0} s the vehicle is flagged as coasting and speeds up, at the same places in both directions: \
             no slope and no wind does that. The flag or the speed is wrong."
        )
    })
}

/// Sums of pairs of numbers.
#[derive(Default)]
struct Pairs {
    all: Vec<(f64, f64)>,
}

impl Pairs {
    /// Slope of the second over the first by least squares, and the squared correlation with its sign.
    fn slope(&self) -> Option<(f64, f64)> {
        let count = self.all.len() as f64;
        if self.all.len() < FEWEST_ROWS {
            return None;
        }
        let mean = |of: fn(&(f64, f64)) -> f64| self.all.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|pair| pair.0), mean(|pair| pair.1));
        let sum = |of: &dyn Fn(&(f64, f64)) -> f64| self.all.iter().map(of).sum::<f64>();
        let (xx, yy) = (sum(&|pair| (pair.0 - x).powi(2)), sum(&|pair| (pair.1 - y).powi(2)));
        let xy = sum(&|pair| (pair.0 - x) * (pair.1 - y));
        (xx > 0.0 && yy > 0.0).then(|| (xy / xx, xy.abs() * xy / (xx * yy)))
    }
}

/// What drives against what is moved: the mass that force and acceleration show.
pub fn forces(case: &Case, system: &System) -> Option<String> {
    let (mut driving, mut everywhere) = (Vec::new(), Pairs::default());
    let mut masses = Vec::new();
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for chunk in system.chunks.iter().filter(|chunk| system.kind(chunk) == Kind::Motion) {
        let (drive, said) = (&case.runs[chunk.run], &case.nominal[chunk.run]);
        let Some(force) = &drive.force_n else { continue };
        let (time_s, speed) = (drive.measured.trace.time_s(), drive.measured.trace.get("speed_m_s")?);
        for group in chunk.rows.chunks_exact(TOGETHER) {
            let mean = |of: &dyn Fn(&crate::balances::rows::Row) -> f64| {
                group.iter().map(of).sum::<f64>() / group.len() as f64
            };
            let free = flagged(drive).is_some_and(|flags| mean(&|row| row.mean(flags)) > 0.0);
            let needed = mean(&|row| row.mean(force) - row.mean(&said.resistance_n));
            let gains = mean(&|row| row.slope(time_s, speed));
            let drives = mean(&|row| row.mean(force));
            if !free && drives.is_finite() && needed.is_finite() && gains.is_finite() {
                everywhere.all.push((gains, needed));
                rows.push((drives, mean(&|row| row.mean(speed))));
                masses.push(mean(&|row| row.mean(&said.effective_mass_kg)));
            }
        }
    }
    let strongest = rows.iter().map(|(force, _)| *force).fold(0.0, f64::max);
    for ((force, speed), pair) in rows.iter().zip(&everywhere.all) {
        // Where brakes may slow the vehicle down, force says nothing of its mass.
        if *force > 0.05 * strongest && pair.0 > -SPEEDS_UP_M_S2 {
            driving.push((*speed, *pair));
        }
    }
    if let Some((_, together)) = everywhere.slope()
        && together < -OPPOSED.powi(2)
    {
        return Some(
            "The recorded force or torque drives one way while the vehicle speeds up the other way: they contradict each \
             other. The sign of one of the two is wrong, or the gear is not that of the scenario."
                .to_owned(),
        );
    }
    let mass = median(&masses);
    // Noise of the acceleration lowers the one, other forces raise the other: the mass lies between them.
    let shown = |driving: &[(f64, (f64, f64))]| {
        let pairs = Pairs { all: driving.iter().map(|(_, pair)| *pair).collect() };
        let (low, together) = pairs.slope().filter(|(_, together)| *together >= TOGETHER_ENOUGH)?;
        let high = low / together;
        (low > OTHER_VEHICLE * mass || high < mass / OTHER_VEHICLE).then_some((low, high))
    };
    let (low, high) = shown(&driving)?;
    // A mass is the same at every speed; what is lost of a force need not be.
    driving.sort_by(|one, other| one.0.total_cmp(&other.0));
    let (slower, faster) = driving.split_at(driving.len() / 2);
    let another = [slower, faster].iter().all(|part| part.len() < FEWEST_ROWS || shown(part).is_some());
    another.then(|| {
        format!(
            "The recording is not of this vehicle, or its force is not in the unit that it claims: force and \
             acceleration show a mass of {:.0} to {:.0} kg, and the scenario has {mass:.0} kg.",
            low.min(high),
            low.max(high)
        )
    })
}

/// Mechanical against electrical power.
pub fn powers(case: &Case) -> Option<String> {
    let mut pairs = Pairs::default();
    for drive in &case.runs {
        let (Some(force), Some(battery)) = (&drive.force_n, drive.measured.trace.get("battery_power_w"))
        else {
            continue;
        };
        for (from, to) in windows(drive.measured.trace.time_s(), SECOND_S) {
            let mean = |of: &dyn Fn(usize) -> f64| (from..to).map(of).sum::<f64>() / (to - from) as f64;
            let moved = mean(&|i| force[i] * drive.motion.value[i]);
            let drawn = mean(&|i| battery[i]);
            if moved.is_finite() && drawn.is_finite() {
                pairs.all.push((moved, drawn));
            }
        }
    }
    let (_, together) = pairs.slope()?;
    (together < -OPPOSED.powi(2)).then(|| {
        "Torque and battery contradict each other: the battery is charged while the torque drives, and discharged while \
         it brakes. The sign of one of the two is wrong (current is positive when the battery is discharged)."
            .to_owned()
    })
}
