//! Tables and key figures.

use crate::html::escape;
use crate::{Axis, ReportError, number};
use std::fmt::Write;

/// One cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A text.
    Text(String),
    /// A number, printed with four significant digits; NaN as a dash.
    Number(f64),
    /// A value with the ends of its interval, printed to two digits of the half width.
    Interval {
        /// The value.
        value: f64,
        /// Lower end.
        lower: f64,
        /// Upper end.
        upper: f64,
    },
    /// A number as it is to be read, as `+2.3 ± 0.1`.
    Written(String),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// A table with a heading. The first column names the rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Title.
    pub title: String,
    /// What the columns hold, with their units.
    pub columns: Vec<Axis>,
    /// As many cells as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    pub(crate) fn html(&self) -> Result<String, ReportError> {
        for (index, row) in self.rows.iter().enumerate() {
            if row.len() != self.columns.len() {
                return Err(ReportError::Row {
                    table: self.title.clone(),
                    row: index + 1,
                    found: row.len(),
                    expected: self.columns.len(),
                });
            }
        }
        let mut html = format!(
            "<div class=\"table\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table><caption>{0}</caption><thead><tr>",
            escape(&self.title)
        );
        for (index, column) in self.columns.iter().enumerate() {
            let class = if self.is_text(index) { "" } else { " class=\"number\"" };
            let _ = write!(html, "<th scope=\"col\"{class}>{}</th>", escape(&column.title()));
        }
        html.push_str("</tr></thead><tbody>");
        for row in &self.rows {
            html.push_str("<tr>");
            for (index, cell) in row.iter().enumerate() {
                html.push_str(&cell_html(cell, index == 0));
            }
            html.push_str("</tr>");
        }
        html.push_str("</tbody></table></div>\n");
        Ok(html)
    }

    fn is_text(&self, column: usize) -> bool {
        self.rows.iter().all(|row| matches!(row[column], Cell::Text(_)))
    }
}

fn cell_html(cell: &Cell, heads_row: bool) -> String {
    match cell {
        Cell::Text(text) if heads_row => format!("<th scope=\"row\">{}</th>", escape(text)),
        Cell::Text(text) => format!("<td>{}</td>", escape(text)),
        Cell::Written(text) => format!("<td class=\"number\">{}</td>", escape(text)),
        Cell::Number(value) => format!("<td class=\"number\">{}</td>", number::number(*value)),
        Cell::Interval { value, lower, upper } => {
            let (value, interval) = number::with_interval(*value, *lower, *upper);
            format!("<td class=\"number\">{value} <span class=\"interval\">({interval})</span></td>")
        }
    }
}

/// Whether a figure is good news.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// Neither.
    #[default]
    Plain,
    /// A requirement is met.
    Good,
    /// A requirement is not met.
    Bad,
}

/// A key number, shown large.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Figure {
    label: String,
    value: String,
    note: String,
    tone: Tone,
}

impl Figure {
    /// A number with its unit; large ones take a prefix.
    pub fn new(label: impl Into<String>, value: f64, unit: &str) -> Self {
        Self::text(label, number::quantity(value, unit))
    }

    /// A text in the place of a number.
    pub fn text(label: impl Into<String>, value: impl Into<String>) -> Self {
        Self { label: label.into(), value: value.into(), ..Self::default() }
    }

    /// With a line below.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Marked as met or not met.
    #[must_use]
    pub fn tone(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }

    pub(crate) fn html(&self) -> String {
        let (class, spoken) = match self.tone {
            Tone::Plain => ("", ""),
            Tone::Good => (" good", " <span class=\"tone\">met</span>"),
            Tone::Bad => (" bad", " <span class=\"tone\">not met</span>"),
        };
        let mut html = format!(
            "<div class=\"tile{class}\"><dt>{}</dt><dd>{}{spoken}",
            escape(&self.label),
            escape(&self.value)
        );
        if !self.note.is_empty() {
            let _ = write!(html, "<small>{}</small>", escape(&self.note));
        }
        html.push_str("</dd></div>");
        html
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: Vec<Vec<Cell>>) -> Table {
        Table {
            title: "parameters".to_owned(),
            columns: vec![Axis::new("name", ""), Axis::new("value", "N")],
            rows,
        }
    }

    #[test]
    fn a_row_of_another_length_is_refused() {
        let error = table(vec![vec!["f0".into(), 1.0.into()], vec!["f1".into()]]).html().unwrap_err();
        assert_eq!(error.to_string(), "table `parameters`: row 2 has 1 cells, expected 2");
    }

    #[test]
    fn texts_are_escaped_and_missing_numbers_are_dashes() {
        let html = table(vec![vec!["a<b".into(), f64::NAN.into()]]).html().unwrap();
        assert!(html.contains("<th scope=\"row\">a&lt;b</th><td class=\"number\">–</td>"), "{html}");
        assert!(html.contains("<th scope=\"col\" class=\"number\">value [N]</th>"), "{html}");
    }

    #[test]
    fn a_figure_that_is_not_met_says_so_in_words_too() {
        let html = Figure::new("RMSE", 0.31, "m/s").tone(Tone::Bad).html();
        assert!(html.contains("0.31\u{a0}m/s") && html.contains("not met"), "{html}");
    }
}
