//! A driver who steers along the path, and the angles of the wheels.
//!
//! κ = 2 y / L²                                  pure pursuit of a point L away, y to the left
//! tan δ_i = κ (x_i − x₀) / (1 − κ y_i)          every wheel square to the line to the centre of the turn
//!
//! Sources: Coulter, *Implementation of the Pure Pursuit Path Tracking Algorithm* (1992); Ackermann's condition, as in
//! Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter D. x₀ is where the axle that does not steer
//! stands, or the middle of a vehicle whose axles all do.
//! A driver who goes backward aims at a point of the path behind; the circle through it is the same formula.
//! Wheels turn no further and no faster than the steering lets them.

use crate::chassis::{Steering, SteeringMode};
use headland_sim::Axles;

/// The steering of a vehicle.
#[derive(Clone, Debug)]
pub(crate) struct Steer {
    steering: Steering,
    /// Where the axle stands that does not steer, x₀ [m].
    pub pivot_m: f64,
    /// Largest distance of a steered axle from there [m].
    lever_m: f64,
    steered: Vec<bool>,
    /// Angle of the axle at that distance [rad].
    turned_rad: f64,
    /// Angle of all wheels alike [rad].
    aslant_rad: f64,
}

/// What the driver sees: the point ahead, in the vehicle's axes from x₀, and how far the heading is off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aim {
    pub ahead_m: f64,
    pub left_m: f64,
    /// Heading that is wanted less that which the vehicle has, counterclockwise [rad].
    pub off_rad: f64,
}

impl Steer {
    pub fn new(steering: Steering, axles: &Axles) -> Self {
        let ahead: Vec<bool> = axles.list().iter().map(|axle| axle.position_m > 0.0).collect();
        let (pivot_m, steered) = match steering.mode {
            SteeringMode::Front => {
                let behind: Vec<f64> =
                    axles.list().iter().map(|axle| axle.position_m).filter(|x| *x <= 0.0).collect();
                (behind.iter().sum::<f64>() / behind.len() as f64, ahead)
            }
            SteeringMode::All | SteeringMode::Crab { .. } => {
                let all: Vec<f64> = axles.list().iter().map(|axle| axle.position_m).collect();
                let (first, last) = all
                    .iter()
                    .fold((f64::NEG_INFINITY, f64::INFINITY), |(most, least), x| (x.max(most), x.min(least)));
                (0.5 * (first + last), vec![true; all.len()])
            }
        };
        let levers = axles.list().iter().zip(&steered).filter(|(_, steered)| **steered);
        let lever_m = levers.map(|(axle, _)| (axle.position_m - pivot_m).abs()).fold(0.0, f64::max);
        Self { steering, pivot_m, lever_m, steered, turned_rad: 0.0, aslant_rad: 0.0 }
    }

    /// How far ahead the driver looks [m].
    pub fn look_ahead_m(&self) -> f64 {
        self.steering.look_ahead_m
    }

    /// Heading of the vehicle less that of the path, counterclockwise [rad].
    pub fn aslant_rad(&self) -> f64 {
        match self.steering.mode {
            SteeringMode::Crab { angle_rad } => -angle_rad,
            SteeringMode::Front | SteeringMode::All => 0.0,
        }
    }

    /// Wheels as they are to be where the vehicle starts: a crab goes aslant from the first.
    pub fn start(&mut self) {
        self.aslant_rad = -self.aslant_rad();
    }

    /// Turns the wheels for one step of a vehicle that goes ahead (`way` 1) or backward (−1).
    pub fn turn(&mut self, aim: Aim, way: f64, step_s: f64) {
        let Steering { limit_rad, rate_rad_s, .. } = self.steering;
        let far_m = aim.ahead_m.hypot(aim.left_m);
        let (curvature, aslant_rad) = match self.steering.mode {
            SteeringMode::Front | SteeringMode::All => (2.0 * aim.left_m / (far_m * far_m), 0.0),
            SteeringMode::Crab { .. } => {
                (way * 2.0 * aim.off_rad / far_m, (way * aim.left_m).atan2(way * aim.ahead_m))
            }
        };
        let most = rate_rad_s * step_s;
        let toward =
            |is: f64, wanted: f64| is + (wanted.clamp(-limit_rad, limit_rad) - is).clamp(-most, most);
        self.turned_rad = toward(self.turned_rad, (self.lever_m * curvature).atan());
        self.aslant_rad = toward(self.aslant_rad, aslant_rad);
    }

    /// Angle of a wheel of an axle at a place, counterclockwise [rad].
    pub fn angle_rad(&self, axle: usize, ahead_m: f64, left_m: f64) -> f64 {
        if !self.steered[axle] {
            return 0.0;
        }
        let curvature = self.turned_rad.tan() / self.lever_m;
        let own = (curvature * (ahead_m - self.pivot_m) / (1.0 - curvature * left_m)).atan();
        own + self.aslant_rad
    }
}
