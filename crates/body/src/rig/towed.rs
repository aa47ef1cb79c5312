//! A trailer in motion: a body of its own, coupled to the vehicle, on wheels that nothing drives.
//!
//! F = m (v₁ − v₀) / dt − m g − Σ F_wheel        what the coupling gives it, from its motion over a step
//!
//! What resists its wheels is told by its task, as in one dimension; the wheels share it by their loads.

use super::contact::{deflection_m, forces, tilt, touch};
use crate::accounts::{Own, Step};
use crate::ground::Ground;
use crate::hop::{self, Bearer};
use crate::pace::{self, Carried};
use crate::spin::{Spin, Turned};
use crate::standing::below;
use crate::trailer::Trailer;
use crate::wheel::{Felt, Scene, Strut, Touch, Wheel};
use crate::world::{State, World};
use crate::{BodyError, Chassis};
use headland_plugin::{Contact, Mode, Place, Situation, Soil};
use headland_sim::{Model, Push, Stepped};
use rapier3d_f64::math::Matrix;
use rapier3d_f64::prelude::{MassProperties, Pose, Rotation, Vector};

/// A trailer behind its vehicle.
#[derive(Debug)]
pub(crate) struct Towed<'a> {
    trailer: &'a Trailer,
    pub wheels: Vec<Wheel<'a>>,
    pub spin: Spin,
    pub state: State,
    pub mass_kg: f64,
    carried_share: f64,
    /// Height of the coupling above level ground [m].
    coupling_height_m: f64,
    /// What the coupling gives the trailer: ahead of the vehicle and up [N].
    pub pull_n: f64,
    pub load_n: f64,
    /// The same in the axes of the world.
    given: Vector,
    resistance_n: f64,
    /// Inverse of its inertia.
    inverse: Matrix,
}

/// The resistance of all its wheels, whatever the ground [N].
#[derive(Debug)]
struct Rolling(f64);

impl Soil for Rolling {
    fn resistance_n(&self, _: &Contact) -> f64 {
        self.0
    }
}

/// Mass that tasks tow, and the share of it that the vehicle carries, where a run begins.
fn towed_at_start(model: &Model) -> (f64, f64) {
    let at = Situation { gravity_m_s2: model.gravity_m_s2, air: model.air, ..Situation::default() };
    let (mut towed_kg, mut carried_kg) = (0.0, 0.0);
    for task in &model.tasks {
        let states: Vec<f64> = task.plugin.states().iter().map(|state| state.initial).collect();
        let load = task.plugin.load_in(Mode::Rest, &at, &states, &mut vec![0.0; states.len()]);
        if load.towed_mass_kg > 0.0 {
            towed_kg += load.towed_mass_kg;
            carried_kg += load.mass_kg;
        }
    }
    let mass_kg = towed_kg + carried_kg;
    (mass_kg, if mass_kg > 0.0 { carried_kg / mass_kg } else { 0.0 })
}

impl<'a> Towed<'a> {
    /// The trailer of a vehicle, not yet on its ground; `None` where it has none.
    pub fn of(model: &Model, chassis: &'a Chassis, hitch_height_m: f64) -> Result<Option<Self>, BodyError> {
        let Some(trailer) = &chassis.trailer else { return Ok(None) };
        trailer.check()?;
        let (mass_kg, carried_share) = towed_at_start(model);
        if mass_kg <= 0.0 {
            return Err(BodyError::NothingTowed);
        }
        let weight_n = (1.0 - carried_share) * mass_kg * model.gravity_m_s2;
        let wheels = wheels(trailer, (weight_n, model.gravity_m_s2), hitch_height_m);
        let tyres: Vec<f64> = wheels.iter().map(|wheel| wheel.tyres).collect();
        Ok(Some(Self {
            spin: Spin::free(&tyres, trailer.rotating_mass_kg, 0.0),
            given: Vector::Z * (carried_share * mass_kg * model.gravity_m_s2),
            inverse: Matrix::IDENTITY,
            state: State::at(Pose::IDENTITY),
            trailer,
            wheels,
            mass_kg,
            carried_share,
            coupling_height_m: hitch_height_m,
            pull_n: 0.0,
            load_n: carried_share * mass_kg * model.gravity_m_s2,
            resistance_n: 0.0,
        }))
    }

    /// How far the mean of its axles is behind the coupling [m].
    pub fn behind_m(&self) -> f64 {
        self.trailer.behind_m()
    }

    /// That mean, at the height of the coupling.
    pub fn middle(&self) -> Vector {
        self.state.pose.translation - self.state.ahead() * self.behind_m()
    }

    /// What presses on the hitch at rest [N].
    pub fn pressing_n(&self, gravity_m_s2: f64) -> f64 {
        self.carried_share * self.mass_kg * gravity_m_s2
    }

    /// Its centre of gravity, from the coupling [m].
    pub fn centre(&self) -> Vector {
        let behind_m = (1.0 - self.carried_share) * self.trailer.behind_m();
        Vector::new(-behind_m, 0.0, self.trailer.centre_of_gravity_height_m - self.coupling_height_m)
    }

    fn properties(&self) -> MassProperties {
        let Trailer { roll_radius_m, pitch_radius_m, yaw_radius_m, .. } = *self.trailer;
        let inertia = Vector::new(roll_radius_m, pitch_radius_m, yaw_radius_m).map(|radius| radius * radius);
        MassProperties::new(self.centre(), self.mass_kg, inertia * self.mass_kg)
    }

    /// Couples it to a vehicle that stands, in line with it, its tyres as they are on level ground.
    pub fn couple(
        &mut self,
        world: &mut World,
        ground: &Ground,
        (vehicle, hitch): (&State, Vector),
        speed_m_s: f64,
    ) -> Result<(), BodyError> {
        /// Each turns the trailer by what is left of its wheels' height over their middle.
        const ITERATIONS: usize = 100;
        let coupling = vehicle.point(hitch);
        let mut turn = vehicle.pose.rotation;
        let count = self.wheels.len() as f64;
        for _ in 0..ITERATIONS {
            let (mut rise, mut roll) = (0.0, 0.0);
            for wheel in &self.wheels {
                let hub = coupling + turn * wheel.arm;
                let (height_m, _) = Wheel::above(hub, &below(ground, wheel, hub, turn * Vector::X)?);
                let lacks_m = 0.5 * wheel.tyre.diameter_m - wheel.touch.deflection_m - height_m;
                rise += lacks_m / count;
                roll += lacks_m / (count * wheel.arm.y);
            }
            let pitch = rise / self.trailer.behind_m();
            turn = (turn * Rotation::from_scaled_axis(Vector::new(roll, pitch, 0.0))).normalize();
        }
        let velocity = vehicle.velocity;
        self.spin = Spin::free(
            &self.wheels.iter().map(|wheel| wheel.tyres).collect::<Vec<_>>(),
            self.trailer.rotating_mass_kg,
            speed_m_s,
        );
        let properties = self.properties();
        self.inverse = properties.reconstruct_inverse_inertia_matrix();
        world.couple(Pose::from_parts(coupling, turn), properties, velocity, hitch);
        self.read(world);
        Ok(())
    }

    /// Takes its motion from the world.
    fn read(&mut self, world: &World) {
        if let Some(state) = world.towed() {
            self.state = state;
        }
    }

    /// Refuses a step that is too long for its wheels.
    pub fn check_step(&self, step_s: f64, speed_m_s: f64) -> Result<(), BodyError> {
        let Trailer { roll_radius_m, pitch_radius_m, .. } = *self.trailer;
        let lever_m = self.centre().x;
        let carried = Carried {
            mass_kg: self.mass_kg,
            roll_kg_m2: self.mass_kg * roll_radius_m * roll_radius_m,
            pitch_kg_m2: self.mass_kg * (pitch_radius_m * pitch_radius_m + lever_m * lever_m),
        };
        let own_kg_m2 = |radius_m: f64| self.mass_kg * radius_m * radius_m;
        let roll = ("trailer.roll_radius_m", own_kg_m2(roll_radius_m));
        let pitch = ("trailer.pitch_radius_m", own_kg_m2(pitch_radius_m));
        hop::check(&self.wheels, self.centre(), (self.mass_kg, roll, pitch), "trailer.axles.")?;
        pace::check(&self.wheels, &self.spin, &Rolling(0.0), carried, (step_s, speed_m_s))
    }

    /// Takes the mass that its task says; returns the energy that comes with it [J].
    pub fn load(&mut self, world: &mut World, push: &Push) -> f64 {
        self.resistance_n = push.towed_n;
        let mass_kg = push.towed_kg + push.coupled_kg;
        if mass_kg == self.mass_kg {
            return 0.0;
        }
        let before_j = world.kinetic_j();
        self.mass_kg = mass_kg;
        self.carried_share = push.coupled_kg / mass_kg;
        let properties = self.properties();
        self.inverse = properties.reconstruct_inverse_inertia_matrix();
        world.load_towed(properties);
        self.read(world);
        world.kinetic_j() - before_j
    }

    /// Lets its wheels meet and feel the ground, along a step; gives what is wrong.
    pub fn feel(&mut self, ground: &Ground, place: Place, position_m: f64, step_s: f64) -> Option<String> {
        let state = self.state;
        let trouble = touch(&mut self.wheels, &state, ground, |_| 0.0);
        let soil = Rolling(self.resistance_n);
        let scene = Scene {
            soil: &soil,
            place,
            position_m,
            speed_m_s: state.speed_m_s(),
            load_n: self.wheels.iter().map(|wheel| wheel.touch.load_n).sum(),
            slip_limit: 1.0,
        };
        for (index, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.feel(&scene, self.spin.wheels_m_s[index], step_s);
        }
        trouble
    }

    /// Turns its wheels for a step; gives force in its centre of gravity and moment about it.
    pub fn push(&mut self, way: f64, gravity_m_s2: f64, step_s: f64) -> (Vector, Vector, Turned) {
        let wheels = &self.wheels;
        let turning_n = |wheel: usize| wheels[wheel].felt.gross_n + wheels[wheel].tilting_n;
        let turned = self.spin.advance((0.0, 1.0), 0.0, turning_n, step_s);
        let (mut force, mut moment) = forces(&self.wheels, &self.spin, &self.state, way);
        if hop::any(&self.wheels) {
            let bearer = Bearer { mass_kg: self.mass_kg, inverse: &self.inverse, state: &self.state };
            // The coupling gives what it gave in the last step.
            let free = force + self.given - Vector::Z * (self.mass_kg * gravity_m_s2);
            let turning = moment + (self.state.pose.translation - self.state.centre).cross(self.given);
            let (more, turn) = hop::taken_back(&self.wheels, bearer, (free, turning), step_s);
            force += more;
            moment += turn;
        }
        (force, moment, turned)
    }

    /// Books a step that the world made under that force, and adds it to that of the vehicle.
    #[allow(clippy::too_many_arguments, reason = "a step is made of all of these")]
    pub fn book(
        &mut self,
        world: &World,
        rolled_m_s: &[f64],
        (force, turned): (Vector, Turned),
        (way, step_s, gravity_m_s2): (f64, f64, f64),
        vehicle: &State,
        own: &mut Own,
        stepped: &mut Stepped,
    ) {
        let before = self.state;
        self.read(world);
        let weight_n = self.mass_kg * gravity_m_s2;
        let change = (self.state.velocity - before.velocity) * (self.mass_kg / step_s);
        let given = change - force + Vector::Z * weight_n;
        self.given = given;
        (self.pull_n, self.load_n) = (given.dot(vehicle.ahead()), given.dot(vehicle.up()));
        let hitch = before.pose.translation;
        hop::follow(&mut self.wheels, (&before, &self.state), step_s);
        tilt(&mut self.wheels, &self.spin, (&before, &self.state), step_s);
        let step =
            Step { before: &before, after: &self.state, lasts_s: step_s, way, weight_n, hitch, turned };
        let rolling = |wheel: usize| 0.5 * (rolled_m_s[wheel] + self.spin.wheels_m_s[wheel]);
        let taken = step.work(&self.wheels, rolling, own);
        stepped.slip_j += taken.slip_j;
        stepped.slope_j += taken.slope_j;
        stepped.towed_j += taken.soil_j;
        stepped.towed_n = self.resistance_n;
        for wheel in &mut self.wheels {
            wheel.settle(step_s);
        }
    }

    /// What presses the vehicle at its hitch [N], by the last step.
    pub fn pressing(&self) -> Vector {
        -self.given
    }

    /// Energy in its tyres [J].
    pub fn spring_j(&self, ground: &Ground) -> f64 {
        self.wheels.iter().map(|wheel| wheel.spring_j(deflection_m(wheel, &self.state, ground))).sum()
    }

    /// Its heading less that of the vehicle, clockwise [rad].
    pub fn angle_rad(&self, vehicle: &State) -> f64 {
        let (own, other) = (self.state.ahead(), vehicle.ahead());
        (own.x * other.y - own.y * other.x).atan2(own.x * other.x + own.y * other.y)
    }
}

/// Its wheels, with arms from the coupling; they carry `weight_n` at rest.
fn wheels(trailer: &Trailer, (weight_n, gravity_m_s2): (f64, f64), hitch_height_m: f64) -> Vec<Wheel<'_>> {
    let whole_n_m: f64 = trailer.axles.iter().map(Trailer::stiffness_n_m).sum();
    let given_m = weight_n / whole_n_m;
    let mut wheels = Vec::new();
    for (index, axle) in trailer.axles.iter().enumerate() {
        let tyres = f64::from(axle.wheels) / 2.0;
        for (side, part) in [("left", 0.5), ("right", -0.5)] {
            let stiffness_n_m = tyres * axle.tyre.stiffness_n_per_m();
            let load_n = stiffness_n_m * given_m;
            wheels.push(Wheel {
                name: format!("trailer_axle_{}_{side}", index + 1),
                told: format!("the {side} wheel of axle {} of the trailer", index + 1),
                axle: index,
                arm: Vector::new(
                    axle.position_m,
                    part * axle.track_m,
                    0.5 * axle.tyre.diameter_m - given_m - hitch_height_m,
                ),
                tyre: &axle.tyre,
                tyres,
                body: axle.body,
                stiffness_n_m,
                damping_n_s_m: tyres * axle.body.damping_n_s_m,
                earlier: 0,
                footprint_m: ((axle.tyre.diameter_m - given_m) * given_m).max(0.0).sqrt(),
                strut: axle.body.suspension.map(|own| Strut::level(own, load_n, gravity_m_s2)),
                slip: 0.0,
                side: 0.0,
                sinkage_m: 0.0,
                sinking_m_s: 0.0,
                radius_m: 0.5 * axle.tyre.diameter_m - given_m,
                tilting_n: 0.0,
                touch: Touch { deflection_m: given_m, load_n, ..Touch::default() },
                felt: Felt::default(),
            });
        }
    }
    wheels
}
