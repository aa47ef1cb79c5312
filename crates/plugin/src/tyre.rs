//! A tyre, as the ground meets it.

/// Size and pressures of a tyre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tyre {
    /// Width of the section, without load [m].
    pub width_m: f64,
    /// Overall diameter, without load [m].
    pub diameter_m: f64,
    /// Height of the section, rim to tread [m].
    pub section_height_m: f64,
    /// Inflation pressure above ambient [Pa].
    pub inflation_pa: f64,
    /// What the stiffness of the carcass adds to the pressure on the ground [Pa].
    pub carcass_pa: f64,
    /// Load per deflection on hard ground [N/m]; `None` where [`Tyre::deflection_m`] estimates it from the inflation.
    pub stiffness_n_per_m: Option<f64>,
}

impl Tyre {
    /// Deflection on hard ground [m].
    ///
    /// Without a measured stiffness: δ = 0.0008 + 0.001 (0.365 + 170 / p) W, p in kPa, W in kN.
    ///
    /// Source: Saarilahti, *Soil interaction model* (2002), equation 2.22, for tyres of forest and farm machines.
    pub fn deflection_m(&self, load_n: f64) -> f64 {
        if let Some(stiffness) = self.stiffness_n_per_m {
            return load_n / stiffness;
        }
        let (p, w) = (self.inflation_pa / 1e3, load_n / 1e3);
        0.0008 + 0.001 * (0.365 + 170.0 / p) * w
    }

    /// Load per deflection on hard ground [N/m]: the measured one, or the slope of the rule that stands in for it.
    pub fn stiffness_n_per_m(&self) -> f64 {
        self.stiffness_n_per_m.unwrap_or_else(|| 1e6 / (0.365 + 170.0 / (self.inflation_pa / 1e3)))
    }

    /// Height of the hub above hard ground [m].
    pub fn loaded_radius_m(&self, load_n: f64) -> f64 {
        0.5 * self.diameter_m - self.deflection_m(load_n)
    }

    /// Pressure on the ground where the tyre is soft beside it [Pa]: inflation and carcass.
    pub fn ground_pressure_pa(&self) -> f64 {
        self.inflation_pa + self.carcass_pa
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TYRE: Tyre = Tyre {
        width_m: 0.9,
        diameter_m: 2.045,
        section_height_m: 0.54,
        inflation_pa: 1.5e5,
        carcass_pa: 0.0,
        stiffness_n_per_m: None,
    };

    /// A 900/60 R38 at 1.5 bar under 31.93 kN: 0.8 + (0.365 + 1.1333) · 31.93 = 48.6 mm, by hand.
    #[test]
    fn a_wide_tyre_gives_way_by_49_mm_under_3_t() {
        assert!((TYRE.deflection_m(31_930.0) - 0.048_64).abs() < 1e-5);
        assert!((TYRE.loaded_radius_m(31_930.0) - (1.0225 - 0.048_64)).abs() < 1e-5);
    }

    #[test]
    fn a_measured_stiffness_takes_the_place_of_the_rule() {
        let tyre = Tyre { stiffness_n_per_m: Some(6e5), ..TYRE };
        assert!((tyre.deflection_m(30_000.0) - 0.05).abs() < 1e-12);
        assert_eq!(tyre.stiffness_n_per_m(), 6e5);
        let slope = (TYRE.deflection_m(31e3) - TYRE.deflection_m(30e3)) / 1e3;
        assert!((slope * TYRE.stiffness_n_per_m() - 1.0).abs() < 1e-9);
    }
}
