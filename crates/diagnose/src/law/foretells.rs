//! A formula in the place of a function of time that each run has of its own: such a function follows whatever there is, and
//! tells nothing of a run that it was not made of. A formula of what was recorded does, where it is right.
//!
//! So it may bring less to the runs that both were made of. Every fitted run is left out once and foretold by the others, as in
//! `foreseen.rs`; runs that are held out have no part in it.

use crate::balances::balance::Kind;
use crate::choosing::search::{Found, worth};
use crate::choosing::state::{Part, Stand, State};

/// A formula brings at least this share of what the functions bring with all that is beside them,
const BRINGS: f64 = 0.75;
/// and of runs that it was not made of it leaves no more than this share of the mean squares that they leave, beyond those of
/// neighbouring rows.
const LEFT: f64 = 0.1;

impl State<'_> {
    /// The names of what was found that takes a course of its own in each run of this balance.
    pub fn courses(&self, found: &Found, kind: Kind) -> Vec<&'static str> {
        let free = |part: &&Part| {
            let cause = self.cause(&part.trial);
            self.timed(part) && cause.is_course() && cause.balances.contains(&kind)
        };
        found.stand.parts.iter().filter(free).map(|part| self.cause(&part.trial).id).collect()
    }

    /// Whether a set has a law that grows with the clock throughout a run, whatever it names.
    pub fn holds_a_course(&self, stand: &Stand) -> bool {
        let longest_s = self.case.longest_s();
        let law = |part: &Part| {
            self.cause(&part.trial).law.as_ref().is_some_and(|law| law.never_settles(longest_s))
        };
        stand.parts.iter().any(law)
    }

    /// The likeliest of some sets with a law and without such courses, where it foretells runs as they never can.
    pub fn that_foretells(&self, found: &Found, sets: Vec<Stand>, kind: Kind) -> Option<Stand> {
        let courses = self.courses(found, kind);
        let brought = |stand: &Stand| worth(stand) - worth(&found.first);
        let least = BRINGS * brought(&found.stand);
        // A law of times or of places would be a course once more.
        let lasts = |part: &Part| {
            let cause = self.cause(&part.trial);
            let course = |name: &&str| ["time_s", "position_m"].contains(name);
            let of_law = cause.law.as_ref().is_some_and(|law| law.depends_on.iter().any(course));
            !courses.contains(&cause.id) && !of_law
        };
        let without = |stand: &Stand| stand.parts.iter().all(lasts);
        let able = sets.into_iter().filter(|stand| without(stand) && brought(stand) > least);
        let best = able.max_by(|one, other| worth(one).total_cmp(&worth(other)))?;
        let place = self.system.kinds.iter().position(|own| *own == kind)?;
        let left = |stand: &Stand| Some(self.foretold(&stand.parts, &stand.noises)?[place]);
        let (before, after) = (left(&found.stand)?, left(&best)?);
        // What neighbouring rows differ by nobody foretells.
        let quiet = self.quiet(&found.first).each[place].sd().powi(2);
        ((after - quiet).max(0.0) < LEFT * (before - quiet)).then_some(best)
    }
}
