//! Views, containers and panels, as the viewer takes them.

use crate::ViewError;
use crate::axis::{Span, last_s};
use crate::entity;
use crate::recorder::{Recorder, TIMELINE, encode, nanoseconds};
use rerun::datatypes::{TimeInt, TimeRange, TimeRangeBoundary};
use rerun::external::re_log_types::{BlueprintActivationCommand, StoreKind};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    ContainerBlueprint, PanelBlueprint, PlotLegend, ScalarAxis, TimeAxis, TimePanelBlueprint, ViewBlueprint,
    ViewContents, ViewportBlueprint,
};
use rerun::external::re_sdk_types::blueprint::components::{
    ContainerKind, Corner2D, LoopMode, PanelState, PlayState,
};
use rerun::log::LogMsg;
use rerun::{ApplicationId, AsComponents, EntityPath, RecordingStreamBuilder};

/// How much longer than the runs plots are, so that their legend hides no line.
pub(crate) const LEGEND: f64 = 0.3;
/// The same of a plot of half the width.
pub(crate) const WIDE_LEGEND: f64 = 0.5;

/// Height of what the plots of a window of 900 points share, and what each of them needs for its title and its times [points].
pub(crate) const COLUMN: f64 = 840.0;
const FRAME: f64 = 46.0;

/// How a plot is to look.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    /// First and last time of its lines [s].
    pub times_s: [f64; 2],
    /// Room of the legend beyond them, as a share; without room there is none.
    pub room: f64,
    /// From where to where its lines go.
    pub span: Option<Span>,
    /// How high it is, with its title and its times [points].
    pub height: f64,
}

/// A view or a container.
#[derive(Clone)]
pub(crate) struct Node {
    id: [u8; 16],
    path: EntityPath,
}

/// A layout that is being made.
pub(crate) struct Layout {
    to: Recorder,
    nodes: u32,
}

impl Layout {
    /// An empty one.
    pub(crate) fn new(application: &ApplicationId) -> Result<Self, ViewError> {
        let to = Recorder::new(RecordingStreamBuilder::new(application.clone()).blueprint())?;
        to.stream().set_time_sequence("blueprint", 0);
        Ok(Self { to, nodes: 0 })
    }

    /// The messages that make the layout below `root`, and the one that puts it into force.
    pub(crate) fn finish(self, root: &Node) -> Result<Vec<LogMsg>, ViewError> {
        self.frame(root)?;
        let mut messages = self.to.finish();
        let blueprint_id = messages
            .iter()
            .map(|message| message.store_id().clone())
            .find(|store| store.kind() == StoreKind::Blueprint)
            .ok_or_else(|| encode("the layout is empty"))?;
        let activation = BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true };
        messages.push(activation.into());
        Ok(messages)
    }

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

    /// A view of a class on some entities.
    pub(crate) fn view(
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

    /// A container; a name of no letters is none.
    pub(crate) fn split(
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

    /// Lines over time.
    pub(crate) fn plot(
        &mut self,
        title: &str,
        lines: &[EntityPath],
        Look { times_s: [first, last], room, span, height }: Look,
    ) -> Result<Node, ViewError> {
        let legend = PlotLegend::new().with_corner(Corner2D::RightTop).with_visible(room > 0.0);
        let [from, to] = [first, last_s(first, last + room * (last - first))]
            .map(|time_s| TimeRangeBoundary::Absolute(TimeInt(nanoseconds(time_s))));
        let axis = TimeAxis::new().with_view_range(TimeRange { start: from, end: to });
        let mut properties: Vec<(&str, &dyn AsComponents)> =
            vec![("PlotLegend", &legend), ("TimeAxis", &axis)];
        let range = span.and_then(|span| span.axis(height - FRAME));
        let values = range.map(|ends| ScalarAxis::new().with_range(rerun::datatypes::Range1D(ends)));
        properties.extend(values.as_ref().map(|values| ("ScalarAxis", values as &dyn AsComponents)));
        self.view("TimeSeries", title, lines, &properties)
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
