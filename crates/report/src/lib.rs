//! Self-contained HTML pages with plots and tables, from traces and results.
//!
//! A [`Report`] is sections of [`Item`]s; [`Report::write`] makes one file of it that needs no network: the plots are
//! drawn by Apache ECharts (Apache-2.0, see `assets/`), which the page brings along. [`build`] makes the usual plots
//! from traces and arrays.

mod axis;
pub mod build;
mod draw;
mod error;
mod html;
mod kind;
mod number;
mod plot;
mod relief;
mod report;
mod table;
mod thin;

pub use axis::Axis;
pub use error::ReportError;
pub use kind::{
    Bar, Bars, Cloud, Colour, Cumulative, Flow, Heat, Highlight, Interval, Line, Lines, Map, Mark, Sankey,
    Scatter, Series, Steps,
};
pub use number::{number, quantity, with_interval};
pub use plot::{Kind, Plot};
pub use relief::{Ground, Relief};
pub use report::{Item, Report, Section};
pub use table::{Cell, Figure, Table, Tone};
