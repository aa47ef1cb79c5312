//! Synthetic recordings with concealed causes, and the score of a diagnosis on them.
//!
//! The plant is another formulation than the simulator that is judged: it is integrated at 1 kHz, its wheels turn and
//! creep, its body pitches on its suspension, and its sensors lag, hold, quantise and drift. It shares no code with the
//! candidates of the diagnosis, which this crate does not know.
//!
//! A case is a folder: `scenario.ron` (the nominal scenario, somewhat wrong within the spread that it states),
//! `recording.ron` with its logs, and `truth.json` with `truth.parquet`, which only the scorer opens.
//!
//! ```text
//! conceal generate --cases 300 --seed 1 --out SET
//! conceal score SET --program target/release/headland --markdown synthetic.md
//! conceal score SET --without-truth --markdown synthetic_without.md
//! conceal real --program target/release/headland --markdown real.md
//! ```
//!
//! `real` does the same with recordings of real vehicles: each set is posed from the channels that were published, and the
//! answer is then held against those that were withheld.
//!
//! Forces in `truth.parquet` are net and forward, powers are taken, as in the `effects.parquet` of a diagnosis. The
//! strength of a cause is its root mean square over the white noise of its balance at one second.
//! `generate --noiseless` makes cases whose scenario is exact and whose sensors are: what `headland compare` then
//! leaves over is how plant and simulator differ. A case with nothing hidden leaves 1 mm/s or so. A recorded
//! accelerometer feels the pitch of the body, which no scenario knows; so `accelerometer_tilt` is true of every such
//! case, and naming it counts neither way. The same goes for `quantisation` where a bus has steps as coarse as its noise.
//!
//! `turbo_lag` shows in a driver's demand, which no log has: where it is hidden, nothing should be claimed.

#![allow(clippy::suboptimal_flops, reason = "equations are written as in their sources")]

mod assemble;
mod case;
mod course;
mod dice;
mod error;
pub mod family;
pub mod hidden;
mod plan;
pub mod plant;
pub mod real;
pub mod score;
mod sensor;
pub mod table;
mod truth;
mod twins;
mod write;

pub use case::{Case, Kind, Probe, generate, kind_of};
pub use course::{Bend, Course};
pub use dice::Dice;
pub use error::ConcealError;
pub use plan::{Channel, Nominal, Plan, RunPlan};
pub use sensor::{Artefact, Sensor};
pub use truth::{Cause, Prior, Truth};
pub use twins::{APART, Seen};
