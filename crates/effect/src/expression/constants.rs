//! The constants of an expression: `{"coefficient": 0.02, "onset_m_s": 5.0}`.

use super::dimension::Dimension;
use super::names::{FUNCTIONS, VARIABLES, WAY};
use super::parser::Constant;
use crate::series::refuse;
use headland_plugin::Refusal;
use headland_units::unit_of_name;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use std::fmt;

/// Names and numbers as they stand in the scenario, twice where they stand twice.
#[derive(Clone, Debug, Default)]
pub(super) struct Constants(Vec<(String, f64)>);

impl Constants {
    /// The constants in SI units; refuses names that are taken or are none, and numbers that are not finite.
    pub(super) fn checked(&self) -> Result<Vec<Constant>, Refusal> {
        let mut all: Vec<Constant> = Vec::new();
        for (name, value) in &self.0 {
            let parameter = format!("constants.{name}");
            let mut letters = name.chars();
            let begins = letters.next().is_some_and(|c| c.is_alphabetic() || c == '_');
            if !(begins && letters.all(|c| c.is_alphanumeric() || c == '_')) {
                return Err(refuse(
                    "constants",
                    &format!("\"{name}\""),
                    "letters, digits and _, no digit first",
                ));
            }
            let known = name == WAY
                || VARIABLES.iter().any(|variable| variable.name == name)
                || FUNCTIONS.iter().any(|function| function.name == name);
            if known || all.iter().any(|other| other.name == *name) {
                let found = if known { "the name of a variable or a function" } else { "given twice" };
                return Err(refuse(&parameter, found, "a name of its own"));
            }
            if !value.is_finite() {
                return Err(refuse(&parameter, &value.to_string(), "a finite number"));
            }
            let unit = unit_of_name(name);
            all.push(Constant {
                name: name.clone(),
                value: unit.as_ref().map_or(*value, |unit| unit.to_si(*value)),
                dimension: unit.as_ref().map_or(Dimension::NONE, Dimension::of),
            });
        }
        Ok(all)
    }
}

impl<'de> Deserialize<'de> for Constants {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(Pairs)
    }
}

struct Pairs;

impl<'de> Visitor<'de> for Pairs {
    type Value = Constants;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("constants, as in {\"coefficient\": 0.02, \"onset_m_s\": 5.0}")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Constants, A::Error> {
        let mut pairs = Vec::new();
        while let Some(pair) = map.next_entry()? {
            pairs.push(pair);
        }
        Ok(Constants(pairs))
    }
}
