//! Pieces of a scenario that are read one by one, so that they may nest and stand for more than one thing.

use crate::document::Document;
use crate::error::ScenarioError;
use crate::fault;
use crate::plugins::bounded;
use crate::tree::{Node, Shape};
use headland_plugin::Bound;
use serde::de::DeserializeOwned;

/// A piece of the document.
#[derive(Clone, Copy)]
pub struct Piece<'d> {
    pub document: &'d Document,
    pub node: &'d Node,
}

impl<'d> Piece<'d> {
    /// Another piece of the same document.
    pub fn at(self, node: &'d Node) -> Self {
        Self { node, ..self }
    }

    /// The value of a field.
    pub fn field(self, key: &str) -> Option<Self> {
        self.node.field(key).map(|field| self.at(&field.value))
    }

    /// Its elements, where it is a list.
    pub fn elements(self) -> Option<&'d [Node]> {
        match &self.node.shape {
            Shape::List(values) => Some(values),
            _ => None,
        }
    }

    /// Its name, as in `Name(...)`.
    pub fn name(self) -> Option<&'d str> {
        self.node.name(self.document.text())
    }

    /// What it says.
    ///
    /// # Errors
    /// Where it does not fit; `of` is what it is called there.
    pub fn read<T: DeserializeOwned>(self, of: &str) -> Result<T, ScenarioError> {
        self.read_without(&[], of)
    }

    /// What it says apart from some fields. They are blanked out, so that places stay what they are.
    ///
    /// # Errors
    /// As [`Piece::read`].
    pub fn read_without<T: DeserializeOwned>(self, fields: &[&str], of: &str) -> Result<T, ScenarioError> {
        let span = self.node.span.clone();
        let mut text = self.document.text()[span.clone()].to_owned();
        if let Shape::Struct { fields: own, .. } = &self.node.shape {
            for field in own.iter().filter(|field| fields.contains(&field.key.as_str())) {
                let from = field.key_span.start - span.start;
                let mut to = field.value.span.end - span.start;
                let rest = &text[to..];
                if rest.trim_start().starts_with(',') {
                    to += rest.len() - rest.trim_start().len() + 1;
                }
                // Line ends stay, so that places in lines and columns do; what is not ASCII takes one column as well.
                let blank: String = text[from..to].chars().map(|c| if c == '\n' { c } else { ' ' }).collect();
                text.replace_range(from..to, &pad(&blank, to - from));
            }
        }
        ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_str(&text)
            .map_err(|error| match fault::tell(self.document, self.node, of, &error) {
                ScenarioError::UnknownField { found, of, mut known, at } => {
                    known.extend(fields.iter().map(|&name| name.to_owned()));
                    ScenarioError::UnknownField { found, of, known, at }
                }
                // What lacks it is this piece and not one within, however near to one that shows.
                ScenarioError::MissingField { field, of, .. }
                    if self.name().is_some_and(|name| of == format!("`{name}`")) =>
                {
                    let at = self.document.location(self.node.span.start);
                    ScenarioError::MissingField { field, of, at }
                }
                other => other,
            })
    }

    /// Refuses what it says.
    pub fn refuse(self, name: &str, found: &str, expected: &str) -> ScenarioError {
        ScenarioError::Value {
            name: name.to_owned(),
            found: found.to_owned(),
            expected: expected.to_owned(),
            at: self.document.location(self.node.span.start),
        }
    }

    /// Refuses a number of one of its fields where it is out of bounds.
    ///
    /// # Errors
    /// [`ScenarioError::Value`].
    pub fn bounded(self, field: &str, value: f64, bound: Bound) -> Result<(), ScenarioError> {
        let at = self.field(field).unwrap_or(self).node.span.start;
        bounded(self.document, field, value, bound, at)
    }

    /// Refuses a name that stands for nothing.
    pub fn unknown(self, kind: &str, found: &str, known: &[String]) -> ScenarioError {
        ScenarioError::UnknownName {
            kind: kind.to_owned(),
            found: found.to_owned(),
            known: known.to_vec(),
            more: None,
            at: self.document.location(self.node.span.start),
        }
    }

    /// The texts of a list, each with its piece.
    ///
    /// # Errors
    /// Where it is no list of texts.
    pub fn texts(self, of: &str) -> Result<Vec<(String, Self)>, ScenarioError> {
        let Some(values) = self.elements() else {
            return Err(self.syntax(of));
        };
        let text = |node: &'d Node| match &node.shape {
            Shape::Text(text) => Ok((text.clone(), self.at(node))),
            _ => Err(self.at(node).syntax(of)),
        };
        values.iter().map(text).collect()
    }

    fn syntax(self, of: &str) -> ScenarioError {
        let found = &self.document.text()[self.node.span.clone()];
        ScenarioError::Syntax {
            found: format!("`{}` in `{of}`", found.lines().next().unwrap_or("")),
            expected: "a list of names in quotes".to_owned(),
            at: self.document.location(self.node.span.start),
        }
    }
}

/// Spaces until a text is as many bytes long as it was; columns behind it on the same line shift by what was not ASCII.
fn pad(blank: &str, bytes: usize) -> String {
    let mut padded = blank.to_owned();
    padded.extend(std::iter::repeat_n(' ', bytes.saturating_sub(blank.len())));
    padded
}
