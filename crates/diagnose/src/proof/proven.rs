//! What was found, with its values and the proof of it.

use crate::causes::catalogue::Class;
use crate::causes::clocks::DRIFT;
use crate::causes::trial::Pool;
use crate::choosing::search::Found;
use crate::choosing::state::{Part, State};
use crate::proof::in_doubt;
use crate::proof::prove::{Errors, Measure, Proof, prove};
use crate::proof::refine::{Cured, Refined, refine, spells};
use crate::single_runs::events::Event;
use crate::soundness::contradiction::withhold;
use crate::{Case, DiagnoseError, System};

/// An error that rises by less than this share rises by what a few runs are apart from the others.
pub const RISES: f64 = 0.02;

/// What was found, with values and the proof of it.
pub struct Proven {
    pub found: Found,
    pub refined: Refined,
    /// Why nothing is claimed, where it is not.
    pub withheld: Option<String>,
    pub proof: Proof,
}

impl Proven {
    pub fn of(
        case: &Case,
        system: &System,
        pool: &mut Pool,
        found: Found,
        events: &[Event],
        by: Option<&Measure>,
    ) -> Result<Self, DiagnoseError> {
        let mut refined = refine(case, system, pool, &found)?;
        let bounds: Vec<(f64, f64)> = case.study.parameters.iter().map(|known| known.bounds).collect();
        in_doubt::widen(&mut refined, &bounds, found.estimate.beta.as_slice());
        spells(case, system, events, &mut refined);
        let withheld = withhold(case, &mut refined);
        let measure = by.map_or_else(|| Measure::of(case, system, &refined), |own| Ok(own.clone()))?;
        let proof = prove(case, system, &refined, &measure)?;
        Ok(Self { found, refined, withheld, proof })
    }

    /// Whether runs held out are worse with this than with another.
    pub fn is_worse_than(&self, other: &Self) -> bool {
        let held_out = self.worsened().zip(other.worsened());
        held_out.is_some_and(|(own, other)| own > (1.0 + RISES) * other)
    }

    /// Whether all runs, those that were fitted too, are clearly worse with what is claimed than with the nominal scenario: what
    /// a part of the rows asks for is then something else.
    pub fn harms(&self) -> bool {
        /// Errors that rise by so much are no matter of noise.
        const CLEARLY: f64 = 1.5;
        let worse = |errors: &Errors| errors.after > CLEARLY * errors.before;
        !self.refined.causes.is_empty()
            && self.withheld.is_none()
            && worse(&self.proof.fitted)
            && self.proof.held_out.as_ref().is_some_and(worse)
    }

    /// Whether all that is claimed is faults of sensors, and runs held out are worse without them, or no better to speak of where far more
    /// than noise is left of all that a clock would set right.
    pub fn only_makes_up_faults(&self) -> bool {
        let mut claimed = self.refined.causes.iter();
        !self.refined.causes.is_empty()
            && self.withheld.is_none()
            && claimed.all(|cured| cured.cause.class == Class::Artefact)
            && self.worsened().is_some_and(|ratio| ratio > 1.0 + RISES || self.is_no_clock(ratio))
    }

    /// Whether a delay or a clock is told that leaves most of the error in all runs, and far more than noise.
    fn is_no_clock(&self, left: f64) -> bool {
        /// Times the noise, and share of the error.
        const FAR: f64 = 3.0;
        const MOST: f64 = 0.7;
        let fitted = &self.proof.fitted;
        let clocks = |cured: &Cured| ["latency", DRIFT].contains(&cured.cause.id);
        self.refined.causes.iter().all(clocks)
            && left > MOST
            && fitted.after > MOST * fitted.before
            && fitted.after > FAR * self.proof.noise
    }

    /// What became of one of the parts of what was found, where it is still claimed.
    pub fn cured(&self, place: usize) -> Option<&Cured> {
        let columns = &self.found.stand.parts[place].trial.columns;
        self.refined.causes.iter().find(|cured| cured.accepted.trial.columns == *columns)
    }

    /// Error on runs held out over that of the nominal scenario, where there are any.
    fn worsened(&self) -> Option<f64> {
        self.proof.held_out.and_then(|errors| ratio(&errors))
    }

    /// The same over some runs alone.
    pub fn worsened_in(&self, telling: &[bool]) -> Option<f64> {
        Errors::over(&self.proof.each, telling).and_then(|errors| ratio(&errors))
    }

    /// The runs held out that tell whether it is right: a map says nothing of places where no fitted run was, nor what each run switches
    /// of any other.
    pub fn telling(&self, case: &Case, system: &System, pool: &Pool) -> Vec<bool> {
        /// A run along which maps are known for less than this share tells nothing of them.
        const KNOWN: f64 = 0.6;
        let state = State { case, system, pool, fit: &case.fit };
        let parts: Vec<Part> =
            self.found.stand.parts.iter().filter(|part| part.spread.is_some()).cloned().collect();
        let foretells = !self.refined.is_switched_alone();
        held_out(case)
            .zip(state.shares_known(&parts))
            .map(|(held_out, known)| held_out && known > KNOWN && foretells)
            .collect()
    }

    /// Whether a free parameter has to be further from what was known of it than it can be, and than it is with another set: it
    /// says then what the other said.
    pub fn strains_more_than(&self, other: &Self, case: &Case) -> bool {
        /// Nothing that is known is so many standard deviations wrong, however much a power that is made of noise bends it.
        const MOST: f64 = 5.0;
        let of = |one: &Self| one.refined.strain(case).map_or(0.0, |(_, strain)| strain);
        of(self) > MOST.max(of(other))
    }
}

/// Which runs are held out and may forbid a claim.
pub fn held_out(case: &Case) -> impl Iterator<Item = bool> {
    case.fit.iter().zip(&case.bears).map(|(fit, bears)| !fit && *bears)
}

/// Whether errors of the same runs are larger with one set than with another.
pub fn is_worse(with: &Errors, without: &Errors) -> bool {
    with.after > (1.0 + RISES) * without.after
}

/// Error with what was found over that of the nominal scenario.
fn ratio(errors: &Errors) -> Option<f64> {
    Some(errors.after / errors.before).filter(|ratio| ratio.is_finite())
}
