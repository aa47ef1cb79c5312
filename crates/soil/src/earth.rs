//! The mechanical parameters of a soil that Bekker's and Wong's wheels share.

use headland_plugin::{Bound, Refusal};
use serde::Deserialize;

/// What plate and shear tests say of a soil.
///
/// The moduli are per power of metres: p = (k_c / b + k_φ) zⁿ with p in Pa, b and z in m.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Earth {
    /// Exponent of sinkage, n.
    pub exponent: f64,
    /// Cohesive modulus of deformation, k_c [N/m^(n+1)].
    pub cohesive_modulus: f64,
    /// Frictional modulus of deformation, k_φ [N/m^(n+2)].
    pub frictional_modulus: f64,
    /// Cohesion, c [Pa].
    pub cohesion_pa: f64,
    /// Angle of internal friction, φ [rad].
    pub friction_angle_rad: f64,
    /// Shear displacement that mobilises 63 % of the strength, K [m].
    pub shear_displacement_m: f64,
    /// Mass per volume [kg/m³].
    pub density_kg_m3: f64,
}

/// How a card tells of the parameter that holds an [`Earth`].
pub const EARTH: &str = "(exponent, cohesive_modulus, frictional_modulus, cohesion_pa, friction_angle_rad, \
                         shear_displacement_m, density_kg_m3)";

/// What a card says of it.
pub const EARTH_ABOUT: &str = "n, k_c in N/m^(n+1), k_φ in N/m^(n+2), c, φ, K, ρ; those of `scenarios/soils` name their \
                               sources";

/// Steeper than this no soil lies: frictional angles of rock debris reach 50°.
const STEEPEST_RAD: f64 = 1.05;

impl Earth {
    /// Refuses what no soil can be; `parameter` is the name that scenarios give it.
    ///
    /// # Errors
    /// [`Refusal`] names the parameter.
    pub fn check(&self, parameter: &str) -> Result<(), Refusal> {
        let bounds = [
            ("exponent", self.exponent, Bound::Within(0.02, 2.5)),
            ("cohesive_modulus", self.cohesive_modulus, Bound::NotNegative),
            ("frictional_modulus", self.frictional_modulus, Bound::NotNegative),
            ("cohesion_pa", self.cohesion_pa, Bound::NotNegative),
            ("friction_angle_rad", self.friction_angle_rad, Bound::Within(0.0, STEEPEST_RAD)),
            ("shear_displacement_m", self.shear_displacement_m, Bound::Positive),
            ("density_kg_m3", self.density_kg_m3, Bound::Positive),
        ];
        let refuse = |name: &str, found: f64, expected: String| {
            Err(Refusal { parameter: format!("{parameter}.{name}"), found: found.to_string(), expected })
        };
        for (name, value, bound) in bounds {
            if !bound.holds(value) {
                return refuse(name, value, bound.in_words());
            }
        }
        if self.cohesive_modulus + self.frictional_modulus == 0.0 {
            return refuse("frictional_modulus", 0.0, "more than 0 where `cohesive_modulus` is 0".to_owned());
        }
        Ok(())
    }

    /// Stiffness under a wheel of this width, k_c / b + k_φ [N/m^(n+2)].
    pub fn stiffness(&self, width_m: f64) -> f64 {
        self.cohesive_modulus / width_m + self.frictional_modulus
    }

    /// Work of pressing a rut of this depth, per metre of way [N]: ∫ b p dz = b k z^(n+1) / (n + 1).
    pub fn compaction_n(&self, width_m: f64, sinkage_m: f64) -> f64 {
        let n = self.exponent;
        width_m * self.stiffness(width_m) * sinkage_m.powf(n + 1.0) / (n + 1.0)
    }

    /// Depth after so many passes, as a multiple of that after one: N^(1/a).
    pub fn deepened(passes: u32, exponent: f64) -> f64 {
        f64::from(passes).powf(1.0 / exponent)
    }

    /// Work of the pass that comes after `earlier` ones, as a multiple of the first pass': N^((n+1)/a) − (N−1)^((n+1)/a).
    pub fn later_work(&self, earlier: u32, exponent: f64) -> f64 {
        let power = self.exponent + 1.0;
        let (before, after) = (Self::deepened(earlier, exponent), Self::deepened(earlier + 1, exponent));
        after.powf(power) - before.powf(power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::DRY_SAND;

    #[test]
    fn pressing_a_rut_takes_the_integral_of_the_pressure() {
        // A thousand slices of b k zⁿ.
        let (b, z) = (0.9, 0.05);
        let slice = z / 1000.0;
        let sum: f64 = (0..1000)
            .map(|i| {
                b * DRY_SAND.stiffness(b) * ((f64::from(i) + 0.5) * slice).powf(DRY_SAND.exponent) * slice
            })
            .sum();
        assert!((sum / DRY_SAND.compaction_n(b, z) - 1.0).abs() < 1e-6);
    }

    /// With a = 3 and n = 1.1: 2^(2.1/3) − 1 = 0.6245 of the first pass.
    #[test]
    fn the_second_pass_works_less_than_the_first_and_all_together_press_one_rut() {
        assert!((DRY_SAND.later_work(0, 3.0) - 1.0).abs() < 1e-12);
        assert!((DRY_SAND.later_work(1, 3.0) - 0.6245).abs() < 1e-4);
        let all: f64 = (0..4).map(|earlier| DRY_SAND.later_work(earlier, 3.0)).sum();
        let depth = Earth::deepened(4, 3.0);
        let (b, z) = (0.9, 0.03);
        assert!(
            (all * DRY_SAND.compaction_n(b, z) / DRY_SAND.compaction_n(b, depth * z) - 1.0).abs() < 1e-12
        );
    }

    #[test]
    fn what_no_soil_can_be_is_refused_by_name() {
        let refused = |earth: Earth| earth.check("earth").unwrap_err().to_string();
        assert!(DRY_SAND.check("earth").is_ok());
        assert!(refused(Earth { exponent: 0.0, ..DRY_SAND }).starts_with("`earth.exponent` is 0"));
        assert!(
            refused(Earth { friction_angle_rad: 28.0, ..DRY_SAND }).contains("friction_angle_rad` is 28")
        );
        assert!(refused(Earth { shear_displacement_m: 0.0, ..DRY_SAND }).contains("more than 0"));
        let airy = Earth { cohesive_modulus: 0.0, frictional_modulus: 0.0, ..DRY_SAND };
        assert!(refused(airy).contains("`cohesive_modulus` is 0"));
    }
}
