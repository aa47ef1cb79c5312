//! A vehicle that is driven as a rigid body.

mod carriage;
mod contact;
mod towed;
mod watch;

use crate::BodyError;
use crate::accounts::Own;
use crate::chassis::Chassis;
use crate::ground::Ground;
use crate::hop;
use crate::pace::{self, Carried};
use crate::spin::Spin;
use crate::standing::{Weight, stand};
use crate::steer::{Pushed, Steer};
use crate::track::{Track, yaw_of};
use crate::wheel::{Scene, Touch, Wheel};
use crate::world::{State, World, properties};
use headland_plugin::{Refusal, Soil};
use headland_sim::{Axles, Model, Push, Start, Vehicle};
use rapier3d_f64::math::Matrix;
use rapier3d_f64::prelude::Vector;
pub(crate) use towed::Towed;

pub(crate) use contact::wheels;
use contact::{deflection_m, touch};

/// A driver looks where the vehicle goes once it goes faster than it rocks at rest [m/s].
const LOOKS_ROUND_M_S: f64 = 0.05;
/// A start so far beyond an end of the path is the rounding of one [m].
const ROUNDING_M: f64 = 1e-6;

/// A vehicle in motion.
#[derive(Debug)]
pub(crate) struct Rig<'a> {
    model: &'a Model,
    chassis: &'a Chassis,
    axles: &'a Axles,
    soil: &'a dyn Soil,
    ground: Ground<'a>,
    world: World,
    wheels: Vec<Wheel<'a>>,
    spin: Spin,
    towed: Option<Towed<'a>>,
    steer: Steer,
    track: Track<'a>,
    state: State,
    mass_kg: f64,
    /// Inverse of the inertia, and whether wheels have masses of their own.
    inverse: Matrix,
    hops: bool,
    /// Whether the driver looks back.
    backward: bool,
    /// How much of the resistances acts, and which way.
    way: f64,
    resting: bool,
    acceleration_m_s2: Option<f64>,
    /// Of the centre of gravity, upward [m/s²].
    rising_m_s2: f64,
    digging_s: f64,
    own: Own,
    first_spring_j: f64,
    first_strut_j: f64,
    trouble: Option<String>,
}

impl<'a> Rig<'a> {
    /// Puts a vehicle on its ground.
    pub fn new(model: &'a Model, chassis: &'a Chassis, start: Start, step_s: f64) -> Result<Self, BodyError> {
        let axles = model.axles.as_ref().ok_or(BodyError::NoAxles)?;
        let soil = model.soil.as_deref().ok_or(BodyError::NoSoil)?;
        chassis.check(axles)?;
        let mass_kg = model.vehicle.mass_kg;
        let rotating_kg = model.vehicle.rotating_mass_kg;
        check_start(model, axles, start)?;
        let ground = Ground::of(&*model.terrain, start.position_m)?;
        let weight_n = mass_kg * model.gravity_m_s2;
        let mut wheels = wheels(axles, chassis, (mass_kg, model.gravity_m_s2));
        let backward = start.speed_m_s < 0.0;
        follow_ruts(&mut wheels, axles, backward);
        let inertias = (
            ("roll_inertia_kg_m2", chassis.roll_inertia_kg_m2),
            ("pitch_inertia_kg_m2", chassis.pitch_inertia_kg_m2),
        );
        hop::check(&wheels, Vector::ZERO, (mass_kg, inertias.0, inertias.1), "axles.")?;
        let mut steer = Steer::new(chassis.steering, axles);
        steer.start();
        let track = Track::at(&*model.terrain, start.position_m);
        let height_m = axles.centre_of_gravity_height_m;
        let hitch = Vector::new(chassis.hitch_position_m, 0.0, axles.hitch_height_m - height_m);
        let mut towed = Towed::of(model, chassis, axles.hitch_height_m)?;
        let pressing_n = towed.as_ref().map_or(0.0, |towed| towed.pressing_n(model.gravity_m_s2));
        let standing_n = weight_n + pressing_n;
        let weight = Weight { newtons: standing_n, centre: hitch * (pressing_n / standing_n), height_m };
        let yaw_rad = yaw_of(track.place.heading_rad) + steer.aslant_rad();
        let pose = stand(&mut wheels, &ground, soil, weight, &track.place, yaw_rad)?;
        for wheel in &wheels {
            let most_m = wheel.tyre.section_height_m;
            if wheel.touch.deflection_m > most_m {
                let Touch { deflection_m: depth_m, load_n, .. } = wheel.touch;
                let (wheel, load_kn) = (wheel.told.clone(), 1e-3 * load_n);
                return Err(BodyError::BelowGround { wheel, depth_m, load_kn, most_m });
            }
        }
        let velocity = along_path(&track) * start.speed_m_s;
        let own = properties(chassis, mass_kg, height_m, mass_kg);
        let mut world = World::new(pose, own, velocity, model.gravity_m_s2);
        let tyres: Vec<(usize, f64)> = wheels.iter().map(|wheel| (wheel.axle, wheel.tyres)).collect();
        let spin = Spin::new(axles, chassis, &tyres, rotating_kg, start.speed_m_s);
        let carried = Carried {
            mass_kg,
            roll_kg_m2: chassis.roll_inertia_kg_m2,
            pitch_kg_m2: chassis.pitch_inertia_kg_m2,
        };
        pace::check(&wheels, &spin, soil, carried, (step_s, start.speed_m_s))?;
        if let Some(towed) = &mut towed {
            towed.check_step(step_s, start.speed_m_s)?;
            let standing = world.state();
            towed.couple(&mut world, &ground, (&standing, hitch), start.speed_m_s)?;
        }
        let mut rig = Self {
            model,
            chassis,
            axles,
            soil,
            ground,
            state: world.state(),
            world,
            inverse: own.reconstruct_inverse_inertia_matrix(),
            hops: hop::any(&wheels),
            backward,
            wheels,
            spin,
            towed,
            steer,
            track,
            mass_kg,
            way: if start.speed_m_s == 0.0 { 0.0 } else { start.speed_m_s.signum() },
            resting: start.speed_m_s == 0.0,
            acceleration_m_s2: None,
            rising_m_s2: 0.0,
            digging_s: 0.0,
            own: Own::default(),
            first_spring_j: 0.0,
            first_strut_j: 0.0,
            trouble: None,
        };
        // A step of no length: what the wheels feel where they stand, for the driver who knows what resists.
        rig.touch();
        if start.speed_m_s == 0.0 {
            rig.hold(standing_n);
        }
        rig.feel(0.0);
        if let Some(towed) = &mut rig.towed {
            rig.trouble = towed.feel(&rig.ground, rig.track.place, rig.track.position_m, 0.0);
        }
        rig.first_spring_j = rig.spring_j();
        rig.first_strut_j = rig.strut_j();
        Ok(rig)
    }

    /// Gives the tyres the slips with which they hold a vehicle at rest on its slope.
    fn hold(&mut self, weight_n: f64) {
        let pressed: Vector = self.wheels.iter().map(|wheel| wheel.touch.normal * wheel.touch.load_n).sum();
        let loads_n: f64 = self.wheels.iter().map(|wheel| wheel.touch.load_n).sum();
        let held = Vector::Z * weight_n - pressed;
        for wheel in &mut self.wheels {
            let own = held * (wheel.touch.load_n / loads_n);
            let across_n = wheel.body.cornering_stiffness_per_rad * wheel.touch.load_n;
            if wheel.touch.load_n > 0.0 {
                wheel.slip = own.dot(wheel.touch.along) / pace::gripping_n(wheel, self.soil);
                wheel.side = own.dot(wheel.touch.across) / across_n;
            }
        }
    }

    /// Energy in the tyres [J].
    fn spring_j(&self) -> f64 {
        let own: f64 = self
            .wheels
            .iter()
            .map(|wheel| wheel.spring_j(deflection_m(wheel, &self.state, &self.ground)))
            .sum();
        own + self.towed.as_ref().map_or(0.0, |towed| towed.spring_j(&self.ground))
    }

    /// Energy in the suspension [J].
    fn strut_j(&self) -> f64 {
        let towed = self.towed.iter().flat_map(|towed| &towed.wheels);
        let struts = self.wheels.iter().chain(towed).filter_map(|wheel| wheel.strut);
        struts.map(|strut| 0.5 * strut.stiffness_n_m * strut.squeezed_m * strut.squeezed_m).sum()
    }

    /// Lets every wheel meet the ground below it.
    fn touch(&mut self) {
        let (state, steer) = (self.state, &self.steer);
        let angle_rad = |wheel: &Wheel| steer.angle_rad(wheel.axle, wheel.arm.x, wheel.arm.y);
        if let Some(told) = touch(&mut self.wheels, &state, &self.ground, angle_rad) {
            self.trouble = Some(told);
        }
    }

    /// Lets every wheel feel the ground, along a step.
    fn feel(&mut self, step_s: f64) {
        let scene = Scene {
            soil: self.soil,
            place: self.track.place,
            position_m: self.track.position_m,
            speed_m_s: self.state.speed_m_s(),
            load_n: self.wheels.iter().map(|wheel| wheel.touch.load_n).sum(),
            slip_limit: self.axles.slip_limit,
        };
        for (index, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.feel(&scene, self.spin.wheels_m_s[index], step_s);
        }
    }

    /// Takes what is carried and what turns as the models say; returns the energy that comes with it [J].
    fn load(&mut self, push: &Push) -> f64 {
        let mut gained_j = self.spin.couple(push.turning_kg);
        if let Some(towed) = self.towed.as_mut().filter(|_| push.towed_kg > 0.0) {
            gained_j += towed.load(&mut self.world, push);
        }
        if self.towed.is_some() != (push.towed_kg > 0.0) && self.trouble.is_none() {
            self.trouble = Some(if self.towed.is_some() {
                "the task that tows the trailer has left it, which a rigid body cannot do".to_owned()
            } else {
                format!(
                    "a task pulls {:.0} kg on other wheels, and the vehicle's `body` has no `trailer`",
                    push.towed_kg
                )
            });
        }
        let coupled_kg = if self.towed.is_some() { push.coupled_kg } else { 0.0 };
        let mass_kg = push.mass_kg - coupled_kg;
        if mass_kg != self.mass_kg {
            if self.chassis.payload.is_none() && self.trouble.is_none() {
                self.trouble = Some(format!(
                    "the vehicle is to carry {:.0} kg, and its `body` has no `payload` to say where",
                    mass_kg - self.model.vehicle.mass_kg
                ));
            }
            let before_j = self.world.kinetic_j();
            let height_m = self.axles.centre_of_gravity_height_m;
            let laden = properties(self.chassis, self.model.vehicle.mass_kg, height_m, mass_kg);
            self.inverse = laden.reconstruct_inverse_inertia_matrix();
            self.world.load(laden);
            self.mass_kg = mass_kg;
            self.state = self.world.state();
            gained_j += self.world.kinetic_j() - before_j;
        }
        gained_j
    }

    fn aim(&mut self, step_s: f64) {
        let axes = (self.state.ahead(), self.state.left());
        let from =
            self.state.point(Vector::new(self.steer.pivot_m, 0.0, -self.axles.centre_of_gravity_height_m));
        let speed_m_s = self.state.speed_m_s();
        if speed_m_s.abs() > LOOKS_ROUND_M_S && self.backward != (speed_m_s < 0.0) {
            self.backward = speed_m_s < 0.0;
            follow_ruts(&mut self.wheels, self.axles, self.backward);
        }
        if let Some(towed) = self.towed.as_ref().filter(|_| self.backward && !self.steer.aslant()) {
            let far_m = self.chassis.hitch_position_m - towed.behind_m() - self.steer.look_ahead_m();
            let aim = self.track.aim(towed.middle(), (towed.state.ahead(), towed.state.left()), far_m, 0.0);
            let pushed = Pushed {
                length_m: towed.behind_m(),
                lever_m: self.steer.pivot_m - self.chassis.hitch_position_m,
                angle_rad: towed.angle_rad(&self.state),
            };
            self.steer.push(&pushed, aim, step_s);
            return;
        }
        let way = if self.backward { -1.0 } else { 1.0 };
        let far_m = self.steer.pivot_m + way * self.steer.look_ahead_m();
        let aim = self.track.aim(from, axes, far_m, self.steer.aslant_rad());
        self.steer.turn(aim, way, step_s);
    }

    /// The point of the vehicle that stands for its place: on the ground below its own centre of gravity.
    fn foot(&self) -> Vector {
        self.state.point(Vector::new(0.0, 0.0, -self.axles.centre_of_gravity_height_m))
    }

    fn hitch(&self) -> Vector {
        let up_m = self.axles.hitch_height_m - self.axles.centre_of_gravity_height_m;
        self.state.point(Vector::new(self.chassis.hitch_position_m, 0.0, up_m))
    }
}

/// Counts for every wheel those that pass before it.
fn follow_ruts(wheels: &mut [Wheel], axles: &Axles, backward: bool) {
    for wheel in wheels {
        wheel.earlier = axles.earlier(wheel.axle, backward);
    }
}

/// Refuses axles, masses and a start that no body can have.
fn check_start(model: &Model, axles: &Axles, start: Start) -> Result<(), BodyError> {
    if let Some(index) = axles.list().iter().position(|axle| axle.wheels > 1 && axle.track_m <= 0.0) {
        return Err(BodyError::Axles(Refusal {
            parameter: format!("axles.{index}.track_m"),
            found: axles.list()[index].track_m.to_string(),
            expected: "more than 0: a rigid body would fall over".to_owned(),
        }));
    }
    let Vehicle { mass_kg, rotating_mass_kg, .. } = model.vehicle;
    for (name, found) in [("mass_kg", mass_kg), ("rotating_mass_kg", rotating_mass_kg)] {
        if found <= 0.0 || found.is_nan() {
            return Err(BodyError::NotPositive { name, found });
        }
    }
    if let Some((from_m, to_m)) = model
        .terrain
        .extent_m()
        .filter(|(from_m, to_m)| !(*from_m - ROUNDING_M..=*to_m + ROUNDING_M).contains(&start.position_m))
    {
        return Err(BodyError::OffThePath { found_m: start.position_m, from_m, to_m });
    }
    Ok(())
}

/// The direction of a path on its slope.
fn along_path(track: &Track) -> Vector {
    let (sin, cos) = track.place.heading_rad.sin_cos();
    let level = track.place.cos_slope();
    Vector::new(level * sin, level * cos, track.place.sin_slope)
}
