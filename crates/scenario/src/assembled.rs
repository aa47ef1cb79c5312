//! Documents that are put together from pieces of others, each of which still knows where it came from.

use crate::document::{Builder, Document};
use crate::error::ScenarioError;
use crate::fault;
use crate::tree::Node;
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// A piece of a text that is put together.
#[derive(Clone, Debug)]
pub enum Piece<'a> {
    /// Words that stand in no file.
    Own(String),
    /// A stretch of the resolved text of a document.
    Of(&'a Document, Range<usize>),
}

impl Document {
    /// A document made of pieces, one after the other; it has the folder and the main file of this one.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where the pieces together are no RON.
    pub fn assembled(&self, pieces: &[Piece<'_>]) -> Result<Self, ScenarioError> {
        let mut builder = Builder::default();
        for piece in pieces {
            self.add(&mut builder, piece);
        }
        builder.document(self.folder().to_owned(), Arc::clone(&self.main))
    }

    /// A copy in which some stretches of the text are other pieces.
    ///
    /// # Errors
    /// As [`Document::assembled`].
    pub fn edited(&self, mut edits: Vec<(Range<usize>, Piece<'_>)>) -> Result<Self, ScenarioError> {
        edits.sort_by_key(|(span, _)| span.start);
        let mut builder = Builder::default();
        let mut at = 0;
        for (span, piece) in edits {
            self.copy(&mut builder, at..span.start);
            self.add(&mut builder, &piece);
            at = span.end;
        }
        self.copy(&mut builder, at..self.text().len());
        builder.document(self.folder().to_owned(), Arc::clone(&self.main))
    }

    fn add(&self, builder: &mut Builder, piece: &Piece<'_>) {
        match piece {
            Piece::Own(text) => builder.push(text, &self.main, 0, true),
            Piece::Of(document, range) => document.copy(builder, range.clone()),
        }
    }

    /// Reads a piece of the text; `of` is what errors call it.
    ///
    /// # Errors
    /// [`ScenarioError`] where it does not fit, with its place.
    pub fn part<T: DeserializeOwned>(&self, node: &Node, of: &str) -> Result<T, ScenarioError> {
        ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_str(&self.text()[node.span.clone()])
            .map_err(|error| fault::tell(self, node, of, &error))
    }

    /// Path and text of every file that the document was read from, the main one first.
    pub fn sources(&self) -> Vec<(&Path, &str)> {
        let mut all = vec![&self.main];
        for segment in &self.segments {
            if !all.iter().any(|source| Arc::ptr_eq(source, &segment.source)) {
                all.push(&segment.source);
            }
        }
        all.into_iter().map(|source| (source.path.as_path(), source.text.as_str())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str, text: &str) -> Document {
        Document::of_text(name, text, Path::new("")).unwrap()
    }

    #[test]
    fn pieces_of_two_documents_make_one_and_keep_their_places() {
        let main = of("main.ron", "(\n  a: 1,\n  b: (c: 2))");
        let other = of("other.ron", "(\n\n  speed_m_s: \"36 km/h\")");
        let (b, speed) = (main.find("b").unwrap(), other.find("speed_m_s").unwrap());
        let whole = main
            .assembled(&[
                Piece::Own("(x: ".to_owned()),
                Piece::Of(&main, b.span.clone()),
                Piece::Own(", y: ".to_owned()),
                Piece::Of(&other, speed.span.clone()),
                Piece::Own(")".to_owned()),
            ])
            .unwrap();
        assert_eq!((whole.number("x.c"), whole.number("y")), (Some(2.0), Some(10.0)));
        let at = whole.location(whole.find("y").unwrap().span.start);
        assert_eq!((at.path.to_str(), at.line), (Some("other.ron"), 3));
        let names: Vec<_> = whole.sources().iter().map(|(path, _)| path.display().to_string()).collect();
        assert_eq!(names, ["main.ron", "other.ron"]);
    }

    #[test]
    fn an_edit_of_a_stretch_brings_the_place_of_what_is_put_in() {
        let main = of("main.ron", "(a: 1, b: 2)");
        let other = of("other.ron", "(\n a: oops)");
        let edits = vec![
            (main.find("b").unwrap().span.clone(), Piece::Own("7".to_owned())),
            (main.find("a").unwrap().span.clone(), Piece::Of(&other, other.find("a").unwrap().span.clone())),
        ];
        let whole = main.edited(edits).unwrap();
        assert_eq!(whole.text(), "(a: oops, b: 7)");
        assert_eq!(whole.location(4).path, Path::new("other.ron"));
        assert!(whole.part::<f64>(whole.find("a").unwrap(), "a").is_err());
        assert_eq!(whole.part::<f64>(whole.find("b").unwrap(), "b").unwrap(), 7.0);
    }
}
