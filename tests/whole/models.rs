//! `docs/plugins.md`, made from the models' own cards.
//!
//! `HEADLAND_WRITE=1 cargo test --test whole models` writes it anew.

use crate::root;
use headland_plugin::{Bound, Card, Kind, Parameter};
use std::fmt::Write;

const HEAD: &str = "# The models that scenarios can name

Made from what the models say of themselves; `headland plugins NAME` prints the same. Every number of a scenario is in the
unit that stands here, or is a text with a unit of its own (`\"30 km/h\"`). A value outside what is usual is accepted and
remarked upon; a value outside what it must be is refused.

How a model of your own joins them: [own_plugin](own_plugin/README.md).
";

fn page() -> String {
    let registry = headland_stock::registry();
    let mut page = HEAD.to_owned();
    page.push('\n');
    for kind in Kind::ALL {
        let _ = writeln!(page, "- [{}](#{})", title(kind), title(kind).to_lowercase());
    }
    for kind in Kind::ALL {
        let _ = writeln!(page, "\n## {}", title(kind));
        for card in registry.cards(kind) {
            describe(&mut page, card);
        }
    }
    page
}

fn title(kind: Kind) -> &'static str {
    match kind {
        Kind::Soil => "Soils",
        Kind::Terrain => "Terrains",
        Kind::Driveline => "Drivelines",
        Kind::Management => "Managements",
        Kind::Task => "Tasks",
        Kind::Effect => "Effects",
    }
}

fn describe(page: &mut String, card: &Card) {
    let _ = write!(
        page,
        "\n### `{}`\n\n{}.\n\n```text\n{}\n```\n\n",
        card.name,
        capital(card.about),
        card.equation
    );
    let _ = write!(page, "Source: {}.\nHolds: {}.\n", card.source, card.validity);
    if card.parameters.is_empty() {
        page.push_str("\nNo parameters.\n");
        return;
    }
    page.push_str(
        "\n| parameter | unit | what it is | must be | usual | if left out |\n|---|---|---|---|---|---|\n",
    );
    for parameter in card.parameters {
        let _ = writeln!(page, "{}", row(parameter));
    }
}

fn row(parameter: &Parameter) -> String {
    let must = match parameter.bound {
        Bound::Finite => String::new(),
        bound => bound.in_words(),
    };
    let usual = parameter.plausible.map_or(String::new(), |(low, high)| format!("{low} to {high}"));
    let default = parameter.default.map_or(String::new(), |value| value.to_string());
    let about = parameter.about.replace('|', "\\|");
    format!("| `{}` | {} | {about} | {must} | {usual} | {default} |", parameter.name, parameter.unit)
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[test]
fn the_page_of_the_models_is_up_to_date() {
    let path = root().join("docs/plugins.md");
    let page = page();
    if std::env::var_os("HEADLAND_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    let first = page.lines().zip(found.lines()).position(|(made, found)| made != found);
    assert!(
        page == found,
        "docs/plugins.md differs from the models from line {} on; `HEADLAND_WRITE=1 cargo test --test whole models` \
         writes it anew",
        first.unwrap_or(found.lines().count()) + 1
    );
}
