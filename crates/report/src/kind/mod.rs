//! The kinds of plots.

mod bars;
mod cumulative;
mod heat;
mod lines;
mod map;
mod sankey;
mod scatter;

pub use bars::{Bar, Bars};
pub use cumulative::{Cumulative, Steps};
pub use heat::Heat;
pub use lines::{Interval, Line, Lines, Mark, Series};
pub use map::{Highlight, Map};
pub use sankey::{Flow, Sankey};
pub use scatter::{Cloud, Colour, Scatter};
