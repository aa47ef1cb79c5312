//! A place in a file, with enough of the file to show it.

use std::fmt;
use std::path::{Path, PathBuf};

/// A place in a file that a person wrote.
#[derive(Clone, Debug, PartialEq)]
pub struct Location {
    /// The file, as it was named.
    pub path: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Characters that are meant, from the column on.
    pub width: usize,
    /// The whole line.
    pub excerpt: String,
}

impl Location {
    /// The place at a byte of a text, `width` bytes wide.
    pub fn of(path: &Path, text: &str, offset: usize, width: usize) -> Self {
        let mut offset = offset.min(text.len());
        while !text.is_char_boundary(offset) {
            offset -= 1;
        }
        let start = text[..offset].rfind('\n').map_or(0, |at| at + 1);
        let end = text[offset..].find('\n').map_or(text.len(), |at| offset + at);
        let mut last = (offset + width).min(end).max(offset);
        while !text.is_char_boundary(last) {
            last += 1;
        }
        Self {
            path: path.to_owned(),
            line: text[..offset].matches('\n').count() + 1,
            column: text[start..offset].chars().count() + 1,
            width: text[offset..last].chars().count().max(1),
            excerpt: text[start..end].trim_end_matches('\r').to_owned(),
        }
    }

    /// The line with carets below what is meant, and a note beside them.
    pub fn shown(&self, note: &str) -> String {
        let number = self.line.to_string();
        let margin = " ".repeat(number.len());
        // Tabs stay tabs, so that the carets stand below their characters.
        let lead: String =
            self.excerpt.chars().take(self.column - 1).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        let carets = "^".repeat(self.width);
        let gap = if note.is_empty() { "" } else { " " };
        format!("  {self}\n{number} | {}\n{margin} | {lead}{carets}{gap}{note}", self.excerpt)
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.path.display(), self.line, self.column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn carets_stand_below_what_is_meant() {
        let text = "(\n\tgröße: oops, x: 1\r\n)";
        let at = Location::of(Path::new("a.ron"), text, text.find("oops").unwrap(), 4);
        assert_eq!((at.line, at.column, at.width), (2, 9, 4));
        assert_eq!(at.shown("what?"), "  a.ron:2:9\n2 | \tgröße: oops, x: 1\n  | \t       ^^^^ what?");
    }

    #[test]
    fn the_end_of_a_text_is_a_place_too() {
        let at = Location::of(Path::new("a.ron"), "(\n", 9, 1);
        assert_eq!((at.line, at.column, at.width), (2, 1, 1));
    }
}
