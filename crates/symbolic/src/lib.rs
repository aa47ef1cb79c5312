//! An equation for a residual that nothing listed explains.
//!
//! A law is a sum of up to three terms. A term is an amplitude in the unit of the target (newtons or watts) times one or two
//! shapes: powers, saturation, decay, thresholds, bumps, steps, switches that latch, what follows late, waves, pulses. Each shape is a pure number,
//! because its scale carries the unit of its variable; so every law has the right unit, and the effect `expression` runs its text as it is.
//!
//! 1. **Screening.** Every term of a dictionary is held against the whitened residual by scalar products; what the free
//!    parameters of the model can imitate is projected out first, with their priors.
//! 2. **Polishing.** The constants inside the best ones are estimated by variable projection.
//! 3. **Growth.** A beam of laws gets further terms; terms are exchanged.
//! 4. **Choice.** Whole runs are left out in turn. The simplest law within one standard error of the best is chosen, if each
//!    of its terms is a larger step than chance would make of white noise in the same screening.
//!
//! It knows no vehicle. It must not be offered what is made of the target: a measured force and an acceleration together
//! reproduce the residual and explain nothing. Only names that formulas know are accepted, and none of them is such.
//!
//! Source of the one-standard-error rule: Breiman, Friedman, Olshen and Stone, *Classification and Regression Trees* (1984),
//! section 3.4.3; of the front of complexity against error: Schmidt and Lipson, *Science* 324 (2009).

mod chance;
mod choose;
mod dictionary;
mod error;
mod lag;
mod latch;
mod law;
mod levels;
mod polish;
mod problem;
mod screen;
mod search;
mod shape;
mod slope;
mod term;
mod twins;
mod validate;
mod variable;
mod vector;

pub use chance::Chance;
pub use choose::Found;
pub use error::SymbolicError;
pub use law::{Constant, Law, constants_text};
pub use problem::{Nuisance, Problem, Rows, Target};
pub use search::Options;
pub use shape::EDGE;
pub use variable::{Enters, Variable};

/// Names that may stand in a law, each with its unit.
pub fn known_variables() -> impl Iterator<Item = (&'static str, &'static str)> {
    variable::KNOWN.iter().map(|known| (known.name, known.unit))
}

/// Searches for a law. `interrupted` is asked now and then whether to end.
///
/// # Errors
/// [`SymbolicError`] where the problem is none, or where the caller interrupted.
pub fn find(
    problem: &Problem,
    options: &Options,
    interrupted: &(dyn Fn() -> bool + Sync),
) -> Result<Found, SymbolicError> {
    let bench = problem::Bench::new(problem)?;
    let searched = search::search(&bench, options, interrupted)?;
    choose::choose(&bench, searched, interrupted)
}
