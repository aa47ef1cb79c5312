//! A slipping wheel digs.
//!
//! z = z₀ ((1 + s) / (1 − ½ s))^q
//!
//! Source: with q = 1 Lyasko, "Slip sinkage effect in soil-vehicle mechanics", Journal of Terramechanics 47 (2010), 21-31;
//! from memory. q = 0 leaves it out. A braked wheel is not in the source and digs no deeper here.

/// Sinkage as a multiple of that without slip.
pub fn deepening(slip: f64, share: f64) -> f64 {
    if slip <= 0.0 || share == 0.0 {
        return 1.0;
    }
    let factor = (1.0 + slip) / (1.0 - 0.5 * slip);
    if share == 1.0 { factor } else { factor.powf(share) }
}

#[cfg(test)]
mod tests {
    use super::deepening;

    /// s = 0.2: 1.2 / 0.9 = 4/3.
    #[test]
    fn at_twenty_per_cent_of_slip_the_rut_is_a_third_deeper() {
        assert!((deepening(0.2, 1.0) - 4.0 / 3.0).abs() < 1e-12);
        assert!((deepening(0.2, 0.5) - (4.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!((deepening(0.2, 0.0), deepening(-0.3, 1.0), deepening(0.0, 1.0)), (1.0, 1.0, 1.0));
    }
}
