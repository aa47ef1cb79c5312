//! From a plot to what its script draws: plain numbers and texts, rounded to what a screen can show.

use crate::{Axis, ReportError, number};
use serde_json::{Value, json};

/// A plot, ready for the page.
#[derive(Debug)]
pub(crate) struct Drawn {
    /// For the script.
    pub(crate) spec: Value,
    /// What is to be seen, for those who cannot see it.
    pub(crate) alt: String,
    /// What has to be said below the plot.
    pub(crate) notes: Vec<String>,
}

/// How the numbers of one axis are written: divided for the prefix, rounded to a millionth of their range.
#[derive(Clone, Debug)]
pub(crate) struct Scale {
    divisor: f64,
    decimals: i32,
    /// The axis with its prefixed unit.
    pub(crate) axis: Axis,
    /// Least and greatest value, undivided; NaN where there is none.
    pub(crate) range: (f64, f64),
}

impl Scale {
    pub(crate) fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let range = values
            .filter(|value| value.is_finite())
            .fold((f64::NAN, f64::NAN), |(low, high), value| (value.min(low), value.max(high)));
        let largest = range.0.abs().max(range.1.abs());
        let (divisor, unit) = number::prefix(&axis.unit, if largest.is_finite() { largest } else { 0.0 });
        let width = (range.1 - range.0) / divisor;
        let width = if width > 0.0 { width } else { (largest / divisor).max(f64::MIN_POSITIVE) };
        #[expect(clippy::cast_possible_truncation, reason = "the exponent of a double lies within ±324")]
        let decimals = if width.is_finite() { 6 - width.log10().floor() as i32 } else { 6 };
        Self { divisor, decimals, axis: Axis { label: axis.label.clone(), unit }, range }
    }

    /// One number; null where there is none.
    pub(crate) fn one(&self, value: f64) -> Value {
        let value = value / self.divisor;
        if !value.is_finite() {
            return Value::Null;
        }
        let decimals = usize::try_from(self.decimals.clamp(0, 17)).unwrap_or(0);
        let rounded: f64 = format!("{value:.decimals$}").parse().unwrap_or(value);
        // A whole number is written without a point, and a negative zero without its sign.
        #[expect(clippy::cast_possible_truncation, reason = "checked to be whole and small")]
        if rounded.fract() == 0.0 && rounded.abs() < 1e15 { json!(rounded as i64) } else { json!(rounded) }
    }

    pub(crate) fn all(&self, values: impl Iterator<Item = f64>) -> Value {
        Value::Array(values.map(|value| self.one(value)).collect())
    }

    pub(crate) fn spec(&self) -> Value {
        json!({ "label": self.axis.label, "unit": self.axis.unit })
    }

    /// "from 0 m/s to 8.3 m/s"
    pub(crate) fn words(&self) -> String {
        let (low, high) = self.range;
        if low.is_nan() {
            return "without values".to_owned();
        }
        let unit = &self.axis.unit;
        let gap = if unit.is_empty() { "" } else { " " };
        format!(
            "from {} to {}{gap}{unit}",
            number::number(low / self.divisor),
            number::number(high / self.divisor)
        )
    }
}

pub(crate) fn same_length(
    plot: &str,
    series: &str,
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), ReportError> {
    if found == expected {
        return Ok(());
    }
    Err(ReportError::Length { plot: plot.to_owned(), series: series.to_owned(), what, found, expected })
}

/// What is said where not every sample is drawn.
#[derive(Debug, Default)]
pub(crate) struct Thinned {
    /// Samples drawn, of how many, of which series.
    parts: Vec<(usize, usize, Vec<String>)>,
}

impl Thinned {
    pub(crate) fn add(&mut self, name: &str, drawn: usize, of: usize) {
        if drawn >= of {
            return;
        }
        match self.parts.iter_mut().find(|(d, o, _)| (*d, *o) == (drawn, of)) {
            Some((.., names)) => names.push(name.to_owned()),
            None => self.parts.push((drawn, of, vec![name.to_owned()])),
        }
    }

    pub(crate) fn note(&self, how: &str) -> Option<String> {
        let count = |samples: usize| number::number(samples as f64);
        let words: Vec<String> = self
            .parts
            .iter()
            .map(|(drawn, of, names)| {
                format!("{} of {} samples of {}", count(*drawn), count(*of), names.join(", "))
            })
            .collect();
        (!words.is_empty()).then(|| format!("Thinned to {how}: {}.", words.join("; ")))
    }
}

pub(crate) const BY_EXTREMES: &str = "the least and the greatest of each step of a pixel's width";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_null_and_digits_end_at_a_millionth_of_the_range() {
        let scale = Scale::new(&Axis::new("speed", "m/s"), [0.0, 8.333_333_333, f64::NAN].into_iter());
        assert_eq!(
            scale.all([0.0, -0.0, 8.333_333_333, f64::NAN, f64::INFINITY].into_iter()).to_string(),
            "[0,0,8.333333,null,null]"
        );
        assert_eq!(scale.words(), "from 0 to 8.333 m/s");
    }

    #[test]
    fn one_sentence_tells_what_was_thinned() {
        let mut thinned = Thinned::default();
        assert_eq!(thinned.note("extremes"), None);
        for (name, drawn, of) in [("a", 20, 60_000), ("b", 20, 60_000), ("c", 5, 5), ("d", 7, 90)] {
            thinned.add(name, drawn, of);
        }
        assert_eq!(
            thinned.note("extremes").unwrap(),
            "Thinned to extremes: 20 of 60\u{202f}000 samples of a, b; 7 of 90 samples of d."
        );
    }

    #[test]
    fn large_forces_are_drawn_in_kilonewtons() {
        let scale = Scale::new(&Axis::new("force", "N"), [-20_000.0, 5.0].into_iter());
        assert_eq!((scale.axis.unit.as_str(), scale.one(-20_000.0)), ("kN", json!(-20)));
    }

    #[test]
    fn no_values_are_no_trouble() {
        let scale = Scale::new(&Axis::new("force", "N"), std::iter::once(f64::NAN));
        assert_eq!(scale.words(), "without values");
        assert_eq!(scale.one(3.5), json!(3.5));
    }
}
