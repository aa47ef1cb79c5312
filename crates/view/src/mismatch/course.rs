//! Where the rows of a recorded run lie.

use super::Left;
use crate::path::{Pose, path};
use headland_trace::{Origin, Run, Trace};

/// Directions are taken over this length [m].
const BASELINE_M: f64 = 2.0;

/// East and south of somewhere [m]: the viewer's second axis looks down.
pub(crate) type Place = [f64; 2];

/// The pose of each row, where the run knows its places or its directions.
pub(crate) fn poses(left: &Left) -> Option<Vec<Pose>> {
    let knows = |name: &str| left.run.trace.get(name).is_some();
    if !(knows("heading_rad") || knows("east_m") && knows("north_m")) {
        return None;
    }
    let forward = forward(left);
    let path = path(forward.as_ref().unwrap_or(left.run), BASELINE_M, None, None).ok()?;
    let at = |time_s: &f64| {
        let right = path.poses.partition_point(|pose| pose.time_s <= *time_s);
        let right = right.clamp(1.min(path.poses.len() - 1), path.poses.len() - 1);
        let (one, other) = (&path.poses[right.saturating_sub(1)], &path.poses[right]);
        let length = other.time_s - one.time_s;
        let share = if length > 0.0 { ((time_s - one.time_s) / length).clamp(0.0, 1.0) } else { 0.0 };
        let at = [0, 1, 2].map(|axis| one.at[axis] + share * (other.at[axis] - one.at[axis]));
        Pose { time_s: *time_s, at, ..*one }
    };
    Some(left.time_s.iter().map(at).collect())
}

/// A run that goes against its path and counts its position along that: it goes on all the same, where it looks.
fn forward(left: &Left) -> Option<Run> {
    let trace = &left.run.trace;
    let (position, heading) = trace.get("position_m").zip(trace.get("heading_rad"))?;
    let falls = position.first().zip(position.last()).is_some_and(|(first, last)| last < first);
    if !(left.reversed && falls) || trace.get("east_m").is_some() {
        return None;
    }
    let mut turned = Trace::new(trace.time_s().to_vec()).ok()?;
    turned.push("position_m", position.iter().map(|at| -at).collect(), Origin::Measured).ok()?;
    turned.push("heading_rad", heading.to_vec(), Origin::Measured).ok()?;
    Some(Run { id: left.run.id.clone(), trace: turned })
}

/// Runs that know directions and no places begin anywhere: each is moved onto the first of its path, by the positions along it.
pub(crate) fn together(all: &[Left], lines: &mut [Vec<Place>]) {
    for index in 1..all.len() {
        let left = &all[index];
        let first = all[..index].iter().position(|other| other.path == left.path);
        let (Some(first), None) = (first, left.run.trace.get("east_m")) else { continue };
        let middle = left.position_m.len() / 2;
        let Some(at_m) = left.position_m.get(middle) else { continue };
        let away = |row: &usize| (all[first].position_m[*row] - at_m).abs();
        let near = (0..lines[first].len()).min_by(|one, other| away(one).total_cmp(&away(other)));
        let Some(near) = near.map(|row| lines[first][row]) else { continue };
        let by = [near[0] - lines[index][middle][0], near[1] - lines[index][middle][1]];
        for at in &mut lines[index] {
            *at = [at[0] + by[0], at[1] + by[1]];
        }
    }
}

/// Its place.
pub(crate) fn place(pose: &Pose) -> Place {
    [pose.at[0], -pose.at[1]]
}
