//! A machine that a carriage moves: forces and powers of one instant, and one step.
//!
//! States of the models go on by Euler's rule from the rates of the step's first instant, as the carriage holds the forces
//! over the step too. Work is what forces do along the ways that the carriage tells.

use crate::Model;
use crate::balance::{Asked, Command, Given, Instant, Point, Rolled, Scratch, Sums, tell};
use crate::carriage::{Carriage, Motion, Push, Stepped};
use crate::ledger::{AIR, BRAKES, DRAWBAR, MASS_CHANGE, SLOPE, SOIL, Slots};
use crate::model::Layout;
use crate::step::{Control, FIRST_STATE, Machine, Moment, POSITION, SPEED, sign};
use crate::wheels::AxleState;
use headland_plugin::Demand;

/// What was asked of a carriage for the step to come.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Borne {
    push: Push,
    air_n: f64,
    /// Force of the driveline, of which effects take their shares [N].
    delivered_n: f64,
}

impl<'a> Machine<'a> {
    /// A machine that `carriage` moves; `driver` names what a driver remembers.
    pub fn on(model: &'a Model, carriage: Box<dyn Carriage + 'a>, driver: Option<&str>) -> Self {
        let motion = carriage.motion();
        let mut machine = match driver {
            Some(name) => Self::with_driver(model, name, motion.position_m, motion.speed_m_s),
            None => Self::new(model, 0.0, motion.position_m, motion.speed_m_s),
        };
        machine.carriage = Some(carriage);
        machine
    }

    /// The balance where the carriage stands.
    #[inline(never)]
    pub(crate) fn borne_instant(&mut self, control: &impl Control) -> Instant {
        let Some(carriage) = self.carriage.take() else {
            unreachable!("it is asked of machines on a carriage")
        };
        let motion = carriage.motion();
        let y = std::mem::take(&mut self.y);
        let mut slope = std::mem::take(&mut self.slopes[0]);
        let states = self.layout.states.len();
        let (position_m, speed_m_s) = (y[POSITION], y[SPEED]);
        let moment = Moment {
            time_s: self.time_s,
            position_m,
            speed_m_s,
            states: &y[FIRST_STATE..FIRST_STATE + states],
        };
        let (command, given) = control.at(&moment);
        let (_, rest) = slope.split_at_mut(FIRST_STATE);
        let (rates, powers) = rest.split_at_mut(states);
        if let Some(driver) = self.layout.driver {
            rates[driver] = given.driver_rate;
        }
        let point = Point { time_s: self.time_s, position_m, speed_m_s, direction: sign(speed_m_s) };
        let (instant, borne) = self.model.borne(
            (&motion, point, self.borne.delivered_n),
            command,
            &given,
            (&self.layout, &self.slots),
            moment.states,
            rates,
            powers,
            &mut self.scratch,
        );
        let axles = self.model.axles.as_ref().map_or(0, |axles| axles.list().len());
        self.scratch.wheels.axles.clear();
        self.scratch.wheels.axles.extend((0..axles).map(|index| {
            let axle = carriage.axle(index);
            AxleState {
                place: motion.place,
                load_n: axle.load_n,
                slip: axle.slip,
                traction_n: axle.traction_n,
                resistance_n: axle.resistance_n,
                sinkage_m: axle.sinkage_m,
            }
        }));
        self.first_kinetic_j.get_or_insert_with(|| carriage.kinetic_j());
        (self.y, self.slopes[0], self.borne) = (y, slope, borne);
        self.carriage = Some(carriage);
        instant
    }

    /// As [`Machine::step`], by the carriage. What ends a phase is foreseen from speed and acceleration, so a step ends
    /// there to within the change of acceleration along it. Where the carriage makes no step, none is taken.
    #[inline(never)]
    pub(crate) fn borne_step(&mut self, step_s: f64, event: &dyn Fn(&Moment) -> f64) -> f64 {
        let Some(mut carriage) = self.carriage.take() else {
            unreachable!("it is asked of machines on a carriage")
        };
        let taken = self.foreseen(step_s, carriage.motion().acceleration_m_s2.unwrap_or(0.0), event);
        let Some(stepped) = carriage.advance(&self.borne.push, taken) else {
            self.steps -= 1;
            self.carriage = Some(carriage);
            return 0.0;
        };
        for (value, rate) in self.y.iter_mut().zip(&self.slopes[0]).skip(FIRST_STATE) {
            *value += taken * rate;
        }
        self.book_step(&stepped);
        let motion = carriage.motion();
        self.set_motion(motion.position_m, motion.speed_m_s);
        self.time_s += taken;
        self.carriage = Some(carriage);
        taken
    }

    /// The part of a step after which the event is due.
    fn foreseen(&self, step_s: f64, acceleration_m_s2: f64, event: &dyn Fn(&Moment) -> f64) -> f64 {
        /// The shortest step, as a part of the whole one: what a carriage divides by it stays a number.
        const SHORTEST: f64 = 1e-5;
        const HALVINGS: usize = 50;
        let left = |ahead_s: f64| {
            let (position_m, speed_m_s) = (self.y[POSITION], self.y[SPEED]);
            let gained = acceleration_m_s2 * ahead_s;
            event(&Moment {
                time_s: self.time_s + ahead_s,
                position_m: position_m + (speed_m_s + 0.5 * gained) * ahead_s,
                speed_m_s: speed_m_s + gained,
                states: self.states(),
            })
        };
        if left(step_s) > 0.0 || left(0.0) <= 0.0 {
            return step_s;
        }
        let (mut low, mut high) = (0.0, step_s);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if left(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        high.max(SHORTEST * step_s)
    }

    fn book_step(&mut self, stepped: &Stepped) {
        let Borne { push, air_n, delivered_n } = self.borne;
        let first = FIRST_STATE + self.layout.states.len();
        let accounts = &mut self.y[first..];
        accounts[SOIL] += stepped.soil_j;
        accounts[AIR] -= air_n * stepped.forward_m;
        accounts[SLOPE] += stepped.slope_j;
        accounts[BRAKES] += stepped.brakes_j;
        accounts[DRAWBAR] += (stepped.way * (push.drawbar_n - stepped.towed_n) - push.hitch_n)
            * stepped.hitch_m
            + stepped.towed_j;
        accounts[MASS_CHANGE] += stepped.mass_j;
        if let Some(slip) = self.slots.slip {
            accounts[slip] += stepped.slip_j;
        }
        // What effects would take from the resistances beyond nothing was not taken.
        let asked_n: f64 = self.scratch.actions.iter().map(|action| action.resistance_n).sum();
        let short = if asked_n == 0.0 { 1.0 } else { push.resistance_n / asked_n };
        for (account, action) in accounts[self.slots.first_effect..].iter_mut().zip(&self.scratch.actions) {
            let resisting_n = stepped.way * short * action.resistance_n;
            *account += (resisting_n - action.force_n) * stepped.forward_m
                + action.loss_share * delivered_n.abs() * stepped.driven_m.abs();
        }
    }
}

impl Model {
    /// What models push with at the motion of a carriage, and the instant as a longitudinal run would tell it. Writes the
    /// rates of all states, and of the powers those that are not work of the carriage.
    #[allow(clippy::too_many_arguments, reason = "as in the balance, whose other branch this is")]
    fn borne(
        &self,
        (motion, point, delivered_n): (&Motion, Point, f64),
        command: Command,
        given: &Given,
        (layout, slots): (&Layout, &Slots),
        states: &[f64],
        rates: &mut [f64],
        powers: &mut [f64],
        scratch: &mut Scratch,
    ) -> (Instant, Borne) {
        let mut situation = self.situation(point, command, given);
        situation.place = motion.place;
        // As they were in the last step.
        situation.acceleration_m_s2 = motion.acceleration_m_s2.unwrap_or(0.0);
        situation.tractive_force_n = delivered_n;
        let sums = self.sums(&mut situation, given, layout, states, rates, scratch);
        let weight_n = situation.mass_kg * self.gravity_m_s2;
        let air_n = self.air_n(&situation);
        let slope_n = (weight_n + sums.towed_kg * self.gravity_m_s2) * situation.place.sin_slope;
        let asked = Asked {
            situation,
            command,
            given,
            layout,
            states,
            direction: point.direction,
            effective_mass_kg: situation.mass_kg + sums.rotating_kg + sums.towed_kg,
            free_n: air_n - slope_n + sums.pushed_n + sums.task_push_n,
            air_n,
            slope_n,
            demand: Demand {
                speed_m_s: motion.driven_m_s,
                force_n: 0.0,
                coasting: situation.coasting,
                auxiliary_power_w: sums.auxiliary_power_w,
                shaft_power_w: sums.pto_power_w + sums.hydraulic_power_w + sums.effect_shaft_w,
                engine_friction_n_m: sums.engine_friction_n_m,
                battery_resistance_ohm: sums.battery_resistance_ohm,
                engine_speed_rad_s: given.engine_speed_rad_s,
                recorded: given.is_driven() || matches!(command, Command::Recorded(_)),
            },
        };
        let rolled = self.driven(&asked, &sums, motion, rates);
        let mut instant = tell(&asked, &sums, &rolled, slots, &scratch.actions, powers);
        instant.slip_w = 0.0;
        for account in [SOIL, AIR, SLOPE, BRAKES, DRAWBAR, MASS_CHANGE].into_iter().chain(slots.slip) {
            powers[account] = 0.0;
        }
        for (power, action) in powers[slots.first_effect..].iter_mut().zip(&scratch.actions) {
            *power = instant.power_w(action);
        }
        let lost_n = sums.loss_share * rolled.delivery.force_n.abs() * sign(motion.driven_m_s);
        let push = Push {
            drive_n: rolled.delivery.force_n - lost_n,
            way: asked.way(),
            brake_n: rolled.brake_n,
            free_n: air_n + sums.pushed_n,
            resistance_n: sums.resistance_n.max(-(motion.resistance_n + sums.drawbar_n)),
            drawbar_n: sums.drawbar_n,
            hitch_n: sums.task_push_n,
            mass_kg: situation.mass_kg,
            towed_kg: sums.towed_kg,
            coupled_kg: sums.coupled_kg,
            towed_n: sums.towed_n,
            turning_kg: sums.rotating_kg - self.vehicle.rotating_mass_kg,
        };
        (instant, Borne { push, air_n, delivered_n: rolled.delivery.force_n })
    }

    /// What the driveline gives, and the brakes: the driver knows what resists as the wheels found it in the last step.
    fn driven(&self, asked: &Asked, sums: &Sums, motion: &Motion, rates: &mut [f64]) -> Rolled {
        let (way, mass_kg) = (asked.way(), asked.effective_mass_kg);
        let ground_n = motion.resistance_n.max(-(sums.resistance_n + sums.drawbar_n));
        let held_n = ground_n + sums.resistance_n + sums.drawbar_n;
        let lost_n = |force_n: f64| sums.loss_share * force_n.abs();
        let wanted_n = match asked.command {
            Command::Coast => 0.0,
            Command::Recorded(force_n) => force_n,
            Command::Accelerate(wanted) => {
                let resting = asked.direction == 0.0 && wanted == 0.0;
                let needed_n = if resting { 0.0 } else { mass_kg * wanted - asked.free_n + way * held_n };
                needed_n / (1.0 - sums.loss_share * (way * needed_n).signum())
            }
            Command::Push(wanted) => mass_kg * wanted,
        };
        let mut situation = asked.situation;
        situation.tractive_force_n = wanted_n;
        let mut demand = asked.demand;
        demand.force_n =
            self.govern(&situation, asked.command, asked.given, asked.layout, asked.states, rates);
        // About a rest the wheels rock; the driveline is told that they stand.
        let rolling_m_s = way * (way * motion.driven_m_s).max(0.0);
        demand.speed_m_s = sums.turning_m_s(rolling_m_s, demand.force_n, asked.direction);
        let own = asked.layout.driveline.clone();
        let delivery = self.deliver(&demand, (sums, way), &asked.states[own.clone()], &mut rates[own]);
        let brake_n = asked.brake_n(|| {
            let more_n = (delivery.force_n - wanted_n) * asked.direction;
            more_n - lost_n(delivery.force_n) + lost_n(wanted_n)
        });
        let resisting_n = held_n + lost_n(delivery.force_n) + brake_n;
        let (way, acceleration_m_s2) = asked.moves(delivery.force_n + asked.free_n, resisting_n);
        Rolled {
            demand,
            delivery,
            ground_n,
            brake_n,
            way,
            acceleration_m_s2,
            traction_n: delivery.force_n,
            slip: motion.slip,
            rolling_m_s,
            locked: false,
        }
    }
}
