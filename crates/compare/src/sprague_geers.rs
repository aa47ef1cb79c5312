//! Errors of size and of phase, apart: Sprague and Geers, and Russell.
//!
//! With A = Σ y² (measured) and B = Σ ŷ² (modelled), over evenly spaced samples:
//!
//! M = √(B/A) - 1      P = acos(Σ y ŷ / √(A B)) / π      C = √(M² + P²)
//!
//! m = (B - A) / √(A B)      M_R = sign(m) lg(1 + |m|)      C_R = √(π/4 (M_R² + P²))
//!
//! M does not see a delay and P does not see a factor. Russell's M_R is odd under swapping the two signals, which M is not;
//! its sign is chosen here as that of M, positive where the model is too large.
//! Neither removes the mean: of a signal that stays far from zero, P says little.
//!
//! Sources: Sprague and Geers, *A spectral-element method for modelling cavitation in transient fluid-structure
//! interaction*, Int. J. Numer. Meth. Engng 60 (2004); Russell, *Error measures for comparing transient data*, Proc. 68th
//! Shock and Vibration Symposium (1997). Beware of code that leaves out the square root of M.

use std::f64::consts::{FRAC_PI_4, PI};

/// Sprague and Geers' errors.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SpragueGeers {
    /// Relative error of the root mean square: factor minus one. NaN where only the measured signal is zero.
    pub magnitude: f64,
    /// Error of phase, 0 to 1 (opposite signs). NaN where one of the signals is zero.
    pub phase: f64,
    /// Root of the sum of their squares. NaN where one of the signals is zero.
    pub combined: f64,
}

/// Russell's errors.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Russell {
    /// Logarithmic error of magnitude, positive where the model is too large.
    pub magnitude: f64,
    /// Error of phase, 0 to 1, as that of Sprague and Geers.
    pub phase: f64,
    /// Comprehensive error: below 0.15 excellent, above 0.28 poor.
    pub combined: f64,
}

/// Σ y², Σ ŷ² and the error of phase.
fn sums(measured: &[f64], modelled: &[f64]) -> (f64, f64, f64) {
    let a: f64 = measured.iter().map(|y| y * y).sum();
    let b: f64 = modelled.iter().map(|m| m * m).sum();
    if measured == modelled {
        return (a, b, 0.0);
    }
    let cross: f64 = measured.iter().zip(modelled).map(|(y, m)| y * m).sum();
    // Rounding may carry the cosine past one.
    (a, b, (cross / (a.sqrt() * b.sqrt())).clamp(-1.0, 1.0).acos() / PI)
}

/// Sprague and Geers' errors of two signals of one length.
pub fn sprague_geers(measured: &[f64], modelled: &[f64]) -> SpragueGeers {
    let (a, b, phase) = sums(measured, modelled);
    let magnitude = match (a > 0.0, b > 0.0) {
        (true, _) => (b / a).sqrt() - 1.0,
        (false, true) => f64::NAN,
        (false, false) => 0.0,
    };
    SpragueGeers { magnitude, phase, combined: magnitude.hypot(phase) }
}

/// Russell's errors of two signals of one length; `None` where exactly one of them is zero throughout.
pub fn russell(measured: &[f64], modelled: &[f64]) -> Option<Russell> {
    let (a, b, phase) = sums(measured, modelled);
    if a == 0.0 && b == 0.0 {
        return Some(Russell { magnitude: 0.0, phase: 0.0, combined: 0.0 });
    }
    if a == 0.0 || b == 0.0 {
        return None;
    }
    let m = (b - a) / (a.sqrt() * b.sqrt());
    let magnitude = m.signum() * (1.0 + m.abs()).log10();
    let magnitude = if m == 0.0 { 0.0 } else { magnitude };
    Some(Russell { magnitude, phase, combined: (FRAC_PI_4 * (magnitude.powi(2) + phase.powi(2))).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// One sine over whole periods, delayed by a share of its half period.
    fn sine(delay: f64) -> Vec<f64> {
        (0..1000).map(|step| (TAU * f64::from(step) / 250.0 - PI * delay).sin()).collect()
    }

    /// y = 1, 2, 3, 4 and ŷ = 1, 2, 3, 6: A = 30, B = 50, Σ y ŷ = 38. M = √(5/3) - 1 = 0.290994;
    /// P = acos(38 / √1500) / π = acos(0.981156) / π = 0.061890; C = √(0.084678 + 0.003830) = 0.297503.
    /// m = 20 / 38.729833 = 0.516398, M_R = lg 1.516398 = 0.180813, C_R = √(π/4 (0.032693 + 0.003830)) = 0.169368.
    #[test]
    fn four_samples_are_worked_by_hand() {
        let (y, m) = ([1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 6.0]);
        let geers = sprague_geers(&y, &m);
        assert!((geers.magnitude - 0.290_994).abs() < 1e-6, "{geers:?}");
        assert!((geers.phase - 0.061_890).abs() < 5e-6, "{geers:?}");
        assert!((geers.combined - 0.297_503).abs() < 2e-6, "{geers:?}");
        let russell = russell(&y, &m).unwrap();
        assert!((russell.magnitude - 0.180_813).abs() < 1e-6, "{russell:?}");
        assert_eq!(russell.phase, geers.phase);
        assert!((russell.combined - 0.169_368).abs() < 5e-6, "{russell:?}");
    }

    /// Twenty per cent too large is 0.2: the square root is there (without it, it would be 0.44).
    #[test]
    fn a_factor_is_magnitude_alone() {
        let y = sine(0.0);
        for factor in [1.2, 0.7, 3.0] {
            let scaled: Vec<f64> = y.iter().map(|y| factor * y).collect();
            let geers = sprague_geers(&y, &scaled);
            assert!((geers.magnitude - (factor - 1.0)).abs() < 1e-12);
            assert!(geers.phase < 1e-7, "{}", geers.phase);
        }
    }

    /// Over whole periods Σ sin(x) sin(x - φ) is cos φ of Σ sin², so P = φ/π: the share of the half period.
    #[test]
    fn a_delayed_sine_is_phase_alone() {
        for delay in [0.1, 0.2, 0.5, 0.9] {
            let geers = sprague_geers(&sine(0.0), &sine(delay));
            assert!((geers.phase - delay).abs() < 1e-12);
            assert!(geers.magnitude.abs() < 1e-12);
            let russell = russell(&sine(0.0), &sine(delay)).unwrap();
            assert!((russell.combined - FRAC_PI_4.sqrt() * delay).abs() < 1e-12);
        }
    }

    /// Swapping the signals turns Russell's magnitude round and leaves the rest.
    #[test]
    fn russell_is_odd_in_magnitude() {
        let (y, m) = (sine(0.0), sine(0.1).iter().map(|m| 1.7 * m).collect::<Vec<_>>());
        let (there, back) = (russell(&y, &m).unwrap(), russell(&m, &y).unwrap());
        assert!((there.magnitude + back.magnitude).abs() < 1e-12 && there.magnitude > 0.0);
        assert!((there.combined - back.combined).abs() < 1e-12);
    }

    #[test]
    fn equal_signals_are_perfect_and_zero_ones_undefined_where_they_must_be() {
        let y = sine(0.3);
        let perfect = SpragueGeers { magnitude: 0.0, phase: 0.0, combined: 0.0 };
        assert_eq!(sprague_geers(&y, &y), perfect);
        assert_eq!(russell(&y, &y), Some(Russell { magnitude: 0.0, phase: 0.0, combined: 0.0 }));
        assert_eq!(sprague_geers(&[0.0; 3], &[0.0; 3]), perfect);
        assert!(sprague_geers(&[0.0; 3], &[1.0; 3]).magnitude.is_nan());
        assert_eq!(sprague_geers(&[1.0; 3], &[0.0; 3]).magnitude, -1.0);
        assert_eq!(russell(&[1.0; 3], &[0.0; 3]), None);
    }
}
