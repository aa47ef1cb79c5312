//! Shear strength that displacement mobilises.
//!
//! τ = (c + σ tan φ) (1 − e^(−j/K))
//! along a flat contact of length L, where j = s x:  H = (A c + W tan φ) [1 − (1 − e^(−u)) / u],  u = s L / K
//!
//! Source: Janosi and Hanamoto, "The analytical determination of drawbar pull as a function of slip for tracked vehicles in
//! deformable soils", 1st international conference on the mechanics of soil-vehicle systems, Turin (1961).

/// Share of the strength that a displacement of `ratio` = j/K mobilises; odd, so that a braked wheel is held back.
pub fn mobilised(ratio: f64) -> f64 {
    (-(-ratio.abs()).exp_m1()).copysign(ratio)
}

/// Mean of [`mobilised`] along a contact at whose end j/K is `ratio`.
pub fn mobilised_along(ratio: f64) -> f64 {
    /// Below this the closed form loses more digits than three terms of its series leave out.
    const SMALL: f64 = 1e-4;
    let u = ratio.abs();
    let mean = if u < SMALL {
        u * (0.5 - u * (1.0 / 6.0 - u / 24.0))
    } else if u.is_infinite() {
        1.0
    } else {
        1.0 + (-u).exp_m1() / u
    };
    mean.copysign(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// u = 2: 1 − (1 − e^(−2))/2 = 0.567668, by hand; −e^(−1) + 1 = 0.632121.
    #[test]
    fn two_lengths_of_shear_mobilise_57_per_cent_on_the_mean() {
        assert!((mobilised_along(2.0) - 0.567_667_6).abs() < 1e-7);
        assert!((mobilised(1.0) - 0.632_120_6).abs() < 1e-7);
    }

    #[test]
    fn the_mean_is_the_integral_of_the_share() {
        for ratio in [-3.0, 1e-5, 0.2, 1.0, 20.0] {
            let pieces = 10_000;
            let sum: f64 = (0..pieces)
                .map(|i| mobilised(ratio * (f64::from(i) + 0.5) / f64::from(pieces)) / f64::from(pieces))
                .sum();
            assert!((sum / mobilised_along(ratio) - 1.0).abs() < 1e-6, "{ratio}: {sum}");
        }
    }

    #[test]
    fn the_series_meets_the_closed_form_and_the_limits_are_kept() {
        let near = 1.000_000_1e-4;
        let (below, above) = (mobilised_along(0.999_999_9e-4), mobilised_along(near));
        assert!(((above - below) / above - 2e-7).abs() < 1e-7, "{below} {above}");
        assert_eq!(mobilised_along(0.0), 0.0);
        assert_eq!((mobilised_along(f64::INFINITY), mobilised_along(-0.5)), (1.0, -mobilised_along(0.5)));
    }
}
