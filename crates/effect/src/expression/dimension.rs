//! Units inside an expression: exponents of SI base units that need not be whole, as under a root.

use headland_units::{Unit, parse_unit};
use std::fmt;

/// Exponents of metre, kilogram, second, ampere and kelvin.
///
/// The radian counts as 1 here (SI brochure, 9th edition, 2.3.3): an angle may stand in `sin`, and a lever times an angle
/// is a length.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Dimension([f64; 5]);

const BASES: [&str; 5] = ["m", "kg", "s", "A", "K"];

/// Units that are called by a name rather than by their base units.
const NAMED: [&str; 15] =
    ["N", "W", "J", "Pa", "V", "m/s", "m/s²", "N s/m", "N s²/m²", "N/m", "W/K", "N/K", "kg/m³", "1/m", "1/s"];

impl Dimension {
    /// A pure number.
    pub(super) const NONE: Self = Self([0.0; 5]);

    /// What a unit measures.
    pub(super) fn of(unit: &Unit) -> Self {
        let of = unit.dimension;
        Self([of.length, of.mass, of.time, of.current, of.temperature].map(f64::from))
    }

    pub(super) fn times(self, other: Self) -> Self {
        Self(std::array::from_fn(|base| self.0[base] + other.0[base]))
    }

    pub(super) fn to_the(self, power: f64) -> Self {
        Self(self.0.map(|exponent| exponent * power))
    }

    pub(super) fn is_pure(self) -> bool {
        self == Self::NONE
    }
}

impl PartialEq for Dimension {
    /// Exponents such as 0.7 + 0.3 are sums with rounding.
    fn eq(&self, other: &Self) -> bool {
        self.0.iter().zip(other.0).all(|(one, other)| (one - other).abs() < 1e-9)
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_pure() {
            return f.write_str("a pure number");
        }
        let same = |name: &&&str| parse_unit(name).is_ok_and(|unit| Self::of(&unit) == *self);
        if let Some(name) = NAMED.iter().find(same) {
            return f.write_str(name);
        }
        let parts: Vec<String> = BASES
            .iter()
            .zip(self.0)
            .filter(|(_, power)| power.abs() >= 1e-9)
            .map(|(base, power)| match (power * 1e6).round() / 1e6 {
                1.0 => (*base).to_owned(),
                power => format!("{base}^{power}"),
            })
            .collect();
        f.write_str(&parts.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(unit: &str) -> Dimension {
        Dimension::of(&parse_unit(unit).unwrap())
    }

    #[test]
    fn a_unit_is_told_by_its_name_or_its_base_units() {
        assert_eq!(of("N").times(of("m/s")).to_string(), "W");
        assert_eq!(of("m").to_the(0.5).times(of("s").to_the(-2.0)).to_string(), "m^0.5 s^-2");
        assert_eq!(of("kg").to_string(), "kg");
        assert_eq!(of("rad"), Dimension::NONE);
        assert_eq!(of("rad/s").to_string(), "1/s");
    }

    #[test]
    fn every_named_unit_is_found_under_its_own_name() {
        for name in NAMED {
            assert_eq!(of(name).to_string(), name);
        }
    }

    #[test]
    fn broken_powers_add_up() {
        assert_eq!(of("m/s").to_the(0.7).times(of("m/s").to_the(0.3)), of("m/s"));
    }
}
