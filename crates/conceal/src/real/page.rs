//! The rows as a page of Markdown.

use super::Row;
use std::fmt::Write;

/// The page.
pub fn page(rows: &[Row]) -> String {
    let mut text = String::from(
        "# Real recordings with a concealed channel\n\n\
         Made by `conceal real --program target/release/headland --markdown docs/evidence/real.md`: every row is posed with the \
         published channels alone, the diagnosis writes its answer, and only then are the withheld channels opened and held \
         against it. No row is left out. *Held out* is the error on runs that were neither chosen nor fitted on, with the \
         nominal scenario and with what was found.\n\n",
    );
    text.push_str("| recordings | concealed | what was said | held out, before → after | goals met | time s |\n|---|---|---|---|---|---|\n");
    for row in rows {
        let goals = row.figures.iter().filter_map(|figure| figure.met);
        let met = goals.clone().filter(|met| *met).count();
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} | {met}/{} | {:.0} |",
            row.set,
            cell(&row.concealed),
            cell(&row.said),
            cell(&row.held_out),
            goals.count(),
            row.wall_s
        );
    }
    for row in rows {
        let _ = writeln!(text, "\n## `{}`: {}\n", row.set, row.concealed);
        let _ = writeln!(text, "> {}\n", row.answer.replace('\n', " "));
        if !row.figures.is_empty() {
            text.push_str("| against the truth | value | goal | met |\n|---|---|---|---|\n");
        }
        for figure in &row.figures {
            let met = figure.met.map_or("", |met| if met { "yes" } else { "**no**" });
            let _ = writeln!(
                text,
                "| {} | {} | {} | {met} |",
                cell(&figure.what),
                cell(&figure.value),
                cell(&figure.goal)
            );
        }
        let failed: Vec<&str> = row
            .figures
            .iter()
            .filter(|figure| figure.met == Some(false))
            .map(|figure| figure.what.as_str())
            .collect();
        if !failed.is_empty() {
            let _ = writeln!(text, "\nWhere it failed: {}.", failed.join("; "));
        }
        if !row.details.is_empty() {
            let _ = writeln!(text, "\n{}", row.details);
        }
    }
    text
}

fn cell(text: &str) -> String {
    text.replace('|', "/").replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Figure;

    #[test]
    fn a_goal_that_was_missed_is_told_twice() {
        let missed = Figure::goal("slope", "0.5".to_owned(), "0.95 to 1.05", false);
        let row = Row { set: "set", figures: vec![missed], ..Row::default() };
        let text = page(&[row]);
        assert!(text.contains("| 0/1 |") && text.contains("Where it failed: slope."));
    }
}
