//! Plugins of a scenario: named in the text, built by the registry, their numbers checked against their cards.

use crate::document::Document;
use crate::error::ScenarioError;
use crate::fault;
use crate::tree::{Node, Shape};
use headland_plugin::{Bound, BuildError, Card, Family};
use headland_sim::Named;
use std::path::Path;

/// A value outside the range where it usually lies: accepted, and told.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// What is unusual.
    pub text: String,
    /// Where.
    pub at: crate::error::Location,
}

/// Builds the plugin that stands at `node`.
pub fn build<T: ?Sized>(
    document: &Document,
    node: &Node,
    family: &Family<T>,
    more: &'static str,
    folder: &Path,
    remarks: &mut Vec<Remark>,
) -> Result<(String, Box<T>), ScenarioError> {
    let text = document.text();
    let Some(name) = node.name(text) else {
        return Err(ScenarioError::Syntax {
            found: format!("`{}`", text[node.span.clone()].lines().next().unwrap_or("")),
            expected: "the name of a model, as in `Name(parameter: value)`".to_owned(),
            at: document.location(node.span.start),
        });
    };
    let parameters = text[node.span.clone()][name.len()..].trim_start();
    let skipped = node.span.len() - parameters.len();
    let part = Node { span: node.span.start + skipped..node.span.end, shape: node.shape.clone() };
    if let Some(card) = family.card(name) {
        check(document, node, card, remarks)?;
    }
    let parameters = if parameters.is_empty() { "()" } else { parameters };
    match family.build(name, parameters, folder) {
        Ok(plugin) => Ok((name.to_owned(), plugin)),
        Err(BuildError::Unknown { kind, name, known, .. }) => Err(ScenarioError::UnknownName {
            kind: kind.to_owned(),
            found: name,
            known: known.into_iter().map(str::to_owned).collect(),
            more: Some(more),
            at: document.location(node.span.start),
        }),
        Err(BuildError::Parameters { name, error }) => {
            let error = fault::tell(document, &part, name, &error);
            let own = document.location(part.span.start);
            Err(match error {
                // The name says more than its parentheses, which a bare one does not even have. A part of the model is pointed at
                // where it stands itself.
                ScenarioError::MissingField { field, of, at } if at == own || skipped == node.span.len() => {
                    ScenarioError::MissingField { field, of, at: document.location(node.span.start) }
                }
                other => other,
            })
        }
        Err(BuildError::Refused { refusal, .. }) => {
            let at = nearest(node, &refusal.parameter).span.start;
            Err(ScenarioError::Value {
                name: refusal.parameter,
                found: refusal.found,
                expected: refusal.expected,
                at: document.location(at),
            })
        }
    }
}

/// The piece at a dotted path, or as near to it as the text goes: what is refused may stand in a file, or nowhere.
fn nearest<'a>(node: &'a Node, path: &str) -> &'a Node {
    let mut nearest = node;
    for part in path.split(['.', '[']) {
        let next = match &nearest.shape {
            Shape::List(values) => {
                part.trim_end_matches(']').parse().ok().and_then(|at: usize| values.get(at))
            }
            _ => nearest.field(part).map(|field| &field.value),
        };
        match next {
            Some(next) => nearest = next,
            None => break,
        }
    }
    nearest
}

/// Builds the plugins of a list, where a second one of the same name is called `name_2`, or of a map of names of one's own.
pub fn build_all<T: ?Sized>(
    document: &Document,
    path: &str,
    family: &Family<T>,
    more: &'static str,
    folder: &Path,
    remarks: &mut Vec<Remark>,
) -> Result<Vec<Named<T>>, ScenarioError> {
    let values = match document.find(path) {
        Some(Node { shape: Shape::List(values), .. }) => values,
        Some(Node { shape: Shape::Map(entries), .. }) => {
            return build_named(document, entries, family, more, folder, remarks);
        }
        Some(node) => {
            return Err(ScenarioError::Syntax {
                found: format!("`{}`", document.text()[node.span.clone()].lines().next().unwrap_or("")),
                expected: "a list `[Model(...)]`, or names of your own `{\"name\": Model(...)}`".to_owned(),
                at: document.location(node.span.start),
            });
        }
        None => return Ok(Vec::new()),
    };
    let mut all: Vec<Named<T>> = Vec::new();
    let mut kinds: Vec<String> = Vec::new();
    for node in values {
        let (name, plugin) = build(document, node, family, more, folder, remarks)?;
        let namesakes = kinds.iter().filter(|kind| **kind == name).count();
        let unique = if namesakes == 0 { name.clone() } else { format!("{name}_{}", namesakes + 1) };
        all.push(Named { name: unique, plugin });
        kinds.push(name);
    }
    Ok(all)
}

fn build_named<T: ?Sized>(
    document: &Document,
    entries: &[(Node, Node)],
    family: &Family<T>,
    more: &'static str,
    folder: &Path,
    remarks: &mut Vec<Remark>,
) -> Result<Vec<Named<T>>, ScenarioError> {
    let mut all: Vec<Named<T>> = Vec::new();
    for (key, node) in entries {
        let refuse = |found: &str, expected: &str| ScenarioError::Value {
            name: "name".to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
            at: document.location(key.span.start),
        };
        let Shape::Text(name) = &key.shape else {
            return Err(refuse(&document.text()[key.span.clone()], "a name in quotes"));
        };
        let usable = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !usable {
            let expected = "letters, digits and `_`, beginning with a letter: it becomes part of channels";
            return Err(refuse(&format!("\"{name}\""), expected));
        }
        if all.iter().any(|other| other.name == *name) {
            return Err(refuse(&format!("\"{name}\" for the second time"), "each name once"));
        }
        let (_, plugin) = build(document, node, family, more, folder, remarks)?;
        all.push(Named { name: name.clone(), plugin });
    }
    Ok(all)
}

fn check(
    document: &Document,
    node: &Node,
    card: &Card,
    remarks: &mut Vec<Remark>,
) -> Result<(), ScenarioError> {
    for parameter in card.parameters {
        let Some(field) = node.find(document.text(), parameter.name) else { continue };
        for (value, at) in numbers(document, field) {
            bounded(document, parameter.name, value, parameter.bound, at)?;
            if let Some((low, high)) = parameter.plausible
                && !(low..=high).contains(&value)
            {
                remarks.push(Remark {
                    text: format!(
                        "`{}` of `{}` is {value} {}; it usually lies between {low} and {high}",
                        parameter.name, card.name, parameter.unit
                    ),
                    at: document.location(at),
                });
            }
        }
    }
    Ok(())
}

/// Refuses a number outside its bound.
pub fn bounded(
    document: &Document,
    name: &str,
    value: f64,
    bound: Bound,
    at: usize,
) -> Result<(), ScenarioError> {
    if bound.holds(value) {
        return Ok(());
    }
    let found = value.to_string();
    Err(ScenarioError::Value {
        name: name.to_owned(),
        found,
        expected: bound.in_words(),
        at: document.location(at),
    })
}

/// The numbers of a value or of a list, with the byte of each.
fn numbers(document: &Document, node: &Node) -> Vec<(f64, usize)> {
    match &node.shape {
        Shape::List(values) => values.iter().flat_map(|value| numbers(document, value)).collect(),
        Shape::Word => {
            let word = document.text()[node.span.clone()].replace('_', "");
            word.parse().ok().map(|value| (value, node.span.start)).into_iter().collect()
        }
        _ => Vec::new(),
    }
}
