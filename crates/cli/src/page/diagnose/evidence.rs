//! What else was tried, and why it lost.

use super::plain;
use headland_diagnose::{Diagnosed, Tried};
use headland_report::{Axis, Cell, Section, Table};

/// Causes that are listed of each round.
const LISTED: usize = 10;

/// The section; none where nothing was tried.
pub fn section(found: &Diagnosed) -> Option<Section> {
    let tried = &found.diagnosis.tried;
    if tried.is_empty() {
        return None;
    }
    let mut section = Section::new("Evidence: what was tried and why it lost").words(
        "Sets of causes are grown side by side, one cause in each round. A cause has to make ln p grow by more than the best \
         of all causes would by chance, once in a hundred times, and what it says of some runs has to hold in the others.",
    );
    let last = tried.iter().map(|one| one.round).max().unwrap_or(0);
    for round in 1..=last {
        let own: Vec<&Tried> = tried.iter().filter(|one| one.round == round).collect();
        let Some(first) = own.first() else { continue };
        let beside = if round == 1 { "alone" } else { "beside the likeliest set of the round before" };
        let mut seen: Vec<&str> = Vec::new();
        let mut rows = Vec::new();
        for one in &own {
            // Of each cause the best of its shapes.
            if !seen.contains(&one.id.as_str()) && seen.len() < LISTED {
                seen.push(&one.id);
                rows.push(vec![
                    Cell::from(plain(&one.id)),
                    Cell::from(tenths(one.gain)),
                    Cell::from(became(one, &own, found)),
                ]);
            }
        }
        section = section.with(Table {
            title: format!("Round {round}: {beside}; {} needed", tenths(first.needed)),
            columns: vec![
                Axis::new("cause", ""),
                Axis::new("growth of ln p", ""),
                Axis::new("what became of it", ""),
            ],
            rows,
        });
    }
    Some(section)
}

/// Growths of ln p are told to a tenth: less than one decides nothing.
fn tenths(value: f64) -> String {
    format!("{value:.1}")
}

fn became(one: &Tried, round: &[&Tried], found: &Diagnosed) -> String {
    let diagnosis = &found.diagnosis;
    if diagnosis.unproven.contains(&one.id) {
        return "explains each run by itself, but not one from the others".to_owned();
    }
    if diagnosis.findings.iter().any(|finding| finding.id == one.id) {
        return "is in what was found".to_owned();
    }
    if one.gain < one.needed {
        return "no more than chance".to_owned();
    }
    for finding in &diagnosis.findings {
        if let Some(rival) = finding.indistinguishable_from.iter().find(|rival| rival.id == one.id) {
            let less = finding.evidence[0] - rival.evidence;
            return match plain(&finding.id) {
                id if less > 0.0 => format!("cannot be told from {id}: less likely by {} only", tenths(less)),
                id => format!("cannot be told from {id}: as likely"),
            };
        }
    }
    let best = round.iter().map(|other| other.gain).fold(f64::NEG_INFINITY, f64::max);
    if one.gain < best {
        format!("less likely than the best by {}", tenths(best - one.gain))
    } else {
        "not needed beside what was found".to_owned()
    }
}
