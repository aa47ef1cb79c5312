//! What is to be explained, and by what.

use crate::SymbolicError;
use crate::variable::{Checked, Variable, check};
use nalgebra::{DMatrix, DVector};

/// The unit of what is to be explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Newtons.
    Force,
    /// Watts.
    Power,
    /// A pure number: the share of the drive force that is lost on its way, or the slip of wheels.
    Share,
}

impl Target {
    /// The target of a unit.
    ///
    /// # Errors
    /// [`SymbolicError::Unit`] where it is none of `N`, `W` and `1`.
    pub fn of_unit(unit: &str) -> Result<Self, SymbolicError> {
        match unit.trim() {
            "N" => Ok(Self::Force),
            "W" => Ok(Self::Power),
            "1" => Ok(Self::Share),
            other => Err(SymbolicError::Unit {
                name: "the target".to_owned(),
                found: other.to_owned(),
                expected: "N, W or 1".to_owned(),
            }),
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Force => "N",
            Self::Power => "W",
            Self::Share => "1",
        }
    }

    pub(crate) fn ending(self) -> &'static str {
        match self {
            Self::Force => "_n",
            Self::Power => "_w",
            Self::Share => "",
        }
    }
}

/// What makes whitened rows of samples: it has to be linear, and the same at every call.
///
/// For a weak form: means of the samples with the test function as weight, then the inverse of a Cholesky factor of the
/// rows' covariance.
pub trait Rows: Sync {
    /// The rows of one run; `samples` are in the unit of the target, one for every so many samples of the run as
    /// [`Rows::every`] says, from the first on.
    fn rows(&self, run: usize, samples: &[f64]) -> Vec<f64>;

    /// Every how many samples of a run one is enough for its rows: what is averaged over many need not be worked out for all.
    fn every(&self, run: usize) -> usize {
        let _ = run;
        1
    }
}

/// Samples that are rows by themselves.
#[cfg(test)]
pub(crate) struct AsTheyAre;

#[cfg(test)]
impl Rows for AsTheyAre {
    fn rows(&self, _: usize, samples: &[f64]) -> Vec<f64> {
        samples.to_vec()
    }
}

/// A free parameter of the model that is estimated beside every law.
#[derive(Clone, Debug)]
pub struct Nuisance {
    /// Prior standard deviation around zero, in units of the column; infinite where nothing is known.
    pub sd: f64,
    /// Whitened rows of every run.
    pub runs: Vec<Vec<f64>>,
}

/// A residual that no listed cause explains.
pub struct Problem<'a> {
    /// What may stand in the law.
    pub variables: &'a [Variable],
    /// Time of every sample of every run [s], for what a law remembers.
    pub times_s: &'a [Vec<f64>],
    /// What the law is.
    pub target: Target,
    /// From samples to whitened rows.
    pub rows: &'a dyn Rows,
    /// The residual as whitened rows of every run.
    pub residual: &'a [Vec<f64>],
    /// Free parameters: what they can imitate is not missing.
    pub nuisances: &'a [Nuisance],
    /// Which runs may be fitted; the others are never looked at but for the figure `unseen`.
    pub fit: &'a [bool],
}

/// A problem, checked, with everything that is prepared once.
///
/// Vectors that are called *projected* have one value for each row that is fitted and one for each nuisance: the scalar
/// product of two of them is what is left of it beside the nuisances, aᵀb − aᵀZ(ZᵀZ + P)⁻¹Zᵀb.
pub(crate) struct Bench<'a> {
    pub variables: Vec<Checked<'a>>,
    pub target: Target,
    operator: &'a dyn Rows,
    residual: &'a [Vec<f64>],
    nuisances: &'a [Nuisance],
    /// Runs that are fitted, and how many rows each has.
    pub fitted: Vec<(usize, usize)>,
    /// Runs that are not.
    pub unseen: Vec<usize>,
    /// Rows that are fitted.
    pub rows: usize,
    /// Orthonormal basis of the nuisances with their priors below.
    basis: DMatrix<f64>,
    /// The residual, projected.
    pub left: Vec<f64>,
}

impl<'a> Bench<'a> {
    pub fn new(problem: &Problem<'a>) -> Result<Self, SymbolicError> {
        let mut variables = check(problem.variables, problem.times_s, problem.fit, problem.target)?;
        let runs = problem.residual.len();
        length("the times", runs, problem.times_s.len(), runs)?;
        for variable in problem.variables {
            length(&format!("`{}`", variable.name), runs, variable.runs.len(), runs)?;
            for (run, samples) in variable.runs.iter().enumerate() {
                length(&format!("`{}`", variable.name), run, samples.len(), problem.times_s[run].len())?;
            }
        }
        for variable in &mut variables {
            variable.look_at_every(|run| problem.rows.every(run));
        }
        length("the choice of runs", runs, problem.fit.len(), runs)?;
        for (index, nuisance) in problem.nuisances.iter().enumerate() {
            if nuisance.sd.is_nan() || nuisance.sd <= 0.0 {
                return Err(SymbolicError::Prior { index, found: nuisance.sd });
            }
            length("a nuisance", runs, nuisance.runs.len(), runs)?;
        }
        for (run, rows) in problem.residual.iter().enumerate() {
            for nuisance in problem.nuisances {
                length("a nuisance", run, nuisance.runs[run].len(), rows.len())?;
                finite("a nuisance", run, &nuisance.runs[run])?;
            }
            finite("the residual", run, rows)?;
        }
        let chosen = |wanted: bool| (0..runs).filter(move |run| problem.fit[*run] == wanted);
        let fitted: Vec<(usize, usize)> = chosen(true)
            .map(|run| (run, problem.residual[run].len()))
            .filter(|(_, rows)| *rows > 0)
            .collect();
        let rows: usize = fitted.iter().map(|(_, rows)| rows).sum();
        let nuisances = problem.nuisances.len();
        if rows < FEWEST_ROWS + 2 * nuisances {
            return Err(SymbolicError::TooFew { rows, nuisances });
        }
        let mut bench = Self {
            variables,
            target: problem.target,
            operator: problem.rows,
            residual: problem.residual,
            nuisances: problem.nuisances,
            fitted,
            unseen: chosen(false).collect(),
            rows,
            basis: DMatrix::zeros(rows, 0),
            left: Vec::new(),
        };
        bench.basis = bench.nuisance_basis();
        bench.left = bench.project(&bench.residual_rows());
        Ok(bench)
    }

    /// Orthonormal columns that span the nuisances, each with the root of its prior precision below.
    fn nuisance_basis(&self) -> DMatrix<f64> {
        let count = self.nuisances.len();
        let mut stacked = DMatrix::zeros(self.rows + count, count);
        for (column, nuisance) in self.nuisances.iter().enumerate() {
            let rows = self.nuisance_rows(nuisance);
            let size = rows.iter().map(|value| value * value).sum::<f64>().sqrt() + nuisance.sd.recip();
            for (row, value) in rows.iter().enumerate() {
                stacked[(row, column)] = value / size;
            }
            stacked[(self.rows + column, column)] = nuisance.sd.recip() / size;
        }
        stacked.qr().q()
    }

    fn nuisance_rows(&self, nuisance: &Nuisance) -> Vec<f64> {
        self.fitted.iter().flat_map(|(run, _)| nuisance.runs[*run].iter().copied()).collect()
    }

    /// The nuisances' rows that are fitted, and their prior precisions.
    pub fn nuisance_columns(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        self.nuisances.iter().map(|one| (self.nuisance_rows(one), one.sd.powi(-2))).unzip()
    }

    /// The nuisances' rows of one run.
    pub fn nuisance_rows_of(&self, run: usize) -> Vec<&[f64]> {
        self.nuisances.iter().map(|one| one.runs[run].as_slice()).collect()
    }

    /// The residual's rows that are fitted.
    pub fn residual_rows(&self) -> Vec<f64> {
        self.fitted.iter().flat_map(|(run, _)| self.residual[*run].iter().copied()).collect()
    }

    /// The residual's rows of one run.
    pub fn residual_rows_of(&self, run: usize) -> &[f64] {
        &self.residual[run]
    }

    /// What the nuisances cannot imitate of some rows.
    pub fn project(&self, rows: &[f64]) -> Vec<f64> {
        let mut column = DVector::zeros(self.basis.nrows());
        column.rows_mut(0, rows.len()).copy_from_slice(rows);
        let imitated = self.basis.tr_mul(&column);
        column.gemv(-1.0, &self.basis, &imitated, 1.0);
        column.as_slice().to_vec()
    }

    /// Rows of one run; what the operator leaves out counts as nothing.
    pub fn rows_of(&self, run: usize, samples: &[f64]) -> Vec<f64> {
        let mut rows = self.operator.rows(run, samples);
        rows.resize(self.residual[run].len(), 0.0);
        rows
    }
}

/// With fewer rows no law of a few constants can be told from chance.
const FEWEST_ROWS: usize = 40;

fn length(what: &str, run: usize, found: usize, expected: usize) -> Result<(), SymbolicError> {
    if found == expected {
        return Ok(());
    }
    Err(SymbolicError::Length { what: what.to_owned(), run, found, expected })
}

fn finite(what: &str, run: usize, values: &[f64]) -> Result<(), SymbolicError> {
    if values.iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    Err(SymbolicError::NotFinite { what: what.to_owned(), run })
}
