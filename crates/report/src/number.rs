//! Numbers as a person reads them: few digits, SI prefixes, a proper minus.

/// Digits of a number that stands alone.
const DIGITS: i32 = 4;
/// Separates groups of thousands: a narrow space at which no line breaks.
const GROUP: char = '\u{202f}';

/// Units that take a prefix when their numbers grow large.
const PREFIXED: &[&str] = &["N", "W", "J", "Pa", "N·m", "V", "Wh"];

/// A number with four significant digits, or with all digits before its point; `–` where there is none.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = magnitude(value);
    if !(-4..9).contains(&exponent) {
        let mantissa = trim(&format!("{:.*}", 2, value / 10f64.powi(exponent)));
        return sign(&format!("{mantissa} × 10{}", superscript(exponent)));
    }
    let decimals = usize::try_from(DIGITS - 1 - exponent).unwrap_or(0);
    sign(&group(&trim(&format!("{value:.decimals$}"))))
}

/// A number with its unit, prefixed where that makes it shorter: `452 kJ`.
pub fn quantity(value: f64, unit: &str) -> String {
    let (factor, unit) = prefix(unit, value.abs());
    let text = number(value / factor);
    if unit.is_empty() { text } else { format!("{text}\u{a0}{unit}") }
}

/// A value and the ends of its interval, to two digits of the half width.
pub fn with_interval(value: f64, lower: f64, upper: f64) -> (String, String) {
    let half = (upper - lower).abs() / 2.0;
    if !(half.is_finite() && half > 0.0) || magnitude(value.abs().max(half)) >= 9 || magnitude(half) < -8 {
        return (number(value), format!("{} to {}", number(lower), number(upper)));
    }
    let decimals = usize::try_from(1 - magnitude(half)).unwrap_or(0);
    let text = |value: f64| {
        if value.is_finite() { sign(&group(&format!("{value:.decimals$}"))) } else { number(value) }
    };
    (text(value), format!("{} to {}", text(lower), text(upper)))
}

/// What to divide by, and the unit to write, for numbers up to `largest` of `unit`.
pub(crate) fn prefix(unit: &str, largest: f64) -> (f64, String) {
    if PREFIXED.contains(&unit) {
        if largest >= 1e10 {
            return (1e9, format!("G{unit}"));
        }
        if largest >= 1e7 {
            return (1e6, format!("M{unit}"));
        }
        if largest >= 1e4 {
            return (1e3, format!("k{unit}"));
        }
    }
    if unit == "m" && largest >= 1e4 {
        return (1e3, "km".to_owned());
    }
    (1.0, unit.to_owned())
}

/// A unit as it is printed: `m/s^2` as `m/s²`.
pub(crate) fn pretty_unit(symbol: &str) -> String {
    symbol
        .replace("^2", "²")
        .replace("^3", "³")
        .replace("^-1", "⁻¹")
        .replace("^-2", "⁻²")
        .replace(' ', "·")
        .replace("ohm", "Ω")
        .replace("deg", "°")
}

/// Decimal exponent of a number that is not zero.
#[expect(clippy::cast_possible_truncation, reason = "the exponent of a double lies within ±324")]
fn magnitude(value: f64) -> i32 {
    value.abs().log10().floor() as i32
}

fn trim(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

fn sign(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|digit| matches!(digit, '0' | '.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text.to_owned(),
    }
}

/// Groups of thousands, from five digits on.
fn group(text: &str) -> String {
    let digits = text.trim_start_matches('-').split('.').next().unwrap_or_default().len();
    if digits < 5 {
        return text.to_owned();
    }
    let (minus, rest) = text.split_at(text.len() - text.trim_start_matches('-').len());
    let mut grouped = minus.to_owned();
    for (index, character) in rest.chars().enumerate() {
        if index > 0 && index < digits && (digits - index).is_multiple_of(3) {
            grouped.push(GROUP);
        }
        grouped.push(character);
    }
    grouped
}

fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|digit| match digit {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            digit => digit.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(digit),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits_and_lose_idle_zeros() {
        assert_eq!(number(0.069_04), "0.06904");
        assert_eq!(number(0.069), "0.069");
        assert_eq!(number(8.333_333), "8.333");
        assert_eq!(number(-12.0), "−12");
        assert_eq!(number(13_019.3), "13\u{202f}019");
        assert_eq!(number(1_234_567.0), "1\u{202f}234\u{202f}567");
        assert_eq!(number(-13_019.3), "−13\u{202f}019");
        assert_eq!(number(9_999.0), "9999");
        assert_eq!(number(100.0), "100");
        assert_eq!(number(2e-9), "2 × 10⁻⁹");
        assert_eq!(number(-6.02e23), "−6.02 × 10²³");
        assert_eq!(number(0.0), "0");
        assert_eq!(number(f64::NAN), "–");
    }

    #[test]
    fn large_forces_and_energies_take_a_prefix() {
        assert_eq!(quantity(452_000.0, "J"), "452\u{a0}kJ");
        assert_eq!(quantity(-8_800.0, "N"), "−8800\u{a0}N");
        assert_eq!(quantity(12_500.0, "N"), "12.5\u{a0}kN");
        assert_eq!(quantity(42.4, "m"), "42.4\u{a0}m");
        assert_eq!(quantity(0.069, ""), "0.069");
    }

    #[test]
    fn an_interval_sets_the_digits_of_its_value() {
        let (value, interval) = with_interval(0.069_04, 0.066_9, 0.071_1);
        assert_eq!((value.as_str(), interval.as_str()), ("0.0690", "0.0669 to 0.0711"));
        let (value, interval) = with_interval(13_010.2, 12_980.0, 13_040.0);
        assert_eq!((value.as_str(), interval.as_str()), ("13\u{202f}010", "12\u{202f}980 to 13\u{202f}040"));
        let (value, interval) = with_interval(-0.001, -0.15, 0.15);
        assert_eq!((value.as_str(), interval.as_str()), ("0.00", "−0.15 to 0.15"));
        assert_eq!(with_interval(1.5, 1.5, 1.5).0, "1.5");
    }

    #[test]
    fn units_are_printed_with_their_powers() {
        assert_eq!(pretty_unit("N s^2/m^2"), "N·s²/m²");
        assert_eq!(pretty_unit("kg/m^3"), "kg/m³");
    }
}
