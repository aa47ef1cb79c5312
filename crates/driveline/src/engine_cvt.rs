//! A combustion engine behind an ideal continuously variable transmission.
//!
//! p_me = e p_mf − p_me0                    Willans line; p_me = 4π T / V_d, p_mf = 4π H ṁ / (ω V_d), four strokes
//! P_e  = F v / η   + P_acc + P_alt + P_shaft     driving
//! P_e  = F v · η   + P_acc + P_alt + P_shaft     overrun (F v < 0)
//! ω    = the lowest speed from idle on with λ T_full(ω) ω ≥ P_e
//!
//! Source: Guzzella and Onder, *Introduction to Modeling and Control of Internal Combustion Engine Systems* (2010),
//! section 2.5, for the Willans line; Renius, *Fundamentals of Tractor Design* (2020), chapter 5, for the operating line.
//!
//! The transmission has every ratio and one efficiency. The operating line is the share λ of the full-load torque; more
//! power than it gives is drawn at the speed of the greatest power, up to full load. Overrun that friction at idle speed
//! can take is fuelled by the Willans line; beyond, fuel is cut off and the engine turns as fast as its friction has to,
//! at most as fast as the full-load curve reaches: that limits engine braking. In neutral and at rest the engine idles
//! or serves the other consumers. These are always served, beyond full load if need be; the wheels get what is left.
//! A speed at which the driver keeps the engine is kept as far as idle and the full-load curve reach; the wheels then get
//! what full load gives at that speed.
//! Leaves out engine dynamics, speed-dependent efficiency, losses without load and limits of the ratio.

use crate::full_load::{FullLoad, Point};
use headland_plugin::{
    Bound, Card, Delivery, Demand, Driveline, Plugin, Readings, Refusal, Shaft, parameter,
};
use serde::Deserialize;
use std::f64::consts::PI;
use std::path::Path;

/// An engine that a transmission without steps keeps on its operating line.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EngineCvt {
    displacement_m3: f64,
    willans_efficiency: f64,
    willans_friction_pa: f64,
    lower_heating_value_j_kg: f64,
    full_load: Vec<Point>,
    idle_speed_rad_s: f64,
    load_share: f64,
    transmission_efficiency: f64,
    max_force_n: f64,
    accessory_power_w: f64,
    alternator_efficiency: f64,
    wheel_radius_m: f64,
    rotating_mass_kg: f64,
    #[serde(skip)]
    curve: FullLoad,
}

impl Plugin for EngineCvt {
    const CARD: Card = Card {
        name: "EngineCvt",
        about: "a four-stroke engine by its Willans line behind an ideal continuously variable transmission",
        equation: "p_me = e p_mf − p_me0; P_e = F v η^(∓1) + P_acc + P_alt + P_shaft; λ T_full(ω) ω = P_e",
        source: "Guzzella and Onder, Introduction to Modeling and Control of Internal Combustion Engine Systems (2010), \
                 section 2.5; Renius, Fundamentals of Tractor Design (2020), chapter 5; usual values from memory",
        validity: "quasi-steady; leaves out turbo lag, shifts, losses without load and limits of the ratio",
        parameters: &[
            parameter("displacement_m3", "m³", "swept volume, V_d")
                .must_be(Bound::Positive)
                .usually(5e-4, 0.03),
            parameter("willans_efficiency", "1", "slope of the Willans line, e")
                .must_be(Bound::Efficiency)
                .usually(0.3, 0.5),
            parameter("willans_friction_pa", "Pa", "mean effective pressure of friction, p_me0")
                .must_be(Bound::Positive)
                .usually(0.4e5, 2.5e5),
            parameter("lower_heating_value_j_kg", "J/kg", "of the fuel, H")
                .must_be(Bound::Positive)
                .usually(2.6e7, 5e7),
            parameter(
                "full_load",
                "[(speed_rad_s, torque_n_m)]",
                "greatest torque by speed, two points or more, T_full",
            ),
            parameter("idle_speed_rad_s", "rad/s", "lowest speed")
                .must_be(Bound::Positive)
                .usually(60.0, 115.0),
            parameter("load_share", "1", "operating line as a share of the full-load torque, λ")
                .must_be(Bound::Efficiency)
                .usually(0.6, 1.0),
            parameter("transmission_efficiency", "1", "engine to wheels, η")
                .must_be(Bound::Efficiency)
                .usually(0.7, 0.97),
            parameter("max_force_n", "N", "greatest force at the wheels, driving or braking")
                .must_be(Bound::Positive)
                .usually(1e3, 3e5),
            parameter("accessory_power_w", "W", "fan, pumps and compressor, at all times, P_acc")
                .must_be(Bound::NotNegative)
                .usually(0.0, 3e4),
            parameter("alternator_efficiency", "1", "shaft to electric consumers")
                .must_be(Bound::Efficiency)
                .usually(0.5, 0.97),
            parameter("wheel_radius_m", "m", "rolling radius, for the ratio shown")
                .must_be(Bound::Positive)
                .usually(0.2, 1.2),
            parameter("rotating_mass_kg", "kg", "inertia of what turns with the wheels, as mass")
                .must_be(Bound::NotNegative)
                .usually(0.0, 3000.0),
        ],
    };

    fn settle(&mut self, _: &Path) -> Result<(), Refusal> {
        self.curve = FullLoad::new(&self.full_load, self.idle_speed_rad_s)?;
        Ok(())
    }
}

/// What the engine does to serve a power at its shaft.
struct Engine {
    speed: f64,
    fuel_power: f64,
}

impl EngineCvt {
    /// Power of friction at an engine speed: (p_me0 V_d / 4π + T_extra) ω.
    fn friction_w(&self, speed: f64, extra_n_m: f64) -> f64 {
        (self.willans_friction_pa * self.displacement_m3 / (4.0 * PI) + extra_n_m).max(0.0) * speed
    }

    /// The speed at which the driver keeps the engine; idle speed where the transmission chooses.
    fn least_speed(&self, kept: f64) -> f64 {
        kept.clamp(self.idle_speed_rad_s, self.curve.last_speed())
    }

    fn engine(&self, power: f64, extra_n_m: f64, kept: f64) -> Engine {
        let least_speed = self.least_speed(kept);
        let least_friction = self.friction_w(least_speed, extra_n_m);
        if power < -least_friction {
            // Fuel is cut off and friction takes what the wheels give.
            return Engine { speed: least_speed * (-power / least_friction), fuel_power: 0.0 };
        }
        let speed = if kept > 0.0 { least_speed } else { self.curve.lowest_speed(power / self.load_share) };
        // The Willans line times V_d ω / 4π, solved for the power of the fuel.
        Engine { speed, fuel_power: (power + self.friction_w(speed, extra_n_m)) / self.willans_efficiency }
    }

    /// The force of those asked for that engine and transmission can make, with `others` taken from the shaft.
    fn force_n(&self, demand: &Demand, others: f64) -> f64 {
        if demand.coasting {
            return 0.0;
        }
        let (v, eta) = (demand.speed_m_s, self.transmission_efficiency);
        let force = demand.force_n.clamp(-self.max_force_n, self.max_force_n);
        let power = force * v;
        let kept = demand.engine_speed_rad_s;
        let full = if demand.recorded {
            f64::INFINITY
        } else if kept > 0.0 {
            self.curve.power(self.least_speed(kept))
        } else {
            self.curve.peak_power()
        };
        let most = eta * (full - others).max(0.0);
        let friction = self.friction_w(self.curve.last_speed(), demand.engine_friction_n_m);
        let least = -(friction + others) / eta;
        if power > most {
            most / v
        } else if power < least {
            least / v
        } else {
            force
        }
    }
}

impl Driveline for EngineCvt {
    fn losses(&self) -> &'static [&'static str] {
        &["engine heat", "transmission", "accessories"]
    }

    fn source(&self) -> &'static str {
        "fuel"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        self.rotating_mass_kg
    }

    fn deliver(&self, demand: &Demand, _: &[f64], _: &mut [f64]) -> Delivery {
        let alternator = demand.auxiliary_power_w / self.alternator_efficiency;
        let others = self.accessory_power_w + alternator + demand.shaft_power_w;
        let force_n = self.force_n(demand, others);
        let wheels = force_n * demand.speed_m_s;
        let eta = self.transmission_efficiency;
        let transmission_input = if wheels > 0.0 { wheels / eta } else { wheels * eta };
        let power = transmission_input + others;
        let Engine { speed, fuel_power } =
            self.engine(power, demand.engine_friction_n_m, demand.engine_speed_rad_s);

        let mut delivery = Delivery { force_n, source_power_w: fuel_power, ..Delivery::NOTHING };
        delivery.losses_w[0] = fuel_power - power;
        delivery.losses_w[1] = transmission_input - wheels;
        delivery.losses_w[2] = self.accessory_power_w + (alternator - demand.auxiliary_power_w);
        let wheel_speed = demand.speed_m_s / self.wheel_radius_m;
        delivery.readings = Readings {
            engine_speed_rad_s: speed,
            engine_torque_n_m: power / speed,
            fuel_rate_kg_s: fuel_power / self.lower_heating_value_j_kg,
            cvt_ratio: if demand.coasting || wheel_speed == 0.0 { f64::NAN } else { speed / wheel_speed },
            ..Readings::NONE
        };
        delivery
    }

    fn force_of_shaft_n(&self, shaft: &Shaft) -> Option<f64> {
        let others = self.accessory_power_w
            + shaft.auxiliary_power_w / self.alternator_efficiency
            + shaft.shaft_power_w;
        let power = shaft.torque_n_m * shaft.speed_rad_s - others;
        let eta = self.transmission_efficiency;
        let force = (if power > 0.0 { power * eta } else { power / eta }) / shaft.wheel_speed_m_s;
        // Beyond the greatest force, as at a standstill, a clutch takes the power and not the wheels.
        (force.abs() <= self.max_force_n).then_some(force)
    }
}

#[cfg(test)]
#[path = "engine_cvt_tests.rs"]
mod tests;
