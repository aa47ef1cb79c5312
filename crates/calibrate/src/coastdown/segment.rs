//! The stretch of a run in which the vehicle rolls out, and what is known along it.

use super::{CoastDownError, CoastRun, Settings};
use headland_trace::Trace;
use headland_units::constants::STANDARD_GRAVITY_M_S2;

/// Fewest samples that make a coast-down.
const LEAST_SAMPLES: usize = 8;
/// Least speed lost in one [m/s].
const LEAST_DROP_M_S: f64 = 0.5;
/// A rise of smoothed speed that ends a deceleration [m/s].
const RISE_M_S: f64 = 0.15;
/// Width of smoothing where the deceleration has to be found [s].
const SMOOTHING_S: f64 = 1.0;

/// One coast-down, ready for fitting.
#[derive(Clone, Debug)]
pub struct Coast {
    /// Name of the run.
    pub id: String,
    /// Index of the run in the study.
    pub run: usize,
    /// Index of its path.
    pub path: usize,
    /// +1 along the path, −1 reversed.
    pub sign: f64,
    /// Mass [kg].
    pub mass_kg: f64,
    /// Mass with rotating parts [kg].
    pub effective_mass_kg: f64,
    /// ½ ρ CdA [kg/m], where it is known.
    pub half_density_drag_area_kg_m: Option<f64>,
    /// Time from the first sample [s].
    pub time_s: Vec<f64>,
    /// Measured speed [m/s].
    pub speed_m_s: Vec<f64>,
    /// Surroundings at each sample.
    pub ambient: Vec<Ambient>,
    /// Time of the first sample in the trace [s].
    pub from_s: f64,
}

/// What acts on the vehicle from outside at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ambient {
    /// Wind from behind [m/s].
    pub tailwind_m_s: f64,
    /// Wind across [m/s].
    pub crosswind_m_s: f64,
    /// Recorded grade in the direction of travel, rise over run.
    pub grade: f64,
}

impl Ambient {
    /// Between two moments.
    pub fn between(self, other: Self, share: f64) -> Self {
        let mix = |from: f64, to: f64| from + share * (to - from);
        Self {
            tailwind_m_s: mix(self.tailwind_m_s, other.tailwind_m_s),
            crosswind_m_s: mix(self.crosswind_m_s, other.crosswind_m_s),
            grade: mix(self.grade, other.grade),
        }
    }
}

impl Coast {
    /// Last measured speed [m/s].
    pub fn last_m_s(&self) -> f64 {
        self.speed_m_s.last().copied().unwrap_or(f64::NAN)
    }

    /// Duration [s].
    pub fn duration_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or(0.0)
    }

    /// Weight of the vehicle [N].
    pub fn weight_n(&self) -> f64 {
        self.mass_kg * STANDARD_GRAVITY_M_S2
    }
}

/// Finds the coast-down of a run.
///
/// # Errors
/// [`CoastDownError`] where speed is missing or nothing rolls out.
pub fn coast_of(
    run: &CoastRun,
    index: usize,
    path: usize,
    settings: &Settings,
) -> Result<Coast, CoastDownError> {
    let trace = &run.trace;
    let speed =
        trace.require("speed_m_s").map_err(|source| CoastDownError::Trace { run: run.id.clone(), source })?;
    let time = trace.time_s();
    let (first, end) = match trace.get("coasting") {
        Some(coasting) => longest(coasting, trace.get("brake"), time),
        None => deceleration(time, speed),
    };
    let (from, to) = match (time.get(first), time.get(end.saturating_sub(1))) {
        (Some(from), Some(to)) => (from + settings.trim_s, to - settings.trim_s),
        _ => (0.0, -1.0),
    };
    let slow = (first..end).find(|at| time[*at] >= from && speed[*at] < settings.lowest_speed_m_s);
    let kept: Vec<usize> = (first..slow.unwrap_or(end))
        .filter(|at| speed[*at].is_finite() && time[*at] >= from && (slow.is_some() || time[*at] <= to))
        .collect();
    let drop_m_s = match (kept.first(), kept.last()) {
        (Some(first), Some(last)) => speed[*first] - speed[*last],
        _ => 0.0,
    };
    if kept.len() < LEAST_SAMPLES || drop_m_s < LEAST_DROP_M_S {
        return Err(CoastDownError::NoCoasting {
            run: run.id.clone(),
            samples: kept.len(),
            drop_m_s,
            least_samples: LEAST_SAMPLES,
            least_drop_m_s: LEAST_DROP_M_S,
        });
    }
    let from_s = time[kept[0]];
    Ok(Coast {
        id: run.id.clone(),
        run: index,
        path,
        sign: if run.reversed { -1.0 } else { 1.0 },
        mass_kg: run.mass_kg.value,
        effective_mass_kg: run.effective_mass_kg(),
        half_density_drag_area_kg_m: run
            .drag_area_m2
            .zip(run.air_density_kg_m3)
            .map(|(area, density)| 0.5 * density.value * area.value),
        time_s: kept.iter().map(|at| time[*at] - from_s).collect(),
        speed_m_s: kept.iter().map(|at| speed[*at]).collect(),
        ambient: kept.iter().map(|at| ambient(trace, run.heading_rad, *at)).collect(),
        from_s,
    })
}

fn ambient(trace: &Trace, heading_rad: Option<f64>, at: usize) -> Ambient {
    let sample = |name| trace.get(name).map(|values| values[at]).filter(|value| value.is_finite());
    let wind = sample("wind_speed_m_s").zip(sample("wind_direction_rad"));
    let heading = sample("heading_rad").or(heading_rad);
    let (tailwind_m_s, crosswind_m_s) = wind.zip(heading).map_or((0.0, 0.0), |((speed, from), heading)| {
        (-speed * (from - heading).cos(), speed * (from - heading).sin())
    });
    Ambient { tailwind_m_s, crosswind_m_s, grade: sample("grade").unwrap_or(0.0) }
}

/// The longest stretch in neutral and unbraked, as a half-open range.
fn longest(coasting: &[f64], brake: Option<&[f64]>, time: &[f64]) -> (usize, usize) {
    let free =
        |at: usize| coasting[at] > 0.5 && brake.is_none_or(|brake| brake[at].is_nan() || brake[at] < 0.5);
    let mut best = (0, 0);
    let mut start = None;
    for at in 0..=coasting.len() {
        if at < coasting.len() && free(at) {
            start.get_or_insert(at);
        } else if let Some(from) = start.take() {
            let duration =
                |(from, end): (usize, usize)| if end > from { time[end - 1] - time[from] } else { -1.0 };
            if duration((from, at)) > duration(best) {
                best = (from, at);
            }
        }
    }
    best
}

/// The stretch in which smoothed speed falls furthest without rising, as a half-open range.
fn deceleration(time: &[f64], speed: &[f64]) -> (usize, usize) {
    let smooth = smoothed(time, speed);
    let (mut best, mut best_drop) = ((0, 0), 0.0);
    let Some(first) = smooth.iter().position(|value| value.is_finite()) else { return best };
    let (mut top, mut bottom) = (first, first);
    for at in first..smooth.len() {
        let value = smooth[at];
        if value.is_nan() {
            continue;
        }
        if value > smooth[bottom] + RISE_M_S || (top == bottom && value >= smooth[top]) {
            (top, bottom) = (at, at);
        }
        if value < smooth[bottom] {
            bottom = at;
        }
        if smooth[top] - smooth[bottom] > best_drop {
            best_drop = smooth[top] - smooth[bottom];
            best = (top, bottom + 1);
        }
    }
    best
}

/// Centred moving mean over [`SMOOTHING_S`], missing samples passed over.
fn smoothed(time: &[f64], values: &[f64]) -> Vec<f64> {
    let (mut from, mut end) = (0, 0);
    let (mut sum, mut count) = (0.0, 0_usize);
    let mut smooth = Vec::with_capacity(values.len());
    for centre in time {
        while end < time.len() && time[end] <= centre + 0.5 * SMOOTHING_S {
            if values[end].is_finite() {
                sum += values[end];
                count += 1;
            }
            end += 1;
        }
        while time[from] < centre - 0.5 * SMOOTHING_S {
            if values[from].is_finite() {
                sum -= values[from];
                count -= 1;
            }
            from += 1;
        }
        smooth.push(if count == 0 { f64::NAN } else { sum / count as f64 });
    }
    smooth
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coastdown::Constant;
    use headland_trace::Origin;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn run(channels: &[(&str, Vec<f64>)]) -> CoastRun {
        let samples = channels[0].1.len();
        let mut trace = Trace::new((0..samples).map(|at| at as f64 * 0.1).collect()).unwrap();
        for (name, values) in channels {
            trace.push(*name, values.clone(), Origin::Measured).unwrap();
        }
        CoastRun {
            id: "r1".to_owned(),
            trace,
            path: None,
            reversed: false,
            mass_kg: Constant::exact(1000.0),
            rotating_mass_kg: Constant::exact(50.0),
            drag_area_m2: None,
            air_density_kg_m3: None,
            heading_rad: Some(0.0),
        }
    }

    fn untrimmed() -> Settings {
        Settings { trim_s: 0.0, ..Settings::default() }
    }

    /// Up to 8 m/s in 4 s, 2 s level, down at 1 m/s², standing.
    fn drive() -> Vec<f64> {
        (0..160)
            .map(|at| {
                let t = f64::from(at) * 0.1;
                if t < 4.0 { 2.0 * t } else { (8.0 - (t - 6.0).max(0.0)).max(0.0) }
            })
            .collect()
    }

    #[test]
    fn the_roll_out_is_found_without_being_told() {
        let coast = coast_of(&run(&[("speed_m_s", drive())]), 0, 0, &untrimmed()).unwrap();
        assert!((coast.from_s - 6.0).abs() < 0.6, "{}", coast.from_s);
        let last = coast.speed_m_s.last().unwrap();
        assert!((0.5..0.7).contains(last), "{last}");
    }

    #[test]
    fn the_clutch_decides_where_it_was_logged_and_the_brake_ends_it() {
        let coasting = (0..160).map(|at| f64::from(u8::from((70..120).contains(&at)))).collect();
        let brake = (0..160).map(|at| f64::from(u8::from(at >= 110))).collect();
        let logged = run(&[("speed_m_s", drive()), ("coasting", coasting), ("brake", brake)]);
        let coast = coast_of(&logged, 0, 0, &untrimmed()).unwrap();
        assert!((coast.from_s - 7.0).abs() < 1e-9 && coast.time_s.len() == 40);
        let coast = coast_of(&logged, 0, 0, &Settings::default()).unwrap();
        assert!((coast.from_s - 7.5).abs() < 1e-9 && coast.time_s.len() == 30);
    }

    #[test]
    fn a_run_that_never_slows_is_refused_with_what_was_found() {
        let error = coast_of(&run(&[("speed_m_s", vec![8.0; 50])]), 0, 0, &untrimmed()).unwrap_err();
        assert!(matches!(error, CoastDownError::NoCoasting { .. }), "{error}");
        let error = coast_of(&run(&[("grade", vec![0.0; 50])]), 0, 0, &untrimmed()).unwrap_err();
        assert!(error.to_string().contains("no channel `speed_m_s`"), "{error}");
    }

    /// Driving north: wind from the south pushes, from the east crosses.
    #[test]
    fn wind_is_split_by_where_it_blows_from() {
        for (from, tail, cross) in [(PI, 5.0, 0.0), (FRAC_PI_2, 0.0, 5.0), (0.0, -5.0, 0.0)] {
            let windy = run(&[
                ("speed_m_s", drive()),
                ("wind_speed_m_s", vec![5.0; 160]),
                ("wind_direction_rad", vec![from; 160]),
            ]);
            let ambient = coast_of(&windy, 0, 0, &untrimmed()).unwrap().ambient[0];
            assert!((ambient.tailwind_m_s - tail).abs() < 1e-9, "{ambient:?}");
            assert!((ambient.crosswind_m_s.abs() - cross).abs() < 1e-9, "{ambient:?}");
        }
    }

    #[test]
    fn missing_samples_are_left_out_and_not_filled() {
        let mut speed = drive();
        speed[80] = f64::NAN;
        let whole = coast_of(&run(&[("speed_m_s", drive())]), 0, 0, &untrimmed()).unwrap();
        let holed = coast_of(&run(&[("speed_m_s", speed)]), 0, 0, &untrimmed()).unwrap();
        assert_eq!(holed.time_s.len() + 1, whole.time_s.len());
    }
}
