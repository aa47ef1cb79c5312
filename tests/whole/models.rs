//! `docs/plugins.md` and a page for each family below `docs/plugins`, made from the models' own cards.
//!
//! `HEADLAND_WRITE=1 cargo test --test whole models` writes it anew.

use crate::root;
use headland_plugin::{Bound, Card, Kind, Parameter};
use headland_task::{IMPLEMENTS, MACHINES, MACHINES_SOURCE, Per};
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
    list.push_str(TABLES);
    pages.push(("plugins/implements.md".to_owned(), implements()));
    pages.push(("plugins.md".to_owned(), list));
    pages
}

const TABLES: &str = "
## Tables

- [Implements and machines](plugins/implements.md): what `Tillage`, `Rotary`, `Harvester` and `Spreader` know by name, and from where
";

/// What tasks know by name.
fn implements() -> String {
    let mut page = "# Implements and machines

Made from the tables of the program. [All models](../plugins.md)

The standard itself was not at hand: each row says whether its numbers were seen in public code that cites it or come from
memory. Either is a default to be overridden by what was measured; *spread* is what the standard says of its own rows.

## Implements of `Tillage`

D = F (A + B S + C S²) W T, with D in N, S in km/h and T in cm; W is the width in m or the number of tools or rows; T is 1 where the depth
does not count. F is that of fine, medium and coarse soil.

| implement | A | B | C | F fine, medium, coarse | W counts | depth counts | spread ± % | numbers |
|---|---:|---:|---:|---|---|---|---:|---|
"
    .to_owned();
    for row in &IMPLEMENTS {
        let ([a, b, c], [fine, medium, coarse]) = (row.abc, row.factors);
        let per = if row.per == Per::Metre { "metres" } else { "tools" };
        let deep = if row.deep { "yes" } else { "no" };
        let _ = writeln!(
            page,
            "| `{}` | {a} | {b} | {c} | {fine}, {medium}, {coarse} | {per} | {deep} | {} | {} |",
            row.name, row.spread_percent, row.source
        );
    }
    let _ = write!(
        page,
        "
## Machines of `Rotary`, `Harvester` and `Spreader`

P = a + b W + c F, with P in kW, the width W in m and the flow F in t/h. All rows: {MACHINES_SOURCE}; spread ±25 to ±50 %.

| machine | a kW | b kW/m | c kW h/t |
|---|---:|---:|---:|
"
    );
    for (name, power) in &MACHINES {
        let _ = writeln!(page, "| `{name}` | {} | {} | {} |", power.a, power.b, power.c);
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
