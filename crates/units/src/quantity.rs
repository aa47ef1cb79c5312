//! Numbers with a unit of their own: `"30 km/h"`.

use crate::{Unit, UnitError, parse_unit};

/// A text that is not a quantity of the kind that was asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuantityError {
    /// It does not start with a number.
    #[error("`{text}` does not start with a number; expected a number and a unit, as in \"30 km/h\"")]
    NoNumber {
        /// What was found.
        text: String,
    },
    /// It has a number and no unit.
    #[error("`{text}` has no unit; expected one that fits {expected}")]
    NoUnit {
        /// What was found.
        text: String,
        /// The unit that was wanted.
        expected: String,
    },
    /// Its unit is not known.
    #[error(transparent)]
    Unit(#[from] UnitError),
    /// Its unit measures something else.
    #[error("`{found}` does not fit: expected a unit of {expected}")]
    Dimension {
        /// The unit that was found.
        found: String,
        /// The unit that was wanted.
        expected: String,
    },
}

/// Reads `"30 km/h"` as a number of `wanted` units.
///
/// # Errors
/// [`QuantityError`] where it is no number with a unit of the same dimension.
pub fn parse_quantity(text: &str, wanted: &Unit) -> Result<f64, QuantityError> {
    let (value, unit) = split(text, wanted)?;
    convert(value, &unit, wanted)
}

/// Reads `"2 °F"` as a difference in `wanted` units, as a standard deviation is one: zeros of scales cancel.
///
/// # Errors
/// [`QuantityError`] where it is no number with a unit of the same dimension.
pub fn parse_difference(text: &str, wanted: &Unit) -> Result<f64, QuantityError> {
    let (value, unit) = split(text, wanted)?;
    let scale = |unit: &Unit| Unit { offset: 0.0, ..unit.clone() };
    convert(value, &scale(&unit), &scale(wanted))
}

/// The number and its unit; `wanted` is what the error asks for.
fn split(text: &str, wanted: &Unit) -> Result<(f64, Unit), QuantityError> {
    let trimmed = text.trim();
    let number_end = trimmed
        .char_indices()
        .find(|&(at, c)| {
            let exponent = matches!(c, 'e' | 'E')
                && trimmed[at + 1..]
                    .starts_with(|next: char| next.is_ascii_digit() || matches!(next, '-' | '+'));
            !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-' | '_') || exponent)
        })
        .map_or(trimmed.len(), |(at, _)| at);
    let value: f64 = trimmed[..number_end]
        .replace('_', "")
        .parse()
        .map_err(|_| QuantityError::NoNumber { text: text.to_owned() })?;
    let unit = trimmed[number_end..].trim();
    if unit.is_empty() {
        return Err(QuantityError::NoUnit { text: text.to_owned(), expected: wanted.symbol.clone() });
    }
    Ok((value, parse_unit(unit)?))
}

/// Converts a value between two units of one dimension.
///
/// # Errors
/// [`QuantityError::Dimension`] where they measure different things.
pub fn convert(value: f64, from: &Unit, to: &Unit) -> Result<f64, QuantityError> {
    if from.dimension != to.dimension {
        return Err(QuantityError::Dimension { found: from.symbol.clone(), expected: to.symbol.clone() });
    }
    Ok(to.from_si(from.to_si(value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit_of_name;
    use proptest::prelude::*;

    fn read(text: &str, name: &str) -> Result<f64, QuantityError> {
        parse_quantity(text, &unit_of_name(name).unwrap())
    }

    #[test]
    fn quantities_convert_to_the_unit_of_the_name() {
        assert!((read("30 km/h", "speed_m_s").unwrap() - 30.0 / 3.6).abs() < 1e-12);
        assert!((read("13.02 t", "mass_kg").unwrap() - 13_020.0).abs() < 1e-9);
        assert!((read("1.5e2kPa", "tyre_pressure_pa").unwrap() - 150_000.0).abs() < 1e-9);
        assert!((read("-90 deg", "from_rad").unwrap() + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((read("50 °F", "air_temperature_c").unwrap() - 10.0).abs() < 1e-12);
        let difference = parse_difference("9 °F", &unit_of_name("air_temperature_c").unwrap()).unwrap();
        assert!((difference - 5.0).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        assert!(matches!(read("30 kg", "speed_m_s"), Err(QuantityError::Dimension { .. })));
        assert!(matches!(read("30", "speed_m_s"), Err(QuantityError::NoUnit { .. })));
        assert!(matches!(read("fast", "speed_m_s"), Err(QuantityError::NoNumber { .. })));
        assert!(matches!(read("3 parsec/h", "speed_m_s"), Err(QuantityError::Unit(_))));
    }

    proptest! {
        #[test]
        fn there_and_back(value in -1e6..1e6f64) {
            let (mph, si) = (parse_unit("mph").unwrap(), parse_unit("m/s").unwrap());
            let back = convert(convert(value, &mph, &si).unwrap(), &si, &mph).unwrap();
            prop_assert!((back - value).abs() <= 1e-9 * value.abs().max(1.0));
        }
    }
}
