//! What scatters between repetitions: parameters that nobody knows better.

use crate::comparison::expected;
use crate::draw::{generator, normal, uniform};
use headland_scenario::{Document, Node, ScenarioError, Shape};

/// How far a value lies from the one that is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spread {
    /// Normally, with this standard deviation.
    Normal(f64),
    /// Evenly, at most this far.
    Within(f64),
    /// Normally, with this standard deviation as a share of the value.
    Share(f64),
}

/// A parameter that scatters.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Dotted path.
    pub path: String,
    /// How far.
    pub spread: Spread,
    /// Where the path stands in the comparison.
    pub(crate) at: usize,
}

impl Scatter {
    pub(crate) fn read(document: &Document) -> Result<Vec<Self>, ScenarioError> {
        let Some(node) = document.find("repeat.scatter") else { return Ok(Vec::new()) };
        entries(document, node, "scatter")?
            .into_iter()
            .map(|(path, value, at)| {
                let spread = spread(document, value)?;
                Ok(Self { path, spread, at })
            })
            .collect()
    }

    /// The value of a repetition, where the scenario says `value`. It is the same in every variant, cycle and ground, so
    /// that differences between them are not of chance.
    pub fn value(&self, value: f64, seed: u64, repetition: u32) -> f64 {
        let mut draws = generator(seed, &self.path, u64::from(repetition));
        match self.spread {
            Spread::Normal(sd) => value + sd * normal(&mut draws),
            Spread::Within(half) => value + half * (2.0 * uniform(&mut draws) - 1.0),
            Spread::Share(sd) => value * (1.0 + sd * normal(&mut draws)),
        }
    }
}

fn spread(document: &Document, node: &Node) -> Result<Spread, ScenarioError> {
    const WANTED: &str = "Normal(sd), Within(half width) or Share(sd), with a number above 0";
    let refuse = || expected(document, node, "scatter", WANTED);
    let Shape::Tuple { values, .. } = &node.shape else { return Err(refuse()) };
    let [value] = values.as_slice() else { return Err(refuse()) };
    let size = number(document, value).filter(|size| *size > 0.0).ok_or_else(refuse)?;
    match node.name(document.text()) {
        Some("Normal") => Ok(Spread::Normal(size)),
        Some("Within") => Ok(Spread::Within(size)),
        Some("Share") => Ok(Spread::Share(size)),
        _ => Err(refuse()),
    }
}

/// A finite number that stands at a node.
pub(crate) fn number(document: &Document, node: &Node) -> Option<f64> {
    let text = document.text()[node.span.clone()].replace('_', "");
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Paths, values and places of a map from dotted paths.
pub(crate) fn entries<'a>(
    document: &Document,
    node: &'a Node,
    name: &str,
) -> Result<Vec<(String, &'a Node, usize)>, ScenarioError> {
    let Shape::Map(entries) = &node.shape else {
        return Err(expected(document, node, name, "{\"dotted.path\": ...}"));
    };
    entries
        .iter()
        .map(|(key, value)| match &key.shape {
            Shape::Text(path) => Ok((path.clone(), value, key.span.start)),
            _ => Err(expected(document, key, name, "a dotted path in quotes")),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn read(text: &str) -> Result<Vec<Scatter>, ScenarioError> {
        Scatter::read(&Document::of_text("test.ron", text, Path::new("")).unwrap())
    }

    #[test]
    fn quantities_take_the_unit_of_their_path() {
        let all = read("(repeat: (scatter: {\"vehicle.mass_kg\": Within(\"0.2 t\")}))").unwrap();
        assert_eq!(all[0].spread, Spread::Within(200.0));
        let value = all[0].value(1000.0, 1, 0);
        assert!((800.0..1200.0).contains(&value) && value != 1000.0);
        assert_eq!(value, all[0].value(1000.0, 1, 0));
        assert_ne!(value, all[0].value(1000.0, 1, 1));
        assert_ne!(value, all[0].value(1000.0, 2, 0));
    }

    #[test]
    fn a_spread_of_nothing_or_of_no_kind_is_refused() {
        for spread in ["Normal(0)", "Normal(-1)", "Wide(3)", "3", "Normal(1, 2)", "Normal(\"3 kg\")"] {
            let text = format!("(repeat: (scatter: {{\"a.b\": {spread}}}))");
            assert!(read(&text).unwrap_err().to_string().contains("scatter"), "{spread}");
        }
    }
}
