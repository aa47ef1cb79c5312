//! The balance of forces and of powers at one instant.
//!
//! (m + m_rot) dv/dt = F_drive − ε |F_drive| − F_brake − F_soil + F_air − m g sin θ − F_drawbar + Σ F_effect
//!
//! ε is the share that effects take of the force at the wheels, and v / (1 − s) the speed at which slipping wheels roll.
//! Source: Newton's second law along the path, with rotating parts reduced to the wheel
//! (Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter A).

#![allow(
    clippy::inline_always,
    reason = "in three of four stages of a step nobody looks at the instant; inlined, it is not even put together"
)]

use crate::Model;
use crate::agreement::Agreement;
use crate::deciding::Deciding;
use crate::ledger::{
    AIR, AUXILIARY, BRAKES, DRAWBAR, FIRST_LOSS, HYDRAULICS, PTO, SLOPE, SOIL, SOURCE, Slots,
};
use crate::model::Layout;
use crate::wheels::WheelScratch;
use headland_plugin::{Action, Air, Delivery, Demand, Effect, MAX_LOSSES, Mode, Situation};

/// What the driver, or the recording, wants at this instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Command {
    /// Neutral.
    Coast,
    /// This force at the wheels [N], from a recorded driveline that the model's own limits do not touch.
    Recorded(f64),
    /// This acceleration [m/s²], as far as the driveline can; brakes help.
    Accelerate(f64),
    /// The force that would accelerate the mass so [m/s²] if nothing resisted; brakes help.
    Push(f64),
}

/// What a recording knows better than the model.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Given {
    /// Where the path is driven towards its start from [m]; positions then count what was travelled.
    pub reversed_from_m: Option<f64>,
    /// How often the path was driven before.
    pub passes_before: usize,
    /// Whether a vehicle at rest is to set off backward.
    pub backward: bool,
    pub sin_slope: Option<f64>,
    pub heading_rad: Option<f64>,
    pub curvature_per_m: Option<f64>,
    pub roll_rad: Option<f64>,
    pub shaking_m2_s4: Option<f64>,
    pub air: Option<Air>,
    pub oil_temperature_c: Option<f64>,
    pub state_of_charge: Option<f64>,
    pub tyre_pressure_pa: Option<f64>,
    pub auxiliary_power_w: Option<f64>,
    pub drawbar_force_n: Option<f64>,
    pub pto_power_w: Option<f64>,
    pub hydraulic_power_w: Option<f64>,
    /// What is carried beside the vehicle and its tasks [kg].
    pub payload_kg: f64,
    pub braking: bool,
    /// Speed at which the driver keeps the engine [rad/s]; 0 where the driveline chooses.
    pub engine_speed_rad_s: f64,
    /// How fast what the driver remembers changes, per second.
    pub driver_rate: f64,
    /// Whether a recorded motion is followed.
    pub followed: Followed,
}

/// How a recorded motion is followed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Followed {
    /// Not at all: the forces make the motion.
    #[default]
    Not,
    /// It was driven, whatever effects would have allowed.
    Driven,
    /// From sample to sample, whatever the forces are: effects are asked for what each of them does, and not for what is left of the
    /// ground's resistance.
    Sampled,
}

impl Given {
    /// Whether the motion itself is what drives.
    pub fn is_driven(&self) -> bool {
        self.followed == Followed::Driven
    }
}

/// What the forces make, for powers that follow it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Made {
    pub acceleration_m_s2: f64,
    pub tractive_force_n: f64,
    pub engine_speed_rad_s: Option<f64>,
}

impl Made {
    #[inline(always)]
    fn of(instant: &Instant) -> Self {
        let speed_rad_s = instant.delivery.readings.engine_speed_rad_s;
        Self {
            acceleration_m_s2: instant.acceleration_m_s2,
            tractive_force_n: instant.delivery.force_n,
            engine_speed_rad_s: speed_rad_s.is_finite().then_some(speed_rad_s),
        }
    }
}

/// Everything that is known at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Instant {
    pub acceleration_m_s2: f64,
    pub situation: Situation,
    pub effective_mass_kg: f64,
    /// What was asked of the driveline.
    pub demand: Demand,
    pub delivery: Delivery,
    pub soil_n: f64,
    pub air_n: f64,
    pub slope_n: f64,
    pub brake_n: f64,
    pub drawbar_n: f64,
    /// Force of the tasks, forward, whether the vehicle moves or not.
    pub pushed_n: f64,
    pub auxiliary_power_w: f64,
    pub pto_power_w: f64,
    pub hydraulic_power_w: f64,
    /// Speed at which the wheels roll.
    pub wheel_speed_m_s: f64,
    /// Force of the driveline before what is lost upstream [N].
    pub transmitted_n: f64,
    /// Force at the wheels in the direction of the motion [N],
    pub driving_n: f64,
    /// and the power that slip takes of it, for each part of one [W].
    pub per_slip_w: f64,
    /// Slip of the driveline's speed, without what effects add.
    pub slip: f64,
    /// Power that it takes [W].
    pub slip_w: f64,
    /// Whether the brakes hold wheels that slide: what they take is then taken by sliding.
    pub locked: bool,
}

impl Instant {
    /// Force of an effect against the motion, what it takes of the wheels' force included [N].
    pub fn resistance_n(&self, action: &Action) -> f64 {
        action.resistance_n + action.loss_share * self.delivery.force_n.abs()
    }

    /// Power that an effect takes beside its forces [W].
    pub fn power_w(&self, action: &Action) -> f64 {
        let upstream_n = action.upstream_n + action.upstream_share * self.transmitted_n.abs();
        action.auxiliary_power_w
            + action.shaft_power_w
            + action.slip_at(self.driving_n) * self.per_slip_w
            + upstream_n * self.demand.speed_m_s.abs()
    }
}

/// A wheel that slips more than this only spins.
pub(crate) const MOST_SLIP: f64 = 0.9;

/// Time, place and motion at which the balance is asked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub time_s: f64,
    pub position_m: f64,
    pub speed_m_s: f64,
    /// 1 forward, −1 backward, 0 where the vehicle rests and the forces have to decide.
    pub direction: f64,
}

/// Scratch memory of the balance, so that no step allocates.
#[derive(Debug)]
pub(crate) struct Scratch {
    pub actions: Vec<Action>,
    /// What each task is told to do.
    pub modes: Vec<Mode>,
    /// What each axle does.
    pub wheels: WheelScratch,
    pub deciding: Deciding,
}

/// What is asked of driveline and ground at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Asked<'a> {
    pub situation: Situation,
    pub command: Command,
    pub given: &'a Given,
    pub layout: &'a Layout,
    pub states: &'a [f64],
    /// As that of the [`Point`].
    pub direction: f64,
    pub effective_mass_kg: f64,
    /// Forces that act whether the vehicle moves or not, forward [N].
    pub free_n: f64,
    /// Those of the air and of the slope among them, this one backward [N].
    pub air_n: f64,
    pub slope_n: f64,
    /// Everything but its force and its speed.
    pub demand: Demand,
}

impl Asked<'_> {
    /// Direction of the motion; forward at rest.
    #[inline(always)]
    pub fn way(&self) -> f64 {
        match self.direction {
            0.0 if self.given.backward => -1.0,
            0.0 => 1.0,
            moving => moving,
        }
    }

    /// What the brakes take [N]: what a driver who moves gets more than was wanted, and everything at rest.
    #[inline(always)]
    pub fn brake_n(&self, more_n: impl FnOnce() -> f64) -> f64 {
        match self.command {
            Command::Accelerate(_) | Command::Push(_) if self.direction != 0.0 => more_n().max(0.0),
            // A driver who wants to stand still keeps a foot on the brake.
            Command::Accelerate(wanted) | Command::Push(wanted) if wanted * self.way() <= 0.0 => {
                f64::INFINITY
            }
            _ => 0.0,
        }
    }

    /// What brakes do of what they would: the ground holds braked wheels by `most_n` in all, and they slide where it takes more
    /// than that. A vehicle at rest is held with whatever it takes as long as the ground does.
    #[inline(always)]
    pub fn held_by_ground(&self, brake_n: f64, most_n: f64, driving_n: f64, held_n: f64) -> (f64, bool) {
        // What was recorded was driven, whatever the ground of the model would have held.
        let short = brake_n > most_n && !self.given.is_driven();
        if !short || (self.direction == 0.0 && driving_n.abs() <= held_n + most_n) {
            return (brake_n, false);
        }
        (most_n.max(0.0), true)
    }

    /// The direction in which resistances act, and the acceleration [m/s²].
    ///
    /// Motion takes every resistance with it; at rest they only hold against what pushes.
    #[inline(always)]
    pub fn moves(&self, driving_n: f64, resisting_n: f64) -> (f64, f64) {
        let way = if self.direction != 0.0 {
            self.direction
        } else if driving_n.abs() <= resisting_n {
            0.0
        } else {
            driving_n.signum()
        };
        let force_n = driving_n - way * resisting_n;
        (way, if way == 0.0 { 0.0 } else { force_n / self.effective_mass_kg })
    }
}

/// What driveline and ground make of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rolled {
    pub demand: Demand,
    pub delivery: Delivery,
    /// Resistance of the ground [N].
    pub ground_n: f64,
    /// That of the brakes [N]; infinite where they hold a vehicle at rest.
    pub brake_n: f64,
    /// Direction in which resistances act.
    pub way: f64,
    pub acceleration_m_s2: f64,
    /// Force of the ground on the driven wheels, forward [N].
    pub traction_n: f64,
    /// Slip of the driveline's speed, and the speed at which the wheels roll [m/s], without what effects add.
    pub slip: f64,
    pub rolling_m_s: f64,
    /// Whether the brakes hold wheels that slide.
    pub locked: bool,
}

impl Model {
    /// Evaluates the balance; writes the rates of all states and the power of every account [W]. Where it `DECIDES`, the driveline
    /// decides as soon as it is known what is asked of it, as far as that does not hang on what it gives. Of a `WHOLE` vehicle it is
    /// known that it has no axles.
    #[allow(
        clippy::too_many_arguments,
        reason = "the inner loop: everything is passed, nothing is allocated"
    )]
    #[inline(always)]
    pub(crate) fn balance<const DECIDES: bool, const WHOLE: bool>(
        &self,
        point: Point,
        command: Command,
        given: &Given,
        layout: &Layout,
        slots: &Slots,
        states: &[f64],
        rates: &mut [f64],
        powers: &mut [f64],
        scratch: &mut Scratch,
    ) -> Instant {
        let at = (point, command, given);
        let any =
            |follows: fn(&dyn Effect) -> bool| self.effects.iter().any(|effect| follows(&*effect.plugin));
        let follows = any(|effect| effect.follows_acceleration());
        let by_acceleration = follows && any(|effect| effect.moved_by_acceleration());
        let by_drive = any(|effect| effect.follows_drive());
        let mut made = Made::default();
        if by_acceleration || by_drive {
            let mut agreement = Agreement::new(by_acceleration);
            while let Some(supposed) = agreement.to_ask() {
                let found = self
                    .balance_at::<false, WHOLE>(at, supposed, layout, slots, states, rates, powers, scratch);
                made = agreement.answered(Made::of(&found));
            }
        } else if follows {
            let first =
                self.balance_at::<false, WHOLE>(at, made, layout, slots, states, rates, powers, scratch);
            made = Made::of(&first);
        }
        self.balance_at::<DECIDES, WHOLE>(at, made, layout, slots, states, rates, powers, scratch)
    }

    /// As [`Model::balance`], with what effects are told of what the forces make.
    #[allow(clippy::too_many_arguments, reason = "as in the balance")]
    #[inline(always)]
    fn balance_at<const DECIDES: bool, const WHOLE: bool>(
        &self,
        (point, command, given): (Point, Command, &Given),
        made: Made,
        layout: &Layout,
        slots: &Slots,
        states: &[f64],
        rates: &mut [f64],
        powers: &mut [f64],
        scratch: &mut Scratch,
    ) -> Instant {
        let Point { speed_m_s, direction, .. } = point;
        let mut situation = self.situation(point, command, given);
        situation.acceleration_m_s2 = made.acceleration_m_s2;
        situation.tractive_force_n = made.tractive_force_n;
        situation.engine_speed_rad_s = made.engine_speed_rad_s;
        let sums = self.sums(&mut situation, given, layout, states, rates, scratch);
        let place = situation.place;

        let weight_n = situation.mass_kg * self.gravity_m_s2;
        let air_n = self.air_n(&situation);
        let slope_n = (weight_n + sums.towed_kg * self.gravity_m_s2) * place.sin_slope;
        let effective_mass_kg = situation.mass_kg + sums.rotating_kg + sums.towed_kg;
        let free_n = air_n - slope_n + sums.pushed_n + sums.task_push_n;
        let shaft_power_w = sums.pto_power_w + sums.hydraulic_power_w + sums.effect_shaft_w;
        let demand = Demand {
            speed_m_s,
            force_n: 0.0,
            coasting: situation.coasting,
            auxiliary_power_w: sums.auxiliary_power_w,
            shaft_power_w,
            engine_friction_n_m: sums.engine_friction_n_m,
            battery_resistance_ohm: sums.battery_resistance_ohm,
            engine_speed_rad_s: given.engine_speed_rad_s,
            recorded: given.is_driven() || matches!(command, Command::Recorded(_)),
        };
        let asked = Asked {
            situation,
            command,
            given,
            layout,
            states,
            direction,
            effective_mass_kg,
            free_n,
            air_n,
            slope_n,
            demand,
        };
        if !WHOLE && let (Some(axles), Some(soil)) = (&self.axles, &self.soil) {
            // Everything goes there as a copy: what another function may look at does not stay in registers here.
            return self.carried((axles, &**soil), asked, sums, slots, rates, powers, scratch);
        }
        let rolled = self.rolling::<DECIDES>(&asked, &sums, rates, &mut scratch.deciding);
        tell(&asked, &sums, &rolled, slots, &scratch.actions, powers)
    }

    /// Force of the air, forward [N].
    #[inline(always)]
    pub(crate) fn air_n(&self, situation: &Situation) -> f64 {
        let area_m2 = self.vehicle.resistance.drag_area_m2();
        situation.air.drag_n(area_m2, situation.speed_m_s, situation.place.heading_rad)
    }

    /// The force to ask of the driveline where `situation` holds the one that is wanted.
    #[inline(always)]
    pub(crate) fn govern(
        &self,
        situation: &Situation,
        command: Command,
        given: &Given,
        layout: &Layout,
        states: &[f64],
        rates: &mut [f64],
    ) -> f64 {
        if self.effects.is_empty() {
            return situation.tractive_force_n;
        }
        let (mut least_n, mut most_n) = (f64::NEG_INFINITY, f64::INFINITY);
        for (effect, range) in self.effects.iter().zip(&layout.effects) {
            let states = &states[range.clone()];
            effect.plugin.follow(situation, states, &mut rates[range.clone()]);
            let (least, most) = effect.plugin.limits_n(situation, states);
            (least_n, most_n) = (least_n.max(least), most_n.min(most));
        }
        let wanted_n = situation.tractive_force_n;
        let most_n = if given.is_driven() { f64::INFINITY } else { most_n };
        match command {
            Command::Accelerate(_) | Command::Push(_) => wanted_n.max(least_n).min(most_n),
            Command::Coast | Command::Recorded(_) => wanted_n,
        }
    }

    /// Where the vehicle is, and in what air.
    #[inline(always)]
    pub(crate) fn situation(&self, point: Point, command: Command, given: &Given) -> Situation {
        let position_m = given.reversed_from_m.map_or(point.position_m, |from_m| from_m - point.position_m);
        let mut place = self.terrain.at(position_m);
        if given.reversed_from_m.is_some() {
            place.sin_slope = -place.sin_slope;
            place.sin_roll = -place.sin_roll;
            place.curvature_per_m = -place.curvature_per_m;
            place.heading_rad += std::f64::consts::PI;
        }
        if let Some(sin_slope) = given.sin_slope {
            place.sin_slope = sin_slope;
        }
        if let Some(heading) = given.heading_rad {
            place.heading_rad = heading;
        }
        if let Some(curvature) = given.curvature_per_m {
            place.curvature_per_m = curvature;
        }
        if let Some(roll) = given.roll_rad {
            place.sin_roll = roll.sin() * place.cos_slope();
        }
        Situation {
            time_s: point.time_s,
            position_m,
            reversed: given.reversed_from_m.is_some(),
            passes_before: given.passes_before,
            speed_m_s: point.speed_m_s,
            acceleration_m_s2: 0.0,
            mass_kg: self.vehicle.mass_kg,
            gravity_m_s2: self.gravity_m_s2,
            place,
            air: given.air.unwrap_or(self.air),
            drag_area_m2: self.vehicle.resistance.drag_area_m2(),
            coasting: command == Command::Coast,
            braking: given.braking,
            tractive_force_n: 0.0,
            shaking_m2_s4: given.shaking_m2_s4,
            engine_speed_rad_s: None,
            oil_temperature_c: given.oil_temperature_c,
            state_of_charge: given.state_of_charge,
            tyre_pressure_pa: given.tyre_pressure_pa,
            pto_power_w: 0.0,
            hydraulic_power_w: 0.0,
        }
    }

    /// What effects and tasks add up to; the mass of the situation grows by what they carry.
    #[inline(always)]
    pub(crate) fn sums(
        &self,
        situation: &mut Situation,
        given: &Given,
        layout: &Layout,
        states: &[f64],
        rates: &mut [f64],
        scratch: &mut Scratch,
    ) -> Sums {
        let mut sums = Sums {
            rotating_kg: self.vehicle.rotating_mass_kg + self.driveline.rotating_mass_kg(situation.coasting),
            auxiliary_power_w: given.auxiliary_power_w.unwrap_or(0.0),
            drawbar_n: given.drawbar_force_n.unwrap_or(0.0),
            ..Sums::default()
        };
        situation.state_of_charge = situation.state_of_charge.or(layout.charge.map(|charge| states[charge]));
        let mut carried_kg = given.payload_kg;
        let tasks = self.tasks.iter().zip(&layout.tasks);
        for ((task, range), mode) in tasks.zip(&scratch.modes) {
            let rates = &mut rates[range.clone()];
            let load = task.plugin.load_in(*mode, situation, &states[range.clone()], rates);
            sums.drawbar_n += load.drawbar_force_n;
            sums.task_push_n += load.force_n;
            sums.pto_power_w += load.pto_power_w;
            sums.hydraulic_power_w += load.hydraulic_power_w;
            sums.towed_kg += load.towed_mass_kg;
            if load.towed_mass_kg > 0.0 {
                sums.coupled_kg += load.mass_kg;
                sums.towed_n += load.drawbar_force_n;
            }
            carried_kg += load.mass_kg;
        }
        // What was recorded there is all that tasks took.
        sums.pto_power_w = given.pto_power_w.unwrap_or(sums.pto_power_w);
        sums.hydraulic_power_w = given.hydraulic_power_w.unwrap_or(sums.hydraulic_power_w);
        (situation.pto_power_w, situation.hydraulic_power_w) = (sums.pto_power_w, sums.hydraulic_power_w);
        situation.mass_kg += carried_kg;
        self.ask(situation, layout, states, rates, scratch);
        let (mass_kg, area_m2) = scratch
            .actions
            .iter()
            .fold((0.0, 0.0), |(mass, area), action| (mass + action.mass_kg, area + action.drag_area_m2));
        if mass_kg != 0.0 || area_m2 != 0.0 {
            situation.mass_kg += mass_kg;
            situation.drag_area_m2 += area_m2;
            self.ask(situation, layout, states, rates, scratch);
        }
        for action in &scratch.actions {
            sums.rotating_kg += action.rotating_mass_kg;
            sums.pushed_n += action.force_n;
            sums.resistance_n += action.resistance_n;
            sums.auxiliary_power_w += action.auxiliary_power_w;
            sums.effect_shaft_w += action.shaft_power_w;
            sums.loss_share += action.loss_share;
            sums.upstream_share += action.upstream_share;
            sums.upstream_n += action.upstream_n;
            sums.slip += action.slip;
            sums.slip_per_n += action.slip_per_n;
            sums.slip_per_n2 += action.slip_per_n2;
            sums.engine_friction_n_m += action.engine_friction_n_m;
            sums.battery_resistance_ohm += action.battery_resistance_ohm;
        }
        sums
    }

    /// Asks every effect what it does.
    #[inline(always)]
    fn ask(
        &self,
        situation: &Situation,
        layout: &Layout,
        states: &[f64],
        rates: &mut [f64],
        scratch: &mut Scratch,
    ) {
        let effects = self.effects.iter().zip(&layout.effects);
        for ((effect, range), action) in effects.zip(&mut scratch.actions) {
            *action = effect.plugin.act(situation, &states[range.clone()], &mut rates[range.clone()]);
        }
    }
}

/// What effects and tasks add up to.
#[derive(Clone, Copy, Debug, Default)]
#[allow(clippy::struct_field_names, reason = "each name ends in its unit")]
pub(crate) struct Sums {
    pub rotating_kg: f64,
    pub towed_kg: f64,
    pub coupled_kg: f64,
    pub towed_n: f64,
    pub task_push_n: f64,
    pub pushed_n: f64,
    pub resistance_n: f64,
    pub auxiliary_power_w: f64,
    pub effect_shaft_w: f64,
    pub loss_share: f64,
    pub upstream_share: f64,
    pub upstream_n: f64,
    pub slip: f64,
    pub slip_per_n: f64,
    pub slip_per_n2: f64,
    pub engine_friction_n_m: f64,
    pub battery_resistance_ohm: f64,
    pub drawbar_n: f64,
    pub pto_power_w: f64,
    pub hydraulic_power_w: f64,
}

impl Sums {
    /// Slip that effects make of wheels that drive with a force, in the direction of the motion [N].
    fn slip_at(&self, driving_n: f64) -> f64 {
        let Self { slip, slip_per_n, slip_per_n2, .. } = *self;
        Action { slip, slip_per_n, slip_per_n2, ..Action::default() }.slip_at(driving_n)
    }

    /// Whether effects make the wheels slip.
    pub fn slips(&self) -> bool {
        self.slip != 0.0 || self.slip_per_n != 0.0 || self.slip_per_n2 != 0.0
    }

    /// Speed of wheels that effects make slip [m/s], which would roll at another in this direction.
    pub fn turning_m_s(&self, rolling_m_s: f64, force_n: f64, direction: f64) -> f64 {
        if !self.slips() {
            return rolling_m_s;
        }
        rolling_m_s / (1.0 - self.slip_at(force_n * direction).clamp(-MOST_SLIP, MOST_SLIP))
    }
}

/// Puts the instant together, and writes the power of every account [W].
#[inline(always)]
pub(crate) fn tell(
    asked: &Asked,
    sums: &Sums,
    rolled: &Rolled,
    slots: &Slots,
    actions: &[Action],
    powers: &mut [f64],
) -> Instant {
    let Rolled { delivery, demand, rolling_m_s, .. } = *rolled;
    let mut situation = asked.situation;
    situation.tractive_force_n = delivery.force_n;
    let driving_n = delivery.force_n * asked.direction;
    let slip = sums.slip_at(driving_n);
    let slipping_w = delivery.force_n * (demand.speed_m_s - rolling_m_s);
    let instant = Instant {
        acceleration_m_s2: rolled.acceleration_m_s2,
        situation,
        effective_mass_kg: asked.effective_mass_kg,
        demand,
        delivery,
        soil_n: rolled.ground_n,
        air_n: asked.air_n,
        slope_n: asked.slope_n,
        brake_n: if rolled.brake_n.is_finite() { rolled.brake_n } else { 0.0 },
        drawbar_n: sums.drawbar_n,
        pushed_n: sums.task_push_n,
        auxiliary_power_w: sums.auxiliary_power_w,
        pto_power_w: sums.pto_power_w,
        hydraulic_power_w: sums.hydraulic_power_w,
        transmitted_n: sums.transmitted_n(delivery.force_n, asked.way()),
        wheel_speed_m_s: if rolled.locked { 0.0 } else { demand.speed_m_s },
        driving_n,
        per_slip_w: if slip == 0.0 { 0.0 } else { slipping_w / slip },
        slip: rolled.slip,
        slip_w: delivery.force_n * rolling_m_s - rolled.traction_n * situation.speed_m_s,
        locked: rolled.locked,
    };
    book(&instant, rolled.way, asked.given, slots, actions, powers);
    instant
}

/// Writes the power of every account [W]; `way` is the direction in which resistances act.
#[inline(always)]
fn book(instant: &Instant, way: f64, given: &Given, slots: &Slots, actions: &[Action], powers: &mut [f64]) {
    let speed_m_s = instant.situation.speed_m_s;
    // All losses are written at once, and what stands in the place of those that nobody has after them.
    let (fixed, _) = powers
        .split_first_chunk_mut::<{ FIRST_LOSS + MAX_LOSSES }>()
        .unwrap_or_else(|| unreachable!("so many there are"));
    fixed[SOURCE] = instant.delivery.source_power_w;
    fixed[SOIL] = way * instant.soil_n * speed_m_s;
    fixed[AIR] = -instant.air_n * speed_m_s;
    fixed[SLOPE] = instant.slope_n * speed_m_s;
    fixed[BRAKES] = way * instant.brake_n * speed_m_s;
    fixed[DRAWBAR] = (way * instant.drawbar_n - instant.pushed_n) * speed_m_s;
    fixed[PTO] = instant.pto_power_w;
    fixed[HYDRAULICS] = instant.hydraulic_power_w;
    fixed[AUXILIARY] = given.auxiliary_power_w.unwrap_or(0.0);
    fixed[FIRST_LOSS..].copy_from_slice(&instant.delivery.losses_w);
    if let Some(slip) = slots.slip {
        powers[slip] = instant.slip_w;
        if instant.locked {
            // A brake that holds a wheel still takes nothing; the ground does, on which it slides.
            powers[slip] += powers[BRAKES];
            powers[BRAKES] = 0.0;
        }
    }
    for (power, action) in powers[slots.first_effect..].iter_mut().zip(actions) {
        *power = (way * instant.resistance_n(action) - action.force_n) * speed_m_s + instant.power_w(action);
    }
}
