//! What a driveline decides in the middle of a step whose motion is known, before it is asked what it gives.
//!
//! What is asked of it hangs on the motion alone, so it need not be asked twice: once to say what is asked, and once more after it
//! has decided. It decides as at the begin of the step; what it remembers in the middle is foreseen from there with the rates of the
//! step before.

use headland_plugin::{Demand, Driveline};

/// What the driveline remembers, about a decision.
#[derive(Debug, Default)]
pub(crate) struct Deciding {
    /// At the begin of the step.
    pub begin: Vec<f64>,
    /// In the middle of it; of meaning where something has `changed`.
    pub middle: Vec<f64>,
    /// Half of the step [s].
    pub half_s: f64,
    /// Whether it has decided.
    pub done: bool,
    /// Whether it came to something else than before.
    pub changed: bool,
}

impl Deciding {
    /// Before a step of which half is `half_s` [s] and that begins with `states`.
    pub fn before(&mut self, states: &[f64], half_s: f64) {
        self.begin.clear();
        self.begin.extend_from_slice(states);
        self.half_s = half_s;
        (self.done, self.changed) = (false, false);
    }

    /// Lets the driveline decide; returns what it remembers in the middle, `foreseen` where nothing changes.
    pub fn decide<'a>(
        &'a mut self,
        driveline: &dyn Driveline,
        demand: &Demand,
        foreseen: &'a [f64],
        rates: &[f64],
    ) -> &'a [f64] {
        self.done = true;
        self.changed = driveline.decide(demand, &mut self.begin);
        if !self.changed {
            return foreseen;
        }
        self.middle.clear();
        self.middle.extend(self.begin.iter().zip(rates).map(|(begin, rate)| begin + self.half_s * rate));
        &self.middle
    }
}
