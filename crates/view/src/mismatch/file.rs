//! A diagnosis as an `.rrd` file.

use super::heat::{self, Over};
use super::plan::Plan;
use super::scale::{Scale, smoothed};
use super::{Diagnosis, Stage, layout, lines};
use crate::ViewError;
use crate::entity;
use crate::file::{begun, store};
use rerun::TextDocument;
use rerun::log::LogMsg;
use std::path::Path;

/// Writes a diagnosis to a file, which appears whole or not at all.
///
/// # Errors
/// [`ViewError::Rows`] where numbers do not stand row by row, [`ViewError::File`] where the file system refuses.
pub fn write(diagnosis: &Diagnosis, path: &Path) -> Result<(), ViewError> {
    store(messages(diagnosis)?, path)
}

/// Everything that the file holds: the layout first, so that the viewer has it before the data.
fn messages(diagnosis: &Diagnosis) -> Result<Vec<LogMsg>, ViewError> {
    diagnosis.check()?;
    let (application, to) = begun(diagnosis.title)?;
    let plan = (!diagnosis.left.is_empty()).then(|| Plan::of(&diagnosis.left));
    let mut answer = diagnosis.answer.to_owned();
    if let Some(plan) = &plan {
        // One scale for before and after: what was found shows as colours that fade.
        let scale = Scale::of(diagnosis.left.iter().flat_map(|left| smoothed(left, Stage::Before)));
        plan.draw(&to, diagnosis, scale)?;
        for over in Over::BOTH {
            heat::draw(&to, diagnosis, over, scale)?;
        }
        answer.push_str(&legend(diagnosis, plan));
    }
    for shown in &diagnosis.shown {
        lines::draw(&to, diagnosis, shown)?;
    }
    for (name, text) in [("answer", answer.as_str()), ("alternatives", diagnosis.alternatives)] {
        to.fixed(&entity::words(name), &TextDocument::from_markdown(text))?;
    }
    let mut messages = layout::messages((&application, &to), diagnosis, plan.as_ref())?;
    messages.extend(to.finish());
    Ok(messages)
}

/// What colours and places stand for, in Markdown.
fn legend(diagnosis: &Diagnosis, plan: &Plan) -> String {
    let places = if plan.located {
        "Runs lie beside one another, a little aside of where they drove."
    } else {
        "The recordings know no places, so each run lies straight on, by its position."
    };
    // The rows of motion are written for what resists.
    let (more, less) = if diagnosis.balance == "motion" {
        ("more resistance than modelled", "less")
    } else {
        ("more than modelled", "less")
    };
    format!(
        "\n\nPainted is what the {} balance leaves over, in {}: orange is {more}, blue is {less}, grey is none; the dot is where a run \
         is at this time. Runs in brackets were held out. {places}\n",
        diagnosis.balance, diagnosis.unit
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mismatch::{Effect, Left, Shown};
    use crate::scene::tests::run;

    #[test]
    fn a_diagnosis_holds_its_plan_its_maps_its_lines_and_its_words() {
        let at: Vec<f64> = (0..100).map(f64::from).collect();
        let recorded = run("r1", &[("position_m", &at), ("heading_rad", &vec![0.5; 100])]);
        let effects = run("r1", &[("drag_n", &at), ("drag_n_low", &at), ("drag_n_high", &at)]);
        let left = Left {
            run: &recorded,
            held_out: true,
            path: 0,
            reversed: false,
            time_s: &at,
            position_m: &at,
            speed_m_s: &at,
            before: &at,
            after: &at,
        };
        let effect = Effect {
            name: "drag".to_owned(),
            unit: "N".to_owned(),
            trace: &effects.trace,
            channel: "drag_n".to_owned(),
        };
        let shown = Shown {
            run: "r1",
            held_out: true,
            signal: "speed [m/s]".to_owned(),
            time_s: &at,
            measured: &at,
            before: &at,
            after: &at,
            effects: vec![effect],
        };
        let diagnosis = Diagnosis {
            title: "a test",
            answer: "Drag.",
            alternatives: "None.",
            balance: "motion",
            unit: "N",
            left: vec![left],
            shown: vec![shown],
        };
        let messages = messages(&diagnosis).unwrap();
        let told = format!("{messages:?}");
        for part in [
            "/plan/before/r1",
            "/plan/here/r1",
            "/maps/position/after",
            "/maps/speed/axes",
            "/words/alternatives",
            "/diagnosed/r1/signal",
            "/diagnosed/r1/effect/0/2",
            "/diagnosed/r1/left",
        ] {
            assert!(told.contains(part), "{part} is missing");
        }
        // Where nothing could be held against the model the words are all there is.
        let empty = Diagnosis { left: Vec::new(), shown: Vec::new(), ..diagnosis };
        assert!(!super::messages(&empty).unwrap().is_empty());
    }
}
