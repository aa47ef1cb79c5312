//! What a comparison looks like: the forms of its parts, made of those of scenarios and of the types that read the rest.

use crate::schema::{Charge, Electricity, Fuel, RepeatFile, ReportFile, SampleFile};
use headland_plugin::{Bound, Field, Form, form_of};
use headland_scenario::{Definition, Note, definitions as of_scenarios};

/// Pieces: their definition, their list in a comparison, the field of the scenario that a bare one stands for.
const PIECES: [(&str, &str, &str); 3] = [
    ("variant", "variants", "vehicle"),
    ("compared_cycle", "cycles", "cycle"),
    ("compared_ground", "grounds", "ground"),
];

/// Path and words of what a comparison says beside scenarios.
const OWN: [(&str, &str); 32] = [
    ("about", "one line on what it shows"),
    ("variants", "what is compared"),
    ("cycles", "what they do"),
    ("grounds", "what they do it on"),
    ("sweep", "values by dotted path; every combination is run"),
    ("sweep.Range", "from low to high in so many values"),
    ("sample", "a Latin hypercube"),
    ("sample.count", "how many samples"),
    ("sample.seed", "of the draws"),
    ("sample.of", "least and greatest value by dotted path"),
    ("sample.of.Logarithmic", "equal factors are equally likely, not equal steps"),
    ("vary", "low and high by dotted path: everything as written, then one after the other at either end"),
    ("repeat", "repetitions, and what scatters between them"),
    ("repeat.times", "how often"),
    ("repeat.seed", "of what is drawn"),
    ("repeat.scatter", "how far a value lies from the one that is written, by dotted path"),
    ("repeat.scatter.Normal", "a standard deviation"),
    ("repeat.scatter.Within", "evenly, at most so far"),
    ("repeat.scatter.Share", "a standard deviation as a share of the value"),
    ("fuel", "what it is; without it fuel is told in kg and its carbon dioxide is not"),
    ("fuel.density_kg_m3", "of the fuel"),
    ("fuel.co2_kg_per_kg", "carbon dioxide of its combustion"),
    ("electricity", "from the grid, for vehicles without fuel"),
    ("electricity.co2_kg_j", "carbon dioxide of its making"),
    ("charge", "how a change of charge is made up for"),
    ("charge.charging_efficiency", "energy in the store for energy of the engine's shaft"),
    (
        "charge.discharging_efficiency",
        "energy that replaces that of the engine's shaft for energy of the store",
    ),
    ("report", "what the report is about"),
    ("report.baseline", "the variant that the others are held against; the first without"),
    ("report.by", "what is compared, most important first"),
    ("name", "what it is called; the name of its file without"),
    ("with", "what it changes in the scenario, by dotted path, or by field in the vehicle or the ground"),
];

/// What is compared by, in words.
const MEASURES: [(&str, &str); 12] = [
    ("report.by.Fuel", "at the charge that the run began with"),
    ("report.by.Electricity", "that electric stores gave"),
    ("report.by.Co2", "carbon dioxide"),
    ("report.by.Time", "from start to end"),
    ("report.by.Area", "that was worked"),
    ("report.by.AreaRate", "area by time; more is better"),
    ("report.by.FuelPerHectare", "of the area that was worked"),
    ("report.by.EnergyPerHectare", "of fuel and stores"),
    ("report.by.SpecificFuel", "for the work of the engine's shaft"),
    ("report.by.FuelPerWork", "for that at drawbar, power take-off and hydraulics"),
    ("report.by.FuelPerDistance", "for the way"),
    ("report.by.Energy", "of fuel and stores"),
];

/// What numbers have to be.
const BOUNDS: [(&str, Bound); 5] = [
    ("fuel.density_kg_m3", Bound::Positive),
    ("fuel.co2_kg_per_kg", Bound::NotNegative),
    ("electricity.co2_kg_j", Bound::NotNegative),
    ("charge.charging_efficiency", Bound::Efficiency),
    ("charge.discharging_efficiency", Bound::Efficiency),
];

/// A comparison, first, and its pieces. What they name beside is defined by
/// [scenarios](headland_scenario::definitions) and by a registry.
pub fn definitions() -> Vec<Definition> {
    let scenario = of_scenarios().into_iter().find(|definition| definition.name == "scenario");
    let (mut shared, notes) = match scenario {
        Some(Definition { form: Form::Fields(fields), notes, .. }) => (fields, notes),
        _ => (Vec::new(), Vec::new()),
    };
    shared.retain(|field| field.name != "about");
    for field in &mut shared {
        field.required = false;
        // What a piece lacks another one may bring, and `with` as well.
        if let Form::Fields(fields) = &mut field.form {
            for field in fields {
                field.required = false;
            }
        }
    }
    let mut all = vec![comparison(&shared, &notes)];
    all.extend(PIECES.map(|(name, _, field)| piece(name, field, &shared, &notes)));
    all
}

fn comparison(shared: &[Field], of_scenario: &[Note]) -> Definition {
    let mut fields = vec![field("about", true, Form::Text)];
    fields.extend(PIECES.map(|(name, list, _)| field(list, false, Form::List(Box::new(Form::Named(name))))));
    let range = choice("Range", Form::Tuple(vec![Form::Number, Form::Number, Form::Whole]));
    let values = Form::Either(vec![Form::List(Box::new(Form::Any)), range]);
    let ends = || Form::Tuple(vec![Form::Number, Form::Number]);
    let drawn = Form::Either(vec![ends(), choice("Logarithmic", ends())]);
    let spreads = ["Normal", "Within", "Share"].map(|name| (name.to_owned(), Some(Form::Number)));
    fields.extend([
        field("sweep", false, map(values)),
        field("sample", false, with(form_of::<SampleFile>(), "of", map(drawn))),
        field("vary", false, map(ends())),
        field("repeat", false, with(form_of::<RepeatFile>(), "scatter", map(Form::Choice(spreads.into())))),
        field("fuel", false, form_of::<Fuel>()),
        field("electricity", false, form_of::<Electricity>()),
        field("charge", false, form_of::<Charge>()),
        field("report", false, form_of::<ReportFile>()),
    ]);
    fields.extend_from_slice(shared);
    let bound =
        |path: &str| BOUNDS.iter().find(|(own, _)| *own == path).map_or(Bound::Finite, |(_, bound)| *bound);
    let own = OWN[..OWN.len() - 2].iter().chain(&MEASURES);
    let mut notes: Vec<Note> = own.map(|&(path, about)| Note { path, about, bound: bound(path) }).collect();
    notes.extend(of_scenario.iter().filter(|note| note.path != "about"));
    Definition { name: "comparison", form: Form::Fields(fields), notes }
}

/// Fields of a scenario with a name, or just the vehicle, the phases or the ground.
fn piece(name: &'static str, of: &str, shared: &[Field], of_scenario: &[Note]) -> Definition {
    let mut fields = vec![field("name", false, Form::Text), field("with", false, Form::Any)];
    fields.extend_from_slice(shared);
    let bare = shared.iter().find(|field| field.name == of).map(|field| field.form.clone());
    let mut notes: Vec<Note> = OWN[OWN.len() - 2..]
        .iter()
        .map(|&(path, about)| Note { path, about, bound: Bound::Finite })
        .collect();
    notes.extend(of_scenario.iter().filter(|note| note.path != "about"));
    let below = |note: &Note| {
        let path = note.path.strip_prefix(of)?.strip_prefix('.')?;
        (path != "name").then_some(Note { path, ..*note })
    };
    notes.extend(of_scenario.iter().filter_map(below));
    let forms = std::iter::once(Form::Fields(fields)).chain(bare).collect();
    Definition { name, form: Form::Either(forms), notes }
}

fn field(name: &str, required: bool, form: Form) -> Field {
    Field { name: name.to_owned(), required, form }
}

fn map(of: Form) -> Form {
    Form::Map(Box::new(of))
}

fn choice(name: &str, form: Form) -> Form {
    Form::Choice(vec![(name.to_owned(), Some(form))])
}

/// A form with another one at a path.
fn with(mut form: Form, path: &str, other: Form) -> Form {
    if let Some(part) = form.find(path) {
        *part = other;
    }
    form
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_is_told_and_nothing_else_is() {
        for definition in definitions() {
            let all = definition.form.paths();
            for path in &all {
                assert!(
                    definition.notes.iter().any(|note| note.path == path),
                    "{}: nothing is told of `{path}`",
                    definition.name
                );
            }
            for note in &definition.notes {
                assert!(all.iter().any(|path| path == note.path), "{}: no `{}`", definition.name, note.path);
            }
        }
    }

    #[test]
    fn a_comparison_asks_for_one_line_and_nothing_more() {
        let Form::Fields(fields) = &definitions()[0].form else { panic!("fields") };
        let required: Vec<&str> =
            fields.iter().filter(|field| field.required).map(|field| field.name.as_str()).collect();
        assert_eq!(required, ["about"]);
        let mut names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
