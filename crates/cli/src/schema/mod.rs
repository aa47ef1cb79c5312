//! What scenario files look like, for editors: a JSON schema, and snippets.
//!
//! Both are made from the types that read scenarios and from the cards of the models, so they accept what the program does.

mod json;
mod snippets;

pub use json::schema;
pub use snippets::snippets;

use headland_plugin::{Bound, Card, Field, Form, Kind, Registry};
use headland_scenario::{Note, definitions};

/// A part of a scenario with what is told of its fields.
pub(crate) struct Part {
    pub name: &'static str,
    pub about: String,
    pub form: Form,
    told: Vec<Told>,
}

/// What is told of a field.
#[derive(Clone, Debug)]
pub(crate) struct Told {
    path: &'static str,
    pub about: &'static str,
    /// Of a number; nothing where the name of the field says it.
    pub unit: &'static str,
    pub bound: Bound,
    pub usual: Option<(f64, f64)>,
    pub default: Option<f64>,
}

impl Part {
    /// What is told of the field at a path; variants on the way may be left out.
    pub fn told(&self, path: &str) -> Option<&Told> {
        let find = |path: &str| self.told.iter().find(|told| told.path == path);
        let without_variants = || {
            let steps = path.split('.').filter(|step| !step.starts_with(|c: char| c.is_ascii_uppercase()));
            steps.collect::<Vec<_>>().join(".")
        };
        find(path).or_else(|| find(&without_variants()))
    }
}

/// The parts of a scenario itself, the scenario first.
pub(crate) fn parts() -> Vec<Part> {
    let told = |note: &Note| Told {
        path: note.path,
        about: note.about,
        unit: "",
        bound: note.bound,
        usual: None,
        default: None,
    };
    definitions()
        .into_iter()
        .map(|definition| Part {
            name: definition.name,
            about: about(definition.name).to_owned(),
            form: definition.form,
            told: definition.notes.iter().map(told).collect(),
        })
        .collect()
}

fn about(name: &str) -> &'static str {
    match name {
        "scenario" => "what is driven, over what, how, and how finely it is computed",
        "cycle" => "phases, or a cycle that brings its tasks",
        "phases" => "a phase, or a list that may hold lists",
        "phase" => "what the driver does until it ends",
        "until" => "an end, or a list of which the first counts",
        "end" => "what ends a phase",
        _ => "who drives",
    }
}

/// The models of a kind.
pub(crate) fn models(registry: &Registry, kind: Kind) -> Vec<(&Card, Part)> {
    let told = |parameter: &headland_plugin::Parameter| Told {
        path: parameter.name,
        about: parameter.about,
        unit: if parameter.unit == "1" { "" } else { parameter.unit },
        bound: parameter.bound,
        usual: parameter.plausible,
        default: parameter.default,
    };
    registry
        .forms(kind)
        .into_iter()
        .map(|(card, form)| {
            let told = card.parameters.iter().map(told).collect();
            (card, Part { name: card.name, about: card.about.to_owned(), form, told })
        })
        .collect()
}

/// Whether nothing has to stand in the parentheses.
pub(crate) fn may_be_bare(form: &Form) -> bool {
    matches!(form, Form::Fields(fields) if fields.iter().all(|field| !field.required))
}

/// A dotted path one step on.
pub(crate) fn below(path: &str, step: &str) -> String {
    if path.is_empty() { step.to_owned() } else { format!("{path}.{step}") }
}

/// The fields of a form that have to be given.
pub(crate) fn required(fields: &[Field]) -> impl Iterator<Item = &Field> {
    fields.iter().filter(|field| field.required)
}
