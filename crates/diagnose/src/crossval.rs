//! Whether what one run teaches holds in another: every run is left out once, the rest is fitted, and the run that was
//! left out is predicted with a cause and without. What the free parameters have to bend for it counts with their priors:
//! a cause that only relieves a parameter need not show in the prediction.
//!
//! Source: Stone, *J. R. Stat. Soc. B* 36 (1974) 111, here over whole runs.

use crate::gram::{Column, Whitened};
use crate::profile::Widths;
use crate::state::{Chosen, Part, Stand, State};
use nalgebra::DVector;
use rayon::prelude::*;

impl State<'_> {
    /// By how much ln p of runs that were left out grows with each cause of a set; none with a single run.
    pub fn predicted(&self, stand: &Stand) -> Option<Vec<f64>> {
        let fitted: Vec<usize> = (0..self.fit.len()).filter(|run| self.fit[*run]).collect();
        if fitted.len() < 2 {
            return None;
        }
        let full = self.deviance(&stand.parts, stand, &fitted)?;
        let without = |place: usize| {
            let mut parts = stand.parts.clone();
            parts.remove(place);
            self.deviance(&parts, stand, &fitted)
        };
        (0..stand.parts.len()).map(|place| Some(0.5 * (without(place)? - full))).collect()
    }

    /// Sum of the squares of what is left, whitened, of runs that were each predicted by the others.
    fn deviance(&self, parts: &[Part], stand: &Stand, fitted: &[usize]) -> Option<f64> {
        let Chosen { columns, sd, places, .. } = self.chosen(parts);
        let chunks = &self.system.chunks;
        let whitened = Whitened::new(chunks, &self.system.residual, &columns, &stand.noises)?;
        let profiles = self.profiles(parts);
        let of_run = |out: &usize| -> Option<f64> {
            let mut mask = self.fit.to_vec();
            mask[*out] = false;
            let beta = self.without_functions(&whitened, &profiles, &mask)?.estimate(&places, &sd)?.beta;
            let functions: Vec<Column> = profiles
                .iter()
                .flatten()
                .map(|(profile, spread)| {
                    let made = profile.function(&whitened, chunks, &mask, spread, &beta, Widths::Left);
                    profile.rows(self.system, &made)
                })
                .collect();
            // What is known of the free parameters is known once, not once for every run.
            let bent: f64 =
                beta.iter().zip(&sd).take(self.pool.nuisance).map(|(value, sd)| (value / sd).powi(2)).sum();
            let mut sum = bent / fitted.len() as f64;
            for (index, chunk) in chunks.iter().enumerate().filter(|(_, chunk)| chunk.run == *out) {
                let mut left: DVector<f64> = self.system.residual[index].clone();
                for (column, value) in columns.iter().zip(beta.iter()) {
                    left -= &column[index] * *value;
                }
                for rows in &functions {
                    left -= &rows[index];
                }
                sum += whitened.whiteners.white(index, chunk, &left).norm_squared();
            }
            Some(sum)
        };
        let all: Vec<Option<f64>> = fitted.par_iter().map(of_run).collect();
        all.into_iter().sum()
    }
}
