//! Snippets as Visual Studio Code, and editors that read its files, complete them: every model, phase and end of a phase, with
//! what has to be given as places to fill in.

use super::{Part, below, models, parts, required};
use headland_plugin::{Bound, Form, Kind, Registry};
use serde_json::{Map, Value, json};

/// The language that editors call RON.
const LANGUAGE: &str = "ron";

/// Snippets of what a scenario can say to this registry.
pub fn snippets(registry: &Registry) -> Value {
    let mut all = Map::new();
    for part in parts() {
        if part.name == "scenario" {
            let mut body = Body { part: &part, places: 0 };
            let text = body.value(&part.form, "", 0);
            all.insert("scenario".to_owned(), snippet(&["scenario"], &text, &part.about));
        }
        let Form::Choice(variants) = &part.form else { continue };
        for (name, form) in variants {
            let mut body = Body { part: &part, places: 0 };
            let text =
                format!("{name}{}", form.as_ref().map_or(String::new(), |form| body.value(form, name, 0)));
            let about = part.told(name).map_or("", |told| told.about);
            all.insert(format!("{name} ({})", part.name), snippet(&[name], &text, about));
        }
    }
    for kind in Kind::ALL {
        for (card, part) in models(registry, kind) {
            let mut body = Body { part: &part, places: 0 };
            let inside = body.value(&part.form, "", 0);
            let text = if inside == "()" { card.name.to_owned() } else { format!("{}{inside}", card.name) };
            let about = format!("{}: {}{}", kind.name(), card.about, left_out(&part.form));
            all.insert(
                format!("{} ({})", card.name, kind.name()),
                snippet(&[card.name, kind.name()], &text, &about),
            );
        }
    }
    all.into()
}

fn snippet(prefixes: &[&str], text: &str, about: &str) -> Value {
    let body: Vec<&str> = text.lines().collect();
    json!({ "prefix": prefixes, "scope": LANGUAGE, "body": body, "description": about })
}

/// What may be said besides.
fn left_out(form: &Form) -> String {
    let Form::Fields(fields) = form else { return String::new() };
    let names: Vec<&str> =
        fields.iter().filter(|field| !field.required).map(|field| field.name.as_str()).collect();
    if names.is_empty() { String::new() } else { format!(". May also say: {}", names.join(", ")) }
}

/// The text of a snippet as it grows.
struct Body<'a> {
    part: &'a Part,
    places: usize,
}

/// Structs of so many fields stand on one line.
const ON_ONE_LINE: usize = 3;

impl Body<'_> {
    fn place(&mut self, hint: &str) -> String {
        self.places += 1;
        let hint = hint.replace('\\', "\\\\").replace('$', "\\$").replace('}', "\\}");
        format!("${{{}:{hint}}}", self.places)
    }

    fn one_of(&mut self, words: &[&str]) -> String {
        self.places += 1;
        format!("${{{}|{}|}}", self.places, words.join(","))
    }

    fn value(&mut self, form: &Form, path: &str, depth: usize) -> String {
        match form {
            Form::Any => self.place("value"),
            Form::Number => {
                let hint = self.hint(path);
                self.place(&hint)
            }
            Form::Whole => self.place("whole number"),
            Form::Flag => self.one_of(&["true", "false"]),
            Form::Text => format!("\"{}\"", self.place(path.rsplit('.').next().unwrap_or("text"))),
            Form::List(inner) => format!("[{}]", self.value(inner, path, depth)),
            Form::Tuple(forms) => {
                let values: Vec<String> = forms.iter().map(|form| self.value(form, path, depth)).collect();
                format!("({})", values.join(", "))
            }
            Form::Map(inner) => format!("{{\"{}\": {}}}", self.place("name"), self.value(inner, path, depth)),
            Form::Either(forms) => forms.first().map_or(String::new(), |form| self.value(form, path, depth)),
            Form::Named(name) => self.place(name),
            Form::Choice(variants) => {
                let names: Vec<&str> = variants.iter().map(|(name, _)| name.as_str()).collect();
                self.one_of(&names)
            }
            Form::Fields(fields) => {
                let given: Vec<_> = required(fields).collect();
                let plain =
                    given.iter().all(|field| matches!(field.form, Form::Number | Form::Whole | Form::Text));
                let short = plain && given.len() <= ON_ONE_LINE;
                let inner: Vec<String> = given
                    .iter()
                    .map(|field| {
                        let value = self.value(&field.form, &below(path, &field.name), depth + 1);
                        format!("{}: {value}", field.name)
                    })
                    .collect();
                if short {
                    return format!("({})", inner.join(", "));
                }
                let (indent, end) = ("    ".repeat(depth + 1), "    ".repeat(depth));
                format!("(\n{indent}{},\n{end})", inner.join(&format!(",\n{indent}")))
            }
        }
    }

    /// What a number has to be, in its place until the author writes it.
    fn hint(&self, path: &str) -> String {
        let Some(told) = self.part.told(path) else { return "number".to_owned() };
        match (told.usual, told.bound) {
            (Some((low, high)), _) => format!("{low} to {high}"),
            (None, Bound::Finite) => "number".to_owned(),
            (None, bound) => bound.in_words(),
        }
    }
}
