//! A diagnosis as a Rerun recording: the mismatch painted along the paths, before and after, maps of it over position and speed, the
//! signal in runs that prove it, and what was reconstructed, on one timeline with the words of the answer.

mod course;
mod file;
mod heat;
mod layout;
mod lines;
mod plan;
mod scale;

pub use file::write as write_diagnosis;

use crate::ViewError;
use headland_trace::{Run, Trace};

/// A diagnosis to be drawn.
#[derive(Clone, Debug)]
pub struct Diagnosis<'a> {
    /// What was diagnosed, in a few words.
    pub title: &'a str,
    /// What was found, in Markdown.
    pub answer: &'a str,
    /// What else could be the cause, in Markdown.
    pub alternatives: &'a str,
    /// Name of the balance that is painted.
    pub balance: &'a str,
    /// Its unit.
    pub unit: &'a str,
    /// What it leaves over, run by run; none where nothing was held against the model.
    pub left: Vec<Left<'a>>,
    /// The signal in runs that prove it.
    pub shown: Vec<Shown<'a>>,
}

/// What a balance leaves over in one run, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Left<'a> {
    /// The run, as it was recorded.
    pub run: &'a Run,
    /// Whether nothing was fitted to it.
    pub held_out: bool,
    /// The path that it drove: runs of the same number share it.
    pub path: usize,
    /// Whether it went against its path.
    pub reversed: bool,
    /// Time of each row [s].
    pub time_s: &'a [f64],
    /// Position of each row along the path [m].
    pub position_m: &'a [f64],
    /// Speed of each row [m/s].
    pub speed_m_s: &'a [f64],
    /// Measured less modelled without what was found, in the unit of the balance.
    pub before: &'a [f64],
    /// With everything that was found.
    pub after: &'a [f64],
}

/// A signal in one run, and the effects along it.
#[derive(Clone, Debug)]
pub struct Shown<'a> {
    /// The run.
    pub run: &'a str,
    /// Whether nothing was fitted to it.
    pub held_out: bool,
    /// What the signal is, with its unit.
    pub signal: String,
    /// Times of the three that follow [s].
    pub time_s: &'a [f64],
    /// What was measured.
    pub measured: &'a [f64],
    /// The model without what was found.
    pub before: &'a [f64],
    /// The model with it.
    pub after: &'a [f64],
    /// What was reconstructed along it.
    pub effects: Vec<Effect<'a>>,
}

/// An effect along one run, with its band where one is known.
#[derive(Clone, Debug)]
pub struct Effect<'a> {
    /// What it is.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The trace that holds it.
    pub trace: &'a Trace,
    /// Its channel; the ends of its 95 % band are called so with `_low` and `_high` behind it.
    pub channel: String,
}

impl Diagnosis<'_> {
    /// Refuses what cannot be drawn.
    fn check(&self) -> Result<(), ViewError> {
        for left in &self.left {
            let rows = left.time_s.len();
            for (name, found) in [
                ("position_m", left.position_m.len()),
                ("speed_m_s", left.speed_m_s.len()),
                ("before", left.before.len()),
                ("after", left.after.len()),
            ] {
                if found != rows {
                    return Err(ViewError::Rows { run: left.run.id.clone(), name, found, expected: rows });
                }
            }
        }
        for shown in &self.shown {
            let rows = shown.time_s.len();
            for (name, values) in
                [("measured", shown.measured), ("before", shown.before), ("after", shown.after)]
            {
                if values.len() != rows {
                    let (run, found) = (shown.run.to_owned(), values.len());
                    return Err(ViewError::Rows { run, name, found, expected: rows });
                }
            }
        }
        Ok(())
    }
}

/// Before what was found was taken into the model, and after.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Before,
    After,
}

impl Stage {
    const BOTH: [Self; 2] = [Self::Before, Self::After];

    fn name(self) -> &'static str {
        match self {
            Self::Before => "before",
            Self::After => "after",
        }
    }

    fn of<'a>(self, left: &Left<'a>) -> &'a [f64] {
        match self {
            Self::Before => left.before,
            Self::After => left.after,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tests::run;

    #[test]
    fn rows_that_do_not_fit_together_are_refused_by_name() {
        let run = run("r1", &[("position_m", &[0.0, 1.0])]);
        let (two, three) = ([0.0; 2], [0.0; 3]);
        let left = Left {
            run: &run,
            held_out: false,
            path: 0,
            reversed: false,
            time_s: &two,
            position_m: &two,
            speed_m_s: &two,
            before: &three,
            after: &two,
        };
        let diagnosis = Diagnosis {
            title: "",
            answer: "",
            alternatives: "",
            balance: "motion",
            unit: "N",
            left: vec![left],
            shown: Vec::new(),
        };
        let error = diagnosis.check().unwrap_err();
        assert_eq!(error.to_string(), "`before` of run `r1` has 3 rows, expected 2");
    }
}
