//! Ranges, and the round steps that cut them.

/// Least and greatest; (0, 0) of nothing.
pub(crate) fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    if low <= high { (low, high) } else { (0.0, 0.0) }
}

/// Steps of 1, 2 or 5 that cut a range into about `pieces`.
pub(crate) fn step(range: f64, pieces: f64) -> f64 {
    let raw = (range / pieces).max(f64::MIN_POSITIVE);
    let power = 10f64.powf(raw.log10().floor());
    let lead = raw / power;
    power
        * if lead < 1.5 {
            1.0
        } else if lead < 3.5 {
            2.0
        } else if lead < 7.5 {
            5.0
        } else {
            10.0
        }
}

/// Multiples of a step within a range.
pub(crate) fn multiples((low, high): (f64, f64), step: f64) -> Vec<f64> {
    let mut all = Vec::new();
    let mut count = (low / step).ceil();
    while count * step <= high + 1e-9 * step {
        all.push(count * step);
        count += 1.0;
    }
    all
}

/// Between two contours; level ground has none.
pub(super) fn contour_step(range: (f64, f64)) -> f64 {
    if range.1 - range.0 > 1e-6 { step(range.1 - range.0, 10.0) } else { f64::INFINITY }
}

/// A number at a tick, with as many digits as the step between ticks needs.
pub(crate) fn tick(at: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 9")]
    let text = format!("{:.*}", decimals as usize, at + 0.0);
    text.replace('-', "\u{2212}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (range, wanted) in [(10.0, 1.0), (16.0, 2.0), (44.0, 5.0), (0.9, 0.1), (80.0, 10.0)] {
            assert!((step(range, 10.0) / wanted - 1.0).abs() < 1e-12, "{range}");
        }
        assert_eq!(multiples((0.3, 1.0), 0.25), [0.5, 0.75, 1.0]);
        assert_eq!(tick(-0.0, 20.0), "0");
        assert_eq!((tick(306.31, 0.02), tick(-40.0, 20.0)), ("306.31".to_owned(), "\u{2212}40".to_owned()));
    }
}
