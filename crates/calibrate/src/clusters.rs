//! Pooling runs: an estimate from groups of residuals that are dependent within a run and independent between runs,
//! with intervals that hold for few runs.
//!
//! Each run brings its information B_i = JᵀV⁻¹J and score u_i = JᵀV⁻¹r, where V is a working covariance. Then
//!
//! δ = B⁻¹ Σ u_i,  B = Σ B_i                                   generalised least squares
//! cov δ = B⁻¹ (Σ C_i û_i û_iᵀ C_iᵀ) B⁻¹,  û_i = u_i − B_i δ     cluster-robust
//! C_i = B_i^½ (I − B_i^½ B⁻¹ B_i^½)^−½ B_i^−½                  bias-reduced: unbiased if V is right
//!
//! The variance is estimated from few runs, so intervals take Student's t with Satterthwaite's degrees of freedom,
//! ν = (tr Ω)² / tr Ω², Ω being the covariance of the run contributions. For a plain mean of n runs all this is the
//! textbook mean ± t(n−1) s/√n. It stays right, if not optimal, where V is wrong.
//!
//! Sources: Liang & Zeger, *Biometrika* 73 (1986); Bell & McCaffrey, *Survey Methodology* 28 (2002);
//! bootstrap-t: Efron, *The Jackknife, the Bootstrap and Other Resampling Plans* (1982), chapter 10, and Hall,
//! *Annals of Statistics* 16 (1988), who shows why the studentised interval, not the percentile one, is
//! second-order correct.

use crate::statistics::{Draws, quantile_of_sorted, sorted, student_quantile};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;

/// What one run says about the shared parameters, linearised at a common point.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// JᵀV⁻¹J.
    pub information: DMatrix<f64>,
    /// JᵀV⁻¹r.
    pub score: DVector<f64>,
}

/// The estimate from all runs.
#[derive(Clone, Debug)]
pub struct Pooled {
    /// Step from the point of linearisation to the estimate.
    pub step: DVector<f64>,
    /// Covariance if the working covariance were right: B⁻¹.
    pub model_covariance: DMatrix<f64>,
    /// Covariance from the scatter between runs, whatever the working covariance.
    pub covariance: DMatrix<f64>,
    /// C_iᵀ B⁻¹ and B_i, for the degrees of freedom.
    parts: Vec<(DMatrix<f64>, DMatrix<f64>)>,
}

/// Pools the clusters; none where the information is singular.
pub fn pool<'a>(clusters: impl IntoIterator<Item = &'a Cluster>) -> Option<Pooled> {
    let clusters: Vec<&Cluster> = clusters.into_iter().collect();
    let size = clusters.first()?.score.len();
    let mut information = DMatrix::zeros(size, size);
    let mut score = DVector::zeros(size);
    for cluster in &clusters {
        information += &cluster.information;
        score += &cluster.score;
    }
    let inverse = scaled_inverse(&information)?;
    let step = &inverse * &score;
    let scale = DMatrix::from_diagonal(&information.diagonal().map(f64::sqrt));
    let unscale = DMatrix::from_diagonal(&information.diagonal().map(|value| 1.0 / value.sqrt()));
    let inverse_scaled = &scale * &inverse * &scale;
    let mut covariance = DMatrix::zeros(size, size);
    let mut parts = Vec::with_capacity(clusters.len());
    for cluster in &clusters {
        let own = &unscale * &cluster.information * &unscale;
        let correction = &scale * bias_reduction(&own, &inverse_scaled) * &unscale;
        let bread = &inverse * &correction;
        let residual = &cluster.score - &cluster.information * &step;
        let contribution = &bread * residual;
        covariance += &contribution * contribution.transpose();
        parts.push((bread.transpose(), cluster.information.clone()));
    }
    Some(Pooled { step, model_covariance: inverse, covariance, parts })
}

impl Pooled {
    /// Satterthwaite degrees of freedom of the variance of `directionᵀ δ`; NaN where the runs leave none.
    pub fn degrees_of_freedom(&self, direction: &DVector<f64>) -> f64 {
        let weights: Vec<DVector<f64>> = self.parts.iter().map(|(bread, _)| bread * direction).collect();
        let (mut trace, mut square) = (0.0, 0.0);
        for (i, (_, own)) in self.parts.iter().enumerate() {
            let left = own * &weights[i];
            let spread = &self.model_covariance * &left;
            for (j, (_, other)) in self.parts.iter().enumerate() {
                let mut entry = -(other * &weights[j]).dot(&spread);
                if i == j {
                    entry += weights[i].dot(&left);
                    trace += entry;
                }
                square += entry * entry;
            }
        }
        trace * trace / square
    }

    /// Variance of `directionᵀ δ` from the scatter between runs.
    pub fn variance(&self, direction: &DVector<f64>) -> f64 {
        direction.dot(&(&self.covariance * direction))
    }
}

/// B_i^½ (I − B_i^½ B⁻¹ B_i^½)^−½ B_i^−½; directions in which a run alone decides get zero.
fn bias_reduction(own: &DMatrix<f64>, inverse: &DMatrix<f64>) -> DMatrix<f64> {
    let root = power(own, 0.5);
    let size = own.nrows();
    let left = DMatrix::identity(size, size) - &root * inverse * &root;
    &root * power(&left, -0.5) * power(own, -0.5)
}

/// Power of a symmetric positive semidefinite matrix on its range.
fn power(matrix: &DMatrix<f64>, exponent: f64) -> DMatrix<f64> {
    let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(matrix.clone());
    let largest = eigenvalues.amax();
    let raised = eigenvalues.map(|value| if value > 1e-10 * largest { value.powf(exponent) } else { 0.0 });
    &eigenvectors * DMatrix::from_diagonal(&raised) * eigenvectors.transpose()
}

/// Inverse after scaling to a unit diagonal; none where singular to rounding.
pub fn scaled_inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale = matrix.diagonal().map(|value| 1.0 / value.sqrt());
    if !scale.iter().all(|value| value.is_finite()) {
        return None;
    }
    let scale = DMatrix::from_diagonal(&scale);
    let unit = &scale * matrix * &scale;
    let cholesky = unit.cholesky()?;
    let smallest_pivot = cholesky.l_dirty().diagonal().min();
    (smallest_pivot > 1e-6).then(|| &scale * cholesky.inverse() * &scale)
}

/// How runs are resampled.
#[derive(Clone, Copy, Debug)]
pub struct Resampling<'a> {
    /// Stratum of each cluster: resampling keeps the number of runs in each.
    pub strata: &'a [usize],
    /// Number of replicates.
    pub replicates: usize,
    /// Seed.
    pub seed: u64,
    /// One column for each constant known with an uncertainty: what one standard deviation of it does to the estimate.
    pub systematic: &'a DMatrix<f64>,
}

/// Bootstrap over runs.
#[derive(Clone, Debug)]
pub struct Bootstrap {
    /// Of each replicate and parameter: deviation from the estimate, and deviation over its own standard error.
    draws: Vec<(DVector<f64>, DVector<f64>)>,
    /// Replicates in which the runs drawn could not determine the parameters.
    pub singular: usize,
}

/// Draws runs with replacement within strata, and the known constants from their normal distributions.
/// Replicates run in parallel; each has its own stream of draws, so the result is the same at any thread count.
pub fn bootstrap(clusters: &[Cluster], estimate: &Pooled, resampling: &Resampling) -> Bootstrap {
    let members: Vec<Vec<usize>> = (0..clusters.len())
        .map(|index| {
            (0..clusters.len())
                .filter(|other| resampling.strata[*other] == resampling.strata[index])
                .collect()
        })
        .collect();
    let systematic = resampling.systematic;
    let systematic_variance =
        DVector::from_fn(estimate.step.len(), |row, _| systematic.row(row).norm_squared());
    let draws: Vec<Option<(DVector<f64>, DVector<f64>)>> = (0..resampling.replicates)
        .into_par_iter()
        .map(|replicate| {
            let mut draws = Draws::new(resampling.seed, replicate as u64);
            let drawn = members.iter().map(|stratum| &clusters[stratum[draws.index(stratum.len())]]);
            let pooled = pool(drawn.collect::<Vec<_>>())?;
            let normal = DVector::from_fn(systematic.ncols(), |_, _| draws.normal());
            let deviation = &pooled.step - &estimate.step + systematic * normal;
            let variance = pooled.covariance.diagonal() + &systematic_variance;
            let studentised = deviation.zip_map(&variance, |deviation, variance| deviation / variance.sqrt());
            studentised.iter().all(|value| value.is_finite()).then_some((deviation, studentised))
        })
        .collect();
    let singular = draws.iter().filter(|draw| draw.is_none()).count();
    Bootstrap { draws: draws.into_iter().flatten().collect(), singular }
}

impl Bootstrap {
    /// Percentile interval of parameter `index` about its estimate. It under-covers for few runs; shown for comparison.
    pub fn percentile(&self, index: usize, estimate: f64, level: f64) -> Option<[f64; 2]> {
        let deviations = sorted(&self.draws.iter().map(|(draw, _)| draw[index]).collect::<Vec<_>>());
        let tail = 0.5 * (1.0 - level);
        let ends = [quantile_of_sorted(&deviations, tail), quantile_of_sorted(&deviations, 1.0 - tail)];
        self.enough().then(|| [estimate + ends[0], estimate + ends[1]])
    }

    /// Studentised (bootstrap-t) interval: estimate − quantiles of the studentised deviation × standard error.
    pub fn studentised(&self, index: usize, estimate: f64, error: f64, level: f64) -> Option<[f64; 2]> {
        let pivots = sorted(&self.draws.iter().map(|(_, pivot)| pivot[index]).collect::<Vec<_>>());
        let tail = 0.5 * (1.0 - level);
        let (low, high) = (quantile_of_sorted(&pivots, tail), quantile_of_sorted(&pivots, 1.0 - tail));
        self.enough().then_some([estimate - high * error, estimate - low * error])
    }

    /// Number of replicates drawn.
    pub fn replicates(&self) -> usize {
        self.draws.len() + self.singular
    }

    /// A tail of 2.5 % needs a few replicates in it, and those that failed are no random choice.
    fn enough(&self) -> bool {
        self.draws.len() >= 200 && 20 * self.singular <= self.draws.len()
    }
}

/// Interval estimate ± t · √(scatter + systematic), with the degrees of freedom of the scatter spread over both
/// (Welch–Satterthwaite; JCGM 100:2008, G.4). Variances in the estimate's unit squared.
pub fn student_interval(
    estimate: f64,
    scatter: f64,
    degrees: f64,
    systematic: f64,
    level: f64,
) -> ([f64; 2], f64) {
    let total = scatter + systematic;
    let degrees = degrees * (total / scatter).powi(2);
    let half = student_quantile(0.5 + 0.5 * level, degrees) * total.sqrt();
    ([estimate - half, estimate + half], degrees)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{mean, standard_deviation};

    fn means(values: &[f64]) -> Vec<Cluster> {
        values
            .iter()
            .map(|value| Cluster {
                information: DMatrix::from_element(1, 1, 4.0),
                score: DVector::from(vec![4.0 * value]),
            })
            .collect()
    }

    const VALUES: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 3.0];

    #[test]
    fn the_pool_of_equal_runs_is_the_textbook_mean_and_standard_error() {
        let clusters = means(&VALUES);
        let pooled = pool(&clusters).unwrap();
        assert!((pooled.step[0] - mean(&VALUES)).abs() < 1e-12);
        let expected = standard_deviation(&VALUES).powi(2) / 5.0;
        assert!((pooled.covariance[(0, 0)] / expected - 1.0).abs() < 1e-9);
        assert!((pooled.degrees_of_freedom(&DVector::from(vec![1.0])) - 4.0).abs() < 1e-9);
    }

    /// Level and slope on a covariate ±1, five runs each: the variance of the level is (s₁² + s₂²)/20 and has eight
    /// degrees of freedom.
    #[test]
    fn two_directions_cost_two_degrees_of_freedom() {
        let values = [[1.0, 2.0, 4.0, 8.0, 3.0], [6.0, 5.0, 9.0, 7.0, 7.5]];
        let mut clusters = Vec::new();
        for (group, sign) in values.iter().zip([1.0, -1.0]) {
            for value in group {
                let row = DVector::from(vec![1.0, sign]);
                clusters.push(Cluster { information: &row * row.transpose(), score: row * *value });
            }
        }
        let pooled = pool(&clusters).unwrap();
        let [first, second] = values.map(|group| standard_deviation(&group).powi(2));
        assert!((pooled.covariance[(0, 0)] / ((first + second) / 20.0) - 1.0).abs() < 1e-9);
        assert!((pooled.degrees_of_freedom(&DVector::from(vec![1.0, 0.0])) - 8.0).abs() < 1e-9);
    }

    #[test]
    fn parameters_that_no_run_determines_are_refused() {
        let row = DVector::from(vec![1.0, 1.0]);
        let cluster = Cluster { information: &row * row.transpose(), score: row };
        assert!(pool([&cluster, &cluster]).is_none());
    }

    fn interval(threads: usize) -> [f64; 2] {
        let pool_of_threads = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let clusters = means(&VALUES);
        let pooled = pool(&clusters).unwrap();
        let systematic = DMatrix::zeros(1, 0);
        let resampling = Resampling { strata: &[0; 5], replicates: 500, seed: 3, systematic: &systematic };
        let resampled = pool_of_threads.install(|| bootstrap(&clusters, &pooled, &resampling));
        resampled.studentised(0, pooled.step[0], pooled.covariance[(0, 0)].sqrt(), 0.95).unwrap()
    }

    #[test]
    fn the_bootstrap_gives_the_same_bits_at_any_thread_count() {
        assert_eq!(interval(1).map(f64::to_bits), interval(3).map(f64::to_bits));
    }

    /// The values are skewed to the right, so the studentised interval has to reach further to the right.
    #[test]
    fn the_studentised_interval_follows_the_skew() {
        let [low, high] = interval(2);
        let mean = mean(&VALUES);
        assert!(high - mean > mean - low, "[{low}, {high}] about {mean}");
    }

    /// Scatter 1 with 4 degrees and as much systematic variance: 16 degrees, half width 2.120 √2.
    #[test]
    fn systematic_uncertainty_widens_and_brings_degrees_of_freedom() {
        let ([low, high], degrees) = student_interval(0.0, 1.0, 4.0, 1.0, 0.95);
        assert!((degrees - 16.0).abs() < 1e-12);
        assert!((high - 2.1199 * 2.0_f64.sqrt()).abs() < 1e-3 && (low + high).abs() < 1e-12);
    }
}
