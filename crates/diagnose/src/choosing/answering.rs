//! A driver, or a governor, that keeps a speed answers what is missing with force: what is in proportion to the measured force then
//! goes with whatever is not explained yet.
//!
//! With F = Z + e, where Z is what the model knows of and e what it does not, a regression on F makes ⟨e²⟩/⟨F²⟩ of e its own. An
//! instrument tells: a cause in proportion to F shows as much in rows of Z. There e is what is left in the mean of a row and those
//! beside it: their noise of the speed is correlated with its own by −½ each, and takes itself back.
//! Source: instrumental variables and the test of Hausman; Greene, *Econometric Analysis* (2018), section 8.

use crate::balances::balance::Kind;
use crate::balances::gram::{Column, Reduced, Whitened};
use crate::balances::noise::{Noise, Noises};
use crate::balances::rows::Chunk;
use crate::causes::sensors::interpolate;
use crate::choosing::state::{Part, Stand, State};
use nalgebra::DVector;

impl State<'_> {
    /// Whether no cause of a set is in proportion to a measured force and there only because that force answers to what is left.
    pub fn needs_no_answer(&self, stand: &Stand) -> bool {
        !stand.parts.iter().any(|part| self.is_an_answer(stand, part).unwrap_or(false))
    }

    /// Whether an instrument shows a cause of another size; none of one that is in no proportion to a measured force.
    fn is_an_answer(&self, stand: &Stand, part: &Part) -> Option<bool> {
        /// So much of a cause an instrument may show it smaller or larger.
        const APART: f64 = 0.5;
        let ([own], None) = (&part.trial.columns[..], &part.spread) else { return None };
        let own_rows = &self.pool.columns[*own];
        let shares = self.in_proportion_to_force(own_rows)?;
        let position = stand.position(*own)?;
        let value = stand.estimate.beta[position];
        let [left, again] = [&self.answered(stand), own_rows].map(|rows| times(&self.around(rows), &shares));
        let chosen = self.chosen(&stand.parts);
        let mut columns = chosen.columns.clone();
        columns.extend([&left, &again]);
        let system = self.system;
        let noises = self.even(stand);
        let whitened = Whitened::new(&system.chunks, &system.residual, &columns, &noises)?;
        let reduced = self.without_functions(&whitened, &self.profiles(&stand.parts), self.fit)?;
        // Where the known force shows next to nothing of it, no size is found, and all of it is an answer.
        let told = by_instrument(&reduced, &chosen.sd, (position, value));
        Some(told.is_none_or(|told| (told - value).abs() > APART * value.abs()))
    }

    /// Noise that weighs all rows of the motion balance alike, but for those that stray: what lasts is to be seen here.
    fn even(&self, stand: &Stand) -> Noises {
        let squares = self.system.mean_squares(&stand.left, self.fit);
        let mut noises = stand.noises.clone();
        for ((noise, kind), square) in noises.each.iter_mut().zip(&self.system.kinds).zip(squares) {
            if *kind == Kind::Motion {
                *noise = Noise { sensor: 0.0, process: square, persistence: 0.0, ..*noise };
            }
        }
        noises
    }

    /// Force that answers what a set leaves, sample by sample of every run [N].
    pub fn answers_n(&self, stand: &Stand) -> Vec<Vec<f64>> {
        let around = self.around(&self.answered(stand));
        let of_run = |run: usize| {
            let own = self
                .system
                .chunks
                .iter()
                .zip(&around)
                .filter(|(chunk, _)| chunk.run == run && self.system.kind(chunk) == Kind::Motion);
            let (mut at_s, mut left_n) = (Vec::new(), Vec::new());
            for (row, value) in own.flat_map(|(chunk, rows)| chunk.rows.iter().zip(rows.iter())) {
                at_s.push(row.time_s);
                left_n.push(*value);
            }
            let time_s = self.case.runs[run].measured.trace.time_s();
            if at_s.is_empty() {
                return vec![0.0; time_s.len()];
            }
            time_s.iter().map(|time_s| interpolate(&at_s, &left_n, *time_s)).collect()
        };
        (0..self.case.runs.len()).map(of_run).collect()
    }

    /// What a force answers to: what is left, and the functions of a set, which their priors hold back.
    fn answered(&self, stand: &Stand) -> Column {
        let mut rows = stand.left.clone();
        for part in stand.parts.iter().filter(|part| part.spread.is_some()) {
            for (rows, effect) in rows.iter_mut().zip(stand.effect(self, part)) {
                *rows += effect;
            }
        }
        rows
    }

    /// What a column is of the measured force, row by row; none where it is in no proportion to one.
    fn in_proportion_to_force(&self, column: &Column) -> Option<Column> {
        /// Squared correlation, about nought, of what is in proportion.
        const ALIKE: f64 = 0.99;
        /// A force is none that is less than this share of the usual one.
        const LEAST: f64 = 0.02;
        let runs = &self.case.runs;
        let force = self.system.column(|kind| match kind {
            Kind::Motion => runs.iter().map(|run| run.force_n.clone().unwrap_or_default()).collect(),
            _ => vec![Vec::new(); runs.len()],
        });
        let (mut products, mut squares, mut forces, mut rows) = (0.0, 0.0, 0.0, 0);
        for ((chunk, own), force) in self.system.chunks.iter().zip(column).zip(&force) {
            if self.fit[chunk.run] && self.system.kind(chunk) == Kind::Motion {
                products += own.abs().dot(&force.abs());
                squares += own.norm_squared();
                forces += force.norm_squared();
                rows += own.len();
            }
        }
        if squares * forces == 0.0 || products.powi(2) < ALIKE * squares * forces {
            return None;
        }
        let least_n = LEAST * (forces / rows as f64).sqrt();
        let share = |(own, force): (&f64, &f64)| if force.abs() < least_n { 0.0 } else { own / force };
        let of_chunk = |(own, force): (&DVector<f64>, &DVector<f64>)| {
            DVector::from_iterator(own.len(), own.iter().zip(force.iter()).map(share))
        };
        Some(column.iter().zip(&force).map(of_chunk).collect())
    }

    /// Mean of the rows around each row of the motion balance, its own among them.
    fn around(&self, rows: &Column) -> Column {
        /// So long to either side: a driver is as slow [s].
        const AROUND_S: f64 = 1.0;
        let around = |(chunk, rows): (&Chunk, &DVector<f64>)| {
            if self.system.kind(chunk) != Kind::Motion {
                return DVector::zeros(rows.len());
            }
            let block_s = self.system.blocks_s[chunk.balance];
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small and positive")]
            let reach = ((AROUND_S / block_s).round() as usize).max(1);
            let mean = |row: usize| {
                let (first, last) = (row.saturating_sub(reach), (row + reach).min(rows.len() - 1));
                rows.rows_range(first..=last).mean()
            };
            DVector::from_iterator(rows.len(), (0..rows.len()).map(mean))
        };
        self.system.chunks.iter().zip(rows).map(around).collect()
    }
}

/// Two columns row by row.
fn times(one: &Column, other: &Column) -> Column {
    one.iter().zip(other).map(|(one, other)| one.component_mul(other)).collect()
}

/// A column's size by an instrument: by itself without what the force makes of what is left; none where it does not settle. The last
/// two columns are that of what the rows leave, and of the column itself.
fn by_instrument(reduced: &Reduced, sd: &[f64], (position, value): (usize, f64)) -> Option<f64> {
    const ROUNDS: usize = 50;
    /// Of what was estimated.
    const SETTLED: f64 = 0.01;
    let used = sd.len();
    let others: Vec<usize> = (0..used).filter(|column| *column != position).collect();
    let known = reduced.estimate(&others, sd)?;
    let with = |column: usize| DVector::from_fn(used - 1, |row, _| reduced.matrix[(others[row], column)]);
    let own = &known.covariance * with(position);
    // Products with the rows and with the column, the others projected out.
    let product = |column: usize| {
        let cross = with(column);
        (
            reduced.vector[column] - cross.dot(&known.beta),
            reduced.matrix[(column, position)] - cross.dot(&own),
        )
    };
    let (itself, left, again) = (product(position), product(used), product(used + 1));
    let next = |told: f64| {
        let of = |itself: f64, left: f64, again: f64| itself - left - (value - told) * again;
        of(itself.0, left.0, again.0) / of(itself.1, left.1, again.1)
    };
    let told = (0..ROUNDS).fold(value, |told, _| next(told));
    ((next(told) - told).abs() < SETTLED * value.abs()).then_some(told)
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_calibrate::statistics::Draws;
    use nalgebra::DMatrix;

    /// Estimate and size by the instrument of a loss in proportion to a force of known part Z and an answer e, of which the rows
    /// hold a share of the force and what is not known.
    fn told(share: f64, unknown: f64) -> (f64, f64) {
        const ROWS: usize = 4000;
        let mut draws = Draws::new(5, 1);
        let mut e = 0.0;
        let mut answers = || {
            e = 0.95 * e + (1.0_f64 - 0.95 * 0.95).sqrt() * draws.normal();
            unknown * e
        };
        let e = DVector::from_fn(ROWS, |_, _| answers());
        let force = DVector::from_fn(ROWS, |_, _| draws.normal()) + &e;
        let rows = &force * share + &e + DVector::from_fn(ROWS, |_, _| 0.1 * draws.normal());
        let value = force.dot(&rows) / force.dot(&force);
        let left = &rows - &force * value;
        let around = |of: &DVector<f64>| {
            DVector::from_fn(ROWS, |row, _| {
                let near = row.saturating_sub(1)..(row + 2).min(ROWS);
                near.clone().map(|other| of[other]).sum::<f64>() / near.len() as f64
            })
        };
        let columns = DMatrix::from_columns(&[force.clone(), around(&left), around(&force)]);
        let reduced = Reduced {
            matrix: columns.transpose() * &columns,
            vector: columns.transpose() * &rows,
            scalar: rows.dot(&rows),
            log_determinant: 0.0,
            rows: ROWS,
        };
        (value, by_instrument(&reduced, &[1e3], (0, value)).unwrap())
    }

    /// ⟨e²⟩/⟨F²⟩ = 0.49/1.49 where there is no loss at all.
    #[test]
    fn an_answer_looks_like_a_third_of_the_force_and_is_none_by_the_instrument() {
        let (estimate, told) = told(0.0, 0.7);
        assert!((estimate - 0.49 / 1.49).abs() < 0.03, "{estimate}");
        assert!(told.abs() < 0.05, "{told}");
    }

    #[test]
    fn a_loss_is_as_large_by_the_instrument() {
        let (estimate, told) = told(0.08, 0.0);
        assert!((told - 0.08).abs() < 0.01 && (estimate - told).abs() < 0.01, "{estimate} {told}");
    }
}
