//! `docs/plugins.md` and a page for each family below `docs/plugins`, made from the models' own cards.
//!
//! `HEADLAND_WRITE=1 cargo test --test whole models` writes it anew.

use crate::root;
use headland_plugin::{Bound, Card, Kind, Parameter};
use std::fmt::Write;

const HEAD: &str = "# The models that scenarios can name

Made from what the models say of themselves; `headland plugins NAME` prints the same. Every number of a scenario is in the
unit that its page says, or is a text with a unit of its own (`\"30 km/h\"`). A value outside what is usual is accepted and
remarked upon; a value outside what it must be is refused.

How a model of your own joins them: [own_plugin](own_plugin/README.md).
";

/// What every page of a family begins with.
const PARAMETERS: &str = "Made from what the models say of themselves. [All models](../plugins.md)
";

/// The pages by their paths below `docs`: the list of all models, and one for each family.
fn pages() -> Vec<(String, String)> {
    let registry = headland_stock::registry();
    let mut list = HEAD.to_owned();
    let mut pages = Vec::new();
    for kind in Kind::ALL {
        let name = format!("plugins/{}.md", title(kind).to_lowercase());
        let _ = writeln!(list, "\n## {}\n\n[Equations, sources and parameters]({name})\n", title(kind));
        let mut page = format!("# {}\n\n{PARAMETERS}", title(kind));
        for card in registry.cards(kind) {
            let _ =
                writeln!(list, "- [`{}`]({name}#{}): {}", card.name, card.name.to_lowercase(), card.about);
            describe(&mut page, card);
        }
        pages.push((name, page));
    }
    pages.push(("plugins.md".to_owned(), list));
    pages
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
        "\n## `{}`\n\n{}.\n\n```text\n{}\n```\n\n",
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
fn the_pages_of_the_models_are_up_to_date() {
    let pages = pages();
    for (name, page) in &pages {
        let path = root().join("docs").join(name);
        if std::env::var_os("HEADLAND_WRITE").is_some() {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, page).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        let first = page.lines().zip(found.lines()).position(|(made, found)| made != found);
        assert!(
            *page == found,
            "docs/{name} differs from the models from line {} on; `HEADLAND_WRITE=1 cargo test --test whole models` writes it \
             anew",
            first.unwrap_or(found.lines().count()) + 1
        );
    }
    for entry in std::fs::read_dir(root().join("docs/plugins")).unwrap() {
        let name = format!("plugins/{}", entry.unwrap().file_name().to_string_lossy());
        assert!(pages.iter().any(|(made, _)| *made == name), "docs/{name} belongs to no family of models");
    }
}
