//! What a law says of runs that it was not fitted to.
//!
//! Each fold of whole runs is left out in turn; amplitudes, nuisances and the constants inside the law are estimated again
//! on the others, the constants along their derivatives. The error of the fold is the deviance of its rows under what
//! the others predict, nuisances uncertain as they then are:
//! eᵀ(σ²(1 + X A⁻¹ Xᵀ))⁻¹e + ln|1 + X A⁻¹ Xᵀ|, with A the information of the others and e = y − X β.
//! Added is what the derivatives promise beyond the constants of the law as it is: one whose constants stand at an end of what
//! they may be bends no further, whatever a straight line along them says.
//! Source: Bishop, *Pattern Recognition and Machine Learning* (2006), section 3.3.2.

use crate::polish::Polished;
use crate::problem::Bench;
use crate::vector::dot;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Folds of the rows that are fitted.
pub(crate) struct Judge {
    folds: Vec<Vec<Range<usize>>>,
    nuisances: Vec<Vec<f64>>,
    precisions: Vec<f64>,
    residual: Vec<f64>,
}

/// What validation says of a law.
#[derive(Clone, Debug)]
pub(crate) struct Verdict {
    /// Squared error of each fold, and what the uncertainty of its prediction adds to its deviance.
    pub folds: Vec<(f64, f64)>,
    /// Covariance of amplitudes and inner constants, for noise of variance 1.
    pub covariance: DMatrix<f64>,
    /// Squared error on runs that were never fitted.
    pub unseen: Option<f64>,
}

/// At most so many folds.
const MOST_FOLDS: usize = 10;
/// With fewer runs a fold is a stretch of rows.
const FEWEST_RUNS: usize = 3;
/// So many stretches.
const STRETCHES: usize = 6;
/// Prior standard deviation of an inner constant around its estimate, in natural logarithms, cycles or spreads.
const INNER_SD: f64 = 1.0;
/// Share of its own information that is added to an amplitude's, so that the system has a solution.
const RIDGE: f64 = 1e-9;

impl Judge {
    pub fn new(bench: &Bench) -> Self {
        let runs = bench.fitted.len();
        let mut folds = Vec::new();
        if runs < FEWEST_RUNS {
            let edge = |piece: usize| bench.rows * piece / STRETCHES;
            folds.extend((0..STRETCHES).map(|piece| std::iter::once(edge(piece)..edge(piece + 1)).collect()));
        } else {
            folds.resize(runs.min(MOST_FOLDS), Vec::new());
            let mut begin = 0;
            for (index, (_, rows)) in bench.fitted.iter().enumerate() {
                folds[index % runs.min(MOST_FOLDS)].push(begin..begin + rows);
                begin += rows;
            }
        }
        let (nuisances, precisions) = bench.nuisance_columns();
        Self { folds, nuisances, precisions, residual: bench.residual_rows() }
    }

    /// Validates a law; none where its system has no solution.
    pub fn judge(&self, bench: &Bench, law: &Polished) -> Option<Verdict> {
        let columns: Vec<Vec<f64>> = law.terms.iter().flat_map(|term| bench.raw_columns(term)).collect();
        let slopes = law.slopes(bench);
        let own = columns.len();
        let size = |column: &Vec<f64>| dot(column, column).sqrt().max(f64::MIN_POSITIVE);
        let sizes: Vec<f64> = columns.iter().map(size).collect();
        let all: Vec<&[f64]> =
            self.nuisances.iter().chain(&columns).chain(&slopes).map(Vec::as_slice).collect();
        let scale: Vec<f64> = std::iter::repeat_n(1.0, self.nuisances.len())
            .chain(sizes.iter().map(|size| size.recip()))
            .chain(std::iter::repeat_n(1.0, slopes.len()))
            .collect();
        let grams: Vec<Gram> =
            self.folds.iter().map(|fold| Gram::of(&all, &scale, &self.residual, fold)).collect();
        let mut prior = DMatrix::zeros(all.len(), all.len());
        let precisions = self.precisions.iter().copied();
        let inner = std::iter::repeat_n(INNER_SD.powi(-2), slopes.len());
        for (index, value) in precisions.chain(std::iter::repeat_n(RIDGE, own)).chain(inner).enumerate() {
            prior[(index, index)] = value;
        }
        let mut total = Gram { matrix: prior, vector: DVector::zeros(all.len()), scalar: 0.0 };
        for gram in &grams {
            total.add(gram, 1.0);
        }
        let whole = total.matrix.clone().cholesky()?;
        let estimate = whole.solve(&total.vector);
        let as_it_is = total.solved_for(self.nuisances.len() + own)?;
        let mut folds = Vec::with_capacity(grams.len());
        for gram in &grams {
            let mut others = total.clone();
            others.add(gram, -1.0);
            let trained = others.matrix.clone().cholesky()?;
            let promised = gram.plain_error(&as_it_is) - gram.plain_error(&estimate);
            folds.push((
                gram.error(&trained.solve(&others.vector), |error| whole.solve(error)) + promised,
                log_determinant(&whole) - log_determinant(&trained),
            ));
        }
        let unseen = self.unseen(bench, law, &scale, &total, &estimate);
        let first = self.nuisances.len();
        let count = all.len() - first;
        let covariance = whole.inverse();
        let covariance = DMatrix::from_fn(count, count, |row, column| {
            covariance[(first + row, first + column)] * scale[first + row] * scale[first + column]
        });
        Some(Verdict { folds, covariance, unseen })
    }

    fn unseen(
        &self,
        bench: &Bench,
        law: &Polished,
        scale: &[f64],
        total: &Gram,
        estimate: &DVector<f64>,
    ) -> Option<f64> {
        let mut sum = None;
        // The constants inside stay as they are: their derivatives are left out.
        let used = self.nuisances.len() + law.amplitudes.len();
        for run in &bench.unseen {
            let residual = bench.residual_rows_of(*run);
            let rows = |samples: Vec<f64>| bench.rows_of(*run, &samples);
            let own: Vec<Vec<f64>> =
                law.terms.iter().flat_map(|term| term.samples(&bench.variables, *run)).map(rows).collect();
            let mut all = bench.nuisance_rows_of(*run);
            all.extend(own.iter().map(Vec::as_slice));
            let gram = Gram::of(&all, &scale[..used], residual, &vec![0..residual.len(); 1]);
            let known = total.matrix.view((0, 0), (used, used)) + &gram.matrix;
            let Some(known) = known.cholesky() else { continue };
            *sum.get_or_insert(0.0) +=
                gram.error(&estimate.rows(0, used).into_owned(), |error| known.solve(error));
        }
        sum
    }
}

fn log_determinant(cholesky: &nalgebra::Cholesky<f64, nalgebra::Dyn>) -> f64 {
    2.0 * cholesky.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>()
}

/// Products of columns and residual over some rows.
#[derive(Clone)]
struct Gram {
    matrix: DMatrix<f64>,
    vector: DVector<f64>,
    scalar: f64,
}

impl Gram {
    fn of(columns: &[&[f64]], scale: &[f64], residual: &[f64], rows: &[Range<usize>]) -> Self {
        let product = |one: &[f64], other: &[f64]| {
            rows.iter().map(|rows| dot(&one[rows.clone()], &other[rows.clone()])).sum::<f64>()
        };
        let count = columns.len();
        let mut matrix = DMatrix::zeros(count, count);
        for row in 0..count {
            for column in 0..=row {
                let value = product(columns[row], columns[column]) * scale[row] * scale[column];
                (matrix[(row, column)], matrix[(column, row)]) = (value, value);
            }
        }
        let vector = DVector::from_iterator(
            count,
            columns.iter().zip(scale).map(|(one, scale)| scale * product(one, residual)),
        );
        Self { matrix, vector, scalar: product(residual, residual) }
    }

    fn add(&mut self, other: &Self, sign: f64) {
        self.matrix += sign * &other.matrix;
        self.vector += sign * &other.vector;
        self.scalar += sign * other.scalar;
    }

    /// The best estimate with all but the first so many at nought; none where these rows do not tell one.
    fn solved_for(&self, first: usize) -> Option<DVector<f64>> {
        let matrix = self.matrix.view((0, 0), (first, first)).into_owned();
        let solved = matrix.cholesky()?.solve(&self.vector.rows(0, first).into_owned());
        Some(solved.resize_vertically(self.vector.len(), 0.0))
    }

    /// Squared error of an estimate on these rows.
    fn plain_error(&self, estimate: &DVector<f64>) -> f64 {
        let along = &self.vector - &self.matrix * estimate;
        self.scalar - estimate.dot(&self.vector) - estimate.dot(&along)
    }

    /// Squared error of an estimate on these rows, once it may still move as far as it is uncertain.
    fn error(&self, estimate: &DVector<f64>, solve: impl Fn(&DVector<f64>) -> DVector<f64>) -> f64 {
        let along = &self.vector - &self.matrix * estimate;
        (self.plain_error(estimate) - along.dot(&solve(&along))).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Judge;
    use crate::polish::amplitudes;
    use crate::problem::{AsTheyAre, Bench, Problem, Target};
    use crate::shape::{Factor, Shape};
    use crate::term::Term;
    use crate::variable::{Enters, Variable};

    /// A drag that goes with the curvature, of 1 kN in a bend of 50 m, held against one that fades with the way besides: along its derivative
    /// a scale that may be no longer than 2500 m would do without the fading.
    #[test]
    fn a_law_is_judged_as_it_is_and_not_by_what_its_derivative_promises() {
        let steps = || 0..200u16;
        let runs = |of: &dyn Fn(u16, u16) -> f64| -> Vec<Vec<f64>> {
            (0..4).map(|run| steps().map(|step| of(run, step)).collect()).collect()
        };
        let way_m = |_: u16, step: u16| 3.5 * f64::from(step);
        let kappa_per_m = |run: u16, step: u16| 0.02 * (0.13 * f64::from(step) + f64::from(run)).sin().abs();
        let noise_n = |run: u16, step: u16| 60.0 * (2.9 * f64::from(step) + 1.7 * f64::from(run)).sin();
        let variable = |name: &str, unit: &str, runs| Variable {
            name: name.to_owned(),
            unit: unit.to_owned(),
            runs,
            twin: None,
            finest: 0.0,
            enters: Enters::Freely,
        };
        let variables = [variable("x", "m", runs(&way_m)), variable("kappa", "1/m", runs(&kappa_per_m))];
        let residual = runs(&|run, step| 5e4 * kappa_per_m(run, step) + noise_n(run, step));
        let problem = Problem {
            variables: &variables,
            times_s: &runs(&|_, step| f64::from(step)),
            target: Target::Force,
            rows: &AsTheyAre,
            residual: &residual,
            nuisances: &[],
            fit: &[true; 4],
        };
        let bench = Bench::new(&problem).unwrap();
        let bend = Factor { variable: 1, shape: Shape::Power(1.0), scale: 0.02, centre: 0.0 };
        let fades = Factor { variable: 0, shape: Shape::Decay, scale: 2500.0, centre: 0.0 };
        let judge = Judge::new(&bench);
        let judged = |term: Term| {
            let law = amplitudes(&bench, vec![term]).unwrap();
            let folds = judge.judge(&bench, &law).unwrap().folds;
            (law.cost, folds.iter().map(|(error, _)| error).sum::<f64>())
        };
        let (cost, error) = judged(Term::of(bend));
        let (of_fading, error_of_fading) = judged(Term::product(fades, bend).unwrap());
        assert!(of_fading > 1.5 * cost, "{of_fading} {cost}");
        assert!(error_of_fading - error > 0.8 * (of_fading - cost), "{error_of_fading} {error}");
    }
}
