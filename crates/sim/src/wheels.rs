//! A vehicle that its wheels carry: loads, slip, traction and resistance of one instant.
//!
//! s_i = 1 − (1 − s) / λ_i                   slip of a driven axle that turns λ times as fast as the driveline
//! F = Σ λ_i G_i(s_i, W_i)                   what the driveline turns the wheels with, at the speed v / (1 − s)
//! (m + m_rot) dv/dt = Σ G_i − Σ R_i(s_i, W_i) + other forces
//! F v / (1 − s) = v Σ G_i + slip            power: what slip takes is what does not become motion
//!
//! Source: Renius, *Fundamentals of Tractor Design* (2020), chapter 3, for driven axles at one speed; ASABE S296 for the
//! terms. Quasi-steady: traction follows slip at once. A wheel that is not driven turns without torque. Loads and
//! acceleration depend on each other, and are solved together.
//!
//! B ≤ Σ_i min(−G_i(s → −1), μ W_i)           what service brakes find in the ground: beyond it every wheel slides
//!
//! Service brakes act on all wheels, and make none slip until all lock; what sliding takes is slip. There is no anti-lock.

use crate::axles::Axles;
use crate::root::rising;
use headland_plugin::{Contact, Footing, Place, Situation, Soil, WheelContact};

/// What one axle does.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AxleState {
    /// The ground below it, straight ahead of the vehicle's place or behind it.
    pub place: Place,
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
            Self::Lifted { axle } => {
                format!("axle {} leaves the ground: pull and slope turn the vehicle over", axle + 1)
            }
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
pub(crate) struct Grip {
    /// Σ G of the driven axles [N].
    pub gross_n: f64,
    /// Σ λ G: force of the driveline [N].
    pub force_n: f64,
    /// Σ R [N].
    pub resistance_n: f64,
    /// Σ R r [N m].
    pub resisting_n_m: f64,
}

/// First step of the search for slip where nothing is known of it.
pub(crate) const FIRST_STEP: f64 = 0.02;
/// Slip at which soils are asked what a wheel finds that a brake holds: they speak of slips above −1.
const LOCKED: f64 = -0.999;
/// Forces are met to this share of the weight.
pub(crate) const TOLERANCE: f64 = 1e-13;

/// A vehicle at one instant.
pub(crate) struct Stance<'a> {
    pub soil: &'a dyn Soil,
    pub axles: &'a Axles,
    pub situation: Situation,
    pub rolling_m_s: f64,
    /// Whether the last axle goes first.
    pub backward: bool,
    pub states: &'a mut [AxleState],
    /// Whether some of the ground knows no slip: then the whole vehicle has none.
    pub firm: bool,
}

impl Stance<'_> {
    fn footing(&self, index: usize, slip: f64) -> Option<Footing> {
        let axle = &self.axles.list()[index];
        self.soil.wheel(&WheelContact {
            tyre: &axle.tyre,
            load_n: self.states[index].load_n.max(0.0) / f64::from(axle.wheels),
            slip,
            speed_m_s: self.rolling_m_s,
            earlier_passes: self.axles.earlier(index, self.backward),
            position_m: self.position_m(axle.position_m),
            place: self.states[index].place,
        })
    }

    /// Where along the path an axle is that stands so far ahead [m].
    fn position_m(&self, ahead_m: f64) -> f64 {
        self.situation.position_m + if self.situation.reversed { -ahead_m } else { ahead_m }
    }

    /// Finds the ground below each axle.
    pub fn place(&mut self) {
        let (east, north) = self.situation.place.heading_rad.sin_cos();
        for (axle, state) in self.axles.list().iter().zip(self.states.iter_mut()) {
            state.place = self.situation.place;
            state.place.east_m += axle.position_m * east;
            state.place.north_m += axle.position_m * north;
        }
    }

    /// Shares the load out, and lets the wheels without drive find the slip at which they turn freely.
    pub fn load(&mut self, weight_n: f64, moment_n_m: f64, limit: f64) {
        self.firm = false;
        for index in 0..self.states.len() {
            self.states[index].load_n = self.axles.load_n(index, weight_n, moment_n_m);
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
        let state = &mut self.states[index];
        state.slip = slip;
        state.traction_n = wheels * footing.gross_traction_n;
        state.resistance_n = wheels * footing.motion_resistance_n;
        state.sinkage_m = footing.sinkage_m;
    }

    /// The sums at a slip of the driveline's speed.
    pub fn grip(&mut self, slip: f64) -> Grip {
        let mut grip = Grip::default();
        for index in 0..self.states.len() {
            let axle = &self.axles.list()[index];
            let radius_m =
                axle.tyre.loaded_radius_m(self.states[index].load_n.max(0.0) / f64::from(axle.wheels));
            if let Some(lead) = axle.lead {
                let own = 1.0 - (1.0 - slip) / lead;
                if let Some(footing) = self.footing(index, own) {
                    self.put(index, own, &footing);
                }
                grip.gross_n += self.states[index].traction_n;
                grip.force_n += lead * self.states[index].traction_n;
            }
            grip.resistance_n += self.states[index].resistance_n;
            grip.resisting_n_m += self.states[index].resistance_n * radius_m;
        }
        grip
    }

    /// On ground that knows no slip every axle resists, and the driven ones pass on what the driveline gives.
    pub fn roll(&mut self, force_n: f64) -> Grip {
        let mut grip = Grip { gross_n: force_n, force_n, ..Grip::default() };
        let driven = self.axles.list().iter().filter(|axle| axle.lead.is_some()).count() as f64;
        for index in 0..self.states.len() {
            let axle = self.axles.list()[index];
            let load_n = self.states[index].load_n.max(0.0);
            let position_m = self.position_m(axle.position_m);
            let contact = Contact { load_n, speed_m_s: self.rolling_m_s, position_m };
            let footing = self.footing(index, 0.0);
            let wheels = f64::from(axle.wheels);
            let resistance_n = footing.map_or_else(
                || self.soil.resistance_at_n(&contact, &self.states[index].place),
                |footing| wheels * footing.motion_resistance_n,
            );
            let traction_n = if axle.lead.is_some() { force_n / driven } else { 0.0 };
            let sinkage_m = footing.map_or(f64::NAN, |footing| footing.sinkage_m);
            self.states[index] =
                AxleState { slip: 0.0, traction_n, resistance_n, sinkage_m, ..self.states[index] };
            grip.resistance_n += resistance_n;
            grip.resisting_n_m += resistance_n * axle.tyre.loaded_radius_m(load_n / wheels);
        }
        grip
    }

    /// What the ground holds the locked wheels of an axle back with [N]; infinite where neither soil nor `friction` says.
    fn locked_of_n(&self, index: usize, friction: f64) -> f64 {
        let load_n = self.states[index].load_n.max(0.0);
        let wheels = f64::from(self.axles.list()[index].wheels);
        // On ground that knows no slip, friction is all that there is, and what resists is a part of it.
        let of_friction_n = if friction == f64::INFINITY { friction } else { friction * load_n };
        match self.footing(index, LOCKED) {
            Some(footing) => (-wheels * footing.gross_traction_n).max(0.0).min(of_friction_n),
            None => of_friction_n - self.states[index].resistance_n,
        }
    }

    /// The same for all axles together [N].
    pub fn locked_n(&self, friction: f64) -> f64 {
        (0..self.states.len()).map(|index| self.locked_of_n(index, friction)).sum()
    }

    /// Writes down that every wheel slides.
    pub fn lock(&mut self, friction: f64) {
        for index in 0..self.states.len() {
            self.states[index].traction_n = -self.locked_of_n(index, friction);
            self.states[index].slip = -1.0;
        }
    }

    /// The first axle that is not carried, or that carries nothing.
    pub fn gone(&self) -> Option<Stuck> {
        let axle = self.states.iter().position(|state| state.load_n < 0.0);
        let sunk = self.states.iter().position(|state| state.resistance_n.is_nan());
        axle.map(|axle| Stuck::Lifted { axle })
            .or_else(|| sunk.map(|axle| Stuck::Sunk { axle, load_n: self.states[axle].load_n }))
    }
}
