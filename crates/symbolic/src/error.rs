//! What keeps a search from being made.

/// A problem that cannot be searched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SymbolicError {
    /// A variable that no formula may name: unknown to formulas, or made of what is to be explained.
    #[error(
        "`{name}` may not stand in a law; known: {}; what is made of the target itself, as a force, \
         would reproduce it and explain nothing",
        known.join(" ")
    )]
    Unknown {
        /// What was found.
        name: String,
        /// What may stand in a law.
        known: Vec<&'static str>,
    },
    /// A variable that may not enter in proportion, and is offered so.
    #[error(
        "`{name}` enters the law of a force by what bends alone: in proportion to it that would reproduce itself"
    )]
    Proportional {
        /// The variable.
        name: String,
    },
    /// A variable that is offered twice.
    #[error("`{name}` is offered twice")]
    Twice {
        /// The variable.
        name: String,
    },
    /// A unit that does not fit.
    #[error("`{name}` is in `{found}`, expected {expected}")]
    Unit {
        /// Of what.
        name: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// Something has not the length that it should have.
    #[error("{what} of run {run} has {found} values, expected {expected}")]
    Length {
        /// Of what.
        what: String,
        /// Index of the run.
        run: usize,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// Something is not a finite number.
    #[error("{what} of run {run} is not finite everywhere; leave out what was not measured")]
    NotFinite {
        /// Of what.
        what: String,
        /// Index of the run.
        run: usize,
    },
    /// A prior that is none.
    #[error("the standard deviation of nuisance {index} is {found}, expected more than 0")]
    Prior {
        /// Index of the nuisance column.
        index: usize,
        /// What was found.
        found: f64,
    },
    /// Too little to judge a law by.
    #[error(
        "{rows} rows that may be fitted beside {nuisances} nuisance columns are too few to judge a law by"
    )]
    TooFew {
        /// Rows of the runs that may be fitted.
        rows: usize,
        /// Nuisance columns.
        nuisances: usize,
    },
    /// The caller interrupted.
    #[error("interrupted")]
    Interrupted,
}
