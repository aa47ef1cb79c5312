//! The constants inside a law, by non-linear least squares; amplitudes and nuisances are eliminated.
//!
//! Variable projection: for given scales θ the amplitudes β solve a linear problem, so that only θ is searched, with the
//! derivative of what is left taken as −(1 − C C⁺) ∂C/∂θ β, damped as by Levenberg and Marquardt.
//! Source: Golub and Pereyra, *SIAM J. Numer. Anal.* 10 (1973); the approximation of the derivative is that of Kaufman,
//! *BIT* 15 (1975).

use crate::problem::Bench;
use crate::shape::{Factor, Free};
use crate::term::Term;
use crate::vector::{add, dot, normalise, take_out, times};
use nalgebra::{DMatrix, DVector};

/// A law with its constants.
#[derive(Clone, Debug)]
pub(crate) struct Polished {
    pub terms: Vec<Term>,
    /// Amplitudes, one or two a term.
    pub amplitudes: Vec<f64>,
    /// What is left, projected.
    pub left: Vec<f64>,
    /// Sum of squares of what is left.
    pub cost: f64,
    /// Orthonormal basis of its columns, projected.
    pub basis: Vec<Vec<f64>>,
}

/// Which constant of which factor of which term.
type Place = (usize, usize, Free);

/// Columns of which less than this share is left beside the others make amplitudes that cancel each other.
const LEAST_LEFT: f64 = 2e-3;
/// A step that promises less than this [nats, twice] is not taken.
const LEAST_STEP: f64 = 0.02;

impl Polished {
    /// The law of nothing.
    pub fn nothing(bench: &Bench) -> Self {
        let cost = dot(&bench.left, &bench.left);
        Self { terms: Vec::new(), amplitudes: Vec::new(), left: bench.left.clone(), cost, basis: Vec::new() }
    }

    /// What it costs to write it down.
    pub fn complexity(&self) -> usize {
        self.terms.iter().map(Term::complexity).sum()
    }

    /// Numbers that were fitted.
    pub fn constants(&self) -> usize {
        self.amplitudes.len() + places(&self.terms).len()
    }

    /// Its terms by themselves, each with its part of the covariance of amplitudes, then inner constants.
    pub fn each(&self, covariance: &DMatrix<f64>) -> Vec<(Self, DMatrix<f64>)> {
        let (mut amplitude, mut inner) = (0, self.amplitudes.len());
        let of = |term: &Term| {
            let free: usize = term.factors.iter().map(|factor| factor.shape.free().len()).sum();
            let own: Vec<usize> = (amplitude..amplitude + term.width()).chain(inner..inner + free).collect();
            let law = Self {
                terms: vec![term.clone()],
                amplitudes: self.amplitudes[amplitude..amplitude + term.width()].to_vec(),
                ..self.clone()
            };
            (amplitude, inner) = (amplitude + term.width(), inner + free);
            (law, DMatrix::from_fn(own.len(), own.len(), |row, column| covariance[(own[row], own[column])]))
        };
        self.terms.iter().map(of).collect()
    }

    /// Derivatives of its rows by its inner constants, as they are.
    pub fn slopes(&self, bench: &Bench) -> Vec<Vec<f64>> {
        let mut first = 0;
        let of = |term: &Term| {
            let share = &self.amplitudes[first..first + term.width()];
            first += term.width();
            slopes_of(bench, term, share)
        };
        self.terms.iter().flat_map(of).collect()
    }
}

/// The free constants of a law.
pub(crate) fn places(terms: &[Term]) -> Vec<Place> {
    let of = |(index, term): (usize, &Term)| {
        term.free().into_iter().map(move |(factor, free)| (index, factor, free)).collect::<Vec<_>>()
    };
    terms.iter().enumerate().flat_map(of).collect()
}

/// A law with its amplitudes; none where its terms cannot be told apart.
pub(crate) fn amplitudes(bench: &Bench, terms: Vec<Term>) -> Option<Polished> {
    let columns = columns_of(bench, &terms).concat();
    with_columns(bench, terms, &columns)
}

/// The projected columns of each term.
pub(crate) fn columns_of(bench: &Bench, terms: &[Term]) -> Vec<Vec<Vec<f64>>> {
    terms.iter().map(|term| bench.columns(term)).collect()
}

/// A law with its amplitudes, of the projected columns of its terms.
pub(crate) fn with_columns(bench: &Bench, terms: Vec<Term>, columns: &[Vec<f64>]) -> Option<Polished> {
    let count = columns.len();
    let mut basis: Vec<Vec<f64>> = Vec::with_capacity(count);
    let mut triangle = DMatrix::zeros(count, count);
    for (index, column) in columns.iter().enumerate() {
        let own = dot(column, column).sqrt();
        let mut rest = column.clone();
        // Twice is enough for orthogonality to rounding.
        for _ in 0..2 {
            for (row, q) in basis.iter().enumerate() {
                let share = dot(q, &rest);
                triangle[(row, index)] += share;
                add(&mut rest, -share, q);
            }
        }
        let size = normalise(&mut rest);
        if size.is_nan() || size <= LEAST_LEFT * own {
            return None;
        }
        triangle[(index, index)] = size;
        basis.push(rest);
    }
    let shares = DVector::from_iterator(count, basis.iter().map(|q| dot(q, &bench.left)));
    let amplitudes = triangle.solve_upper_triangular(&shares)?.as_slice().to_vec();
    let mut left = bench.left.clone();
    for (q, share) in basis.iter().zip(&shares) {
        add(&mut left, -share, q);
    }
    let cost = dot(&left, &left);
    (cost.is_finite() && amplitudes.iter().all(|value| value.is_finite())).then_some(Polished {
        terms,
        amplitudes,
        left,
        cost,
        basis,
    })
}

/// Derivatives of the rows of a term with its amplitudes by each of its inner constants.
fn slopes_of(bench: &Bench, term: &Term, share: &[f64]) -> Vec<Vec<f64>> {
    let free = term.free();
    let phased = term.factors.iter().any(|factor| factor.shape.has_phase());
    // Beside a factor with a phase the other one has no amplitude of its own, and without one it is that of the first.
    let share_of = |place: usize| {
        let own = if phased { term.factors[place].shape.has_phase() } else { place == 0 };
        if own { share } else { &[1.0] }
    };
    let mut all: Vec<Vec<f64>> = vec![Vec::with_capacity(bench.rows); free.len()];
    if free.is_empty() {
        return all;
    }
    for (run, _) in &bench.fitted {
        let seen = |factor: &Factor| {
            let of = &bench.variables[factor.variable];
            (&of.seen[*run], &of.seen_s[*run], of)
        };
        let sized = |(place, factor): (usize, &Factor)| {
            let (values, times_s, of) = seen(factor);
            factor.along(values, times_s, of).sized(share_of(place))
        };
        let sized: Vec<Vec<f64>> = if term.factors.len() > 1 {
            term.factors.iter().enumerate().map(sized).collect()
        } else {
            Vec::new()
        };
        for ((place, free), rows) in free.iter().zip(&mut all) {
            let factor = &term.factors[*place];
            let (values, times_s, of) = seen(factor);
            let mut slope = factor.slope(*free, values, times_s, of).sized(share_of(*place));
            for (_, other) in sized.iter().enumerate().filter(|(other, _)| other != place) {
                times(&mut slope, other);
            }
            rows.extend(bench.rows_of(*run, &slope));
        }
    }
    all
}

/// Moves the free constants downhill, at most so many steps.
pub(crate) fn polish(bench: &Bench, start: Polished, steps: usize) -> Polished {
    let places = places(&start.terms);
    if places.is_empty() {
        return start;
    }
    let mut here = start;
    let mut damping = 0.01;
    let mut slopes: Option<Vec<Vec<f64>>> = None;
    for _ in 0..steps {
        let current = slopes.get_or_insert_with(|| {
            let raw = here.slopes(bench);
            let free = |rows: &Vec<f64>| {
                let mut slope = bench.project(rows);
                take_out(&mut slope, &here.basis);
                slope
            };
            raw.iter().map(free).collect()
        });
        let count = places.len();
        let mut matrix = DMatrix::from_fn(count, count, |row, column| dot(&current[row], &current[column]));
        let downhill = DVector::from_iterator(count, current.iter().map(|slope| dot(slope, &here.left)));
        let floor = 1e-9 * matrix.diagonal().amax() + f64::MIN_POSITIVE;
        for index in 0..count {
            matrix[(index, index)] += damping * matrix[(index, index)] + floor;
        }
        let Some(cholesky) = matrix.cholesky() else { break };
        let step = cholesky.solve(&downhill);
        if !step.dot(&downhill).is_finite() || step.dot(&downhill) < LEAST_STEP {
            break;
        }
        let next = moved(bench, &here.terms, &places, &step).and_then(|terms| amplitudes(bench, terms));
        match next {
            Some(next) if next.cost < here.cost => {
                let gained = here.cost - next.cost;
                (here, slopes, damping) = (next, None, (damping * 0.2).max(1e-6));
                if gained < LEAST_STEP {
                    break;
                }
            }
            _ => damping *= 8.0,
        }
    }
    here
}

fn moved(bench: &Bench, terms: &[Term], places: &[Place], step: &DVector<f64>) -> Option<Vec<Term>> {
    let mut terms = terms.to_vec();
    for ((term, factor, free), step) in places.iter().zip(step) {
        let factor = &mut terms[*term].factors[*factor];
        let of = &bench.variables[factor.variable];
        let longest = factor.longest_step(*free);
        factor.set_inner(*free, factor.inner(*free, of) + step.clamp(-longest, longest), of);
    }
    step.iter().all(|step| step.is_finite()).then_some(terms)
}
