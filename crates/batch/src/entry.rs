//! Variants, cycles and grounds: named pieces of scenarios.
//!
//! A piece is fields of a scenario with a name, `(name: "plough", cycle: [...], tasks: [...])`, or just the vehicle, the
//! phases or the ground, which then is called by its own name or by its file. `with` changes single values.

use crate::comparison::{ScenarioField, expected};
use headland_scenario::{Document, Node, ScenarioError, Shape};
use std::ops::Range;

/// A variant, a cycle or a ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// What it is called.
    pub name: String,
    /// Fields of the scenario that it brings.
    pub(crate) fields: Vec<ScenarioField>,
    /// What it changes in the scenario.
    pub(crate) with: Vec<Change>,
    /// Where it begins in the comparison.
    pub(crate) at: usize,
}

/// A value of the scenario that is another one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Change {
    /// Dotted path.
    pub path: String,
    /// Where the value stands in the comparison.
    pub value: Range<usize>,
    /// Where the path stands.
    pub at: usize,
    /// Whether it may be a field that the piece does not have yet.
    pub adds: bool,
}

/// A kind of entries.
pub(crate) struct KindOf {
    list: &'static str,
    /// The field of the scenario that a bare piece stands for.
    field: &'static str,
    /// A field that only a bare piece has.
    bare: &'static str,
    /// What one of them is called.
    one: &'static str,
}

pub(crate) const VARIANTS: KindOf =
    KindOf { list: "variants", field: "vehicle", bare: "mass_kg", one: "variant" };
pub(crate) const CYCLES: KindOf = KindOf { list: "cycles", field: "cycle", bare: "phases", one: "cycle" };
pub(crate) const GROUNDS: KindOf =
    KindOf { list: "grounds", field: "ground", bare: "terrain", one: "ground" };

/// The entries of a list; one without a name of its own where there is no list.
pub(crate) fn entries(document: &Document, kind: &KindOf) -> Result<Vec<Entry>, ScenarioError> {
    let Some(list) = document.find(kind.list) else {
        return Ok(vec![Entry { name: kind.one.to_owned(), fields: Vec::new(), with: Vec::new(), at: 0 }]);
    };
    let Shape::List(nodes) = &list.shape else {
        return Err(expected(document, list, kind.list, "a list in brackets"));
    };
    if nodes.is_empty() {
        return Err(expected(document, list, kind.list, "one or more"));
    }
    let mut all: Vec<Entry> = Vec::new();
    for node in nodes {
        let entry = entry(document, kind, node)?;
        if all.iter().any(|other| other.name == entry.name) {
            let place = node.field("name").map_or(node, |field| &field.value);
            return Err(ScenarioError::Value {
                name: "name".to_owned(),
                found: format!("\"{}\" for the second time", entry.name),
                expected: format!("each {} under a name of its own", kind.one),
                at: document.location(place.span.start),
            });
        }
        all.push(entry);
    }
    Ok(all)
}

fn entry(document: &Document, kind: &KindOf, node: &Node) -> Result<Entry, ScenarioError> {
    let at = node.span.start;
    let bare = matches!(node.shape, Shape::List(_)) || node.field(kind.bare).is_some();
    if bare {
        let fields = vec![(kind.field.to_owned(), node.span.clone())];
        return Ok(Entry { name: name(document, kind, node)?, fields, with: Vec::new(), at });
    }
    let Shape::Struct { fields, .. } = &node.shape else {
        return Err(expected(document, node, kind.one, "fields in parentheses"));
    };
    let with = match node.field("with") {
        Some(field) => changes(document, kind, &field.value)?,
        None => Vec::new(),
    };
    let fields = fields
        .iter()
        .filter(|field| !["name", "with"].contains(&field.key.as_str()))
        .map(|field| (field.key.clone(), field.value.span.clone()))
        .collect();
    Ok(Entry { name: name(document, kind, node)?, fields, with, at })
}

/// The name that is given, or that of the file that the piece was included from.
fn name(document: &Document, kind: &KindOf, node: &Node) -> Result<String, ScenarioError> {
    if let Some(field) = node.field("name") {
        let Shape::Text(name) = &field.value.shape else {
            return Err(expected(document, &field.value, "name", "a text in quotes"));
        };
        if name.trim().is_empty() {
            return Err(expected(document, &field.value, "name", "a text that is not empty"));
        }
        return Ok(name.clone());
    }
    // Of a piece with fields of the scenario, the field of its kind may be what was included.
    let inner = node.field(kind.field).map_or(node, |field| &field.value);
    let path = document.location(inner.span.start).path;
    if path != document.path()
        && let Some(stem) = path.file_stem()
    {
        return Ok(stem.to_string_lossy().replace('_', " "));
    }
    Err(ScenarioError::MissingField {
        field: "name".to_owned(),
        of: kind.one.to_owned(),
        at: document.location(node.span.start),
    })
}

/// `with: (field: value)` speaks of the vehicle or the ground, `with: {"path": value}` of the whole scenario.
fn changes(document: &Document, kind: &KindOf, node: &Node) -> Result<Vec<Change>, ScenarioError> {
    match &node.shape {
        Shape::Struct { fields, name: None } => Ok(fields
            .iter()
            .map(|field| Change {
                path: format!("{}.{}", kind.field, field.key),
                value: field.value.span.clone(),
                at: field.key_span.start,
                adds: true,
            })
            .collect()),
        Shape::Map(entries) => entries
            .iter()
            .map(|(key, value)| match &key.shape {
                Shape::Text(path) => Ok(Change {
                    path: path.clone(),
                    value: value.span.clone(),
                    at: key.span.start,
                    adds: false,
                }),
                _ => Err(expected(document, key, "with", "a dotted path in quotes")),
            })
            .collect(),
        _ => Err(expected(document, node, "with", "fields in parentheses, or {\"dotted.path\": value}")),
    }
}
