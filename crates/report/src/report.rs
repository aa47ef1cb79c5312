//! A report: sections of plots, tables and words.

use crate::{Figure, Kind, Plot, ReportError, Table, html};
use std::fs;
use std::path::Path;

/// One thing to look at.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A plot.
    Plot(Plot),
    /// A table.
    Table(Table),
    /// A paragraph.
    Words(String),
    /// Sentences that stand each for itself.
    Sentences(Vec<String>),
    /// Key numbers.
    Figures(Vec<Figure>),
}

impl From<Plot> for Item {
    fn from(plot: Plot) -> Self {
        Self::Plot(plot)
    }
}

impl From<Table> for Item {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

impl From<Vec<Figure>> for Item {
    fn from(figures: Vec<Figure>) -> Self {
        Self::Figures(figures)
    }
}

impl From<Vec<String>> for Item {
    fn from(sentences: Vec<String>) -> Self {
        Self::Sentences(sentences)
    }
}

/// A part of a report, listed in its table of contents. Its plots over time zoom together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Title.
    pub title: String,
    /// A paragraph that begins it; may be empty.
    pub words: String,
    /// What it holds.
    pub items: Vec<Item>,
}

impl Section {
    /// An empty section.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Begins with a paragraph.
    #[must_use]
    pub fn words(mut self, words: impl Into<String>) -> Self {
        self.words = words.into();
        self
    }

    /// With one more item at its end.
    #[must_use]
    pub fn with(mut self, item: impl Into<Item>) -> Self {
        self.items.push(item.into());
        self
    }

    /// Least and greatest time of its plots over time.
    pub(crate) fn time_range(&self) -> Option<(f64, f64)> {
        self.items
            .iter()
            .filter_map(|item| match item {
                Item::Plot(Plot { kind: Kind::Lines(lines), .. }) => lines.time_range(),
                _ => None,
            })
            .reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
    }
}

/// A page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Title.
    pub title: String,
    /// One or two sentences that say what was found; may be empty.
    pub lede: String,
    /// What it holds.
    pub sections: Vec<Section>,
}

impl Report {
    /// A report without sections.
    pub fn new(title: impl Into<String>, lede: impl Into<String>) -> Self {
        Self { title: title.into(), lede: lede.into(), sections: Vec::new() }
    }

    /// With one more section at its end.
    #[must_use]
    pub fn with(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// The page as one text that needs no network.
    ///
    /// # Errors
    /// [`ReportError`] where arrays that belong together differ in length, or flows cannot be drawn.
    pub fn to_html(&self) -> Result<String, ReportError> {
        html::page(self)
    }

    /// Writes the page to a file, which appears whole or not at all.
    ///
    /// # Errors
    /// As [`Report::to_html`], and [`ReportError::File`] where the file system refuses.
    pub fn write(&self, path: &Path) -> Result<(), ReportError> {
        let html = self.to_html()?;
        let refused = |source| ReportError::File { path: path.to_owned(), source };
        let part = path.with_extension("html.part");
        fs::write(&part, html).and_then(|()| fs::rename(&part, path)).map_err(|source| {
            // The page is not wanted half; that it may stay behind must not hide why it was refused.
            let _ = fs::remove_file(&part);
            refused(source)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_that_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let inside_nothing = folder.path().join("missing").join("report.html");
        let error = Report::new("t", "").write(&inside_nothing).unwrap_err();
        assert!(error.to_string().contains("missing"), "{error}");
    }

    #[test]
    fn a_folder_in_the_place_of_the_file_is_refused_and_nothing_stays_behind() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("report.html");
        fs::create_dir(&taken).unwrap();
        assert!(matches!(Report::new("t", "").write(&taken), Err(ReportError::File { .. })));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_written_page_is_the_page() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.html");
        let report = Report::new("Roll-out", "It stopped.").with(Section::new("One"));
        report.write(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), report.to_html().unwrap());
    }
}
