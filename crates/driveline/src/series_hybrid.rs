//! Series hybrid: an engine that only drives a generator, and a motor that alone drives the wheels.
//!
//! P_e = P_g + P_shaft,   P_b = P_el,m − P_el,g + consumers,   ω_m = i v / r,   ω_g = i_g ω_e
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.2; parts as in their own files.
//!
//! The power take-off is on the shaft of engine and generator; with the engine stopped the generator drives it. Leaves out
//! what starting the engine takes.

use crate::engine::{ENGINE, Engine};
use crate::hybrid::{Asked, CONSUMERS, Consumers, Flow, Topology};
use crate::motor::{Motor, machine};
use crate::parts::{hold, join};
use crate::store::{BATTERY, BatteryFile, SUPERCAPACITOR, Store, SupercapacitorFile};
use headland_plugin::{Bound, Card, Parameter, Refusal, State, parameter};
use serde::Deserialize;

const MOTOR: [Parameter; crate::motor::COUNT] = machine!("motor");
const GENERATOR: [Parameter; crate::motor::COUNT] = machine!("generator");
const OWN: [Parameter; 5] = [
    parameter("generator_ratio", "1", "generator speed over engine speed, i_g")
        .must_be(Bound::Positive)
        .usually(0.5, 6.0),
    parameter("gear_ratio", "1", "motor speed over wheel speed, i")
        .must_be(Bound::Positive)
        .usually(5.0, 150.0),
    parameter("gear_efficiency", "1", "motor to wheels, η").must_be(Bound::Efficiency).usually(0.85, 0.99),
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

/// Engine and generator, motor and wheels.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "SeriesHybrid")]
pub struct Series {
    engine: Engine,
    motor: Motor,
    generator: Motor,
    generator_ratio: f64,
    gear_ratio: f64,
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

impl Series {
    fn leverage_per_m(&self) -> f64 {
        self.gear_ratio / self.wheel_radius_m
    }
}

impl Topology for Series {
    const CARD: Card = Card {
        name: "SeriesHybrid",
        about: "an engine that drives a generator, and a motor that drives the wheels, with a battery or a supercapacitor between",
        equation: "P_e = P_g + P_shaft; P_b = P_el,m − P_el,g + consumers; ω_m = i v / r; ω_g = i_g ω_e; \
                   P_el = T ω + k_c T² + k_i ω + k_w ω³ + k_0; I = (U − √(U² − 4 R P)) / (2 R); dS/dt = −I / (3600 Q)",
        source: "Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), sections 4.2, 4.4 and 4.5; usual values of engine, \
                 machines, battery and gears from memory",
        validity: "with a management; quasi-steady; leaves out starts of the engine, ageing and temperature of the battery",
        parameters: &PARAMETERS,
    };
    const HAS_GENERATOR: bool = true;
    const OWN_STATES: usize = 1;

    fn settle(&mut self) -> Result<(), Refusal> {
        self.engine.settle()?;
        self.motor.settle("motor", &MOTOR)?;
        self.generator.settle("generator", &GENERATOR)?;
        let own = [
            ("generator_ratio", self.generator_ratio),
            ("gear_ratio", self.gear_ratio),
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
        let torque = self.motor.limit_n_m(self.leverage_per_m() * asked.speed_m_s, asked.motor_c);
        let force = torque * self.leverage_per_m();
        (force / self.gear_efficiency, force * self.gear_efficiency)
    }

    fn flow(&self, asked: &Asked, force_n: f64, engine_w: Option<f64>) -> Flow {
        let Asked { demand, speed_m_s, at, motor_c, own } = *asked;
        let motor_rad_s = self.leverage_per_m() * speed_m_s;
        let gear = if force_n >= 0.0 { 1.0 / self.gear_efficiency } else { self.gear_efficiency };
        let motor_n_m = force_n / self.leverage_per_m() * gear;
        let motor_loss_w = self.motor.loss_w(motor_n_m, motor_rad_s);
        let motor_w = motor_n_m * motor_rad_s;

        let (running, shaft) = match engine_w {
            Some(engine_w) => {
                let running = self.engine.run(engine_w, &at);
                (running, running.speed_rad_s)
            }
            None if demand.shaft_power_w == 0.0 => (self.engine.stopped(&at), 0.0),
            // The generator drives the power take-off.
            None if at.hand_rad_s > 0.0 => (self.engine.stopped(&at), at.hand_rad_s),
            None => (self.engine.stopped(&at), self.engine.idle_rad_s()),
        };
        let generated_w = engine_w.unwrap_or(0.0) - demand.shaft_power_w;
        let generator_rad_s = self.generator_ratio * shaft;
        let (generator_loss_w, limit_w) = if shaft > 0.0 {
            let torque = generated_w / generator_rad_s;
            let limit = self.generator.limit_n_m(generator_rad_s, own[0]) * generator_rad_s;
            (self.generator.loss_w(torque, generator_rad_s), limit)
        } else {
            // Switched off.
            (0.0, f64::INFINITY)
        };
        Flow {
            running,
            bus_w: motor_w + motor_loss_w - generated_w + generator_loss_w,
            asked_w: -generated_w - limit_w,
            pushed_w: generated_w - limit_w,
            transmission_w: motor_w - force_n * speed_m_s,
            motor_loss_w,
            generator_loss_w,
            motor_rad_s,
            motor_n_m,
            motor_warming_k_s: self.motor.warming_k_s(motor_loss_w, motor_c),
            own_rates: [self.generator.warming_k_s(generator_loss_w, own[0]), 0.0],
            cvt_ratio: f64::NAN,
        }
    }
}
