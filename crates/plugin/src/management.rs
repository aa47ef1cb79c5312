//! How a driveline with an engine and a second store shares the power between them.

use crate::State;
use std::fmt::Debug;

/// What a management may know: demand and state, never the future.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outlook {
    /// Power that engine and store have to give together, at the shaft of the engine [W]; negative in overrun.
    pub power_w: f64,
    /// The most that the engine gives now [W].
    pub most_engine_w: f64,
    /// Charge of the store, 0 empty and 1 full.
    pub state_of_charge: f64,
    /// Least and greatest charge that it is used between.
    pub window: (f64, f64),
    /// Most power that the store gives and takes now [W], both 0 or more.
    pub most_store_w: (f64, f64),
    /// Whether the engine runs.
    pub engine_runs: bool,
}

/// A way to share the power.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Whether the engine runs.
    pub engine_runs: bool,
    /// Power at its shaft [W]; of no meaning where it does not run. The store gives the rest. Where the store cannot, the
    /// driveline departs from this as little as it has to.
    pub engine_w: f64,
}

/// What a way to share the power takes from the stores.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Consequence {
    /// Power of the fuel, by its lower heating value [W].
    pub fuel_w: f64,
    /// Power drawn from the other store before its resistance, negative while it is charged [W].
    pub store_w: f64,
    /// Rate of its state of charge [1/s].
    pub charge_per_s: f64,
    /// Power that the wheels get less than was asked [W].
    pub short_w: f64,
    /// Power at the shaft of the engine as it came about [W].
    pub engine_w: f64,
}

/// A driveline as its management sees it.
pub trait Stores {
    /// What is asked and what is there.
    fn outlook(&self) -> Outlook;

    /// What a way to share the power would take.
    fn weigh(&self, share: Share) -> Consequence;
}

/// Thresholds, load levelling, equivalent consumption.
pub trait Management: Debug + Send + Sync {
    /// What it remembers.
    fn states(&self) -> Vec<State> {
        Vec::new()
    }

    /// Shares the power until the next step; may set its own states.
    fn share(&self, at: &dyn Stores, states: &mut [f64]) -> Share;

    /// Whether how its states change by themselves hangs on what is asked and what is there; one that counts time is not told.
    fn flows_by_outlook(&self) -> bool {
        true
    }

    /// How its states change by themselves, each per second; a timer runs at 1.
    fn flow(&self, outlook: &Outlook, states: &[f64], rates: &mut [f64]) {
        let _ = (outlook, states, rates);
    }
}
