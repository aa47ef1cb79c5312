//! What scenario files look like, for editors: a JSON schema, and snippets.
//!
//! Both are made from the types that read scenarios and from the cards of the models, so they accept what the program does.

mod json;
mod snippets;

pub use json::{schema, schema_of};
pub use snippets::snippets;

use crate::arguments::SchemaKind;
use headland_plugin::{Bound, Card, Field, Form, Kind, Registry, form_of};
use headland_recording::{ABOUT, ABOUT_PARTS, DescriptionForm};
use headland_scenario::{Definition, Note, definitions};

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
        // What stands in several places is told once, without the list that it stands in.
        let without_the_list = || path.split_once('.').and_then(|(_, rest)| find(rest));
        find(path)
            .or_else(|| find(&without_variants()))
            .or_else(|| if self.name == "recording" { without_the_list() } else { None })
    }
}

/// The parts of a scenario itself, the scenario first.
pub(crate) fn parts() -> Vec<Part> {
    parts_of(definitions())
}

/// The parts of a file, the file itself first.
pub(crate) fn parts_of_file(kind: SchemaKind) -> Vec<Part> {
    match kind {
        SchemaKind::Scenario => parts(),
        SchemaKind::Comparison => {
            let mut parts = parts_of(headland_batch::definitions());
            parts.extend(self::parts().into_iter().filter(|part| part.name != "scenario"));
            parts
        }
        SchemaKind::Recording => vec![recording()],
    }
}

/// A description of a recording.
fn recording() -> Part {
    let told = |path: &'static str, about: &'static str| Told {
        path,
        about,
        unit: "",
        bound: Bound::Finite,
        usual: None,
        default: None,
    };
    let told = ABOUT.iter().chain(ABOUT_PARTS).map(|(path, about)| told(path, about)).collect();
    let name = "recording";
    Part { name, about: about(name).to_owned(), form: form_of::<DescriptionForm>(), told }
}

fn parts_of(definitions: Vec<Definition>) -> Vec<Part> {
    let told = |note: &Note| Told {
        path: note.path,
        about: note.about,
        unit: "",
        bound: note.bound,
        usual: None,
        default: None,
    };
    definitions
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
        "comparison" => "variants through cycles on grounds, as often as asked",
        "variant" => "fields of a scenario with a name, or just a vehicle",
        "compared_cycle" => "fields of a scenario with a name, or just phases",
        "compared_ground" => "fields of a scenario with a name, or just a ground",
        "recording" => "which files there are, and which column is which quantity",
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
