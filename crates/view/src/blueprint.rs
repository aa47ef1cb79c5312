//! How the viewer lays everything out: the vehicle on the left, what is to be read on the right.

use crate::entity::{self, Who};
use crate::groups::{Group, Rank};
use crate::lanes::Lane;
use crate::path::Pose;
use crate::plots::{COMPARED, residual};
use crate::recorder::{Recorder, TIMELINE, encode, nanoseconds};
use crate::{Scene, ViewError};
use rerun::datatypes::{TimeInt, TimeRange, TimeRangeBoundary};
use rerun::external::re_log_types::{BlueprintActivationCommand, StoreKind};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, ContainerBlueprint, EyeControls3D, LineGrid3D, PanelBlueprint, PlotLegend, TimeAxis,
    TimePanelBlueprint, ViewBlueprint, ViewContents, ViewportBlueprint,
};
use rerun::external::re_sdk_types::blueprint::components::{
    BackgroundKind, ContainerKind, Corner2D, LoopMode, PanelState, PlayState,
};
use rerun::log::LogMsg;
use rerun::{ApplicationId, AsComponents, EntityPath, RecordingStreamBuilder};

/// The messages that make the layout, and the one that puts it into force.
pub(crate) fn messages(
    application: &ApplicationId,
    scene: &Scene,
    groups: &[Group],
    lanes: &[Lane],
) -> Result<Vec<LogMsg>, ViewError> {
    let to = Recorder::new(RecordingStreamBuilder::new(application.clone()).blueprint())?;
    to.stream().set_time_sequence("blueprint", 0);
    let mut layout = Layout { to, nodes: 0, times_s: times_s(lanes) };
    let space = layout.space(scene, lanes)?;
    let text = layout.view("TextDocument", "About", &[entity::summary()], &[])?;
    let left = layout.split(ContainerKind::Vertical, "", &[space, text], &[5.0, 1.0])?;
    let right = layout.plots(groups, lanes)?;
    let root = layout.split(ContainerKind::Horizontal, "", &[left, right], &[6.0, 5.0])?;
    layout.frame(&root)?;
    let mut messages = layout.to.finish();
    let blueprint_id = messages
        .iter()
        .map(|message| message.store_id().clone())
        .find(|store| store.kind() == StoreKind::Blueprint)
        .ok_or_else(|| encode("the layout is empty"))?;
    let activation = BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true };
    messages.push(activation.into());
    Ok(messages)
}

/// Behind everything in space: dark enough for light labels.
const SKY: [u8; 3] = [34, 44, 56];
/// How much longer than the runs the plots are, so that their legend hides no line.
const LEGEND: f64 = 0.3;

/// First and last time of all runs [s], the last one with room for the legend.
fn times_s(lanes: &[Lane]) -> [f64; 2] {
    let runs = || lanes.iter().flat_map(|lane| [Some(lane.run), lane.recording]).flatten();
    let first = runs().filter_map(|run| run.trace.time_s().first()).copied().fold(f64::INFINITY, f64::min);
    let last = runs().filter_map(|run| run.trace.time_s().last()).copied().fold(f64::NEG_INFINITY, f64::max);
    [first, last + LEGEND * (last - first)]
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

/// A view or a container.
#[derive(Clone)]
struct Node {
    id: [u8; 16],
    path: EntityPath,
}

struct Layout {
    to: Recorder,
    nodes: u32,
    times_s: [f64; 2],
}

impl Layout {
    fn log(&self, at: impl Into<EntityPath>, what: &dyn AsComponents) -> Result<(), ViewError> {
        self.to.stream().log(at, what).map_err(encode)
    }

    /// A new node: its number as a random UUID would be written.
    fn node(&mut self, kind: &str) -> Node {
        self.nodes += 1;
        let mut id = [0x48, 0x65, 0x61, 0x64, 0x6c, 0x61, 0x4e, 0x64, 0x80, 0, 0, 0, 0, 0, 0, 0];
        id[12..].copy_from_slice(&self.nodes.to_be_bytes());
        let mut text = format!("{:032x}", u128::from_be_bytes(id));
        for dash in [20, 16, 12, 8] {
            text.insert(dash, '-');
        }
        Node { id, path: format!("{kind}/{text}").into() }
    }

    fn view(
        &mut self,
        class: &str,
        name: &str,
        contents: &[EntityPath],
        properties: &[(&str, &dyn AsComponents)],
    ) -> Result<Node, ViewError> {
        let node = self.node("view");
        let queries = contents.iter().map(|path| format!("+ {path}/**"));
        let sub = |name: &str| entity::part(&node.path, name);
        self.log(sub("ViewContents"), &ViewContents::new(queries))?;
        let view = ViewBlueprint::new(class).with_display_name(name).with_space_origin("/");
        self.log(node.path.clone(), &view)?;
        for (name, property) in properties {
            self.log(sub(name), *property)?;
        }
        Ok(node)
    }

    fn split(
        &mut self,
        kind: ContainerKind,
        name: &str,
        parts: &[Node],
        shares: &[f32],
    ) -> Result<Node, ViewError> {
        let node = self.node("container");
        let mut container =
            ContainerBlueprint::new(kind).with_contents(parts.iter().map(|part| part.path.to_string()));
        if !name.is_empty() {
            container = container.with_display_name(name);
        }
        let shares = shares.iter().copied();
        container = match kind {
            ContainerKind::Horizontal => container.with_col_shares(shares),
            ContainerKind::Vertical => container.with_row_shares(shares),
            ContainerKind::Tabs | ContainerKind::Grid => container,
        };
        self.log(node.path.clone(), &container)?;
        Ok(node)
    }

    /// The world, seen from beside the first vehicle, which the eye follows.
    fn space(&mut self, scene: &Scene, lanes: &[Lane]) -> Result<Node, ViewError> {
        let Some((first, pose)) = lanes.first().zip(lanes.first().and_then(|lane| lane.path.poses.first()))
        else {
            return Err(ViewError::NoRun);
        };
        let (sine, cosine) = main_heading_rad(&first.path.poses, pose.heading_rad).sin_cos();
        let reach = scene.vehicle.length_m.max(scene.vehicle.height_m);
        // Ahead and to the right of the vehicle, in its own lengths.
        let (ahead, right, up) = (0.5 * reach, 2.2 * reach, 1.0 * reach);
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
        self.view("3D", "Vehicle", &[entity::world()], &properties)
    }

    /// The plots of one run, or a tab for each run.
    fn plots(&mut self, groups: &[Group], lanes: &[Lane]) -> Result<Node, ViewError> {
        let mut tabs = Vec::with_capacity(lanes.len() + 1);
        if let [_, _, ..] = lanes {
            let speeds: Vec<EntityPath> = lanes
                .iter()
                .flat_map(|lane| {
                    [Who::Modelled, Who::Measured].map(|who| entity::channel(&lane.run.id, COMPARED, who))
                })
                .collect();
            tabs.push(self.plot("Speed of all runs [m/s]", &speeds)?);
        }
        for lane in lanes {
            let name = if lanes.len() > 1 { lane.run.id.as_str() } else { "" };
            let column = self.column(groups, lane, name)?;
            tabs.push(column);
        }
        if let [only] = tabs.as_slice() {
            return Ok(only.clone());
        }
        self.split(ContainerKind::Tabs, "Runs", &tabs, &[])
    }

    /// Speed, its residual, forces, powers, and tabs for wheels and for the rest.
    fn column(&mut self, groups: &[Group], lane: &Lane, name: &str) -> Result<Node, ViewError> {
        let id = &lane.run.id;
        let (mut parts, mut shares) = (Vec::new(), Vec::new());
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
            let plot = self.plot(&group.title, &lines)?;
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
            parts.push(plot);
            shares.push(3.0);
            let compared = lane.recording.is_some_and(|recording| residual(lane.run, recording).is_some());
            if compared && group.channels.iter().any(|channel| channel == COMPARED) {
                parts.push(
                    self.plot("Speed residual [m/s]", &[entity::channel(id, COMPARED, Who::Residual)])?,
                );
                shares.push(2.0);
            }
        }
        for (title, tabs) in [("Wheels", wheels), ("More", rest)] {
            if !tabs.is_empty() {
                parts.push(self.split(ContainerKind::Tabs, title, &tabs, &[])?);
                shares.push(3.0);
            }
        }
        self.split(ContainerKind::Vertical, name, &parts, &shares)
    }

    fn plot(&mut self, title: &str, lines: &[EntityPath]) -> Result<Node, ViewError> {
        let legend = PlotLegend::new().with_corner(Corner2D::RightTop);
        let [from, to] = self.times_s.map(|time_s| TimeRangeBoundary::Absolute(TimeInt(nanoseconds(time_s))));
        let axis = TimeAxis::new().with_view_range(TimeRange { start: from, end: to });
        self.view("TimeSeries", title, lines, &[("PlotLegend", &legend), ("TimeAxis", &axis)])
    }

    /// What lies around the views.
    fn frame(&self, root: &Node) -> Result<(), ViewError> {
        let viewport = ViewportBlueprint::new()
            .with_root_container(root.id)
            .with_auto_layout(false)
            .with_auto_views(false);
        self.log("viewport", &viewport)?;
        for panel in ["blueprint_panel", "selection_panel"] {
            self.log(panel, &PanelBlueprint::new().with_state(PanelState::Hidden))?;
        }
        let time = TimePanelBlueprint::new()
            .with_state(PanelState::Collapsed)
            .with_timeline(TIMELINE)
            .with_play_state(PlayState::Playing)
            .with_loop_mode(LoopMode::All);
        self.log("time_panel", &time)
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
