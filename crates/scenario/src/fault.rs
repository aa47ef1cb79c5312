//! Errors of `ron`, told in the words and places of the scenario.

use crate::document::Document;
use crate::error::ScenarioError;
use crate::tree::{Field, Node, Shape};
use ron::error::{Error, SpannedError};

/// Tells an error that `ron` met in the piece `part` of the document; `of` names the piece.
pub fn tell(document: &Document, part: &Node, of: &str, error: &SpannedError) -> ScenarioError {
    let text = &document.text()[part.span.clone()];
    let begin = part.span.start + offset_of(text, error.span.start.line, error.span.start.col);
    let end = part.span.start + offset_of(text, error.span.end.line, error.span.end.col);
    tell_at(document, part, of, &error.code, begin, end.max(begin))
}

/// As [`tell`], with the stretch of the error as bytes of the resolved text.
pub fn tell_at(
    document: &Document,
    part: &Node,
    of: &str,
    code: &Error,
    begin: usize,
    end: usize,
) -> ScenarioError {
    let owner = |outer: &Option<String>| format!("`{}`", outer.as_deref().unwrap_or(of));
    let strings = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    match code {
        Error::NoSuchStructField { expected, found, outer } => {
            let at = last_field(part, found, end).map_or(begin, |field| field.key_span.start);
            ScenarioError::UnknownField {
                found: found.clone(),
                of: owner(outer),
                known: strings(expected),
                at: document.location(at),
            }
        }
        Error::NoSuchEnumVariant { expected, found, outer } => ScenarioError::UnknownName {
            kind: outer.as_deref().map_or("choice", plain).to_owned(),
            found: found.clone(),
            known: strings(expected),
            more: None,
            at: document.location(document.text()[..end].rfind(found.as_str()).unwrap_or(begin)),
        },
        Error::MissingStructField { field, outer } => ScenarioError::MissingField {
            field: (*field).to_owned(),
            of: owner(outer),
            at: document.location(lacking(part, field, begin, end).span.start),
        },
        Error::DuplicateStructField { field, .. } => {
            let at = last_field(part, field, end).map_or(begin, |field| field.key_span.start);
            ScenarioError::Syntax {
                found: format!("the field `{field}` twice"),
                expected: "it once".to_owned(),
                at: document.location(at),
            }
        }
        other => {
            // The error shows within or right behind the value that does not fit.
            let field = around(part, begin).or_else(|| around(part, end.saturating_sub(1)));
            let (found, at, name) = match field {
                // A value without its name: what holds it may be long, and is right as far as it goes.
                _ if nameless(other) => {
                    let own = &innermost(part, begin).span;
                    let field = field.map_or_else(String::new, |field| format!(" in `{}`", field.key));
                    (format!("`{}`", short(&document.text()[own.clone()])), own.start, field)
                }
                Some(field) => (
                    format!("`{}`", short(&document.text()[field.value.span.clone()])),
                    field.value.span.start,
                    format!(" in `{}`", field.key),
                ),
                None => (format!("`{}`", short(&document.text()[begin..])), begin, String::new()),
            };
            ScenarioError::Syntax {
                found: found + &name,
                expected: expected(other),
                at: document.location(at),
            }
        }
    }
}

/// What `ron` wanted, without its capital letters.
fn expected(code: &Error) -> String {
    match code {
        Error::InvalidValueForType { expected, .. } | Error::ExpectedDifferentLength { expected, .. } => {
            expected.clone()
        }
        Error::ExpectedFloat => "a number".to_owned(),
        Error::ExpectedBoolean => "true or false".to_owned(),
        Error::ExpectedInteger | Error::InvalidIntegerDigit { .. } | Error::IntegerOutOfBounds => {
            "a whole number, neither less than 0 nor beyond all bounds".to_owned()
        }
        Error::ExpectedMap => "names and values in braces, as in `{\"name\": value}`".to_owned(),
        code if nameless(code) => "a field with its name, as in `(name: value)`".to_owned(),
        Error::ExpectedString => "a text in quotes".to_owned(),
        Error::ExpectedArray => "a list in square brackets".to_owned(),
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => {
            "fields in parentheses, as in `(name: value)`".to_owned()
        }
        Error::ExpectedDifferentStructName { expected, .. } => format!("`{expected}`"),
        other => {
            let text = other.to_string();
            let text = text.strip_prefix("Expected ").unwrap_or(&text);
            format!("another value: {text}")
        }
    }
}

/// Whether a value stands where the name of a field has to.
fn nameless(code: &Error) -> bool {
    matches!(code, Error::InvalidIdentifier(_) | Error::SuggestRawIdentifier(_) | Error::ExpectedIdentifier)
}

fn plain(name: &str) -> &str {
    name.strip_suffix("File").unwrap_or(name)
}

fn short(text: &str) -> String {
    const LONGEST: usize = 40;
    let line = text.lines().next().unwrap_or("");
    if line.chars().count() > LONGEST {
        line.chars().take(LONGEST).collect::<String>() + "…"
    } else {
        line.to_owned()
    }
}

/// Byte at which a line and a column, both from 1, lie.
fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let within = text[start..].char_indices().nth(column.saturating_sub(1));
    within.map_or(text.len(), |(at, _)| start + at)
}

fn children(node: &Node) -> Vec<&Node> {
    match &node.shape {
        Shape::Struct { fields, .. } => fields.iter().map(|field| &field.value).collect(),
        Shape::Tuple { values, .. } | Shape::List(values) => values.iter().collect(),
        Shape::Map(entries) => entries.iter().map(|(_, value)| value).collect(),
        Shape::Text(_) | Shape::Word => Vec::new(),
    }
}

/// The last field of a name that begins before a byte.
fn last_field<'a>(node: &'a Node, key: &str, before: usize) -> Option<&'a Field> {
    let own: &[Field] = if let Shape::Struct { fields, .. } = &node.shape { fields } else { &[] };
    let mut best = own.iter().rfind(|field| field.key == key && field.key_span.start <= before);
    for child in children(node) {
        if let Some(deeper) = last_field(child, key, before)
            && best.is_none_or(|best| deeper.key_span.start > best.key_span.start)
        {
            best = Some(deeper);
        }
    }
    best
}

/// The innermost struct about a stretch that has no field of this name.
fn lacking<'a>(node: &'a Node, field: &str, begin: usize, end: usize) -> &'a Node {
    for child in children(node) {
        let covers = child.span.start <= begin && begin <= child.span.end
            || child.span.start <= end && end <= child.span.end;
        if covers {
            let inner = lacking(child, field, begin, end);
            if matches!(inner.shape, Shape::Struct { .. } | Shape::Tuple { .. })
                && inner.field(field).is_none()
            {
                return inner;
            }
        }
    }
    node
}

/// The innermost piece that covers a byte.
fn innermost(node: &Node, at: usize) -> &Node {
    let covering = children(node).into_iter().find(|child| child.span.start <= at && at < child.span.end);
    covering.map_or(node, |child| innermost(child, at))
}

/// The innermost field whose value covers a byte.
fn around(node: &Node, at: usize) -> Option<&Field> {
    let own: &[Field] = if let Shape::Struct { fields, .. } = &node.shape { fields } else { &[] };
    let mine = own.iter().find(|field| field.key_span.start <= at && at <= field.value.span.end);
    children(node).into_iter().find_map(|child| around(child, at)).or(mine)
}
