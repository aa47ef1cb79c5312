//! The JSON schema. RON stands in it as JSON so: `(field: value)` is an object, `Name(field: value)` an object of one property
//! `Name`, `Name` alone a string, a list an array.

use super::{Part, Told, below, may_be_bare, models, parts_of_file, required};
use crate::arguments::SchemaKind;
use headland_plugin::{Bound, Form, Kind, Registry};
use serde_json::{Map, Value, json};

/// A number may be written as a text with a unit: it begins like a number.
const QUANTITY: &str = "^\\s*[-+.0-9]";

/// What scenario files look like to this registry, as a JSON schema (draft 2020-12).
pub fn schema(registry: &Registry) -> Value {
    schema_of(registry, SchemaKind::Scenario)
}

/// The same of a kind of files.
pub fn schema_of(registry: &Registry, file: SchemaKind) -> Value {
    let mut definitions = Map::new();
    let parts = parts_of_file(file);
    let whole = parts.first().map_or("", |part| part.name);
    for part in &parts {
        let own = with_about(form(part, &part.form, ""), &part.about);
        definitions.insert(part.name.to_owned(), own);
    }
    let kinds = if file == SchemaKind::Recording { &[][..] } else { &Kind::ALL[..] };
    for &kind in kinds {
        let mut choices = Vec::new();
        for (card, part) in models(registry, kind) {
            let about = format!("{}: {}. Source: {}", card.about, card.equation, card.source);
            choices.push(named(card.name, &form(&part, &part.form, ""), &about));
            if may_be_bare(&part.form) {
                choices.push(json!({ "const": card.name, "description": card.about }));
            }
        }
        definitions.insert(kind.name().to_owned(), json!({ "anyOf": choices }));
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("Headland {whole}"),
        "description": "A file with its includes in place. (field: value) is an object, Name(field: value) an object of one \
                        property, Name alone a string.",
        "$ref": format!("#/$defs/{whole}"),
        "$defs": definitions,
    })
}

fn named(name: &str, form: &Value, about: &str) -> Value {
    json!({
        "type": "object",
        "description": about,
        "properties": { name: form },
        "required": [name],
        "additionalProperties": false,
    })
}

fn with_about(mut value: Value, about: &str) -> Value {
    if let Value::Object(map) = &mut value {
        map.insert("description".to_owned(), about.into());
    }
    value
}

fn form(part: &Part, form_: &Form, path: &str) -> Value {
    match form_ {
        Form::Any => json!({}),
        Form::Number => number(part.told(path)),
        Form::Whole => json!({ "type": "integer" }),
        Form::Flag => json!({ "type": "boolean" }),
        Form::Text => json!({ "type": "string" }),
        Form::List(inner) => json!({ "type": "array", "items": form(part, inner, path) }),
        Form::Tuple(forms) => {
            let items: Vec<Value> = forms.iter().map(|one| plain(part, one, path)).collect();
            let count = items.len();
            json!({ "type": "array", "prefixItems": items, "minItems": count, "maxItems": count })
        }
        Form::Map(inner) => json!({ "type": "object", "additionalProperties": form(part, inner, path) }),
        Form::Fields(fields) => {
            let property = |field: &headland_plugin::Field| {
                let path = below(path, &field.name);
                let value = form(part, &field.form, &path);
                let told = part.told(&path);
                (field.name.clone(), told.map_or(value.clone(), |told| with_about(value, &sentence(told))))
            };
            let properties: Map<String, Value> = fields.iter().map(property).collect();
            let names: Vec<&str> = required(fields).map(|field| field.name.as_str()).collect();
            json!({
                "type": "object",
                "properties": properties,
                "required": names,
                "additionalProperties": false,
            })
        }
        Form::Choice(variants) => {
            let mut choices = Vec::new();
            for (name, inner) in variants {
                let path = below(path, name);
                let about =
                    part.told(&path).filter(|told| told_of_it(told, name)).map_or("", |told| told.about);
                if let Some(inner) = inner {
                    choices.push(named(name, &form(part, inner, &path), about));
                }
                if inner.as_ref().is_none_or(may_be_bare) {
                    choices.push(json!({ "const": name, "description": about }));
                }
            }
            json!({ "anyOf": choices })
        }
        Form::Either(forms) => {
            let choices: Vec<Value> = forms.iter().map(|one| form(part, one, path)).collect();
            json!({ "anyOf": choices })
        }
        Form::Named(name) => json!({ "$ref": format!("#/$defs/{name}") }),
    }
}

/// Whether what is told is of a variant itself, and not of the field that it stands in.
fn told_of_it(told: &Told, name: &str) -> bool {
    told.path.rsplit('.').next() == Some(name)
}

/// A form without the bounds that are told of the whole it is a part of.
fn plain(part: &Part, one: &Form, path: &str) -> Value {
    if *one == Form::Number { number(None) } else { form(part, one, path) }
}

fn number(told: Option<&Told>) -> Value {
    let mut map = Map::new();
    map.insert("type".to_owned(), json!(["number", "string"]));
    map.insert("pattern".to_owned(), QUANTITY.into());
    let Some(told) = told else { return map.into() };
    match told.bound {
        Bound::Finite => {}
        Bound::Positive => {
            map.insert("exclusiveMinimum".to_owned(), 0.into());
        }
        Bound::NotNegative => {
            map.insert("minimum".to_owned(), 0.into());
        }
        Bound::Efficiency => {
            map.insert("exclusiveMinimum".to_owned(), 0.into());
            map.insert("maximum".to_owned(), 1.into());
        }
        Bound::Within(low, high) => {
            map.insert("minimum".to_owned(), low.into());
            map.insert("maximum".to_owned(), high.into());
        }
    }
    if let Some(default) = told.default {
        map.insert("default".to_owned(), default.into());
    }
    map.into()
}

/// What is told of a field: what it is, its unit, where it usually lies and what it is where it is left out.
fn sentence(told: &Told) -> String {
    let unit = if told.unit.is_empty() { String::new() } else { format!(" [{}]", told.unit) };
    let usual = told.usual.map_or(String::new(), |(low, high)| format!("; usually {low} to {high}"));
    let default = told.default.map_or(String::new(), |value| format!("; {value} if left out"));
    format!("{}{unit}{usual}{default}", told.about)
}
