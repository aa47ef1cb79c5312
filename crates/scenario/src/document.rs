//! A RON file with its includes and its quantities resolved, that still knows where every character came from.
//!
//! `include("file.ron")` is replaced by that file, and a text in a field whose name ends in a unit (`speed_m_s:
//! "30 km/h"`) by the number. What is left is plain RON for `serde`; positions of its errors lead back to the file.

use crate::error::{Location, ScenarioError};
use crate::scenario::AskedInputs;
use crate::tree::{Field, Node, Shape, parse};
use headland_units::{QuantityError, Unit, parse_difference, parse_quantity, unit_of_name};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file that was read.
#[derive(Debug, PartialEq)]
pub struct Source {
    /// Where it lies.
    pub path: PathBuf,
    /// What it holds.
    pub text: String,
}

/// A stretch of the resolved text and where it was copied from.
#[derive(Clone, Debug)]
pub(crate) struct Segment {
    start: usize,
    pub(crate) source: Arc<Source>,
    origin: usize,
    /// Whether the stretch stands for the text at its origin rather than being a copy of it.
    replaced: bool,
}

/// A resolved RON text.
#[derive(Clone, Debug)]
pub struct Document {
    text: String,
    pub(crate) segments: Vec<Segment>,
    tree: Node,
    folder: PathBuf,
    pub(crate) main: Arc<Source>,
}

/// How deep includes may nest.
const DEEPEST_INCLUDE: usize = 16;

impl Document {
    /// Reads a file and everything that it includes.
    ///
    /// # Errors
    /// [`ScenarioError`]: unreadable, not UTF-8, empty, not RON, a circle of includes, a quantity that does not fit.
    pub fn read(path: &Path) -> Result<Self, ScenarioError> {
        let mut builder = Builder { text: String::new(), segments: Vec::new() };
        let main = builder.file(path, None, &mut Vec::new())?;
        let folder = path.parent().map(Path::to_owned).unwrap_or_default();
        builder.document(folder, main)
    }

    /// Resolves a text that lies in no file; `name` stands for the file in messages.
    ///
    /// # Errors
    /// As [`Document::read`].
    pub fn of_text(name: &str, text: &str, folder: &Path) -> Result<Self, ScenarioError> {
        let source = Arc::new(Source { path: PathBuf::from(name), text: text.to_owned() });
        let mut builder = Builder { text: String::new(), segments: Vec::new() };
        builder.source(&source, folder, &mut Vec::new())?;
        builder.document(folder.to_owned(), source)
    }

    /// The resolved text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The shape of the resolved text.
    pub fn tree(&self) -> &Node {
        &self.tree
    }

    /// The folder that relative paths of the scenario start from.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The file that was asked for.
    pub fn path(&self) -> &Path {
        &self.main.path
    }

    /// The piece at a dotted path.
    pub fn find(&self, path: &str) -> Option<&Node> {
        self.tree.find(&self.text, path)
    }

    /// The number at a dotted path.
    pub fn number(&self, path: &str) -> Option<f64> {
        self.text[self.find(path)?.span.clone()].replace('_', "").parse().ok()
    }

    /// Where a byte of the resolved text came from.
    pub fn location(&self, at: usize) -> Location {
        let index = self.segments.partition_point(|segment| segment.start <= at).saturating_sub(1);
        let Some(segment) = self.segments.get(index) else {
            return Location::of(&self.main.path, &self.main.text, 0, 1);
        };
        let offset = segment.origin + if segment.replaced { 0 } else { at - segment.start };
        let width = self.width(at);
        Location::of(&segment.source.path, &segment.source.text, offset, width)
    }

    /// Length of the word that starts at a byte, for the line of carets.
    fn width(&self, at: usize) -> usize {
        let rest = self.text.get(at..).unwrap_or("");
        rest.chars().take_while(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '-')).count().max(1)
    }

    /// A copy in which the values at some paths are other numbers.
    ///
    /// # Errors
    /// [`ScenarioError::NoSuchPath`] where a path leads nowhere.
    pub fn with(&self, changes: &[(&str, f64)]) -> Result<Self, ScenarioError> {
        let changes: Vec<(&str, String)> =
            changes.iter().map(|(path, value)| (*path, format!("{value:?}"))).collect();
        self.replaced(&changes)
    }

    /// A copy in which the values at some paths are other pieces of RON.
    ///
    /// # Errors
    /// [`ScenarioError::NoSuchPath`] where a path leads nowhere, or what [`Document::of_text`] refuses.
    pub fn replaced(&self, changes: &[(&str, String)]) -> Result<Self, ScenarioError> {
        let mut edits: Vec<(Range<usize>, &str)> = Vec::new();
        for (path, value) in changes {
            let node =
                self.find(path).ok_or_else(|| ScenarioError::NoSuchPath { path: (*path).to_owned() })?;
            edits.push((node.span.clone(), value));
        }
        edits.sort_by_key(|(span, _)| span.start);
        let mut builder = Builder { text: String::new(), segments: Vec::new() };
        let mut at = 0;
        for (span, value) in edits {
            self.copy(&mut builder, at..span.start);
            let index =
                self.segments.partition_point(|segment| segment.start <= span.start).saturating_sub(1);
            let segment = &self.segments[index];
            let origin = segment.origin + if segment.replaced { 0 } else { span.start - segment.start };
            builder.push(value, &segment.source, origin, true);
            at = span.end;
        }
        self.copy(&mut builder, at..self.text.len());
        builder.document(self.folder.clone(), Arc::clone(&self.main))
    }

    /// The one dotted path at which a parameter lies: the path itself, or the only field of that name.
    ///
    /// # Errors
    /// [`ScenarioError::NoSuchPath`] where there is none, or more than one.
    pub fn resolve(&self, name: &str) -> Result<String, ScenarioError> {
        if self.find(name).is_some() {
            return Ok(name.to_owned());
        }
        let mut found = Vec::new();
        paths_of(&self.tree, &self.text, name, "", &mut found);
        match found.len() {
            1 => Ok(found.remove(0)),
            _ => Err(ScenarioError::NoSuchPath { path: name.to_owned() }),
        }
    }

    /// A copy that holds one more effect.
    ///
    /// # Errors
    /// What [`Document::of_text`] refuses.
    pub fn with_effect(&self, effect: &str) -> Result<Self, ScenarioError> {
        match self.find("effects") {
            Some(Node { shape: Shape::List(values), span }) => match values.last() {
                Some(last) => self.inserted(last.span.end, &format!(", {effect}")),
                None => self.inserted(span.start + 1, effect),
            },
            _ => self.with_field("effects", &format!("[{effect}]")),
        }
    }

    /// A copy whose replay is told just these recorded circumstances.
    ///
    /// # Errors
    /// What [`Document::of_text`] refuses.
    pub fn with_inputs(&self, asked: &AskedInputs) -> Result<Self, ScenarioError> {
        let all = asked.all.then(|| "All".to_owned());
        let names: Vec<String> =
            all.into_iter().chain(asked.listed.iter().map(|input| format!("{input:?}"))).collect();
        let list = format!("[{}]", names.join(", "));
        if self.find("replay.inputs").is_some() {
            return self.replaced(&[("replay.inputs", list)]);
        }
        match self.find("replay") {
            Some(Node { shape: Shape::Struct { fields, .. }, .. }) if !fields.is_empty() => {
                self.inserted(fields[fields.len() - 1].value.span.end, &format!(", inputs: {list}"))
            }
            Some(_) => self.replaced(&[("replay", format!("(inputs: {list})"))]),
            None => self.with_field("replay", &format!("(inputs: {list})")),
        }
    }

    /// A copy with another field behind all others.
    fn with_field(&self, name: &str, value: &str) -> Result<Self, ScenarioError> {
        match &self.tree.shape {
            Shape::Struct { fields, .. } => {
                let end = fields.last().map_or(self.tree.span.end - 1, |field| field.value.span.end);
                self.inserted(end, &format!(",\n    {name}: {value}"))
            }
            _ => Ok(self.clone()),
        }
    }

    fn inserted(&self, at: usize, piece: &str) -> Result<Self, ScenarioError> {
        let mut builder = Builder { text: String::new(), segments: Vec::new() };
        self.copy(&mut builder, 0..at);
        let origin = self.main.text.len();
        builder.push(piece, &self.main, origin, true);
        self.copy(&mut builder, at..self.text.len());
        builder.document(self.folder.clone(), Arc::clone(&self.main))
    }

    pub(crate) fn copy(&self, builder: &mut Builder, range: Range<usize>) {
        let mut at = range.start;
        let mut index = self.segments.partition_point(|segment| segment.start <= at).saturating_sub(1);
        while at < range.end {
            let end = self.segments.get(index + 1).map_or(range.end, |next| next.start.min(range.end));
            let segment = &self.segments[index];
            let origin = segment.origin + if segment.replaced { 0 } else { at - segment.start };
            builder.push(&self.text[at..end], &segment.source, origin, segment.replaced);
            at = end;
            index += 1;
        }
    }
}

/// Collects the paths of all fields of a name, `free` and `runs` left out: they speak of parameters elsewhere; and
/// `candidates`, which do not act.
fn paths_of(node: &Node, text: &str, name: &str, prefix: &str, found: &mut Vec<String>) {
    let join = |key: &str| if prefix.is_empty() { key.to_owned() } else { format!("{prefix}.{key}") };
    match &node.shape {
        Shape::Struct { fields, .. } => {
            for field in fields {
                if prefix.is_empty()
                    && ["free", "runs", "replay", "start", "cycle", "candidates"]
                        .contains(&field.key.as_str())
                {
                    continue;
                }
                let path = join(&field.key);
                if field.key == name {
                    found.push(path.clone());
                }
                paths_of(&field.value, text, name, &path, found);
            }
        }
        Shape::List(values) => {
            for (index, value) in values.iter().enumerate() {
                let key = value.name(text).map_or_else(|| index.to_string(), str::to_owned);
                paths_of(value, text, name, &join(&key), found);
            }
        }
        _ => {}
    }
}

#[derive(Default)]
pub(crate) struct Builder {
    text: String,
    segments: Vec<Segment>,
}

impl Builder {
    pub(crate) fn push(&mut self, text: &str, source: &Arc<Source>, origin: usize, replaced: bool) {
        if text.is_empty() {
            return;
        }
        self.segments.push(Segment { start: self.text.len(), source: Arc::clone(source), origin, replaced });
        self.text.push_str(text);
    }

    pub(crate) fn document(self, folder: PathBuf, main: Arc<Source>) -> Result<Document, ScenarioError> {
        let Self { text, segments } = self;
        match parse(&text) {
            Ok(tree) => Ok(Document { text, segments, tree, folder, main }),
            Err(broken) => Err(ScenarioError::Syntax {
                found: broken.found,
                expected: broken.expected.to_owned(),
                at: Location::of(&main.path, &main.text, broken.at.min(main.text.len()), 1),
            }),
        }
    }

    fn file(
        &mut self,
        path: &Path,
        from: Option<&Location>,
        open: &mut Vec<PathBuf>,
    ) -> Result<Arc<Source>, ScenarioError> {
        let unreadable =
            |reason: String| ScenarioError::File { path: path.to_owned(), reason, at: from.cloned() };
        let bytes = if path.is_dir() {
            return Err(unreadable("is a folder, expected a RON file".to_owned()));
        } else {
            std::fs::read(path).map_err(|error| unreadable(error.to_string()))?
        };
        let text = String::from_utf8(bytes).map_err(|error| {
            let good = String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]);
            let (line, column) =
                (good.matches('\n').count() + 1, good.lines().last().unwrap_or("").chars().count() + 1);
            let column = if good.ends_with('\n') { 1 } else { column };
            let byte = error.as_bytes()[error.utf8_error().valid_up_to()];
            unreadable(format!(
                "found the byte 0x{byte:02X} in line {line}, column {column}, expected UTF-8 text"
            ))
        })?;
        let text = text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text);
        let text = with_line_feeds(text);
        if text.trim().is_empty() {
            return Err(unreadable("is empty, expected a RON value in parentheses".to_owned()));
        }
        let identity = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        if open.contains(&identity) || open.len() >= DEEPEST_INCLUDE {
            return Err(unreadable("includes itself".to_owned()));
        }
        let source = Arc::new(Source { path: path.to_owned(), text });
        open.push(identity);
        let folder = path.parent().unwrap_or(Path::new(""));
        self.source(&source, folder, open)?;
        open.pop();
        Ok(source)
    }

    fn source(
        &mut self,
        source: &Arc<Source>,
        folder: &Path,
        open: &mut Vec<PathBuf>,
    ) -> Result<(), ScenarioError> {
        let tree = parse(&source.text).map_err(|broken| ScenarioError::Syntax {
            found: broken.found,
            expected: broken.expected.to_owned(),
            at: Location::of(&source.path, &source.text, broken.at, 1),
        })?;
        let mut replacements = Vec::new();
        collect(&tree, None, source, &mut replacements)?;
        let mut at = 0;
        for (span, replacement) in replacements {
            self.push(&source.text[at..span.start], source, at, false);
            match replacement {
                Replacement::Number(value) => self.push(&format!("{value:?}"), source, span.start, true),
                Replacement::File(name) => {
                    let from = Location::of(&source.path, &source.text, span.start, span.len());
                    self.file(&folder.join(name), Some(&from), open)?;
                }
            }
            at = span.end;
        }
        self.push(&source.text[at..], source, at, false);
        Ok(())
    }
}

enum Replacement {
    Number(f64),
    File(String),
}

/// Finds quantities and includes, in the order in which they stand. `unit` is that of the field around.
fn collect(
    node: &Node,
    unit: Option<&Unit>,
    source: &Arc<Source>,
    found: &mut Vec<(Range<usize>, Replacement)>,
) -> Result<(), ScenarioError> {
    match &node.shape {
        Shape::Struct { fields, .. } => {
            let named = named_unit(fields);
            for field in fields {
                let of_name = unit_of_name(&field.key);
                let own = match field.key.as_str() {
                    "value" | "bounds" => named.clone(),
                    // A spread is a difference: the zero of a scale cancels.
                    "sd" => {
                        if let (Some(unit), Shape::Text(text)) = (&named, &field.value.shape) {
                            let value = parse_difference(text, unit)
                                .map_err(|error| refused(error, &field.value, source))?;
                            found.push((field.value.span.clone(), Replacement::Number(value)));
                        }
                        continue;
                    }
                    _ => None,
                };
                collect(&field.value, own.or(of_name).as_ref(), source, found)?;
            }
        }
        Shape::Tuple { name, values } => {
            if let Some(name) = name
                && &source.text[name.clone()] == "include"
            {
                return match values.as_slice() {
                    [Node { shape: Shape::Text(file), .. }] => {
                        found.push((node.span.clone(), Replacement::File(file.clone())));
                        Ok(())
                    }
                    _ => Err(ScenarioError::Syntax {
                        found: source.text[node.span.clone()].to_owned(),
                        expected: "include(\"file.ron\")".to_owned(),
                        at: Location::of(&source.path, &source.text, node.span.start, node.span.len()),
                    }),
                };
            }
            for value in values {
                collect(value, unit, source, found)?;
            }
        }
        Shape::List(values) => {
            for value in values {
                collect(value, unit, source, found)?;
            }
        }
        Shape::Map(entries) => {
            for (key, value) in entries {
                let unit = match &key.shape {
                    Shape::Text(key) => unit_of_name(key),
                    _ => None,
                };
                collect(value, unit.as_ref(), source, found)?;
            }
        }
        Shape::Text(text) => {
            if let Some(unit) = unit {
                let value = parse_quantity(text, unit).map_err(|error| refused(error, node, source))?;
                found.push((node.span.clone(), Replacement::Number(value)));
            }
        }
        Shape::Word => {}
    }
    Ok(())
}

/// The unit of the number that a free parameter names: `value`, `sd` and `bounds` beside the name are of it.
fn named_unit(fields: &[Field]) -> Option<Unit> {
    let name = fields.iter().find(|field| field.key == "name")?;
    match &name.value.shape {
        Shape::Text(path) => unit_of_name(path),
        _ => None,
    }
}

fn refused(error: QuantityError, node: &Node, source: &Source) -> ScenarioError {
    ScenarioError::Quantity {
        error,
        at: Location::of(&source.path, &source.text, node.span.start, node.span.len()),
    }
}

/// Old machines end a line with CR alone. Lines are counted by line feeds, so those become some; no byte moves.
fn with_line_feeds(text: String) -> String {
    if !text.contains('\r') {
        return text;
    }
    let next = text.chars().skip(1).map(Some).chain([None]);
    let fed = |(letter, next)| if letter == '\r' && next != Some('\n') { '\n' } else { letter };
    text.chars().zip(next).map(fed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Document {
        Document::of_text("test.ron", text, Path::new("")).unwrap()
    }

    #[test]
    fn quantities_become_numbers_of_the_unit_of_the_name() {
        let document = of(
            "(speed_m_s: \"36 km/h\", about: \"36 km/h\", points_m: [\"1 km\", 5], with: {\"a.mass_kg\": \"2 t\"})",
        );
        assert_eq!(document.number("speed_m_s"), Some(10.0));
        assert_eq!(document.number("points_m.0"), Some(1000.0));
        assert!(
            document.text().contains("about: \"36 km/h\"")
                && document.text().contains("\"a.mass_kg\": 2000.0")
        );
    }

    #[test]
    fn a_free_parameter_takes_the_unit_of_what_it_names() {
        let document = of(
            "(free: [(name: \"vehicle.mass_kg\", value: \"13 t\", sd: \"65 kg\", bounds: (\"12 t\", 14000)), \
              (name: \"air.temperature_c\", sd: \"9 °F\")])",
        );
        for (path, expected) in [
            ("free.0.value", 13_000.0),
            ("free.0.sd", 65.0),
            ("free.0.bounds.0", 12_000.0),
            ("free.1.sd", 5.0),
        ] {
            assert!((document.number(path).unwrap() - expected).abs() < 1e-9, "{path}");
        }
        let broken = "(free: [(name: \"vehicle.mass_kg\", sd: \"7 m\")])";
        let error = Document::of_text("test.ron", broken, Path::new("")).unwrap_err();
        assert_eq!(error.location().unwrap().column, 39);
    }

    #[test]
    fn positions_behind_a_replacement_still_lead_to_the_file() {
        let text = "(\n  speed_m_s: \"36 km/h\", mass: oops,\n)";
        let document = of(text);
        let location = document.location(document.find("mass").unwrap().span.start);
        assert_eq!((location.line, location.column), (2, 31));
        assert_eq!(text.lines().nth(1).unwrap().chars().nth(30), Some('o'));
    }

    #[test]
    fn a_quantity_that_does_not_fit_is_refused_where_it_stands() {
        let error = Document::of_text("test.ron", "(\n mass_kg: \"3 km\")", Path::new("")).unwrap_err();
        let at = error.location().unwrap();
        assert_eq!((at.line, at.column), (2, 11));
        assert!(error.to_string().contains("`km`") && error.to_string().contains("kg"), "{error}");
    }

    #[test]
    fn includes_are_read_from_the_folder_of_the_including_file() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("vehicles")).unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("main.ron", "(vehicle: include(\"vehicles/a.ron\"), x: 1)");
        write("vehicles/a.ron", "(tyre: include(\"tyre.ron\"),\n mass_kg: \"1 t\")");
        write("vehicles/tyre.ron", "// wide\n(width_m: \"90 cm\")");
        let document = Document::read(&folder.path().join("main.ron")).unwrap();
        assert_eq!(document.number("vehicle.tyre.width_m"), Some(0.9));
        let at = document.location(document.find("vehicle.mass_kg").unwrap().span.start);
        assert!(at.path.ends_with("vehicles/a.ron"));
        assert_eq!((at.line, at.column), (2, 11));
        write("vehicles/tyre.ron", "include(\"a.ron\")");
        let error = Document::read(&folder.path().join("main.ron")).unwrap_err();
        assert!(error.to_string().contains("includes itself"), "{error}");
        write("main.ron", "(vehicle: include(\"nowhere.ron\"))");
        let error = Document::read(&folder.path().join("main.ron")).unwrap_err();
        assert_eq!(error.location().unwrap().column, 11);
    }

    #[test]
    fn other_numbers_can_be_put_in_and_positions_stay() {
        let document = of("(a: (b: 1, c: \"x\"), d_m: \"1 km\", e: 2)");
        let changed = document.with(&[("e", 0.25), ("a.b", -3.0)]).unwrap();
        assert_eq!(
            (changed.number("a.b"), changed.number("d_m"), changed.number("e")),
            (Some(-3.0), Some(1000.0), Some(0.25))
        );
        assert_eq!(changed.location(changed.find("e").unwrap().span.start).column, 37);
        assert!(matches!(document.with(&[("a.z", 0.0)]), Err(ScenarioError::NoSuchPath { .. })));
    }
}
