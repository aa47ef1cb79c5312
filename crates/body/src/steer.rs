//! A driver who steers along the path, and the angles of the wheels.
//!
//! κ = 2 y / L²                                  pure pursuit of a point L away, y to the left
//! tan δ_i = κ (x_i − x₀) / (1 − κ y_i)          every wheel square to the line to the centre of the turn
//!
//! Sources: Coulter, *Implementation of the Pure Pursuit Path Tracking Algorithm* (1992); Ackermann's condition, as in
//! Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter D. x₀ is where the axle that does not steer
//! stands, or the middle of a vehicle whose axles all do.
//! A driver who goes backward aims at a point of the path behind; the circle through it is the same formula.
//! One who pushes a trailer backward aims with the trailer's axle, and turns the hitch to the angle of that circle:
//!
//! κ₁ = κ₂ / √(1 + κ₂² (l² − m²)),  β₂ = atan l κ₂ + atan m κ₁      steady: κ₂ of the trailer's axle, l behind the hitch, m behind x₀
//! dβ/ds = κ (1 + (m/l) cos β) − sin β / l                          the hitch angle along the way
//! κ = (sin β / l + k (β₂ − β)) / (1 + (m/l) cos β),  k < 0 going back  so β comes to β₂ as exp(−|k s|), where left alone it grows
//!
//! Source: the hitch angle as the inner loop of two, Pradalier and Usher, *Robust trajectory tracking for a reversing
//! tractor-trailer system*, Journal of Field Robotics 25 (2008); its kinematics inverted instead of linearised.
//! Wheels turn no further and no faster than the steering lets them.

use crate::chassis::{Steering, SteeringMode};
use headland_sim::Axles;

/// Part of the steering that a steady turn with a trailer behind may take.
const RESERVE: f64 = 0.8;
/// A trailer turns on no smaller radius than this part of its length.
const TIGHTEST: f64 = 0.25;
/// The hitch settles within this part of the look ahead, so that the trailer follows what is aimed at.
const SETTLES: f64 = 1.0 / 3.0;

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

/// A trailer that is pushed backward.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pushed {
    /// From the hitch back to its axle, l [m].
    pub length_m: f64,
    /// From x₀ back to the hitch, m [m].
    pub lever_m: f64,
    /// Yaw of the vehicle less that of the trailer, β [rad].
    pub angle_rad: f64,
}

impl Pushed {
    /// The curvature with which the trailer comes to `wanted_per_m` of its own, kept to what a vehicle can that turns by
    /// `most_per_m` at most; the hitch angle settles within `settles_m`.
    fn curvature_per_m(&self, wanted_per_m: f64, most_per_m: f64, settles_m: f64) -> f64 {
        let Self { length_m: l, lever_m: m, angle_rad } = *self;
        // What the steering can hold, less a reserve without which it could not turn back.
        let (tightest_m, least_m) = (1.0 / (RESERVE * most_per_m), TIGHTEST * l);
        let own_m = (tightest_m * tightest_m + m * m - l * l).max(least_m * least_m).sqrt();
        let trailer = wanted_per_m.clamp(-1.0 / own_m, 1.0 / own_m);
        let steady = trailer / (1.0 + trailer * trailer * (l * l - m * m)).max(TIGHTEST * TIGHTEST).sqrt();
        let off_rad = (l * trailer).atan() + (m * steady).atan() - angle_rad;
        (angle_rad.sin() / l - off_rad / settles_m) / (1.0 + m / l * angle_rad.cos())
    }
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

    /// Whether the vehicle goes aslant.
    pub fn aslant(&self) -> bool {
        matches!(self.steering.mode, SteeringMode::Crab { .. })
    }

    /// Turns the wheels for one step of a vehicle that pushes a trailer backward; the aim is that of the trailer's axle.
    pub fn push(&mut self, pushed: &Pushed, aim: Aim, step_s: f64) {
        let Steering { limit_rad, rate_rad_s, look_ahead_m, .. } = self.steering;
        let far_m = aim.ahead_m.hypot(aim.left_m);
        let wanted_per_m = 2.0 * aim.left_m / (far_m * far_m);
        let most_per_m = limit_rad.tan() / self.lever_m;
        let curvature = pushed.curvature_per_m(wanted_per_m, most_per_m, SETTLES * look_ahead_m);
        let most = rate_rad_s * step_s;
        let wanted = (self.lever_m * curvature).atan().clamp(-limit_rad, limit_rad);
        self.turned_rad += (wanted - self.turned_rad).clamp(-most, most);
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
