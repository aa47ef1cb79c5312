//! A plot of any kind, with its title.

use crate::draw::Drawn;
use crate::{Bars, Cumulative, Heat, Lines, Map, ReportError, Sankey, Scatter};

/// What a plot shows.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Series over a common axis.
    Lines(Lines),
    /// Points.
    Scatter(Scatter),
    /// Bars over categories.
    Bars(Bars),
    /// Flows from sources to sinks.
    Sankey(Sankey),
    /// Cumulative probability.
    Cumulative(Cumulative),
    /// A path seen from above.
    Map(Map),
    /// Numbers as colours.
    Heat(Heat),
}

/// A plot with its title and what is said below it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Title; also names the file of a saved picture.
    pub title: String,
    /// Said below the plot; may be empty.
    pub words: String,
    /// What it shows.
    pub kind: Kind,
}

impl Plot {
    /// A plot of this kind.
    pub fn new(title: impl Into<String>, kind: impl Into<Kind>) -> Self {
        Self { title: title.into(), words: String::new(), kind: kind.into() }
    }

    /// With words below it.
    #[must_use]
    pub fn words(mut self, words: impl Into<String>) -> Self {
        self.words = words.into();
        self
    }

    /// Whether it can be drawn; a page with one that cannot is not made.
    ///
    /// # Errors
    /// [`ReportError`], as the page would give it.
    pub fn drawable(&self) -> Result<(), ReportError> {
        self.draw().map(drop)
    }

    pub(crate) fn draw(&self) -> Result<Drawn, ReportError> {
        match &self.kind {
            Kind::Lines(lines) => lines.draw(&self.title),
            Kind::Scatter(scatter) => scatter.draw(&self.title),
            Kind::Bars(bars) => bars.draw(&self.title),
            Kind::Sankey(sankey) => sankey.draw(&self.title),
            Kind::Cumulative(cumulative) => cumulative.draw(&self.title),
            Kind::Map(map) => map.draw(&self.title),
            Kind::Heat(heat) => heat.draw(&self.title),
        }
    }
}

macro_rules! kind_from {
    ($($kind:ident),*) => {
        $(impl From<$kind> for Kind {
            fn from(kind: $kind) -> Self {
                Self::$kind(kind)
            }
        })*
    };
}
kind_from!(Lines, Scatter, Bars, Sankey, Cumulative, Map, Heat);
