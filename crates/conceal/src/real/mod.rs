//! The proof on recordings of real vehicles whose withheld channels say what was concealed.
//!
//! Every row is posed with files of `given/` alone; the program under test runs and writes its answer; only then is
//! `truth/` opened. Rows run one after the other, each with a time limit.

mod bicycle;
mod buggy;
mod car;
mod dyno;
mod page;
mod pose;
mod quadricycle;
mod robot;
mod signal;
mod table;
mod tractor;
mod truck;

pub use page::page;

use crate::error::ConcealError;
use std::path::PathBuf;

/// What to do.
#[derive(Clone, Debug)]
pub struct Options {
    /// The program under test.
    pub program: PathBuf,
    /// Folder of the recordings.
    pub recordings: PathBuf,
    /// Folder of the scenarios and recording descriptions of the project.
    pub scenarios: PathBuf,
    /// Where inputs and answers are put.
    pub scratch: PathBuf,
    /// The one set to do; all where there is none.
    pub only: Option<String>,
    /// Longest time for one diagnosis [s].
    pub limit_s: f64,
}

/// One row of the proof.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// Folder of the recordings.
    pub set: &'static str,
    /// What was concealed, and how it was posed.
    pub concealed: String,
    /// What the program said: verdict, causes, alternatives.
    pub said: String,
    /// Its answer in its own words, or why there is none.
    pub answer: String,
    /// Before and after on runs that were held out.
    pub held_out: String,
    /// Figures against the truth.
    pub figures: Vec<Figure>,
    /// More about single runs, as Markdown.
    pub details: String,
    /// Time that the diagnosis took [s].
    pub wall_s: f64,
}

/// A figure against the truth.
#[derive(Clone, Debug)]
pub struct Figure {
    /// What it is.
    pub what: String,
    /// Its value, as text.
    pub value: String,
    /// What it should be; empty where there is no goal.
    pub goal: String,
    /// Whether it is; none where there is no goal.
    pub met: Option<bool>,
}

impl Figure {
    /// A figure with a goal.
    fn goal(what: &str, value: String, goal: &str, met: bool) -> Self {
        Self { what: what.to_owned(), value, goal: goal.to_owned(), met: Some(met) }
    }

    /// A figure without one.
    fn told(what: &str, value: String) -> Self {
        Self { what: what.to_owned(), value, goal: String::new(), met: None }
    }
}

type Set = (&'static str, fn(&Options) -> Result<Vec<Row>, ConcealError>);

const SETS: [Set; 8] = [
    ("bmw_i3", car::rows),
    ("class8_trucks", truck::rows),
    ("tractor_t7165", tractor::rows),
    ("twizy", quadricycle::rows),
    ("compton_challenge", bicycle::rows),
    ("husky_farm", robot::rows),
    ("baja_coastdown", buggy::rows),
    ("camry_dyno", dyno::rows),
];

/// All rows, set by set.
///
/// # Errors
/// [`ConcealError`] where a file cannot be read or the program cannot be started. A diagnosis that fails is a row.
pub fn all(options: &Options, mut progress: impl FnMut(&str)) -> Result<Vec<Row>, ConcealError> {
    let mut rows = Vec::new();
    for (name, set) in SETS {
        if options.only.as_deref().is_none_or(|only| only == name) {
            progress(name);
            rows.extend(set(options)?);
        }
    }
    Ok(rows)
}
