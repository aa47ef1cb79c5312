//! A run that nobody has driven yet, as it would be recorded: simulated with everything that is known, with the channels
//! and the sampling of the runs at hand.

use super::course::{Course, Motion, Without};
use crate::runs::recorded::Recorded;
use crate::runs::said::Said;
use crate::{Case, DiagnoseError};
use headland_calibrate::study::Measured;
use headland_sim::{Drive, Inputs, Model, Replay, local_fit, replay};
use headland_trace::{Origin, Trace};

/// A proposed run is no longer than this [s]: more would be several.
const LONGEST_S: f64 = 300.0;
/// A run that ends sooner tells nothing [s].
const SHORTEST_S: f64 = 5.0;
/// A coasting vehicle has come to rest below this speed [m/s].
const RESTS_M_S: f64 = 0.4;

/// The recorded run that the proposed ones are like: of those that were fitted, the one of middle length.
pub fn base(case: &Case) -> Option<Recorded> {
    let mut fitted: Vec<&Recorded> =
        case.runs.iter().zip(&case.fit).filter(|(_, fit)| **fit).map(|(drive, _)| drive).collect();
    fitted
        .sort_by(|one, other| one.measured.trace.duration_s().total_cmp(&other.measured.trace.duration_s()));
    let middle = *fitted.get(fitted.len() / 2)?;
    Some(shortened(middle))
}

fn shortened(drive: &Recorded) -> Recorded {
    let trace = &drive.measured.trace;
    let Some(&start_s) = trace.time_s().first() else { return drive.clone() };
    let short = trace.slice(start_s, start_s + LONGEST_S);
    let keep = |values: &[f64]| values[..short.len().min(values.len())].to_vec();
    let mut drive = Recorded {
        acceleration_m_s2: keep(&drive.acceleration_m_s2),
        position_m: keep(&drive.position_m),
        force_n: drive.force_n.as_deref().map(keep),
        engine_w: drive.engine_w.as_deref().map(keep),
        pull_n: drive.pull_n.as_deref().map(keep),
        ..drive.clone()
    };
    drive.motion.value.truncate(short.len());
    drive.motion.slope.truncate(short.len());
    drive.measured.compared.truncate(short.len());
    drive.measured.unknown.truncate(short.len());
    drive.stands_in.truncate(short.len());
    drive.measured.trace = short;
    drive
}

/// The run as a course wants it, of which the model is what acts there; none where it would be over before it began. The force is still
/// unknown.
pub fn drafted(
    case: &Case,
    base: &Recorded,
    course: &Course,
    model: &Model,
) -> Result<Option<Recorded>, DiagnoseError> {
    let course = &rolling(base, course);
    let ground = Ground::of(base);
    let Some(known) = ballasted(case, base, course.ballast_kg) else { return Ok(None) };
    let Some((time_s, speed, source)) = motion(base, course, model, &ground)? else { return Ok(None) };
    let mut travelled = vec![0.0];
    for (times, speeds) in time_s.windows(2).zip(speed.windows(2)) {
        let far =
            travelled.last().copied().unwrap_or(0.0) + 0.5 * (speeds[0] + speeds[1]) * (times[1] - times[0]);
        travelled.push(far);
    }
    let reversed = base.measured.how.reversed_from_m.is_some() != course.opposite;
    let position_m: Vec<f64> =
        travelled.iter().map(|far| if reversed { ground.to_m - far } else { ground.from_m + far }).collect();
    let mut trace = Trace::new(time_s.clone())?;
    trace.push("speed_m_s", speed.clone(), Origin::Measured)?;
    trace.push("position_m", position_m.clone(), Origin::Measured)?;
    let along = source.is_some() && !course.opposite;
    for name in CIRCUMSTANCES {
        let Some(values) = base.measured.trace.get(name) else { continue };
        let by_place = matches!(
            *name,
            "heading_rad" | "curvature_per_m" | "grade" | "roll_rad" | "vertical_acceleration_m_s2"
        );
        let flip = |value: f64| match *name {
            _ if !course.opposite => value,
            "heading_rad" => (value + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU),
            "curvature_per_m" | "grade" | "roll_rad" => -value,
            _ => value,
        };
        let at = |index: usize| match (*name, &source) {
            ("wind_speed_m_s", _) if course.without == Without::Wind => 0.0,
            ("grade" | "roll_rad", _) if course.without == Without::Ground => 0.0,
            // Who drives the other way drives throughout: what rolled free would have moved otherwise.
            ("coasting", Some(_)) if course.opposite => 0.0,
            ("coasting", None) => f64::from(u8::from(matches!(course.motion, Motion::Coast { .. }))),
            ("brake", None) => 0.0,
            (_, Some(source)) if along || !by_place => values[source[index]],
            _ if by_place => flip(values[nearest(&base.position_m, position_m[index])]),
            _ => values[values.len() / 2],
        };
        trace.push(*name, (0..time_s.len()).map(at).collect(), Origin::Measured)?;
    }
    // What is measured there does not matter: only what causes would do to it.
    for name in ["specific_force_m_s2", "wheel_speed_m_s", "battery_power_w", "fuel_rate_kg_s"] {
        let carried = course.accelerometer && name == "specific_force_m_s2";
        if carried || base.measured.trace.get(name).is_some() {
            trace.push(name, vec![0.0; time_s.len()], Origin::Measured)?;
        }
    }
    if let Some(charge) = base.measured.trace.get("state_of_charge")
        && base.charge_j.is_some()
    {
        let first = charge.iter().copied().find(|charge| charge.is_finite()).unwrap_or(0.5);
        trace.push("state_of_charge", vec![first; time_s.len()], Origin::Measured)?;
    }
    let engine_w = base.engine_w.as_ref().map(|_| vec![0.0; time_s.len()]);
    let compared = vec![true; time_s.len()];
    let mut how = Replay { reversed_from_m: reversed.then_some(ground.to_m), ..base.measured.how.clone() };
    how.also.retain(|input| input.channels().iter().all(|name| trace.get(name).is_some()));
    let motion = local_fit(&time_s, &speed, how.smoothing_s);
    let measured = Measured {
        id: course.name.to_owned(),
        trace,
        how,
        held_out: false,
        compared,
        unknown: Vec::new(),
        signals: base.measured.signals.clone(),
        known,
    };
    let acceleration_m_s2 = motion.slope.clone();
    Ok(Some(Recorded {
        measured,
        number: base.number,
        motion,
        acceleration_m_s2,
        position_m,
        path: base.path,
        force_n: None,
        stands_in: Vec::new(),
        unknown: Vec::new(),
        leaps: Vec::new(),
        placed: false,
        engine_w,
        pull_n: None,
        charge_j: base.charge_j,
    }))
}

/// The course as a vehicle takes it that rolls free throughout: whatever acts otherwise moves it otherwise, as nothing makes up for it.
fn rolling(base: &Recorded, course: &Course) -> Course {
    let free = base.measured.how.drive == Drive::Coast;
    let first = base.motion.value.iter().copied().find(|speed| speed.is_finite());
    let motion = match (&course.motion, first) {
        (Motion::AsRecorded, Some(from_m_s)) if free && course.alters() => Motion::Coast { from_m_s },
        (own, _) => own.clone(),
    };
    Course { motion, ..course.clone() }
}

/// What is known of a run with ballast; none where the scenario has no one mass.
pub fn ballasted(case: &Case, base: &Recorded, ballast_kg: f64) -> Option<Vec<(String, f64)>> {
    let mut known = base.measured.known.clone();
    if ballast_kg == 0.0 {
        return Some(known);
    }
    let document = case.study.scenario().document();
    let path = document.resolve("mass_kg").ok()?;
    if let Some((_, value)) = known.iter_mut().find(|(own, _)| *own == path) {
        *value += ballast_kg;
        return Some(known);
    }
    let free = case.study.paths().iter().position(|own| *own == path);
    let usual_kg =
        free.map_or_else(|| document.number(&path), |free| Some(case.study.parameters[free].value));
    known.push((path, usual_kg? + ballast_kg));
    Some(known)
}

/// Channels that say under which circumstances a run was driven.
const CIRCUMSTANCES: &[&str] = &[
    "heading_rad",
    "curvature_per_m",
    "roll_rad",
    "vertical_acceleration_m_s2",
    "grade",
    "coasting",
    "brake",
    "air_temperature_c",
    "oil_temperature_c",
    "wind_speed_m_s",
    "wind_direction_rad",
    "auxiliary_power_w",
    "drawbar_force_n",
];

/// Gives a drafted run the force that its motion takes, where the runs at hand measure one.
pub fn forced(drive: &mut Recorded, base: &Recorded, said: &Said) -> Result<(), DiagnoseError> {
    if base.force_n.is_none() {
        return Ok(());
    }
    let coasting = drive.measured.trace.get("coasting").map(<[f64]>::to_vec);
    let force: Vec<f64> = (0..said.resistance_n.len())
        .map(|index| {
            let free = coasting.as_ref().is_some_and(|coasting| coasting[index] >= 0.5);
            let takes = said.resistance_n[index] + said.effective_mass_kg[index] * drive.motion.slope[index];
            if free { 0.0 } else { takes }
        })
        .collect();
    if matches!(base.forward(), Some(Drive::Force | Drive::Torque)) {
        drive.measured.trace.push("tractive_force_n", force.clone(), Origin::Measured)?;
    }
    drive.force_n = Some(force);
    Ok(())
}

/// The stretch that the base run drove [m].
struct Ground {
    from_m: f64,
    to_m: f64,
}

impl Ground {
    fn of(base: &Recorded) -> Self {
        let (mut from_m, mut to_m) = (f64::INFINITY, f64::NEG_INFINITY);
        for position in base.position_m.iter().filter(|position| position.is_finite()) {
            (from_m, to_m) = (from_m.min(*position), to_m.max(*position));
        }
        if from_m < to_m { Self { from_m, to_m } } else { Self { from_m: 0.0, to_m: 0.0 } }
    }
}

/// Times, speeds, and of which recorded sample each is the like.
type Moved = (Vec<f64>, Vec<f64>, Option<Vec<usize>>);

fn motion(
    base: &Recorded,
    course: &Course,
    model: &Model,
    ground: &Ground,
) -> Result<Option<Moved>, DiagnoseError> {
    let recorded_s = base.measured.trace.time_s();
    let (Some(&start_s), Some(&end_s)) = (recorded_s.first(), recorded_s.last()) else { return Ok(None) };
    let count = recorded_s.len();
    let period_s = (end_s - start_s) / (count.max(2) - 1) as f64;
    let times =
        |count: usize| (0..count).map(|index| start_s + period_s * index as f64).collect::<Vec<f64>>();
    let lane_m = ground.to_m - ground.from_m;
    let longest = |speed: f64| {
        let lasts_s =
            if lane_m > 0.0 { (end_s - start_s).min(lane_m / speed.max(RESTS_M_S)) } else { end_s - start_s };
        recorded_s.partition_point(|time| *time <= start_s + lasts_s)
    };
    let moved = match course.motion {
        Motion::AsRecorded => (recorded_s.to_vec(), base.motion.value.clone(), Some((0..count).collect())),
        Motion::Longer { back_m_s2 } => {
            // Between two rounds it is brought gently to the speed that they begin with.
            let (first, last) = (base.motion.value[0], base.motion.value[count - 1]);
            let step = back_m_s2 * period_s * (first - last).signum();
            let between = ((first - last).abs() / (back_m_s2 * period_s)).floor().min(count as f64);
            let (mut speed, mut source) = (Vec::new(), Vec::new());
            for round in 0..3 {
                if round > 0 {
                    let mut now = last + step;
                    while (first - now) * step > 0.0 && ((now - last) / step) < between {
                        speed.push(now);
                        source.push(0);
                        now += step;
                    }
                }
                speed.extend_from_slice(&base.motion.value);
                source.extend(0..count);
            }
            (times(source.len()), speed, Some(source))
        }
        Motion::Hold { speed_m_s } => {
            let count = longest(speed_m_s);
            (times(count), vec![speed_m_s; count], None)
        }
        Motion::TwoForces { between_m_s: (low, high), at_m_s2: (gentle, hard) } => {
            let (mut speed, mut slope) = (vec![low], hard);
            let mut turns = 0usize;
            for _ in 1..longest(0.5 * (low + high)) {
                let next = speed.last().copied().unwrap_or(low) + slope * period_s;
                if next >= high || next <= low {
                    turns += 1;
                    slope = if turns % 2 == 1 {
                        -gentle
                    } else if turns % 4 == 2 {
                        gentle
                    } else {
                        hard
                    };
                }
                speed.push(next.clamp(low, high));
            }
            (times(speed.len()), speed, None)
        }
        Motion::Coast { from_m_s } => {
            let time_s = times(count);
            let mut trace = Trace::new(time_s.clone())?;
            trace.push("speed_m_s", vec![from_m_s; count], Origin::Measured)?;
            let reversed = base.measured.how.reversed_from_m.is_some() != course.opposite;
            let how = Replay {
                drive: Drive::Coast,
                also: Vec::<Inputs>::new(),
                window_s: None,
                reversed_from_m: reversed.then_some(ground.to_m),
                ..base.measured.how.clone()
            };
            let failed = |error| DiagnoseError::Replay { run: course.name.to_owned(), error };
            let outcome = replay(model, &trace, &how).map_err(failed)?.trace;
            let speed = outcome.get("speed_m_s").unwrap_or(&[]);
            let mut far = 0.0;
            let rolls = |speed: &&f64| {
                far += **speed * period_s;
                **speed > RESTS_M_S && (lane_m <= 0.0 || far <= lane_m)
            };
            let speed: Vec<f64> = speed.iter().take_while(rolls).copied().collect();
            (time_s[..speed.len()].to_vec(), speed, None)
        }
    };
    let lasts_s = match moved.0[..] {
        [first, .., last] => last - first,
        _ => 0.0,
    };
    Ok((lasts_s >= SHORTEST_S).then_some(moved))
}

/// The sample at which a run was nearest to a place.
fn nearest(position_m: &[f64], at_m: f64) -> usize {
    let falls = position_m.first() > position_m.last();
    let before = |position: &f64| if falls { *position > at_m } else { *position < at_m };
    position_m.partition_point(before).min(position_m.len().saturating_sub(1))
}
