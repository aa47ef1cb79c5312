//! Parallel hybrid: a motor on the shaft of the engine, in front of a hydrostatic-mechanical transmission.
//!
//! P_e + P_m = P_in + P_shaft,   ω_m = i_m ω
//!
//! Source: Guzzella and Sciarretta, *Vehicle Propulsion Systems* (2013), section 4.2; parts as in their own files.
//!
//! A clutch parts a stopped engine from the shaft; motor, power take-off and transmission then turn as slowly as the motor
//! can give the power, at least at the engine's idle speed. Leaves out what starting the engine takes.

use crate::engine::{ENGINE, Engine};
use crate::hybrid::{Asked, CONSUMERS, Consumers, Flow, Topology};
use crate::hydromechanical::{Hydromechanical, TRANSMISSION};
use crate::motor::{Motor, machine};
use crate::parts::{hold, join};
use crate::store::{BATTERY, BatteryFile, SUPERCAPACITOR, Store, SupercapacitorFile};
use headland_plugin::{Bound, Card, Parameter, Refusal, State, parameter};
use serde::Deserialize;

const MACHINES: [Parameter; crate::motor::COUNT] = machine!("motor");
const OWN: [Parameter; 1] = [parameter("motor_ratio", "1", "motor speed over engine speed, i_m")
    .must_be(Bound::Positive)
    .usually(0.5, 6.0)];
const COUNT: usize = ENGINE.len()
    + MACHINES.len()
    + OWN.len()
    + TRANSMISSION.len()
    + BATTERY.len()
    + SUPERCAPACITOR.len()
    + CONSUMERS.len();
const PARAMETERS: [Parameter; COUNT] =
    join(&[&ENGINE, &MACHINES, &OWN, &TRANSMISSION, &BATTERY, &SUPERCAPACITOR, &CONSUMERS]);

/// Engine and motor on one shaft.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename = "ParallelHybrid")]
pub struct Parallel {
    engine: Engine,
    motor: Motor,
    motor_ratio: f64,
    transmission: Hydromechanical,
    battery: Option<BatteryFile>,
    supercapacitor: Option<SupercapacitorFile>,
    standby_power_w: f64,
    converter_efficiency: f64,
    #[serde(skip)]
    store: Store,
}

const RANGE: usize = 0;
const SINCE: usize = 1;

/// A change of range takes 0.2 to 0.4 s; the next one has to wait for it.
const RANGE_TIME_S: f64 = 0.3;

/// Rounds in which the speed of the shaft and what is asked of the motor at it find each other.
const ROUNDS: usize = 2;

impl Topology for Parallel {
    const CARD: Card = Card {
        name: "ParallelHybrid",
        about: "an engine and a motor on one shaft in front of a hydrostatic-mechanical transmission, with a battery or a \
                supercapacitor",
        equation: "P_e + P_m = P_in + P_shaft; ω_m = i_m ω; P_el = T_m ω_m + k_c T_m² + k_i ω_m + k_w ω_m³ + k_0; \
                   I = (U − √(U² − 4 R P)) / (2 R); dS/dt = −I / (3600 Q); P_in as of `HydromechanicalCvt`",
        source: "Guzzella and Sciarretta, Vehicle Propulsion Systems (2013), sections 4.2, 4.4 and 4.5; usual values of engine, \
                 machines, battery and gears from memory",
        validity: "with a management; quasi-steady; leaves out starts of the engine, ageing and temperature of the battery",
        parameters: &PARAMETERS,
    };
    const HAS_GENERATOR: bool = false;
    const OWN_STATES: usize = 2;
    const CHOOSES: bool = true;

    fn settle(&mut self) -> Result<(), Refusal> {
        self.engine.settle()?;
        self.motor.settle("motor", &MACHINES)?;
        self.transmission.settle()?;
        hold(&OWN, &[("motor_ratio", self.motor_ratio)])?;
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
        vec![
            State { name: "transmission_range", initial: 0.0 },
            State { name: "since_range_s", initial: RANGE_TIME_S },
        ]
    }

    fn rotating_mass_kg(&self) -> f64 {
        self.transmission.rotating_mass_kg
    }

    fn most_force_n(&self, asked: &Asked) -> (f64, f64) {
        let least = self.transmission.least_engine_rad_s(asked.speed_m_s);
        let speed = self.engine.idle_rad_s().max(least);
        if least > self.engine.last_rad_s() {
            return (0.0, 0.0);
        }
        let (drives, brakes) = self.transmission.most_force_n(asked.own[RANGE], asked.speed_m_s, speed);
        (brakes, drives)
    }

    fn flow(&self, asked: &Asked, force_n: f64, engine_w: Option<f64>) -> Flow {
        let Asked { demand, speed_m_s, at, motor_c, own } = *asked;
        let least = if demand.coasting { 0.0 } else { self.transmission.least_engine_rad_s(speed_m_s) };
        let idle = if at.hand_rad_s > 0.0 { at.hand_rad_s } else { self.engine.idle_rad_s() };
        let chosen = engine_w.map_or(idle, |engine_w| self.engine.speed_rad_s(engine_w, &at)).max(least);
        let (mut shaft, mut input_w) = (chosen, 0.0);
        for round in 0..=ROUNDS {
            input_w = if demand.coasting {
                self.transmission.neutral_w(shaft)
            } else {
                self.transmission.through(own[RANGE], speed_m_s, force_n, shaft).input_w
            };
            if round < ROUNDS && at.hand_rad_s == 0.0 {
                // As fast as the motor has to turn for what the engine leaves to it.
                let motor_w = input_w + demand.shaft_power_w - engine_w.unwrap_or(0.0);
                let needed = self.motor.lowest_rad_s(motor_w) / self.motor_ratio;
                shaft = chosen.max(needed).min(self.engine.last_rad_s().max(least));
            }
        }
        let running = match engine_w {
            Some(engine_w) => self.engine.run_at(shaft, engine_w, &at),
            None => self.engine.stopped(&at),
        };
        let motor_w = input_w + demand.shaft_power_w - engine_w.unwrap_or(0.0);
        let motor_rad_s = self.motor_ratio * shaft;
        let motor_n_m = motor_w / motor_rad_s;
        let loss_w = self.motor.loss_w(motor_n_m, motor_rad_s);
        let limit_w = self.motor.limit_n_m(motor_rad_s, motor_c) * motor_rad_s;
        Flow {
            running,
            bus_w: motor_w + loss_w,
            asked_w: motor_w - limit_w,
            pushed_w: -motor_w - limit_w,
            transmission_w: input_w - force_n * speed_m_s,
            motor_loss_w: loss_w,
            motor_rad_s,
            motor_n_m,
            motor_warming_k_s: self.motor.warming_k_s(loss_w, motor_c),
            own_rates: [0.0, 1.0],
            cvt_ratio: if demand.coasting { f64::NAN } else { self.transmission.ratio(shaft, speed_m_s) },
            ..Flow::default()
        }
    }

    fn choose(&self, asked: &Asked, flow: &Flow, own: &mut [f64]) -> bool {
        if asked.demand.coasting || own[SINCE] < RANGE_TIME_S {
            return false;
        }
        let shaft = flow.motor_rad_s / self.motor_ratio;
        let range = self.transmission.choose(own[RANGE], asked.speed_m_s, shaft);
        if range == own[RANGE] {
            return false;
        }
        (own[RANGE], own[SINCE]) = (range, 0.0);
        true
    }
}
