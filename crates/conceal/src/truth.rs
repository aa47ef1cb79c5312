//! What a case conceals. Only the scorer opens it.

use crate::error::ConcealError;
use crate::hidden::Told;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// A parameter of the nominal scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prior {
    /// Dotted path in the scenario.
    pub path: String,
    /// Its true value.
    pub truth: f64,
    /// What the scenario says.
    pub nominal: f64,
    /// Stated standard deviation.
    pub sd: f64,
    /// Least and greatest value that the scenario allows.
    pub bounds: (f64, f64),
    /// Whether the scenario frees it.
    pub free: bool,
}

/// A hidden cause.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cause {
    /// The contract's id, or `unlisted`.
    pub id: String,
    /// Which law, where the id alone does not say.
    pub law: String,
    /// `physics` or `artefact`.
    pub class: String,
    /// Its parameters.
    pub parameters: Vec<Told>,
    /// Column of `truth.parquet` that holds what it did along each run.
    pub column: String,
    /// Its root mean square over the fitted runs, in the unit of the column.
    pub rms: f64,
    /// That, over the noise of its balance at one second.
    pub strength: f64,
    /// ln p that it brings over the free parameters, if all noise were white.
    #[serde(default)]
    pub evidence: f64,
    /// Other causes that nobody could tell from it in these runs: the contract's ids.
    #[serde(default)]
    pub twins: Vec<String>,
    /// Column of what it does in power of battery or fuel, where it is a force that only they show.
    #[serde(default)]
    pub power_column: Option<String>,
}

/// What a case conceals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    /// Schema of this document.
    pub schema: String,
    /// Seed of the set.
    pub seed: u64,
    /// Number of the case.
    pub case: usize,
    /// Family.
    pub family: String,
    /// `single`, `two`, `two_unlisted` (one listed, one not), `two_sensor` (physics and a fault), `unlisted`, `empty`
    /// or `artefact`.
    pub kind: String,
    /// The causes.
    pub hidden: Vec<Cause>,
    /// What is true of every plant and not in the scenario: naming it is neither right nor wrong.
    pub also_true: Vec<String>,
    /// Parameters of the scenario.
    pub nominal: Vec<Prior>,
    /// Noise of a sample of each channel that has any, in its unit.
    pub noise: BTreeMap<String, f64>,
    /// Noise of the balance of forces at one second [N].
    pub force_noise_n: f64,
    /// Noise of the balance of the battery at one second [W]; 0 where there is none.
    pub power_noise_w: f64,
    /// The hidden physics as the effects of a scenario, where they can be written so; for the best possible fit.
    #[serde(default)]
    pub oracle: Option<String>,
    /// Runs that are kept from every fit; empty where the diagnosis has to choose.
    pub held_out: Vec<String>,
}

/// Version of `truth.json`.
pub const SCHEMA: &str = "headland.truth/1";

impl Truth {
    /// Reads `truth.json` of a case.
    ///
    /// # Errors
    /// [`ConcealError::File`] or [`ConcealError::Json`].
    pub fn read(folder: &Path) -> Result<Self, ConcealError> {
        let path = folder.join("truth.json");
        let text = std::fs::read_to_string(&path)
            .map_err(|source| ConcealError::File { path: path.clone(), source })?;
        serde_json::from_str(&text).map_err(|source| ConcealError::Json { path, source })
    }
}
