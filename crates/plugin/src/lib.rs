//! The extension points of Headland: what a soil, a terrain, a driveline, its management, a task and an effect have to
//! answer, how each describes itself, and the registry that knows them by name.
//!
//! A model is a pure function of its arguments: it sees no clock, no file while running, and keeps no history. What it
//! remembers it declares as states, which the simulation integrates.

mod asking;
mod card;
mod driveline;
mod effect;
mod family;
mod form;
mod management;
mod registry;
mod situation;
mod soil;
mod state;
mod surface;
mod task;
mod terrain;
mod tyre;

pub use card::{Bound, Card, Parameter, parameter};
pub use driveline::{Delivery, Demand, Driveline, MAX_LOSSES, Readings, Shaft};
pub use effect::{Action, Effect};
pub use family::{BuildError, Entry, Family, closest};
pub use form::{Field, Form, form_of};
pub use management::{Consequence, Management, Outlook, Share, Stores};
pub use registry::{Kind, Registry};
pub use situation::{Air, Situation};
pub use soil::{Contact, Footing, Soil, WheelContact};
pub use state::State;
pub use surface::{Bounds, Spot, Surface};
pub use task::{Implement, Load, Mode, Task};
pub use terrain::{Place, Terrain};
pub use tyre::Tyre;

use serde::de::DeserializeOwned;
use std::path::Path;

/// Why a model refuses its parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{parameter}` is {found}, expected {expected}")]
pub struct Refusal {
    /// The parameter, as it is named in the scenario.
    pub parameter: String,
    /// Its value, or what was found in its place.
    pub found: String,
    /// What would have been accepted.
    pub expected: String,
}

/// A model that scenarios can name: it describes itself, and is read from its parameters.
pub trait Plugin: DeserializeOwned + Send + Sync + 'static {
    /// Name, equation, source and parameters.
    const CARD: Card;

    /// Reads the files that the parameters name (relative to `folder`) and checks what no single bound can.
    ///
    /// # Errors
    /// [`Refusal`] names the parameter.
    fn settle(&mut self, folder: &Path) -> Result<(), Refusal> {
        let _ = folder;
        Ok(())
    }
}
