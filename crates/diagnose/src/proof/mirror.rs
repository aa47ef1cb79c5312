//! A wind across a lane: whether it blows from the left or from the right is the same to what was driven there and back, so
//! there are two winds that explain as much, one the other's image in a mirror along the lane.

use crate::Case;
use crate::causes::catalogue::{Cause, Form};
use crate::runs::recorded::{Recorded, SLOWEST_M_S};

/// A sum of squares within this of the least one is as good: 95 % of a chi-square of one degree of freedom.
pub const AS_GOOD: f64 = 3.84;
/// A wind along a lane is the top of a hill for what blows across it, which no fit leaves by itself: it begins with this share
/// of the other part.
const LEAN: f64 = 0.5;
/// Runs go along one line where the resultant of their doubled headings is longer than this.
const STRAIGHT: f64 = 0.9;

/// Whether the parts of a cause are one thing seen from two sides, so that one which the data do not need is not nought but
/// unknown.
pub fn is_whole(cause: &Cause) -> bool {
    cause.id == "wind" && cause.form == Form::Parameters
}

/// What of a wind blows along the one line on which all runs went, which they tell whatever blows across it.
#[derive(Clone, Copy, Debug)]
pub struct Lane {
    /// Along the line [m/s].
    pub speed_m_s: f64,
    /// Its standard deviation [m/s].
    pub sd_m_s: f64,
    /// Where it comes from, clockwise from north [rad].
    pub from_rad: f64,
}

impl Lane {
    /// Of a wind, north and east, with the standard deviations of both and their correlation.
    pub fn of(axis_rad: f64, [north, east]: [(f64, f64); 2], correlation: f64) -> Self {
        let (sine, cosine) = axis_rad.sin_cos();
        let along = cosine * north.0 + sine * east.0;
        let (north_sd, east_sd) = (cosine * north.1, sine * east.1);
        let variance = north_sd.powi(2) + east_sd.powi(2) + 2.0 * correlation * north_sd * east_sd;
        Self::along(axis_rad, (along, variance.max(0.0).sqrt()))
    }

    /// Of what blows from one end of the line, or from the other where that is negative, with its standard deviation.
    pub fn along(axis_rad: f64, (along_m_s, sd_m_s): (f64, f64)) -> Self {
        let turned = if along_m_s < 0.0 { std::f64::consts::PI } else { 0.0 };
        Self {
            speed_m_s: along_m_s.abs(),
            sd_m_s,
            from_rad: (axis_rad + turned).rem_euclid(std::f64::consts::TAU),
        }
    }
}

/// Gives a part that the data did not ask for a value to begin with.
pub fn lean<'a>(values: impl Iterator<Item = &'a mut f64>) {
    let mut values: Vec<&mut f64> = values.collect();
    let most = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    for own in values.iter_mut().filter(|own| own.abs() < LEAN * most) {
        **own = (LEAN * most).copysign(**own);
    }
}

/// The line along which all runs went, clockwise from north [rad]; none where they went in more directions.
pub fn axis_rad(case: &Case) -> Option<f64> {
    let each = resultants(case)?;
    let sum = |place: usize| each.iter().map(|one| one[place]).sum::<f64>();
    line_rad([sum(0), sum(1), sum(2)])
}

/// The lines along which runs went, one for each that moved, clockwise from north [rad]; none where any of them turned.
pub fn lanes_rad(case: &Case) -> Option<Vec<f64>> {
    resultants(case)?.into_iter().filter(|one| one[2] > 0.0).map(line_rad).collect()
}

/// The line of doubled headings whose cosines and sines sum to this, over so many samples; none where they go in more directions.
fn line_rad([cosine, sine, count]: [f64; 3]) -> Option<f64> {
    (count > 0.0 && f64::hypot(cosine, sine) > STRAIGHT * count).then(|| 0.5 * sine.atan2(cosine))
}

/// Sums of the cosines and of the sines of the doubled headings of each run, and how many they are.
fn resultants(case: &Case) -> Option<Vec<[f64; 3]>> {
    let priors = case.study.priors();
    let of_run = |run: &Recorded| {
        let headings = if let Some(recorded) = run.measured.trace.get("heading_rad") {
            recorded.to_vec()
        } else {
            let terrain = case.study.model(&run.measured, &priors).ok()?.terrain;
            run.position_m.iter().map(|position| terrain.at(*position).heading_rad).collect()
        };
        let moving = run.motion.value.iter().zip(&headings).filter(|(speed, _)| **speed > SLOWEST_M_S);
        let known = moving.filter(|(_, heading)| heading.is_finite());
        Some(known.fold([0.0; 3], |[cosine, sine, count], (_, heading)| {
            [cosine + (2.0 * heading).cos(), sine + (2.0 * heading).sin(), count + 1.0]
        }))
    };
    case.runs.iter().map(of_run).collect()
}

/// A wind, north and east, in a mirror along a line.
pub fn mirrored(values: &[f64], axis_rad: f64) -> Vec<f64> {
    let [north, east, ..] = *values else { return values.to_vec() };
    let (cosine, sine) = ((2.0 * axis_rad).cos(), (2.0 * axis_rad).sin());
    vec![cosine * north + sine * east, sine * north - cosine * east]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_asked_for_begins_away_from_nought() {
        let mut values = [-6.0, 0.0];
        lean(values.iter_mut());
        assert_eq!(values, [-6.0, 3.0]);
        lean(values.iter_mut());
        assert_eq!(values, [-6.0, 3.0], "what leans already stays");
    }

    /// On a lane to the north-east a wind of (3, 4) m/s blows with 7/√2 m/s along it, however far the two trade places.
    #[test]
    fn what_blows_along_is_known_though_north_and_east_are_not() {
        let lane = Lane::of(std::f64::consts::FRAC_PI_4, [(-3.0, 2.0), (-4.0, 2.0)], -0.99);
        assert!((lane.speed_m_s - 7.0 / 2.0_f64.sqrt()).abs() < 1e-12, "{lane:?}");
        assert!((lane.from_rad - 1.25 * std::f64::consts::PI).abs() < 1e-12, "{lane:?}");
        assert!((lane.sd_m_s - 2.0 * 0.01_f64.sqrt()).abs() < 1e-12, "{lane:?}");
    }

    /// Along a lane to the north-east a wind from the north is one from the east; twice is the wind itself.
    #[test]
    fn a_mirror_keeps_what_blows_along_and_turns_what_blows_across() {
        let axis = std::f64::consts::FRAC_PI_4;
        let image = mirrored(&[3.0, 0.0], axis);
        assert!(image[0].abs() < 1e-12 && (image[1] - 3.0).abs() < 1e-12);
        let twice = mirrored(&mirrored(&[3.0, -1.0], 0.3), 0.3);
        assert!((twice[0] - 3.0).abs() < 1e-12 && (twice[1] + 1.0).abs() < 1e-12);
    }
}
