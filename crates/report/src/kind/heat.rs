//! A table of numbers shown as colours, as for correlations.

use crate::draw::{Drawn, Scale, same_length};
use crate::{Axis, ReportError};
use serde_json::{Value, json};

/// Rows and columns of numbers on a two-sided colour scale around 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heat {
    /// What the numbers are.
    pub axis: Axis,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Names of the rows.
    pub rows: Vec<String>,
    /// `values[row][column]`; NaN where there is none.
    pub values: Vec<Vec<f64>>,
    /// Ends of the colour scale: from minus this to this.
    pub limit: f64,
}

impl Heat {
    pub(crate) fn draw(&self, plot: &str) -> Result<Drawn, ReportError> {
        same_length(plot, "rows", "the heat map", self.values.len(), self.rows.len())?;
        for (row, values) in self.rows.iter().zip(&self.values) {
            same_length(plot, row, "the row", values.len(), self.columns.len())?;
        }
        let scale = Scale::new(&self.axis, self.values.iter().flatten().copied());
        let strongest = self.strongest();
        let alt = format!(
            "Heat map of {}: {} by {}{}.",
            self.axis.label,
            self.rows.join(", "),
            self.columns.join(", "),
            strongest.map(|words| format!("; strongest: {words}")).unwrap_or_default()
        );
        let spec = json!({
            "kind": "heat",
            "axis": scale.spec(),
            "columns": self.columns,
            "rows": self.rows,
            "limit": scale.one(self.limit),
            "values": self.values.iter().map(|row| scale.all(row.iter().copied())).collect::<Vec<Value>>(),
        });
        Ok(Drawn { spec, alt, notes: Vec::new() })
    }

    /// The cell that is furthest from 0 and joins two different names.
    fn strongest(&self) -> Option<String> {
        let cells = self.rows.iter().zip(&self.values).flat_map(|(row, values)| {
            self.columns.iter().zip(values).map(move |(column, value)| (row, column, *value))
        });
        let (row, column, value) = cells
            .filter(|(row, column, value)| row != column && value.is_finite())
            .max_by(|one, other| one.2.abs().total_cmp(&other.2.abs()))?;
        Some(format!("{row} with {column} {}", crate::number::number(value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_strongest_correlation_is_told_and_the_diagonal_is_not_it() {
        let names = vec!["f0".to_owned(), "f2".to_owned()];
        let heat = Heat {
            axis: Axis::new("correlation", ""),
            columns: names.clone(),
            rows: names,
            values: vec![vec![1.0, -0.93], vec![-0.93, 1.0]],
            limit: 1.0,
        };
        assert!(heat.draw("correlation").unwrap().alt.contains("f2 with f0 −0.93"));
        let ragged = Heat { values: vec![vec![1.0], vec![1.0, 2.0]], ..heat };
        assert!(ragged.draw("correlation").is_err());
    }
}
