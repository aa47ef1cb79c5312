//! A vehicle that its wheels carry: loads, slip, traction and resistance of one instant.
//!
//! s_i = 1 − (1 − s) / λ_i                   slip of a driven axle that turns λ times as fast as the driveline
//! F = Σ λ_i G_i(s_i, W_i)                   what the driveline turns the wheels with, at the speed v / (1 − s)
//! (m + m_rot) dv/dt = Σ G_i − Σ R_i(s_i, W_i) + other forces
//! F v / (1 − s) = v Σ G_i + slip            power: what slip takes is what does not become motion
//!
//! Source: Renius, *Fundamentals of Tractor Design* (2020), chapter 3, for driven axles at one speed; ASABE S296 for the
//! terms. Quasi-steady: traction follows slip at once. A wheel that is not driven turns without torque. Service brakes
//! act on the vehicle without making wheels skid. Loads and acceleration depend on each other, and are solved together.

use crate::Model;
use crate::axles::Axles;
use crate::balance::{Asked, Command, Rolled, Sums};
use crate::root::{Root, rising};
use headland_plugin::{Contact, Delivery, Demand, Footing, Situation, Soil, WheelContact};

/// What one axle does.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AxleState {
    pub load_n: f64,
    pub slip: f64,
    pub traction_n: f64,
    pub resistance_n: f64,
    pub sinkage_m: f64,
}

/// Why a vehicle cannot go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Stuck {
    /// The driven wheels are asked for more than the ground holds.
    Slip { slip: f64, most_n: f64 },
    /// An axle sinks to its hubs.
    Sunk { axle: usize, load_n: f64 },
    /// An axle leaves the ground.
    Lifted { axle: usize },
}

impl Stuck {
    pub fn in_words(self, limit: f64) -> String {
        match self {
            Self::Slip { slip, most_n } if slip >= limit => format!(
                "slip past the limit: with the {limit} that the vehicle may have the ground gives its driven wheels \
                 {most_n:.0} N, and they are asked for more"
            ),
            Self::Slip { slip, most_n } => format!(
                "slip past the limit: the ground gives the driven wheels {most_n:.0} N at the most, at a slip of {slip:.2}, \
                 and they are asked for more"
            ),
            Self::Sunk { axle, load_n } => {
                format!("axle {} sinks to its hubs: the ground does not carry its {load_n:.0} N", axle + 1)
            }
            Self::Lifted { axle } => format!("axle {} leaves the ground: pull and slope turn the vehicle over", axle + 1),
        }
    }
}

/// Memory of the wheels of one vehicle.
#[derive(Debug, Default)]
pub(crate) struct WheelScratch {
    pub axles: Vec<AxleState>,
    pub stuck: Option<Stuck>,
}

/// Sums over all axles, along the motion.
#[derive(Clone, Copy, Debug, Default)]
struct Grip {
    /// Σ G of the driven axles [N].
    gross_n: f64,
    /// Σ λ G: force of the driveline [N].
    force_n: f64,
    /// Σ R [N].
    resistance_n: f64,
    /// Σ R r [N m].
    resisting_n_m: f64,
}

/// First step of the search for slip where nothing is known of it.
const FIRST_STEP: f64 = 0.02;
/// And where the slip under slightly other loads is.
const NEXT_STEP: f64 = 1e-3;
/// Forces are met to this share of the weight.
const TOLERANCE: f64 = 1e-13;
const MOST_ITERATIONS: usize = 40;

/// A vehicle at one instant.
struct Stance<'a> {
    soil: &'a dyn Soil,
    axles: &'a Axles,
    situation: Situation,
    rolling_m_s: f64,
    loads: &'a mut [AxleState],
    /// Whether some of the ground knows no slip: then the whole vehicle has none.
    firm: bool,
}

impl Stance<'_> {
    fn footing(&self, index: usize, slip: f64) -> Option<Footing> {
        let axle = &self.axles.list()[index];
        self.soil.wheel(&WheelContact {
            tyre: &axle.tyre,
            load_n: self.loads[index].load_n.max(0.0) / f64::from(axle.wheels),
            slip,
            speed_m_s: self.rolling_m_s,
            earlier_passes: self.axles.earlier(index),
            position_m: self.situation.position_m,
            place: self.situation.place,
        })
    }

    /// Shares the load out and lets the wheels without drive find the slip at which they turn freely.
    fn load(&mut self, weight_n: f64, moment_n_m: f64, limit: f64) {
        self.firm = false;
        for index in 0..self.loads.len() {
            self.loads[index].load_n = self.axles.load_n(index, weight_n, moment_n_m);
            let Some(towed) = self.footing(index, 0.0) else {
                self.firm = true;
                continue;
            };
            if self.axles.list()[index].lead.is_some() {
                continue;
            }
            let torque = |slip: f64| self.footing(index, slip).map_or(f64::NAN, |f| f.gross_traction_n);
            let free = if towed.gross_traction_n == 0.0 {
                0.0
            } else {
                rising(torque, 0.0, FIRST_STEP, (-limit, limit), TOLERANCE * weight_n).at
            };
            let footing = self.footing(index, free).unwrap_or(towed);
            self.put(index, free, &Footing { gross_traction_n: 0.0, ..footing });
        }
    }

    fn put(&mut self, index: usize, slip: f64, footing: &Footing) {
        let wheels = f64::from(self.axles.list()[index].wheels);
        let state = &mut self.loads[index];
        state.slip = slip;
        state.traction_n = wheels * footing.gross_traction_n;
        state.resistance_n = wheels * footing.motion_resistance_n;
        state.sinkage_m = footing.sinkage_m;
    }

    /// The sums at a slip of the driveline's speed.
    fn grip(&mut self, slip: f64) -> Grip {
        let mut grip = Grip::default();
        for index in 0..self.loads.len() {
            let axle = &self.axles.list()[index];
            let radius_m =
                axle.tyre.loaded_radius_m(self.loads[index].load_n.max(0.0) / f64::from(axle.wheels));
            if let Some(lead) = axle.lead {
                let own = 1.0 - (1.0 - slip) / lead;
                if let Some(footing) = self.footing(index, own) {
                    self.put(index, own, &footing);
                }
                grip.gross_n += self.loads[index].traction_n;
                grip.force_n += lead * self.loads[index].traction_n;
            }
            grip.resistance_n += self.loads[index].resistance_n;
            grip.resisting_n_m += self.loads[index].resistance_n * radius_m;
        }
        grip
    }

    /// On ground that knows no slip every axle resists, and the driven ones pass on what the driveline gives.
    fn roll(&mut self, force_n: f64) -> Grip {
        let mut grip = Grip { gross_n: force_n, force_n, ..Grip::default() };
        let driven = self.axles.list().iter().filter(|axle| axle.lead.is_some()).count() as f64;
        for index in 0..self.loads.len() {
            let axle = self.axles.list()[index];
            let load_n = self.loads[index].load_n.max(0.0);
            let contact =
                Contact { load_n, speed_m_s: self.rolling_m_s, position_m: self.situation.position_m };
            let footing = self.footing(index, 0.0);
            let wheels = f64::from(axle.wheels);
            let resistance_n = footing.map_or_else(
                || self.soil.resistance_at_n(&contact, &self.situation.place),
                |footing| wheels * footing.motion_resistance_n,
            );
            let traction_n = if axle.lead.is_some() { force_n / driven } else { 0.0 };
            let sinkage_m = footing.map_or(f64::NAN, |footing| footing.sinkage_m);
            self.loads[index] = AxleState { load_n, slip: 0.0, traction_n, resistance_n, sinkage_m };
            grip.resistance_n += resistance_n;
            grip.resisting_n_m += resistance_n * axle.tyre.loaded_radius_m(load_n / wheels);
        }
        grip
    }
}

/// What is asked of the ground: a sum of tractions after what they lose and what resists, or a force of the driveline.
#[derive(Clone, Copy)]
enum Goal {
    Net(f64),
    Force(f64),
}

/// One try: everything at one moment of the forces.
struct Tried {
    rolled: Rolled,
    stuck: Option<Stuck>,
    slip: f64,
    moment_n_m: f64,
}

impl Model {
    /// The forces of a vehicle with axles.
    #[inline(never)]
    pub(crate) fn on_wheels(
        &self,
        axles: &Axles,
        soil: &dyn Soil,
        mut asked: Asked,
        sums: &Sums,
        rates: &mut [f64],
        scratch: &mut WheelScratch,
    ) -> Rolled {
        let place = asked.situation.place;
        let carried_n = asked.situation.mass_kg * self.gravity_m_s2;
        let weight_n = carried_n * place.cos_slope();
        scratch.axles.resize(axles.list().len(), AxleState::default());
        let situation = asked.situation;
        let rolling_m_s = (situation.speed_m_s * asked.direction).max(0.0);
        let loads = scratch.axles.as_mut_slice();
        let mut stance = Stance { soil, axles, situation, rolling_m_s, loads, firm: false };
        // The secant method on the moment: tried at one, the forces make another.
        let (mut moment, mut before) = (0.0, None::<(f64, f64)>);
        let mut slip = None;
        let mut tried;
        let mut iteration = 0;
        loop {
            stance.load(weight_n, moment, axles.slip_limit);
            tried = self.attempt(&mut stance, &mut asked, sums, rates, slip);
            let off = tried.moment_n_m - moment;
            iteration += 1;
            let done = off.abs() <= TOLERANCE * weight_n || !off.is_finite() || iteration == MOST_ITERATIONS;
            if done {
                break;
            }
            slip = Some(tried.slip);
            let next = match before {
                Some((at, was)) if was != off => moment - off * (moment - at) / (off - was),
                _ => tried.moment_n_m,
            };
            before = Some((moment, off));
            moment = next;
        }
        scratch.stuck = tried.stuck.or_else(|| gone(&scratch.axles));
        tried.rolled
    }

    /// Asks ground and driveline for what is wanted, at the loads of the stance.
    fn attempt(
        &self,
        stance: &mut Stance,
        asked: &mut Asked,
        sums: &Sums,
        rates: &mut [f64],
        near: Option<f64>,
    ) -> Tried {
        let way = if asked.direction == 0.0 { 1.0 } else { asked.direction };
        let limit = stance.axles.slip_limit;
        let tolerance = TOLERANCE * asked.situation.mass_kg * self.gravity_m_s2;
        let other_n = sums.resistance_n + sums.drawbar_n;
        let net_n = |grip: &Grip| {
            grip.gross_n - sums.loss_share * grip.force_n.abs() - grip.resistance_n.max(-other_n)
        };
        let find = |stance: &mut Stance, goal: Goal, near: Option<f64>| {
            let (start, step) = near.map_or((0.0, FIRST_STEP), |slip| (slip, NEXT_STEP));
            let miss = |slip: f64| {
                let grip = stance.grip(slip);
                match goal {
                    Goal::Net(net) => net_n(&grip) - net,
                    Goal::Force(force) => grip.force_n - force,
                }
            };
            rising(miss, start, step, (-limit, limit), tolerance)
        };
        let goal = match asked.command {
            Command::Accelerate(wanted) if asked.demand.speed_m_s == 0.0 && wanted == 0.0 => Goal::Force(0.0),
            Command::Accelerate(wanted) => {
                Goal::Net(way * (asked.effective_mass_kg * wanted - asked.free_n) + other_n)
            }
            Command::Push(wanted) => Goal::Force(way * asked.effective_mass_kg * wanted),
            Command::Recorded(force_n) => Goal::Force(way * force_n),
            Command::Coast => Goal::Force(0.0),
        };
        // What the driver wants of the wheels, as far as the ground could give it.
        let (mut found, wanted) = if stance.firm {
            let free = stance.roll(0.0);
            let force_n = match goal {
                Goal::Force(force_n) => force_n,
                Goal::Net(net) => {
                    let gross_n = net + free.resistance_n.max(-other_n);
                    gross_n / (1.0 - sums.loss_share * gross_n.signum())
                }
            };
            (Root { at: 0.0, reached: true }, force_n)
        } else {
            let found = find(stance, goal, near);
            let driven = asked.given.driven || matches!(asked.command, Command::Recorded(_));
            let wanted = match goal {
                Goal::Force(force_n) if found.reached || driven => force_n,
                _ => stance.grip(found.at).force_n,
            };
            (found, wanted)
        };
        let mut wanted_n = way * wanted;
        if matches!(asked.command, Command::Coast) {
            wanted_n = 0.0;
        }
        asked.situation.tractive_force_n = wanted_n;
        asked.demand.force_n =
            self.govern(&asked.situation, asked.command, asked.given, asked.layout, asked.states, rates);
        // What the driveline gives at the speed at which the wheels turn under it.
        let speed_m_s = asked.situation.speed_m_s;
        let mut slip_of = |stance: &mut Stance, force_n: f64| -> Root {
            if stance.firm || force_n == wanted_n {
                return found;
            }
            find(stance, Goal::Force(way * force_n), Some(found.at))
        };
        let turn = |slip: f64, force_n: f64| {
            let further = (sums.slip_per_n * force_n * way).clamp(-crate::balance::MOST_SLIP, crate::balance::MOST_SLIP);
            speed_m_s / (1.0 - slip) / (1.0 - further)
        };
        let own = asked.layout.driveline.clone();
        let mut given = |demand: &mut Demand, slip: f64, force_n: f64| {
            demand.speed_m_s = turn(slip, force_n);
            self.driveline.deliver(demand, &asked.states[own.clone()], &mut rates[own.clone()])
        };
        let mut force_n = asked.demand.force_n;
        let mut at = slip_of(stance, force_n);
        let mut delivery = given(&mut asked.demand, at.at, force_n);
        let mut before = (force_n, delivery.force_n - force_n);
        let mut iteration = 0;
        while (delivery.force_n - force_n).abs() > tolerance && iteration < MOST_ITERATIONS {
            let off = delivery.force_n - force_n;
            let next = if iteration == 0 || before.1 == off {
                delivery.force_n
            } else {
                force_n - off * (force_n - before.0) / (off - before.1)
            };
            before = (force_n, off);
            force_n = next;
            at = slip_of(stance, force_n);
            delivery = given(&mut asked.demand, at.at, force_n);
            iteration += 1;
        }
        if let Command::Recorded(recorded_n) = asked.command {
            delivery.source_power_w += (recorded_n - delivery.force_n) * asked.demand.speed_m_s;
            delivery.force_n = recorded_n;
        }
        found = at;
        self.moved(stance, asked, sums, (goal, found, wanted), delivery)
    }
}
