//! How the viewer lays a diagnosis out: where the mismatch sits and the words on the left, before and after on the right.

use super::heat::{self, Over};
use super::plan::Plan;
use super::{Diagnosis, Shown, Stage, lines};
use crate::ViewError;
use crate::entity;
use crate::layout::{LEGEND, Layout, Node, WIDE_LEGEND};
use rerun::external::re_sdk_types::blueprint::archetypes::{Background, VisualBounds2D};
use rerun::external::re_sdk_types::blueprint::components::{BackgroundKind, ContainerKind};
use rerun::log::LogMsg;
use rerun::{ApplicationId, AsComponents, EntityPath};

/// Behind plan and maps.
const DARK: [u8; 3] = [22, 26, 32];
/// Runs whose signal is seen at once; the others have it in their tabs.
const AT_ONCE: usize = 3;

/// The messages that make the layout.
pub(crate) fn messages(
    application: &ApplicationId,
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
        let right = proof(&mut layout, diagnosis)?;
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
fn proof(layout: &mut Layout, diagnosis: &Diagnosis) -> Result<Node, ViewError> {
    let mut signals = Vec::new();
    let mut tabs = Vec::new();
    for (index, shown) in diagnosis.shown.iter().enumerate() {
        let times_s = times_s(shown);
        let (mut parts, mut shares) = (Vec::new(), Vec::new());
        let mut plot = |layout: &mut Layout, title: &str, at: EntityPath| -> Result<(), ViewError> {
            parts.push(layout.plot(title, &[at], times_s, LEGEND)?);
            shares.push(1.0);
            Ok(())
        };
        let signal = format!("{}: {}", named(shown), shown.signal);
        let error = format!("{}: measured − modelled", shown.run);
        if index < AT_ONCE {
            let views = [
                layout.plot(&signal, &[lines::signal(shown)], times_s, WIDE_LEGEND)?,
                layout.plot(&error, &[lines::error(shown)], times_s, 0.0)?,
            ];
            signals.push(layout.split(ContainerKind::Horizontal, "", &views, &[1.0, 1.0])?);
        } else {
            plot(layout, &signal, lines::signal(shown))?;
            plot(layout, &error, lines::error(shown))?;
        }
        if diagnosis.left.iter().any(|left| left.run.id == shown.run) {
            let title =
                format!("{}: left over in the {} balance [{}]", shown.run, diagnosis.balance, diagnosis.unit);
            plot(layout, &title, lines::left_over(shown))?;
        }
        for (number, effect) in shown.effects.iter().enumerate() {
            let title = format!("{}: {} [{}]", shown.run, effect.name, effect.unit);
            plot(layout, &title, lines::effect(shown, number))?;
        }
        if !parts.is_empty() {
            tabs.push(layout.split(ContainerKind::Vertical, shown.run, &parts, &shares)?);
        }
    }
    let share = (2.0 * signals.len() as f32).min(4.5);
    let above =
        layout.split(ContainerKind::Vertical, "Before and after", &signals, &vec![1.0; signals.len()])?;
    let below = match tabs.as_slice() {
        [] => return Ok(above),
        [only] => only.clone(),
        _ => layout.split(ContainerKind::Tabs, "Runs", &tabs, &[])?,
    };
    layout.split(ContainerKind::Vertical, "", &[above, below], &[share.max(2.0), 3.0])
}

fn named(shown: &Shown) -> String {
    format!("{} ({})", shown.run, if shown.held_out { "held out" } else { "fitted" })
}

fn times_s(shown: &Shown) -> [f64; 2] {
    let first = shown.time_s.first().copied().unwrap_or(0.0);
    [first, shown.time_s.last().copied().unwrap_or(first)]
}
