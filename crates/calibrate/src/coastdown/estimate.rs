//! From a fit to numbers with intervals.

use super::CoastDownError;
use super::fit::{Fitted, Model, step};
use super::input::Settings;
use super::motion::Term;
use super::report::{Estimate, FitReport};
use super::segment::Coast;
use crate::clusters::{Bootstrap, Resampling, bootstrap, student_interval};
use nalgebra::{DMatrix, DVector};

/// Level of every interval.
const LEVEL: f64 = 0.95;
/// Fewest runs that a bootstrap is drawn from.
const LEAST_RUNS: usize = 5;
/// Fewest degrees of freedom of the scatter between runs that an interval is built on; two runs in one direction
/// have one.
const LEAST_DEGREES: f64 = 0.9;

/// A fit and what its constants add to its uncertainty.
pub struct Judged {
    /// The fit.
    pub fitted: Fitted,
    /// One column a constant: what one standard deviation of it does to the parameters.
    pub systematic: DMatrix<f64>,
    /// Variance that scatter between runs and constants give together.
    pub covariance: DMatrix<f64>,
    bootstrap: Option<Bootstrap>,
}

impl Judged {
    /// Judges a fit. `shifted` holds the coast-downs with one constant moved by its standard deviation each.
    ///
    /// # Errors
    /// [`CoastDownError::Undetermined`] where a shifted study determines nothing.
    pub fn new(
        model: &Model,
        fitted: Fitted,
        shifted: &[Vec<Coast>],
        settings: &Settings,
    ) -> Result<Self, CoastDownError> {
        let mut systematic = DMatrix::zeros(fitted.parameters.len(), shifted.len());
        for (column, coasts) in shifted.iter().enumerate() {
            let clusters = Model { coasts, ..model.clone() }.information(&fitted)?;
            let (moved, _) = step(&clusters).ok_or(CoastDownError::Undetermined { model: model.name })?;
            systematic.set_column(column, &(moved - &fitted.pooled.step));
        }
        let covariance = &fitted.pooled.covariance + &systematic * systematic.transpose();
        let strata = strata(model.coasts);
        let enough = model.coasts.len() >= LEAST_RUNS && settings.replicates > 0;
        let bootstrap = enough.then(|| {
            let resampling = Resampling {
                strata: &strata,
                replicates: settings.replicates,
                seed: settings.seed,
                systematic: &systematic,
            };
            bootstrap(&fitted.clusters, &fitted.pooled, &resampling)
        });
        Ok(Self { fitted, systematic, covariance, bootstrap })
    }

    /// Value of a combination of parameters with its standard error, degrees of freedom and Student interval.
    pub fn combination(&self, direction: &DVector<f64>) -> (f64, Option<Spread>) {
        let value = direction.dot(&DVector::from_column_slice(&self.fitted.parameters));
        let scatter = self.fitted.pooled.variance(direction);
        let systematic = (self.systematic.transpose() * direction).norm_squared();
        let degrees = self.fitted.pooled.degrees_of_freedom(direction);
        let directional = |term: &&Term| matches!(term, Term::Grade { .. } | Term::Headwind { .. });
        let levels = 1 + self.fitted.terms.iter().filter(directional).count();
        if self.fitted.clusters.len() <= levels || degrees.is_nan() || degrees < LEAST_DEGREES {
            return (value, None);
        }
        let (interval, degrees) = student_interval(value, scatter, degrees, systematic, LEVEL);
        let standard_error = (scatter + systematic).sqrt();
        let usable = interval.iter().all(|end| end.is_finite());
        (value, usable.then_some(Spread { standard_error, degrees, interval }))
    }

    /// The fit as it is reported. `name` gives name and unit of a term.
    pub fn report(&self, name: impl Fn(Term) -> (String, &'static str)) -> FitReport {
        let fitted = &self.fitted;
        let size = fitted.parameters.len();
        let estimates = (0..size)
            .map(|index| {
                let direction = DVector::from_fn(size, |row, _| f64::from(u8::from(row == index)));
                let (value, spread) = self.combination(&direction);
                let resampled = self.bootstrap.as_ref().zip(spread.as_ref());
                let bootstrap_95 = resampled.and_then(|(bootstrap, spread)| {
                    bootstrap.studentised(index, value, spread.standard_error, LEVEL)
                });
                let percentile_95 =
                    resampled.and_then(|(bootstrap, _)| bootstrap.percentile(index, value, LEVEL));
                let student_95 = spread.as_ref().map(|spread| spread.interval);
                let (name, unit) = name(fitted.terms[index]);
                Estimate {
                    name,
                    unit: unit.to_owned(),
                    value,
                    standard_error: spread.as_ref().map(|spread| spread.standard_error),
                    degrees_of_freedom: spread.as_ref().map(|spread| spread.degrees),
                    interval_95: bootstrap_95.or(student_95),
                    student_95,
                    bootstrap_95,
                    percentile_95,
                }
            })
            .collect();
        let runs = fitted.rms_m_s.len() as f64;
        FitReport {
            estimates,
            covariance: self.covariance.row_iter().map(|row| row.iter().copied().collect()).collect(),
            rms_m_s: (fitted.rms_m_s.iter().map(|rms| rms * rms).sum::<f64>() / runs).sqrt(),
            sample_sd_m_s: fitted.noise.sample_m_s,
            correlation_time_s: fitted.noise.correlation_time_s,
            between_runs_sd: fitted.noise.between_runs,
            replicates: self.bootstrap.as_ref().map_or(0, Bootstrap::replicates),
            singular_replicates: self.bootstrap.as_ref().map_or(0, |bootstrap| bootstrap.singular),
        }
    }
}

/// Uncertainty of a number.
pub struct Spread {
    /// Standard error.
    pub standard_error: f64,
    /// Its degrees of freedom.
    pub degrees: f64,
    /// 95 % interval.
    pub interval: [f64; 2],
}

/// Directions are kept in proportion where there are at least three runs of each, else runs are drawn from all.
fn strata(coasts: &[Coast]) -> Vec<usize> {
    let reversed = coasts.iter().filter(|coast| coast.sign < 0.0).count();
    let both = reversed >= 3 && coasts.len() - reversed >= 3;
    coasts.iter().map(|coast| usize::from(both && coast.sign < 0.0)).collect()
}
