//! Causes whose parameter is a function: of the position along a path, or of time in one run.
//!
//! The function is a Gaussian process of Ornstein and Uhlenbeck on evenly spaced knots, linear in between. Its length and
//! its size are those that make the recording most likely; so its freedom grows only as far as the data carry it. Where it
//! may jump, its increments are as free as they need to be, one by one.
//! Each path (or run) has knots of its own, which are eliminated before anything else is estimated.
//! Source: Rasmussen and Williams, *Gaussian Processes for Machine Learning* (2006), sections 2.7 and B.2.1.

use crate::balances::balance::System;
use crate::balances::gram::Column;
use crate::balances::rows::{Chunk, Row};
use crate::causes::catalogue::Form;
use crate::causes::jumps::Jumps;
use crate::runs::recorded::Recorded;
use nalgebra::{DMatrix, DVector};

/// How a function is spread over knots.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// Distance over which it forgets itself [m or s].
    pub length: f64,
    /// Its standard deviation, in the unit of the cause's parameter.
    pub size: f64,
    /// Knots to one length: between them it is straight.
    pub knots_per_length: f64,
    /// Where it may jump.
    pub jumps: Option<Jumps>,
    /// Whether all runs take one and the same course of time, each from its own start.
    pub shared: bool,
}

/// The knots of one path or run.
#[derive(Clone, Debug)]
pub struct Group {
    /// Where the first knot lies.
    pub from: f64,
    /// Distance between knots.
    pub step: f64,
    /// How many there are.
    pub count: usize,
}

/// A function-valued cause on the rows of a balance.
pub struct Profile<'a> {
    /// What a parameter of one does to each row.
    pub signature: &'a Column,
    /// Position or time of each row.
    pub at: Column,
    /// Path or run of each run.
    pub group_of: Vec<usize>,
    /// Least and greatest `at` of each group.
    pub extents: Vec<(f64, f64)>,
    /// How many rows each group has.
    pub rows: Vec<usize>,
}

/// Whether it is asked how well a function is known at its knots, which takes longer than the function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Widths {
    /// It is.
    Wanted,
    /// It is not, and standard deviations are NaN but for functions that may jump.
    Left,
}

/// A function that was estimated.
#[derive(Clone, Debug)]
pub struct Function {
    /// Knots of each group.
    pub groups: Vec<Group>,
    /// Values at the knots, and their standard deviations.
    pub values: Vec<(DVector<f64>, DVector<f64>)>,
    /// How it is spread.
    pub spread: Spread,
    /// Squares of its increments, with what is not known of them, in units of their usual variance.
    pub squares: Vec<Vec<f64>>,
}

/// Knots of a group are at most so many: a drive of 25 minutes has as many rows of a second, and they tell no more.
const MOST_KNOTS: f64 = 1500.0;
/// What may jump anywhere has a knot at every so many rows of the balance that shows it: a step shows in two.
pub const KNOTS_OF_JUMPS: f64 = 2.0;
/// Knots to one length of the process, enough to find it.
pub const COARSE: f64 = 2.0;
/// Enough to draw it: the process is rough within its length.
pub const FINE: f64 = 8.0;
/// The same of a function of time, which is switched at once, where no road climbs at once.
pub const FINE_IN_TIME: f64 = 40.0;

impl<'a> Profile<'a> {
    /// A function of the position or of time, which all runs may share, with what a parameter of one does to each row.
    pub fn new(
        system: &System,
        runs: &[Recorded],
        (form, shared): (Form, bool),
        signature: &'a Column,
    ) -> Self {
        let over_position = form == Form::OverPosition;
        let group_of: Vec<usize> = runs.iter().map(|run| group(form, shared, run)).collect();
        let groups = group_of.iter().max().map_or(0, |most| most + 1);
        let mut extents = vec![(f64::INFINITY, f64::NEG_INFINITY); groups];
        let mut rows = vec![0; groups];
        let of_chunk = |chunk: &Chunk| {
            let place = |row: &Row| {
                let at = if over_position { row.mean(&runs[chunk.run].position_m) } else { row.time_s };
                if at.is_finite() { at } else { 0.0 }
            };
            let at = DVector::from_iterator(chunk.rows.len(), chunk.rows.iter().map(place));
            let extent = &mut extents[group_of[chunk.run]];
            *extent = (extent.0.min(at.min()), extent.1.max(at.max()));
            rows[group_of[chunk.run]] += chunk.rows.len();
            at
        };
        let at: Column = system.chunks.iter().map(of_chunk).collect();
        for extent in &mut extents {
            if !extent.0.is_finite() {
                *extent = (0.0, 1.0);
            }
        }
        Self { signature, at, group_of, extents, rows }
    }

    /// What the function does to every row.
    pub fn rows(&self, system: &System, function: &Function) -> Column {
        let of_chunk = |(index, chunk): (usize, &Chunk)| {
            let group = self.group_of[chunk.run];
            self.signature[index]
                .zip_map(&self.at[index], |signature, at| signature * function.value(group, at))
        };
        system.chunks.iter().enumerate().map(of_chunk).collect()
    }

    /// Whether the function does anything in a chunk.
    pub fn touches(&self, chunk: usize) -> bool {
        self.signature[chunk].iter().any(|value| *value != 0.0)
    }

    /// Whether another function acts on some of its rows.
    pub fn shares_rows(&self, other: &Profile) -> bool {
        (0..self.signature.len()).any(|chunk| self.touches(chunk) && other.touches(chunk))
    }

    /// Longest stretch that a group covers [m or s].
    pub fn longest(&self) -> f64 {
        self.extents.iter().map(|(from, to)| to - from).fold(0.0, f64::max)
    }

    /// The knots of every group.
    pub fn groups(&self, spread: &Spread) -> Vec<Group> {
        self.extents
            .iter()
            .zip(&self.rows)
            .enumerate()
            .map(|(number, ((from, to), rows))| {
                let told = spread.jumps.as_ref().and_then(|jumps| Some((jumps.step, jumps.knots(number)?)));
                if let Some((step, (from, count))) = told {
                    return Group { from, step, count };
                }
                let range = (to - from).max(1e-9);
                let wanted =
                    spread.jumps.as_ref().map_or(spread.length / spread.knots_per_length, |jumps| jumps.step);
                // Between two rows nothing is told.
                let step = wanted.max(range / MOST_KNOTS.min((*rows).max(1) as f64));
                // Between 2 and some hundreds.
                #[allow(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "small and positive"
                )]
                let count = (range / step).ceil() as usize + 1;
                Group { from: *from, step, count: count.max(2) }
            })
            .collect()
    }

    /// The first and the last knot that a chunk touches.
    pub fn touched(&self, index: usize, group: &Group) -> (usize, usize) {
        let at = &self.at[index];
        (knot(group, at.min()).0, (knot(group, at.max()).0 + 1).min(group.count - 1))
    }

    /// Signature times hat functions, for the knots that a chunk touches.
    pub fn basis(&self, index: usize, chunk: &Chunk, group: &Group) -> (usize, DMatrix<f64>) {
        let at = &self.at[index];
        let (low, high) = self.touched(index, group);
        let mut basis = DMatrix::zeros(chunk.rows.len(), high - low + 1);
        for row in 0..chunk.rows.len() {
            let (left, share) = knot(group, at[row]);
            basis[(row, left - low)] += (1.0 - share) * self.signature[index][row];
            if left < high {
                basis[(row, left + 1 - low)] += share * self.signature[index][row];
            }
        }
        (low, basis)
    }
}

/// The path or run of a run, by number, whose function it takes.
fn group(form: Form, shared: bool, run: &Recorded) -> usize {
    match form {
        Form::OverPosition => run.path,
        _ if shared => 0,
        _ => run.number,
    }
}

/// The knot to the left, and the share of the way to the next.
fn knot(group: &Group, at: f64) -> (usize, f64) {
    let steps = ((at - group.from) / group.step).clamp(0.0, (group.count - 1) as f64);
    // Clamped just above.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and the count")]
    let left = (steps.floor() as usize).min(group.count.saturating_sub(2));
    (left, steps - left as f64)
}

impl Function {
    /// The group of a run: of its path, or of itself.
    pub fn group_of(&self, form: Form, run: &Recorded) -> usize {
        group(form, self.spread.shared, run)
    }

    /// The function and a value that it has everywhere beside.
    pub fn raised(mut self, by: f64) -> Self {
        for (values, _) in &mut self.values {
            values.add_scalar_mut(by);
        }
        self
    }

    /// The function of a group and what was told beside it at some places; a knot takes the mean of what was told about it, or
    /// what the last one before it took.
    pub fn add(&mut self, group: usize, told: &[(f64, f64)]) {
        let own = &self.groups[group];
        let (mut sums, mut weights) = (vec![0.0; own.count], vec![0.0; own.count]);
        for (at, value) in told {
            let (left, share) = knot(own, *at);
            for (place, weight) in [(left, 1.0 - share), (left + 1, share)] {
                sums[place] += weight * value;
                weights[place] += weight;
            }
        }
        let mut last = 0.0;
        for ((value, sum), weight) in self.values[group].0.iter_mut().zip(sums).zip(weights) {
            if weight > 0.0 {
                last = sum / weight;
            }
            *value += last;
        }
    }

    /// Its value somewhere.
    pub fn value(&self, group: usize, at: f64) -> f64 {
        let (left, share) = knot(&self.groups[group], at);
        let values = &self.values[group].0;
        (1.0 - share) * values[left] + share * values[(left + 1).min(values.len() - 1)]
    }

    /// Where the knots of a group lie.
    pub fn knots(&self, group: usize) -> Vec<f64> {
        let Group { from, step, count } = self.groups[group];
        (0..count).map(|index| from + step * index as f64).collect()
    }
}

/// What is left of a function's value at the next knot.
pub fn forgetting(group: &Group, spread: &Spread) -> f64 {
    (-group.step / spread.length).exp()
}

/// Usual variance of an increment.
pub fn innovation(group: &Group, spread: &Spread) -> f64 {
    let phi = forgetting(group, spread);
    spread.size * spread.size * (1.0 - phi * phi)
}

impl Spread {
    /// A function that stays and then jumps on knots `step` apart, whose usual size is `scale`: between jumps it wanders by its size in so many
    /// times its steps, and jumps find their own size.
    pub fn jumping(step: f64, scale: f64) -> Self {
        const LENGTHS: f64 = 200.0;
        const SIZE: f64 = 0.3;
        Self {
            length: LENGTHS * step,
            size: SIZE * scale,
            knots_per_length: COARSE,
            jumps: Some(Jumps::unknown(step)),
            shared: false,
        }
    }

    /// The same function, for one of this scale, where nothing is known of its increments.
    pub fn afresh(&self, scale: f64) -> Self {
        match &self.jumps {
            Some(jumps) if jumps.is_told() => Self::jumping(KNOTS_OF_JUMPS * jumps.step, scale),
            Some(jumps) => Self { jumps: Some(Jumps::unknown(jumps.step)), ..self.clone() },
            None => self.clone(),
        }
    }

    /// Factor of the precision of an increment.
    fn weight(&self, number: usize, increment: usize) -> f64 {
        self.jumps.as_ref().map_or(1.0, |jumps| jumps.weight(number, increment))
    }

    /// As the increments of a function ask for it: each as free as it was found to be, and all of the size that suits them.
    pub fn relaxed(&self, function: &Function) -> Self {
        /// The size may change so much in a round.
        const MOST: f64 = 3.0;
        let Some(jumps) = self.jumps.as_ref().filter(|jumps| !jumps.is_told()) else { return self.clone() };
        let (mut sum, mut count) = (0.0, 0usize);
        for (number, squares) in function.squares.iter().enumerate() {
            for (increment, square) in squares.iter().enumerate() {
                sum += jumps.weight(number, increment) * square;
                count += 1;
            }
        }
        let growth = (sum / count.max(1) as f64).sqrt().clamp(1.0 / MOST, MOST);
        let scaled = |squares: &Vec<f64>| squares.iter().map(|square| square / (growth * growth)).collect();
        let squares = function.squares.iter().map(scaled).collect();
        Self { size: self.size * growth, jumps: Some(Jumps::of(jumps.step, squares)), ..*self }
    }
}

/// What the prior's precision is made of: row, column (not right of the diagonal), and what is added there.
pub fn precision_entries(number: usize, group: &Group, spread: &Spread) -> Vec<(usize, usize, f64)> {
    let phi = forgetting(group, spread);
    let usual = innovation(group, spread);
    let mut all = vec![(0, 0, 1.0 / (spread.size * spread.size))];
    for row in 1..group.count {
        let scale = spread.weight(number, row - 1) / usual;
        all.extend([(row, row, scale), (row, row - 1, -scale * phi), (row - 1, row - 1, scale * phi * phi)]);
    }
    all
}

/// ln |P| in closed form, and what a bound of the prior is below it, twice.
pub fn log_precision(number: usize, group: &Group, spread: &Spread) -> f64 {
    let increments = group.count - 1;
    let weights: f64 = (0..increments).map(|increment| spread.weight(number, increment).ln()).sum();
    let bound = spread.jumps.as_ref().map_or(0.0, |jumps| jumps.bound(number, increments));
    weights - 2.0 * spread.size.ln() - increments as f64 * innovation(group, spread).ln() + 2.0 * bound
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::causes::band::Band;

    fn precision(group: &Group, spread: &Spread) -> Band {
        let mut band = Band::zeros(group.count, 1);
        for (row, column, value) in precision_entries(0, group, spread) {
            band.add(row, column, value);
        }
        band
    }

    #[test]
    fn the_closed_form_of_the_determinant_is_that_of_the_matrix() {
        let group = Group { from: 0.0, step: 3.0, count: 7 };
        let spread = Spread { length: 10.0, size: 0.3, knots_per_length: COARSE, jumps: None, shared: false };
        let direct = precision(&group, &spread).cholesky().unwrap().log_determinant();
        assert!((direct - log_precision(0, &group, &spread)).abs() < 1e-9);
    }

    #[test]
    fn the_precision_is_the_inverse_of_an_exponential_covariance() {
        let group = Group { from: 0.0, step: 3.0, count: 5 };
        let spread = Spread { length: 10.0, size: 0.3, knots_per_length: COARSE, jumps: None, shared: false };
        let factor = precision(&group, &spread).cholesky().unwrap();
        let row = factor.solve(&DVector::from_fn(5, |knot, _| f64::from(knot == 3)));
        let expected = 0.09 * (-6.0_f64 / 10.0).exp();
        assert!((row[1] - expected).abs() < 1e-12 && (row[3] - 0.09).abs() < 1e-12);
        assert!((factor.inverse_diagonals().0[2] - 0.09).abs() < 1e-12);
    }
}
