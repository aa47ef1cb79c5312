//! A hybrid on a course of demands that is known to its end: driven by its own management, and as dynamic programming sees it.
//!
//! Each demand holds for one step. What a driveline remembers beside its charge, such as the range of a transmission, is in
//! both what its management left it in; a turbocharger does not lag. So the two differ by the sharing of power alone.

use crate::optimum::{Course, Grid, Sharing, Unreachable, optimum};
use headland_plugin::{Consequence, Demand, Driveline, Share};

/// How finely the least is looked for.
#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    /// Charges of the grid, two or more; an odd number has the charge at the end on a point of its own.
    pub charges: usize,
    /// Powers of the engine beside 0.
    pub levels: usize,
}

/// A driveline whose sharing nobody can ask about.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotShared {
    /// It has no engine and second store.
    #[error("the driveline does not share power between an engine and a second store: it has no state `{0}`")]
    State(&'static str),
    /// There is nothing to drive.
    #[error("the course has no step")]
    Empty,
    /// Nothing goes in or out of the store, whatever the engine gives.
    #[error("the store takes no part in the course")]
    Idle,
}

/// A hybrid and the demands of its course.
#[derive(Debug)]
pub struct Demanded<'a> {
    hybrid: &'a dyn Driveline,
    demands: &'a [Demand],
    step_s: f64,
    /// What it remembers in every step, with the charge of its management.
    states: Vec<Vec<f64>>,
    charge: usize,
    /// Greatest power of the engine in every step, and the one that leaves the store alone [W].
    powers_w: Vec<(f64, f64)>,
    /// Energy of a charge of 1 [J].
    full_charge_j: f64,
    /// What came of its own management.
    pub managed: Sharing,
}

/// Charge on either side of what the management used that the least may use as well; the store keeps its own window.
const MARGIN: f64 = 0.08;

impl<'a> Demanded<'a> {
    /// Drives the course, each demand for `step_s` [s], with the management that the driveline has.
    ///
    /// # Errors
    /// [`NotShared`].
    pub fn new(hybrid: &'a dyn Driveline, demands: &'a [Demand], step_s: f64) -> Result<Self, NotShared> {
        let named = hybrid.states();
        let index = |name: &'static str| {
            named.iter().position(|state| state.name == name).ok_or(NotShared::State(name))
        };
        let (charge, runs, set) =
            (index("state_of_charge")?, index("engine_runs")?, index("engine_set_power_w")?);
        let boost = index("boost").ok();
        let mut memory: Vec<f64> = named.iter().map(|state| state.initial).collect();
        let mut managed = Sharing {
            fuel_j: 0.0,
            short_j: 0.0,
            shares: Vec::with_capacity(demands.len()),
            charges: vec![memory[charge]],
        };
        let mut states = Vec::with_capacity(demands.len());
        let mut rates = vec![0.0; memory.len()];
        for demand in demands {
            if let Some(boost) = boost {
                memory[boost] = 1.0;
            }
            hybrid.decide(demand, &mut memory);
            let share = Share { engine_runs: memory[runs] > 0.5, engine_w: memory[set] };
            let consequence = hybrid.weigh(demand, &memory, share).ok_or(NotShared::Empty)?;
            states.push(memory.clone());
            rates.fill(0.0);
            hybrid.deliver(demand, &memory, &mut rates);
            memory.iter_mut().zip(&rates).for_each(|(value, rate)| *value += step_s * rate);
            managed.fuel_j += step_s * consequence.fuel_w;
            managed.short_j += step_s * consequence.short_w;
            managed.shares.push(share);
            managed.charges.push(memory[charge]);
        }
        let (powers_w, full_charge_j) = (Vec::new(), 0.0);
        let mut course = Self { hybrid, demands, step_s, states, charge, powers_w, full_charge_j, managed };
        course.powers_w = (0..demands.len()).map(|step| course.powers_of_w(step)).collect();
        course.full_charge_j = course.energy_of_charge_j()?;
        Ok(course)
    }

    /// Greatest power of the engine in a step, and the one that leaves the store alone, by the secant method [W].
    fn powers_of_w(&self, step: usize) -> (f64, f64) {
        /// More than any engine of a vehicle gives; the driveline says how much of it comes about.
        const ALL_W: f64 = 1e9;
        /// A secant converges within these where the losses bend gently.
        const ROUNDS: usize = 6;
        /// A store that works less than this is left alone [W].
        const ALONE_W: f64 = 1.0;
        let at = |engine_w: f64| {
            self.weigh(step, self.states[step][self.charge], Share { engine_runs: true, engine_w })
        };
        let most = at(ALL_W).engine_w.max(0.0);
        let demand = &self.demands[step];
        let mut one = (demand.force_n * demand.speed_m_s + demand.shaft_power_w).clamp(0.0, most);
        let mut at_one = at(one).store_w;
        let mut two = (one + at_one).clamp(0.0, most);
        for _ in 0..ROUNDS {
            let at_two = at(two).store_w;
            if at_two.abs() < ALONE_W || at_two == at_one {
                break;
            }
            let next = (two - at_two * (two - one) / (at_two - at_one)).clamp(0.0, most);
            (one, at_one, two) = (two, at_two, next);
        }
        (most, two)
    }

    /// Energy of a charge of 1, of the step in which the store works most [J].
    fn energy_of_charge_j(&self) -> Result<f64, NotShared> {
        let stopped = Share { engine_runs: false, engine_w: 0.0 };
        let most = (0..self.demands.len())
            .map(|step| self.weigh(step, self.states[step][self.charge], stopped))
            .max_by(|one, other| one.charge_per_s.abs().total_cmp(&other.charge_per_s.abs()))
            .ok_or(NotShared::Empty)?;
        if most.charge_per_s == 0.0 { Err(NotShared::Idle) } else { Ok(-most.store_w / most.charge_per_s) }
    }

    /// Energy that the store gained with its management [J].
    pub fn gained_j(&self) -> f64 {
        let charges = &self.managed.charges;
        self.full_charge_j * (charges[charges.len() - 1] - charges[0])
    }

    /// The course of least fuel that ends at the charge at which the management ended.
    ///
    /// # Errors
    /// [`Unreachable`] where the grid has fewer than two points.
    pub fn least(&self, fineness: Fineness) -> Result<Sharing, Unreachable> {
        let charges = &self.managed.charges;
        let (start, end) = (charges[0], charges[charges.len() - 1]);
        // As far to one side of the end as to the other, so that the step of the cost there is met by a point.
        let reach = charges.iter().map(|charge| (charge - end).abs()).fold(0.0, f64::max) + MARGIN;
        let grid = Grid {
            window: (end - reach, end + reach),
            charges: fineness.charges,
            levels: fineness.levels,
            full_charge_j: self.full_charge_j,
        };
        optimum(self, start, end, grid)
    }
}

impl Course for Demanded<'_> {
    fn steps(&self) -> usize {
        self.demands.len()
    }

    fn step_s(&self) -> f64 {
        self.step_s
    }

    fn most_engine_w(&self, step: usize) -> f64 {
        self.powers_w[step].0
    }

    fn power_w(&self, step: usize) -> f64 {
        self.powers_w[step].1
    }

    fn weigh(&self, step: usize, charge: f64, share: Share) -> Consequence {
        let mut states = self.states[step].clone();
        states[self.charge] = charge;
        self.hybrid.weigh(&self.demands[step], &states, share).unwrap_or_default()
    }
}
