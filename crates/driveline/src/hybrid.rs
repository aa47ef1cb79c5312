//! What drivelines with an engine and a second store have in common: the sharing of power that a management decides, and the
//! limits that make them depart from it.
//!
//! Between two steps the management says whether the engine runs and what power P_e it gives. Within a step P_e stays, and
//! the electric side makes up the difference to what is asked. Where a machine or the store cannot:
//! 1. too much is asked of it: the engine gives more, up to full load; then the wheels get less
//! 2. too much is pushed into it: the engine gives less, down to its own friction; then the wheels brake less, and the
//!    service brakes take the rest
//!
//! Other consumers are always served, beyond the limits of the store if need be.

use crate::engine::{Circumstance, Engine, PATIENCE_S, Running};
use crate::parts::crossing;
use crate::store::{Drawn, Store};
use headland_plugin::{
    Bound, Card, Consequence, Delivery, Demand, Driveline, MAX_LOSSES, Management, Outlook, Parameter,
    Plugin, Readings, Refusal, Share, State, Stores, parameter,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer};
use std::fmt::Debug;
use std::path::Path;

/// How the electric consumers of a hybrid are told.
pub(crate) const CONSUMERS: [Parameter; 2] = [
    parameter("standby_power_w", "W", "electric: controllers, steering and cooling, at all times")
        .must_be(Bound::NotNegative)
        .usually(0.0, 1e4),
    parameter("converter_efficiency", "1", "battery to other consumers")
        .must_be(Bound::Efficiency)
        .usually(0.8, 0.99),
];

/// The most states of its own that a topology has.
const MOST_OWN_STATES: usize = 2;

/// What a topology is asked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<'a> {
    pub demand: &'a Demand,
    /// Speed in the direction of driving.
    pub speed_m_s: f64,
    pub at: Circumstance,
    pub motor_c: f64,
    /// Its own states.
    pub own: &'a [f64],
}

/// What flows through a topology for a force and a power of the engine.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Flow {
    pub running: Running,
    /// Electric power that the machines take from the store and each other [W].
    pub bus_w: f64,
    /// By how much more is asked of the machines than they can; negative where they can more [W].
    pub asked_w: f64,
    /// By how much more is pushed into the machines than they can; negative where they can more [W].
    pub pushed_w: f64,
    pub transmission_w: f64,
    pub motor_loss_w: f64,
    pub generator_loss_w: f64,
    pub motor_rad_s: f64,
    pub motor_n_m: f64,
    pub motor_warming_k_s: f64,
    /// Rates of its own states.
    pub own_rates: [f64; MOST_OWN_STATES],
    pub cvt_ratio: f64,
}

/// Names of what is lost, as `deliver` gives it; that of the generator last, for those without one.
const LOSSES: [&str; 7] =
    ["engine heat", "transmission", "accessories", "motor", "battery", "battery charge", "generator"];
/// The same with a supercapacitor.
const LOSSES_OF_SUPERCAPACITOR: [&str; 7] = [
    "engine heat",
    "transmission",
    "accessories",
    "motor",
    "supercapacitor",
    "supercapacitor charge",
    "generator",
];

/// How engine, machines and wheels hang together.
pub(crate) trait Topology: Debug + Send + Sync {
    const CARD: Card;
    /// Whether a generator is apart from the motor, which loses too.
    const HAS_GENERATOR: bool;
    /// How many states of its own it has.
    const OWN_STATES: usize;
    /// Whether it changes any of them between two steps.
    const CHOOSES: bool = false;

    fn settle(&mut self) -> Result<(), Refusal>;
    fn engine(&self) -> &Engine;
    fn store(&self) -> &Store;
    fn consumers(&self) -> Consumers;
    fn coolant_c(&self) -> f64;
    fn own_states(&self) -> Vec<State>;
    fn rotating_mass_kg(&self) -> f64;
    /// Greatest braking and driving force that machines and gears can take.
    fn most_force_n(&self, asked: &Asked) -> (f64, f64);
    /// What flows for a force in the direction of driving; `engine_w` is `None` where the engine stands still.
    fn flow(&self, asked: &Asked, force_n: f64, engine_w: Option<f64>) -> Flow;
    /// Of that, what the machines take from the store for a power of the running engine [W].
    fn bus_w(&self, asked: &Asked, force_n: f64) -> impl Fn(f64) -> f64 {
        move |engine_w| self.flow(asked, force_n, Some(engine_w)).bus_w
    }
    /// Changes its own states between two steps.
    fn choose(&self, asked: &Asked, flow: &Flow, own: &mut [f64]) -> bool {
        let _ = (asked, flow, own);
        false
    }
}

/// Electric consumers beside the machines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Consumers {
    pub standby_w: f64,
    pub converter_efficiency: f64,
}

impl Consumers {
    fn total_w(&self, demand: &Demand) -> f64 {
        self.standby_w + demand.auxiliary_power_w / self.converter_efficiency
    }
}

/// A topology with its management.
#[derive(Debug)]
pub struct Managed<T> {
    topology: T,
    management: Option<Box<dyn Management>>,
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Managed<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        T::deserialize(deserializer).map(|topology| Self { topology, management: None })
    }
}

#[allow(private_bounds, reason = "the topologies are those of this crate")]
impl<T: Topology + DeserializeOwned + 'static> Plugin for Managed<T> {
    const CARD: Card = T::CARD;

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.topology.settle()
    }
}

const BOOST: usize = 0;
const RUNS: usize = 1;
const SET: usize = 2;
const CHARGE: usize = 3;
const VOLUME: usize = 4;
const CARBON: usize = 5;
const MOTOR_C: usize = 6;
const OWN: usize = 7;

/// A store that gives or takes less than this part of what the engine gives is left alone.
const ALONE: f64 = 1e-6;
/// From as near as this one more step of a search leads to a ten-thousandth at most, and mostly far nearer.
const NEARLY_ALONE: f64 = 1e-3;

/// At rest a force that misses is weighed as if the vehicle crept [m/s]: no power tells of it.
const CREEP_M_S: f64 = 0.5;

/// What came about.
struct Solved {
    force: f64,
    engine_w: f64,
    flow: Flow,
    drawn: Drawn,
}

/// What engine and store can [W].
#[expect(clippy::struct_field_names, reason = "each name ends in its unit")]
struct Limits {
    most_out_w: f64,
    most_in_w: f64,
    /// What other consumers take.
    others_w: f64,
    least_w: f64,
    most_w: f64,
}

impl Limits {
    /// By how much more is asked of machines or store than they can.
    fn too_much_w(&self, flow: &Flow) -> f64 {
        flow.asked_w.max(flow.bus_w + self.others_w - self.most_out_w)
    }

    /// By how much more is pushed into them.
    fn pushed_w(&self, flow: &Flow) -> f64 {
        flow.pushed_w.max(-flow.bus_w - self.others_w - self.most_in_w)
    }
}

#[allow(private_bounds, reason = "the topologies are those of this crate")]
impl<T: Topology> Managed<T> {
    fn asked<'a>(demand: &'a Demand, states: &'a [f64]) -> Asked<'a> {
        Asked {
            demand,
            speed_m_s: demand.speed_m_s.abs(),
            at: Circumstance {
                boost: states[BOOST],
                friction_n_m: demand.engine_friction_n_m,
                hand_rad_s: demand.engine_speed_rad_s,
            },
            motor_c: states[MOTOR_C],
            own: &states[OWN..OWN + T::OWN_STATES],
        }
    }

    fn way(demand: &Demand) -> f64 {
        if demand.speed_m_s == 0.0 {
            if demand.force_n < 0.0 { -1.0 } else { 1.0 }
        } else {
            demand.speed_m_s.signum()
        }
    }

    /// The force in the direction of driving that gears and machines could make.
    fn wanted_n(&self, asked: &Asked) -> f64 {
        if asked.demand.coasting {
            return 0.0;
        }
        let (brakes, drives) = self.topology.most_force_n(asked);
        (asked.demand.force_n * Self::way(asked.demand)).clamp(-brakes, drives)
    }

    /// What comes of a share, from which it departs as little as the limits ask.
    fn solve(&self, demand: &Demand, states: &[f64], share: Share) -> Solved {
        let asked = Self::asked(demand, states);
        let (engine, store) = (self.topology.engine(), self.topology.store());
        let behind = store.behind(states[CHARGE], demand.battery_resistance_ohm);
        let (most_out_w, most_in_w) = store.most_behind_w(states[CHARGE], behind);
        let others_w = self.topology.consumers().total_w(demand);
        // Of one that stands still nobody asks what it could give.
        let (least_w, most_w) = if share.engine_runs {
            (engine.least_w(&asked.at), engine.most_w(&asked.at))
        } else {
            (0.0, 0.0)
        };
        let limits = Limits { most_out_w, most_in_w, others_w, least_w, most_w };
        let mut force = self.wanted_n(&asked);
        let mut engine_w = share.engine_w.clamp(least_w.min(most_w), most_w);
        let mut flow = self.topology.flow(&asked, force, share.engine_runs.then_some(engine_w));
        if limits.too_much_w(&flow) > 0.0 || limits.pushed_w(&flow) > 0.0 {
            (force, engine_w, flow) = self.within(&limits, &asked, share.engine_runs, force, engine_w);
        }
        let drawn = store.draw_behind(flow.bus_w + others_w, behind);
        Solved { force, engine_w: if share.engine_runs { engine_w } else { 0.0 }, flow, drawn }
    }

    /// A force and a power of the engine near these that are within the limits, and what flows then.
    #[cold]
    #[inline(never)]
    fn within(
        &self,
        limits: &Limits,
        asked: &Asked,
        engine_runs: bool,
        mut force: f64,
        mut engine_w: f64,
    ) -> (f64, f64, Flow) {
        let power = |engine_w: f64| engine_runs.then_some(engine_w);
        let flow = |force: f64, engine_w: f64| self.topology.flow(asked, force, power(engine_w));
        let too_much_w = |force: f64, engine_w: f64| limits.too_much_w(&flow(force, engine_w));
        let pushed_w = |force: f64, engine_w: f64| limits.pushed_w(&flow(force, engine_w));
        // What a crossing leaves is rounding of the power that flows.
        let rounding_w = |found: &Flow| 1e-9 * (found.bus_w.abs() + limits.others_w + 1.0);

        if too_much_w(force, engine_w) > 0.0 {
            if engine_runs {
                engine_w = crossing(engine_w, limits.most_w, |engine_w| -too_much_w(force, engine_w));
            }
            let found = flow(force, engine_w);
            if force > 0.0 && limits.too_much_w(&found) > rounding_w(&found) {
                force -= crossing(0.0, force, |less| -too_much_w(force - less, engine_w));
            }
        } else {
            if engine_runs {
                engine_w -=
                    crossing(0.0, engine_w - limits.least_w, |less| -pushed_w(force, engine_w - less));
            }
            let found = flow(force, engine_w);
            if force < 0.0 && limits.pushed_w(&found) > rounding_w(&found) {
                force += crossing(0.0, -force, |less| -pushed_w(force + less, engine_w));
            }
        }
        (force, engine_w, flow(force, engine_w))
    }

    fn share(states: &[f64]) -> Share {
        Share { engine_runs: states[RUNS] > 0.5, engine_w: states[SET] }
    }

    fn outlook(&self, demand: &Demand, states: &[f64], power_w: f64) -> Outlook {
        let asked = Self::asked(demand, states);
        let (out, into) = self.topology.store().most_w(states[CHARGE], demand.battery_resistance_ohm);
        Outlook {
            power_w,
            most_engine_w: self.topology.engine().most_w(&asked.at).max(0.0),
            state_of_charge: states[CHARGE],
            window: self.topology.store().window,
            most_store_w: (out, into),
            engine_runs: states[RUNS] > 0.5,
        }
    }

    /// The power of the engine that leaves the store alone, by the secant method.
    fn alone_w(&self, demand: &Demand, states: &[f64]) -> f64 {
        const ROUNDS: usize = 4;
        let asked = Self::asked(demand, states);
        let force = self.wanted_n(&asked);
        let others = self.topology.consumers().total_w(demand);
        let bus_w = self.topology.bus_w(&asked, force);
        let bus = |engine_w: f64| bus_w(engine_w) + others;
        let mut one = force * asked.speed_m_s + demand.shaft_power_w + others;
        let mut at_one = bus(one);
        let mut two = one + at_one;
        for _ in 0..ROUNDS {
            let at_two = bus(two);
            let scale = one.abs().max(two.abs());
            if at_two.abs() <= ALONE * scale || at_two == at_one || two == one {
                break;
            }
            let next = two - at_two * (two - one) / (at_two - at_one);
            let near = at_two.abs() <= NEARLY_ALONE * scale;
            (one, at_one, two) = (two, at_two, next);
            if near {
                break;
            }
        }
        if two.is_finite() { two } else { one }
    }
}

/// A hybrid at an instant, as its management sees it.
struct Weighing<'a, T> {
    hybrid: &'a Managed<T>,
    demand: &'a Demand,
    states: &'a [f64],
    outlook: Outlook,
}

impl<T: Topology> Stores for Weighing<'_, T> {
    fn outlook(&self) -> Outlook {
        self.outlook
    }

    fn weigh(&self, share: Share) -> Consequence {
        self.hybrid.consequence(self.demand, self.states, share)
    }
}

#[allow(private_bounds, reason = "the topologies are those of this crate")]
impl<T: Topology> Managed<T> {
    fn consequence(&self, demand: &Demand, states: &[f64], share: Share) -> Consequence {
        let Solved { force, engine_w, flow, drawn } = self.solve(demand, states, share);
        let wanted = demand.force_n * Self::way(demand);
        let short = if demand.coasting { 0.0 } else { (wanted - force).max(0.0) };
        let (out, _) = self.topology.store().most_w(states[CHARGE], demand.battery_resistance_ohm);
        let beyond = (drawn.store_w - drawn.loss_w - out).max(0.0);
        Consequence {
            fuel_w: flow.running.fuel_w,
            store_w: drawn.store_w,
            charge_per_s: drawn.charge_per_s,
            short_w: short * demand.speed_m_s.abs().max(CREEP_M_S) + beyond,
            engine_w,
        }
    }
}

#[allow(private_bounds, reason = "the topologies are those of this crate")]
impl<T: Topology> Driveline for Managed<T> {
    fn states(&self) -> Vec<State> {
        let mut states = vec![
            State { name: "boost", initial: 0.0 },
            State { name: "engine_runs", initial: 1.0 },
            State { name: "engine_set_power_w", initial: 0.0 },
            State { name: "state_of_charge", initial: self.topology.store().initial },
            State { name: "fuel_m3", initial: 0.0 },
            State { name: "carbon_dioxide_kg", initial: 0.0 },
            State { name: "motor_temperature_c", initial: self.topology.coolant_c() },
        ];
        states.extend(self.topology.own_states());
        states.extend(self.management.iter().flat_map(|management| management.states()));
        states
    }

    fn losses(&self) -> &'static [&'static str] {
        let all: &[&str] =
            if self.topology.store().is_supercapacitor { &LOSSES_OF_SUPERCAPACITOR } else { &LOSSES };
        if T::HAS_GENERATOR { all } else { &all[..all.len() - 1] }
    }

    fn source(&self) -> &'static str {
        "fuel"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        self.topology.rotating_mass_kg()
    }

    fn deliver(&self, demand: &Demand, states: &[f64], rates: &mut [f64]) -> Delivery {
        let Solved { force, engine_w, flow, drawn } = self.solve(demand, states, Self::share(states));
        let engine = self.topology.engine();
        if let Some(own) = rates.get_mut(..OWN) {
            (own[RUNS], own[SET]) = (0.0, 0.0);
            (own[BOOST], own[CHARGE]) = (flow.running.boost_per_s, drawn.charge_per_s);
            (own[VOLUME], own[CARBON]) = engine.burnt(flow.running.fuel_w);
            own[MOTOR_C] = flow.motor_warming_k_s;
            let ends = OWN + T::OWN_STATES;
            rates[OWN..ends].copy_from_slice(&flow.own_rates[..T::OWN_STATES]);
            if let Some(management) = &self.management {
                let power_w = engine_w + drawn.store_w - drawn.loss_w;
                let outlook = if management.flows_by_outlook() {
                    self.outlook(demand, states, power_w)
                } else {
                    Outlook::default()
                };
                management.flow(&outlook, &states[ends..], &mut rates[ends..]);
            }
        }
        let force_n = force * Self::way(demand);
        let consumers = self.topology.consumers();
        let mut losses_w = [0.0; MAX_LOSSES];
        losses_w[0] = flow.running.heat_w();
        losses_w[1] = flow.transmission_w;
        losses_w[2] = flow.running.accessories_w + consumers.total_w(demand) - demand.auxiliary_power_w;
        losses_w[3] = flow.motor_loss_w;
        losses_w[4] = drawn.loss_w;
        losses_w[5] = -drawn.store_w;
        losses_w[6] = flow.generator_loss_w;
        Delivery {
            force_n,
            source_power_w: flow.running.fuel_w,
            losses_w,
            readings: Readings {
                engine_speed_rad_s: flow.running.speed_rad_s,
                engine_torque_n_m: flow.running.torque_n_m(),
                fuel_rate_kg_s: flow.running.fuel_w / engine.heating_value_j_kg(),
                cvt_ratio: flow.cvt_ratio,
                motor_speed_rad_s: flow.motor_rad_s,
                motor_torque_n_m: flow.motor_n_m,
                battery_voltage_v: drawn.voltage_v,
                battery_current_a: drawn.current_a,
            },
        }
    }

    fn decide(&self, demand: &Demand, states: &mut [f64]) -> bool {
        let ends = OWN + T::OWN_STATES;
        let mut chosen = false;
        if T::CHOOSES {
            let flow = self.solve(demand, states, Self::share(states)).flow;
            let mut own = [0.0; MOST_OWN_STATES];
            own[..T::OWN_STATES].copy_from_slice(&states[OWN..ends]);
            chosen = self.topology.choose(&Self::asked(demand, states), &flow, &mut own[..T::OWN_STATES]);
            states[OWN..ends].copy_from_slice(&own[..T::OWN_STATES]);
        }
        let Some(management) = &self.management else { return chosen };
        let (base, memory) = states.split_at_mut(ends);
        let outlook = self.outlook(demand, base, self.alone_w(demand, base));
        let share = management.share(&Weighing { hybrid: self, demand, states: base, outlook }, memory);
        let set = if share.engine_runs { share.engine_w } else { 0.0 };
        let runs = f64::from(u8::from(share.engine_runs));
        let changed = base[RUNS] != runs || base[SET] != set;
        (base[RUNS], base[SET]) = (runs, set);
        chosen || changed
    }

    fn patience_s(&self) -> f64 {
        PATIENCE_S
    }

    fn needs_management(&self) -> bool {
        self.management.is_none()
    }

    fn adopt(&mut self, management: Box<dyn Management>) -> Result<(), Refusal> {
        self.management = Some(management);
        Ok(())
    }

    fn weigh(&self, demand: &Demand, states: &[f64], share: Share) -> Option<Consequence> {
        Some(self.consequence(demand, states, share))
    }
}

#[cfg(test)]
#[path = "hybrid_tests.rs"]
mod tests;
