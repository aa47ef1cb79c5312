//! The two-stage aggregation of the reference study: a coefficient a sample, a median a run, a pool of runs.
//!
//! c = (m a − F_a) / (G (1 + v/100))      a the deceleration, F_a the air drag; each sample
//!
//! Within a run, samples outside the 5th to 95th percentile are dropped; of the rest those inside the quartiles weigh
//! 1 and those outside ½. A run counts as an outlier where its median lies more than 1.5 interquartile ranges outside
//! the quartiles of all run medians. The text leaves open whether samples or runs are pooled, so both are given.
//!
//! Source: coast-down validation of a Claas Xerion 3800, *Applied Sciences* 16 (2026) 1814, equations 2 to 4.
//! It takes F = m a, without rotating parts, and needs a differentiated speed: both are what the fit does better.

use super::segment::Coast;
use crate::statistics::{mean, quantile_of_sorted, sorted, weighted_median};
use serde::{Deserialize, Serialize};

/// Result of the two-stage aggregation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TwoStage {
    /// Whether rotating parts were counted in the mass; the study does not.
    pub with_rotating_mass: bool,
    /// Of each run, in order.
    pub runs: Vec<RunCoefficient>,
    /// Below this a run median is an outlier.
    pub lower_fence: f64,
    /// Above this a run median is an outlier.
    pub upper_fence: f64,
    /// Pool of the runs that are no outliers.
    pub kept: Pool,
    /// Pool of all runs.
    pub all: Pool,
}

/// What one run says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunCoefficient {
    /// Name of the run.
    pub run: String,
    /// Samples with a coefficient.
    pub samples: usize,
    /// Samples between the 5th and the 95th percentile.
    pub kept: usize,
    /// Weighted median of the kept samples.
    pub median: f64,
    /// Weighted mean of the kept samples.
    pub mean: f64,
    /// Sum of the weights.
    pub weight: f64,
    /// Whether its median lies outside the fences.
    pub outlier: bool,
}

/// The readings of "pooled".
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pool {
    /// Weighted mean over all samples: long runs count for more.
    pub by_samples: f64,
    /// Mean of the run means: every run counts alike.
    pub by_runs: f64,
    /// Mean of the run medians, for comparison: the study's own numbers exclude it.
    pub by_medians: f64,
}

/// Coefficient of each sample that has neighbours half a width before and after it.
pub fn coefficients(coast: &Coast, scale_m_s: f64, difference_s: f64, with_rotating_mass: bool) -> Vec<f64> {
    let mass = if with_rotating_mass { coast.effective_mass_kg } else { coast.mass_kg };
    let (time, speed) = (&coast.time_s, &coast.speed_m_s);
    let half = 0.5 * difference_s - 1e-9;
    let mut coefficients = Vec::new();
    for at in 0..time.len() {
        let Some(before) = (0..at).rev().find(|other| time[at] - time[*other] >= half) else { continue };
        let Some(after) = (at + 1..time.len()).find(|other| time[*other] - time[at] >= half) else {
            continue;
        };
        if time[after] - time[before] > 3.0 * difference_s.max(time[at] - time[at - 1]) {
            continue;
        }
        let v = speed[at];
        let deceleration = (speed[before] - speed[after]) / (time[after] - time[before]);
        let ambient = coast.ambient[at];
        let along = v - ambient.tailwind_m_s;
        let drag =
            coast.half_density_drag_area_kg_m.unwrap_or(0.0) * along.hypot(ambient.crosswind_m_s) * along;
        coefficients.push((mass * deceleration - drag) / (coast.weight_n() * (1.0 + v / scale_m_s)));
    }
    coefficients
}

/// First stage: samples of one run to median, mean and weight.
pub fn run_coefficient(run: &str, coefficients: &[f64]) -> RunCoefficient {
    let ordered = sorted(coefficients);
    let (low, high) = (quantile_of_sorted(&ordered, 0.05), quantile_of_sorted(&ordered, 0.95));
    let kept: Vec<f64> = ordered.iter().copied().filter(|value| (low..=high).contains(value)).collect();
    let (q1, q3) = (quantile_of_sorted(&kept, 0.25), quantile_of_sorted(&kept, 0.75));
    let weighted: Vec<(f64, f64)> =
        kept.iter().map(|value| (*value, if (q1..=q3).contains(value) { 1.0 } else { 0.5 })).collect();
    let weight: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    RunCoefficient {
        run: run.to_owned(),
        samples: coefficients.len(),
        kept: kept.len(),
        median: weighted_median(&weighted),
        mean: weighted.iter().map(|(value, weight)| value * weight).sum::<f64>() / weight,
        weight,
        outlier: false,
    }
}

/// Second stage: fences over the run medians, then the pools.
pub fn pool(mut runs: Vec<RunCoefficient>, with_rotating_mass: bool) -> TwoStage {
    let medians = sorted(&runs.iter().map(|run| run.median).collect::<Vec<_>>());
    let (q1, q3) = (quantile_of_sorted(&medians, 0.25), quantile_of_sorted(&medians, 0.75));
    let (lower_fence, upper_fence) = (q1 - 1.5 * (q3 - q1), q3 + 1.5 * (q3 - q1));
    for run in &mut runs {
        run.outlier = run.median < lower_fence || run.median > upper_fence;
    }
    let kept: Vec<&RunCoefficient> = runs.iter().filter(|run| !run.outlier).collect();
    let all: Vec<&RunCoefficient> = runs.iter().collect();
    let (kept, all) = (pool_of(&kept), pool_of(&all));
    TwoStage { with_rotating_mass, runs, lower_fence, upper_fence, kept, all }
}

fn pool_of(runs: &[&RunCoefficient]) -> Pool {
    let weight: f64 = runs.iter().map(|run| run.weight).sum();
    Pool {
        by_samples: runs.iter().map(|run| run.mean * run.weight).sum::<f64>() / weight,
        by_runs: mean(&runs.iter().map(|run| run.mean).collect::<Vec<_>>()),
        by_medians: mean(&runs.iter().map(|run| run.median).collect::<Vec<_>>()),
    }
}

/// Both stages over a study. Runs without a coefficient are left out.
pub fn two_stage(
    coasts: &[Coast],
    scale_m_s: f64,
    difference_s: f64,
    with_rotating_mass: bool,
) -> Option<TwoStage> {
    let runs: Vec<RunCoefficient> = coasts
        .iter()
        .map(|coast| (&coast.id, coefficients(coast, scale_m_s, difference_s, with_rotating_mass)))
        .filter(|(_, coefficients)| !coefficients.is_empty())
        .map(|(run, coefficients)| run_coefficient(run, &coefficients))
        .collect();
    (!runs.is_empty()).then(|| pool(runs, with_rotating_mass))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::coastdown::segment::Ambient;

    /// 0 … 20: the 5th and 95th percentiles are 1 and 19, the quartiles of what is left 5.5 and 14.5. Nine values
    /// 6 … 14 weigh 1, ten weigh ½: weight 14, median and mean 10 by symmetry. With 100 instead of 20, which is
    /// dropped, nothing changes.
    #[test]
    fn the_first_stage_by_hand() {
        let mut values: Vec<f64> = (0..=20).map(f64::from).collect();
        let run = run_coefficient("a", &values);
        assert_eq!((run.run.as_str(), run.samples, run.kept), ("a", 21, 19));
        assert_eq!((run.weight, run.median, run.mean), (14.0, 10.0, 10.0));
        values[20] = 100.0;
        assert_eq!(run_coefficient("a", &values), run);
    }

    /// 1, 2, 4, 8, 16: the percentiles drop the ends; of 2, 4, 8 the quartiles are 3 and 6, so the weights are ½, 1, ½
    /// and the mean (1 + 4 + 4) / 2 = 4.5, which the unweighted 14/3 is not.
    #[test]
    fn samples_outside_the_quartiles_weigh_half() {
        let run = run_coefficient("a", &[1.0, 2.0, 4.0, 8.0, 16.0]);
        assert_eq!((run.kept, run.weight, run.median, run.mean), (3, 2.0, 4.0, 4.5));
    }

    fn said(run: u8, median: f64, mean: f64, weight: f64) -> RunCoefficient {
        RunCoefficient { run: run.to_string(), samples: 10, kept: 9, median, mean, weight, outlier: false }
    }

    /// Medians 1, 2, 3, 4, 20: quartiles 2 and 4, fences −1 and 7, so the last run goes.
    /// By samples (1·1 + 2·1 + 3·1 + 5·3) / 6 = 3.5; by runs 11/4; by medians 10/4.
    #[test]
    fn the_second_stage_by_hand_in_each_reading() {
        let runs = vec![
            said(0, 1.0, 1.0, 1.0),
            said(1, 2.0, 2.0, 1.0),
            said(2, 3.0, 3.0, 1.0),
            said(3, 4.0, 5.0, 3.0),
            said(4, 20.0, 14.0, 2.0),
        ];
        let pooled = pool(runs, false);
        assert_eq!((pooled.lower_fence, pooled.upper_fence), (-1.0, 7.0));
        assert!(pooled.runs[4].outlier && pooled.runs.iter().filter(|run| run.outlier).count() == 1);
        assert_eq!(pooled.kept, Pool { by_samples: 3.5, by_runs: 2.75, by_medians: 2.5 });
        assert_eq!(pooled.all, Pool { by_samples: 49.0 / 8.0, by_runs: 5.0, by_medians: 6.0 });
    }

    /// Nine runs at 0.069 and a sixth at 0.042: 0.0682 is reached with 3 % of the weight on it, 0.0663 with equal runs.
    #[test]
    fn both_published_aggregates_are_reachable_by_samples_only() {
        let runs = |weight| {
            let mut runs: Vec<_> =
                (0..9).map(|run| said(run, 0.069 + 1e-6 * f64::from(run), 0.069, 1.0)).collect();
            runs.push(said(9, 0.042, 0.042, weight));
            pool(runs, false)
        };
        let light = runs(9.0 * 0.03 / 0.97);
        assert!((light.kept.by_samples - 0.069).abs() < 1e-6);
        assert!((light.all.by_samples - 0.0682).abs() < 5e-5, "{:?}", light.all);
        assert!((light.all.by_runs - 0.0663).abs() < 5e-5, "{:?}", light.all);
    }

    /// 0.7 m/s² at any speed without air: c (1 + v/s) G = m a.
    #[test]
    fn a_sample_coefficient_is_force_over_weight() {
        let time_s: Vec<f64> = (0..20).map(|at| f64::from(at) * 0.1).collect();
        let coast = Coast {
            id: String::new(),
            run: 0,
            path: 0,
            sign: 1.0,
            mass_kg: 1000.0,
            effective_mass_kg: 1100.0,
            half_density_drag_area_kg_m: Some(2.0),
            speed_m_s: time_s.iter().map(|time| 5.0 - 0.7 * time).collect(),
            ambient: vec![Ambient::default(); 20],
            time_s,
            from_s: 0.0,
        };
        let found = coefficients(&coast, 25.0, 0.2, false);
        assert_eq!(found.len(), 18);
        let v: f64 = 5.0 - 0.07;
        assert!((found[0] - (700.0 - 2.0 * v * v) / (9806.65 * (1.0 + v / 25.0))).abs() < 1e-9);
        let heavier = coefficients(&coast, 25.0, 0.2, true);
        assert!((heavier[0] - (770.0 - 2.0 * v * v) / (9806.65 * (1.0 + v / 25.0))).abs() < 1e-9);
    }
}
