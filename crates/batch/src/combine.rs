//! Scenarios put together from a comparison: what is common, a variant, a cycle and a ground.

use crate::comparison::Comparison;
use crate::entry::{Change, Entry};
use headland_scenario::{Document, Node, Piece, ScenarioError, Shape};
use std::ops::Range;

/// Fields that add up where several pieces bring them; every other one is given once.
const LISTS: [&str; 2] = ["tasks", "effects"];

/// A field of the scenario, who brings it, and where its values stand.
struct Field<'a> {
    key: &'a str,
    by: String,
    spans: Vec<Range<usize>>,
}

impl Comparison {
    /// The scenario of a variant, a cycle and a ground.
    ///
    /// # Errors
    /// [`ScenarioError`] where two pieces give one field, or `with` changes what is not there.
    pub fn scenario(
        &self,
        variant: &Entry,
        cycle: &Entry,
        ground: &Entry,
    ) -> Result<Document, ScenarioError> {
        let document = &self.document;
        let mut fields: Vec<Field<'_>> = Vec::new();
        let pieces = [
            (&self.common, "the comparison".to_owned()),
            (&variant.fields, format!("variant `{}`", variant.name)),
            (&cycle.fields, format!("cycle `{}`", cycle.name)),
            (&ground.fields, format!("ground `{}`", ground.name)),
        ];
        for (brought, by) in pieces {
            for (key, span) in brought {
                match fields.iter_mut().find(|field| field.key == key) {
                    None => fields.push(Field { key, by: by.clone(), spans: vec![span.clone()] }),
                    Some(field) if LISTS.contains(&field.key) => field.spans.push(span.clone()),
                    Some(field) => {
                        return Err(ScenarioError::Value {
                            name: key.clone(),
                            found: format!("given by {by} and by {}", field.by),
                            expected: "it once; `with` changes what another piece gives".to_owned(),
                            at: document.location(span.start),
                        });
                    }
                }
            }
        }
        let mut pieces = vec![Piece::Own(format!("(\n    about: {:?},\n", self.about))];
        for field in &fields {
            pieces.push(Piece::Own(format!("    {}: ", field.key)));
            match field.spans.as_slice() {
                [span] => pieces.push(Piece::Of(document, span.clone())),
                spans => {
                    pieces.push(Piece::Own("[".to_owned()));
                    for span in spans {
                        for element in elements(document, span) {
                            pieces.push(Piece::Of(document, element));
                            pieces.push(Piece::Own(", ".to_owned()));
                        }
                    }
                    pieces.push(Piece::Own("]".to_owned()));
                }
            }
            pieces.push(Piece::Own(",\n".to_owned()));
        }
        pieces.push(Piece::Own(")\n".to_owned()));
        let mut scenario = document.assembled(&pieces)?;
        for change in variant.with.iter().chain(&cycle.with).chain(&ground.with) {
            scenario = changed(document, &scenario, change)?
                .ok_or_else(|| nowhere(document, &change.path, change.at, (variant, cycle, ground)))?;
        }
        Ok(scenario)
    }
}

/// The scenario with one other value; `None` where it has no such place.
fn changed(
    document: &Document,
    scenario: &Document,
    change: &Change,
) -> Result<Option<Document>, ScenarioError> {
    let value = Piece::Of(document, change.value.clone());
    if let Some(node) = scenario.find(&change.path) {
        return scenario.edited(vec![(node.span.clone(), value)]).map(Some);
    }
    let Some((owner, field)) = change.path.rsplit_once('.').filter(|_| change.adds) else { return Ok(None) };
    let Some(Node { shape: Shape::Struct { fields, .. }, .. }) = scenario.find(owner) else {
        return Ok(None);
    };
    let Some(last) = fields.last() else { return Ok(None) };
    let behind = last.value.span.end..last.value.span.end;
    let text = scenario.text();
    let pieces = [
        Piece::Of(scenario, 0..behind.start),
        Piece::Own(", ".to_owned()),
        Piece::Of(document, change.at..change.at + field.len()),
        Piece::Own(": ".to_owned()),
        value,
        Piece::Of(scenario, behind.end..text.len()),
    ];
    scenario.assembled(&pieces).map(Some)
}

/// A path that leads nowhere in a combination.
pub(crate) fn nowhere(
    document: &Document,
    path: &str,
    at: usize,
    (variant, cycle, ground): (&Entry, &Entry, &Entry),
) -> ScenarioError {
    ScenarioError::Value {
        name: path.to_owned(),
        found: format!("not there in {}", called(variant, cycle, ground)),
        expected: "the dotted path of a value that stands there".to_owned(),
        at: document.location(at),
    }
}

/// What a combination is called.
pub(crate) fn called(variant: &Entry, cycle: &Entry, ground: &Entry) -> String {
    format!("variant `{}`, cycle `{}`, ground `{}`", variant.name, cycle.name, ground.name)
}

/// Where the elements of a list stand; what is no list is left to the scenario to refuse.
fn elements(document: &Document, span: &Range<usize>) -> Vec<Range<usize>> {
    match at(document.tree(), span).map(|node| &node.shape) {
        Some(Shape::List(values)) => values.iter().map(|value| value.span.clone()).collect(),
        _ => vec![span.clone()],
    }
}

/// The node that covers exactly this stretch.
fn at<'a>(node: &'a Node, span: &Range<usize>) -> Option<&'a Node> {
    if node.span == *span {
        return Some(node);
    }
    children(node)
        .into_iter()
        .find(|child| child.span.start <= span.start && span.end <= child.span.end)
        .and_then(|child| at(child, span))
}

/// What a piece is made of.
pub(crate) fn children(node: &Node) -> Vec<&Node> {
    match &node.shape {
        Shape::Struct { fields, .. } => fields.iter().map(|field| &field.value).collect(),
        Shape::Tuple { values, .. } | Shape::List(values) => values.iter().collect(),
        Shape::Map(entries) => entries.iter().flat_map(|(key, value)| [key, value]).collect(),
        Shape::Text(_) | Shape::Word => Vec::new(),
    }
}

/// Where the numbers of all fields named `seed` stand.
pub(crate) fn seeds(document: &Document) -> Vec<(Range<usize>, f64)> {
    fn collect(node: &Node, text: &str, found: &mut Vec<(Range<usize>, f64)>) {
        if let Shape::Struct { fields, .. } = &node.shape {
            for field in fields.iter().filter(|field| field.key == "seed") {
                let number = text[field.value.span.clone()].replace('_', "").parse::<f64>();
                if let Some(seed) = number.ok().filter(|seed| seed.fract() == 0.0 && *seed >= 0.0) {
                    found.push((field.value.span.clone(), seed));
                }
            }
        }
        for child in children(node) {
            collect(child, text, found);
        }
    }
    let mut found = Vec::new();
    collect(document.tree(), document.text(), &mut found);
    found
}
