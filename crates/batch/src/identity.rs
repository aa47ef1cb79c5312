//! What a batch is: the parts of its comparison on which results depend, without comments and layout.

use crate::comparison::Comparison;
use crate::draw::{BASIS, hash};
use crate::entry::Entry;
use crate::journal::Identity;
use headland_scenario::{Document, Node, Shape};
use std::ops::Range;
use std::path::Path;

/// Parts of a comparison that no result depends on.
const NO_PART: [&str; 5] = ["about", "report", "variants", "cycles", "grounds"];

impl Comparison {
    /// The parts of the comparison and their hashes, with the seed of the command line.
    pub fn identity(&self, seed: u64) -> Identity {
        let document = self.document();
        let mut identity = vec![
            ("the version of Headland".to_owned(), of_text(env!("CARGO_PKG_VERSION"))),
            ("--seed".to_owned(), seed),
        ];
        let lists = [
            ("variant", "variants", &self.variants),
            ("cycle", "cycles", &self.cycles),
            ("ground", "grounds", &self.grounds),
        ];
        for (one, list, entries) in lists {
            let nodes = match document.find(list).map(|node| &node.shape) {
                Some(Shape::List(nodes)) => nodes.as_slice(),
                _ => &[],
            };
            for (entry, node) in entries.iter().zip(nodes) {
                identity.push((format!("{one} `{}`", entry.name), of_entry(document, entry, node)));
            }
        }
        if let Shape::Struct { fields, .. } = &document.tree().shape {
            for field in fields.iter().filter(|field| !NO_PART.contains(&field.key.as_str())) {
                identity.push((format!("`{}`", field.key), of_node(document, &field.value, BASIS)));
            }
        }
        let mut folder = document.folder().to_owned();
        if let Some(Node { shape: Shape::Text(named), .. }) = document.find("folder") {
            folder.push(named);
        }
        files(document.tree(), &folder, &mut identity);
        identity
    }
}

fn of_text(text: &str) -> u64 {
    hash(BASIS, text.as_bytes())
}

fn of_entry(document: &Document, entry: &Entry, node: &Node) -> u64 {
    of_node(document, node, of_text(&entry.name))
}

/// Hash of what a piece says: names, texts and words, with its brackets.
fn of_node(document: &Document, node: &Node, from: u64) -> u64 {
    let name = |hash_so_far: u64, name: &Option<Range<usize>>| match name {
        Some(name) => hash(hash_so_far, document.text()[name.clone()].as_bytes()),
        None => hash_so_far,
    };
    match &node.shape {
        Shape::Struct { name: own, fields } => {
            let begin = hash(name(from, own), b"(");
            let inside = fields.iter().fold(begin, |so_far, field| {
                of_node(document, &field.value, hash(hash(so_far, field.key.as_bytes()), b":"))
            });
            hash(inside, b")")
        }
        Shape::Tuple { name: own, values } => {
            let begin = hash(name(from, own), b"(");
            hash(
                values.iter().fold(begin, |so_far, value| of_node(document, value, hash(so_far, b","))),
                b")",
            )
        }
        Shape::List(values) => {
            let begin = hash(from, b"[");
            hash(
                values.iter().fold(begin, |so_far, value| of_node(document, value, hash(so_far, b","))),
                b"]",
            )
        }
        Shape::Map(entries) => {
            let begin = hash(from, b"{");
            let inside = entries.iter().fold(begin, |so_far, (key, value)| {
                of_node(document, value, hash(of_node(document, key, so_far), b":"))
            });
            hash(inside, b"}")
        }
        Shape::Text(text) => hash(hash(hash(from, b"\""), text.as_bytes()), b"\""),
        Shape::Word => hash(from, document.text()[node.span.clone()].as_bytes()),
    }
}

/// Files that texts of the comparison name, as a terrain does: their content counts too.
fn files(node: &Node, folder: &Path, identity: &mut Identity) {
    if let Shape::Text(text) = &node.shape
        && !text.is_empty()
        && let path = folder.join(text)
        && path.is_file()
        && let Ok(bytes) = std::fs::read(&path)
    {
        let name = format!("the file {text}");
        if !identity.iter().any(|(other, _)| *other == name) {
            identity.push((name, hash(BASIS, &bytes)));
        }
    }
    for child in crate::combine::children(node) {
        files(child, folder, identity);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity(text: &str, folder: &Path) -> Identity {
        Comparison::of_text("test.ron", text, folder).unwrap().identity(1)
    }

    const TEXT: &str =
        "(about: \"x\", variants: [(name: \"a\", vehicle: (mass_kg: 1))], sweep: {\"m\": [1, 2]})";

    #[test]
    fn layout_comments_and_the_report_are_no_part_of_it() {
        let same = "(about: \"y\", // a remark\n variants: [(name: \"a\", vehicle: (mass_kg:   1))],\n \
                    sweep: {\"m\": [1, 2]}, report: (by: [Time]))";
        assert_eq!(identity(TEXT, Path::new("")), identity(same, Path::new("")));
    }

    #[test]
    fn every_other_change_shows_where_it_is() {
        for (from, to, part) in [
            ("mass_kg: 1", "mass_kg: 2", "variant `a`"),
            ("[1, 2]", "[1, 3]", "`sweep`"),
            ("[1, 2]", "[12]", "`sweep`"),
        ] {
            let (before, after) =
                (identity(TEXT, Path::new("")), identity(&TEXT.replace(from, to), Path::new("")));
            let changed: Vec<_> = before.iter().zip(&after).filter(|(one, other)| one != other).collect();
            assert_eq!(changed.len(), 1, "{to}");
            assert_eq!(changed[0].0.0, part);
        }
    }

    #[test]
    fn a_file_that_the_comparison_names_is_part_of_it() {
        let folder = tempfile::tempdir().unwrap();
        let text = TEXT.replace("mass_kg: 1", "file: \"path.csv\"");
        std::fs::write(folder.path().join("path.csv"), "1").unwrap();
        let before = identity(&text, folder.path());
        std::fs::write(folder.path().join("path.csv"), "2").unwrap();
        let after = identity(&text, folder.path());
        assert_eq!(before.last().unwrap().0, "the file path.csv");
        assert_ne!(before.last(), after.last());
    }
}
