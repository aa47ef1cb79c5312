//! How the viewer lays everything out: the vehicle on the left, what is to be read on the right.

use crate::entity::{self, Who};
use crate::flow;
use crate::groups::{Group, Rank};
use crate::lanes::Lane;
use crate::layout::{COLUMN, LEGEND, Layout, Look, Node, WIDE_LEGEND};
use crate::path::Pose;
use crate::plots::{BESIDE, COMPARED, residual};
use crate::recorder::Recorder;
use crate::{Scene, ViewError};
use rerun::external::re_sdk_types::blueprint::archetypes::{Background, EyeControls3D, LineGrid3D};
use rerun::external::re_sdk_types::blueprint::components::{BackgroundKind, ContainerKind};
use rerun::log::LogMsg;
use rerun::{ApplicationId, AsComponents, EntityPath};
use std::mem::take;

/// The messages that make the layout, and the one that puts it into force.
pub(crate) fn messages(
    (application, drawn): (&ApplicationId, &Recorder),
    scene: &Scene,
    groups: &[Group],
    lanes: &[Lane],
) -> Result<Vec<LogMsg>, ViewError> {
    let mut layout = Scenic { layout: Layout::new(application)?, drawn, times_s: times_s(lanes) };
    let space = layout.space(scene, lanes)?;
    let text = layout.layout.view("TextDocument", "About", &[entity::summary()], &[])?;
    let (right, rest) = layout.plots(scene, groups, lanes)?;
    let (below, above) = match rest {
        Some(rest) => (layout.layout.split(ContainerKind::Horizontal, "", &[text, rest], &[1.0, 1.0])?, 2.8),
        None => (text, 5.0),
    };
    let left = layout.layout.split(ContainerKind::Vertical, "", &[space, below], &[above, 1.0])?;
    let root = layout.layout.split(ContainerKind::Horizontal, "", &[left, right], &[6.0, 5.0])?;
    layout.layout.finish(&root)
}

/// Behind everything in space: dark enough for light labels.
const SKY: [u8; 3] = [34, 44, 56];

/// What a plot needs beside the lines of its legend, in such lines: its title and its times. (The viewer gives a legend four
/// fifths of the plot, so such a line is a quarter higher than one of text.)
const FRAME_LINES: f32 = 1.7;
/// The least share of a plot: with less no numbers have room.
const LEAST: f32 = 4.7;
/// Height of a row of tabs above plots, and of the plots below the vehicle [points].
const TABS: f64 = 24.0;
const ASIDE: f64 = 225.0;

/// First and last time of all runs [s].
fn times_s(lanes: &[Lane]) -> [f64; 2] {
    let runs = || lanes.iter().flat_map(|lane| [Some(lane.run), lane.recording]).flatten();
    let first = runs().filter_map(|run| run.trace.time_s().first()).copied().fold(f64::INFINITY, f64::min);
    let last = runs().filter_map(|run| run.trace.time_s().last()).copied().fold(f64::NEG_INFINITY, f64::max);
    [first, last]
}

/// The direction from the first place to the last one; that of the start where these are close to each other.
fn main_heading_rad(poses: &[Pose], start_rad: f64) -> f64 {
    let Some((first, last)) = poses.first().zip(poses.last()) else { return start_rad };
    let (east_m, north_m) = (last.at[0] - first.at[0], last.at[1] - first.at[1]);
    let travelled_m = (last.travelled_m - first.travelled_m).abs();
    if east_m.hypot(north_m) > 0.5 * travelled_m && travelled_m > 0.0 {
        east_m.atan2(north_m)
    } else {
        start_rad
    }
}

/// A plot that is to be.
struct Wanted {
    title: String,
    lines: Vec<EntityPath>,
    room: f64,
    share: f32,
}

/// The layout of a scene.
struct Scenic<'a> {
    layout: Layout,
    drawn: &'a Recorder,
    times_s: [f64; 2],
}

impl Scenic<'_> {
    /// The world, seen from beside the first vehicle, which the eye follows.
    fn space(&mut self, scene: &Scene, lanes: &[Lane]) -> Result<Node, ViewError> {
        let Some((first, pose)) = lanes.first().zip(lanes.first().and_then(|lane| lane.path.poses.first()))
        else {
            return Err(ViewError::NoRun);
        };
        let (sine, cosine) = main_heading_rad(&first.path.poses, pose.heading_rad).sin_cos();
        let reach = scene.vehicle.length_m.max(scene.vehicle.height_m);
        // Ahead and to the right of the vehicle, in its own lengths; behind it where something hangs there.
        let hangs = scene.setting(&first.run.id).is_some_and(|setting| setting.hangs(-1.0));
        let (ahead, right) = if hangs { (-1.2, 1.9) } else { (0.5, 2.2) };
        let (ahead, right, up) = (ahead * reach, right * reach, reach);
        let eye = [
            pose.at[0] + ahead * sine + right * cosine,
            pose.at[1] + ahead * cosine - right * sine,
            pose.at[2] + up,
        ];
        let target = [pose.at[0], pose.at[1], pose.at[2] + scene.vehicle.height_m / 2.0];
        let eye = EyeControls3D::new()
            .with_position(crate::mesh::single(eye))
            .with_look_target(crate::mesh::single(target))
            .with_eye_up([0.0, 0.0, 1.0])
            .with_tracking_entity(entity::reach(&first.run.id).to_string());
        let grid = LineGrid3D::new().with_visible(false);
        let sky = Background::new(BackgroundKind::SolidColor).with_color(SKY);
        let properties: [(&str, &dyn AsComponents); 3] =
            [("EyeControls3D", &eye), ("LineGrid3D", &grid), ("Background", &sky)];
        self.layout.view("3D", "Vehicle", &[entity::world()], &properties)
    }

    /// The plots of one run and, apart, those of the rest; or a tab with all for each run.
    fn plots(
        &mut self,
        scene: &Scene,
        groups: &[Group],
        lanes: &[Lane],
    ) -> Result<(Node, Option<Node>), ViewError> {
        if let [only] = lanes {
            return self.column((scene, groups), only, None);
        }
        let mut tabs = vec![self.overview(lanes)?];
        for lane in lanes {
            let (column, _) = self.column((scene, groups), lane, Some(&lane.run.id))?;
            tabs.push(column);
        }
        Ok((self.layout.split(ContainerKind::Tabs, "Runs", &tabs, &[])?, None))
    }

    /// What all runs are held beside one another by.
    fn overview(&mut self, lanes: &[Lane]) -> Result<Node, ViewError> {
        let mut wanted = Vec::with_capacity(BESIDE.len());
        for (channel, title, _) in BESIDE {
            let knows = |lane: &&Lane| lane.run.trace.channel(channel).is_some();
            let lines: Vec<EntityPath> = lanes
                .iter()
                .filter(knows)
                .flat_map(|lane| {
                    let id = &lane.run.id;
                    if channel == COMPARED {
                        [Who::Modelled, Who::Measured].map(|who| entity::channel(id, channel, who)).to_vec()
                    } else {
                        vec![entity::beside(channel, id)]
                    }
                })
                .collect();
            if !lines.is_empty() {
                wanted.push((title, lines));
            }
        }
        let height = (COLUMN - TABS) / wanted.len() as f64;
        let plots = wanted
            .iter()
            .map(|(title, lines)| self.plot(title, lines, (LEGEND, height)))
            .collect::<Result<Vec<_>, _>>()?;
        if let [only] = plots.as_slice() {
            return Ok(only.clone());
        }
        self.layout.split(ContainerKind::Vertical, "All runs", &plots, &vec![1.0; plots.len()])
    }

    /// Speed, its residual, forces, where the power goes, and tabs for wheels and for the rest; each as high as its legend needs,
    /// tabs as their first one. Without a name the rest stands apart.
    fn column(
        &mut self,
        (scene, groups): (&Scene, &[Group]),
        lane: &Lane,
        name: Option<&str>,
    ) -> Result<(Node, Option<Node>), ViewError> {
        let id = &lane.run.id;
        let mut wanted = Vec::new();
        let (mut wheels, mut rest) = (Vec::new(), Vec::new());
        for group in groups {
            let lines: Vec<EntityPath> = group
                .channels
                .iter()
                .filter(|channel| {
                    let runs = [Some(lane.run), lane.recording];
                    runs.into_iter().flatten().any(|run| run.trace.channel(channel).is_some())
                })
                .flat_map(|channel| {
                    [Who::Modelled, Who::Measured].map(|who| entity::channel(id, channel, who))
                })
                .collect();
            if lines.is_empty() {
                continue;
            }
            let knows = |run: Option<&headland_trace::Run>, channel: &str| {
                usize::from(run.is_some_and(|run| run.trace.channel(channel).is_some()))
            };
            let drawn: usize = group
                .channels
                .iter()
                .map(|channel| knows(Some(lane.run), channel) + knows(lane.recording, channel))
                .sum();
            let share = (FRAME_LINES + drawn as f32).max(LEAST);
            let room = if group.rank == Rank::More && name.is_none() { WIDE_LEGEND } else { LEGEND };
            let plot = Wanted { title: group.title.clone(), lines, room, share };
            match group.rank {
                Rank::Main => {}
                Rank::Wheels => {
                    wheels.push(plot);
                    continue;
                }
                Rank::More => {
                    rest.push(plot);
                    continue;
                }
            }
            wanted.push(plot);
            let compared = lane.recording.is_some_and(|recording| residual(lane.run, recording).is_some());
            if compared && group.channels.iter().any(|channel| channel == COMPARED) {
                let lines = vec![entity::channel(id, COMPARED, Who::Residual)];
                let title = "Speed residual [m/s]".to_owned();
                wanted.push(Wanted { title, lines, room: LEGEND, share: LEAST });
            }
        }
        let flows: Vec<EntityPath> =
            flow::flows(scene, groups, lane.run).iter().map(|flow| entity::flow(id, &flow.name)).collect();
        if !flows.is_empty() {
            let share = FRAME_LINES + flows.len() as f32;
            wanted.push(Wanted { title: flow::TITLE.to_owned(), lines: flows, room: LEGEND, share });
        }
        // The rest of a run that is alone stands below the vehicle.
        let apart = (name.is_none() && !(wanted.is_empty() && wheels.is_empty())).then(|| take(&mut rest));
        let mut shares: Vec<f32> = wanted.iter().map(|plot| plot.share).collect();
        shares.extend([&wheels, &rest].into_iter().filter_map(|tabs| tabs.first()).map(|plot| plot.share));
        let column = if name.is_some() { COLUMN - TABS } else { COLUMN };
        let point = column / f64::from(shares.iter().sum::<f32>());
        let mut parts = Vec::with_capacity(shares.len());
        for plot in &wanted {
            parts.push(self.plot(&plot.title, &plot.lines, (plot.room, point * f64::from(plot.share)))?);
        }
        for (title, tabs) in [("Wheels", &wheels), ("More", &rest)] {
            if let Some(first) = tabs.first() {
                parts.push(self.tabs(title, tabs, point * f64::from(first.share))?);
            }
        }
        let apart = apart.filter(|tabs| !tabs.is_empty());
        let apart = apart.map(|tabs| self.tabs("More", &tabs, ASIDE)).transpose()?;
        let column = self.layout.split(ContainerKind::Vertical, name.unwrap_or_default(), &parts, &shares)?;
        Ok((column, apart))
    }

    fn plot(
        &mut self,
        title: &str,
        lines: &[EntityPath],
        (room, height): (f64, f64),
    ) -> Result<Node, ViewError> {
        let look = Look { times_s: self.times_s, room, span: self.drawn.span(lines), height };
        self.layout.plot(title, lines, look)
    }

    /// Plots of which one is seen.
    fn tabs(&mut self, title: &str, plots: &[Wanted], height: f64) -> Result<Node, ViewError> {
        let plots = plots
            .iter()
            .map(|plot| self.plot(&plot.title, &plot.lines, (plot.room, height)))
            .collect::<Result<Vec<_>, _>>()?;
        self.layout.split(ContainerKind::Tabs, title, &plots, &[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn pose(travelled_m: f64, east_m: f64, north_m: f64) -> Pose {
        Pose { travelled_m, at: [east_m, north_m, 0.0], heading_rad: 1.0, ..Pose::default() }
    }

    #[test]
    fn the_eye_looks_across_the_way_as_a_whole_but_for_a_round() {
        let way = [pose(0.0, 0.0, 0.0), pose(80.0, 60.0, 0.0)];
        assert_eq!(main_heading_rad(&way, 1.0), FRAC_PI_2);
        let round = [pose(0.0, 0.0, 0.0), pose(80.0, 6.0, 0.0)];
        assert_eq!(main_heading_rad(&round, 1.0), 1.0);
        assert_eq!(main_heading_rad(&[pose(0.0, 0.0, 0.0)], 1.0), 1.0);
    }
}
