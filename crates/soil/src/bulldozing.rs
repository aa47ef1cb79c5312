//! The soil that a wheel pushes before it.
//!
//! R_b = b (⅔ c z K_pc + ½ γ z² K_pγ)
//! K_pc = (N_c − tan φ') cos² φ',  K_pγ = (2 N_γ / tan φ' + 1) cos² φ',  tan φ' = ⅔ tan φ
//! N_q = e^(π tan φ') tan²(45° + φ'/2),  N_c = (N_q − 1) / tan φ',  N_γ = 2 (N_q + 1) tan φ'
//!
//! Source: Hegedus, *A simplified method for the determination of bulldozing resistance* (1960), in Bekker, *Introduction to
//! Terrain-Vehicle Systems* (1969), part II, with local shear failure (two thirds of the strength); the factors of bearing
//! capacity by Prandtl, Reissner and Vesić ("Analysis of ultimate loads of shallow foundations", 1973), which are closed
//! forms where Terzaghi's are tables. From memory.

use crate::Earth;
use std::f64::consts::{FRAC_PI_4, PI};

/// Reduction of the strength where the soil gives way before its full strength is reached.
const LOCAL: f64 = 2.0 / 3.0;

/// The two factors of a soil, so that a wheel needs no more than two products.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bulldozing {
    /// ⅔ c K_pc [Pa].
    cohesive_pa: f64,
    /// ½ ρ K_pγ [kg/m³]; times gravity where it is used.
    frictional_kg_m3: f64,
}

impl Bulldozing {
    /// Of this soil.
    pub fn of(earth: &Earth) -> Self {
        let tan = LOCAL * earth.friction_angle_rad.tan();
        let phi = tan.atan();
        let n_q = (PI * tan).exp() * (FRAC_PI_4 + 0.5 * phi).tan().powi(2);
        // Without friction the quotient is Prandtl's limit, 2 + π.
        let n_c = if tan > 0.0 { (n_q - 1.0) / tan } else { 2.0 + PI };
        let cos2 = phi.cos().powi(2);
        Self {
            cohesive_pa: LOCAL * earth.cohesion_pa * (n_c - tan) * cos2,
            frictional_kg_m3: 0.5 * earth.density_kg_m3 * (4.0 * (n_q + 1.0) + 1.0) * cos2,
        }
    }

    /// Resistance of a wheel of this width that sinks by `sinkage_m` [N].
    pub fn resistance_n(&self, width_m: f64, sinkage_m: f64) -> f64 {
        /// A soil's model is told no gravity; a half per cent of a correction would be lost in what is known of soils.
        const GRAVITY_M_S2: f64 = 9.806_65;
        let z = sinkage_m;
        width_m * (self.cohesive_pa * z + self.frictional_kg_m3 * GRAVITY_M_S2 * z * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::DRY_SAND;

    /// φ = 28°: tan φ' = 0.35447, φ' = 19.518°, N_q = 3.0452 · 2.0036 = 6.1013, N_c = 14.392, cos² = 0.88838;
    /// K_pc = 12.470, K_pγ = 26.123. With c = 1.04 kPa, 1500 kg/m³, z = 36 mm, b = 0.9 m:
    /// 0.9 (⅔ · 1040 · 0.036 · 12.470 + ½ · 1500 · 9.80665 · 0.036² · 26.123) = 504.2 N, by hand.
    #[test]
    fn dry_sand_before_a_wide_tyre() {
        let force = Bulldozing::of(&DRY_SAND).resistance_n(0.9, 0.036);
        assert!((force / 504.2 - 1.0).abs() < 2e-3, "{force}");
    }

    #[test]
    fn clay_without_friction_has_prandtls_limit_and_its_neighbour_meets_it() {
        let clay = Earth { friction_angle_rad: 0.0, cohesion_pa: 2e4, ..DRY_SAND };
        let limit = Bulldozing::of(&clay);
        assert!((limit.cohesive_pa - LOCAL * 2e4 * (2.0 + PI)).abs() < 1e-9);
        assert!((limit.frictional_kg_m3 / (0.5 * 1500.0 * 9.0) - 1.0).abs() < 1e-12);
        let near = Bulldozing::of(&Earth { friction_angle_rad: 1e-7, ..clay });
        assert!((near.cohesive_pa / limit.cohesive_pa - 1.0).abs() < 1e-5);
    }

    #[test]
    fn no_sinkage_pushes_nothing_and_weight_counts_with_its_square() {
        let soil = Bulldozing::of(&Earth { cohesion_pa: 0.0, ..DRY_SAND });
        assert_eq!(soil.resistance_n(1.0, 0.0), 0.0);
        assert!((soil.resistance_n(1.0, 0.04) / soil.resistance_n(1.0, 0.02) - 4.0).abs() < 1e-12);
    }
}
