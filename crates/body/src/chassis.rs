//! What a rigid body needs to be told beside axles, tyres, masses and heights.

use crate::trailer::Trailer;
use headland_plugin::Refusal;
use headland_sim::Axles;

/// A vehicle as a rigid body on its axles.
#[derive(Clone, Debug, PartialEq)]
pub struct Chassis {
    /// Moment of inertia about the axis that points forward, without what is carried [kg m²].
    pub roll_inertia_kg_m2: f64,
    /// About the axis to the left.
    pub pitch_inertia_kg_m2: f64,
    /// About the upright axis.
    pub yaw_inertia_kg_m2: f64,
    /// Where tasks pull, ahead of the centre of gravity [m]; negative behind it.
    pub hitch_position_m: f64,
    /// Where what is carried lies; `None` where nothing can be carried.
    pub payload: Option<Payload>,
    /// How it is steered.
    pub steering: Steering,
    /// Between the driven axles.
    pub centre: Differential,
    /// What each axle is, in the order of the vehicle's axles.
    pub axles: Vec<AxleBody>,
    /// What is coupled to it; `None` where nothing is.
    pub trailer: Option<Trailer>,
}

/// The place of what is carried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Payload {
    /// Ahead of the vehicle's own centre of gravity [m].
    pub position_m: f64,
    /// Above the ground [m].
    pub height_m: f64,
}

/// How torque is shared between two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Differential {
    /// Equal torques, speeds as they come.
    Open,
    /// Equal speeds, torques as they come.
    Locked,
}

/// Which wheels steer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SteeringMode {
    /// Those ahead of the centre of gravity, about the middle of the others.
    Front,
    /// Those behind it against those ahead, about the centre of gravity.
    All,
    /// All the same way: the vehicle goes aslant, its heading off the path by this angle, clockwise [rad].
    Crab {
        /// Heading of the vehicle less that of the path [rad].
        angle_rad: f64,
    },
}

/// A driver who steers along the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steering {
    /// Which wheels steer.
    pub mode: SteeringMode,
    /// The furthest that wheels turn either way [rad].
    pub limit_rad: f64,
    /// How fast they are turned [rad/s].
    pub rate_rad_s: f64,
    /// How far ahead the driver aims [m].
    pub look_ahead_m: f64,
}

/// Tyres and gears of an axle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxleBody {
    /// Damping of each tyre [N s/m].
    pub damping_n_s_m: f64,
    /// The most that a tyre holds along the wheel, per load.
    pub friction: f64,
    /// The most that it holds across the wheel, per load; together they are the half axes of an ellipse.
    pub side_friction: f64,
    /// Force along the wheel per load and slip, on ground that knows no slip.
    pub slip_stiffness: f64,
    /// Force across the wheel per load and slip angle [1/rad].
    pub cornering_stiffness_per_rad: f64,
    /// Way on which a tyre comes to its slip [m].
    pub relaxation_length_m: f64,
    /// Between its wheels, where it is driven.
    pub differential: Differential,
    /// Between its wheels and the chassis; `None` where only tyres spring.
    pub suspension: Option<Suspension>,
}

/// Spring and damper between the wheels of one side and the chassis, in line with their tyres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Suspension {
    /// Of each side [N/m].
    pub stiffness_n_m: f64,
    /// Of each side, more than 0 [N s/m].
    pub damping_n_s_m: f64,
    /// Mass of the wheels of each side and what moves with them, part of that of the vehicle [kg]; 0 where it goes with the
    /// chassis.
    pub unsprung_mass_kg: f64,
}

impl Chassis {
    /// Whether it suits the axles, and is a body that can be.
    ///
    /// # Errors
    /// [`Refusal`] names the parameter, as `axles.0.friction`.
    pub fn check(&self, axles: &Axles) -> Result<(), Refusal> {
        let refuse = |parameter: &str, found: String, expected: &str| {
            Err(Refusal { parameter: parameter.to_owned(), found, expected: expected.to_owned() })
        };
        if self.axles.len() != axles.list().len() {
            let expected = format!("{}, one for each of the vehicle's axles", axles.list().len());
            return refuse("axles", format!("a list of {}", self.axles.len()), &expected);
        }
        if let Some(index) = axles.list().iter().position(|axle| axle.wheels != 1 && axle.wheels % 2 == 1) {
            let found = format!("axle {} has {} wheels", index + 1, axles.list()[index].wheels);
            return refuse("axles", found, "one in the middle, or as many left as right");
        }
        let inertias = [
            ("roll_inertia_kg_m2", self.roll_inertia_kg_m2),
            ("pitch_inertia_kg_m2", self.pitch_inertia_kg_m2),
            ("yaw_inertia_kg_m2", self.yaw_inertia_kg_m2),
        ];
        let sum: f64 = inertias.iter().map(|(_, inertia)| inertia).sum();
        for (name, inertia) in inertias {
            if 2.0 * inertia > sum * (1.0 + f64::EPSILON) {
                let expected = "no more than the other two together: no body has such a one";
                return refuse(name, inertia.to_string(), expected);
            }
        }
        let ahead = axles.list().iter().filter(|axle| axle.position_m > 0.0).count();
        if self.steering.mode == SteeringMode::Front && (ahead == 0 || ahead == axles.list().len()) {
            let expected = "axles ahead of the centre of gravity and behind it";
            return refuse("steering", "Front".to_owned(), expected);
        }
        if let SteeringMode::Crab { angle_rad } = self.steering.mode
            && angle_rad.abs() > self.steering.limit_rad
        {
            let expected = format!(
                "at most `limit_rad`, {}, either way: wheels turn no further",
                self.steering.limit_rad
            );
            return refuse("steering.mode", format!("a crab of {angle_rad} rad"), &expected);
        }
        self.trailer.as_ref().map_or(Ok(()), Trailer::check)
    }
}
