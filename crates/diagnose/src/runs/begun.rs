//! Coast-downs whose recorded speed goes on for a moment as it was before: the sensor is late, or the runs begin before neutral.
//! Left as it is, that moment would be a slope at the place where the runs begin, or a brake let go.
//!
//! v(t) = b − (1 + k) |a| (max(0, d − t) + t),   b and a of each run, d and k of all
//!
//! b is the speed that the rest of a run goes back to, a what the nominal model makes of the resistances, k by how much it is
//! wrong. d is looked for on a grid, b and k by least squares; it counts where the speed goes on as it was, as a delay makes it, and
//! does not merely bend, as a curve of the resistances or a push would. Source: change-point regression with a continuous line;
//! Seber and Wild, *Nonlinear Regression* (1989), section 9.3.

use crate::causes::sensors::{corrected, small_latency_s};
use crate::proof::refine::HALF_95;
use crate::proof::widths::FILTER_SD_S;
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::soundness::faults::{Fault, place};
use crate::told::report::Interval;
use crate::{Case, DiagnoseError};
use headland_sim::Drive;
use nalgebra::{Matrix2, Vector2};

/// The fault that it is.
const LATENCY: &str = "latency";
/// No receiver is later than this, and no driver [s].
const LONGEST_S: f64 = 0.8;
/// Filters of loggers take so long, all channels alike [s].
const FILTERED_S: f64 = 0.05;
/// So much of a run is looked at [s].
const WINDOW_S: f64 = 2.5;
/// Delays are tried so far apart [s].
const STEP_S: f64 = 0.01;
/// Fewer runs may have begun late by chance …
const FEWEST: usize = 3;
/// … but for as many whose accelerometer shows that they slow down from their begin on.
const FEWEST_SHOWN: usize = 2;
/// Growth of ln p from which on a bend is none of the noise.
const LEAST_GAIN: f64 = 20.0;
/// The bend is as deep as a delay makes it, within this share.
const AS_DEEP: f64 = 0.35;
/// A delay says at least this share of what any bend there does.
const MOSTLY: f64 = 0.9;
/// An accelerometer that shows less than this share of the deceleration says that the vehicle was not yet in neutral.
const IN_NEUTRAL: f64 = 0.5;

/// How late the speed of runs that coast from their begin on is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Late {
    /// The delay [s].
    pub value: f64,
    /// Its standard deviation [s].
    pub sd: f64,
    /// Whether the sensor is late, as far as an accelerometer can tell; none where there is no accelerometer.
    pub sensor: Option<bool>,
}

/// One run's begin.
struct Begin {
    time_s: Vec<f64>,
    speed_m_s: Vec<f64>,
    /// What the model's deceleration takes from the speed up to a sample [m/s].
    fallen_m_s: Vec<f64>,
    /// The deceleration at the begin [m/s²].
    slows_m_s2: f64,
}

/// How late the speed of coast-downs is; none where it is not, or where too few tell. Beside runs that are driven an accelerometer has
/// to say that it is the sensor: those may have begun in any way.
pub fn late(case: &Case) -> Option<Late> {
    if !case.wanted(LATENCY) {
        return None;
    }
    let coasts = case.coasts();
    let coasting = || case.runs.iter().zip(&case.nominal).zip(&coasts).filter(|(_, coasts)| **coasts);
    let begins: Vec<Begin> = coasting().filter_map(|((run, said), _)| begin(run, said)).collect();
    if begins.len() < FEWEST_SHOWN {
        return None;
    }
    let told = told(&begins)?;
    let sensor = in_neutral(coasting().map(|(both, _)| both), told.value);
    let known = sensor == Some(true) || !coasts.contains(&false) && begins.len() >= FEWEST;
    (known && told.value > small_latency_s(case)).then_some(Late { sensor, ..told })
}

impl Case<'_> {
    /// Which runs coast from their begin on: all, where nothing can have driven any, else those of which a flag says so. What power alone tells
    /// of may have been driven.
    fn coasts(&self) -> Vec<bool> {
        let driven = self.driven() || !self.runs.iter().all(Recorded::force_is_known);
        self.runs.iter().map(|run| !driven || run.forward() == Some(Drive::Coast)).collect()
    }
}

/// Sets a late speed right in all runs, or leaves out what was recorded before neutral. A fault, where it is the sensor's.
pub fn set_right(
    case: &mut Case,
    late: Late,
    usable: &mut [Vec<bool>],
) -> Result<Option<Fault>, DiagnoseError> {
    let stretches = case.runs.iter().map(|run| {
        let time_s = run.measured.trace.time_s();
        let until = time_s.iter().take_while(|time| **time < time_s[0] + late.value).count();
        // A run may be over before its delay is.
        place(run, 0, until.min(time_s.len() - 1))
    });
    let stretches: Vec<Interval> = stretches.collect();
    if late.sensor == Some(false) {
        for (run, usable) in case.runs.iter().zip(usable) {
            let time_s = run.measured.trace.time_s();
            let before = time_s.iter().take_while(|time| **time <= time_s[0] + late.value).count();
            usable[..before].fill(false);
        }
        case.study.notes.push(format!(
            "The speed falls only {:.2} s after the begin of the runs, and the accelerometer shows nothing before: they begin \
             before neutral. Those samples were left out.",
            late.value
        ));
        return Ok(None);
    }
    if late.sensor.is_none() {
        case.study.notes.push(
            "No accelerometer tells whether the speed is late or the runs begin before neutral; either way the speed belongs to \
             what happened before."
                .to_owned(),
        );
    }
    case.raw = corrected(&case.raw, LATENCY, late.value)?;
    case.runs.clone_from(&case.raw);
    case.late_s = Some(late.value);
    case.no_faults.push(LATENCY);
    case.suppose()?;
    let half = HALF_95 * late.sd;
    if late.value - half < FILTERED_S {
        case.study.notes.push(format!(
            "Speed goes on as it was for {:.2} s at the begin of the coast-downs, which the filter of a logger does: that is no fault, \
             and it was corrected.",
            late.value
        ));
        return Ok(None);
    }
    // Nobody knows how much of what comes late the logger's filter delayed, which is no fault.
    let half = HALF_95 * late.sd.hypot(FILTER_SD_S);
    Ok(Some(Fault {
        id: LATENCY,
        channel: "speed_m_s".to_owned(),
        size: late.value,
        ci95: Some([late.value - half, late.value + half]),
        leaps: false,
        unit: "s".to_owned(),
        stretches,
    }))
}

fn begin(run: &Recorded, said: &Said) -> Option<Begin> {
    let time_s = run.measured.trace.time_s();
    let speed = run.measured.trace.get("speed_m_s")?;
    let count = time_s.iter().take_while(|time| **time < time_s[0] + WINDOW_S).count();
    // It has to begin in time, and to have samples on both sides of any bend.
    if count < 8 || time_s[count - 1] - time_s[0] < 0.8 * WINDOW_S || !run.stands_in.is_empty() {
        return None;
    }
    let slows: Vec<f64> =
        (0..count).map(|index| said.resistance_n[index] / said.effective_mass_kg[index]).collect();
    if slows.iter().chain(&speed[..count]).any(|value| !value.is_finite()) || slows[0] <= 0.0 {
        return None;
    }
    let mut fallen = vec![0.0];
    for index in 1..count {
        let mean = 0.5 * (slows[index - 1] + slows[index]);
        fallen.push(fallen[index - 1] + mean * (time_s[index] - time_s[index - 1]));
    }
    Some(Begin {
        time_s: time_s[..count].iter().map(|time| time - time_s[0]).collect(),
        speed_m_s: speed[..count].to_vec(),
        fallen_m_s: fallen,
        slows_m_s2: slows[0],
    })
}

/// The delay that suits all begins best.
fn told(begins: &[Begin]) -> Option<Late> {
    let prompt = left(begins, 0.0)?;
    // Counts of a grid of fractions of a second.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small and positive")]
    let steps = (LONGEST_S / STEP_S) as u32;
    let all: Vec<(f64, Left)> = (1..=steps)
        .filter_map(|step| {
            let delay_s = f64::from(step) * STEP_S;
            Some((delay_s, left(begins, delay_s)?))
        })
        .collect();
    let (delay_s, best) = all.iter().min_by(|one, other| one.1.squares.total_cmp(&other.1.squares))?;
    let samples: usize = begins.iter().map(|one| one.time_s.len()).sum();
    let freedom = samples.checked_sub(begins.len() + 2).filter(|freedom| *freedom > 0)?;
    let variance = (best.squares / freedom as f64).max(f64::MIN_POSITIVE);
    let gain = 0.5 * (prompt.squares - best.squares) / variance;
    let bent = all.iter().map(|one| one.1.bent).fold(f64::INFINITY, f64::min);
    let of_a_delay = prompt.squares - best.squares > MOSTLY * (prompt.squares - bent);
    if gain < LEAST_GAIN || (best.deep - 1.0).abs() > AS_DEEP || !of_a_delay {
        return None;
    }
    // Where the sum of squares has grown by its variance.
    let near = all.iter().filter(|(_, left)| left.squares < best.squares + variance);
    let farthest = near.map(|(other, _)| (other - delay_s).abs()).fold(0.0, f64::max);
    Some(Late { value: *delay_s, sd: farthest.max(STEP_S), sensor: None })
}

/// What a delay leaves.
struct Left {
    /// Sum of squares [m²/s²].
    squares: f64,
    /// The same where the bend may be of any depth [m²/s²].
    bent: f64,
    /// How deep the bend is, in units of what the delay makes: how much of the later slope is not there yet.
    deep: f64,
}

fn left(begins: &[Begin], delay_s: f64) -> Option<Left> {
    let (mut one, mut both) = (Sums::default(), Sums::default());
    for begin in begins {
        let bends = begin.time_s.iter().map(|time| -begin.slows_m_s2 * (delay_s - time).max(0.0));
        let bends = centred(&bends.collect::<Vec<_>>());
        let falls = centred(&begin.fallen_m_s.iter().map(|fallen| -fallen).collect::<Vec<_>>());
        let speed = centred(&begin.speed_m_s);
        for ((bend, fall), speed) in bends.iter().zip(&falls).zip(&speed) {
            // The bend as deep as the delay makes it, whatever the model is wrong by.
            one.add(fall + bend, 0.0, *speed);
            both.add(*fall, *bend, *speed);
        }
    }
    let wrong = one.cross[0] / one.products[(0, 0)];
    let squares = one.square - wrong * one.cross[0];
    let (bent, deep) = both.products.try_inverse().map_or((squares, 0.0), |inverse| {
        let slopes = inverse * both.cross;
        (both.square - slopes.dot(&both.cross), slopes[1] / slopes[0])
    });
    squares.is_finite().then_some(Left { squares, bent, deep })
}

#[derive(Default)]
struct Sums {
    products: Matrix2<f64>,
    cross: Vector2<f64>,
    square: f64,
}

impl Sums {
    fn add(&mut self, fall: f64, bend: f64, value: f64) {
        let row = Vector2::new(fall, bend);
        self.products += row * row.transpose();
        self.cross += row * value;
        self.square += value * value;
    }
}

fn centred(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|value| value - mean).collect()
}

/// Whether the accelerometers of the runs show the deceleration from the begin on.
fn in_neutral<'a>(runs: impl Iterator<Item = (&'a Recorded, &'a Said)>, delay_s: f64) -> Option<bool> {
    let (mut shown, mut made, mut samples) = (0.0, 0.0, 0usize);
    for (run, said) in runs {
        let trace = &run.measured.trace;
        let Some(specific) = trace.get("specific_force_m_s2") else { continue };
        let begin_s = trace.time_s()[0];
        let count = trace.time_s().iter().take_while(|time| **time < begin_s + delay_s).count();
        for index in (0..count).filter(|index| specific[*index].is_finite()) {
            shown -= specific[index];
            made += said.resistance_n[index] / said.effective_mass_kg[index];
            samples += 1;
        }
    }
    (samples > 0).then_some(shown > IN_NEUTRAL * made)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six coast-downs that slow down by 0.8 m/s², some of them the faster the faster they are, in steps of a tenth of a second.
    fn begins(delay_s: f64, wrong: f64) -> Vec<Begin> {
        let mut draws = headland_calibrate::statistics::Draws::new(3, 0);
        (0..6)
            .map(|run| {
                let time_s: Vec<f64> = (0..25).map(|step| 0.1 * f64::from(step)).collect();
                let slows_m_s2 = 0.7 + 0.04 * f64::from(run);
                let speed =
                    |time: &f64| 8.0 - wrong * slows_m_s2 * (time - delay_s).max(0.0) + 0.03 * draws.normal();
                Begin {
                    speed_m_s: time_s.iter().map(speed).collect(),
                    fallen_m_s: time_s.iter().map(|time| slows_m_s2 * time).collect(),
                    time_s,
                    slows_m_s2,
                }
            })
            .collect()
    }

    #[test]
    fn a_delay_is_found_beside_a_resistance_that_is_wrong() {
        for wrong in [0.85, 1.0, 1.15] {
            let told = told(&begins(0.25, wrong)).unwrap();
            assert!((told.value - 0.25).abs() < 3.0 * told.sd && told.sd < 0.05, "{told:?}");
        }
    }

    /// A force with a clock of its own that pushes by less at first: the speed falls from the begin on, and faster later.
    #[test]
    fn a_speed_that_falls_from_the_begin_on_is_not_late_however_it_bends() {
        let mut bent = begins(0.5, 1.0);
        for begin in &mut bent {
            for (time, speed) in begin.time_s.iter().zip(&mut begin.speed_m_s) {
                *speed -= 0.9 * begin.slows_m_s2 * time;
            }
        }
        assert_eq!(told(&bent), None);
    }

    #[test]
    fn a_prompt_speed_is_not_late_whatever_the_resistance() {
        for wrong in [0.85, 1.0, 1.15] {
            assert_eq!(told(&begins(0.0, wrong)), None);
        }
    }
}
