//! Cumulative probability of measured against modelled values, with a Kolmogorov band.
//!
//! ε = √(ln(2/α) / (2 n))    half width of the band that holds the true distribution with probability 1 - α
//!
//! The bound takes independent samples, and those of a recording are not: n is the effective sample size from the
//! autocorrelation of the measured signal. A match says nothing about the order in time: it is necessary, not sufficient.
//!
//! Sources: Massart, *The tight constant in the Dvoretzky-Kiefer-Wolfowitz inequality*, Annals of Probability 18 (1990);
//! the area between the curves as a metric: Ferson, Oberkampf and Ginzburg, Comput. Methods Appl. Mech. Engng 197 (2008).

use crate::autocorrelation::effective_sample_size;

/// Most points of a curve that are kept for drawing.
pub const POINTS: usize = 101;

/// Cumulative probabilities at one value.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CdfPoint {
    /// In the unit of the channel.
    pub value: f64,
    /// Share of the measured values at or below it.
    pub measured: f64,
    /// Share of the modelled values at or below it.
    pub modelled: f64,
}

/// Two cumulative probabilities, how far they are apart, and how far they may be.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct CdfComparison {
    /// Measured samples that would say as much if they were independent.
    pub effective_samples: f64,
    /// Probability with which the band fails to hold the true distribution.
    pub alpha: f64,
    /// Half width ε of the band around the measured curve.
    pub band_half_width: f64,
    /// Largest distance between the curves, 0 to 1.
    pub distance: f64,
    /// Whether the modelled curve stays within the band.
    pub within_band: bool,
    /// Area between the curves [unit of the channel]; zero only where they are equal.
    pub area: f64,
    /// The curves, thinned evenly in rank to at most [`POINTS`] points.
    pub points: Vec<CdfPoint>,
}

/// Half width of the Kolmogorov band of `n` independent samples at the level `alpha`.
pub fn band_half_width(n: f64, alpha: f64) -> f64 {
    ((2.0 / alpha).ln() / (2.0 * n)).sqrt()
}

/// Compares the distributions of two sets of values with a band at the level `alpha` (0.05 for 95 %).
///
/// The measured values are in order of time, for their autocorrelation. `None` where either set is empty, a value is not
/// finite, or `alpha` is not between 0 and 1.
pub fn cdf_comparison(measured: &[f64], modelled: &[f64], alpha: f64) -> Option<CdfComparison> {
    let finite = measured.iter().chain(modelled).all(|value| value.is_finite());
    if measured.is_empty() || modelled.is_empty() || !finite || !(alpha > 0.0 && alpha < 1.0) {
        return None;
    }
    let all = steps(measured, modelled);
    let distance = all.iter().map(|point| (point.modelled - point.measured).abs()).fold(0.0, f64::max);
    let area = all
        .windows(2)
        .map(|pair| (pair[0].modelled - pair[0].measured).abs() * (pair[1].value - pair[0].value))
        .sum();
    let effective_samples = effective_sample_size(measured).min(measured.len() as f64);
    let band_half_width = band_half_width(effective_samples, alpha);
    Some(CdfComparison {
        effective_samples,
        alpha,
        band_half_width,
        distance,
        within_band: distance <= band_half_width,
        area,
        points: thinned(&all),
    })
}

/// Both step functions at every value that occurs.
fn steps(measured: &[f64], modelled: &[f64]) -> Vec<CdfPoint> {
    let sorted = |values: &[f64]| {
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted
    };
    let (y, m) = (sorted(measured), sorted(modelled));
    let (mut i, mut j, mut points) = (0, 0, Vec::new());
    while i < y.len() || j < m.len() {
        let value =
            y.get(i).copied().unwrap_or(f64::INFINITY).min(m.get(j).copied().unwrap_or(f64::INFINITY));
        i += y[i..].iter().take_while(|next| **next <= value).count();
        j += m[j..].iter().take_while(|next| **next <= value).count();
        points.push(CdfPoint {
            value,
            measured: i as f64 / y.len() as f64,
            modelled: j as f64 / m.len() as f64,
        });
    }
    points
}

fn thinned(all: &[CdfPoint]) -> Vec<CdfPoint> {
    if all.len() <= POINTS {
        return all.to_vec();
    }
    (0..POINTS).map(|point| all[point * (all.len() - 1) / (POINTS - 1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At α = 0.10: ln 20 / 2 = 1.497866; √(1.497866/100) = 0.122387 and √(1.497866/1000) = 0.038702.
    #[test]
    fn the_half_width_is_that_of_the_tables() {
        assert!((band_half_width(100.0, 0.10) - 0.122_387).abs() < 1e-6);
        assert!((band_half_width(1000.0, 0.10) - 0.038_702).abs() < 1e-6);
        assert!((band_half_width(1.0, 0.05) - 1.358_102).abs() < 1e-6);
    }

    /// 1, 2, 3, 4 against 1, 2, 3, 6: the curves part at 4 (1 against 3/4) until 6: distance 1/4, area 2/4. The ramp counts
    /// as 2.4 samples, so the 95 % band is √(ln 40 / 4.8) = 0.876651 wide.
    #[test]
    fn four_samples_are_worked_by_hand() {
        let found = cdf_comparison(&[1.0, 2.0, 3.0, 4.0], &[6.0, 3.0, 2.0, 1.0], 0.05).unwrap();
        assert_eq!((found.distance, found.area), (0.25, 0.5));
        assert!((found.effective_samples - 2.4).abs() < 1e-12);
        assert!((found.band_half_width - 0.876_651).abs() < 1e-6, "{}", found.band_half_width);
        assert!(found.within_band);
        assert_eq!(found.points[3], CdfPoint { value: 4.0, measured: 1.0, modelled: 0.75 });
        assert_eq!(found.points.len(), 5);
    }

    /// A shift of everything by d has the area d.
    #[test]
    fn the_area_of_a_shift_is_the_shift() {
        let y: Vec<f64> = (0..500_u32).map(|at| f64::from(at * 7919 % 500)).collect();
        let m: Vec<f64> = y.iter().map(|y| y + 30.25).collect();
        let found = cdf_comparison(&y, &m, 0.05).unwrap();
        assert!((found.area - 30.25).abs() < 1e-9);
        assert!((found.distance - 31.0 / 500.0).abs() < 1e-12, "{}", found.distance);
        assert_eq!(found.points.len(), POINTS);
        assert_eq!(found.points[POINTS - 1].modelled, 1.0);
    }

    /// The order in time changes the band and not the curves.
    #[test]
    fn slow_signals_have_wider_bands() {
        let slow: Vec<f64> = (0..500_u32).map(f64::from).collect();
        let mixed: Vec<f64> = (0..500_u32).map(|at| f64::from(at * 7919 % 500)).collect();
        let (slow, mixed) =
            (cdf_comparison(&slow, &slow, 0.05).unwrap(), cdf_comparison(&mixed, &mixed, 0.05).unwrap());
        assert_eq!(slow.points, mixed.points);
        assert!(slow.band_half_width > 5.0 * mixed.band_half_width);
    }

    #[test]
    fn what_has_no_distribution_has_no_comparison() {
        assert_eq!(cdf_comparison(&[], &[1.0], 0.05), None);
        assert_eq!(cdf_comparison(&[1.0], &[f64::NAN], 0.05), None);
        assert_eq!(cdf_comparison(&[1.0], &[1.0], 0.0), None);
    }
}
