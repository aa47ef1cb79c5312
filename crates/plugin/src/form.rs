//! What a text has to look like for a type to be read from it: found out from how the type reads itself.
//!
//! A type derives `Deserialize`; here it is read from nothing, again and again, and what it asks for is written down: names
//! of fields, variants, lists, numbers. Whether a field may be left out shows by leaving it out. So a schema never differs
//! from what is accepted, and no model has to describe its shape.

use crate::asking::Asking;
use serde::de::DeserializeOwned;

/// What a value has to look like.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Form {
    /// Anything, or what somebody else reads.
    #[default]
    Any,
    /// A number; a text with a unit where the name says one.
    Number,
    /// A whole number.
    Whole,
    /// `true` or `false`.
    Flag,
    /// A text.
    Text,
    /// A list of such values.
    List(Box<Form>),
    /// As many values as there are forms.
    Tuple(Vec<Form>),
    /// Such values by names of one's own.
    Map(Box<Form>),
    /// `(field: value)`.
    Fields(Vec<Field>),
    /// One of several names, each with what follows it, as in `Name` or `Name(field: value)`.
    Choice(Vec<(String, Option<Form>)>),
    /// One of several forms.
    Either(Vec<Form>),
    /// A form that stands elsewhere under this name.
    Named(&'static str),
}

impl Form {
    /// Paths of all its fields and variants, `cycle.Hold.for_s`; values of lists and maps have the path of what holds them.
    pub fn paths(&self) -> Vec<String> {
        let mut all = Vec::new();
        self.add_paths("", &mut all);
        all
    }

    fn add_paths(&self, path: &str, all: &mut Vec<String>) {
        let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match self {
            Self::List(inner) | Self::Map(inner) => inner.add_paths(path, all),
            Self::Either(forms) => forms.iter().for_each(|form| form.add_paths(path, all)),
            Self::Fields(fields) => {
                for field in fields {
                    all.push(below(&field.name));
                    field.form.add_paths(&below(&field.name), all);
                }
            }
            Self::Choice(variants) => {
                for (name, inner) in variants {
                    all.push(below(name));
                    if let Some(inner) = inner {
                        inner.add_paths(&below(name), all);
                    }
                }
            }
            _ => {}
        }
    }
}

/// A field of a struct.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Whether it has to be given.
    pub required: bool,
    /// What its value looks like.
    pub form: Form,
}

/// More readings than any type needs: each adds something.
const MOST_READINGS: usize = 100_000;

/// The form of a type.
pub fn form_of<T: DeserializeOwned>() -> Form {
    let mut asked = Asked::default();
    for _ in 0..MOST_READINGS {
        if asked.done {
            break;
        }
        // What it makes of nothing is of no interest, a refusal as little: what it asked for stays.
        let _ = T::deserialize(Asking { asked: &mut asked });
    }
    asked.into_form()
}

/// What was asked for at one place so far.
#[derive(Debug, Default)]
pub(crate) struct Asked {
    pub kind: Kind,
    /// Whether nothing more can be found out.
    pub done: bool,
    /// Whether it may be left out because it is an `Option`.
    pub optional: bool,
}

/// What was asked for.
#[derive(Debug, Default)]
pub(crate) enum Kind {
    #[default]
    Unknown,
    Plain(Form),
    List(Box<Asked>),
    Map(Box<Asked>),
    Tuple(Vec<Asked>),
    Fields(Vec<AskedField>),
    Choice(Vec<(&'static str, Option<Asked>)>),
}

/// A field that was asked for.
#[derive(Debug)]
pub(crate) struct AskedField {
    pub name: &'static str,
    pub asked: Asked,
    pub required: bool,
}

impl Asked {
    fn into_form(self) -> Form {
        match self.kind {
            Kind::Unknown => Form::Any,
            Kind::Plain(form) => form,
            Kind::List(inner) => Form::List(Box::new(inner.into_form())),
            Kind::Map(inner) => Form::Map(Box::new(inner.into_form())),
            Kind::Tuple(inner) => Form::Tuple(inner.into_iter().map(Self::into_form).collect()),
            Kind::Fields(fields) => Form::Fields(
                fields
                    .into_iter()
                    .map(|field| Field {
                        name: field.name.to_owned(),
                        required: field.required,
                        form: field.asked.into_form(),
                    })
                    .collect(),
            ),
            Kind::Choice(variants) => Form::Choice(
                variants
                    .into_iter()
                    .map(|(name, inner)| {
                        let form = inner.map(Self::into_form);
                        // A variant without anything behind it.
                        (name.to_owned(), form.filter(|form| *form != Form::Tuple(Vec::new())))
                    })
                    .collect(),
            ),
        }
    }
}

impl Form {
    /// The form at a dotted path of fields; lists are looked through.
    pub fn find(&mut self, path: &str) -> Option<&mut Self> {
        if path.is_empty() {
            return Some(self);
        }
        if let Self::List(inner) | Self::Map(inner) = self {
            return inner.find(path);
        }
        let Self::Fields(fields) = self else { return None };
        let (head, rest) = path.split_once('.').unwrap_or((path, ""));
        fields.iter_mut().find(|field| field.name == head)?.form.find(rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;
    use serde::de::IgnoredAny;
    use std::collections::BTreeMap;

    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code, reason = "asked for its form alone")]
    struct Whole {
        mass_kg: f64,
        name: Option<String>,
        #[serde(default)]
        gears: Vec<Gear>,
        mode: Mode,
        map: Option<BTreeMap<String, Vec<IgnoredAny>>>,
        bounds: (f64, u32),
        checked: Checked,
    }

    #[derive(Deserialize)]
    #[allow(dead_code, reason = "asked for its form alone")]
    struct Gear {
        ratio: f64,
        #[serde(default = "yes")]
        used: bool,
    }

    fn yes() -> bool {
        true
    }

    #[derive(Deserialize)]
    #[allow(dead_code, reason = "asked for its form alone")]
    enum Mode {
        Off,
        Kept(f64),
        Over { times_s: Vec<f64>, inner: Option<Inner> },
    }

    #[derive(Deserialize)]
    enum Inner {
        One,
        Two,
    }

    /// What refuses everything that it can be given here.
    #[derive(Deserialize)]
    #[serde(try_from = "f64")]
    struct Checked;

    impl TryFrom<f64> for Checked {
        type Error = String;
        fn try_from(value: f64) -> Result<Self, String> {
            Err(format!("{value} is nothing"))
        }
    }

    fn field(name: &str, required: bool, form: Form) -> Field {
        Field { name: name.to_owned(), required, form }
    }

    #[test]
    fn a_type_tells_all_it_asks_for() {
        let numbers = || Form::List(Box::new(Form::Number));
        let inner = Form::Choice(vec![("One".to_owned(), None), ("Two".to_owned(), None)]);
        let over = Form::Fields(vec![field("times_s", true, numbers()), field("inner", false, inner)]);
        let gear = Form::Fields(vec![field("ratio", true, Form::Number), field("used", false, Form::Flag)]);
        let expected = Form::Fields(vec![
            field("mass_kg", true, Form::Number),
            field("name", false, Form::Text),
            field("gears", false, Form::List(Box::new(gear))),
            field(
                "mode",
                true,
                Form::Choice(vec![
                    ("Off".to_owned(), None),
                    ("Kept".to_owned(), Some(Form::Number)),
                    ("Over".to_owned(), Some(over)),
                ]),
            ),
            field("map", false, Form::Map(Box::new(Form::List(Box::new(Form::Any))))),
            field("bounds", true, Form::Tuple(vec![Form::Number, Form::Whole])),
            field("checked", true, Form::Number),
        ]);
        assert_eq!(form_of::<Whole>(), expected);
    }

    #[test]
    fn forms_are_found_by_their_path_through_lists() {
        let mut form = form_of::<Whole>();
        assert_eq!(form.find("gears.used"), Some(&mut Form::Flag));
        assert_eq!(form.find("gears.teeth"), None);
        assert_eq!(form_of::<f64>(), Form::Number);
    }
}
