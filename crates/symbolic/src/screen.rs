//! Every term of the dictionary against what is left, by scalar products alone.
//!
//! With the columns Q of the law so far made orthonormal, a column d adds (dᵀr)² / (dᵀd − |Qᵀd|²) to what is explained.
//! For waves the dictionary is as fine as the record is long, so this is a periodogram of whitened rows in which
//! nothing counts that the nuisances or the law so far can imitate.
//! Source: orthogonal matching pursuit, Pati, Rezaiifar and Krishnaprasad, 27th Asilomar Conference (1993); least-squares
//! spectra, Lomb, *Astrophys. Space Sci.* 39 (1976).

use crate::SymbolicError;
use crate::problem::Bench;
use crate::shape::{Factor, Shape};
use crate::term::Term;
use crate::variable::Kind;
use crate::vector::{dot, normalise, take_out};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// The terms of the dictionary with their projected columns.
pub(crate) struct Screen {
    pub terms: Vec<Term>,
    /// One or two for each term.
    columns: Vec<Vec<Vec<f64>>>,
    /// Where the waves of each variable begin and end, slowest first.
    waves: Vec<(usize, usize)>,
    /// Every how many rows one is looked at.
    stride: usize,
}

/// At most so many rows are looked at: screening needs no more, and the memory of the columns is bounded.
const MOST_ROWS: usize = 4000;
/// At most so many waves of position, of the way, and of time.
const MOST_WAVES: usize = 1000;
/// Waves lie this share of one cycle over the record apart, so that none falls between two.
const CYCLES_APART: f64 = 0.5;
/// A column of which less than this share is left beside the others is imitated by them.
const LEAST_LEFT: f64 = 1e-4;

impl Screen {
    pub fn new(
        bench: &Bench,
        dictionary: Vec<Term>,
        stop: &(dyn Fn() -> bool + Sync),
    ) -> Result<Self, SymbolicError> {
        let (mut terms, mut waves) = (dictionary, Vec::new());
        for (index, of) in bench.variables.iter().enumerate() {
            if ![Kind::Coordinate, Kind::Way].contains(&of.known.kind) {
                continue;
            }
            let begin = terms.len();
            let count = waves_of(bench, index);
            terms.extend((1..=count).map(|wave| {
                let scale = of.spread() / (CYCLES_APART * wave as f64);
                Term::of(Factor { variable: index, shape: Shape::Wave, scale, centre: 0.0 })
            }));
            waves.push((begin, terms.len()));
        }
        let mut screen = Self { stride: bench.rows.div_ceil(MOST_ROWS), terms, columns: Vec::new(), waves };
        let columns = |term: &Term| if stop() { None } else { Some(screen.columns_of(bench, term)) };
        let all: Option<Vec<_>> = screen.terms.par_iter().map(columns).collect();
        screen.columns = all.ok_or(SymbolicError::Interrupted)?;
        Ok(screen)
    }

    /// The projected columns of a term, thinned and made orthonormal; none where the nuisances imitate it.
    fn columns_of(&self, bench: &Bench, term: &Term) -> Vec<Vec<f64>> {
        let mut all: Vec<Vec<f64>> = Vec::new();
        for raw in bench.raw_columns(term) {
            let whole = dot(&raw, &raw) / self.stride as f64;
            let mut column = self.thin(bench, &bench.project(&raw));
            take_out(&mut column, &all);
            let size = normalise(&mut column).powi(2);
            if size.is_finite() && size > LEAST_LEFT * whole {
                all.push(column);
            }
        }
        all
    }

    /// What a term that is not in the dictionary adds.
    pub fn gain_of(&self, bench: &Bench, term: &Term, basis: &[Vec<f64>], left: &[f64]) -> f64 {
        gain(&self.columns_of(bench, term), basis, left)
    }

    /// Every so manieth row, and what belongs to the nuisances.
    pub fn thin(&self, bench: &Bench, projected: &[f64]) -> Vec<f64> {
        if self.stride == 1 {
            return projected.to_vec();
        }
        let (rows, below) = projected.split_at(bench.rows);
        let share = (self.stride as f64).sqrt().recip();
        rows.iter().step_by(self.stride).copied().chain(below.iter().map(|value| value * share)).collect()
    }

    /// What each term adds to the explained sum of squares, beside orthonormal columns of which `left` is free.
    pub fn gains(&self, basis: &[Vec<f64>], left: &[f64]) -> Vec<f64> {
        self.columns.par_iter().map(|columns| gain(columns, basis, left)).collect()
    }

    /// The best of all gains for each of many residuals, with no law yet.
    pub fn best_gains(&self, residuals: &[Vec<f64>]) -> Vec<f64> {
        /// Terms whose columns are multiplied at once.
        const TERMS: usize = 64;
        let rows = residuals.first().map_or(0, Vec::len);
        let left = DMatrix::from_iterator(rows, residuals.len(), residuals.iter().flatten().copied());
        let of = |terms: &[Vec<Vec<f64>>]| -> Vec<f64> {
            let count = terms.iter().map(Vec::len).sum();
            let columns = terms.iter().flatten().flatten().copied();
            let shares = DMatrix::from_row_iterator(count, rows, columns) * &left;
            let best = |at: usize| {
                let mut squares = shares.column(at).into_iter().map(|share| share * share);
                let gains = terms.iter().map(|term| squares.by_ref().take(term.len()).sum::<f64>());
                gains.fold(0.0, f64::max)
            };
            (0..residuals.len()).map(best).collect()
        };
        let parts: Vec<Vec<f64>> = self.columns.par_chunks(TERMS).map(of).collect();
        (0..residuals.len()).map(|at| parts.iter().map(|part| part[at]).fold(0.0, f64::max)).collect()
    }

    /// The highest peaks of the scanned waves of every variable.
    pub fn peaks(&self, gains: &[f64], most: usize) -> Vec<usize> {
        let mut all = Vec::new();
        for (begin, end) in &self.waves {
            let at = |index: usize| if (*begin..*end).contains(&index) { gains[index] } else { 0.0 };
            let mut peaks: Vec<usize> = (*begin..*end)
                .filter(|index| {
                    at(*index) >= at(index + 1) && (*index == *begin || at(*index) > at(index - 1))
                })
                .collect();
            peaks.sort_by(|one, other| gains[*other].total_cmp(&gains[*one]).then(one.cmp(other)));
            all.extend(peaks.into_iter().take(most));
        }
        all
    }
}

/// How many waves of a coordinate are told apart by its samples and by the rows.
fn waves_of(bench: &Bench, index: usize) -> usize {
    /// Samples in the shortest wave.
    const SAMPLES: f64 = 4.0;
    let of = &bench.variables[index];
    let by_samples = of.spread() / (SAMPLES * of.step.max(f64::MIN_POSITIVE));
    // Half a cycle a row is the most that rows can hold of something that follows the clock.
    let longest = bench.fitted.iter().map(|(_, rows)| *rows).max().unwrap_or(0);
    let by_samples = if of.finest > 0.0 { by_samples.min(of.spread() / of.finest) } else { by_samples };
    let by_rows = if of.known.name == "t" { 0.5 * longest as f64 } else { f64::INFINITY };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most MOST_WAVES")]
    let count = (by_samples.min(by_rows) / CYCLES_APART).min(MOST_WAVES as f64) as usize;
    count
}

/// What one or two orthonormal columns add.
fn gain(columns: &[Vec<f64>], basis: &[Vec<f64>], left: &[f64]) -> f64 {
    if basis.is_empty() {
        return columns.iter().map(|column| dot(column, left).powi(2)).sum();
    }
    let shares: Vec<Vec<f64>> =
        columns.iter().map(|column| basis.iter().map(|q| dot(q, column)).collect()).collect();
    let rest = |one: usize, other: usize| {
        f64::from(u8::from(one == other))
            - shares[one].iter().zip(&shares[other]).map(|(a, b)| a * b).sum::<f64>()
    };
    // The second with what is left of the first taken out; either where the other is imitated.
    let alone = |index: usize| {
        let size = rest(index, index);
        if size > LEAST_LEFT { dot(&columns[index], left).powi(2) / size } else { 0.0 }
    };
    if columns.len() < 2 {
        return (0..columns.len()).map(alone).sum();
    }
    let (aa, ab, bb) = (rest(0, 0), rest(0, 1), rest(1, 1));
    if aa <= LEAST_LEFT {
        return alone(1);
    }
    let size = bb - ab * ab / aa;
    if size <= LEAST_LEFT {
        return alone(0);
    }
    let along = dot(&columns[1], left) - ab / aa * dot(&columns[0], left);
    alone(0) + along * along / size
}

impl Bench<'_> {
    /// The projected columns of a term.
    pub fn columns(&self, term: &Term) -> Vec<Vec<f64>> {
        self.raw_columns(term).iter().map(|rows| self.project(rows)).collect()
    }

    /// The columns of a term as they are.
    pub fn raw_columns(&self, term: &Term) -> Vec<Vec<f64>> {
        let mut all = vec![Vec::with_capacity(self.rows); term.width()];
        for (run, _) in &self.fitted {
            for (rows, samples) in all.iter_mut().zip(term.samples(&self.variables, *run)) {
                rows.extend(self.rows_of(*run, &samples));
            }
        }
        all
    }
}
