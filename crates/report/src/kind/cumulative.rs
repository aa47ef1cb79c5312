//! Cumulative probability as steps, with bands.

use crate::draw::{BY_EXTREMES, Drawn, Scale, Thinned, same_length};
use crate::thin::{BUCKETS, extremes};
use crate::{Axis, ReportError};
use serde_json::{Value, json};

/// A distribution: the probability to find at most `x`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Steps {
    /// Its name.
    pub name: String,
    /// Values, ascending.
    pub x: Vec<f64>,
    /// Probability of at most `x`, 0 to 1.
    pub probability: Vec<f64>,
    /// Lower and upper limit of the probability.
    pub band: Option<(Vec<f64>, Vec<f64>)>,
}

/// Distributions over a common axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cumulative {
    /// What is distributed.
    pub axis: Axis,
    /// The distributions.
    pub steps: Vec<Steps>,
}

impl Cumulative {
    pub(crate) fn draw(&self, plot: &str) -> Result<Drawn, ReportError> {
        for steps in &self.steps {
            same_length(plot, &steps.name, "the probability", steps.probability.len(), steps.x.len())?;
            if let Some((low, high)) = &steps.band {
                same_length(plot, &steps.name, "the lower band", low.len(), steps.x.len())?;
                same_length(plot, &steps.name, "the upper band", high.len(), steps.x.len())?;
            }
        }
        let x = Scale::new(&self.axis, self.steps.iter().flat_map(|steps| steps.x.iter().copied()));
        let y = Scale::new(&Axis::new("cumulative probability", ""), [0.0, 1.0].into_iter());
        let mut thinned = Thinned::default();
        let series: Vec<Value> = self
            .steps
            .iter()
            .map(|steps| {
                let kept = extremes(&steps.x, &[&steps.probability], BUCKETS);
                thinned.add(&steps.name, kept.len(), steps.x.len());
                let pick = |values: &[f64], scale: &Scale| scale.all(kept.iter().map(|at| values[*at]));
                json!({
                    "name": steps.name,
                    "x": pick(&steps.x, &x),
                    "y": pick(&steps.probability, &y),
                    "low": steps.band.as_ref().map(|(low, _)| pick(low, &y)),
                    "high": steps.band.as_ref().map(|(_, high)| pick(high, &y)),
                })
            })
            .collect();
        let names: Vec<&str> = self.steps.iter().map(|steps| steps.name.as_str()).collect();
        let alt = format!(
            "Cumulative probability of {}: {}. {} {}.",
            x.axis.label,
            names.join(", "),
            x.axis.label,
            x.words()
        );
        let spec = json!({ "kind": "cumulative", "x": x.spec(), "y": y.spec(), "series": series });
        Ok(Drawn { spec, alt, notes: thinned.note(BY_EXTREMES).into_iter().collect() })
    }
}
