//! The models of one kind, by name.

use crate::{Card, Form, Plugin, Refusal};
use std::path::Path;

/// How a model is read from the text of its parameters.
pub type Build<T> = fn(&str, &Path) -> Result<Box<T>, BuildError>;

/// A model that scenarios can name.
pub struct Entry<T: ?Sized> {
    /// How it describes itself.
    pub card: Card,
    build: Build<T>,
    form: fn() -> Form,
}

impl<T: ?Sized> Entry<T> {
    /// What its parameters look like.
    pub fn form(&self) -> Form {
        (self.form)()
    }
}

/// Models of one kind.
pub struct Family<T: ?Sized> {
    kind: &'static str,
    entries: Vec<Entry<T>>,
}

/// A model that cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// No model has this name.
    #[error("no {kind} is named `{name}`")]
    Unknown {
        /// Kind of model.
        kind: &'static str,
        /// Name found.
        name: String,
        /// Names that are known.
        known: Vec<&'static str>,
        /// The nearest of them.
        suggestion: Option<&'static str>,
    },
    /// Its parameters do not fit; positions count from their first character.
    #[error("parameters of `{name}` do not fit: {error}")]
    Parameters {
        /// The model.
        name: &'static str,
        /// Where and why.
        error: Box<ron::error::SpannedError>,
    },
    /// A parameter has a value that the model refuses.
    #[error("parameters of `{name}` do not fit: {refusal}")]
    Refused {
        /// The model.
        name: &'static str,
        /// Which parameter and why.
        refusal: Refusal,
    },
}

impl<T: ?Sized> Family<T> {
    /// An empty family; `kind` ends sentences such as 'no soil model is named'.
    pub const fn new(kind: &'static str) -> Self {
        Self { kind, entries: Vec::new() }
    }

    /// What the models of this family are.
    pub fn kind(&self) -> &'static str {
        self.kind
    }

    /// The models, in the order in which they were registered.
    pub fn entries(&self) -> &[Entry<T>] {
        &self.entries
    }

    /// Adds a model that `build` reads and whose parameters look like `form`.
    ///
    /// # Panics
    /// Where the name is taken: that is a bug of the program, not of its user.
    pub fn insert(&mut self, card: Card, build: Build<T>, form: fn() -> Form) {
        assert!(self.card(card.name).is_none(), "a {} named `{}` is registered twice", self.kind, card.name);
        self.entries.push(Entry { card, build, form });
    }

    /// How the model of this name describes itself.
    pub fn card(&self, name: &str) -> Option<&Card> {
        self.entries.iter().map(|entry| &entry.card).find(|card| card.name == name)
    }

    /// Builds the model `name` from the RON of its parameters (`(coefficient: 0.07)`).
    ///
    /// # Errors
    /// [`BuildError`].
    pub fn build(&self, name: &str, parameters: &str, folder: &Path) -> Result<Box<T>, BuildError> {
        let Some(entry) = self.entries.iter().find(|entry| entry.card.name == name) else {
            let known: Vec<_> = self.entries.iter().map(|entry| entry.card.name).collect();
            let suggestion = closest(name, &known);
            return Err(BuildError::Unknown { kind: self.kind, name: name.to_owned(), known, suggestion });
        };
        (entry.build)(parameters, folder)
    }
}

/// Reads `P` from its parameters.
pub(crate) fn read<P: Plugin>(parameters: &str, folder: &Path) -> Result<P, BuildError> {
    let name = P::CARD.name;
    let mut model: P = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(parameters)
        .map_err(|error| BuildError::Parameters { name, error: Box::new(error) })?;
    model.settle(folder).map_err(|refusal| BuildError::Refused { name, refusal })?;
    Ok(model)
}

/// The known name that `name` was most likely meant to be.
pub fn closest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    /// Below this likeness a suggestion would puzzle more than help.
    const LEAST_LIKENESS: f64 = 0.7;
    known
        .iter()
        .map(|candidate| (strsim::jaro_winkler(&name.to_lowercase(), &candidate.to_lowercase()), *candidate))
        .filter(|(likeness, _)| *likeness >= LEAST_LIKENESS)
        .max_by(|one, other| one.0.total_cmp(&other.0))
        .map(|(_, candidate)| candidate)
}
