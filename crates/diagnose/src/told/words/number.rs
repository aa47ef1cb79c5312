//! Numbers in sentences.

/// With as many decimals.
fn fixed(value: f64, decimals: i32) -> String {
    let shown = usize::try_from(decimals.clamp(0, 8)).unwrap_or(0);
    let power = 10f64.powi(decimals.min(0));
    // Rounded to tens or hundreds where the decimals are negative.
    let rounded = (value * power).round() / power;
    let text = format!("{:.shown$}", if decimals < 0 { rounded } else { value });
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|letter| matches!(letter, '0' | '.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// Decimals that leave so many significant digits.
fn decimals(value: f64, digits: i32) -> i32 {
    // A few decades at most.
    #[allow(clippy::cast_possible_truncation, reason = "the exponent of a double is small")]
    let magnitude = value.abs().log10().floor() as i32;
    digits - 1 - magnitude
}

/// A number with as many digits as a person reads.
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value.is_finite() { "0".to_owned() } else { "–".to_owned() };
    }
    fixed(value, decimals(value, 3).clamp(0, 8))
}

/// A unit as it is printed, with the space before it.
fn behind(unit: &str) -> String {
    match unit {
        "" | "1" => String::new(),
        other => format!(" {}", other.replace("^2", "²").replace("^3", "³").replace('*', " ")),
    }
}

/// A number with its unit.
pub fn quantity(value: f64, unit: &str) -> String {
    format!("{}{}", number(value), behind(unit))
}

/// A value with its 95 % interval and its unit, to two digits of the interval's half width.
pub fn with_interval(value: f64, ci95: [f64; 2], unit: &str) -> String {
    let half = 0.5 * (ci95[1] - ci95[0]);
    if !(half.is_finite() && half > 0.0) {
        return quantity(value, unit);
    }
    let decimals = decimals(half, 2).min(8);
    format!(
        "{} ({} to {}){}",
        fixed(value, decimals),
        fixed(ci95[0], decimals),
        fixed(ci95[1], decimals),
        behind(unit)
    )
}

/// `310 ± 20 N`, to two digits of the deviation.
pub fn plus_minus(value: f64, sd: f64, unit: &str) -> String {
    if !(sd.is_finite() && sd > 0.0) {
        return quantity(value, unit);
    }
    let decimals = decimals(sd, 2).min(8);
    format!("{} ± {}{}", fixed(value, decimals), fixed(sd, decimals), behind(unit))
}

/// An identifier as words: `soft_ground` is soft ground.
pub fn plain(id: &str) -> String {
    id.replace('_', " ")
}

/// `a`, `a or b`, `a, b or c`.
pub fn either(all: &[String]) -> String {
    match all {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_decides_how_many_digits_are_read() {
        assert_eq!(with_interval(5.3184, [4.912, 5.725], "m/s"), "5.32 (4.91 to 5.72) m/s");
        assert_eq!(with_interval(12873.2, [12411.0, 13335.0], "kg"), "12870 (12410 to 13340) kg");
        assert_eq!(with_interval(-0.012_34, [-0.0136, -0.0111], "1"), "−0.0123 (−0.0136 to −0.0111)");
    }

    #[test]
    fn deviations_and_units_are_printed_as_people_write_them() {
        assert_eq!(plus_minus(311.7, 20.4, "N"), "312 ± 20 N");
        assert_eq!(plus_minus(0.234, 0.0121, "m/s^2"), "0.234 ± 0.012 m/s²");
        assert_eq!(quantity(0.0, "N"), "0 N");
        assert_eq!(number(-0.000_000_000_1), "0.00000000");
    }
}
