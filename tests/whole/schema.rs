//! Every scenario of the project conforms to the exported schema, and what does not is refused by it.

use crate::{files_below, root};
use headland_scenario::{Document, Node, Shape};
use serde_json::{Map, Value, json};
use std::path::Path;

/// RON as the JSON that the schema speaks of.
fn as_json(node: &Node, text: &str) -> Value {
    let fields = |fields: &[headland_scenario::Field]| {
        Value::Object(fields.iter().map(|field| (field.key.clone(), as_json(&field.value, text))).collect())
    };
    let named = |name: &Option<std::ops::Range<usize>>, inner: Value| match name {
        Some(name) => json!({ &text[name.clone()]: inner }),
        None => inner,
    };
    match &node.shape {
        Shape::Struct { name, fields: own } => named(name, fields(own)),
        Shape::Tuple { name: name @ Some(_), values } if values.len() == 1 => {
            named(name, as_json(&values[0], text))
        }
        Shape::Tuple { name, values } => {
            named(name, Value::Array(values.iter().map(|value| as_json(value, text)).collect()))
        }
        Shape::List(values) => Value::Array(values.iter().map(|value| as_json(value, text)).collect()),
        Shape::Map(entries) => {
            let entry = |(key, value): &(Node, Node)| match &key.shape {
                Shape::Text(key) => (key.clone(), as_json(value, text)),
                other => panic!("{other:?}"),
            };
            Value::Object(entries.iter().map(entry).collect())
        }
        Shape::Text(words) => Value::String(words.clone()),
        Shape::Word => {
            let word = text[node.span.clone()].replace('_', "");
            let number = || word.parse::<f64>().ok().filter(|number| number.is_finite()).map(Value::from);
            let whole = word.parse::<i64>().ok().map(Value::from);
            let flag = word.parse::<bool>().ok().map(Value::from);
            whole
                .or_else(number)
                .or(flag)
                .unwrap_or_else(|| Value::String(text[node.span.clone()].to_owned()))
        }
    }
}

/// Keywords that say something to people only.
const ANNOTATIONS: [&str; 5] = ["description", "title", "default", "$schema", "$defs"];

/// Why a value does not conform, with its path. Panics at a keyword that this validator does not know.
fn validate(whole: &Value, schema: &Value, value: &Value, path: &str) -> Result<(), String> {
    let Value::Object(keywords) = schema else { panic!("{schema}") };
    for (keyword, says) in keywords.iter().filter(|(keyword, _)| !ANNOTATIONS.contains(&keyword.as_str())) {
        let fits = match keyword.as_str() {
            "$ref" => {
                let target = whole.pointer(says.as_str().unwrap().trim_start_matches('#')).unwrap();
                validate(whole, target, value, path)?;
                true
            }
            "anyOf" => {
                let told: Vec<String> = says
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|one| validate(whole, one, value, path).err().unwrap_or_default())
                    .collect();
                if !told.iter().any(String::is_empty) {
                    // The one that came furthest is the one that was meant.
                    return Err(told
                        .into_iter()
                        .max_by_key(|why| why.split(": ").next().unwrap().len())
                        .unwrap());
                }
                true
            }
            "type" => match says {
                Value::Array(kinds) => kinds.iter().any(|kind| is(value, kind.as_str().unwrap())),
                kind => is(value, kind.as_str().unwrap()),
            },
            "const" => value == says,
            "required" => {
                let lacks = |name: &&Value| value.get(name.as_str().unwrap()).is_none();
                !value.is_object() || !says.as_array().unwrap().iter().any(|name| lacks(&name))
            }
            "properties" => {
                for (name, one) in says.as_object().unwrap() {
                    if let Some(inner) = value.get(name) {
                        validate(whole, one, inner, &format!("{path}.{name}"))?;
                    }
                }
                true
            }
            "additionalProperties" => {
                let known = keywords.get("properties").and_then(Value::as_object);
                let empty = Map::new();
                for (name, inner) in value.as_object().unwrap_or(&empty) {
                    if known.is_some_and(|known| known.contains_key(name)) {
                        continue;
                    }
                    if says == &json!(false) {
                        return Err(format!("{path}.{name}: is not known"));
                    }
                    validate(whole, says, inner, &format!("{path}.{name}"))?;
                }
                true
            }
            "items" => {
                for (index, inner) in value.as_array().into_iter().flatten().enumerate() {
                    validate(whole, says, inner, &format!("{path}.{index}"))?;
                }
                true
            }
            "prefixItems" => {
                for (one, inner) in
                    says.as_array().unwrap().iter().zip(value.as_array().into_iter().flatten())
                {
                    validate(whole, one, inner, path)?;
                }
                true
            }
            "minItems" => value.as_array().is_none_or(|list| list.len() as u64 >= says.as_u64().unwrap()),
            "maxItems" => value.as_array().is_none_or(|list| list.len() as u64 <= says.as_u64().unwrap()),
            "minimum" => value.as_f64().is_none_or(|number| number >= says.as_f64().unwrap()),
            "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > says.as_f64().unwrap()),
            "maximum" => value.as_f64().is_none_or(|number| number <= says.as_f64().unwrap()),
            "pattern" => {
                assert_eq!(says, "^\\s*[-+.0-9]");
                let begins =
                    |text: &str| text.trim_start().starts_with(|c: char| "-+.0123456789".contains(c));
                value.as_str().is_none_or(begins)
            }
            unknown => panic!("a keyword that is not known: {unknown}"),
        };
        if !fits {
            return Err(format!("{path}: {value} is against {keyword} {says}"));
        }
    }
    Ok(())
}

fn is(value: &Value, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("{other}"),
    }
}

fn read(path: &Path) -> Value {
    let document =
        Document::read(path).unwrap_or_else(|error| panic!("{}: {}", path.display(), error.told()));
    as_json(document.tree(), document.text())
}

fn schema() -> Value {
    headland::schema(&headland_stock::registry())
}

#[test]
fn every_scenario_conforms_to_the_schema() {
    let (schema, folder) = (schema(), root().join("scenarios"));
    let mut files = files_below(&folder);
    files.retain(|path| path.parent() == Some(&folder) && path.extension().is_some_and(|end| end == "ron"));
    assert!(files.len() > 40, "{files:?}");
    for path in files {
        if let Err(why) = validate(&schema, &schema, &read(&path), "") {
            panic!("{}: {why}", path.display());
        }
    }
}

/// Vehicles, grounds, cycles and soils that scenarios include conform to the part that they stand for.
#[test]
fn every_piece_conforms_to_its_part_of_the_schema() {
    let whole = schema();
    let scenario = &whole["$defs"]["scenario"]["properties"];
    let parts = [
        ("vehicles", &scenario["vehicle"]),
        ("grounds", &scenario["ground"]),
        ("cycles", &whole["$defs"]["cycle"]),
        ("tyres", &scenario["vehicle"]["properties"]["axles"]["items"]["properties"]["tyre"]),
        ("drivelines", &whole["$defs"]["driveline"]),
    ];
    for (folder, part) in parts {
        let files = files_below(&root().join("scenarios").join(folder));
        assert!(!files.is_empty(), "{folder}");
        for path in files {
            if let Err(why) = validate(&whole, part, &read(&path), "") {
                panic!("{}: {why}", path.display());
            }
        }
    }
}

#[test]
fn every_scenario_of_the_documentation_conforms_to_the_schema() {
    let (schema, folder) = (schema(), root().join("scenarios"));
    let mut blocks = crate::blocks();
    blocks.retain(|block| block.mark == "ron scenario");
    assert!(blocks.len() > 5, "{}", blocks.len());
    for block in blocks {
        let name = format!("{}:{}", block.page, block.line);
        let document = Document::of_text(&name, &block.text, &folder).unwrap();
        if let Err(why) = validate(&schema, &schema, &as_json(document.tree(), document.text()), "") {
            panic!("{name}: {why}");
        }
    }
}

fn of_kind(kind: headland::SchemaKind) -> Value {
    headland::schema_of(&headland_stock::registry(), kind)
}

/// Files of a folder and blocks of the documentation with a mark, as JSON with their names.
fn files_and_blocks(folder: &str, mark: &str) -> Vec<(String, Value)> {
    let mut files = files_below(&root().join(folder));
    files.retain(|path| path.parent() == Some(&root().join(folder)));
    let mut all: Vec<(String, Value)> =
        files.iter().map(|path| (path.display().to_string(), read(path))).collect();
    for block in crate::blocks().iter().filter(|block| block.mark == mark) {
        let name = format!("{}:{}", block.page, block.line);
        let document = Document::of_text(&name, &block.text, &root().join("scenarios")).unwrap();
        all.push((name, as_json(document.tree(), document.text())));
    }
    all
}

#[test]
fn every_comparison_conforms_to_its_schema() {
    let schema = of_kind(headland::SchemaKind::Comparison);
    let all = files_and_blocks("scenarios/comparisons", "ron comparison");
    assert!(all.len() > 4, "{}", all.len());
    for (name, comparison) in &all {
        if let Err(why) = validate(&schema, &schema, comparison, "") {
            panic!("{name}: {why}");
        }
    }
    let refused = |pointer: &str, value: Value| {
        let mut wrong = all.iter().find(|(name, _)| name.contains("batch.md")).unwrap().1.clone();
        *wrong.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}")) = value;
        validate(&schema, &schema, &wrong, "").unwrap_err()
    };
    assert!(refused("/variants/0/vehicle/mass_kg", json!("heavy")).contains("variants.0.vehicle.mass_kg"));
    assert!(refused("/repeat/scatter", json!({"vehicle.mass_kg": {"Wide": 3}})).contains(".repeat.scatter"));
    assert!(refused("/sweep", json!({"vehicle.mass_kg": {"Range": [1, 2]}})).contains("minItems"));
    assert!(refused("/report/by", json!(["Fuell"])).contains(".report.by"));
    assert!(refused("/fuel/density_kg_m3", json!(-1)).contains("exclusiveMinimum"));
    assert!(refused("", json!({"abuot": "nothing"})).contains("about"));
}

#[test]
fn every_recording_conforms_to_its_schema() {
    let schema = of_kind(headland::SchemaKind::Recording);
    let all = files_and_blocks("scenarios/recordings", "ron recording");
    assert!(all.len() > 8, "{}", all.len());
    for (name, recording) in &all {
        if let Err(why) = validate(&schema, &schema, recording, "") {
            panic!("{name}: {why}");
        }
    }
    let refused = |text: &str| {
        let document = Document::of_text("test.ron", text, root()).unwrap();
        validate(&schema, &schema, &as_json(document.tree(), document.text()), "").unwrap_err()
    };
    let good = "(about: \"a log\", runs: [(id: \"one\", file: \"one.csv\", use: held_out)], format: csv(delimiter: \";\"))";
    let document = Document::of_text("test.ron", good, root()).unwrap();
    assert_eq!(validate(&schema, &schema, &as_json(document.tree(), document.text()), ""), Ok(()));
    assert!(refused(&good.replace("held_out", "held")).contains(".runs.0.use"));
    assert!(refused(&good.replace("id: \"one\", ", "")).contains("required"));
    assert!(refused(&good.replace("delimiter", "delimeter")).contains("delimeter"));
}

/// Panics where nothing is told of a field.
fn hold(value: &Value, path: &str, told_above: bool) {
    for (name, own) in value.get("properties").and_then(Value::as_object).into_iter().flatten() {
        let path = format!("{path}.{name}");
        let told = own.get("description").and_then(Value::as_str).unwrap_or_default();
        assert!(told_above || !told.is_empty(), "{path}");
        hold(own, &path, false);
    }
    // What is told of a variant stands beside its name, not behind it.
    for inner in value.get("anyOf").and_then(Value::as_array).into_iter().flatten() {
        let told = inner.get("description").and_then(Value::as_str).unwrap_or_default();
        assert!(!told.is_empty(), "{path}: {inner}");
        hold(inner, path, true);
    }
    if let Some(items) = value.get("items") {
        hold(items, path, false);
    }
}

/// Whatever a description may say is told, and nothing else is.
#[test]
fn every_field_of_a_recording_is_told_in_its_schema() {
    let schema = of_kind(headland::SchemaKind::Recording);
    let whole = &schema["$defs"]["recording"];
    hold(whole, "", false);
    for (path, about) in headland_recording::ABOUT.iter().chain(headland_recording::ABOUT_PARTS) {
        let found = path.split('.').try_fold(whole, step).or_else(|| {
            // A variant without anything behind it is a constant.
            let (field, variant) = path.rsplit_once('.')?;
            let choices = field.split('.').try_fold(whole, step)?.get("anyOf")?.as_array()?;
            choices
                .iter()
                .find(|one| one["const"] == json!(variant) || one["properties"].get(variant).is_some())
        });
        let found = found.unwrap_or_else(|| panic!("no `{path}`"));
        let told = found["description"].as_str().unwrap_or_default();
        assert!(
            told.starts_with(about) || found.get("anyOf").is_some() || path.contains("format."),
            "{path}: {told}"
        );
    }
}

#[test]
fn what_the_program_refuses_the_schema_refuses_with_its_place() {
    let schema = schema();
    let whole = read(&root().join("scenarios/ploughing_on_wheels.ron"));
    let refused = |pointer: &str, key: Option<&str>, value: Value| {
        let mut wrong = whole.clone();
        let at = wrong.pointer_mut(pointer).unwrap_or_else(|| panic!("{pointer}"));
        match key {
            Some(key) if value.is_null() => {
                at.as_object_mut().unwrap().remove(key).unwrap();
            }
            Some(key) => {
                at.as_object_mut().unwrap().insert(key.to_owned(), value);
            }
            None => *at = value,
        }
        validate(&schema, &schema, &wrong, "").unwrap_err()
    };
    assert!(refused("/vehicle", Some("mass_kgs"), json!(1)).contains("mass_kgs"));
    assert!(refused("/vehicle", Some("mass_kg"), Value::Null).contains("required"));
    assert!(refused("/vehicle/mass_kg", None, json!("heavy")).contains("pattern"));
    assert!(refused("/vehicle/mass_kg", None, json!([1])).starts_with(".vehicle.mass_kg"));
    assert!(refused("/vehicle/axles/0/tyre/width_m", None, json!(-1)).contains("exclusiveMinimum"));
    assert!(refused("/ground/terrain", None, json!("Flatt")).contains(".ground.terrain"));
    assert!(refused("/simulation/fidelity", None, json!("Rigid")).contains(".simulation.fidelity"));
    assert!(refused("/ground/soil", None, json!({"Constant": {"coefficient": -1}})).contains("minimum"));
    assert!(
        refused("", Some("cycle"), json!([{"Hold": {"for_s": 1, "unitl": "Stopped"}}])).contains("unitl")
    );
}

/// Whatever a card tells of has its place in the schema.
#[test]
fn every_parameter_of_every_model_is_in_the_schema() {
    let (schema, registry) = (schema(), headland_stock::registry());
    for kind in headland_plugin::Kind::ALL {
        for card in registry.cards(kind) {
            let choices = schema["$defs"][kind.name()]["anyOf"].as_array().unwrap();
            let own = choices.iter().find_map(|one| one["properties"].get(card.name)).unwrap();
            for parameter in card.parameters {
                let found = parameter.name.split('.').try_fold(own, step);
                let found = found.unwrap_or_else(|| panic!("{}: {}", card.name, parameter.name));
                let told = found["description"].as_str().unwrap_or_default();
                assert!(told.starts_with(parameter.about), "{}: {}: {told}", card.name, parameter.name);
            }
        }
    }
}

fn step<'a>(schema: &'a Value, name: &str) -> Option<&'a Value> {
    if let Some(found) = schema.get("properties").and_then(|own| own.get(name)) {
        return Some(found);
    }
    if let Some(items) = schema.get("items") {
        return step(items, name);
    }
    schema.get("anyOf")?.as_array()?.iter().find_map(|one| {
        let inner = one.get("properties")?.as_object()?.values().next()?;
        step(inner, name).or_else(|| step(one, name))
    })
}

/// A snippet with its places filled in reads as RON.
#[test]
fn snippets_are_ron_once_their_places_are_filled_in() {
    let snippets = headland::snippets(&headland_stock::registry());
    let snippets = snippets.as_object().unwrap();
    assert!(snippets.len() > 90, "{}", snippets.len());
    for (name, snippet) in snippets {
        let lines: Vec<&str> =
            snippet["body"].as_array().unwrap().iter().map(|line| line.as_str().unwrap()).collect();
        let body = filled(&lines.join("\n"));
        let read = ron::from_str::<ron::Value>(&format!("({body})")).or_else(|_| ron::from_str(&body));
        assert!(read.is_ok(), "{name}: {body}\n{read:?}");
    }
}

/// A text with `1` in each place, or the first of its choices.
fn filled(body: &str) -> String {
    let mut text = String::new();
    let mut rest = body;
    while let Some((before, place)) = rest.split_once("${") {
        text.push_str(before);
        let end = (0..place.len())
            .find(|at| place[*at..].starts_with('}') && !place[..*at].ends_with('\\'))
            .unwrap();
        let choice = place[..end].split_once('|').map(|(_, words)| words.split([',', '|']).next().unwrap());
        text.push_str(choice.unwrap_or("1"));
        rest = &place[end + 1..];
    }
    text + rest
}
