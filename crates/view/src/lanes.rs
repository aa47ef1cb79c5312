//! Where each run's path lies among the others.

use crate::colour::{self, Colour};
use crate::path::{Path, Pose, path};
use crate::{Scene, ViewError};
use headland_trace::Run;

/// A run and its recording, each on its path.
#[derive(Debug)]
pub(crate) struct Lane<'a> {
    pub run: &'a Run,
    pub recording: Option<&'a Run>,
    pub path: Path,
    /// The recording's path, where it has one.
    pub measured: Option<Path>,
    /// Colour of the run's vehicle, path and speed.
    pub colour: Colour,
    /// The same of its recording.
    pub pale: Colour,
    /// By how much the run was moved from the places of its trace [m].
    pub shift: [f64; 3],
}

/// All runs of a scene, moved so that the first starts at the origin.
///
/// A run that knows only its distance follows its recording where that knows the places; else it gets a lane of its own, as do
/// runs of a study that start where an earlier one did.
///
/// # Errors
/// [`ViewError::NoPath`] or [`ViewError::NoPose`] of a run; a recording without a path is only plotted.
pub(crate) fn lanes<'a>(scene: &Scene<'a>) -> Result<Vec<Lane<'a>>, ViewError> {
    let (baseline_m, ground) = (scene.vehicle.wheelbase_m, scene.ground.as_ref());
    let mut lanes = Vec::with_capacity(scene.runs.len());
    let mut north_m = 0.0;
    for run in scene.runs {
        let recording = scene.measured.iter().find(|recording| recording.id == run.id);
        let mut path_of_run = path(run, baseline_m, ground, scene.rig(&run.id))?;
        let mut measured = recording.and_then(|recording| path(recording, baseline_m, ground, None).ok());
        match &mut measured {
            Some(measured) if measured.located && !path_of_run.located => follow(&mut path_of_run, measured),
            Some(measured) if path_of_run.located && !measured.located => follow(measured, &path_of_run),
            _ => {}
        }
        if !path_of_run.located {
            for path in [Some(&mut path_of_run), measured.as_mut()].into_iter().flatten() {
                path.shift([0.0, north_m, 0.0]);
            }
            north_m += LANE * scene.vehicle.width_m;
        }
        let (index, count) = (lanes.len(), scene.runs.len());
        let (colour, pale) = (colour::of_run(index, count), colour::of_recording(index, count));
        lanes.push(Lane { run, recording, path: path_of_run, measured, colour, pale, shift: [0.0; 3] });
    }
    let first = lanes.iter().find_map(|lane| lane.path.poses.first());
    let shift = first.map_or([0.0; 3], |pose| pose.at.map(|part| -part));
    for lane in &mut lanes {
        lane.shift(shift);
    }
    if scene.measured.is_empty() {
        part(&mut lanes, scene.vehicle.width_m);
    }
    Ok(lanes)
}

impl Lane<'_> {
    /// Moves the run and its recording.
    fn shift(&mut self, by: [f64; 3]) {
        self.path.shift(by);
        if let Some(measured) = &mut self.measured {
            measured.shift(by);
        }
        for (shift, by) in self.shift.iter_mut().zip(by) {
            *shift += by;
        }
    }

    /// How far to the left of a direction the run comes, least and most [m].
    fn breadth_m(&self, (sine, cosine): (f64, f64)) -> [f64; 2] {
        let left = || self.path.poses.iter().map(|pose| pose.at[1] * sine - pose.at[0] * cosine);
        [left().fold(f64::MAX, f64::min), left().fold(f64::MIN, f64::max)]
    }
}

/// Runs that know their places and start where an earlier one did are moved to the left of all before them, each on a ground of
/// its own that begins at the height of the first: so they can be seen side by side.
fn part(lanes: &mut [Lane], width_m: f64) {
    let Some(direction) =
        lanes.first().and_then(|lane| lane.path.poses.first()).map(|pose| pose.heading_rad.sin_cos())
    else {
        return;
    };
    let mut taken_m: Option<f64> = None;
    let mut starts: Vec<[f64; 3]> = Vec::new();
    for lane in lanes.iter_mut().filter(|lane| lane.path.located) {
        let Some(start) = lane.path.poses.first().map(|pose| pose.at) else { continue };
        let near = |other: &[f64; 3]| (other[0] - start[0]).hypot(other[1] - start[1]) < width_m;
        let beside = starts.iter().any(near);
        starts.push(start);
        let [least_m, most_m] = lane.breadth_m(direction);
        if let (Some(taken_m), true) = (&mut taken_m, beside) {
            let by_m = *taken_m + LANE * width_m - least_m;
            lane.shift([-by_m * direction.1, by_m * direction.0, -start[2]]);
            *taken_m = most_m + by_m;
        } else {
            taken_m = Some(taken_m.map_or(most_m, |taken_m| taken_m.max(most_m)));
        }
    }
}

/// From one lane to the next one on its left, in widths of the vehicle: the eye is on the right of the first.
pub(crate) const LANE: f64 = 4.0;

/// Lays `path`, which knows only distances, along `guide`, from where the guide was when the path began.
fn follow(path: &mut Path, guide: &Path) {
    let Some(start) = path.poses.first().copied() else { return };
    let mut places: Vec<Pose> = Vec::with_capacity(guide.poses.len());
    for pose in &guide.poses {
        if places.last().is_none_or(|last| pose.travelled_m > last.travelled_m) {
            places.push(*pose);
        }
    }
    let Some(last) = places.len().checked_sub(1) else { return };
    let begun = guide.poses.iter().take_while(|pose| pose.time_s <= start.time_s).last();
    let from_m = begun.unwrap_or(&guide.poses[0]).travelled_m - start.travelled_m;
    for pose in &mut path.poses {
        let travelled_m = pose.travelled_m + from_m;
        let right = places.partition_point(|place| place.travelled_m <= travelled_m).clamp(1.min(last), last);
        let (one, other) = (&places[right.saturating_sub(1)], &places[right]);
        let length = other.travelled_m - one.travelled_m;
        let share = if length > 0.0 { (travelled_m - one.travelled_m) / length } else { 0.0 };
        pose.at = [0, 1, 2].map(|axis| one.at[axis] + share * (other.at[axis] - one.at[axis]));
        let near = if share < 0.5 { one } else { other };
        (pose.heading_rad, pose.pitch_rad) = (near.heading_rad, near.pitch_rad);
    }
    path.located = true;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::{BODY, run, scene};

    #[test]
    fn runs_of_distance_alone_lie_side_by_side_and_the_first_at_the_origin() {
        let runs = [run("r1", &[("position_m", &[5.0, 15.0])]), run("r2", &[("position_m", &[0.0, 4.0])])];
        let lanes = lanes(&scene(&runs, &[])).unwrap();
        let at = |lane: usize, pose: usize| lanes[lane].path.poses[pose].at;
        assert_eq!([at(0, 0), at(0, 1)], [[0.0; 3], [10.0, 0.0, 0.0]]);
        assert_eq!([at(1, 0), at(1, 1)], [[0.0, LANE * BODY.width_m, 0.0], [4.0, LANE * BODY.width_m, 0.0]]);
    }

    /// Large coordinates would lose their centimetres in single precision.
    #[test]
    fn places_far_from_their_origin_are_moved_to_it() {
        let east = [500_000.25, 500_001.25];
        let north = [5_400_000.5, 5_400_000.5];
        let runs = [run("r1", &[("east_m", &east), ("north_m", &north)])];
        let lanes = lanes(&scene(&runs, &[])).unwrap();
        assert_eq!(lanes[0].path.poses[1].at, [1.0, 0.0, 0.0]);
        assert_eq!(lanes[0].shift, [-500_000.25, -5_400_000.5, 0.0]);
    }

    /// The recording drives north, then turns east after 10 m; the model is 5 m ahead of it at the end.
    #[test]
    fn a_model_without_places_drives_along_its_recording() {
        let runs = [run("r1", &[("position_m", &[100.0, 104.0, 115.0])])];
        let measured = [run("r1", &[("east_m", &[0.0, 0.0, 10.0]), ("north_m", &[0.0, 10.0, 10.0])])];
        let lanes = lanes(&scene(&runs, &measured)).unwrap();
        let at: Vec<[f64; 3]> = lanes[0].path.poses.iter().map(|pose| pose.at).collect();
        assert_eq!(at, [[0.0; 3], [0.0, 4.0, 0.0], [5.0, 10.0, 0.0]]);
    }

    /// Both drive north from the same place, 3 m high; the second bends 5 m to the left.
    #[test]
    fn runs_that_start_at_one_place_are_laid_side_by_side() {
        let heights: (&str, &[f64]) = ("elevation_m", &[3.0, 3.0]);
        let straight = run("r1", &[("east_m", &[0.0, 0.0]), ("north_m", &[0.0, 40.0]), heights]);
        let bent = run("r2", &[("east_m", &[0.0, -5.0]), ("north_m", &[0.0, 40.0]), heights]);
        let third = run("r3", &[("east_m", &[0.0, 0.0]), ("north_m", &[0.0, 40.0]), heights]);
        let runs = [straight, bent, third];
        let parted = lanes(&scene(&runs, &[])).unwrap();
        let east = |lane: usize, pose: usize| parted[lane].path.poses[pose].at[0];
        let gap_m = LANE * BODY.width_m;
        assert_eq!([east(0, 0), east(1, 0), east(2, 0)], [0.0, -gap_m, -2.0 * gap_m - 5.0]);
        assert_eq!((east(1, 1), parted[1].shift), (-gap_m - 5.0, [-gap_m, 0.0, -3.0]));
        // Held against recordings they stay where they were.
        let together = lanes(&scene(&runs, &runs[..1])).unwrap();
        assert!(together.iter().all(|lane| lane.path.poses[0].at[0] == 0.0));
    }

    #[test]
    fn a_recording_that_knows_no_place_is_only_plotted() {
        let runs = [run("r1", &[("position_m", &[0.0, 1.0])])];
        let measured = [run("r1", &[("speed_m_s", &[1.0, 1.0])])];
        let lanes = lanes(&scene(&runs, &measured)).unwrap();
        assert!(lanes[0].measured.is_none() && lanes[0].recording.is_some());
    }
}
