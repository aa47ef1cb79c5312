//! Speeds that no vehicle can have: a receiver that says nought for a moment, or a sample far from all others.
//!
//! Such a stretch begins with a leap and ends with a leap back, each of which would take more than tyres can give. A vehicle
//! that brakes to a stand leaps nowhere, and one whose sensor says nought below some speed does not leap far.

use headland_calibrate::statistics::median;
use headland_recording::renewed_s;
use headland_trace::Trace;

/// Tyres and ground give no vehicle more than about 1.5 g [m/s²].
const MOST_M_S2: f64 = 15.0;
/// No vehicle stops and is off again by half of g within moments [m/s²]; a wheel that locks does, and that is no speed over ground.
const MOST_OF_NOUGHT_M_S2: f64 = 5.0;
const OVER_GROUND: &str = "speed_m_s";
/// Sensors that count teeth, and radars, say nought below 0.5 to 1.4 m/s; a step from there is none of these leaps [m/s].
const LEAST_M_S: f64 = 1.5;
/// Where a sensor does leap further elsewhere in the run, a step from so little is one too [m/s].
const LEAST_AGAIN_M_S: f64 = 0.5;
/// And a leap is so many times the usual step: of white noise one in a million is this far from both neighbours.
const STEPS: f64 = 10.0;
/// What lasts longer is no moment: the channel says something else there [s].
const LONGEST_S: f64 = 10.0;
/// Back where it was: within this share of the leap.
const BACK: f64 = 0.5;
/// So few samples in a row, and so short a gap [s], are taken as what lies between their neighbours: a vehicle's speed does not
/// bend further in the time than noise.
const FEW: usize = 2;
const SHORT_S: f64 = 0.5;

/// First and last sample of every stretch of a speed that no vehicle can have.
pub fn leaps(trace: &Trace, name: &str) -> Vec<(usize, usize)> {
    let far = further(trace, name, LEAST_M_S);
    if far.is_empty() { far } else { further(trace, name, LEAST_AGAIN_M_S) }
}

/// The same, of leaps by more than `least_m_s`.
fn further(trace: &Trace, name: &str, least_m_s: f64) -> Vec<(usize, usize)> {
    let Some(values) = trace.get(name) else { return Vec::new() };
    let time_s = trace.time_s();
    let known: Vec<usize> = (0..values.len()).filter(|index| values[*index].is_finite()).collect();
    let step = |place: usize| values[known[place]] - values[known[place - 1]];
    let moves: Vec<f64> = (1..known.len()).map(|place| step(place).abs()).filter(|one| *one > 0.0).collect();
    if moves.is_empty() {
        return Vec::new();
    }
    let (usual, renewed_s) = (median(&moves), renewed_s(trace, name));
    let leap = |place: usize| {
        let passed_s = (time_s[known[place]] - time_s[known[place - 1]]).max(renewed_s);
        let nought = [place - 1, place].iter().any(|place| values[known[*place]] == 0.0);
        let able_m_s2 = if nought && name == OVER_GROUND { MOST_OF_NOUGHT_M_S2 } else { MOST_M_S2 };
        let most = (able_m_s2 * passed_s).max(STEPS * usual).max(least_m_s);
        Some(step(place)).filter(|step| step.abs() > most)
    };
    let mut all = Vec::new();
    let mut place = 1;
    while place < known.len() {
        let Some(away) = leap(place) else {
            place += 1;
            continue;
        };
        let (from, before) = (known[place], values[known[place - 1]]);
        let soon = |other: &usize| time_s[known[*other]] - time_s[from] <= LONGEST_S;
        let returns = |other: &usize| {
            let back = leap(*other).is_some_and(|step| step * away < 0.0);
            back && (values[known[*other]] - before).abs() < BACK * away.abs()
        };
        place += 1;
        let Some(mut end) = (place..known.len()).take_while(soon).find(returns) else { continue };
        // A filter of the sensor makes several steps of one leap.
        while end + 1 < known.len() && leap(end + 1).is_some_and(|step| step * away < 0.0) {
            end += 1;
        }
        all.push((from, known[end] - 1));
        place = end + 1;
    }
    all
}

/// The channel without its leaps: what lies between where it is a sample or two, and else nothing.
pub fn without(trace: &Trace, name: &str, leaps: &[(usize, usize)]) -> Vec<f64> {
    let time_s = trace.time_s();
    let mut values = trace.get(name).unwrap_or(&[]).to_vec();
    for (from, to) in leaps {
        values[*from..=*to].fill(f64::NAN);
        let (before, after) = (from - 1, to + 1);
        let whole = values[before].is_finite() && values[after].is_finite();
        if whole && to - from < FEW && time_s[after] - time_s[before] <= SHORT_S {
            let slope = (values[after] - values[before]) / (time_s[after] - time_s[before]);
            for index in *from..=*to {
                values[index] = values[before] + slope * (time_s[index] - time_s[before]);
            }
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_calibrate::statistics::Draws;
    use headland_trace::Origin;

    /// Rolling out from 8 m/s by 0.25 m/s², with noise, changed sample by sample.
    fn rolling(changed: impl Fn(usize, f64) -> f64) -> Trace {
        let mut draws = Draws::new(5, 0);
        let mut trace = Trace::new((0..800).map(|index| 0.05 * f64::from(index)).collect()).unwrap();
        let speed = (0..800).map(|index| (8.0 - 0.0125 * f64::from(index)).max(0.0) + 0.03 * draws.normal());
        let speed = speed.enumerate().map(|(index, speed)| changed(index, speed)).collect();
        trace.push("speed_m_s", speed, Origin::Measured).unwrap();
        trace
    }

    fn found(changed: impl Fn(usize, f64) -> f64) -> Vec<(usize, usize)> {
        leaps(&rolling(changed), "speed_m_s")
    }

    #[test]
    fn a_speed_that_is_nought_for_a_moment_leaps_and_so_does_a_sample_far_above() {
        let nought = |index: usize, speed: f64| {
            if (200..=229).contains(&index) || index == 300 { 0.0 } else { speed }
        };
        assert_eq!(found(nought), [(200, 229), (300, 300)]);
        let last = |index: usize, speed: f64| if [300, 560].contains(&index) { 0.0 } else { speed };
        assert_eq!(found(last), [(300, 300), (560, 560)], "at 1 m/s, by a sensor that leaps elsewhere");
        assert_eq!(found(|index, speed| if index == 77 { 31.0 } else { speed }), [(77, 77)]);
        // A filter takes two samples to follow.
        let slow = |index: usize, speed: f64| match index {
            200 | 231 => 0.5 * speed,
            201..=230 => 0.0,
            _ => speed,
        };
        assert_eq!(found(slow), [(200, 231)]);
    }

    #[test]
    fn a_vehicle_that_stops_leaps_nowhere() {
        assert_eq!(found(|_, speed| speed), []);
        // Full brakes to a stand, and off again by as much.
        let stops = |index: usize, speed: f64| match index {
            100..200 => (speed - 0.4 * (index - 99) as f64).max(0.0),
            200..300 => (0.15 * (index - 200) as f64).min(speed),
            _ => speed,
        };
        assert_eq!(found(stops), []);
        assert_eq!(found(|index, speed| if index >= 400 { 0.0 } else { speed }), [], "it stays");
        assert_eq!(found(|_, speed| if speed < 1.4 { 0.0 } else { speed }), [], "a sensor that counts teeth");
        let coarse = |_: usize, speed: f64| (speed / 0.28).round() * 0.28;
        assert_eq!(found(coarse), [], "steps of resolution");
    }

    /// 2 m/s within a fifth of a second are less than 1.5 g, and yet nobody drives off like that.
    #[test]
    fn nought_between_two_walking_speeds_is_a_leap_of_a_receiver_and_none_of_a_wheel() {
        let walking = |name: &str| {
            let mut trace = Trace::new((0..200).map(|index| 0.2 * f64::from(index)).collect()).unwrap();
            let speed = |index: usize| {
                if (50..54).contains(&index) { 0.0 } else { 2.0 + 0.03 * (1.3 * index as f64).sin() }
            };
            trace.push(name, (0..200).map(speed).collect(), Origin::Measured).unwrap();
            leaps(&trace, name)
        };
        assert_eq!(walking("speed_m_s"), [(50, 53)]);
        assert_eq!(walking("wheel_speed_m_s"), []);
    }

    /// Renewed once a second: 0.9 s of full brakes are one step of 7 m/s.
    #[test]
    fn a_step_of_a_channel_that_is_renewed_slowly_is_no_leap() {
        let held: Vec<f64> = rolling(|_, speed| speed).get("speed_m_s").unwrap().to_vec();
        let slow = |index: usize, _: f64| {
            let speed = held[index / 20 * 20];
            if (320..380).contains(&index) { (speed - 7.0).max(0.0) } else { speed }
        };
        assert_eq!(found(slow), []);
    }

    #[test]
    fn a_sample_or_two_is_what_lies_between_and_more_is_nothing() {
        let trace =
            rolling(|index, speed| if (200..=229).contains(&index) || index == 300 { 0.0 } else { speed });
        let values = without(&trace, "speed_m_s", &leaps(&trace, "speed_m_s"));
        assert!((200..=229).all(|index| values[index].is_nan()));
        assert!((values[300] - 0.5 * (values[299] + values[301])).abs() < 1e-12);
    }
}
