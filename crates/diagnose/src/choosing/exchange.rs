//! Causes that stand where another one belongs: a set grows one cause after the other, and what was taken first to stand for
//! several is not the best of them once the others are there.

use crate::causes::catalogue::{Cause, Form};
use crate::choosing::conclude::Side;
use crate::choosing::search::{TOLERANCE, rank};
use crate::choosing::state::{Part, Stand, State};

/// A function whose course brings no more than this share of what it brings is its plain value: what else is wrong in the
/// model bends a function that is free to bend.
const COURSE: f64 = 0.1;

impl State<'_> {
    /// The set with that cause exchanged for which another one says most more in its place; or for the plain value of what
    /// was a function, where that says nearly as much. None where every cause is where it belongs.
    pub fn exchanged(&self, best: &Stand, sides: &[Side], banned: &[usize]) -> Option<Stand> {
        let banned = self.case.ids(banned);
        let law = |part: &Part| self.cause(&part.trial).law.is_some();
        if best.parts.iter().any(law) {
            return None;
        }
        let more = |side: &Side| -> Option<(f64, Stand)> {
            let own = self.cause(&side.part.trial);
            let brings = side.lesser.as_ref().map_or(0.0, |lesser| best.score - lesser.score);
            let as_good = TOLERANCE.max(COURSE * brings);
            let of = |stand: &Stand| -> Option<f64> {
                let part = stand.parts.last()?;
                let cause = self.cause(&part.trial);
                if cause.id == own.id || law(part) || cause.is_banned(&banned) {
                    return None;
                }
                let needed = if is_plain(cause, own) && side.part.spread.is_some() {
                    -as_good
                } else if is_plain(own, cause) && part.spread.is_some() {
                    as_good
                } else {
                    TOLERANCE
                };
                Some(rank(stand, self) - best.score - needed).filter(|more| *more > 0.0)
            };
            let all = side.contests.iter().filter_map(|one| Some((of(&one.stand)?, &one.stand)));
            let able = all.filter(|(_, stand)| self.sensible(stand));
            let top = able.max_by(|one, other| one.0.total_cmp(&other.0));
            top.map(|(more, stand)| (more, stand.clone()))
        };
        let best = sides.iter().filter_map(more).max_by(|one, other| one.0.total_cmp(&other.0));
        best.map(|(_, stand)| stand)
    }
}

/// Whether a cause is the plain value of what another has as a function.
fn is_plain(cause: &Cause, function: &Cause) -> bool {
    cause.form == Form::Parameters
        && function.even().is_some_and(|(even, _)| even == cause.id && even != function.id)
}
