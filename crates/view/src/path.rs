//! Where the vehicle is, and which way it looks.

use crate::setting::Rig;
use crate::thin::{MOST, spread};
use crate::{Ground, ViewError};
use headland_trace::{Run, Trace};
use std::f64::consts::FRAC_PI_2;

/// One place on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pose {
    /// Row of the trace.
    pub row: usize,
    /// Time [s].
    pub time_s: f64,
    /// Distance along the path [m]; it falls where the vehicle goes back.
    pub travelled_m: f64,
    /// East, north, up [m].
    pub at: [f64; 3],
    /// Clockwise from north [rad].
    pub heading_rad: f64,
    /// Nose up [rad].
    pub pitch_rad: f64,
    /// Right side down [rad].
    pub roll_rad: f64,
    /// How much higher than the ground at `at` the point of the vehicle is that touches it on level ground [m].
    pub lift_m: f64,
}

/// The path of one run.
#[derive(Debug)]
pub(crate) struct Path {
    /// At least one, at most [`MOST`].
    pub poses: Vec<Pose>,
    /// Whether the run knew where it was; else the path was laid out from the distance alone.
    pub located: bool,
}

impl Path {
    /// Moves the whole path.
    pub(crate) fn shift(&mut self, by: [f64; 3]) {
        for pose in &mut self.poses {
            for (at, by) in pose.at.iter_mut().zip(by) {
                *at += by;
            }
        }
    }
}

/// The path of `run`, directions taken over `baseline_m` where no channel tells them. A vehicle on a rig stands as its trace says.
///
/// # Errors
/// [`ViewError::NoPath`] or [`ViewError::NoPose`].
pub(crate) fn path(
    run: &Run,
    baseline_m: f64,
    ground: Option<&Ground>,
    rig: Option<&Rig>,
) -> Result<Path, ViewError> {
    let trace = &run.trace;
    let located = trace.get("east_m").is_some() && trace.get("north_m").is_some();
    let mut needed = if located { vec!["east_m", "north_m"] } else { vec!["position_m"] };
    if !located && trace.get("position_m").is_none() {
        let present = trace.channels().iter().map(|channel| channel.name.clone()).collect();
        return Err(ViewError::NoPath { run: run.id.clone(), present });
    }
    needed.extend(
        ["heading_rad", "elevation_m", "pitch_rad", "roll_rad"]
            .into_iter()
            .filter(|name| trace.get(name).is_some()),
    );
    let whole: Vec<usize> = (0..trace.len())
        .filter(|index| needed.iter().all(|name| value(trace, name, *index).is_some_and(f64::is_finite)))
        .collect();
    if whole.is_empty() {
        return Err(ViewError::NoPose { run: run.id.clone(), channels: needed });
    }
    let mut poses = if located { from_places(trace, &whole) } else { from_distance(trace, &whole) };
    for (pose, index) in poses.iter_mut().zip(&whole) {
        let [east, north, _] = pose.at;
        pose.row = *index;
        pose.at[2] = value(trace, "elevation_m", *index)
            .or_else(|| ground.map(|ground| ground.height_m(pose.travelled_m, east, north)))
            .unwrap_or(0.0);
    }
    let kept = spread(poses.len(), MOST);
    let whole: Vec<usize> = kept.iter().map(|index| whole[*index]).collect();
    let mut poses: Vec<Pose> = kept.into_iter().map(|index| poses[index]).collect();
    let directions = directions(&poses, baseline_m);
    for ((pose, index), (heading_rad, pitch_rad)) in poses.iter_mut().zip(whole).zip(directions) {
        let driven = if located { heading_rad } else { FRAC_PI_2 };
        pose.heading_rad = value(trace, "heading_rad", index).unwrap_or(driven);
        pose.pitch_rad = value(trace, "pitch_rad", index).unwrap_or(pitch_rad);
        pose.roll_rad = value(trace, "roll_rad", index).unwrap_or(0.0);
        let height_m = value(trace, "height_m", index).filter(|height| height.is_finite());
        if let Some((rig, height_m)) = rig.zip(height_m) {
            let upright = pose.pitch_rad.cos() * pose.roll_rad.cos();
            pose.lift_m = height_m - upright * rig.centre_height_m - pose.at[2];
        }
    }
    Ok(Path { poses, located })
}

fn value(trace: &Trace, name: &str, index: usize) -> Option<f64> {
    trace.get(name).map(|values| values[index])
}

fn from_places(trace: &Trace, whole: &[usize]) -> Vec<Pose> {
    let mut travelled_m = 0.0;
    let mut before: Option<[f64; 3]> = None;
    let place =
        |index| [value(trace, "east_m", index).unwrap_or(0.0), value(trace, "north_m", index).unwrap_or(0.0)];
    let mut poses = Vec::with_capacity(whole.len());
    for index in whole {
        let [east, north] = place(*index);
        travelled_m += before.map_or(0.0, |before| (east - before[0]).hypot(north - before[1]));
        let measured = value(trace, "position_m", *index).filter(|position| position.is_finite());
        let at = [east, north, 0.0];
        before = Some(at);
        let travelled_m = measured.unwrap_or(travelled_m);
        poses.push(Pose { time_s: trace.time_s()[*index], travelled_m, at, ..Pose::default() });
    }
    poses
}

/// East = ∫ sin(heading) ds, north = ∫ cos(heading) ds.
fn from_distance(trace: &Trace, whole: &[usize]) -> Vec<Pose> {
    let mut poses: Vec<Pose> = Vec::with_capacity(whole.len());
    for index in whole {
        let travelled_m = value(trace, "position_m", *index).unwrap_or(0.0);
        let (sine, cosine) = value(trace, "heading_rad", *index).map_or((1.0, 0.0), f64::sin_cos);
        let (from, [east, north, _]) =
            poses.last().map_or((travelled_m, [0.0; 3]), |pose| (pose.travelled_m, pose.at));
        let step = travelled_m - from;
        let at = [east + step * sine, north + step * cosine, 0.0];
        poses.push(Pose { time_s: trace.time_s()[*index], travelled_m, at, ..Pose::default() });
    }
    poses
}

/// Heading and pitch of the chord from about half a baseline behind to half a baseline ahead of each pose.
///
/// Where the vehicle stands the direction of before holds on; a vehicle that never moves looks east.
fn directions(poses: &[Pose], baseline_m: f64) -> Vec<(f64, f64)> {
    let gap = |one: &Pose, other: &Pose| (one.at[0] - other.at[0]).hypot(one.at[1] - other.at[1]);
    let mut last = None;
    let mut directions: Vec<Option<(f64, f64)>> = Vec::with_capacity(poses.len());
    for (index, pose) in poses.iter().enumerate() {
        let near = |other: &&Pose| gap(other, pose) >= baseline_m / 2.0;
        let behind = poses[..index].iter().rev().find(near).unwrap_or(&poses[0]);
        let ahead = poses[index..].iter().find(near).unwrap_or(&poses[poses.len() - 1]);
        let chord = gap(behind, ahead);
        if chord >= baseline_m / 4.0 {
            let heading = (ahead.at[0] - behind.at[0]).atan2(ahead.at[1] - behind.at[1]);
            last = Some((heading, ((ahead.at[2] - behind.at[2]) / chord).atan()));
        }
        directions.push(last);
    }
    let first = directions.iter().flatten().next().copied().unwrap_or((FRAC_PI_2, 0.0));
    directions.into_iter().map(|direction| direction.unwrap_or(first)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_trace::Origin;

    fn run(channels: &[(&str, &[f64])]) -> Run {
        let times = (0..channels[0].1.len()).map(|second| second as f64).collect();
        let mut trace = Trace::new(times).unwrap();
        for (name, values) in channels {
            trace.push(*name, values.to_vec(), Origin::Predicted).unwrap();
        }
        Run { id: "r1".to_owned(), trace }
    }

    #[test]
    fn a_distance_alone_leads_east_and_a_heading_leads_where_it_points() {
        let east = path(&run(&[("position_m", &[5.0, 15.0])]), 3.0, None, None).unwrap();
        assert_eq!(east.poses[1].at, [10.0, 0.0, 0.0]);
        assert_eq!(east.poses[1].heading_rad, FRAC_PI_2);
        let south = [std::f64::consts::PI; 2];
        let south =
            path(&run(&[("position_m", &[0.0, 10.0]), ("heading_rad", &south)]), 3.0, None, None).unwrap();
        let [east, north, _] = south.poses[1].at;
        assert!(east.abs() < 1e-12 && (north + 10.0).abs() < 1e-12, "{east} {north}");
    }

    /// North-east at a rise of 1 in 10: heading π/4, pitch atan 0.1.
    #[test]
    fn places_give_the_direction_of_travel() {
        let side: Vec<f64> = (0..20).map(f64::from).collect();
        let rise: Vec<f64> = side.iter().map(|side| side * 2f64.sqrt() * 0.1).collect();
        let path =
            path(&run(&[("east_m", &side), ("north_m", &side), ("elevation_m", &rise)]), 3.0, None, None);
        for pose in path.unwrap().poses {
            assert!((pose.heading_rad - FRAC_PI_2 / 2.0).abs() < 1e-12);
            assert!((pose.pitch_rad - 0.1f64.atan()).abs() < 1e-12);
        }
    }

    #[test]
    fn a_vehicle_that_stands_keeps_its_direction() {
        let north = [0.0, 4.0, 8.0, 8.0, 8.0, 8.0];
        let path = path(&run(&[("east_m", &[0.0; 6]), ("north_m", &north)]), 2.0, None, None).unwrap();
        assert!(path.poses.iter().all(|pose| pose.heading_rad == 0.0));
    }

    #[test]
    fn the_ground_carries_a_vehicle_that_knows_no_height() {
        let ground = Ground::Profile { position_m: &[0.0, 10.0], height_m: &[1.0, 2.0] };
        let path = path(&run(&[("position_m", &[0.0, 5.0, 10.0])]), 3.0, Some(&ground), None).unwrap();
        assert_eq!(path.poses.iter().map(|pose| pose.at[2]).collect::<Vec<_>>(), [1.0, 1.5, 2.0]);
    }

    /// The centre of gravity is 1.3 m above the ground of a vehicle that stands level, and at 3.0 m: it stands on 1.7 m, 0.7 m
    /// above the ground at its place.
    #[test]
    fn a_vehicle_on_a_rig_stands_where_its_centre_of_gravity_is() {
        let rig = Rig { centre_height_m: 1.3, wheels: Vec::new() };
        let channels: [(&str, &[f64]); 4] =
            [("position_m", &[0.0]), ("elevation_m", &[1.0]), ("height_m", &[3.0]), ("roll_rad", &[0.0])];
        let level = path(&run(&channels), 3.0, None, Some(&rig)).unwrap().poses[0];
        assert!((level.lift_m - 0.7).abs() < 1e-12 && level.at[2] == 1.0);
        let leaning = [channels[0], channels[1], channels[2], ("roll_rad", &[0.5][..])];
        let leaning = path(&run(&leaning), 3.0, None, Some(&rig)).unwrap().poses[0];
        assert!((leaning.lift_m - (2.0 - 1.3 * 0.5f64.cos())).abs() < 1e-12 && leaning.roll_rad == 0.5);
    }

    #[test]
    fn samples_without_a_place_are_passed_over() {
        let path = path(&run(&[("position_m", &[0.0, f64::NAN, 2.0])]), 3.0, None, None).unwrap();
        assert_eq!(path.poses.iter().map(|pose| pose.time_s).collect::<Vec<_>>(), [0.0, 2.0]);
    }

    #[test]
    fn a_run_without_a_path_is_refused_by_name() {
        let error = path(&run(&[("speed_m_s", &[1.0, 2.0])]), 3.0, None, None).unwrap_err();
        assert_eq!(
            error.to_string(),
            "run `r1` has no path: expected `position_m`, or `east_m` and `north_m`; there are: speed_m_s"
        );
        let error = path(&run(&[("position_m", &[f64::NAN; 2])]), 3.0, None, None).unwrap_err();
        assert_eq!(error.to_string(), "run `r1` has no sample at which each of position_m is a number");
    }
}
