//! The pages that commands write.

pub mod batch;
pub mod calibrate;
pub mod coastdown;
pub mod compare;
pub mod diagnose;
mod energy;
mod motion;
pub mod optimum;
pub mod run;
mod wheels;

use headland_recording::Notice;
use headland_report::{Axis, Cell, Item, Section, Table};

/// Title of the section about the data.
pub const ABOUT_DATA: &str = "What to know about the data";

/// A number with four significant digits.
pub fn short(value: f64) -> String {
    headland_report::number(value)
}

/// The title of a run: `Run r1`, and `run_01` as it is.
fn titled(id: &str) -> String {
    if id.to_lowercase().starts_with("run") { id.to_owned() } else { format!("Run {id}") }
}

/// Most rows of notices on a page.
const NOTICES: usize = 60;

/// What recordings show about themselves and what was decided on the way; nothing where there is nothing.
fn notices(notices: &[Notice], notes: &[String]) -> Option<Section> {
    if notices.is_empty() && notes.is_empty() {
        return None;
    }
    let mut section =
        Section::new(ABOUT_DATA).words("Nothing of it was repaired: the logs were used as they are.");
    if !notes.is_empty() {
        section = section.with(Item::Sentences(notes.to_vec()));
    }
    if !notices.is_empty() {
        let row = |notice: &Notice| {
            let run = if notice.run.is_empty() { "all" } else { &notice.run };
            vec![Cell::from(run), Cell::from(notice.kind.name()), Cell::from(notice.text.clone())]
        };
        let shown = notices.len().min(NOTICES);
        let title = if shown < notices.len() {
            format!("Notices, the first {shown} of {}", notices.len())
        } else {
            "Notices".to_owned()
        };
        section = section.with(Table {
            title,
            columns: ["run", "kind", "what was seen"].map(|name| Axis::new(name, "")).to_vec(),
            rows: notices.iter().take(NOTICES).map(row).collect(),
        });
    }
    Some(section)
}
