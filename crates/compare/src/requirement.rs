//! What a comparison has to meet: `speed_m_s rmse < 0.2`, `tractive_force_n rmse < 1.5 kN`, `fuel_rate_kg_s total < 5 %`.

use crate::CompareError;
use headland_units::{parse_unit, unit_of_name};
use std::fmt;
use std::str::FromStr;

/// A number of a comparison that can be required. Each is zero or more: an error is required by its size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// Absolute value of the bias [unit of the channel].
    Bias,
    /// Root of the mean squared error [unit of the channel].
    Rmse,
    /// Mean absolute error [unit of the channel].
    Mae,
    /// Largest absolute error [unit of the channel].
    MaxError,
    /// RMSE over the range of the measured values.
    Nrmse,
    /// RMSE over the measured mean.
    NrmseMean,
    /// Square of the correlation.
    RSquared,
    /// Theil's inequality.
    TheilU,
    /// Sprague and Geers' combined error.
    SpragueGeers,
    /// Russell's comprehensive error.
    Russell,
    /// ISO 18571-style rating.
    Iso18571,
    /// Largest distance of the cumulative probabilities.
    CdfDistance,
    /// Area between the cumulative probabilities [unit of the channel].
    CdfArea,
    /// Absolute value of the delay (s).
    Lag,
    /// Absolute value of the relative error of the integral over time.
    Total,
}

impl Metric {
    /// Every metric, with the word for it.
    pub const ALL: [(Self, &'static str); 15] = [
        (Self::Bias, "bias"),
        (Self::Rmse, "rmse"),
        (Self::Mae, "mae"),
        (Self::MaxError, "max_error"),
        (Self::Nrmse, "nrmse"),
        (Self::NrmseMean, "nrmse_mean"),
        (Self::RSquared, "r_squared"),
        (Self::TheilU, "theil_u"),
        (Self::SpragueGeers, "sprague_geers"),
        (Self::Russell, "russell"),
        (Self::Iso18571, "iso18571"),
        (Self::CdfDistance, "cdf_distance"),
        (Self::CdfArea, "cdf_area"),
        (Self::Lag, "lag"),
        (Self::Total, "total"),
    ];

    /// The word for it.
    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(metric, _)| *metric == self).map_or("", |(_, word)| word)
    }

    /// The unit in which it is given for a channel; `1` for a pure number.
    pub fn unit_for(self, channel: &str) -> String {
        let own = || unit_of_name(channel).map_or_else(|| "1".to_owned(), |unit| unit.symbol);
        match self {
            Self::Bias | Self::Rmse | Self::Mae | Self::MaxError | Self::CdfArea => own(),
            Self::Lag => "s".to_owned(),
            _ => "1".to_owned(),
        }
    }
}

/// How a number has to stand to its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Relation {
    /// Below.
    #[serde(rename = "<")]
    Less,
    /// At most.
    #[serde(rename = "<=")]
    LessOrEqual,
    /// Above.
    #[serde(rename = ">")]
    Greater,
    /// At least.
    #[serde(rename = ">=")]
    GreaterOrEqual,
}

impl Relation {
    /// Longer signs first.
    const SIGNS: [(Self, &'static str); 4] =
        [(Self::LessOrEqual, "<="), (Self::GreaterOrEqual, ">="), (Self::Less, "<"), (Self::Greater, ">")];

    /// Whether `found` stands so to `limit`; never, where it is NaN.
    pub fn holds(self, found: f64, limit: f64) -> bool {
        match self {
            Self::Less => found < limit,
            Self::LessOrEqual => found <= limit,
            Self::Greater => found > limit,
            Self::GreaterOrEqual => found >= limit,
        }
    }

    /// Whether a larger number is a worse one.
    pub(crate) fn is_upper(self) -> bool {
        matches!(self, Self::Less | Self::LessOrEqual)
    }
}

/// A limit on one number of one channel, to be met in every run. Read from text by [`str::parse`].
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Requirement {
    /// The channel, or what a total is of.
    pub channel: String,
    /// The number.
    pub metric: Metric,
    /// How it has to stand to the limit.
    pub relation: Relation,
    /// The limit, in [`Metric::unit_for`] the channel.
    pub limit: f64,
}

impl fmt::Display for Requirement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign =
            Relation::SIGNS.iter().find(|(relation, _)| *relation == self.relation).map_or("", |(_, s)| s);
        write!(f, "{} {} {sign} {}", self.channel, self.metric.word(), self.limit)?;
        match self.metric.unit_for(&self.channel).as_str() {
            "1" => Ok(()),
            unit => write!(f, " {unit}"),
        }
    }
}

impl FromStr for Requirement {
    type Err = CompareError;

    fn from_str(text: &str) -> Result<Self, CompareError> {
        read(text).map_err(|reason| CompareError::Requirement { text: text.to_owned(), reason })
    }
}

fn read(text: &str) -> Result<Requirement, String> {
    let at = text.find(['<', '>']).ok_or("it has no < <= > or >=")?;
    let (left, right) = text.split_at(at);
    let (relation, sign) = Relation::SIGNS
        .into_iter()
        .find(|(_, sign)| right.starts_with(sign))
        .ok_or("it has no < <= > or >=")?;
    let words: Vec<&str> = left.split_whitespace().collect();
    let [channel, word] = words[..] else {
        return Err(format!("{} words stand before `{sign}` instead of a channel and a metric", words.len()));
    };
    let metric = metric(word)?;
    let limit = limit(right[sign.len()..].trim(), &metric.unit_for(channel))?;
    Ok(Requirement { channel: channel.to_owned(), metric, relation, limit })
}

fn metric(word: &str) -> Result<Metric, String> {
    if let Some((metric, _)) = Metric::ALL.iter().find(|(_, known)| known.eq_ignore_ascii_case(word)) {
        return Ok(*metric);
    }
    let known: Vec<&str> = Metric::ALL.iter().map(|(_, word)| *word).collect();
    Err(format!("no metric is named `{word}`{}; known: {}", suggestion(word, &known), known.join(", ")))
}

/// `; did you mean ...?` where one of the known words is close.
pub(crate) fn suggestion(word: &str, known: &[&str]) -> String {
    let closest = known
        .iter()
        .map(|known| (strsim::damerau_levenshtein(&word.to_lowercase(), known), known))
        .min_by_key(|(distance, _)| *distance);
    match closest {
        Some((distance, known)) if distance <= 1 + word.len() / 5 => format!("; did you mean `{known}`?"),
        _ => String::new(),
    }
}

/// A number of `wanted` units, with or without a unit of its own.
fn limit(text: &str, wanted: &str) -> Result<f64, String> {
    let (value, unit) = number_and_rest(text).ok_or_else(|| format!("its limit `{text}` is no number"))?;
    if !value.is_finite() || value < 0.0 {
        return Err(format!("its limit {value} is not a number from 0 up, as every metric is"));
    }
    if unit.is_empty() {
        return Ok(value);
    }
    let wanted = parse_unit(wanted).map_err(|error| error.to_string())?;
    let unit = parse_unit(unit).map_err(|error| error.to_string())?;
    if unit.dimension != wanted.dimension {
        let expected = if wanted.symbol == "1" { "a pure number or %" } else { &wanted.symbol };
        return Err(format!("the unit `{}` of its limit does not fit, expected {expected}", unit.symbol));
    }
    // An error is a difference: where a scale of temperature has its zero does not matter.
    Ok(value * unit.factor / wanted.factor)
}

/// The longest start of a text that is a number, and what follows.
fn number_and_rest(text: &str) -> Option<(f64, &str)> {
    (1..=text.len())
        .rev()
        .filter(|end| text.is_char_boundary(*end))
        .find_map(|end| text[..end].trim().parse().ok().map(|value| (value, text[end..].trim())))
}

#[cfg(test)]
#[path = "requirement_tests.rs"]
mod tests;
