//! Free parameters that are held to what was known of them.
//!
//! A map or a function of time takes up whatever goes along with it, and rows that are wrong in the same way for minutes are many:
//! together they move the free parameters to where no vehicle is. What is known of a vehicle was told by somebody, and contradicts
//! them; so the rows are then trusted less, by as much as it takes to have the free parameters within what can be.
//!
//! The likelihood is raised to the power of 1/d. Then the priors weigh d times what they did beside it, and all is known √d times
//! worse. Source: Holmes and Walker, *Biometrika* 104 (2017) 497, for a power that a conflict with the prior asks for.

use crate::balances::balance::Kind;
use crate::balances::gram::Whitened;
use crate::causes::trial::Pool;
use crate::choosing::state::{Chosen, Stand, State};
use nalgebra::DVector;

/// A free parameter further from what was known of it than so many standard deviations is held.
const HELD: f64 = 2.0;
/// By how much more the rows are doubted in one step, and at most.
const STEP: f64 = 1.5;
const MOST: f64 = 1e4;

impl State<'_> {
    /// A set that holds functions with its free parameters where they can be; as it is where they are, or where a force was
    /// measured, which tells the functions apart from what is free.
    pub fn held(&self, stand: &Stand) -> Stand {
        let doubt = self.doubt(stand).unwrap_or(1.0);
        if doubt == 1.0 {
            return stand.clone();
        }
        let pool = Pool { sd: self.doubted(&self.pool.sd, doubt), ..self.pool.clone() };
        let held = State { pool: &pool, ..*self }.settle(&stand.parts, &stand.noises);
        // Causes that would have to be what they cannot be beside it leave all as it is.
        held.filter(|held| !self.impossible(&held.parts, &held.estimate)).map_or_else(
            || stand.clone(),
            |mut held| {
                held.estimate.covariance *= doubt;
                Stand { score: stand.score, ..held }
            },
        )
    }

    /// By how much the rows are doubted: 1 where they are believed.
    fn doubt(&self, stand: &Stand) -> Option<f64> {
        let functions = stand.parts.iter().any(|part| part.spread.is_some());
        if !functions || self.system.has(Kind::Motion) || self.strain(&stand.estimate.beta) <= HELD {
            return Some(1.0);
        }
        let Chosen { used, columns, places, .. } = self.chosen(&stand.parts);
        let whitened = Whitened::new(&self.system.chunks, &self.system.residual, &columns, &stand.noises)?;
        let reduced = self.without_functions(&whitened, &self.profiles(&stand.parts), self.fit)?;
        let mut doubt = 1.0;
        loop {
            doubt *= STEP;
            let all = self.doubted(&self.sd(), doubt);
            let sd: Vec<f64> = used.iter().map(|column| all[*column]).collect();
            if doubt > MOST || self.strain(&reduced.estimate(&places, &sd)?.beta) <= HELD {
                return Some(doubt);
            }
        }
    }

    /// Prior standard deviations with what is known beside the rows so many times as heavy.
    fn doubted(&self, sd: &[f64], doubt: f64) -> Vec<f64> {
        let of = |(column, sd): (usize, &f64)| {
            if column < self.pool.nuisance { sd / doubt.sqrt() } else { *sd }
        };
        sd.iter().enumerate().map(of).collect()
    }

    /// How far the free parameters are from what was known of them, in their standard deviations, at most.
    fn strain(&self, beta: &DVector<f64>) -> f64 {
        let free = self.case.study.parameters.iter().zip(beta.iter());
        free.filter_map(|(one, change)| Some(change.abs() / one.sd?)).fold(0.0, f64::max)
    }
}
