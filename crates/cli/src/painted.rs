//! A diagnosis as it is drawn: the balance that fails first, the runs that prove it, and what else could be the cause.

use headland_diagnose::{Diagnosed, Diagnosis as Answer, FindingReport, Kind, LeftOver};
use headland_recording::Recording;
use headland_report::Axis;
use headland_trace::Run;
use headland_view::{Diagnosis, Effect, Left, Shown};
use std::fmt::Write;

/// Causes that are told of those that were tried.
const TRIED: usize = 6;
/// Units of effects, as the names of their channels end, and as they are printed.
const UNITS: [(&str, &str); 4] = [("n", "N"), ("w", "W"), ("m_s", "m/s"), ("m_s2", "m/s²")];

/// The runs of a recording, as they are drawn.
pub fn runs(recording: &Recording) -> Vec<Run> {
    recording.runs.iter().map(|run| Run { id: run.id.clone(), trace: run.trace.clone() }).collect()
}

/// The words beside the picture, in Markdown.
pub struct Words {
    answer: String,
    alternatives: String,
}

impl Words {
    /// Of an answer.
    pub fn of(answer: &Answer) -> Self {
        let mut findings = format!("{}\n", answer.answer);
        for finding in &answer.findings {
            let _ = writeln!(findings, "\n**{}** {}", plain(&finding.id), finding.equation);
        }
        Self { answer: findings, alternatives: alternatives(answer) }
    }
}

/// What is drawn of a diagnosis.
pub fn painted<'a>(title: &'a str, found: &'a Diagnosed, runs: &'a [Run], words: &'a Words) -> Diagnosis<'a> {
    let answer = &found.diagnosis;
    let kind = answer
        .first_balance
        .or(answer.findings.first().map(|finding| finding.balance))
        .or(found.residuals.first().map(|left| left.balance));
    let left = |left: &'a LeftOver| {
        (!left.time_s.is_empty()).then_some(())?;
        Some(Left {
            run: runs.iter().find(|run| run.id == left.run)?,
            held_out: left.held_out,
            path: left.path,
            reversed: left.reversed,
            time_s: &left.time_s,
            position_m: &left.position_m,
            speed_m_s: &left.speed_m_s,
            before: &left.before,
            after: &left.after,
        })
    };
    let shown = |shown: &'a headland_diagnose::Shown| {
        let Axis { label, unit } = Axis::of(&shown.signal);
        Shown {
            run: &shown.run,
            held_out: shown.held_out,
            signal: format!("{label} [{unit}]"),
            time_s: &shown.time_s,
            measured: &shown.measured,
            before: &shown.before,
            after: &shown.after,
            effects: answer
                .findings
                .iter()
                .filter_map(|finding| effect(found, finding, &shown.run))
                .collect(),
        }
    };
    Diagnosis {
        title,
        answer: &words.answer,
        alternatives: &words.alternatives,
        balance: kind.map_or("", Kind::name),
        unit: kind.map_or("", Kind::unit),
        left: found.residuals.iter().filter(|left| Some(left.balance) == kind).filter_map(left).collect(),
        shown: found.shown.iter().map(shown).collect(),
    }
}

fn effect<'a>(found: &'a Diagnosed, finding: &FindingReport, run: &str) -> Option<Effect<'a>> {
    let trace = &found.effects.iter().find(|effects| effects.id == run)?.trace;
    let channel = |(end, unit): &(&str, &str)| {
        let name = format!("{}_{end}", finding.id);
        trace.get(&name).is_some().then(|| (name, (*unit).to_owned()))
    };
    let (channel, unit) = UNITS.iter().find_map(channel)?;
    Some(Effect { name: plain(&finding.id), unit, trace, channel })
}

fn plain(id: &str) -> String {
    id.replace('_', " ")
}

/// What cannot be told from what was found, what was tried, and what to drive next.
fn alternatives(answer: &Answer) -> String {
    let mut text = String::new();
    for finding in &answer.findings {
        let name = plain(&finding.id);
        if finding.indistinguishable_from.is_empty() {
            let _ = writeln!(text, "No other cause explains as much as **{name}**.\n");
        } else {
            let _ = writeln!(text, "As likely as **{name}** (growth of ln p {:.1}):\n", finding.evidence[0]);
            text.push_str("| cause | growth of ln p |\n|---|---|\n");
            for rival in &finding.indistinguishable_from {
                let _ = writeln!(text, "| {} | {:.1} |", plain(&rival.id), rival.evidence);
            }
            text.push('\n');
        }
    }
    if answer.findings.is_empty() {
        text.push_str("Nothing was found that other causes could stand in for.\n\n");
    }
    let mut best: Vec<&headland_diagnose::Tried> = Vec::new();
    for one in answer.tried.iter().filter(|one| one.round == 1) {
        if !best.iter().any(|known| known.id == one.id) {
            best.push(one);
        }
    }
    if let Some(first) = best.first() {
        let _ = writeln!(text, "Tried alone, with {:.1} needed:\n", first.needed);
        text.push_str("| cause | growth of ln p |\n|---|---|\n");
        for one in best.iter().take(TRIED) {
            let _ = writeln!(text, "| {} | {:.1} |", plain(&one.id), one.gain);
        }
        text.push('\n');
    }
    for finding in &answer.findings {
        let _ = writeln!(text, "To make sure of {}: {}.\n", plain(&finding.id), finding.next_experiment);
    }
    for sentence in &answer.null_space {
        let _ = writeln!(text, "Cannot be told: {sentence}\n");
    }
    text
}
