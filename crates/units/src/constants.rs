//! Constants of nature and of fuels, each with its source.

/// Standard acceleration of gravity [m/s²]. Source: 3rd CGPM (1901), resolution 2.
pub const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;

/// Specific gas constant of dry air [J/(kg K)]. Source: ISO 2533:1975, standard atmosphere.
pub const DRY_AIR_GAS_CONSTANT_J_KG_K: f64 = 287.052_87;

/// Zero of the Celsius scale [K]. Source: SI brochure, 9th edition, 2.3.1.
pub const CELSIUS_ZERO_K: f64 = 273.15;

/// Density of dry air [kg/m³] at a temperature [°C] and a pressure [Pa]: ρ = p / (R T), the ideal gas law.
pub fn dry_air_density_kg_m3(temperature_c: f64, pressure_pa: f64) -> f64 {
    pressure_pa / (DRY_AIR_GAS_CONSTANT_J_KG_K * (temperature_c + CELSIUS_ZERO_K))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 12 °C and 1013 hPa, the day of the reference study, by hand: 101300 / (287.05 · 285.15) = 1.2376.
    #[test]
    fn air_of_the_reference_day() {
        assert!((dry_air_density_kg_m3(12.0, 101_300.0) - 1.2376).abs() < 1e-4);
    }
}
