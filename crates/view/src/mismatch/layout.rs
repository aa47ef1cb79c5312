//! How the viewer lays a diagnosis out: where the mismatch sits and the words on the left, before and after on the right.

use super::heat::{self, Over};
use super::plan::Plan;
use super::{Diagnosis, Shown, Stage, lines};
use crate::ViewError;
use crate::entity;
use crate::layout::{COLUMN, LEGEND, Layout, Look, Node, WIDE_LEGEND};
use crate::recorder::Recorder;
use rerun::external::re_sdk_types::blueprint::archetypes::{Background, VisualBounds2D};
use rerun::external::re_sdk_types::blueprint::components::{BackgroundKind, ContainerKind};
use rerun::log::LogMsg;
use rerun::{ApplicationId, AsComponents, EntityPath};

/// Behind plan and maps.
const DARK: [u8; 3] = [22, 26, 32];
/// Runs whose signal is seen at once; the others have it in their tabs.
const AT_ONCE: usize = 3;
/// Share of the height that their tabs have below them.
const BELOW: f32 = 3.0;

/// The messages that make the layout.
pub(crate) fn messages(
    (application, drawn): (&ApplicationId, &Recorder),
    diagnosis: &Diagnosis,
    plan: Option<&Plan>,
) -> Result<Vec<LogMsg>, ViewError> {
    let mut layout = Layout::new(application)?;
    let mut texts = Vec::new();
    for (title, name) in [("Answer", "answer"), ("Alternatives", "alternatives")] {
        texts.push(layout.view("TextDocument", title, &[entity::words(name)], &[])?);
    }
    let (mut parts, mut shares) = (Vec::new(), Vec::new());
    if let Some(plan) = plan {
        parts.push(painted(&mut layout, diagnosis, plan)?);
        shares.push(if plan.wide() { 5.0 } else { 4.4 });
        parts.push(maps(&mut layout, diagnosis)?);
        shares.push(3.7);
    }
    parts.push(layout.split(ContainerKind::Horizontal, "", &texts, &[1.0, 1.0])?);
    shares.push(5.4);
    let left = layout.split(ContainerKind::Vertical, "", &parts, &shares)?;
    let root = if diagnosis.shown.is_empty() {
        left
    } else {
        let right = proof((&mut layout, drawn), diagnosis)?;
        layout.split(ContainerKind::Horizontal, "", &[left, right], &[6.0, 5.0])?
    };
    layout.finish(&root)
}

fn flat(
    layout: &mut Layout,
    title: &str,
    contents: &[EntityPath],
    [left, top, right, bottom]: [f64; 4],
) -> Result<Node, ViewError> {
    let range = rerun::datatypes::Range2D { x_range: [left, right].into(), y_range: [top, bottom].into() };
    let bounds = VisualBounds2D::new(range);
    let dark = Background::new(BackgroundKind::SolidColor).with_color(DARK);
    let properties: [(&str, &dyn AsComponents); 2] = [("VisualBounds2D", &bounds), ("Background", &dark)];
    layout.view("2D", title, contents, &properties)
}

/// The paths, before and after beside each other, or above where they are wide.
fn painted(layout: &mut Layout, diagnosis: &Diagnosis, plan: &Plan) -> Result<Node, ViewError> {
    let mut views = Vec::with_capacity(2);
    for stage in Stage::BOTH {
        let contents = [stage.name(), "here", "legend"].map(entity::painted_parts);
        let title = format!("Mismatch along the path, {} [{}]", stage.name(), diagnosis.unit);
        views.push(flat(layout, &title, &contents, plan.view())?);
    }
    let kind = if plan.wide() { ContainerKind::Vertical } else { ContainerKind::Horizontal };
    layout.split(kind, "", &views, &[1.0, 1.0])
}

/// The maps over position and over speed, before and after beside each other.
fn maps(layout: &mut Layout, diagnosis: &Diagnosis) -> Result<Node, ViewError> {
    let mut tabs = Vec::with_capacity(2);
    for over in Over::BOTH {
        let mut views = Vec::with_capacity(2);
        for stage in Stage::BOTH {
            let contents = [stage.name(), "axes"].map(|part| entity::mapped(over.name(), part));
            let title = format!("Runs by {}, {}", over.name(), stage.name());
            views.push(flat(layout, &title, &contents, heat::view(diagnosis.left.len()))?);
        }
        let title = format!("Map over {}", over.name());
        tabs.push(layout.split(ContainerKind::Horizontal, &title, &views, &[1.0, 1.0])?);
    }
    layout.split(ContainerKind::Tabs, "Maps", &tabs, &[])
}

/// The signal in the first runs, and below it the rest of each run in a tab.
fn proof((layout, drawn): (&mut Layout, &Recorder), diagnosis: &Diagnosis) -> Result<Node, ViewError> {
    let at_once = diagnosis.shown.len().min(AT_ONCE);
    let above_share = (2.0 * at_once as f32).clamp(2.0, 4.5);
    let above = COLUMN * f64::from(above_share / (above_share + BELOW));
    let height = above / at_once as f64;
    let mut signals = Vec::new();
    let mut tabs = Vec::new();
    for (index, shown) in diagnosis.shown.iter().enumerate() {
        let times_s = times_s(shown);
        let look = |at: &EntityPath, room: f64, height: f64| Look {
            times_s,
            room,
            span: drawn.span(std::slice::from_ref(at)),
            height,
        };
        let mut parts = Vec::new();
        let mut plot = |title: &str, at: EntityPath| {
            parts.push((title.to_owned(), at));
        };
        let signal = format!("{}: {}", named(shown), shown.signal);
        let error = format!("{}: measured − modelled", shown.run);
        if index < AT_ONCE {
            let views = [(signal, lines::signal(shown), WIDE_LEGEND), (error, lines::error(shown), 0.0)].map(
                |(title, at, room)| layout.plot(&title, std::slice::from_ref(&at), look(&at, room, height)),
            );
            let views = views.into_iter().collect::<Result<Vec<_>, _>>()?;
            signals.push(layout.split(ContainerKind::Horizontal, "", &views, &[1.0, 1.0])?);
        } else {
            plot(&signal, lines::signal(shown));
            plot(&error, lines::error(shown));
        }
        if diagnosis.left.iter().any(|left| left.run.id == shown.run) {
            let title =
                format!("{}: left over in the {} balance [{}]", shown.run, diagnosis.balance, diagnosis.unit);
            plot(&title, lines::left_over(shown));
        }
        for (number, effect) in shown.effects.iter().enumerate() {
            let title = format!("{}: {} [{}]", shown.run, effect.name, effect.unit);
            plot(&title, lines::effect(shown, number));
        }
        if !parts.is_empty() {
            let height = (COLUMN - above) / parts.len() as f64;
            let plots = parts
                .iter()
                .map(|(title, at)| layout.plot(title, std::slice::from_ref(at), look(at, LEGEND, height)))
                .collect::<Result<Vec<_>, _>>()?;
            let shares = vec![1.0; plots.len()];
            tabs.push(layout.split(ContainerKind::Vertical, shown.run, &plots, &shares)?);
        }
    }
    let above =
        layout.split(ContainerKind::Vertical, "Before and after", &signals, &vec![1.0; signals.len()])?;
    let below = match tabs.as_slice() {
        [] => return Ok(above),
        [only] => only.clone(),
        _ => layout.split(ContainerKind::Tabs, "Runs", &tabs, &[])?,
    };
    layout.split(ContainerKind::Vertical, "", &[above, below], &[above_share, BELOW])
}

fn named(shown: &Shown) -> String {
    format!("{} ({})", shown.run, if shown.held_out { "held out" } else { "fitted" })
}

fn times_s(shown: &Shown) -> [f64; 2] {
    let first = shown.time_s.first().copied().unwrap_or(0.0);
    [first, shown.time_s.last().copied().unwrap_or(first)]
}
