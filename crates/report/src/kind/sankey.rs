//! Flows from sources to sinks, as wide as they are large.

use crate::draw::{Drawn, Scale};
use crate::{Axis, ReportError, number};
use serde_json::json;
use std::collections::BTreeMap;

/// What passes from one node to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Flow {
    /// Where it leaves.
    pub from: String,
    /// Where it arrives.
    pub to: String,
    /// How much, above 0.
    pub value: f64,
}

/// A diagram of flows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sankey {
    /// What flows.
    pub axis: Axis,
    /// The flows. They run in no circle.
    pub flows: Vec<Flow>,
    /// Which of the colours of a page, counted from 0, a node has, so that it is the same in several plots. Those that are not named
    /// here have the colour of their order.
    pub colours: BTreeMap<String, usize>,
}

impl Sankey {
    pub(crate) fn draw(&self, plot: &str) -> Result<Drawn, ReportError> {
        for Flow { from, to, value } in &self.flows {
            if !(value.is_finite() && *value > 0.0) {
                return Err(ReportError::Flow {
                    plot: plot.to_owned(),
                    from: from.clone(),
                    to: to.clone(),
                    value: *value,
                });
            }
        }
        if let Some(through) = self.circle() {
            return Err(ReportError::Circle { plot: plot.to_owned(), through: through.to_owned() });
        }
        let scale = Scale::new(&self.axis, self.flows.iter().map(|flow| flow.value));
        let words: Vec<String> = self
            .flows
            .iter()
            .map(|Flow { from, to, value }| {
                format!("{from} to {to} {}", number::quantity(*value, &self.axis.unit))
            })
            .collect();
        let spec = json!({
            "kind": "sankey",
            "axis": scale.spec(),
            "nodes": self.nodes(),
            "colours": self.colours,
            "flows": self.flows.iter().map(|flow| {
                json!({ "from": flow.from, "to": flow.to, "value": scale.one(flow.value) })
            }).collect::<Vec<_>>(),
        });
        let alt = format!("Flows of {}: {}.", self.axis.label, words.join("; "));
        Ok(Drawn { spec, alt, notes: Vec::new() })
    }

    fn nodes(&self) -> Vec<&str> {
        let mut nodes: Vec<&str> = Vec::new();
        for end in self.flows.iter().flat_map(|flow| [flow.from.as_str(), flow.to.as_str()]) {
            if !nodes.contains(&end) {
                nodes.push(end);
            }
        }
        nodes
    }

    /// A node that is left when nodes without inflow are taken away again and again.
    fn circle(&self) -> Option<&str> {
        let mut nodes = self.nodes();
        loop {
            let before = nodes.len();
            let fed: Vec<&str> = self
                .flows
                .iter()
                .filter(|flow| nodes.contains(&flow.from.as_str()))
                .map(|flow| flow.to.as_str())
                .collect();
            nodes.retain(|node| fed.contains(node));
            if nodes.len() == before {
                return nodes.first().copied();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow(from: &str, to: &str, value: f64) -> Flow {
        Flow { from: from.to_owned(), to: to.to_owned(), value }
    }

    #[test]
    fn a_circle_and_a_backward_flow_are_refused() {
        let axis = Axis::new("energy", "J");
        let circle = vec![flow("x", "a", 1.0), flow("a", "b", 1.0), flow("b", "a", 1.0), flow("b", "y", 1.0)];
        let error =
            Sankey { axis: axis.clone(), flows: circle, ..Sankey::default() }.draw("energy").unwrap_err();
        assert_eq!(error.to_string(), "plot `energy`: the flows through `a` run in a circle");
        for value in [-1.0, 0.0, f64::NAN] {
            let flows = vec![flow("a", "b", value)];
            assert!(Sankey { axis: axis.clone(), flows, ..Sankey::default() }.draw("energy").is_err());
        }
    }

    #[test]
    fn each_flow_is_told_in_words() {
        let flows = vec![flow("kinetic", "soil", 448_100.0), flow("kinetic", "air", 3_900.0)];
        let colours = BTreeMap::from([("soil".to_owned(), 3)]);
        let drawn = Sankey { axis: Axis::new("energy", "J"), flows, colours }.draw("energy").unwrap();
        assert_eq!(drawn.spec["colours"], json!({ "soil": 3 }));
        assert_eq!(drawn.alt, "Flows of energy: kinetic to soil 448.1\u{a0}kJ; kinetic to air 3900\u{a0}J.");
    }
}
