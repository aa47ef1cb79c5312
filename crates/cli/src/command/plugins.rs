//! `headland plugins`: what scenarios can name.

use crate::arguments::PluginsOptions;
use crate::failure::Failure;
use crate::say::Say;
use headland_plugin::{Bound, Card, Kind, Registry, closest};
use serde::Serialize;
use std::fmt::Write;

#[derive(Debug, Serialize)]
struct Listed {
    kind: &'static str,
    name: &'static str,
    about: &'static str,
    equation: &'static str,
    source: &'static str,
    validity: &'static str,
    parameters: Vec<ListedParameter>,
}

#[derive(Debug, Serialize)]
struct ListedParameter {
    name: &'static str,
    unit: &'static str,
    about: &'static str,
    must_be: String,
    plausible: Option<(f64, f64)>,
    default: Option<f64>,
}

/// Runs the command.
pub fn plugins(registry: &Registry, options: &PluginsOptions, say: Say) -> Result<(), Failure> {
    let listed = match &options.kind {
        None => every(registry),
        Some(word) => chosen(registry, word)?,
    };
    let whole = options.kind.is_some();
    let mut text = String::new();
    let mut kind = "";
    for one in &listed {
        if one.kind != kind {
            kind = one.kind;
            let _ = writeln!(text, "{kind}");
        }
        if whole { describe(&mut text, one) } else { line(&mut text, one) }
    }
    if !whole {
        text.push_str(
            "\n`headland plugins KIND` or `headland plugins NAME` tells equation, source and parameters.\n",
        );
    }
    say.result(&text, &listed)
}

fn every(registry: &Registry) -> Vec<Listed> {
    Kind::ALL
        .iter()
        .flat_map(|kind| registry.cards(*kind).into_iter().map(|card| list(*kind, card)))
        .collect()
}

fn chosen(registry: &Registry, word: &str) -> Result<Vec<Listed>, Failure> {
    let singular = word.strip_suffix('s').unwrap_or(word);
    let fits = |one: &Listed| [word, singular].contains(&one.kind) || one.name.eq_ignore_ascii_case(word);
    let all = every(registry);
    let known: Vec<&str> = all.iter().map(|one| one.name).chain(Kind::ALL.map(Kind::name)).collect();
    let suggestion = closest(word, &known);
    let kinds = Kind::ALL.map(Kind::name);
    let found: Vec<Listed> = all.into_iter().filter(fits).collect();
    if found.is_empty() && !kinds.contains(&singular) {
        let hint = suggestion.map_or(String::new(), |name| format!("; did you mean `{name}`?"));
        return Err(Failure::Input(format!(
            "no kind and no model is named `{word}`{hint}\n  kinds: {}   (headland plugins lists every model)",
            kinds.join(", ")
        )));
    }
    Ok(found)
}

fn list(kind: Kind, card: &Card) -> Listed {
    let parameter = |parameter: &headland_plugin::Parameter| ListedParameter {
        name: parameter.name,
        unit: parameter.unit,
        about: parameter.about,
        must_be: match parameter.bound {
            Bound::Finite => String::new(),
            bound => bound.in_words(),
        },
        plausible: parameter.plausible,
        default: parameter.default,
    };
    Listed {
        kind: kind.name(),
        name: card.name,
        about: card.about,
        equation: card.equation,
        source: card.source,
        validity: card.validity,
        parameters: card.parameters.iter().map(parameter).collect(),
    }
}

fn line(text: &mut String, one: &Listed) {
    let _ = writeln!(text, "  {:<24} {}", one.name, one.about);
}

fn describe(text: &mut String, one: &Listed) {
    let _ = writeln!(text, "\n  {}\n    {}", one.name, one.about);
    let _ = writeln!(
        text,
        "    equation  {}\n    source    {}\n    holds     {}",
        one.equation, one.source, one.validity
    );
    for parameter in &one.parameters {
        let mut facts = Vec::new();
        if !parameter.must_be.is_empty() {
            facts.push(parameter.must_be.clone());
        }
        if let Some((low, high)) = parameter.plausible {
            facts.push(format!("usually {low} to {high}"));
        }
        if let Some(default) = parameter.default {
            facts.push(format!("{default} if left out"));
        }
        let _ = writeln!(
            text,
            "    {:<28} [{}] {}{}",
            parameter.name,
            parameter.unit,
            parameter.about,
            if facts.is_empty() { String::new() } else { format!(" ({})", facts.join("; ")) }
        );
    }
}
