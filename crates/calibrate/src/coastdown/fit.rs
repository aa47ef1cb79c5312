//! Output-error fit of v(t): all runs at once, each with its own initial speed.
//!
//! First plain least squares over the parameters and all initial speeds, by Levenberg–Marquardt. Then generalised
//! least squares with the covariance that the residuals show, in which each run carries a random offset of its
//! resistance; initial speed and offset of a run are eliminated from its normal equations (Schur complement), which
//! leaves one [`Cluster`] a run. The between-run variance is set so that offsets are as large as they should be:
//! Paule & Mandel, *Journal of Research of the National Bureau of Standards* 87 (1982) 377.

use super::CoastDownError;
use super::motion::{Air, Motion, Term};
use super::noise::{Noise, Normal, correlation_time_s, normal};
use super::segment::Coast;
use crate::clusters::{Cluster, Pooled, pool, scaled_inverse};
use crate::least_squares::{Linearised, Problem, Stop, minimise};
use nalgebra::{DMatrix, DVector};

/// Smallest sample deviation that is told from rounding [m/s].
const ROUNDING_M_S: f64 = 1e-10;
/// Relinearisations of the generalised fit; two or three are the rule.
const ROUNDS: usize = 30;
/// Rounds in which the covariance follows the residuals; then it is held, or the two can chase each other.
const FREE_ROUNDS: usize = 6;
/// A step below this share of the standard error ends the search.
const SETTLED: f64 = 1e-4;

/// What is fitted to what.
#[derive(Clone, Debug)]
pub struct Model<'a> {
    /// Name for messages.
    pub name: &'static str,
    /// The coast-downs.
    pub coasts: &'a [Coast],
    /// What is free.
    pub terms: Vec<Term>,
    /// What is known of the air.
    pub air: Air,
}

/// Where a fit ended.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// Terms fitted.
    pub terms: Vec<Term>,
    /// One value a term.
    pub parameters: Vec<f64>,
    /// Initial speed of each run [m/s].
    pub initial_m_s: Vec<f64>,
    /// Covariance found.
    pub noise: Noise,
    /// What each run says about the terms, at the estimate.
    pub clusters: Vec<Cluster>,
    /// Their pool; its step is rounding.
    pub pooled: Pooled,
    /// Offset of the level of each run, and its standard deviation from the noise within the run: of c_w where that is
    /// fitted, else of resistance over weight.
    pub offsets: Vec<(f64, f64)>,
    /// Root mean square of the residual of each run, with its own offset [m/s].
    pub rms_m_s: Vec<f64>,
}

/// Residual and Jacobian of one run; the columns are the terms, the offset and the initial speed.
struct Deviation {
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
}

impl Model<'_> {
    /// Finds the parameters.
    ///
    /// # Errors
    /// [`CoastDownError::Undetermined`] or [`CoastDownError::NotSettled`].
    pub fn fit(&self) -> Result<Fitted, CoastDownError> {
        let start = self.start();
        let solution = minimise(self, start, &Stop::default());
        let size = self.terms.len();
        let mut parameters: Vec<f64> = solution.x.as_slice()[..size].to_vec();
        let mut initial: Vec<f64> = solution.x.as_slice()[size..].to_vec();
        let mut held: Option<Noise> = None;
        for round in 0..ROUNDS {
            let deviations = self.deviations(&parameters, &initial);
            let time = match held {
                Some(noise) if round >= FREE_ROUNDS => noise.correlation_time_s,
                _ => correlation_time_s(self.coasts, &self.own_deviations(&deviations)?),
            };
            let normals = self.normals(&deviations, time);
            let noise = match held {
                Some(noise) if round >= FREE_ROUNDS => noise,
                _ => self.noise(&normals, time)?,
            };
            held = Some(noise);
            let clusters = self.clusters(&normals, &noise)?;
            let (step, covariance) = step(&clusters).ok_or(self.undetermined())?;
            let mut largest: f64 = 0.0;
            for (index, parameter) in parameters.iter_mut().enumerate() {
                *parameter += step[index];
                largest = largest
                    .max(step[index].abs() / (covariance[(index, index)].sqrt() + 1e-9 * parameter.abs()));
            }
            for (speed, normal) in initial.iter_mut().zip(&normals) {
                *speed += response(normal, &step, &noise)[1];
            }
            if largest < SETTLED {
                return self.at(parameters, initial, noise);
            }
        }
        Err(CoastDownError::NotSettled { model: self.name, linearisations: solution.linearisations + ROUNDS })
    }

    /// What each run says about `terms`, which may be others than were fitted: they count as zero.
    ///
    /// # Errors
    /// [`CoastDownError::Undetermined`] where a run does not even determine its initial speed.
    pub fn information(&self, fitted: &Fitted) -> Result<Vec<Cluster>, CoastDownError> {
        let parameters: Vec<f64> = self
            .terms
            .iter()
            .map(|term| {
                let index = fitted.terms.iter().position(|other| other == term);
                index.map_or(0.0, |index| fitted.parameters[index])
            })
            .collect();
        let deviations = self.deviations(&parameters, &fitted.initial_m_s);
        let normals = self.normals(&deviations, fitted.noise.correlation_time_s);
        self.clusters(&normals, &fitted.noise)
    }

    fn at(
        &self,
        parameters: Vec<f64>,
        initial_m_s: Vec<f64>,
        noise: Noise,
    ) -> Result<Fitted, CoastDownError> {
        let deviations = self.deviations(&parameters, &initial_m_s);
        let normals = self.normals(&deviations, noise.correlation_time_s);
        let clusters = self.clusters(&normals, &noise)?;
        let pooled = pool(&clusters).ok_or(self.undetermined())?;
        let none = DVector::zeros(self.terms.len());
        let offsets = normals.iter().map(|normal| offset(normal, &none, &noise)).collect();
        let rms_m_s = self
            .own_deviations(&deviations)?
            .iter()
            .map(|deviation| (deviation.norm_squared() / deviation.len() as f64).sqrt())
            .collect();
        Ok(Fitted {
            terms: self.terms.clone(),
            parameters,
            initial_m_s,
            noise,
            clusters,
            pooled,
            offsets,
            rms_m_s,
        })
    }

    /// What varies from run to run: the level, with the shape that the model gives it. A run could otherwise set its
    /// level by an offset and the common coefficient by the bend of its curve, which a wrong model bends too.
    fn offset_term(&self) -> Term {
        match self.terms.first() {
            Some(rolling @ Term::Rolling { .. }) => *rolling,
            _ => Term::Offset,
        }
    }

    fn undetermined(&self) -> CoastDownError {
        CoastDownError::Undetermined { model: self.name }
    }

    /// The first term alone explains the mean deceleration, the first sample is the initial speed.
    fn start(&self) -> DVector<f64> {
        let mut start = DVector::zeros(self.terms.len() + self.coasts.len());
        let (mut force, mut scale) = (0.0, 0.0);
        for (index, coast) in self.coasts.iter().enumerate() {
            let last = coast.time_s.len() - 1;
            let (first, end) = (coast.speed_m_s[0], coast.speed_m_s[last]);
            start[self.terms.len() + index] = first;
            force += coast.effective_mass_kg * (first - end) / coast.time_s[last];
            scale += match self.terms.first() {
                Some(Term::Rolling { .. }) => coast.weight_n(),
                _ => 1.0,
            };
        }
        if !self.terms.is_empty() {
            start[0] = force / scale;
        }
        start
    }

    fn deviations(&self, parameters: &[f64], initial_m_s: &[f64]) -> Vec<Deviation> {
        let mut terms = self.terms.clone();
        terms.push(self.offset_term());
        let mut parameters = parameters.to_vec();
        parameters.push(0.0);
        let motion = Motion { terms: &terms, parameters: &parameters, air: self.air };
        self.coasts
            .iter()
            .zip(initial_m_s)
            .map(|(coast, initial)| {
                let (speeds, jacobian) = motion.roll_out(coast, *initial);
                Deviation { residual: DVector::from_column_slice(&coast.speed_m_s) - speeds, jacobian }
            })
            .collect()
    }

    /// What is left of each run when its own offset and initial speed are taken out.
    fn own_deviations(&self, deviations: &[Deviation]) -> Result<Vec<DVector<f64>>, CoastDownError> {
        deviations
            .iter()
            .map(|Deviation { residual, jacobian }| {
                let own = jacobian.columns(self.terms.len(), 2).into_owned();
                let normal = own.transpose() * &own;
                let inverse = scaled_inverse(&normal).ok_or(self.undetermined())?;
                Ok(residual - &own * (inverse * (own.transpose() * residual)))
            })
            .collect()
    }

    fn normals(&self, deviations: &[Deviation], correlation_time_s: f64) -> Vec<Normal> {
        self.coasts
            .iter()
            .zip(deviations)
            .map(|(coast, deviation)| {
                normal(coast, &deviation.jacobian, &deviation.residual, correlation_time_s)
            })
            .collect()
    }

    fn noise(&self, normals: &[Normal], correlation_time_s: f64) -> Result<Noise, CoastDownError> {
        let (mut square, mut freedom) = (0.0, -(self.terms.len() as f64));
        for normal in normals {
            square += left_over(normal).ok_or(self.undetermined())?;
            freedom += normal.samples as f64 - 2.0;
        }
        let sample_m_s = (square / freedom.max(1.0)).sqrt().max(ROUNDING_M_S);
        let mut noise = Noise { sample_m_s, correlation_time_s, between_runs: 0.0 };
        let between = self
            .terms
            .iter()
            .filter(|term| matches!(term, Term::Grade { .. } | Term::Headwind { .. }))
            .count() as f64;
        let freedom = normals.len() as f64 - 1.0 - between;
        let excess = |between_runs: f64| -> Result<f64, CoastDownError> {
            let noise = Noise { between_runs, ..noise };
            let (step, _) = step(&self.clusters(normals, &noise)?).ok_or(self.undetermined())?;
            let spread = normals.iter().map(|normal| {
                let (offset, deviation) = offset(normal, &step, &noise);
                offset * offset / (deviation * deviation + between_runs * between_runs)
            });
            Ok(spread.sum::<f64>() - freedom)
        };
        if freedom < 1.0 || excess(0.0)? <= 0.0 {
            return Ok(noise);
        }
        let (mut low, mut high) = (1e-9_f64, 1.0_f64);
        for _ in 0..40 {
            let middle = (low * high).sqrt();
            if excess(middle)? > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        noise.between_runs = high;
        Ok(noise)
    }

    fn clusters(&self, normals: &[Normal], noise: &Noise) -> Result<Vec<Cluster>, CoastDownError> {
        let size = self.terms.len();
        normals
            .iter()
            .map(|normal| {
                let nuisance = nuisance_inverse(normal, noise).ok_or(self.undetermined())?;
                let cross = normal.matrix.view((0, size), (size, 2));
                let gain = cross * nuisance;
                let variance = noise.sample_m_s.powi(2);
                let information =
                    (normal.matrix.view((0, 0), (size, size)) - &gain * cross.transpose()) / variance;
                let score = (normal.vector.rows(0, size) - &gain * normal.vector.rows(size, 2)) / variance;
                Ok(Cluster { information: 0.5 * (&information + information.transpose()), score })
            })
            .collect()
    }
}

impl Problem for Model<'_> {
    fn linearise(&self, x: &DVector<f64>) -> Linearised {
        let size = self.terms.len();
        let mut gradient = DVector::zeros(x.len());
        let mut information = DMatrix::zeros(x.len(), x.len());
        let mut cost = 0.0;
        let initial = &x.as_slice()[size..];
        for (index, Deviation { residual, jacobian }) in
            self.deviations(&x.as_slice()[..size], initial).into_iter().enumerate()
        {
            let own = size + index;
            let jacobian = jacobian.remove_column(size);
            let product = jacobian.transpose() * &jacobian;
            let score = jacobian.transpose() * &residual;
            let place = |column: usize| if column == size { own } else { column };
            for row in 0..=size {
                gradient[place(row)] += score[row];
                for column in 0..=size {
                    information[(place(row), place(column))] += product[(row, column)];
                }
            }
            cost += residual.norm_squared();
        }
        Linearised { cost, gradient, information }
    }
}

/// Generalised least-squares step and its covariance.
pub fn step(clusters: &[Cluster]) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let size = clusters.first()?.score.len();
    let mut information = DMatrix::zeros(size, size);
    let mut score = DVector::zeros(size);
    for cluster in clusters {
        information += &cluster.information;
        score += &cluster.score;
    }
    let inverse = scaled_inverse(&information)?;
    Some((&inverse * score, inverse))
}

/// Inverse of the normal matrix of offset and initial speed; the offset has the prior that runs differ by τ.
fn nuisance_inverse(normal: &Normal, noise: &Noise) -> Option<DMatrix<f64>> {
    let size = normal.matrix.nrows() - 2;
    let mut own = normal.matrix.view((size, size), (2, 2)).into_owned();
    if noise.between_runs > 0.0 {
        own[(0, 0)] += (noise.sample_m_s / noise.between_runs).powi(2);
        return scaled_inverse(&own);
    }
    let mut inverse = DMatrix::zeros(2, 2);
    inverse[(1, 1)] = 1.0 / own[(1, 1)];
    inverse[(1, 1)].is_finite().then_some(inverse)
}

/// Offset and change of initial speed of a run when the terms move by `step`.
fn response(normal: &Normal, step: &DVector<f64>, noise: &Noise) -> DVector<f64> {
    let size = step.len();
    let left = normal.vector.rows(size, 2) - normal.matrix.view((size, 0), (2, size)) * step;
    nuisance_inverse(normal, noise).map_or_else(|| DVector::zeros(2), |inverse| inverse * left)
}

/// Offset of a run for itself, and its standard deviation, when the terms move by `step`.
fn offset(normal: &Normal, step: &DVector<f64>, noise: &Noise) -> (f64, f64) {
    let size = step.len();
    let own = normal.matrix.view((size, size), (2, 2));
    let left = normal.vector.rows(size, 2) - normal.matrix.view((size, 0), (2, size)) * step;
    let gain = own[(0, 1)] / own[(1, 1)];
    let information = own[(0, 0)] - gain * own[(1, 0)];
    ((left[0] - gain * left[1]) / information, noise.sample_m_s / information.sqrt())
}

/// Residual square that offset and initial speed of the run leave.
fn left_over(normal: &Normal) -> Option<f64> {
    let size = normal.matrix.nrows() - 2;
    let inverse = scaled_inverse(&normal.matrix.view((size, size), (2, 2)).into_owned())?;
    let own = normal.vector.rows(size, 2).into_owned();
    Some((normal.square - own.dot(&(inverse * &own))).max(0.0))
}
