//! Student's distribution as a normal one of a width of its own: for increments that jump, and for rows that stray.
//!
//! ln t(e) ≥ ln t(√ξ) − w (e² − ξ)/2,  w = (ν + 1)/(ν + ξ)
//!
//! The bound touches where e² = ξ. With it everything stays linear and normal, and what is lost is known, so the likelihood
//! stays comparable; ξ is found round after round.
//! Source: Jaakkola and Jordan, *Statistics and Computing* 10 (2000) 25, for bounds of this kind; Lange, Little and
//! Taylor, *J. Am. Stat. Assoc.* 84 (1989) 881, for Student's distribution by weights.

use std::f64::consts::TAU;

/// The distribution of unit scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Student {
    /// Degrees of freedom ν.
    freedom: f64,
    /// Γ((ν + 1)/2) / (Γ(ν/2) √(νπ)), the density at 0.
    height: f64,
}

impl Student {
    /// ν = 2: values of any size, and no variance. Γ(3/2) = √π/2, so the height is 1/√8.
    pub const JUMPING: Self = Self { freedom: 2.0, height: 0.353_553_390_593_273_8 };
    /// ν = 4, as robust regression takes it by default (Lange, Little and Taylor). Γ(5/2) = 3√π/4, so the height is 3/8.
    pub const STRAYING: Self = Self { freedom: 4.0, height: 0.375 };

    /// Factor w of the precision.
    pub fn weight(self, square: f64) -> f64 {
        (self.freedom + 1.0) / (self.freedom + square)
    }

    /// What the bound is above the normal density of precision w that stands for it: ln t(√ξ) + w ξ/2 − ½ ln(w/2π).
    pub fn bound(self, square: f64) -> f64 {
        let weight = self.weight(square);
        self.height.ln() - 0.5 * (self.freedom + 1.0) * (square / self.freedom).ln_1p()
            + 0.5 * weight * square
            - 0.5 * (weight / TAU).ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_touches_the_density_where_it_was_made_and_lies_below_elsewhere() {
        // By the textbook's densities: (1/√8)(1 + e²/2)^(−3/2) and (3/8)(1 + e²/4)^(−5/2).
        let jumping = |e2: f64| -0.5 * 8f64.ln() - 1.5 * (0.5 * e2).ln_1p();
        let straying = |e2: f64| (3.0f64 / 8.0).ln() - 2.5 * (0.25 * e2).ln_1p();
        let densities: [(Student, &dyn Fn(f64) -> f64); 2] =
            [(Student::JUMPING, &jumping), (Student::STRAYING, &straying)];
        for (student, density) in densities {
            for square in [0.0, 0.3, 4.0, 90.0] {
                let (weight, bound) = (student.weight(square), student.bound(square));
                let below = |e2: f64| 0.5 * (weight / TAU).ln() - 0.5 * weight * e2 + bound;
                assert!((below(square) - density(square)).abs() < 1e-12);
                assert!([0.0, 1.0, 10.0].iter().all(|e2| below(*e2) <= density(*e2) + 1e-12));
            }
        }
    }

    #[test]
    fn its_density_is_one_in_all() {
        for student in [Student::JUMPING, Student::STRAYING] {
            // At e² = ξ the bound is the density; the substitution e = tan(θ) makes the range finite.
            let count = 200_000;
            let step = std::f64::consts::PI / f64::from(count);
            let density = |e: f64| {
                let square = e * e;
                let weight = student.weight(square);
                (student.bound(square) + 0.5 * (weight / TAU).ln() - 0.5 * weight * square).exp()
            };
            let sum: f64 = (0..count)
                .map(|index| {
                    let e = (-0.5 * std::f64::consts::PI + (f64::from(index) + 0.5) * step).tan();
                    density(e) * (1.0 + e * e) * step
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        }
    }
}
