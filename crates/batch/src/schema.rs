//! The fields of a comparison that are not pieces of scenarios.

use crate::Measure;
use serde::Deserialize;

/// `repeat`, without what scatters.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "repeat")]
#[allow(dead_code, reason = "what scatters is taken from the text")]
pub struct RepeatFile {
    pub times: u32,
    pub seed: u64,
    pub scatter: Option<serde::de::IgnoredAny>,
}

/// `sample`, without the ranges.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "sample")]
#[allow(dead_code, reason = "the ranges are taken from the text")]
pub struct SampleFile {
    pub count: u32,
    pub seed: u64,
    pub of: serde::de::IgnoredAny,
}

/// What the fuel is.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, rename = "fuel")]
pub struct Fuel {
    /// Its density [kg/m³].
    pub density_kg_m3: f64,
    /// Carbon dioxide of its combustion [kg/kg].
    pub co2_kg_per_kg: f64,
}

/// Where electricity that is charged from the grid comes from.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, rename = "electricity")]
pub struct Electricity {
    /// Carbon dioxide of its making [kg/J].
    pub co2_kg_j: f64,
}

/// How a store that ends at another charge than it began with is made up for.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, rename = "charge")]
pub struct Charge {
    /// Energy in the store for energy of the engine's shaft, when charging.
    pub charging_efficiency: f64,
    /// Energy that replaces that of the engine's shaft for energy of the store, when discharging.
    pub discharging_efficiency: f64,
}

/// `report`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "report")]
pub struct ReportFile {
    pub baseline: Option<String>,
    #[serde(default)]
    pub by: Vec<Measure>,
}
