//! Whether what one run teaches holds in another: every run is left out once, the rest is fitted, and the run that was
//! left out is predicted with a cause and without. What the free parameters have to bend for it counts with their priors:
//! a cause that only relieves a parameter need not show in the prediction.
//!
//! A road that no other run drove has slopes that the others say nothing of: along it they are as unknown as they usually are, and
//! what is left of the run is judged with that. So is a run beside a course of its own, or a level, of which others say nothing.
//!
//! Source: Stone, *J. R. Stat. Soc. B* 36 (1974) 111, here over whole runs.

use crate::balances::gram::{Column, Whitened};
use crate::balances::noise::Noises;
use crate::balances::rows::{Chunk, Row};
use crate::causes::catalogue::Form;
use crate::causes::profile::Widths;
use crate::choosing::state::{Chosen, Part, Stand, State};
use crate::single_runs::events::Event;
use headland_calibrate::statistics::sorted;
use nalgebra::DVector;
use rayon::prelude::*;

impl State<'_> {
    /// By how much ln p of runs that were left out grows with each cause of a set; none with a single run.
    pub fn predicted(&self, stand: &Stand) -> Option<Vec<f64>> {
        let unseen = self.unseen(&stand.parts);
        let alone = self.alone(&stand.parts);
        let full = self.deviance(&stand.parts, stand, &unseen, &alone)?;
        let without = |place: usize| {
            let mut parts = stand.parts.clone();
            parts.remove(place);
            self.deviance(&parts, stand, &unseen, &alone)
        };
        (0..stand.parts.len()).map(|place| Some(0.5 * (without(place)? - full))).collect()
    }

    /// What causes leave of every balance in runs that were each predicted by the others, as mean squares over rows of the
    /// fitted runs; none with a single run.
    pub fn foretold(&self, parts: &[Part], noises: &Noises) -> Option<Vec<f64>> {
        let told = self.told_by_others(parts, noises, &vec![false; self.fit.len()])?;
        let balances = self.system.kinds.len();
        let (mut sums, mut counts) = (vec![0.0; balances], vec![0usize; balances]);
        for (index, left) in told.iter().flat_map(|one| &one.left) {
            let balance = self.system.chunks[*index].balance;
            sums[balance] += left.norm_squared();
            counts[balance] += left.len();
        }
        Some(sums.iter().zip(counts).map(|(sum, count)| sum / count.max(1) as f64).collect())
    }

    /// The rows at places where no other fitted run was, by chunk: a map that is made without a run says nothing of them.
    fn unseen(&self, parts: &[Part]) -> Vec<Vec<usize>> {
        let mapped = self.mapped(parts);
        let runs = &self.case.runs;
        let of_chunk = |chunk: &Chunk| {
            let Some(mapped) = mapped.as_ref().filter(|_| self.fit[chunk.run]) else { return Vec::new() };
            let at_m = |row: &Row| row.mean(&runs[chunk.run].position_m);
            let rows = chunk.rows.iter().enumerate();
            rows.filter(|(_, row)| !self.is_known(mapped, chunk.run, at_m(row)))
                .map(|(number, _)| number)
                .collect()
        };
        self.system.chunks.par_iter().map(of_chunk).collect()
    }

    /// The share of every run along which other, fitted runs tell what the maps of a set are.
    pub fn shares_known(&self, parts: &[Part]) -> Vec<f64> {
        let Some(mapped) = self.mapped(parts) else { return vec![1.0; self.fit.len()] };
        let of_run = |run: usize| {
            let places = &self.case.runs[run].position_m;
            let known = places.iter().filter(|at_m| self.is_known(&mapped, run, **at_m)).count();
            known as f64 / places.len().max(1) as f64
        };
        (0..self.fit.len()).into_par_iter().map(of_run).collect()
    }

    /// Where the maps of a set are known; none where it has no map.
    fn mapped(&self, parts: &[Part]) -> Option<Mapped> {
        /// So far from where it is known a map still is, in lengths over which it stays alike.
        const NEAR: f64 = 0.5;
        let of_place = |part: &&Part| self.cause(&part.trial).form == Form::OverPosition;
        let lengths = parts.iter().filter(of_place).filter_map(|part| Some(part.spread.as_ref()?.length));
        let near_m = NEAR * lengths.fold(f64::INFINITY, f64::min);
        let places = || self.case.runs.iter().map(|run| sorted(&run.position_m)).collect();
        near_m.is_finite().then(|| Mapped { near_m, places: places() })
    }

    /// Whether other, fitted runs tell what maps are where a run is.
    fn is_known(&self, mapped: &Mapped, own: usize, at_m: f64) -> bool {
        let (runs, near_m) = (&self.case.runs, mapped.near_m);
        (0..runs.len()).filter(|run| *run != own && self.fit[*run] && runs[*run].path == runs[own].path).any(
            |run| {
                let places = &mapped.places[run];
                let next = places.partition_point(|place| *place < at_m - near_m);
                places.get(next).is_some_and(|place| *place <= at_m + near_m)
            },
        )
    }

    /// Whether a spell says anything that a set with maps does not say: a stretch that nobody else drove, of a path that others
    /// drove as well, has slopes of which its map knows nothing, or that the spell drew itself.
    pub fn is_told_beside(&self, parts: &[Part], event: &Event) -> bool {
        let Some(mapped) = self.mapped(parts) else { return true };
        let runs = &self.case.runs;
        let own = &runs[event.run];
        let shared = (0..runs.len())
            .any(|other| other != event.run && self.fit[other] && runs[other].path == own.path);
        if self.fit[event.run] && !shared {
            return true;
        }
        let time_s = own.measured.trace.time_s();
        let places = || {
            let inside = time_s.iter().zip(&own.position_m);
            inside.filter(|(time, _)| (event.from_s..=event.to_s).contains(*time)).map(|(_, at_m)| *at_m)
        };
        let known = places().filter(|at_m| self.is_known(&mapped, event.run, *at_m)).count();
        2 * known > places().count()
    }

    /// The fitted runs whose path no other fitted run drove, where a set holds a function of the path, and all where it holds a
    /// function of each run's own.
    fn alone(&self, parts: &[Part]) -> Vec<bool> {
        let of_place =
            |part: &Part| part.spread.is_some() && self.cause(&part.trial).form == Form::OverPosition;
        if parts.iter().any(|part| part.spread.is_some() && self.timed(part)) {
            return self.fit.to_vec();
        }
        let mapped = parts.iter().any(of_place);
        let runs = &self.case.runs;
        let others = |own: usize| {
            (0..runs.len()).any(|run| run != own && self.fit[run] && runs[run].path == runs[own].path)
        };
        (0..runs.len()).map(|run| mapped && self.fit[run] && !others(run)).collect()
    }

    /// Sum of the squares of what is left, whitened, of runs that were each predicted by the others; rows that are `unseen`
    /// leave nothing, and runs that were `alone` what is unlikely beside functions of their own that nobody knows.
    fn deviance(&self, parts: &[Part], stand: &Stand, unseen: &[Vec<usize>], alone: &[bool]) -> Option<f64> {
        let chunks = &self.system.chunks;
        let whiteners = stand.noises.whiteners(chunks)?;
        let told = self.told_by_others(parts, &stand.noises, alone)?;
        let of_run = |one: &Told| {
            let white = |(index, left): &(usize, DVector<f64>)| {
                let mut left = left.clone();
                for row in &unseen[*index] {
                    left[*row] = 0.0;
                }
                whiteners.white(*index, &chunks[*index], &left).norm_squared()
            };
            // What is known of the free parameters is known once, not once for every run.
            one.bent / told.len() as f64
                + one.unlikely.unwrap_or_else(|| one.left.iter().map(white).sum::<f64>())
        };
        Some(told.iter().map(of_run).sum())
    }

    /// Every fitted run as the others predict it with some causes; those that are `alone` beside functions of their own.
    fn told_by_others(&self, parts: &[Part], noises: &Noises, alone: &[bool]) -> Option<Vec<Told>> {
        let fitted: Vec<usize> = (0..self.fit.len()).filter(|run| self.fit[*run]).collect();
        if fitted.len() < 2 {
            return None;
        }
        let Chosen { columns, sd, places, .. } = self.chosen(parts);
        let chunks = &self.system.chunks;
        let whitened = Whitened::new(chunks, &self.system.residual, &columns, noises)?;
        let profiles = self.profiles(parts);
        let of_run = |out: &usize| -> Option<Told> {
            let mut mask = self.fit.to_vec();
            mask[*out] = false;
            let solved = self.gathered(&whitened, &profiles, &mask)?.solved(&profiles)?;
            let beta = solved.reduced.estimate(&places, &sd)?.beta;
            let made = solved.functions(&beta, Widths::Left);
            let functions: Vec<Column> = profiles
                .iter()
                .zip(&made)
                .filter_map(|(one, made)| Some(one.as_ref()?.0.rows(self.system, made.as_ref()?)))
                .collect();
            let of_chunk = |index: usize| {
                let mut left: DVector<f64> = self.system.residual[index].clone();
                for (column, value) in columns.iter().zip(beta.iter()) {
                    left -= &column[index] * *value;
                }
                for rows in &functions {
                    left -= &rows[index];
                }
                (index, left)
            };
            let mut own = vec![false; self.fit.len()];
            own[*out] = true;
            let unlikely = if alone[*out] {
                Some(self.without_functions(&whitened, &profiles, &own)?.deviance_at(&beta))
            } else {
                None
            };
            Some(Told {
                unlikely,
                bent: beta
                    .iter()
                    .zip(&sd)
                    .take(self.pool.nuisance)
                    .map(|(value, sd)| (value / sd).powi(2))
                    .sum(),
                left: (0..chunks.len()).filter(|index| chunks[*index].run == *out).map(of_chunk).collect(),
            })
        };
        fitted.par_iter().map(of_run).collect()
    }
}

/// Where maps are known.
struct Mapped {
    /// So near to where a run was [m].
    near_m: f64,
    /// The places of every run, sorted [m].
    places: Vec<Vec<f64>>,
}

/// A run as the others predict it.
struct Told {
    /// Squares of how far the free parameters had to move, in standard deviations of what is known of them.
    bent: f64,
    /// How unlikely it is beside functions of its own, −2 ln p but for what is the same of all sets; none where it is predicted as it is.
    unlikely: Option<f64>,
    /// What is left of every chunk of it.
    left: Vec<(usize, DVector<f64>)>,
}
