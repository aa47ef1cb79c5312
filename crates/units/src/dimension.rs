//! What kind of quantity a unit measures, as exponents of base quantities.

use std::fmt;
use std::ops::{Add, Mul, Neg};

/// Exponents of length, mass, time, current, temperature and angle.
///
/// Angle counts as a dimension of its own, so that `rpm` fits `rad/s` and `Hz` does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension {
    /// Exponent of length.
    pub length: i8,
    /// Exponent of mass.
    pub mass: i8,
    /// Exponent of time.
    pub time: i8,
    /// Exponent of electric current.
    pub current: i8,
    /// Exponent of temperature.
    pub temperature: i8,
    /// Exponent of plane angle.
    pub angle: i8,
}

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self::of(0, 0, 0, 0, 0, 0);

    /// The dimension with these exponents of length, mass, time, current, temperature and angle.
    pub const fn of(length: i8, mass: i8, time: i8, current: i8, temperature: i8, angle: i8) -> Self {
        Self { length, mass, time, current, temperature, angle }
    }

    fn exponents(self) -> [(&'static str, i8); 6] {
        [
            ("m", self.length),
            ("kg", self.mass),
            ("s", self.time),
            ("A", self.current),
            ("K", self.temperature),
            ("rad", self.angle),
        ]
    }
}

impl Add for Dimension {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::of(
            self.length + other.length,
            self.mass + other.mass,
            self.time + other.time,
            self.current + other.current,
            self.temperature + other.temperature,
            self.angle + other.angle,
        )
    }
}

impl Neg for Dimension {
    type Output = Self;

    fn neg(self) -> Self {
        self * -1
    }
}

impl Mul<i8> for Dimension {
    type Output = Self;

    fn mul(self, power: i8) -> Self {
        Self::of(
            self.length * power,
            self.mass * power,
            self.time * power,
            self.current * power,
            self.temperature * power,
            self.angle * power,
        )
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = self
            .exponents()
            .into_iter()
            .filter(|(_, power)| *power != 0)
            .map(|(base, power)| if power == 1 { base.to_owned() } else { format!("{base}^{power}") })
            .collect();
        if parts.is_empty() { f.write_str("a pure number") } else { f.write_str(&parts.join(" ")) }
    }
}
