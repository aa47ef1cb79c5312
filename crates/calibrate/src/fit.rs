//! Parameters with priors and bounds, fitted to residuals that depend on one another within a run.
//!
//! Minimises Σ (r/σ)² + Σ ((x − x₀)/s)² by Gauss–Newton steps with Marquardt's damping, held within the bounds.
//! The residuals come in clusters (runs, or blocks of a long run) that are independent of each other: intervals follow
//! from the scatter between clusters, see [`crate::clusters`].

use crate::clusters::{Cluster, pool, student_interval};
use crate::separable::blind_directions;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

/// Something that may be moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name, ending in its unit.
    pub name: String,
    /// Prior value, and where the search starts.
    pub value: f64,
    /// Prior standard deviation; `None` where nothing is known.
    pub sd: Option<f64>,
    /// Least and greatest value.
    pub bounds: (f64, f64),
}

impl Parameter {
    /// A change that matters, for steps and for what counts as separable.
    fn size(&self) -> f64 {
        /// Without a prior, a tenth of the value.
        const SHARE: f64 = 0.1;
        let of_bounds = 0.1 * (self.bounds.1 - self.bounds.0);
        match self.sd {
            Some(sd) => sd,
            None if self.value != 0.0 => SHARE * self.value.abs(),
            None if of_bounds.is_finite() => of_bounds,
            None => SHARE,
        }
    }
}

/// What was found of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Prior value.
    pub prior: f64,
    /// Prior standard deviation.
    pub prior_sd: Option<f64>,
    /// Fitted value.
    pub value: f64,
    /// Standard error.
    pub standard_error: f64,
    /// 95 % interval.
    pub ci95: [f64; 2],
    /// Whether it ended at a bound; the interval then says nothing.
    pub at_bound: bool,
}

/// A fit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// One for each parameter.
    pub estimates: Vec<Estimate>,
    /// Correlation of the estimates.
    pub correlation: Vec<Vec<f64>>,
    /// Sum of squared weighted residuals at the prior, without the prior's own part.
    pub cost_before: f64,
    /// The same at the estimate.
    pub cost_after: f64,
    /// Number of residuals.
    pub residuals: usize,
    /// Number of clusters.
    pub clusters: usize,
    /// Whether the search came to its end.
    pub converged: bool,
    /// What the data cannot separate, one sentence each.
    pub null_space: Vec<String>,
}

impl Fit {
    /// The fitted values, in the order of the parameters.
    pub fn values(&self) -> Vec<f64> {
        self.estimates.iter().map(|estimate| estimate.value).collect()
    }
}

/// Weighted residuals, one list for each cluster, of the same length at every point.
pub type Residuals = Vec<Vec<f64>>;

/// Clusters to a parameter from which on their scatter can be trusted.
const FEW_CLUSTERS: usize = 3;
const MOST_STEPS: usize = 25;
/// A search ends when a step promises less than this share of the cost.
const LEAST_DECREASE: f64 = 1e-6;
/// Step of the difference quotients as a share of a parameter's size: far above rounding, far below curvature.
const DIFFERENCE: f64 = 1e-2;

struct Here {
    x: DVector<f64>,
    residuals: Residuals,
    cost: f64,
}

/// Fits. `evaluate` is asked for residuals at many points, several at once.
///
/// # Errors
/// What `evaluate` gives.
pub fn fit<E: Send>(
    parameters: &[Parameter],
    evaluate: impl Fn(&[f64]) -> Result<Residuals, E> + Sync,
) -> Result<Fit, E> {
    let objective = |x: &DVector<f64>| -> Result<Here, E> {
        let residuals = evaluate(x.as_slice())?;
        let cost = data_cost(&residuals) + prior_cost(parameters, x);
        Ok(Here { x: x.clone(), residuals, cost })
    };
    let start = DVector::from_iterator(parameters.len(), parameters.iter().map(|one| one.value));
    let mut here = objective(&start)?;
    let cost_before = data_cost(&here.residuals);
    let mut damping = 1e-3;
    let mut converged = parameters.is_empty();
    let mut jacobian = jacobian(parameters, &evaluate, &here)?;
    for _ in 0..MOST_STEPS {
        if converged {
            break;
        }
        let (information, gradient) = normal_equations(parameters, &here, &jacobian);
        let fixed = held(parameters, &here.x, &gradient);
        let Some(step) = step(parameters, &here.x, &information, &gradient, &fixed, damping) else {
            damping *= 10.0;
            continue;
        };
        let promised = 2.0 * step.dot(&gradient) - step.dot(&(&information * &step));
        if promised <= LEAST_DECREASE * here.cost {
            converged = true;
            break;
        }
        let next = objective(&(&here.x + &step))?;
        if next.cost < here.cost {
            damping = (damping * 0.2).max(1e-9);
            here = next;
            jacobian = self::jacobian(parameters, &evaluate, &here)?;
        } else {
            damping *= 10.0;
            if damping > 1e9 {
                break;
            }
        }
    }
    Ok(conclude(parameters, &here, &jacobian, cost_before, converged))
}

fn data_cost(residuals: &Residuals) -> f64 {
    residuals.iter().flatten().map(|residual| residual * residual).sum()
}

fn prior_cost(parameters: &[Parameter], x: &DVector<f64>) -> f64 {
    let part = |(parameter, value): (&Parameter, &f64)| {
        parameter.sd.map_or(0.0, |sd| ((value - parameter.value) / sd).powi(2))
    };
    parameters.iter().zip(x.iter()).map(part).sum()
}

/// ∂r/∂x of every cluster, by differences towards the inside of the bounds.
fn jacobian<E: Send>(
    parameters: &[Parameter],
    evaluate: &(impl Fn(&[f64]) -> Result<Residuals, E> + Sync),
    here: &Here,
) -> Result<Vec<DMatrix<f64>>, E> {
    let columns: Vec<Residuals> = (0..parameters.len())
        .into_par_iter()
        .map(|index| {
            let parameter = &parameters[index];
            let mut step = DIFFERENCE * parameter.size();
            if here.x[index] + step > parameter.bounds.1 {
                step = -step;
            }
            let mut moved = here.x.clone();
            moved[index] += step;
            let mut there = evaluate(moved.as_slice())?;
            for (after, before) in there.iter_mut().flatten().zip(here.residuals.iter().flatten()) {
                *after = (*after - before) / step;
            }
            Ok(there)
        })
        .collect::<Result<_, E>>()?;
    Ok((0..here.residuals.len())
        .map(|cluster| {
            DMatrix::from_fn(here.residuals[cluster].len(), parameters.len(), |row, column| {
                columns[column][cluster][row]
            })
        })
        .collect())
}

/// Information with the prior, and the direction downhill.
fn normal_equations(
    parameters: &[Parameter],
    here: &Here,
    jacobian: &[DMatrix<f64>],
) -> (DMatrix<f64>, DVector<f64>) {
    let mut information = prior_information(parameters);
    let mut gradient = DVector::from_fn(parameters.len(), |index, _| {
        parameters[index].sd.map_or(0.0, |sd| (parameters[index].value - here.x[index]) / (sd * sd))
    });
    for cluster in clusters_of(here, jacobian) {
        information += cluster.information;
        gradient += cluster.score;
    }
    (information, gradient)
}

fn prior_information(parameters: &[Parameter]) -> DMatrix<f64> {
    let diagonal = parameters.iter().map(|one| one.sd.map_or(0.0, |sd| sd.powi(-2)));
    DMatrix::from_diagonal(&DVector::from_iterator(parameters.len(), diagonal))
}

fn clusters_of(here: &Here, jacobian: &[DMatrix<f64>]) -> Vec<Cluster> {
    let cluster = |(rows, residuals): (&DMatrix<f64>, &Vec<f64>)| Cluster {
        information: rows.transpose() * rows,
        score: -rows.transpose() * DVector::from_column_slice(residuals),
    };
    jacobian.iter().zip(&here.residuals).map(cluster).collect()
}

/// Parameters that lie at a bound and would leave it.
fn held(parameters: &[Parameter], x: &DVector<f64>, gradient: &DVector<f64>) -> Vec<bool> {
    let one = |(index, parameter): (usize, &Parameter)| {
        x[index] <= parameter.bounds.0 && gradient[index] < 0.0
            || x[index] >= parameter.bounds.1 && gradient[index] > 0.0
    };
    parameters.iter().enumerate().map(one).collect()
}

fn step(
    parameters: &[Parameter],
    x: &DVector<f64>,
    information: &DMatrix<f64>,
    gradient: &DVector<f64>,
    fixed: &[bool],
    damping: f64,
) -> Option<DVector<f64>> {
    let mut matrix = information.clone();
    let mut right = gradient.clone();
    for (index, fixed) in fixed.iter().enumerate() {
        let own = matrix[(index, index)];
        matrix[(index, index)] =
            if own > 0.0 { own * (1.0 + damping) } else { parameters[index].size().powi(-2) };
        if *fixed {
            matrix.row_mut(index).fill(0.0);
            matrix.column_mut(index).fill(0.0);
            matrix[(index, index)] = 1.0;
            right[index] = 0.0;
        }
    }
    let step = matrix.cholesky()?.solve(&right);
    step.iter().all(|value| value.is_finite()).then(|| {
        DVector::from_fn(step.len(), |index, _| {
            let (low, high) = parameters[index].bounds;
            (x[index] + step[index]).clamp(low, high) - x[index]
        })
    })
}

fn conclude(
    parameters: &[Parameter],
    here: &Here,
    jacobian: &[DMatrix<f64>],
    cost_before: f64,
    converged: bool,
) -> Fit {
    let clusters = clusters_of(here, jacobian);
    let count = parameters.len();
    // The prior is one more independent source of information.
    let mut sources = clusters.clone();
    for (index, parameter) in parameters.iter().enumerate() {
        if let Some(sd) = parameter.sd {
            let mut information = DMatrix::zeros(count, count);
            information[(index, index)] = sd.powi(-2);
            let mut score = DVector::zeros(count);
            score[index] = (parameter.value - here.x[index]) / (sd * sd);
            sources.push(Cluster { information, score });
        }
    }
    let size: Vec<f64> = parameters.iter().map(Parameter::size).collect();
    let at_bound = |index: usize| {
        let (low, high) = parameters[index].bounds;
        here.x[index] <= low || here.x[index] >= high
    };
    // What a bound holds is not estimated: the others are judged as if it were known.
    let open: Vec<usize> = (0..count).filter(|index| !at_bound(*index)).collect();
    let judged = Judged::new(&sources, &open, here);
    let estimates = parameters.iter().enumerate().map(|(index, parameter)| {
        let (standard_error, ci95) = match open.iter().position(|other| *other == index) {
            Some(place) => judged.interval(place, here.x[index]),
            None => (f64::NAN, [f64::NEG_INFINITY, f64::INFINITY]),
        };
        Estimate {
            name: parameter.name.clone(),
            prior: parameter.value,
            prior_sd: parameter.sd,
            value: here.x[index],
            standard_error,
            ci95,
            at_bound: at_bound(index),
        }
    });
    let information = clusters.iter().fold(prior_information(parameters), |sum, one| sum + &one.information);
    Fit {
        estimates: estimates.collect(),
        correlation: crate::clusters::scaled_inverse(&information)
            .as_ref()
            .map_or_else(Vec::new, correlation),
        cost_before,
        cost_after: data_cost(&here.residuals),
        residuals: here.residuals.iter().map(Vec::len).sum(),
        clusters: here.residuals.len(),
        converged,
        null_space: null_space(parameters, &clusters, &size),
    }
}

/// The uncertainty of the parameters that no bound holds.
struct Judged {
    pooled: Option<crate::clusters::Pooled>,
    plain: Option<DMatrix<f64>>,
    scattered: f64,
    size: usize,
    sources: usize,
}

impl Judged {
    fn new(sources: &[Cluster], open: &[usize], here: &Here) -> Self {
        let size = open.len();
        let part = |cluster: &Cluster| Cluster {
            information: DMatrix::from_fn(size, size, |row, column| {
                cluster.information[(open[row], open[column])]
            }),
            score: DVector::from_fn(size, |row, _| cluster.score[open[row]]),
        };
        let sources: Vec<Cluster> = sources.iter().map(part).collect();
        let information = sources.iter().fold(DMatrix::zeros(size, size), |sum, one| sum + &one.information);
        Self {
            pooled: pool(&sources),
            plain: crate::clusters::scaled_inverse(&information),
            scattered: cost_scale(here),
            size,
            sources: here.residuals.len(),
        }
    }

    /// Standard error and 95 % interval of a value.
    fn interval(&self, place: usize, value: f64) -> (f64, [f64; 2]) {
        let robust = self.pooled.as_ref().map_or(f64::INFINITY, |pooled| pooled.covariance[(place, place)]);
        let plain = self.plain.as_ref().map_or(f64::INFINITY, |plain| plain[(place, place)] * self.scattered);
        // Few clusters can agree by chance; what the residuals themselves say is the floor.
        let variance = robust.max(plain);
        // Fewer clusters than this to a parameter leave their scatter no degrees of freedom that could be counted.
        let few = self.sources < FEW_CLUSTERS * self.size;
        let direction = DVector::from_fn(self.size, |row, _| f64::from(row == place));
        let degrees = self.pooled.as_ref().map_or(f64::NAN, |pooled| pooled.degrees_of_freedom(&direction));
        let degrees = match (few, degrees.is_finite()) {
            (true, _) => (self.sources as f64 - 1.0).max(1.0),
            (false, true) => degrees.max(1.0),
            (false, false) => 1.0,
        };
        if variance.is_finite() {
            (variance.sqrt(), student_interval(value, variance, degrees, 0.0, 0.95).0)
        } else {
            (f64::INFINITY, [f64::NEG_INFINITY, f64::INFINITY])
        }
    }
}

/// What one residual is worth, squared: 1 where the weights were right.
fn cost_scale(here: &Here) -> f64 {
    let count: usize = here.residuals.iter().map(Vec::len).sum();
    if count > here.x.len() { data_cost(&here.residuals) / (count - here.x.len()) as f64 } else { 1.0 }
}

fn correlation(covariance: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let sd = covariance.diagonal().map(f64::sqrt);
    (0..covariance.nrows())
        .map(|row| {
            (0..covariance.ncols()).map(|column| covariance[(row, column)] / (sd[row] * sd[column])).collect()
        })
        .collect()
}

/// What the data, without the priors, cannot tell apart.
fn null_space(parameters: &[Parameter], clusters: &[Cluster], size: &[f64]) -> Vec<String> {
    let count = parameters.len();
    let information = clusters.iter().fold(DMatrix::zeros(count, count), |sum, one| sum + &one.information);
    let names: Vec<&str> = parameters.iter().map(|one| one.name.as_str()).collect();
    blind_directions(&information, size).iter().map(|blind| blind.told(&names)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Draws;
    use std::convert::Infallible;

    fn parameter(name: &str, value: f64, sd: Option<f64>) -> Parameter {
        Parameter { name: name.to_owned(), value, sd, bounds: (f64::NEG_INFINITY, f64::INFINITY) }
    }

    /// y = a + b x + noise of sd 0.1 in ten clusters.
    fn line(a: f64, b: f64) -> Vec<Vec<(f64, f64)>> {
        (0..10)
            .map(|cluster| {
                let mut draws = Draws::new(7, cluster);
                (0..20)
                    .map(|sample| {
                        let x = f64::from(sample) / 20.0;
                        (x, a + b * x + 0.1 * draws.normal())
                    })
                    .collect()
            })
            .collect()
    }

    fn residuals(data: &[Vec<(f64, f64)>], x: &[f64]) -> Residuals {
        data.iter()
            .map(|cluster| cluster.iter().map(|(at, y)| (x[0] + x[1] * at - y) / 0.1).collect())
            .collect()
    }

    #[test]
    fn a_line_is_found_with_textbook_errors() {
        let data = line(2.0, -3.0);
        let parameters = [parameter("a", 0.0, None), parameter("b", 1.0, None)];
        let fit = fit(&parameters, |x| Ok::<_, Infallible>(residuals(&data, x))).unwrap();
        assert!(fit.converged && fit.null_space.is_empty(), "{fit:?}");
        for (estimate, truth) in fit.estimates.iter().zip([2.0, -3.0]) {
            assert!((estimate.value - truth).abs() < 4.0 * estimate.standard_error, "{estimate:?}");
        }
        // By hand: sd(b) = σ / √(n var x), with var x of 0, 0.05 … 0.95 = 0.083125.
        let textbook = 0.1 / (200.0_f64 * 0.083_125).sqrt();
        assert!((fit.estimates[1].standard_error / textbook - 1.0).abs() < 0.6, "{fit:?}");
        assert!(fit.correlation[0][1] < -0.8);
    }

    #[test]
    fn a_prior_holds_what_the_data_leave_open() {
        let data = line(2.0, -3.0);
        let parameters =
            [parameter("a", 1.0, Some(0.5)), parameter("twin", 0.0, Some(0.5)), parameter("b", 0.0, None)];
        let twins = |x: &[f64]| Ok::<_, Infallible>(residuals(&data, &[x[0] + x[1], x[2]]));
        let fit = fit(&parameters, twins).unwrap();
        // The sum is known to be 2 and the prior 1 ± ½ and 0 ± ½ shares the rest evenly: 1.5 and 0.5.
        assert!((fit.estimates[0].value - 1.5).abs() < 0.05 && (fit.estimates[1].value - 0.5).abs() < 0.05);
        assert_eq!(fit.null_space.len(), 1, "{:?}", fit.null_space);
        assert!(fit.null_space[0].contains("`twin` cannot be told apart from `a`"));
    }

    #[test]
    fn a_bound_holds_and_is_told() {
        let data = line(2.0, -3.0);
        let mut parameters = [parameter("a", 0.0, None), parameter("b", 1.0, None)];
        parameters[1].bounds = (-1.0, 2.0);
        let fit = fit(&parameters, |x| Ok::<_, Infallible>(residuals(&data, x))).unwrap();
        assert!(fit.estimates[1].at_bound && fit.estimates[1].value == -1.0);
        // With b held at −1 the best a is the mean of 2 − 3x + x = 2 − 2 · 0.475.
        assert!((fit.estimates[0].value - 1.05).abs() < 0.05, "{fit:?}");
    }

    #[test]
    fn a_curved_problem_is_followed() {
        let truth = [1.5, 0.7];
        let data: Vec<(f64, f64)> = (0..60)
            .map(|index| f64::from(index) / 10.0)
            .map(|x| (x, truth[0] * (-truth[1] * x).exp()))
            .collect();
        let parameters = [parameter("height", 1.0, None), parameter("rate_per_s", 0.2, None)];
        let decay = |x: &[f64]| {
            let all: Vec<f64> = data.iter().map(|(at, y)| x[0] * (-x[1] * at).exp() - y).collect();
            Ok::<_, Infallible>(all.chunks(10).map(<[f64]>::to_vec).collect::<Residuals>())
        };
        let fit = fit(&parameters, decay).unwrap();
        for (estimate, truth) in fit.estimates.iter().zip(truth) {
            assert!((estimate.value / truth - 1.0).abs() < 1e-3, "{estimate:?}");
        }
    }
}
