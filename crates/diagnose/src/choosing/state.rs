//! A set of causes and how likely it makes the recordings: estimates, their noise, the evidence.

use crate::Case;
use crate::balances::balance::{Kind, System};
use crate::balances::gram::{Column, Estimate, Reduced, Whitened};
use crate::balances::noise::Noises;
use crate::causes::abreast;
use crate::causes::catalogue::{Cause, Form};
use crate::causes::cycles::Cycles;
use crate::causes::functions::Profiles;
use crate::causes::profile::{Function, Profile, Spread, Widths};
use crate::causes::trial::{Pool, Trial};
use crate::choosing::rivals::twin;
use crate::look::MANY_ROWS;
use crate::runs::recorded::share_paths;
use headland_calibrate::statistics::mean;
use nalgebra::DVector;

/// A cause in a set, and how a function of it is spread.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its trial.
    pub trial: Trial,
    /// Where it is a function.
    pub spread: Option<Spread>,
}

impl Part {
    /// The columns that stand beside it, where it is a function.
    pub fn beside(&self) -> &[usize] {
        if self.spread.is_some() { &self.trial.beside } else { &[] }
    }
}

/// A set of causes with its estimate.
#[derive(Clone)]
pub struct Stand {
    /// The causes.
    pub parts: Vec<Part>,
    /// Columns in use: free parameters first.
    pub used: Vec<usize>,
    /// Noise that suits it.
    pub noises: Noises,
    /// Values of the columns in use.
    pub estimate: Estimate,
    /// ln p of the recordings, with what the choice of the causes costs.
    pub score: f64,
    /// What it leaves of every row.
    pub left: Column,
    /// The function of each part that is one.
    pub functions: Vec<Option<Function>>,
}

/// The columns that a set of causes uses.
pub struct Chosen<'a> {
    /// Which they are.
    pub used: Vec<usize>,
    /// What each does to the rows.
    pub columns: Vec<&'a Column>,
    /// Prior standard deviation of each.
    pub sd: Vec<f64>,
    /// Their places among themselves: all of them.
    pub places: Vec<usize>,
}

/// What all sets are judged by.
pub struct State<'a> {
    pub case: &'a Case<'a>,
    pub system: &'a System,
    pub pool: &'a Pool,
    pub fit: &'a [bool],
}

/// Effects are sometimes several times their usual size: so much wider is the prior that they are estimated with.
pub const WIDER: f64 = 3.0;

/// What it costs to have had the choice among so many shapes: ln of their number. A spell at the same time in every run,
/// with nothing that tells why, is less likely from the start.
fn choice(cause: &Cause) -> f64 {
    const BY_THE_CLOCK: f64 = 3.0;
    /// No recording tells a tilt from the offset that it makes, which is the plainer thing to say.
    const TILT: f64 = 1.0;
    /// Drag of the air that is stated wrongly is the plainer square of speed.
    const SQUARE: f64 = 1.0;
    /// Of no grid, each of its speeds was found at one of so many places.
    const PLACES: f64 = 24.0;
    let clock = cause.terms.iter().any(|term| term.name == "from_s");
    let found = cause.law.as_ref().map_or(0.0, |law| law.cost);
    let tilt = cause.id == "accelerometer_tilt";
    let square = cause.terms.iter().any(|term| term.name == "quadratic");
    let shapes = if cause.shapes.is_empty() {
        cause.speeds() as f64 * PLACES.ln()
    } else {
        (cause.shapes.len() as f64).ln()
    };
    found
        + shapes
        + if clock { BY_THE_CLOCK } else { 0.0 }
        + if tilt { TILT } else { 0.0 }
        + if square { SQUARE } else { 0.0 }
}

impl<'a> State<'a> {
    /// The cause of a trial.
    pub fn cause(&self, trial: &Trial) -> &'a Cause {
        &self.case.causes[trial.cause]
    }

    /// Its identifier.
    pub fn id(&self, trial: &Trial) -> &'static str {
        self.cause(trial).id
    }

    /// Columns that a set of causes uses. A function brings its signature: the value that it has on average; what stands
    /// beside functions comes first, so that the columns of the causes are always the last.
    pub fn columns(&self, parts: &[Part]) -> Vec<usize> {
        let mut used: Vec<usize> = (0..self.pool.nuisance).collect();
        used.extend(parts.iter().flat_map(|part| part.beside().iter().copied()));
        used.extend(parts.iter().flat_map(|part| part.trial.columns.iter().copied()));
        used
    }

    /// The same with all that an estimate by them takes.
    pub fn chosen(&self, parts: &[Part]) -> Chosen<'a> {
        let (used, all_sd) = (self.columns(parts), self.sd());
        Chosen {
            columns: used.iter().map(|column| &self.pool.columns[*column]).collect(),
            sd: used.iter().map(|column| all_sd[*column]).collect(),
            places: (0..used.len()).collect(),
            used,
        }
    }

    /// Prior standard deviation of every column, for estimates.
    pub fn sd(&self) -> Vec<f64> {
        let wide = |(index, sd): (usize, &f64)| if index < self.pool.nuisance { *sd } else { WIDER * sd };
        self.pool.sd.iter().enumerate().map(wide).collect()
    }

    /// What turns the evidence with the wide normal priors into that with priors of heavy tails: a cause's parameter is
    /// usually of its scale, sometimes several times that. Cauchy (at the estimate) over normal.
    pub fn heavy(&self, used: &[usize], beta: &DVector<f64>) -> f64 {
        let own = |(column, value): (&usize, &f64)| {
            let ratio = value / self.pool.sd[*column];
            let normal = -0.5 * (ratio / WIDER).powi(2) - (WIDER * (2.0 * std::f64::consts::PI).sqrt()).ln();
            let cauchy = -(std::f64::consts::PI * (1.0 + ratio * ratio)).ln();
            cauchy - normal
        };
        let causes = used.iter().zip(beta.iter()).filter(|(column, _)| **column >= self.pool.nuisance);
        causes.map(own).sum()
    }

    /// Whether a set would have to be what it cannot be.
    pub fn impossible(&self, parts: &[Part], estimate: &Estimate) -> bool {
        self.beyond(parts, &estimate.beta)
    }

    fn beyond(&self, parts: &[Part], beta: &DVector<f64>) -> bool {
        self.first_beyond(parts, beta).is_some()
    }

    /// The first part of a set that would have to be what it cannot be.
    pub fn first_beyond(&self, parts: &[Part], beta: &DVector<f64>) -> Option<usize> {
        let own: usize = parts.iter().map(|part| part.trial.columns.len()).sum();
        let mut position = beta.len() - own;
        for (place, part) in parts.iter().enumerate() {
            let cause = self.cause(&part.trial);
            for term in &part.trial.terms {
                let bounded = part.spread.is_none();
                if bounded && cause.impossible(*term, beta[position]) {
                    return Some(place);
                }
                position += 1;
            }
        }
        None
    }

    /// Whether the functions of a set stay within what their parameters can be, by two standard deviations and a tenth of
    /// how far they reach, but for one knot in twenty, and none is what nobody wants by another name: a load that does not change is a mass,
    /// and slopes that are the same everywhere are one.
    pub fn functions_possible(&self, stand: &Stand) -> bool {
        const SIGMAS: f64 = 2.0;
        const SLACK: f64 = 0.1;
        /// Where runs differ, what all of them share may lie in other parameters.
        const SLACK_BY_RUN: f64 = 0.4;
        const MOST_BEYOND: f64 = 0.05;
        stand.parts.iter().zip(&stand.functions).all(|(part, function)| {
            let Some(function) = function else { return true };
            let term = &self.cause(&part.trial).terms[part.trial.terms[0]];
            let position = stand.position(part.trial.columns[0]);
            let even = position.map_or(0.0, |position| stand.estimate.beta[position]);
            let all = || function.values.iter().flat_map(|(values, sds)| values.iter().zip(sds.iter()));
            let reach = all().fold(f64::NEG_INFINITY, |most, (value, _)| most.max(*value))
                - all().fold(f64::INFINITY, |least, (value, _)| least.min(*value));
            let levels = all().map(|(value, _)| even + value);
            if self.case.is_left_out_as(self.cause(&part.trial)) && is_level(levels) {
                return false;
            }
            let by_run = self.cause(&part.trial).by_run;
            let widest = all().map(|(_, sd)| *sd).fold(0.0, f64::max);
            if by_run && !term.has_room_for(reach, SIGMAS * widest) {
                return false;
            }
            let slack = if by_run { SLACK_BY_RUN } else { SLACK };
            let beyond = all().filter(|(value, sd)| {
                let (value, known) = (even + **value, SIGMAS * **sd + slack * reach);
                value + known < term.low || value - known > term.high
            });
            beyond.count() as f64 <= MOST_BEYOND * all().count() as f64
        })
    }

    /// Whether a part is a function of time of each run, or works in one run alone.
    pub fn timed(&self, part: &Part) -> bool {
        let cause = self.cause(&part.trial);
        let own = |spread: &Spread| cause.form == Form::OverTime && !spread.shared;
        cause.run.is_some() || part.spread.as_ref().is_some_and(own)
    }

    /// Cost of the choice of these causes, and of what no other run shows.
    pub fn choices(&self, parts: &[Part]) -> f64 {
        /// A function of time is shown by no other run, nor is one of a path that only one drove: it takes so much more.
        const NO_OTHER_RUN: f64 = 20.0;
        /// Consumers that nobody logged are the rule on a battery, whose current hides little else.
        const CONSUMER: f64 = 14.0;
        let battery = self.system.kinds.iter().position(|kind| *kind == Kind::Battery);
        let cost = |part: &Part| {
            let own = |spread: &Spread| {
                let of_place = self.cause(&part.trial).form == Form::OverPosition && !self.paths_shared();
                of_place || spread.shared && self.case.cycles == Cycles::Same
            };
            let alone = self.timed(part) || part.spread.as_ref().is_some_and(own);
            let consumer = part.spread.is_some()
                && self.id(&part.trial) == "auxiliary_power"
                && battery.is_some_and(|battery| self.touches(&part.trial, battery));
            let unshared = if consumer { CONSUMER } else { NO_OTHER_RUN };
            choice(self.cause(&part.trial)) + if alone { unshared } else { 0.0 }
        };
        parts.iter().map(cost).sum()
    }

    /// Whether any two fitted runs drove the same path.
    pub fn paths_shared(&self) -> bool {
        share_paths(&self.case.runs, self.fit)
    }

    /// All columns and the residual, multiplied at a noise, with the functions of a set eliminated.
    pub fn reduced(&self, noises: &Noises, parts: &[Part]) -> Option<Reduced> {
        let columns: Vec<&Column> = self.pool.columns.iter().collect();
        let whitened = Whitened::new(&self.system.chunks, &self.system.residual, &columns, noises)?;
        self.without_functions(&whitened, &self.profiles(parts), self.fit)
    }

    /// The functions of a set, part by part.
    pub fn profiles(&self, parts: &[Part]) -> Vec<Option<(Profile<'a>, Spread)>> {
        let of = |part: &Part| {
            let spread = part.spread.clone()?;
            Some((self.profile(&part.trial, spread.shared), spread))
        };
        parts.iter().map(of).collect()
    }

    /// Whether the first column of a trial shows in a balance.
    pub fn touches(&self, trial: &Trial, balance: usize) -> bool {
        let signature = &self.pool.columns[trial.columns[0]];
        let own = self.system.chunks.iter().zip(signature).filter(|(chunk, _)| chunk.balance == balance);
        own.into_iter().any(|(_, values)| values.iter().any(|value| *value != 0.0))
    }

    /// Whether a function can stand beside those of a set: it has rows to itself, or few enough share them.
    pub fn fits_beside(&self, trial: &Trial, parts: &[Part]) -> bool {
        let steady = |part: &Part| {
            let cause = self.cause(&part.trial);
            !cause.by_run && part.spread.as_ref().is_none_or(|spread| spread.jumps.is_none())
        };
        let own = Part { trial: trial.clone(), spread: None };
        let shared = parts.iter().filter(|part| part.spread.is_some()).collect::<Vec<_>>();
        let few = self.system.row_count() <= MANY_ROWS
            && shared.len() < abreast::MOST
            && steady(&own)
            && shared.iter().all(|part| steady(part))
            && shared.iter().all(|part| self.both_ways(trial, &part.trial));
        few || self.apart(trial, parts)
    }

    /// Whether a path that shows two functions of it was driven both ways, where that alone tells them apart.
    fn both_ways(&self, one: &Trial, other: &Trial) -> bool {
        if twin(self.id(one)) != Some(self.id(other)) {
            return true;
        }
        let column = |trial: &Trial| &self.pool.columns[trial.columns[0]];
        let mut ways: Vec<(usize, bool)> = Vec::new();
        for (index, chunk) in self.system.chunks.iter().enumerate().filter(|(_, chunk)| self.fit[chunk.run]) {
            let product = column(one)[index].dot(&column(other)[index]);
            let way = (self.case.runs[chunk.run].path, product > 0.0);
            if product != 0.0 && !ways.contains(&way) {
                ways.push(way);
            }
        }
        ways.iter().any(|(path, way)| ways.contains(&(*path, !way)))
    }

    /// Whether a function has rows to itself beside those of a set.
    pub fn apart(&self, trial: &Trial, parts: &[Part]) -> bool {
        let touched = |trial: &Trial| -> Vec<bool> {
            (0..self.system.kinds.len()).map(|number| self.touches(trial, number)).collect()
        };
        let own = touched(trial);
        let functions = parts.iter().filter(|part| part.spread.is_some());
        !functions
            .into_iter()
            .any(|part| touched(&part.trial).iter().zip(&own).any(|(one, other)| *one && *other))
    }

    /// The function of a trial, which all runs may share, on the rows.
    pub fn profile(&self, trial: &Trial, shared: bool) -> Profile<'a> {
        Profile::new(
            self.system,
            &self.case.runs,
            (self.cause(trial).form, shared),
            &self.pool.columns[trial.columns[0]],
        )
    }

    /// ln p of the recordings with a set of causes at a noise, without what the choice costs; none where it cannot be.
    pub fn likely(&self, parts: &[Part], noises: &Noises) -> Option<f64> {
        let (score, beta) = self.weighed(parts, noises)?;
        (!self.beyond(parts, &beta)).then_some(score)
    }

    /// ln p of the recordings with a set of causes at a noise, and the values of all columns in use.
    pub fn weighed(&self, parts: &[Part], noises: &Noises) -> Option<(f64, DVector<f64>)> {
        let Chosen { used, columns, sd, places } = self.chosen(parts);
        let whitened = Whitened::new(&self.system.chunks, &self.system.residual, &columns, noises)?;
        let reduced = self.without_functions(&whitened, &self.profiles(parts), self.fit)?;
        let estimate = reduced.estimate(&places, &sd)?;
        Some((estimate.log_evidence + self.heavy(&used, &estimate.beta), estimate.beta))
    }

    /// Estimates a set of causes, and lets the noise follow.
    pub fn settle(&self, parts: &[Part], start: &Noises) -> Option<Stand> {
        const ROUNDS: usize = 12;
        const LEAST_ROUNDS: usize = 8;
        /// A growth of ln p below this is none.
        const SETTLED: f64 = 0.02;
        /// Rows that stray are many, and find their weights slowly; what is left to find does not decide.
        const ROUNDS_ASTRAY: usize = 4;
        const SETTLED_ASTRAY: f64 = 1.0;
        let (rounds, settled) =
            if start.tails.is_some() { (ROUNDS_ASTRAY, SETTLED_ASTRAY) } else { (ROUNDS, SETTLED) };
        let Chosen { used, columns, sd, places } = self.chosen(parts);
        let mut parts = parts.to_vec();
        let mut profiles = self.profiles(&parts);
        let chunks = &self.system.chunks;
        let mut noises = start.clone();
        let mut best: Option<Stand> = None;
        // Where a function may jump, its freedom has to be found first.
        let jumps =
            parts.iter().any(|part| part.spread.as_ref().is_some_and(|spread| spread.jumps.is_some()));
        let least = if jumps { LEAST_ROUNDS } else { 0 };
        let gathered = |noises: &Noises, profiles: &Profiles| {
            let whitened = Whitened::new(chunks, &self.system.residual, &columns, noises)?;
            self.gathered(&whitened, profiles, self.fit)
        };
        let mut told = None;
        for round in 0..rounds + least {
            let own = match told.take() {
                Some(own) => own,
                None => gathered(&noises, &profiles)?,
            };
            let solved = own.solved(&profiles)?;
            let estimate = solved.reduced.estimate(&places, &sd)?;
            let mut left = self.left(&used, &estimate.beta);
            let made = solved.functions(&estimate.beta, Widths::Left);
            for (one, made) in profiles.iter().zip(&made) {
                let (Some((profile, _)), Some(made)) = (one, made) else { continue };
                for (left, rows) in left.iter_mut().zip(profile.rows(self.system, made)) {
                    *left -= rows;
                }
            }
            let next = if round >= least {
                self.system.noises_like(&left, self.fit, Some(&noises))
            } else {
                noises.clone()
            };
            let score = estimate.log_evidence + self.heavy(&used, &estimate.beta) - self.choices(&parts)
                + self.system.prior(&noises);
            let better = best.as_ref().is_none_or(|one| score > one.score + settled);
            if !better && round >= least {
                break;
            }
            let spreads: Vec<Option<Spread>> = parts
                .iter()
                .zip(&made)
                .map(|(part, made)| Some(part.spread.as_ref()?.relaxed(made.as_ref()?)))
                .collect();
            if better {
                let (parts, used) = (parts.clone(), used.clone());
                let noises = noises.clone();
                best = Some(Stand { parts, used, noises, estimate, score, left, functions: made });
            }
            for ((part, profile), spread) in parts.iter_mut().zip(&mut profiles).zip(spreads) {
                if let (Some((_, own)), Some(spread)) = (profile, &spread) {
                    own.clone_from(spread);
                }
                part.spread = spread;
            }
            // Until then the noise stays what neighbouring rows show.
            if round >= least {
                noises = next;
            } else {
                told = Some(own);
            }
        }
        best.map(|stand| Stand { functions: self.drawn(&stand, &stand.noises, self.fit), ..stand })
    }

    /// The functions of a set at a noise, as some runs tell them, each with how well it is known.
    pub fn drawn(&self, stand: &Stand, noises: &Noises, runs: &[bool]) -> Vec<Option<Function>> {
        let profiles = self.profiles(&stand.parts);
        if profiles.iter().all(Option::is_none) {
            return vec![None; profiles.len()];
        }
        let columns: Vec<&Column> = stand.used.iter().map(|column| &self.pool.columns[*column]).collect();
        let chunks = &self.system.chunks;
        let whitened = Whitened::new(chunks, &self.system.residual, &columns, noises);
        let Some(whitened) = whitened else { return vec![None; profiles.len()] };
        let solved = self.gathered(&whitened, &profiles, runs).and_then(|told| told.solved(&profiles));
        let told = solved.map(|solved| solved.functions(&stand.estimate.beta, Widths::Wanted));
        told.unwrap_or_else(|| vec![None; profiles.len()])
    }

    /// What columns of these values leave of every row.
    pub fn left(&self, used: &[usize], beta: &DVector<f64>) -> Column {
        let mut left = self.system.residual.clone();
        for (column, value) in used.iter().zip(beta.iter()) {
            for (chunk, values) in left.iter_mut().zip(&self.pool.columns[*column]) {
                *chunk -= values * *value;
            }
        }
        left
    }
}

impl Stand {
    /// Position among the columns in use.
    pub fn position(&self, column: usize) -> Option<usize> {
        self.used.iter().position(|used| *used == column)
    }

    /// The value of a column in use, 0 where it is not.
    pub fn value(&self, column: usize) -> f64 {
        self.position(column).map_or(0.0, |position| self.estimate.beta[position])
    }

    /// What one part does to every row.
    pub fn effect(&self, state: &State, part: &Part) -> Column {
        let mut rows: Column =
            state.system.chunks.iter().map(|chunk| DVector::zeros(chunk.rows.len())).collect();
        for column in part.trial.columns.iter().chain(part.beside()) {
            let value = self.value(*column);
            for (row, values) in rows.iter_mut().zip(&state.pool.columns[*column]) {
                *row += values * value;
            }
        }
        let place = self.parts.iter().position(|own| own.trial.columns == part.trial.columns);
        if let Some(Some(function)) = place.and_then(|place| self.functions.get(place)) {
            let made = state.profile(&part.trial, function.spread.shared).rows(state.system, function);
            for (row, values) in rows.iter_mut().zip(made) {
                *row += values;
            }
        }
        rows
    }
}

/// Whether values hardly differ.
fn is_level(values: impl Iterator<Item = f64>) -> bool {
    /// Their scatter, of what they are on average.
    const HARDLY: f64 = 0.2;
    let values: Vec<f64> = values.collect();
    let level = mean(&values);
    let squares: Vec<f64> = values.iter().map(|value| (value - level).powi(2)).collect();
    mean(&squares).sqrt() < HARDLY * level.abs()
}

#[cfg(test)]
mod tests {
    use super::is_level;

    /// A load of a tonne that lacked to ten kilograms was told in the place of a mass that nobody wanted.
    #[test]
    fn what_hardly_changes_is_level_and_what_comes_and_goes_is_not() {
        let of = |change_kg: f64| (0..40).map(move |at| -1060.0 + change_kg * f64::from(at % 2));
        assert!(is_level(of(20.0)) && !is_level(of(1060.0)));
        assert!(!is_level((0..40).map(|at| 50.0 * f64::from(at - 20))));
    }
}
