//! `diagnosis.json`, as much of it as is scored.

use crate::error::ConcealError;
use serde::Deserialize;
use std::path::Path;

/// What a diagnosis says.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Diagnosis {
    /// `missing_physics`, `sensor_artefact`, `both`, `none`, `cannot_tell` or `unlisted`.
    pub verdict: String,
    /// What it found, the largest share of the mismatch first.
    #[serde(default)]
    pub findings: Vec<Finding>,
    /// How the fit improved.
    #[serde(default)]
    pub fit: Option<Fit>,
    /// Nominal parameters that it moved.
    #[serde(default)]
    pub calibrated: Vec<Interval>,
}

/// A finding.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Finding {
    /// `physics`, `artefact` or `unlisted`.
    pub kind: String,
    /// The contract's id.
    pub id: String,
    /// The balance in which it was found.
    #[serde(default)]
    pub balance: String,
    /// Its parameters.
    #[serde(default)]
    pub parameters: Vec<Interval>,
    /// What it cannot be told from.
    #[serde(default)]
    pub indistinguishable_from: Vec<Alternative>,
}

/// A cause that explains the data as well.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Alternative {
    /// The contract's id.
    pub id: String,
}

/// A number with its interval.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Interval {
    /// Its name.
    pub name: String,
    /// Best value.
    #[serde(default)]
    pub value: Option<f64>,
    /// 95 % interval.
    #[serde(default)]
    pub ci95: Option<[Option<f64>; 2]>,
}

/// The fit before and after.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct Fit {
    /// The channel.
    #[serde(default)]
    pub signal: String,
    /// Runs that were fitted.
    #[serde(default)]
    pub fitted: Option<FitPart>,
    /// Runs that were not.
    #[serde(default)]
    pub held_out: Option<FitPart>,
}

/// Errors over some runs.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct FitPart {
    /// The runs.
    #[serde(default)]
    pub runs: Vec<String>,
    /// With the nominal model.
    #[serde(default)]
    pub rmse_before: Option<f64>,
    /// With the improved one.
    #[serde(default)]
    pub rmse_after: Option<f64>,
}

impl Diagnosis {
    /// Reads a document.
    ///
    /// # Errors
    /// [`ConcealError::File`] or [`ConcealError::Json`].
    pub fn read(path: &Path) -> Result<Self, ConcealError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ConcealError::File { path: path.to_owned(), source })?;
        serde_json::from_str(&text).map_err(|source| ConcealError::Json { path: path.to_owned(), source })
    }
}
