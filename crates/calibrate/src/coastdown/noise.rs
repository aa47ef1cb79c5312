//! What the deviations of a recording from a model look like: the working covariance of a fit.
//!
//! Within a run, deviations of speed are taken as exponentially correlated, cov(e_j, e_k) = σ² exp(−|t_j − t_k|/T),
//! which is undone sample by sample; between runs, resistance varies by an offset of standard deviation τ times the
//! weight. Estimates stay unbiased and their intervals valid where this is only roughly so: see [`crate::clusters`].

use super::segment::Coast;
use crate::statistics::median;
use nalgebra::{DMatrix, DVector};

/// The working covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// σ, standard deviation of a sample [m/s].
    pub sample_m_s: f64,
    /// T, how long a deviation lasts [s]; 0 where samples are independent.
    pub correlation_time_s: f64,
    /// τ, standard deviation between runs: of c_w where that is fitted, else of resistance over weight.
    pub between_runs: f64,
}

/// Jacobian and residual of one run in which samples have become independent, as normal equations with σ = 1.
#[derive(Clone, Debug)]
pub struct Normal {
    /// JᵀR⁻¹J; the last two columns are the offset of the run and its initial speed.
    pub matrix: DMatrix<f64>,
    /// JᵀR⁻¹r.
    pub vector: DVector<f64>,
    /// rᵀR⁻¹r.
    pub square: f64,
    /// Number of samples.
    pub samples: usize,
}

/// Undoes the correlation: each row less what the one before predicts of it, over what remains unpredicted.
pub fn normal(
    coast: &Coast,
    jacobian: &DMatrix<f64>,
    residual: &DVector<f64>,
    correlation_time_s: f64,
) -> Normal {
    let (samples, columns) = jacobian.shape();
    let mut matrix = DMatrix::zeros(columns, columns);
    let mut vector = DVector::zeros(columns);
    let mut square = 0.0;
    for sample in 0..samples {
        let mut row = jacobian.row(sample).transpose();
        let mut own = residual[sample];
        if sample > 0 && correlation_time_s > 0.0 {
            let memory = (-(coast.time_s[sample] - coast.time_s[sample - 1]) / correlation_time_s).exp();
            let scale = 1.0 / (1.0 - memory * memory).sqrt();
            row = (row - jacobian.row(sample - 1).transpose() * memory) * scale;
            own = (own - residual[sample - 1] * memory) * scale;
        }
        matrix.ger(1.0, &row, &row, 1.0);
        vector.axpy(own, &row, 1.0);
        square += own * own;
    }
    Normal { matrix, vector, square, samples }
}

/// How long deviations last, from the correlation of neighbours in all runs [s].
pub fn correlation_time_s(coasts: &[Coast], deviations: &[DVector<f64>]) -> f64 {
    let (mut product, mut square, mut count, mut steps) = (0.0, 0.0, 0_usize, Vec::new());
    for (coast, deviation) in coasts.iter().zip(deviations) {
        for (pair, time) in deviation.as_slice().windows(2).zip(coast.time_s.windows(2)) {
            product += pair[0] * pair[1];
            steps.push(time[1] - time[0]);
            count += 1;
        }
        square += deviation.norm_squared();
    }
    let correlation = product / square;
    // Two standard errors of the correlation of independent samples.
    if !(correlation.is_finite() && correlation > 2.0 / (count as f64).sqrt()) {
        return 0.0;
    }
    -median(&steps) / correlation.min(0.999).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coastdown::segment::Ambient;
    use crate::statistics::Draws;

    fn coast(samples: usize) -> Coast {
        Coast {
            id: String::new(),
            run: 0,
            path: 0,
            sign: 1.0,
            mass_kg: 1.0,
            effective_mass_kg: 1.0,
            half_density_drag_area_kg_m: None,
            time_s: (0..samples).map(|at| at as f64 * 0.1).collect(),
            speed_m_s: vec![0.0; samples],
            ambient: vec![Ambient::default(); samples],
            from_s: 0.0,
        }
    }

    /// Against the inverse of the full covariance matrix.
    #[test]
    fn undoing_the_correlation_is_dividing_by_the_covariance() {
        let coast = coast(4);
        let covariance =
            DMatrix::from_fn(4, 4, |row, column| (-(row as f64 - column as f64).abs() * 0.1 / 0.3).exp());
        let inverse = covariance.try_inverse().unwrap();
        let jacobian = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 1.0, 2.0, 1.0, 3.0, 1.0, 7.0]);
        let residual = DVector::from(vec![1.0, -2.0, 0.5, 3.0]);
        let normal = normal(&coast, &jacobian, &residual, 0.3);
        assert!((normal.matrix - jacobian.transpose() * &inverse * &jacobian).amax() < 1e-12);
        assert!((normal.vector - jacobian.transpose() * &inverse * &residual).amax() < 1e-12);
        assert!((normal.square - residual.dot(&(&inverse * &residual))).abs() < 1e-12);
    }

    #[test]
    fn the_correlation_time_of_a_process_is_found_and_noise_has_none() {
        let coast = coast(4000);
        let mut draws = Draws::new(5, 0);
        let memory = (-0.1_f64 / 0.5).exp();
        let mut last = 0.0;
        let process = DVector::from_fn(4000, |_, _| {
            last = memory * last + (1.0 - memory * memory).sqrt() * draws.normal();
            last
        });
        let found = correlation_time_s(std::slice::from_ref(&coast), &[process]);
        assert!((found - 0.5).abs() < 0.1, "{found}");
        let white = DVector::from_fn(4000, |_, _| draws.normal());
        assert!(correlation_time_s(&[coast], &[white]) < 0.04);
    }
}
