//! Power split: a planetary shares the engine's torque between a generator and the wheels, where a motor adds its own.
//!
//! ω_s = (1 + k) ω_e − k ω_r                engine on the carrier, generator on the sun, wheels behind the ring
//! T_s = T_c / (1 + k),   T_r = k T_c / (1 + k),   T_c = (P_e − P_shaft) / ω_e
//! T_out = T_r + i_m T_m = F r / (i_f η^(±1)),   ω_r = i_f v / r,   P_b = P_el,m − P_el,g + consumers
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.2 (planetary by Willis).
//!
//! The engine turns as slowly as its power allows, within what the generator's highest speed leaves. A stopped engine holds
//! the carrier; the power take-off, on the carrier, is then turned at idle speed behind a clutch. The planetary itself loses
//! nothing. Leaves out what starting the engine takes.

use crate::engine::{ENGINE, Engine};
use crate::hybrid::{Asked, CONSUMERS, Consumers, Flow, Topology};
use crate::motor::{Motor, machine};
use crate::parts::{hold, join};
use crate::store::{BATTERY, BatteryFile, SUPERCAPACITOR, Store, SupercapacitorFile};
use headland_plugin::{Bound, Card, Parameter, Refusal, State, parameter};
use serde::Deserialize;

const MOTOR: [Parameter; crate::motor::COUNT] = machine!("motor");
const GENERATOR: [Parameter; crate::motor::COUNT] = machine!("generator");
const OWN: [Parameter; 6] = [
    parameter("planetary_ratio", "1", "teeth of the ring over those of the sun, k")
        .must_be(Bound::Positive)
        .usually(1.5, 4.0),
    parameter("motor_ratio", "1", "motor speed over ring speed, i_m")
        .must_be(Bound::Positive)
        .usually(0.5, 10.0),
    parameter("final_ratio", "1", "ring speed over wheel speed, i_f")
        .must_be(Bound::Positive)
        .usually(2.0, 80.0),
    parameter("gear_efficiency", "1", "ring to wheels, η").must_be(Bound::Efficiency).usually(0.85, 0.99),
    parameter("wheel_radius_m", "m", "rolling radius, r").must_be(Bound::Positive).usually(0.2, 1.2),
    parameter("rotating_mass_kg", "kg", "inertia of rotor, gears and wheels, as mass")
        .must_be(Bound::NotNegative)
        .usually(0.0, 5000.0),
];
const COUNT: usize = ENGINE.len()
    + MOTOR.len()
    + GENERATOR.len()
    + OWN.len()
    + BATTERY.len()
    + SUPERCAPACITOR.len()
    + CONSUMERS.len();
const PARAMETERS: [Parameter; COUNT] =
    join(&[&ENGINE, &MOTOR, &GENERATOR, &OWN, &BATTERY, &SUPERCAPACITOR, &CONSUMERS]);

/// Engine, generator and wheels at a planetary.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "PowerSplitHybrid")]
pub struct PowerSplit {
    engine: Engine,
    motor: Motor,
    generator: Motor,
    planetary_ratio: f64,
    motor_ratio: f64,
    final_ratio: f64,
    gear_efficiency: f64,
    wheel_radius_m: f64,
    rotating_mass_kg: f64,
    battery: Option<BatteryFile>,
    supercapacitor: Option<SupercapacitorFile>,
    standby_power_w: f64,
    converter_efficiency: f64,
    #[serde(skip)]
    store: Store,
}

/// A torque beyond a limit is weighed as power at this speed more, so that it counts at rest too [rad/s].
const WEIGHING_RAD_S: f64 = 10.0;

/// What turns at a speed and flows for a force, whatever the engine does.
#[derive(Clone, Copy)]
struct Wheels {
    ring_rad_s: f64,
    /// Torque and power that go out to the wheels behind the ring.
    out_n_m: f64,
    out_w: f64,
    motor_rad_s: f64,
}

/// What turns and what flows behind the carrier of the planetary.
struct Turned {
    sun_rad_s: f64,
    sun_n_m: f64,
    motor_n_m: f64,
    motor_loss_w: f64,
    generator_loss_w: f64,
    bus_w: f64,
}

impl PowerSplit {
    fn wheels(&self, speed_m_s: f64, force_n: f64) -> Wheels {
        let ring_rad_s = self.ring_rad_s(speed_m_s);
        let gear = if force_n >= 0.0 { 1.0 / self.gear_efficiency } else { self.gear_efficiency };
        let out_n_m = force_n * self.wheel_radius_m / self.final_ratio * gear;
        Wheels {
            ring_rad_s,
            out_n_m,
            out_w: out_n_m * ring_rad_s,
            motor_rad_s: self.motor_ratio * ring_rad_s,
        }
    }

    /// For a power that goes through the carrier at its speed.
    #[inline]
    fn turned(&self, wheels: Wheels, (through_w, carrier): (f64, f64)) -> Turned {
        let k = self.planetary_ratio;
        let torque = if carrier > 0.0 { through_w / carrier } else { 0.0 };
        let sun_rad_s = (1.0 + k) * carrier - k * wheels.ring_rad_s;
        let sun_n_m = torque * (1.0 / (1.0 + k));
        let generated_w = sun_n_m * sun_rad_s;
        let motor_n_m = (wheels.out_n_m - k * sun_n_m) * (1.0 / self.motor_ratio);
        let motor_loss_w = self.motor.loss_w(motor_n_m, wheels.motor_rad_s);
        let generator_loss_w = self.generator.loss_w(sun_n_m, sun_rad_s);
        Turned {
            sun_rad_s,
            sun_n_m,
            motor_n_m,
            motor_loss_w,
            generator_loss_w,
            bus_w: motor_n_m * wheels.motor_rad_s + motor_loss_w - generated_w + generator_loss_w,
        }
    }

    fn ring_rad_s(&self, speed_m_s: f64) -> f64 {
        self.final_ratio * speed_m_s / self.wheel_radius_m
    }

    /// The lowest and the highest speed of the engine that the generator can turn with.
    fn carried_rad_s(&self, ring: f64) -> (f64, f64) {
        let (k, most) = (self.planetary_ratio, self.generator.max_rad_s());
        ((k * ring - most) / (1.0 + k), (k * ring + most) / (1.0 + k))
    }
}

impl Topology for PowerSplit {
    const CARD: Card = Card {
        name: "PowerSplitHybrid",
        about: "a planetary between engine, generator and wheels, and a motor at the wheels, with a battery or a supercapacitor",
        equation: "ω_s = (1 + k) ω_e − k ω_r; T_s = T_c / (1 + k); T_r = k T_c / (1 + k); T_c = (P_e − P_shaft) / ω_e; \
                   T_r + i_m T_m = F r / (i_f η^(±1)); P_el = T ω + k_c T² + k_i ω + k_w ω³ + k_0; \
                   I = (U − √(U² − 4 R P)) / (2 R); dS/dt = −I / (3600 Q)",
        source: "Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), sections 4.2, 4.4 and 4.5; usual values of engine, \
                 machines, battery and gears from memory",
        validity: "with a management; quasi-steady; one range; leaves out losses of the planetary, starts of the engine, ageing and \
                   temperature of the battery",
        parameters: &PARAMETERS,
    };
    const HAS_GENERATOR: bool = true;
    const OWN_STATES: usize = 1;

    fn settle(&mut self) -> Result<(), Refusal> {
        self.engine.settle()?;
        self.motor.settle("motor", &MOTOR)?;
        self.generator.settle("generator", &GENERATOR)?;
        let own = [
            ("planetary_ratio", self.planetary_ratio),
            ("motor_ratio", self.motor_ratio),
            ("final_ratio", self.final_ratio),
            ("gear_efficiency", self.gear_efficiency),
            ("wheel_radius_m", self.wheel_radius_m),
        ];
        hold(&OWN, &own)?;
        self.store = Store::new(self.battery.as_ref(), self.supercapacitor.as_ref())?;
        Ok(())
    }

    fn engine(&self) -> &Engine {
        &self.engine
    }

    fn store(&self) -> &Store {
        &self.store
    }

    fn consumers(&self) -> Consumers {
        Consumers { standby_w: self.standby_power_w, converter_efficiency: self.converter_efficiency }
    }

    fn coolant_c(&self) -> f64 {
        self.motor.coolant_c()
    }

    fn own_states(&self) -> Vec<State> {
        vec![State { name: "generator_temperature_c", initial: self.generator.coolant_c() }]
    }

    fn rotating_mass_kg(&self) -> f64 {
        self.rotating_mass_kg
    }

    fn most_force_n(&self, asked: &Asked) -> (f64, f64) {
        let ring = self.ring_rad_s(asked.speed_m_s);
        let motor = self.motor.limit_n_m(self.motor_ratio * ring, asked.motor_c) * self.motor_ratio;
        let k = self.planetary_ratio;
        let carrier = (1.0 + k) * self.generator.limit_n_m(0.0, asked.own[0]);
        let force = |torque: f64| torque * self.final_ratio / self.wheel_radius_m;
        // In neutral of the planetary the engine cannot brake: only the motor does.
        (force(motor) / self.gear_efficiency, force(motor + k / (1.0 + k) * carrier) * self.gear_efficiency)
    }

    fn flow(&self, asked: &Asked, force_n: f64, engine_w: Option<f64>) -> Flow {
        let Asked { demand, speed_m_s, at, motor_c, own } = *asked;
        let wheels = self.wheels(speed_m_s, force_n);
        let (running, carrier) = match engine_w {
            Some(engine_w) => {
                let (least, most) = self.carried_rad_s(wheels.ring_rad_s);
                let speed = self.engine.speed_rad_s(engine_w, &at).max(least).min(most);
                (self.engine.run_at(speed, engine_w, &at), speed)
            }
            None if demand.shaft_power_w == 0.0 => (self.engine.stopped(&at), 0.0),
            None if at.hand_rad_s > 0.0 => (self.engine.stopped(&at), at.hand_rad_s),
            None => (self.engine.stopped(&at), self.engine.idle_rad_s()),
        };
        let through_w = engine_w.unwrap_or(0.0) - demand.shaft_power_w;
        let turned = self.turned(wheels, (through_w, carrier));
        let Turned { sun_n_m, motor_n_m, motor_loss_w, generator_loss_w, .. } = turned;
        let motor_rad_s = wheels.motor_rad_s;
        let limit = self.motor.limit_n_m(motor_rad_s, motor_c);
        let holds = self.generator.limit_n_m(turned.sun_rad_s, own[0]);
        let weigh = WEIGHING_RAD_S + motor_rad_s;
        Flow {
            running,
            bus_w: turned.bus_w,
            asked_w: ((motor_n_m - limit) * weigh).max((-sun_n_m - holds) * weigh),
            pushed_w: ((-motor_n_m - limit) * weigh).max((sun_n_m - holds) * weigh),
            transmission_w: wheels.out_w - force_n * speed_m_s,
            motor_loss_w,
            generator_loss_w,
            motor_rad_s,
            motor_n_m,
            motor_warming_k_s: self.motor.warming_k_s(motor_loss_w, motor_c),
            own_rates: [self.generator.warming_k_s(generator_loss_w, own[0]), 0.0],
            cvt_ratio: f64::NAN,
        }
    }

    fn bus_w(&self, asked: &Asked, force_n: f64) -> impl Fn(f64) -> f64 {
        let wheels = self.wheels(asked.speed_m_s, force_n);
        let (least, most) = self.carried_rad_s(wheels.ring_rad_s);
        let (shaft_w, speed_rad_s) = (asked.demand.shaft_power_w, self.engine.speeds_rad_s(&asked.at));
        move |engine_w| {
            let carrier = speed_rad_s(engine_w).max(least).min(most);
            self.turned(wheels, (engine_w - shaft_w, carrier)).bus_w
        }
    }
}
