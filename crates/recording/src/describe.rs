//! The schema of a description, as it stands in RON.

use headland_units::{parse_difference, parse_quantity, unit_of_name};
use serde::{Deserialize, Deserializer, de};
use std::fmt;

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Recording")]
pub(crate) struct Description {
    pub about: String,
    #[serde(default)]
    pub folder: Option<String>,
    pub runs: Vec<RunDescription>,
    #[serde(default)]
    pub format: Option<Format>,
    #[serde(default)]
    pub time: Option<TimeDescription>,
    #[serde(default)]
    pub channels: Vec<ChannelDescription>,
    #[serde(default = "yes")]
    pub keep_others: bool,
    #[serde(default)]
    pub split: Option<Split>,
    #[serde(default)]
    pub known: Vec<KnownDescription>,
    #[serde(default)]
    pub notes: Vec<String>,
}

fn yes() -> bool {
    true
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Run")]
pub(crate) struct RunDescription {
    pub id: String,
    pub file: String,
    #[serde(default)]
    pub segments: Vec<Segment>,
    #[serde(default)]
    pub split: Option<Split>,
    #[serde(default)]
    pub path: Option<String>,
    #[serde(default)]
    pub reversed: bool,
    #[serde(default, rename = "use")]
    pub purpose: Purpose,
    #[serde(default)]
    pub channels: Vec<ChannelDescription>,
    #[serde(default)]
    pub known: Vec<KnownDescription>,
    #[serde(default)]
    pub notes: Vec<String>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Segment {
    pub from_s: f64,
    pub to_s: f64,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Purpose {
    #[default]
    Fit,
    HeldOut,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(clippy::struct_field_names, reason = "the unit ends each name")]
pub(crate) struct Split {
    #[serde(default)]
    pub speed_jump_m_s: Option<f64>,
    #[serde(default)]
    pub gap_s: Option<f64>,
    #[serde(default)]
    pub shortest_s: Option<f64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum Format {
    Csv {
        #[serde(default)]
        delimiter: Option<String>,
        #[serde(default)]
        encoding: Option<String>,
        #[serde(default)]
        decimal: Option<String>,
        #[serde(default)]
        skip_lines: Option<usize>,
        #[serde(default)]
        comment: Option<String>,
        #[serde(default)]
        names: Option<Vec<String>>,
    },
    Parquet,
    Mdf4,
    Candump {
        #[serde(rename = "dbc")]
        _dbc: String,
    },
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TimeDescription {
    #[serde(default)]
    pub column: Option<String>,
    #[serde(default)]
    pub date: Option<String>,
    #[serde(default)]
    pub clock: Option<String>,
    #[serde(default)]
    pub order: Option<DateOrder>,
    #[serde(default)]
    pub unit: Option<String>,
    #[serde(default)]
    pub period_s: Option<f64>,
}

/// Order of day, month and year in a date.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum DateOrder {
    Ymd,
    Dmy,
    Mdy,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Channel")]
pub(crate) struct ChannelDescription {
    #[serde(default)]
    pub column: Option<String>,
    #[serde(default)]
    pub columns: Option<Vec<String>>,
    #[serde(default)]
    pub combine: Option<Combine>,
    pub is: String,
    #[serde(default)]
    pub unit: Option<String>,
    #[serde(default)]
    pub scale: Option<f64>,
    #[serde(default)]
    pub offset: Option<f64>,
    #[serde(default)]
    pub density_kg_m3: Option<f64>,
    #[serde(default)]
    pub radius_m: Option<f64>,
    #[serde(default)]
    pub optional: bool,
    #[serde(default)]
    pub sensor: Option<SensorDescription>,
}

/// How several columns become one channel.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Combine {
    Mean,
    Sum,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "sensor")]
pub(crate) struct SensorDescription {
    #[serde(default)]
    pub noise: Option<f64>,
    #[serde(default)]
    pub latency_s: Option<f64>,
    #[serde(default)]
    pub scale: Option<f64>,
    #[serde(default)]
    pub bias: Option<f64>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "Known")]
pub(crate) struct KnownDescription {
    pub name: String,
    pub value: Amount,
    #[serde(default)]
    pub sd: Option<Amount>,
}

/// A number in the unit of its name, or a text with a unit of its own.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Amount {
    Number(f64),
    Text(String),
}

impl Amount {
    /// The number in the unit that ends `name`; the text says what is wrong.
    pub fn resolve(&self, name: &str, spread: bool) -> Result<f64, String> {
        match self {
            Self::Number(value) => Ok(*value),
            Self::Text(text) => {
                let unit = unit_of_name(name).ok_or_else(|| {
                    format!("`{name}` ends in no unit, expected a number instead of `{text}`")
                })?;
                let read = if spread { parse_difference } else { parse_quantity };
                read(text, &unit).map_err(|error| error.to_string())
            }
        }
    }
}

impl<'de> Deserialize<'de> for Amount {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        #[expect(clippy::cast_precision_loss, reason = "whole numbers in a description are small")]
        impl de::Visitor<'_> for Reader {
            type Value = Amount;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a text with a unit such as \"1.27 t\"")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Amount, E> {
                Ok(Amount::Number(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Amount, E> {
                Ok(Amount::Number(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Amount, E> {
                Ok(Amount::Number(value as f64))
            }

            fn visit_str<E: de::Error>(self, value: &str) -> Result<Amount, E> {
                Ok(Amount::Text(value.to_owned()))
            }
        }
        deserializer.deserialize_any(Reader)
    }
}
