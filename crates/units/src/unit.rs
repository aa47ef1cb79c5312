//! Units as people write them: `km/h`, `N·m`, `m/s^2`, `°C`, `g/kWh`, `rpm`.

use crate::Dimension;
use std::f64::consts::PI;

/// A unit: an SI value is `value * factor + offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// As it was written.
    pub symbol: String,
    /// What it measures.
    pub dimension: Dimension,
    /// SI units in one of these.
    pub factor: f64,
    /// SI value of zero of these; not 0 for temperatures alone.
    pub offset: f64,
}

impl Unit {
    /// The SI value of `value` of these units. Temperatures come out in degrees Celsius.
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// How many of these units an SI value is.
    pub fn from_si(&self, value: f64) -> f64 {
        (value - self.offset) / self.factor
    }
}

/// A text that is no unit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// A part of it is not a unit that is known.
    #[error("`{part}` in `{text}` is no known unit")]
    Unknown {
        /// The whole text.
        text: String,
        /// The part that was not understood.
        part: String,
    },
    /// A temperature scale with an offset stands inside a compound.
    #[error("`{text}` puts a temperature scale into a compound unit; write K for differences")]
    Offset {
        /// The whole text.
        text: String,
    },
}

const LENGTH: Dimension = Dimension::of(1, 0, 0, 0, 0, 0);
const MASS: Dimension = Dimension::of(0, 1, 0, 0, 0, 0);
const TIME: Dimension = Dimension::of(0, 0, 1, 0, 0, 0);
const CURRENT: Dimension = Dimension::of(0, 0, 0, 1, 0, 0);
const TEMPERATURE: Dimension = Dimension::of(0, 0, 0, 0, 1, 0);
const ANGLE: Dimension = Dimension::of(0, 0, 0, 0, 0, 1);
const FORCE: Dimension = Dimension::of(1, 1, -2, 0, 0, 0);
const ENERGY: Dimension = Dimension::of(2, 1, -2, 0, 0, 0);
const POWER: Dimension = Dimension::of(2, 1, -3, 0, 0, 0);
const PRESSURE: Dimension = Dimension::of(-1, 1, -2, 0, 0, 0);
const VOLTAGE: Dimension = Dimension::of(2, 1, -3, -1, 0, 0);
const RESISTANCE: Dimension = Dimension::of(2, 1, -3, -2, 0, 0);
const VOLUME: Dimension = Dimension::of(3, 0, 0, 0, 0, 0);
const SPEED: Dimension = Dimension::of(1, 0, -1, 0, 0, 0);
const FREQUENCY: Dimension = Dimension::of(0, 0, -1, 0, 0, 0);
const ANGULAR_SPEED: Dimension = Dimension::of(0, 0, -1, 0, 0, 1);
const CHARGE: Dimension = Dimension::of(0, 0, 1, 1, 0, 0);

/// Symbol, what it measures, SI units in one. Non-SI factors: NIST Special Publication 811 (2008), appendix B.8.
const ATOMS: &[(&str, Dimension, f64)] = &[
    ("1", Dimension::NONE, 1.0),
    ("-", Dimension::NONE, 1.0),
    ("%", Dimension::NONE, 0.01),
    ("m", LENGTH, 1.0),
    ("km", LENGTH, 1e3),
    ("cm", LENGTH, 1e-2),
    ("mm", LENGTH, 1e-3),
    ("ft", LENGTH, 0.3048),
    ("in", LENGTH, 0.0254),
    ("mi", LENGTH, 1609.344),
    ("ha", Dimension::of(2, 0, 0, 0, 0, 0), 1e4),
    ("kg", MASS, 1.0),
    ("g", MASS, 1e-3),
    ("mg", MASS, 1e-6),
    ("t", MASS, 1e3),
    ("lb", MASS, 0.453_592_37),
    ("s", TIME, 1.0),
    ("sec", TIME, 1.0),
    ("ms", TIME, 1e-3),
    ("min", TIME, 60.0),
    ("h", TIME, 3600.0),
    ("hr", TIME, 3600.0),
    ("d", TIME, 86_400.0),
    ("A", CURRENT, 1.0),
    ("mA", CURRENT, 1e-3),
    ("Ah", CHARGE, 3600.0),
    ("K", TEMPERATURE, 1.0),
    ("rad", ANGLE, 1.0),
    ("deg", ANGLE, PI / 180.0),
    ("°", ANGLE, PI / 180.0),
    ("rev", ANGLE, 2.0 * PI),
    ("rpm", ANGULAR_SPEED, PI / 30.0),
    ("1/min", ANGULAR_SPEED, PI / 30.0),
    ("Hz", FREQUENCY, 1.0),
    ("N", FORCE, 1.0),
    ("Nm", ENERGY, 1.0),
    ("kN", FORCE, 1e3),
    ("daN", FORCE, 10.0),
    ("lbf", FORCE, 4.448_221_615_260_5),
    ("kgf", FORCE, 9.806_65),
    ("J", ENERGY, 1.0),
    ("kJ", ENERGY, 1e3),
    ("MJ", ENERGY, 1e6),
    ("Wh", ENERGY, 3600.0),
    ("kWh", ENERGY, 3.6e6),
    ("W", POWER, 1.0),
    ("kW", POWER, 1e3),
    ("MW", POWER, 1e6),
    ("hp", POWER, 745.699_871_582_270_2),
    ("PS", POWER, 735.498_75),
    ("Pa", PRESSURE, 1.0),
    ("hPa", PRESSURE, 100.0),
    ("kPa", PRESSURE, 1e3),
    ("MPa", PRESSURE, 1e6),
    ("bar", PRESSURE, 1e5),
    ("mbar", PRESSURE, 100.0),
    ("psi", PRESSURE, 6_894.757_293_168_361),
    ("V", VOLTAGE, 1.0),
    ("mV", VOLTAGE, 1e-3),
    ("F", Dimension::of(-2, -1, 4, 2, 0, 0), 1.0),
    ("ohm", RESISTANCE, 1.0),
    ("Ω", RESISTANCE, 1.0),
    ("mohm", RESISTANCE, 1e-3),
    ("mΩ", RESISTANCE, 1e-3),
    ("L", VOLUME, 1e-3),
    ("l", VOLUME, 1e-3),
    ("mL", VOLUME, 1e-6),
    ("ml", VOLUME, 1e-6),
    ("cc", VOLUME, 1e-6),
    ("ccps", Dimension::of(3, 0, -1, 0, 0, 0), 1e-6),
    ("kph", SPEED, 1.0 / 3.6),
    ("kmh", SPEED, 1.0 / 3.6),
    ("km/h", SPEED, 1.0 / 3.6),
    ("mph", SPEED, 0.447_04),
    ("mps", SPEED, 1.0),
    ("kn", SPEED, 1852.0 / 3600.0),
    ("g0", Dimension::of(1, 0, -2, 0, 0, 0), 9.806_65),
];

/// Temperature scales: symbol, factor, value in °C of their zero. Headland holds temperatures in °C.
const SCALES: &[(&str, f64, f64)] = &[
    ("°C", 1.0, 0.0),
    ("degC", 1.0, 0.0),
    ("C", 1.0, 0.0),
    ("K", 1.0, -273.15),
    ("°F", 5.0 / 9.0, -160.0 / 9.0),
    ("degF", 5.0 / 9.0, -160.0 / 9.0),
];

/// Reads a unit: atoms joined by `·`, `*` or a space, with one or more `/`, and powers as `^2`, `²` or a bare digit.
///
/// # Errors
/// [`UnitError`] names the part that is not known.
pub fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let symbol = text.trim();
    if let Some((_, dimension, factor)) = ATOMS.iter().find(|(atom, ..)| *atom == symbol && *atom != "K") {
        return Ok(Unit { symbol: symbol.to_owned(), dimension: *dimension, factor: *factor, offset: 0.0 });
    }
    if let Some((_, factor, offset)) = SCALES.iter().find(|(scale, ..)| *scale == symbol) {
        return Ok(Unit {
            symbol: symbol.to_owned(),
            dimension: TEMPERATURE,
            factor: *factor,
            offset: *offset,
        });
    }
    let (mut dimension, mut factor) = (Dimension::NONE, 1.0);
    for (index, side) in symbol.split('/').enumerate() {
        let side = side.trim().trim_start_matches('(').trim_end_matches(')');
        let sign: i8 = if index == 0 { 1 } else { -1 };
        for part in side.split(['·', '*', ' ', '⋅']).filter(|part| !part.is_empty()) {
            let (atom, power) = split_power(part);
            if SCALES.iter().any(|(scale, ..)| *scale == atom && *scale != "K") {
                return Err(UnitError::Offset { text: symbol.to_owned() });
            }
            let Some((_, base, size)) = ATOMS.iter().find(|(known, ..)| *known == atom) else {
                return Err(UnitError::Unknown { text: symbol.to_owned(), part: part.to_owned() });
            };
            dimension = dimension + *base * (power * sign);
            factor *= size.powi(i32::from(power * sign));
        }
    }
    if symbol.is_empty() {
        return Err(UnitError::Unknown { text: symbol.to_owned(), part: symbol.to_owned() });
    }
    Ok(Unit { symbol: symbol.to_owned(), dimension, factor, offset: 0.0 })
}

fn split_power(part: &str) -> (&str, i8) {
    const SUPERSCRIPTS: [(&str, i8); 4] = [("⁻¹", -1), ("⁻²", -2), ("²", 2), ("³", 3)];
    for (mark, power) in SUPERSCRIPTS {
        if let Some(atom) = part.strip_suffix(mark) {
            return (atom, power);
        }
    }
    if let Some((atom, power)) = part.split_once('^')
        && let Ok(power) = power.parse()
    {
        return (atom, power);
    }
    match part.char_indices().next_back() {
        Some((at, '2')) if at > 0 => (&part[..at], 2),
        Some((at, '3')) if at > 0 => (&part[..at], 3),
        _ => (part, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_and_flows_convert_as_by_hand() {
        assert!((parse_unit("km/h").unwrap().to_si(36.0) - 10.0).abs() < 1e-12);
        assert!((parse_unit("mph").unwrap().to_si(1.0) - 0.447_04).abs() < 1e-15);
        assert!((parse_unit("g/kWh").unwrap().to_si(200.0) - 200.0 / 3.6e9).abs() < 1e-18);
        assert!((parse_unit("L/h").unwrap().to_si(3.6) - 1e-6).abs() < 1e-18);
        assert!((parse_unit("rpm").unwrap().to_si(60.0) - 2.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn powers_are_read_in_every_spelling() {
        for text in ["m/s^2", "m/s²", "m/s2", "m/s/s", "m s^-2", "m·s⁻²"] {
            assert_eq!(parse_unit(text).unwrap().dimension, Dimension::of(1, 0, -2, 0, 0, 0), "{text}");
        }
    }

    #[test]
    fn temperatures_are_held_in_celsius() {
        assert!((parse_unit("°F").unwrap().to_si(212.0) - 100.0).abs() < 1e-12);
        assert!((parse_unit("K").unwrap().to_si(273.15)).abs() < 1e-12);
        assert!(matches!(parse_unit("°C/s"), Err(UnitError::Offset { .. })));
    }

    #[test]
    fn an_unknown_part_is_named() {
        let error = parse_unit("km/furlong").unwrap_err();
        assert_eq!(error.to_string(), "`furlong` in `km/furlong` is no known unit");
    }

    #[test]
    fn turns_are_not_events() {
        assert_ne!(parse_unit("rpm").unwrap().dimension, parse_unit("Hz").unwrap().dimension);
    }
}
