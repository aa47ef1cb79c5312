//! Curvature that nobody recorded: the rate of turn over the speed, or how the heading changes along the way. It is made where a
//! vehicle really turns: further than a lane bends by the noise of a compass, and so hard that its tyres could tell.

use crate::statistics::{median, quantile_of_sorted, sorted};
use headland_recording::{RecordedRun, Recording, renewed_s};
use headland_sim::{Model, local_fit};
use headland_trace::{Origin, Trace, TraceError};
use std::f64::consts::{PI, TAU};

/// What is made.
pub const CURVATURE: &str = "curvature_per_m";
/// What it is made of, the better first.
const SOURCES: [&str; 2] = ["yaw_rate_rad_s", "heading_rad"];
/// Slower than this a vehicle crawls: no tyre is asked for a side force, and a rate of turn over next to nothing is noise [m/s].
const SLOWEST_M_S: f64 = 0.7;
/// Half widths of the fit [s]: the least that shows the turns clearly. A driver takes two seconds or more to turn in.
const HALF_S: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
/// A fit holds so many renewals to either side, at least.
const RENEWALS: f64 = 3.0;
/// Turns are clear where their rate is so many times its own noise: that adds a hundredth to its square.
const CLEAR: f64 = 10.0;
/// And they are turns at all where it is so many times that.
const TURNS: f64 = 5.0;
/// The rate of turns: all but this share of the samples turn less, of noise alone all but as many less than thrice its size.
const TURNING: f64 = 0.995;
/// A turn changes the heading by this much, half a right angle or more with what the driver leaves [rad]: a lane that is held by
/// hand wanders by less.
const LEAST_TURN_RAD: f64 = 0.5;
/// A side acceleration below this bends no tyre noticeably [m/s²].
const LEAST_SIDE_M_S2: f64 = 0.2;
/// No vehicle turns tighter than this [1/m]: a circle of 2 m.
const TIGHTEST_PER_M: f64 = 0.5;
/// A step of the heading beyond what the vehicle could have turned and this is none of its own: the other direction of a lane,
/// or a compass that went astray [rad].
const STEP_RAD: f64 = 0.1;
/// Noise makes no step of so many times the median one: six standard deviations.
const NOISE_STEP: f64 = 9.0;
/// A heading with more such steps than this share of its samples says nothing.
const MOST_STEPS: f64 = 0.02;
/// Fewer samples make no turn.
const FEWEST: usize = 50;

/// Runs by name, each with what its curvature is made of.
pub type Made = Vec<(String, &'static str)>;

/// What turns a run shows.
struct Turned {
    source: &'static str,
    curvature_per_m: Vec<f64>,
    clear: bool,
}

/// Whether the path of a model is straight: no curvature is known of it but what was recorded.
pub fn is_straight(model: &Model) -> bool {
    /// So far a path without an end is looked along [m], in so many steps.
    const FAR_M: f64 = 1000.0;
    const STEPS: u32 = 500;
    let (from_m, to_m) = model.terrain.extent_m().unwrap_or((0.0, FAR_M));
    let at = |step: u32| from_m + (to_m - from_m) * f64::from(step) / f64::from(STEPS);
    (0..=STEPS).all(|step| model.terrain.at(at(step)).curvature_per_m == 0.0)
}

/// The recording with curvature in all runs where some lack it, each can make it, and any of them turns; and which those are,
/// with what theirs is made of. None where nothing is made.
///
/// # Errors
/// [`TraceError`]: a bug.
pub fn with_curvature(recording: &Recording) -> Result<Option<(Recording, Made)>, TraceError> {
    let none = || Ok(None);
    let recorded = |run: &RecordedRun| run.trace.get(CURVATURE).is_some();
    let mut made: Vec<Option<Turned>> = Vec::new();
    for run in &recording.runs {
        if recorded(run) {
            made.push(None);
            continue;
        }
        let Some(turned) = turned(&run.trace) else { return none() };
        made.push(Some(turned));
    }
    let turns = recording.runs.iter().any(recorded) || made.iter().flatten().any(|turned| turned.clear);
    if !turns || made.iter().all(Option::is_none) {
        return none();
    }
    let mut own = recording.clone();
    let mut told = Vec::new();
    for (run, turned) in own.runs.iter_mut().zip(made) {
        let Some(turned) = turned else { continue };
        run.trace.push(CURVATURE, turned.curvature_per_m, Origin::Measured)?;
        told.push((run.id.clone(), turned.source));
    }
    Ok(Some((own, told)))
}

/// The turns of a run by what shows them best; none where nothing does.
fn turned(trace: &Trace) -> Option<Turned> {
    let known = |name: &str| {
        let count = |values: &[f64]| values.iter().filter(|value| value.is_finite()).count();
        trace.get(name).is_some_and(|values| count(values) >= FEWEST)
    };
    let speed = ["speed_m_s", "wheel_speed_m_s"].iter().find(|name| known(name))?;
    let source = SOURCES.into_iter().find(|name| known(name))?;
    let time_s = trace.time_s();
    let values = trace.get(source)?;
    let is_rate = source == SOURCES[0];
    let renewed_s = renewed_s(trace, source);
    let mut last = None;
    for half_s in HALF_S.map(|half_s| half_s.max(RENEWALS * renewed_s)) {
        let speed_m_s = local_fit(time_s, trace.get(speed)?, half_s).value;
        let unwrapped =
            if is_rate { values.to_vec() } else { continuous_rad(time_s, values, &speed_m_s, renewed_s)? };
        let fit = local_fit(time_s, &unwrapped, half_s);
        let rate_rad_s = &if is_rate { fit.value.clone() } else { held_at_ends(time_s, &fit.slope, half_s) };
        let moving: Vec<usize> = (0..time_s.len())
            .filter(|index| speed_m_s[*index] >= SLOWEST_M_S && rate_rad_s[*index].is_finite())
            .collect();
        let off: Vec<f64> = moving.iter().map(|index| unwrapped[*index] - fit.value[*index]).collect();
        let off: Vec<f64> = off.into_iter().filter(|off| off.is_finite()).collect();
        let noise = (off.iter().map(|off| off * off).sum::<f64>() / off.len().max(1) as f64).sqrt();
        // Of a parabola of least squares through n evenly spaced values: its middle, and its slope there.
        let count = (2.0 * half_s / renewed_s).max(1.0);
        let noise_rad_s =
            if is_rate { 1.5 * noise / count.sqrt() } else { noise * (3.0 / count).sqrt() / half_s };
        let most = |of: &dyn Fn(usize) -> f64| {
            let all: Vec<f64> = moving.iter().map(|index| of(*index)).collect();
            if all.is_empty() { 0.0 } else { quantile_of_sorted(&sorted(&all), TURNING) }
        };
        let turning_rad_s = most(&|index| rate_rad_s[index].abs());
        let side_m_s2 = most(&|index| rate_rad_s[index].abs() * speed_m_s[index]);
        let turns = turning_rad_s > TURNS * noise_rad_s
            && side_m_s2 > LEAST_SIDE_M_S2
            && range_rad(time_s, rate_rad_s, &moving) > LEAST_TURN_RAD;
        let curvature = |index: usize| {
            let (rate, speed) = (rate_rad_s[index], speed_m_s[index]);
            if speed < SLOWEST_M_S { 0.0 } else { (rate / speed).clamp(-TIGHTEST_PER_M, TIGHTEST_PER_M) }
        };
        let curvature_per_m = (0..time_s.len()).map(curvature).collect();
        last = Some(Turned { source, curvature_per_m, clear: turns });
        if turns && turning_rad_s > CLEAR * noise_rad_s {
            break;
        }
    }
    last
}

/// A slope that stays as it is where its fit has samples to one side alone, which know it several times worse.
fn held_at_ends(time_s: &[f64], slope: &[f64], half_s: f64) -> Vec<f64> {
    let (Some(begin_s), Some(end_s)) = (time_s.first(), time_s.last()) else { return slope.to_vec() };
    let first = time_s.partition_point(|time| *time < begin_s + half_s);
    let end = time_s.partition_point(|time| *time <= end_s - half_s);
    if first >= end {
        return slope.to_vec();
    }
    (0..slope.len()).map(|index| slope[index.clamp(first, end - 1)]).collect()
}

/// A heading without leaps: through north, and where it changes by more than any vehicle turns meanwhile. None where that is
/// often.
fn continuous_rad(
    time_s: &[f64],
    heading_rad: &[f64],
    speed_m_s: &[f64],
    renewed_s: f64,
) -> Option<Vec<f64>> {
    let wrapped = |change: f64| (change + PI).rem_euclid(TAU) - PI;
    let known = heading_rad.iter().copied().filter(|heading| heading.is_finite()).collect::<Vec<f64>>();
    let changes: Vec<f64> = known.windows(2).map(|pair| wrapped(pair[1] - pair[0]).abs()).collect();
    let noise_rad = if changes.is_empty() { 0.0 } else { NOISE_STEP * median(&changes) };
    // Where noise turns by a right angle nobody knows which way round it went.
    if noise_rad > 0.5 * PI {
        return None;
    }
    let mut made = heading_rad.to_vec();
    let mut last: Option<usize> = None;
    let (mut steps, mut count) = (0usize, 0usize);
    for index in 0..made.len() {
        if !heading_rad[index].is_finite() {
            continue;
        }
        if let Some(last) = last {
            let turn = wrapped(heading_rad[index] - heading_rad[last]);
            let speed_m_s = if speed_m_s[index].is_finite() { speed_m_s[index].abs() } else { 0.0 };
            let since_s = renewed_s.max(time_s[index] - time_s[last]);
            let able = TIGHTEST_PER_M * speed_m_s * since_s + STEP_RAD.max(noise_rad);
            let own = turn.abs() <= able;
            if speed_m_s >= SLOWEST_M_S {
                count += 1;
                steps += usize::from(!own);
            }
            made[index] = made[last] + if own { turn } else { 0.0 };
        }
        last = Some(index);
    }
    (steps as f64 <= MOST_STEPS * count as f64).then_some(made)
}

/// By how much the heading that a rate makes changes while the vehicle moves [rad].
fn range_rad(time_s: &[f64], rate_rad_s: &[f64], moving: &[usize]) -> f64 {
    let (mut heading, mut low, mut high) = (0.0f64, 0.0f64, 0.0f64);
    for pair in moving.windows(2).filter(|pair| pair[1] == pair[0] + 1) {
        heading += 0.5 * (rate_rad_s[pair[0]] + rate_rad_s[pair[1]]) * (time_s[pair[1]] - time_s[pair[0]]);
        (low, high) = (low.min(heading), high.max(heading));
    }
    high - low
}

/// What is said of it.
pub fn told(made: &[(String, &'static str)]) -> Vec<String> {
    let one = |source: &str| {
        let runs: Vec<&str> =
            made.iter().filter(|(_, own)| *own == source).map(|(run, _)| run.as_str()).collect();
        (!runs.is_empty()).then(|| {
            format!(
                "In {} no `{CURVATURE}` was recorded; it is made of `{source}` and the speed.",
                runs.join(", ")
            )
        })
    };
    SOURCES.into_iter().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Draws;

    /// A run of 60 s at 3 m/s and 20 Hz.
    fn run(heading_rad: impl Fn(f64, &mut Draws) -> f64) -> Trace {
        let mut draws = Draws::new(5, 0);
        let time: Vec<f64> = (0..1200).map(|index| 0.05 * f64::from(index)).collect();
        let heading = time.iter().map(|time| heading_rad(*time, &mut draws).rem_euclid(TAU)).collect();
        let mut trace = Trace::new(time).unwrap();
        trace.push("speed_m_s", vec![3.0; 1200], Origin::Measured).unwrap();
        trace.push("heading_rad", heading, Origin::Measured).unwrap();
        trace
    }

    /// Half a turn within 10 s, over north: 0.314 rad/s at 3 m/s, 0.105 per metre.
    fn half_turn(time_s: f64) -> f64 {
        PI * ((time_s - 25.0) / 10.0).clamp(0.0, 1.0) - 1.0
    }

    fn clear(trace: &Trace) -> bool {
        turned(trace).is_some_and(|turned| turned.clear)
    }

    #[test]
    fn a_turn_is_made_of_the_heading_through_its_noise() {
        for noise in [0.0, 0.01, 0.03, 0.05] {
            let made = turned(&run(|time, draws| half_turn(time) + noise * draws.normal())).unwrap();
            let middle = made.curvature_per_m[550..650].iter().sum::<f64>() / 100.0;
            assert!(made.clear && (middle - 0.1047).abs() < 0.006, "{noise}: {middle}");
            assert!(made.curvature_per_m[..400].iter().all(|own| own.abs() < 0.05));
        }
    }

    #[test]
    fn a_rate_of_turn_is_taken_before_a_heading_and_nothing_turns_at_a_crawl() {
        let mut trace = run(|time, _| half_turn(time));
        let rate = |index: usize| if (500..700).contains(&index) { 0.3 } else { 0.0 };
        trace.push("yaw_rate_rad_s", (0..1200).map(rate).collect(), Origin::Measured).unwrap();
        let made = turned(&trace).unwrap();
        assert!(made.source == "yaw_rate_rad_s" && (made.curvature_per_m[600] - 0.1).abs() < 1e-9);
        let mut slow = Trace::new(trace.time_s().to_vec()).unwrap();
        for channel in trace.channels() {
            let values = match channel.name.as_str() {
                "speed_m_s" => vec![0.2; 1200],
                _ => channel.values.clone(),
            };
            slow.push(channel.name.clone(), values, Origin::Measured).unwrap();
        }
        let made = turned(&slow).unwrap();
        assert!(!made.clear && made.curvature_per_m.iter().all(|own| *own == 0.0));
    }

    #[test]
    fn a_straight_lane_makes_no_curvature_however_its_heading_was_written() {
        assert!(!clear(&run(|_, _| 0.6)));
        for noise in [0.03, 0.05, 0.1] {
            assert!(!clear(&run(|_, draws| 0.6 + noise * draws.normal())), "{noise}");
        }
        // Steps of two degrees.
        let coarse = |_: f64, draws: &mut Draws| (0.6 + 0.02 * draws.normal()) / 0.035;
        assert!(!clear(&run(|time, draws| 0.035 * coarse(time, draws).round())));
        // A lane that is driven to and fro, by its direction.
        assert!(!clear(&run(|time, _| if time < 30.0 { 0.6 } else { 0.6 + PI })));
        // Noise that makes any heading of any other.
        assert!(!clear(&run(|_, draws| draws.normal())));
        // A driver who weaves.
        assert!(!clear(&run(|time, _| 0.1 * (0.5 * time).sin())));
    }
}
