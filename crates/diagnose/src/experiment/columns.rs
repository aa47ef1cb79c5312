//! The columns of a finding, of its rivals and of everything that is free beside them: over the runs at hand, and over
//! the proposed ones.

use super::signature::{by_values, signatures};
use super::stage::Stage;
use crate::balances::gram::{Column, Reduced, Whitened};
use crate::balances::noise::{Noise, Noises};
use crate::causes::catalogue::Form;
use crate::causes::profile::{COARSE, Function, Profile, Spread, Widths};
use crate::causes::trial::{Pool, Trial};
use crate::choosing::search::Found;
use crate::choosing::state::WIDER;
use crate::proof::refine::Cured;
use crate::{Case, DiagnoseError, System};
use nalgebra::DVector;
use std::collections::BTreeMap;

/// Columns of one finding.
pub struct Columns<'a, 'b> {
    case: &'b Case<'a>,
    stage: &'b Stage<'a>,
    system: &'b System,
    pool: &'b Pool,
    noises: Noises,
    residual: Column,
    here: Vec<Column>,
    there: Vec<Column>,
    cause: Vec<Option<usize>>,
    /// How many belong to nothing that is in doubt.
    pub nuisance: usize,
    /// Prior standard deviations.
    pub sd: Vec<f64>,
}

impl<'a, 'b> Columns<'a, 'b> {
    /// With everything that is free.
    pub fn new(
        case: &'b Case<'a>,
        stage: &'b Stage<'a>,
        system: &'b System,
        pool: &'b Pool,
        found: &Found,
    ) -> Self {
        let mut columns = Self {
            case,
            stage,
            system,
            pool,
            noises: found.noises.1.clone(),
            residual: system.residual.clone(),
            here: Vec::new(),
            there: Vec::new(),
            cause: Vec::new(),
            nuisance: 0,
            sd: Vec::new(),
        };
        let corrected = case.corrections.iter().map(|one| (one.id, one.accepted.trial.cause));
        let cause_of: BTreeMap<&str, usize> = corrected.collect();
        for index in 0..pool.nuisance {
            let name = pool.small.iter().chain(&pool.corrected).find(|(_, column)| *column == index);
            let there = match name {
                None => Some(index),
                Some((name, _)) => stage.faults().find(|(own, _)| own == name).map(|(_, column)| *column),
            };
            let there = there.map_or_else(|| nothing(&stage.system), |at| stage.pool.columns[at].clone());
            let cause = name.and_then(|(name, _)| cause_of.get(name)).copied();
            columns.push(pool.columns[index].clone(), there, pool.sd[index], cause);
        }
        // What only the proposed runs have, an accelerometer's offset among it.
        let known = |name: &str| pool.small.iter().chain(&pool.corrected).any(|(own, _)| *own == name);
        for (name, column) in stage.faults().filter(|(name, _)| !known(name)) {
            let sd = stage.pool.sd[*column];
            let own = case.causes.iter().position(|cause| cause.id == *name);
            columns.push(nothing(system), stage.pool.columns[*column].clone(), sd, own);
        }
        columns.nuisance = columns.sd.len();
        columns
    }

    fn push(&mut self, here: Column, there: Column, sd: f64, cause: Option<usize>) -> usize {
        self.here.push(here);
        self.there.push(there);
        self.sd.push(sd);
        self.cause.push(cause);
        self.sd.len() - 1
    }

    /// Those of a cause that was found; none where it is a function of time, which no other run shares.
    pub fn found(&mut self, cured: &Cured) -> Result<Option<Vec<usize>>, DiagnoseError> {
        let corrected = self.pool.corrected.iter().find(|(id, _)| *id == cured.cause.id);
        if let Some((_, column)) = corrected {
            return Ok(Some(vec![*column]));
        }
        self.add(&cured.accepted.trial, &cured.values(), cured.function())
    }

    /// The one of a function of time, as it was in the runs at hand; the proposed runs are taken to have none of it.
    pub fn timed(&mut self, cured: &Cured) -> Option<Vec<usize>> {
        let function = cured.function()?;
        let signature = &self.pool.columns[*cured.accepted.trial.columns.first()?];
        let here = along(self.case, self.system, cured.cause.form, signature, function);
        let there = nothing(&self.stage.system);
        Some(vec![self.push(here, there, 1.0, Some(cured.accepted.trial.cause))])
    }

    /// Puts a fault back that the recordings were corrected for.
    pub fn uncorrect(&mut self, column: usize, value: f64) {
        for (rows, fault) in self.residual.iter_mut().zip(&self.here[column]) {
            *rows += fault * value;
        }
    }

    /// Those of a cause with these values, in the order of its terms; of a function, along the function.
    pub fn add(
        &mut self,
        trial: &Trial,
        values: &[f64],
        function: Option<&Function>,
    ) -> Result<Option<Vec<usize>>, DiagnoseError> {
        let cause = &self.case.causes[trial.cause];
        let form = cause.form;
        if form == Form::OverTime || (form == Form::OverPosition) != function.is_some() {
            return Ok(None);
        }
        let (here, there) = if by_values(form) {
            let here = signatures(self.case, self.system, trial, values)?;
            let there = signatures(&self.stage.case, &self.stage.system, trial, values)?;
            let (Some(here), Some(there)) = (here, there) else { return Ok(None) };
            (here, there)
        } else {
            let here = trial.columns.iter().map(|column| self.pool.columns[*column].clone()).collect();
            let there = trial.terms.iter().map(|term| self.stage.column(trial, *term)).collect();
            (here, there)
        };
        let mut added = Vec::new();
        for (place, (mut here, mut there)) in here.into_iter().zip(there).enumerate() {
            if let Some(function) = function {
                here = along(self.case, self.system, form, &here, function);
                there = along(&self.stage.case, &self.stage.system, form, &there, function);
            }
            // A function that was estimated has the size one.
            let sd = if function.is_some() { 1.0 } else { WIDER * cause.terms[trial.terms[place]].scale };
            added.push(self.push(here, there, sd, Some(trial.cause)));
        }
        Ok(Some(added))
    }

    /// Of several trials the one that explains most beside the columns `common`, and what its terms would be.
    pub fn best(&self, trials: &[Trial], common: &[usize]) -> Option<(Trial, Vec<f64>)> {
        let mut columns: Vec<&Column> = common.iter().map(|index| &self.here[*index]).collect();
        let mut sd: Vec<f64> = common.iter().map(|index| self.sd[*index]).collect();
        let mut places: Vec<Vec<usize>> = Vec::new();
        for trial in trials {
            places.push((columns.len()..columns.len() + trial.columns.len()).collect());
            columns.extend(trial.columns.iter().map(|column| &self.pool.columns[*column]));
            sd.extend(trial.columns.iter().map(|column| WIDER * self.pool.sd[*column]));
        }
        let chunks = &self.system.chunks;
        let whitened = Whitened::new(chunks, &self.residual, &columns, &self.noises)?;
        let reduced = whitened.reduced(chunks, &self.case.fit);
        let judged = trials.iter().zip(&places).filter_map(|(trial, own)| {
            let used: Vec<usize> = (0..common.len()).chain(own.iter().copied()).collect();
            let estimate = reduced.estimate(&used, &sd)?;
            let values = self.values(trial, &estimate.beta.as_slice()[common.len()..])?;
            Some((estimate.log_evidence, trial, values))
        });
        let best = judged.max_by(|one, other| one.0.total_cmp(&other.0));
        best.map(|(_, trial, values)| (trial.clone(), values))
    }

    /// What a trial's terms are when its columns have these sizes; none where they cannot be.
    fn values(&self, trial: &Trial, sizes: &[f64]) -> Option<Vec<f64>> {
        let cause = &self.case.causes[trial.cause];
        let mut shape = trial.shape.iter();
        let one = |(index, term): (usize, &crate::causes::catalogue::Term)| {
            if !term.linear {
                return Some(shape.next().copied().unwrap_or(1.0));
            }
            let place = trial.terms.iter().position(|own| *own == index);
            let value = place.map_or(0.0, |place| sizes[place]);
            (cause.is_function() || !cause.impossible(index, value)).then_some(value)
        };
        cause.terms.iter().enumerate().map(one).collect()
    }

    /// Columns of a rival that are its own at the size that it would have: a wind of twice the speed is not twice the wind.
    pub fn rival(
        &mut self,
        trials: &[Trial],
        common: &[usize],
        like: Option<&Spread>,
    ) -> Result<Option<Vec<usize>>, DiagnoseError> {
        /// The estimate with columns at one size is the size for the next.
        const ROUNDS: usize = 2;
        let Some((trial, mut values)) = self.best(trials, common) else { return Ok(None) };
        if self.case.causes[trial.cause].is_function() {
            let function = self.function_of(&trial, common, like);
            return self.add(&trial, &values, function.as_ref());
        }
        let mut own = self.add(&trial, &values, None)?;
        if trial.columns.len() == 1 || !by_values(self.case.causes[trial.cause].form) {
            return Ok(own);
        }
        for _ in 0..ROUNDS {
            let Some(columns) = &own else { return Ok(None) };
            let used: Vec<usize> = common.iter().chain(columns).copied().collect();
            let estimate = self.now(&self.noises).and_then(|now| now.estimate(&used, &self.sd));
            let sizes = estimate.map(|estimate| estimate.beta.as_slice()[common.len()..].to_vec());
            let Some(next) = sizes.and_then(|sizes| self.values(&trial, &sizes)) else { return Ok(own) };
            values = next;
            own = self.add(&trial, &values, None)?;
        }
        Ok(own)
    }

    /// The function that a cause over position would have, beside the columns `used`.
    fn function_of(&self, trial: &Trial, used: &[usize], like: Option<&Spread>) -> Option<Function> {
        const LENGTHS_M: [f64; 4] = [15.0, 50.0, 150.0, 450.0];
        let cause = &self.case.causes[trial.cause];
        if cause.form != Form::OverPosition {
            return None;
        }
        let (chunks, fit) = (&self.system.chunks, &self.case.fit);
        let own: Vec<&Column> = used.iter().map(|index| &self.here[*index]).collect();
        let sd: Vec<f64> = used.iter().map(|index| self.sd[*index]).collect();
        let all: Vec<usize> = (0..own.len()).collect();
        let whitened = Whitened::new(chunks, &self.residual, &own, &self.noises)?;
        let signature = &self.pool.columns[trial.columns[0]];
        let profile = Profile::new(self.system, &self.case.runs, (cause.form, false), signature);
        let lengths = like.map_or(LENGTHS_M.to_vec(), |spread| vec![spread.length]);
        let mut best: Option<(f64, Function)> = None;
        for length in lengths {
            let spread = Spread {
                length,
                size: cause.terms[0].scale,
                knots_per_length: COARSE,
                jumps: None,
                shared: false,
            };
            let Some(solved) = profile.gathered(&whitened, chunks, fit, &spread).solved(&spread) else {
                continue;
            };
            let mut reduced = whitened.reduced(chunks, fit);
            solved.take(&mut reduced);
            let Some(estimate) = reduced.estimate(&all, &sd) else { continue };
            if best.as_ref().is_none_or(|(known, _)| estimate.log_evidence > *known) {
                best = Some((estimate.log_evidence, solved.function(&estimate.beta, Widths::Wanted)));
            }
        }
        best.map(|(_, function)| function)
    }

    /// The noise that was found, and louder worlds beside it.
    pub fn noises(&self) -> Vec<Noises> {
        /// Variance of an unsteady world, as shares of that of a row.
        const LOUDER: [f64; 4] = [0.02, 0.2, 2.0, 20.0];
        const PERSISTENCES: [f64; 2] = [0.88, 0.99];
        let louder = |share: f64, persistence: f64| {
            let one = |noise: &Noise| Noise {
                process: noise.process + share * (noise.sensor + noise.process),
                persistence,
                ..*noise
            };
            Noises::normal(self.noises.each.iter().map(one).collect())
        };
        let all = LOUDER.iter().flat_map(|share| PERSISTENCES.map(|persistence| louder(*share, persistence)));
        std::iter::once(self.noises.clone()).chain(all).collect()
    }

    /// Products over the runs that were fitted.
    pub fn now(&self, noises: &Noises) -> Option<Reduced> {
        let columns: Vec<&Column> = self.here.iter().collect();
        let whitened = Whitened::new(&self.system.chunks, &self.residual, &columns, noises)?;
        Some(whitened.reduced(&self.system.chunks, &self.case.fit))
    }

    /// Products over each of the proposed runs; the scalar is what noise as it was found is expected to add.
    pub fn proposed(&self, noises: &Noises) -> Option<Vec<Reduced>> {
        let system = &self.stage.system;
        let (as_found, noises) = (self.there_is(&self.noises), self.there_is(noises));
        let columns: Vec<&Column> = self.there.iter().collect();
        let whitened = Whitened::new(&system.chunks, &nothing(system), &columns, &noises)?;
        let of_run = |run: usize| {
            let only: Vec<bool> = (0..self.stage.courses.len()).map(|other| other == run).collect();
            whitened.reduced(&system.chunks, &only)
        };
        let mut all: Vec<Reduced> = (0..self.stage.courses.len()).map(of_run).collect();
        let mut traces: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        for chunk in &system.chunks {
            let rows = chunk.rows.len();
            let trace = traces
                .entry((chunk.balance, rows))
                .or_insert_with(|| whitened.whiteners.of(chunk).trace(rows, &as_found.each[chunk.balance]));
            all[chunk.run].scalar += *trace;
        }
        for (course, products) in self.stage.courses.iter().zip(&mut all) {
            for (column, cause) in self.cause.iter().enumerate() {
                if cause.is_some_and(|cause| course.without.silences(&self.case.causes[cause])) {
                    products.matrix.row_mut(column).fill(0.0);
                    products.matrix.column_mut(column).fill(0.0);
                }
            }
        }
        Some(all)
    }

    /// The noise of the proposed runs' balances: as at hand, and of an accelerometer where there was none.
    fn there_is(&self, noises: &Noises) -> Noises {
        let one = |kind: &crate::Kind| {
            let known = self.system.kinds.iter().position(|own| own == kind);
            known.map_or_else(|| self.stage.accelerometer(), |known| noises.each[known])
        };
        Noises::normal(self.stage.system.kinds.iter().map(one).collect())
    }
}

/// A column of nothing.
pub fn nothing(system: &System) -> Column {
    system.chunks.iter().map(|chunk| DVector::zeros(chunk.rows.len())).collect()
}

/// What a function does to every row: its signature times its values.
fn along(case: &Case, system: &System, form: Form, signature: &Column, function: &Function) -> Column {
    Profile::new(system, &case.runs, (form, function.spread.shared), signature).rows(system, function)
}
