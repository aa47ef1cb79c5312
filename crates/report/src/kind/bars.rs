//! Bars: side by side or stacked, upright or lying, with error bars.

use crate::draw::{Drawn, Scale, same_length};
use crate::{Axis, ReportError};
use serde_json::{Value, json};

/// One set of bars, one value a category; NaN where there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bar {
    /// Its name.
    pub name: String,
    /// Lengths.
    pub values: Vec<f64>,
    /// Ends of the error bars: lower and upper.
    pub error: Option<(Vec<f64>, Vec<f64>)>,
}

/// Bars over categories.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    /// What stands below each group of bars.
    pub categories: Vec<String>,
    /// What the lengths measure.
    pub axis: Axis,
    /// The bars.
    pub bars: Vec<Bar>,
    /// On each other, not side by side.
    pub stacked: bool,
    /// Lying: better for long names.
    pub horizontal: bool,
}

impl Bars {
    pub(crate) fn draw(&self, plot: &str) -> Result<Drawn, ReportError> {
        for bar in &self.bars {
            same_length(plot, &bar.name, "the bars", bar.values.len(), self.categories.len())?;
            if let Some((low, high)) = &bar.error {
                same_length(plot, &bar.name, "the lower error", low.len(), self.categories.len())?;
                same_length(plot, &bar.name, "the upper error", high.len(), self.categories.len())?;
            }
        }
        let scale = Scale::new(
            &self.axis,
            self.bars.iter().flat_map(|bar| {
                let errors = bar.error.iter().flat_map(|(low, high)| low.iter().chain(high));
                bar.values.iter().chain(errors).copied()
            }),
        );
        let bars: Vec<Value> = self
            .bars
            .iter()
            .map(|bar| {
                json!({
                    "name": bar.name,
                    "values": scale.all(bar.values.iter().copied()),
                    "low": bar.error.as_ref().map(|(low, _)| scale.all(low.iter().copied())),
                    "high": bar.error.as_ref().map(|(_, high)| scale.all(high.iter().copied())),
                })
            })
            .collect();
        let names: Vec<&str> = self.bars.iter().map(|bar| bar.name.as_str()).collect();
        let alt = format!(
            "Bars of {} for {}: {}. Values {}.",
            scale.axis.label,
            self.categories.join(", "),
            names.join(", "),
            scale.words()
        );
        let spec = json!({
            "kind": "bars",
            "axis": scale.spec(),
            "categories": self.categories,
            "bars": bars,
            "stacked": self.stacked,
            "horizontal": self.horizontal,
        });
        Ok(Drawn { spec, alt, notes: Vec::new() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_bar_is_null_and_a_short_error_is_refused() {
        let bar = Bar { name: "rmse".to_owned(), values: vec![0.5, f64::NAN], error: None };
        let mut bars = Bars {
            categories: vec!["a".to_owned(), "b".to_owned()],
            axis: Axis::of("speed_m_s"),
            bars: vec![bar],
            ..Bars::default()
        };
        assert_eq!(bars.draw("errors").unwrap().spec["bars"][0]["values"], json!([0.5, null]));
        bars.bars[0].error = Some((vec![0.4], vec![0.6]));
        assert!(bars.draw("errors").unwrap_err().to_string().contains("the lower error of `rmse` has 1"));
    }
}
