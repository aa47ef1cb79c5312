//! What can be wrong with a scenario, and how it is told.

pub use crate::location::Location;
use headland_body::BodyError;
use headland_units::QuantityError;
use std::path::PathBuf;

/// A scenario that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScenarioError {
    /// A file cannot be read.
    #[error("cannot read {}: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
        /// Where it is included from.
        at: Option<Location>,
    },
    /// The text is no RON.
    #[error("found {found}, expected {expected}")]
    Syntax {
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
        /// Where.
        at: Location,
    },
    /// A quantity does not fit its field.
    #[error("{error}")]
    Quantity {
        /// Why.
        error: QuantityError,
        /// Where.
        at: Location,
    },
    /// A field that does not exist.
    #[error("{of} has no field `{found}`")]
    UnknownField {
        /// What was found.
        found: String,
        /// What it was found in.
        of: String,
        /// The fields that exist.
        known: Vec<String>,
        /// Where.
        at: Location,
    },
    /// A field that has to be given.
    #[error("{of} lacks the field `{field}`")]
    MissingField {
        /// The field.
        field: String,
        /// What it is missing from.
        of: String,
        /// Where.
        at: Location,
    },
    /// A name that stands for nothing.
    #[error("no {kind} is named `{found}`")]
    UnknownName {
        /// Kind of thing.
        kind: String,
        /// What was found.
        found: String,
        /// The names that are known.
        known: Vec<String>,
        /// The command that tells more.
        more: Option<&'static str>,
        /// Where.
        at: Location,
    },
    /// A value that makes no sense.
    #[error("`{name}` is {found}, expected {expected}")]
    Value {
        /// The field.
        name: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
        /// Where.
        at: Location,
    },
    /// A vehicle that cannot be driven as a rigid body.
    #[error("{error}")]
    Body {
        /// Why.
        error: BodyError,
        /// Where.
        at: Location,
    },
    /// A dotted path that leads nowhere.
    #[error("the scenario has nothing at `{path}`")]
    NoSuchPath {
        /// The path.
        path: String,
    },
}

impl ScenarioError {
    /// Where it is.
    pub fn location(&self) -> Option<&Location> {
        match self {
            Self::File { at, .. } => at.as_ref(),
            Self::NoSuchPath { .. } => None,
            Self::Syntax { at, .. }
            | Self::Quantity { at, .. }
            | Self::UnknownField { at, .. }
            | Self::MissingField { at, .. }
            | Self::UnknownName { at, .. }
            | Self::Body { at, .. }
            | Self::Value { at, .. } => Some(at),
        }
    }

    /// The message for a person: what, where with the line, and what was perhaps meant.
    pub fn told(&self) -> String {
        let mut told = self.to_string();
        let (found, known, more) = match self {
            Self::UnknownField { found, known, .. } => (found.as_str(), known.as_slice(), None),
            Self::UnknownName { found, known, more, .. } => (found.as_str(), known.as_slice(), *more),
            _ => ("", [].as_slice(), None),
        };
        let names: Vec<&str> = known.iter().map(String::as_str).collect();
        let note = headland_plugin::closest(found, &names)
            .map_or(String::new(), |closest| format!("did you mean `{closest}`?"));
        if let Some(at) = self.location() {
            told.push('\n');
            told.push_str(&at.shown(&note));
        }
        if !known.is_empty() {
            told.push_str("\n  known: ");
            told.push_str(&names.join(", "));
        }
        if let Some(more) = more {
            told.push_str("   (");
            told.push_str(more);
            told.push(')');
        }
        told
    }
}
