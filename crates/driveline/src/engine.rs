//! A combustion engine with what hangs on it: fuel, friction, boost, governor and accessories.
//!
//! P_f  = (P + (p_me0 V_d / 4π + T_x) ω) / e         Willans line, p_me0 = p₀ + p₂ ω²; or a map of fuel by speed and torque
//! ω    = the lowest speed from idle on with min(λ, l) T_full(ω) ω ≥ P     operating line
//! ω    = ω_h (1 + δ (1 − T / T_full(ω_h)))           at a hand throttle set to ω_h
//! l    = σ + (1 − σ) b,   τ ω_P/ω db/dt = T / T_full(ω) − b     smoke limit and boost
//! P    = P_net + P_acc + T_pump ω + P_fan (ω / ω_P)³ + P_el / η_alt     accessories
//!
//! Source: Guzzella and Onder, *Introduction to Modeling and Control of Internal Combustion Engine Systems* (2010), sections
//! 2.5 (Willans line), 2.6 (boost, linearised to a first-order lag); Renius, *Fundamentals of Tractor Design* (2020),
//! chapter 5, for the operating line. ω_P is the speed of the greatest power.
//!
//! Overrun that friction at idle speed can take is fuelled; beyond, fuel is cut off and the engine turns as fast as it has
//! to, at most as fast as the full-load curve reaches. Leaves out inertia of the crankshaft, cold starts and altitude.

use crate::full_load::{FullLoad, Point};
use crate::parts::{crossing, hold, increasing, place, refuse};
use headland_plugin::{Bound, Parameter, Refusal, parameter};
use serde::Deserialize;
use std::f64::consts::PI;

/// How long a driveline behind an engine may wait for boost and shifts [s]: longer than turbochargers take from idle.
pub(crate) const PATIENCE_S: f64 = 4.0;

/// How an engine's parameters are told, as `engine.` of a driveline.
pub(crate) const ENGINE: [Parameter; 21] = [
    parameter("engine.displacement_m3", "m³", "swept volume, four strokes, V_d")
        .must_be(Bound::Positive)
        .usually(5e-4, 0.03),
    parameter(
        "engine.full_load",
        "[(speed_rad_s, torque_n_m)]",
        "greatest torque by speed, two points or more, T_full",
    ),
    parameter("engine.idle_speed_rad_s", "rad/s", "lowest speed")
        .must_be(Bound::Positive)
        .usually(60.0, 115.0),
    parameter("engine.load_share", "1", "operating line as a share of the full-load torque, λ")
        .must_be(Bound::Efficiency)
        .usually(0.6, 1.0),
    parameter("engine.friction_pa", "Pa", "mean effective pressure of friction at no speed, p₀")
        .must_be(Bound::Positive)
        .usually(0.3e5, 2.5e5),
    parameter("engine.friction_rise_pa_s2", "Pa s²", "its rise with the square of speed, p₂")
        .must_be(Bound::NotNegative)
        .usually(0.0, 5.0)
        .or(0.0),
    parameter("engine.willans_efficiency", "1", "slope of the Willans line, e; or `fuel_map`")
        .must_be(Bound::Efficiency)
        .usually(0.3, 0.5),
    parameter(
        "engine.fuel_map",
        "(speeds_rad_s, torques_n_m, rates_kg_s)",
        "fuel by speed and torque instead, one list of rates for each speed; torques begin at 0",
    ),
    parameter("engine.lower_heating_value_j_kg", "J/kg", "of the fuel")
        .must_be(Bound::Positive)
        .usually(2.6e7, 5e7),
    parameter("engine.fuel_density_kg_m3", "kg/m³", "of the fuel")
        .must_be(Bound::Positive)
        .usually(600.0, 950.0),
    parameter("engine.carbon_dioxide", "1", "kg of CO₂ from a kg of fuel")
        .must_be(Bound::NotNegative)
        .usually(0.0, 4.0),
    parameter("engine.droop", "1", "rise of speed from full load to none at a hand throttle, δ")
        .must_be(Bound::Within(0.0, 0.5))
        .usually(0.0, 0.1)
        .or(0.0),
    parameter(
        "engine.unboosted_share",
        "1",
        "share of the full-load torque without boost, σ; 1 for no limit",
    )
    .must_be(Bound::Efficiency)
    .usually(0.4, 1.0)
    .or(1.0),
    parameter("engine.boost_time_s", "s", "time constant of the boost at the speed of greatest power, τ")
        .must_be(Bound::Positive)
        .usually(0.3, 3.0)
        .or(1.0),
    parameter("engine.accessory_power_w", "W", "compressor and whatever takes as much at all speeds, P_acc")
        .must_be(Bound::NotNegative)
        .usually(0.0, 3e4),
    parameter("engine.pump_torque_n_m", "N m", "standby of hydraulic pumps, T_pump")
        .must_be(Bound::NotNegative)
        .usually(0.0, 100.0)
        .or(0.0),
    parameter("engine.fan_power_w", "W", "of the fan at the speed of greatest power, P_fan")
        .must_be(Bound::NotNegative)
        .usually(0.0, 4e4)
        .or(0.0),
    parameter("engine.alternator_efficiency", "1", "shaft to electric consumers, η_alt")
        .must_be(Bound::Efficiency)
        .usually(0.4, 0.97),
    parameter("engine.fuel_map.speeds_rad_s", "[rad/s]", "speeds of the map, two or more, increasing")
        .must_be(Bound::Positive)
        .usually(50.0, 700.0),
    parameter("engine.fuel_map.torques_n_m", "[N m]", "torques of the map from 0 on, increasing")
        .must_be(Bound::NotNegative)
        .usually(0.0, 5000.0),
    parameter("engine.fuel_map.rates_kg_s", "[kg/s]", "one list for each speed, one rate for each torque")
        .must_be(Bound::NotNegative)
        .usually(0.0, 0.1),
];

/// Fuel by speed and torque.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FuelMap {
    speeds_rad_s: Vec<f64>,
    torques_n_m: Vec<f64>,
    rates_kg_s: Vec<Vec<f64>>,
}

/// An engine.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "engine")]
pub(crate) struct Engine {
    displacement_m3: f64,
    full_load: Vec<Point>,
    idle_speed_rad_s: f64,
    load_share: f64,
    friction_pa: f64,
    #[serde(default)]
    friction_rise_pa_s2: f64,
    willans_efficiency: Option<f64>,
    fuel_map: Option<FuelMap>,
    lower_heating_value_j_kg: f64,
    fuel_density_kg_m3: f64,
    carbon_dioxide: f64,
    #[serde(default)]
    droop: f64,
    #[serde(default = "one")]
    unboosted_share: f64,
    #[serde(default = "one")]
    boost_time_s: f64,
    accessory_power_w: f64,
    #[serde(default)]
    pump_torque_n_m: f64,
    #[serde(default)]
    fan_power_w: f64,
    alternator_efficiency: f64,
    #[serde(skip)]
    curve: FullLoad,
}

const fn one() -> f64 {
    1.0
}

/// What is asked of an engine beside power.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Circumstance {
    /// Boost, 0 to 1.
    pub boost: f64,
    /// Friction beside its own [N m].
    pub friction_n_m: f64,
    /// Speed of a hand throttle [rad/s]; 0 where there is none.
    pub hand_rad_s: f64,
}

/// What an engine does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Running {
    pub speed_rad_s: f64,
    /// Power at the shaft, accessories included.
    pub shaft_w: f64,
    pub accessories_w: f64,
    pub fuel_w: f64,
    pub boost_per_s: f64,
}

impl Running {
    /// Torque at the shaft.
    pub fn torque_n_m(&self) -> f64 {
        if self.speed_rad_s > 0.0 { self.shaft_w / self.speed_rad_s } else { 0.0 }
    }

    /// What the engine turns into heat.
    pub fn heat_w(&self) -> f64 {
        self.fuel_w - self.shaft_w
    }
}

impl Engine {
    /// Checks what is told of it.
    ///
    /// # Errors
    /// [`Refusal`] by the full name of the parameter.
    pub(crate) fn settle(&mut self) -> Result<(), Refusal> {
        let values = [
            ("displacement_m3", self.displacement_m3),
            ("idle_speed_rad_s", self.idle_speed_rad_s),
            ("load_share", self.load_share),
            ("friction_pa", self.friction_pa),
            ("friction_rise_pa_s2", self.friction_rise_pa_s2),
            ("willans_efficiency", self.willans_efficiency.unwrap_or(1.0)),
            ("lower_heating_value_j_kg", self.lower_heating_value_j_kg),
            ("fuel_density_kg_m3", self.fuel_density_kg_m3),
            ("carbon_dioxide", self.carbon_dioxide),
            ("droop", self.droop),
            ("unboosted_share", self.unboosted_share),
            ("boost_time_s", self.boost_time_s),
            ("accessory_power_w", self.accessory_power_w),
            ("pump_torque_n_m", self.pump_torque_n_m),
            ("fan_power_w", self.fan_power_w),
            ("alternator_efficiency", self.alternator_efficiency),
        ];
        hold(&ENGINE, &values)?;
        self.curve = FullLoad::new(&self.full_load, self.idle_speed_rad_s)
            .map_err(|refusal| Refusal { parameter: format!("engine.{}", refusal.parameter), ..refusal })?;
        match (&self.fuel_map, self.willans_efficiency) {
            (Some(map), None) => self.check_map(map),
            (None, Some(_)) => Ok(()),
            (Some(_), Some(_)) => {
                Err(refuse("engine.fuel_map", "given beside `willans_efficiency`", "one of the two"))
            }
            (None, None) => Err(refuse("engine", "without fuel", "`willans_efficiency` or `fuel_map`")),
        }
    }

    fn check_map(&self, map: &FuelMap) -> Result<(), Refusal> {
        increasing("engine.fuel_map.speeds_rad_s", &map.speeds_rad_s, 2)?;
        increasing("engine.fuel_map.torques_n_m", &map.torques_n_m, 2)?;
        let rows = map.rates_kg_s.len();
        if rows != map.speeds_rad_s.len()
            || map.rates_kg_s.iter().any(|row| row.len() != map.torques_n_m.len())
        {
            let found = format!(
                "{rows} lists of {:?} rates",
                map.rates_kg_s.iter().map(Vec::len).collect::<Vec<_>>()
            );
            let expected = format!("{} lists of {} rates", map.speeds_rad_s.len(), map.torques_n_m.len());
            return Err(refuse("engine.fuel_map.rates_kg_s", found, &expected));
        }
        if let Some(rate) = map.rates_kg_s.iter().flatten().find(|rate| !(rate.is_finite() && **rate >= 0.0))
        {
            return Err(refuse("engine.fuel_map.rates_kg_s", rate, "0 or more"));
        }
        let (first, last) = (map.speeds_rad_s[0], map.speeds_rad_s[map.speeds_rad_s.len() - 1]);
        if first > self.idle_speed_rad_s || last < self.curve.last_speed() {
            let expected = format!(
                "speeds from {} to {} at least, from idle to the end of `full_load`: nothing is extrapolated",
                self.idle_speed_rad_s,
                self.curve.last_speed()
            );
            return Err(refuse("engine.fuel_map.speeds_rad_s", format!("{first} to {last}"), &expected));
        }
        let most = self.full_load.iter().map(|point| point.torque_n_m).fold(0.0, f64::max);
        let (least, greatest) = (map.torques_n_m[0], map.torques_n_m[map.torques_n_m.len() - 1]);
        if least != 0.0 || greatest < most {
            let expected = format!("torques from 0 to {most} at least, the most of `full_load`");
            return Err(refuse("engine.fuel_map.torques_n_m", format!("{least} to {greatest}"), &expected));
        }
        Ok(())
    }

    pub(crate) fn heating_value_j_kg(&self) -> f64 {
        self.lower_heating_value_j_kg
    }

    pub(crate) fn idle_rad_s(&self) -> f64 {
        self.idle_speed_rad_s
    }

    pub(crate) fn load_share(&self) -> f64 {
        self.load_share
    }

    pub(crate) fn last_rad_s(&self) -> f64 {
        self.curve.last_speed()
    }

    pub(crate) fn full_torque_n_m(&self, speed: f64) -> f64 {
        self.curve.torque(speed)
    }

    /// Shaft power that electric consumers take through the alternator.
    pub(crate) fn alternator_w(&self, electric_w: f64) -> f64 {
        electric_w / self.alternator_efficiency
    }

    /// Rates of burnt volume [m³/s] and carbon dioxide [kg/s].
    pub(crate) fn burnt(&self, fuel_w: f64) -> (f64, f64) {
        let rate = fuel_w / self.lower_heating_value_j_kg;
        (rate / self.fuel_density_kg_m3, rate * self.carbon_dioxide)
    }

    /// Power of friction at a speed.
    pub(crate) fn friction_w(&self, speed: f64, more_n_m: f64) -> f64 {
        let pressure = self.friction_pa + self.friction_rise_pa_s2 * speed * speed;
        (pressure * self.displacement_m3 / (4.0 * PI) + more_n_m).max(0.0) * speed
    }

    /// Power of the accessories at a speed.
    pub(crate) fn accessories_w(&self, speed: f64) -> f64 {
        let others_w = self.accessory_power_w + self.pump_torque_n_m * speed;
        if self.fan_power_w == 0.0 {
            return others_w;
        }
        others_w + self.fan_power_w * (speed / self.curve.peak_speed()).powi(3)
    }

    /// The share of the full-load torque that smoke and boost allow.
    pub(crate) fn limit(&self, boost: f64) -> f64 {
        self.unboosted_share + (1.0 - self.unboosted_share) * boost.clamp(0.0, 1.0)
    }

    /// Power of the fuel at a speed and a power of the shaft.
    pub(crate) fn fuel_w(&self, speed: f64, shaft_w: f64, more_n_m: f64) -> f64 {
        let Some(map) = &self.fuel_map else {
            let willans = self.willans_efficiency.unwrap_or(1.0);
            return ((shaft_w + self.friction_w(speed, more_n_m)) / willans).max(0.0);
        };
        if speed <= 0.0 {
            return 0.0;
        }
        let torque = shaft_w / speed + more_n_m;
        let (row, along) = place(&map.speeds_rad_s, speed);
        let at = |torque: f64| {
            let (column, across) = place(&map.torques_n_m, torque);
            let of = |row: &[f64]| row[column] + across * (row[column + 1] - row[column]);
            let (one, two) = (of(&map.rates_kg_s[row]), of(&map.rates_kg_s[row + 1]));
            one + along * (two - one)
        };
        // Below no torque the map is carried on to where friction alone turns the engine.
        let own = self.friction_w(speed, 0.0) / speed;
        let rate = if torque >= 0.0 { at(torque) } else { at(0.0) * (1.0 + torque / own).max(0.0) };
        rate * self.lower_heating_value_j_kg
    }

    /// The most power beside accessories.
    pub(crate) fn most_w(&self, at: &Circumstance) -> f64 {
        let (limit, speed) = (self.limit(at.boost), self.peak_rad_s(at));
        limit * self.curve.torque(speed) * speed - self.accessories_w(speed)
    }

    fn peak_rad_s(&self, at: &Circumstance) -> f64 {
        if at.hand_rad_s > 0.0 { at.hand_rad_s } else { self.curve.peak_speed() }
    }

    /// The same where it may not turn slower than a speed.
    pub(crate) fn most_from_w(&self, least_rad_s: f64, at: &Circumstance) -> f64 {
        if least_rad_s > self.peak_rad_s(at) {
            let most = self.limit(at.boost) * self.curve.torque(least_rad_s) * least_rad_s;
            return most - self.accessories_w(least_rad_s);
        }
        self.most_w(at)
    }

    /// The least power beside accessories: what brakes the most.
    pub(crate) fn least_w(&self, at: &Circumstance) -> f64 {
        let speed = if at.hand_rad_s > 0.0 { at.hand_rad_s } else { self.curve.last_speed() };
        -self.friction_w(speed, at.friction_n_m) - self.accessories_w(speed)
    }

    /// The speed that the controller chooses for a power beside accessories.
    pub(crate) fn speed_rad_s(&self, net_w: f64, at: &Circumstance) -> f64 {
        self.speeds_rad_s(at)(net_w)
    }

    /// The same for many powers: what does not hang on them is worked out once.
    #[inline]
    pub(crate) fn speeds_rad_s(&self, at: &Circumstance) -> impl Fn(f64) -> f64 {
        let Circumstance { hand_rad_s, friction_n_m, boost } = *at;
        let takes = move |speed: f64| self.friction_w(speed, friction_n_m) + self.accessories_w(speed);
        let (idle, last) = (self.idle_speed_rad_s, self.curve.last_speed());
        let idle_w = takes(idle);
        let share = self.load_share.min(self.limit(boost));
        let fan =
            if self.fan_power_w == 0.0 { 0.0 } else { self.fan_power_w / self.curve.peak_speed().powi(3) };
        move |net_w| {
            if hand_rad_s > 0.0 {
                let load = net_w / (self.curve.torque(hand_rad_s) * hand_rad_s);
                let speed = hand_rad_s * (1.0 + self.droop * (1.0 - load.clamp(0.0, 1.0)));
                return speed.min(last.max(hand_rad_s));
            }
            if net_w + idle_w < 0.0 {
                return crossing(last, idle, |speed| -net_w - takes(speed));
            }
            self.curve.speed_for(share, [self.accessory_power_w + net_w, self.pump_torque_n_m, fan])
        }
    }

    /// What it does to give a power beside accessories at a speed.
    pub(crate) fn run_at(&self, speed_rad_s: f64, net_w: f64, at: &Circumstance) -> Running {
        let accessories_w = self.accessories_w(speed_rad_s);
        let shaft_w = net_w + accessories_w;
        let fuel_w = self.fuel_w(speed_rad_s, shaft_w, at.friction_n_m);
        let full_w = self.curve.torque(speed_rad_s) * speed_rad_s;
        let load = if full_w > 0.0 { (shaft_w / full_w).clamp(0.0, 1.0) } else { 0.0 };
        let time_s = self.boost_time_s * self.curve.peak_speed() / speed_rad_s;
        Running { speed_rad_s, shaft_w, accessories_w, fuel_w, boost_per_s: (load - at.boost) / time_s }
    }

    /// What it does to give a power beside accessories, at the speed that the controller chooses.
    pub(crate) fn run(&self, net_w: f64, at: &Circumstance) -> Running {
        self.run_at(self.speed_rad_s(net_w, at), net_w, at)
    }

    /// What it does while it stands still.
    pub(crate) fn stopped(&self, at: &Circumstance) -> Running {
        Running { boost_per_s: -at.boost / self.boost_time_s, ..Running::default() }
    }
}

#[cfg(test)]
#[path = "engine_tests.rs"]
pub(crate) mod tests;
