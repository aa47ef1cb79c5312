//! The vehicle as rapier sees it: one body, and a trailer's coupled to it, under gravity and forces that are new each step.

use crate::chassis::{Chassis, Payload};
use rapier3d_f64::prelude::{
    MassProperties, PhysicsWorld, Pose, RigidBody, RigidBodyBuilder, RigidBodyHandle, SphericalJointBuilder,
    Vector,
};

/// Rapier's world and the body in it.
pub(crate) struct World {
    physics: PhysicsWorld,
    body: RigidBodyHandle,
    towed: Option<RigidBodyHandle>,
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("World").field("body", &self.body).finish_non_exhaustive()
    }
}

/// Motion of the body at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    /// Pose of the vehicle's own centre of gravity.
    pub pose: Pose,
    /// Centre of gravity with what is carried.
    pub centre: Vector,
    /// Its velocity [m/s].
    pub velocity: Vector,
    /// Angular velocity [rad/s].
    pub turning: Vector,
}

impl State {
    /// At rest at a pose, its centre of gravity there.
    pub fn at(pose: Pose) -> Self {
        Self { pose, centre: pose.translation, velocity: Vector::ZERO, turning: Vector::ZERO }
    }

    fn of(body: &RigidBody) -> Self {
        Self {
            pose: *body.position(),
            centre: body.center_of_mass(),
            velocity: body.linvel(),
            turning: body.angvel(),
        }
    }

    pub fn ahead(&self) -> Vector {
        self.pose.rotation * Vector::X
    }

    pub fn left(&self) -> Vector {
        self.pose.rotation * Vector::Y
    }

    pub fn up(&self) -> Vector {
        self.pose.rotation * Vector::Z
    }

    /// A point of the vehicle's own axes in the world.
    pub fn point(&self, arm: Vector) -> Vector {
        self.pose.translation + self.pose.rotation * arm
    }

    /// Velocity of what is fixed to the vehicle at a point of the world [m/s].
    pub fn velocity_at(&self, point: Vector) -> Vector {
        self.velocity + self.turning.cross(point - self.centre)
    }

    /// Speed along the vehicle [m/s].
    pub fn speed_m_s(&self) -> f64 {
        self.velocity.dot(self.ahead())
    }
}

/// Mass, its centre and its inertia with what is carried.
pub(crate) fn properties(chassis: &Chassis, own_kg: f64, height_m: f64, mass_kg: f64) -> MassProperties {
    let own = Vector::new(chassis.roll_inertia_kg_m2, chassis.pitch_inertia_kg_m2, chassis.yaw_inertia_kg_m2);
    let carried_kg = mass_kg - own_kg;
    let (Some(Payload { position_m, height_m: at_m }), true) = (chassis.payload, carried_kg != 0.0) else {
        return MassProperties::new(Vector::ZERO, mass_kg, own);
    };
    // What is carried is a point; it lies in the middle of the vehicle's width, so the axes stay principal but for the
    // product of inertia about the left axis, which the matrix holds.
    let (x, z) = (position_m, at_m - height_m);
    let share = carried_kg / mass_kg;
    let reduced_kg = carried_kg * (1.0 - share);
    let inertia = rapier3d_f64::math::Matrix::from_cols(
        Vector::new(own.x + reduced_kg * z * z, 0.0, -reduced_kg * x * z),
        Vector::new(0.0, own.y + reduced_kg * (x * x + z * z), 0.0),
        Vector::new(-reduced_kg * x * z, 0.0, own.z + reduced_kg * x * x),
    );
    MassProperties::with_inertia_matrix(Vector::new(share * x, 0.0, share * z), mass_kg, inertia)
}

impl World {
    pub fn new(pose: Pose, properties: MassProperties, velocity: Vector, gravity_m_s2: f64) -> Self {
        let mut physics = PhysicsWorld::new();
        physics.gravity = Vector::new(0.0, 0.0, -gravity_m_s2);
        // Nothing touches and no joint holds: one pass is Euler's half-implicit rule, and more would change nothing else.
        physics.integration_parameters.num_solver_iterations = 1;
        // Rapier would hold bodies to 400 m/s and an eighth of a turn in a step, and stand still those whose speed has no square.
        physics.integration_parameters.normalized_max_linear_velocity = f64::MAX;
        let body: RigidBody = RigidBodyBuilder::dynamic()
            .pose(pose)
            .linvel(velocity)
            .additional_mass_properties(properties)
            .allow_fast_rotation(true)
            .can_sleep(false)
            .build();
        let body = physics.insert_body(body);
        let mut world = Self { physics, body, towed: None };
        world.physics.bodies[body].recompute_mass_properties_from_colliders(&world.physics.colliders);
        world
    }

    pub fn state(&self) -> State {
        State::of(&self.physics.bodies[self.body])
    }

    /// Motion of the trailer; `None` where there is none.
    pub fn towed(&self) -> Option<State> {
        self.towed.map(|body| State::of(&self.physics.bodies[body]))
    }

    /// Couples a trailer, whose axes begin in the coupling, at a point of the vehicle's axes.
    pub fn couple(&mut self, pose: Pose, properties: MassProperties, velocity: Vector, hitch: Vector) {
        /// Passes over the coupling in each step: what they leave is below the rounding of a step.
        const PASSES: usize = 16;
        let trailer: RigidBody = RigidBodyBuilder::dynamic()
            .pose(pose)
            .linvel(velocity)
            .additional_mass_properties(properties)
            .allow_fast_rotation(true)
            .can_sleep(false)
            .build();
        let trailer = self.physics.insert_body(trailer);
        self.physics.bodies[trailer].recompute_mass_properties_from_colliders(&self.physics.colliders);
        let joint = SphericalJointBuilder::new().local_anchor1(hitch).local_anchor2(Vector::ZERO);
        self.physics.insert_impulse_joint(self.body, trailer, joint);
        self.physics.integration_parameters.num_internal_pgs_iterations = PASSES;
        self.towed = Some(trailer);
    }

    pub fn kinetic_j(&self) -> f64 {
        let all = [Some(self.body), self.towed].into_iter().flatten();
        all.map(|body| self.physics.bodies[body].kinetic_energy()).sum()
    }

    /// Other mass properties at the same velocity of the vehicle.
    pub fn load(&mut self, properties: MassProperties) {
        self.load_body(self.body, properties);
    }

    /// The same of the trailer.
    pub fn load_towed(&mut self, properties: MassProperties) {
        if let Some(towed) = self.towed {
            self.load_body(towed, properties);
        }
    }

    fn load_body(&mut self, body: RigidBodyHandle, properties: MassProperties) {
        let colliders = &self.physics.colliders;
        let body = &mut self.physics.bodies[body];
        body.set_additional_mass_properties(properties, true);
        body.recompute_mass_properties_from_colliders(colliders);
    }

    fn push(&mut self, body: RigidBodyHandle, (force, moment): (Vector, Vector)) {
        let body = &mut self.physics.bodies[body];
        body.reset_forces(true);
        body.reset_torques(true);
        body.add_force(force, true);
        body.add_torque(moment, true);
    }

    /// Whether the last step left motions, and an energy, that are numbers. Rapier stands still what has no finite motion, and tells
    /// in its quarantine alone.
    pub fn is_finite(&self) -> bool {
        self.physics.quarantine().is_empty() && self.kinetic_j().is_finite()
    }

    /// Puts the vehicle, and its trailer, back to how they moved.
    pub fn put_back(&mut self, own: &State, towed: Option<&State>) {
        for (body, state) in std::iter::once(self.body).zip([own]).chain(self.towed.into_iter().zip(towed)) {
            let body = &mut self.physics.bodies[body];
            body.set_position(state.pose, true);
            body.set_linvel(state.velocity, true);
            body.set_angvel(state.turning, true);
        }
    }

    /// One step under a force in the centre of gravity [N] and a moment about it [N m], and the same of the trailer.
    pub fn step(&mut self, own: (Vector, Vector), towed: (Vector, Vector), step_s: f64) {
        self.push(self.body, own);
        if let Some(trailer) = self.towed {
            self.push(trailer, towed);
        }
        self.physics.integration_parameters.dt = step_s;
        self.physics.step();
    }
}
