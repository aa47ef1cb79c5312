//! Where a vehicle stands at rest: height, roll and pitch at which tyres and weight balance.
//!
//! Newton's method on three numbers. On a slope the ground holds along itself what the vehicle would slide with, as under
//! braked wheels.

use crate::BodyError;
use crate::ground::Ground;
use crate::wheel::Wheel;
use headland_plugin::{Place, Soil, Spot, WheelContact};
use rapier3d_f64::prelude::{Pose, Rotation, Vector};

/// The weight that stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weight {
    pub newtons: f64,
    /// Its centre in the axes of the vehicle [m].
    pub centre: Vector,
    /// Height of the vehicle's own centre of gravity above level ground [m].
    pub height_m: f64,
}

/// The ground that a wheel rests on, or why there is nothing: the mean over the length of its tyre's footprint by Simpson's
/// rule, as a tyre bridges what is shorter than that. `ahead` is the way the vehicle points.
pub(crate) fn below(ground: &Ground, wheel: &Wheel, hub: Vector, ahead: Vector) -> Result<Spot, BodyError> {
    const WEIGHTS: [(f64, f64); 3] = [(0.0, 4.0 / 6.0), (1.0, 1.0 / 6.0), (-1.0, 1.0 / 6.0)];
    let mut mean = Spot::default();
    for (part, weight) in WEIGHTS {
        let point = hub + ahead * (part * wheel.footprint_m);
        let spot = ground.spot(point.x, point.y).ok_or_else(|| BodyError::OffTheMap {
            wheel: wheel.told.clone(),
            east_m: point.x,
            north_m: point.y,
        })?;
        mean.height_m += weight * spot.height_m;
        mean.rise_east += weight * spot.rise_east;
        mean.rise_north += weight * spot.rise_north;
    }
    Ok(mean)
}

/// Finds the pose at a place and heading, and leaves the wheels as they stand there.
pub(crate) fn stand(
    wheels: &mut [Wheel],
    ground: &Ground,
    soil: &dyn Soil,
    weight: Weight,
    place: &Place,
    yaw_rad: f64,
) -> Result<Pose, BodyError> {
    const MOST_ITERATIONS: usize = 500;
    /// Forces balance to this part of the weight.
    const BALANCED: f64 = 1e-12;
    /// What a wheel in the air counts for, so that three equations keep three unknowns.
    const IN_THE_AIR: f64 = 1e-2;
    /// An iteration goes no further than this: wheels come to the ground and leave it on the way [m, rad].
    const FURTHEST_M: f64 = 0.1;
    const FURTHEST_RAD: f64 = 0.05;
    /// None stands that leans further than 60° [1].
    const LEANING: f64 = 0.5;
    let up = Vector::Z;
    let spot = ground.spot(place.east_m, place.north_m);
    let spot = spot.unwrap_or(Spot { height_m: place.elevation_m, ..Spot::default() });
    let normal = Vector::new(-spot.rise_east, -spot.rise_north, 1.0).normalize();
    let mut origin = Vector::new(place.east_m, place.north_m, spot.height_m) + normal * weight.height_m;
    let mut turn = (Rotation::from_rotation_arc(up, normal) * Rotation::from_rotation_z(yaw_rad)).normalize();
    for _ in 0..MOST_ITERATIONS {
        let axes = [turn * Vector::X, turn * Vector::Y, turn * up];
        let centre = origin + turn * weight.centre;
        let (mut force, mut moment, mut middle, mut loads) = (Vector::ZERO, Vector::ZERO, Vector::ZERO, 0.0);
        let mut stiff = [[0.0; 3]; 3];
        for wheel in wheels.iter_mut() {
            let hub = origin + turn * wheel.arm;
            let (height_m, normal) = Wheel::above(hub, &below(ground, wheel, hub, axes[0])?);
            let deflection_m = 0.5 * wheel.tyre.diameter_m - height_m - wheel.sinkage_m;
            wheel.stand(deflection_m, normal.z);
            wheel.touch.height_m = height_m;
            let load_n = wheel.touch.load_n;
            let point = hub - normal * height_m;
            force += normal * load_n;
            moment += (point - centre).cross(normal * load_n);
            middle += point * load_n;
            loads += load_n;
            let arm = wheel.arm - weight.centre;
            let lever = [1.0, arm.y, -arm.x];
            let k = wheel.standing_n_m() * if load_n > 0.0 { 1.0 } else { IN_THE_AIR };
            for (row, a) in stiff.iter_mut().zip(lever) {
                for (cell, b) in row.iter_mut().zip(lever) {
                    *cell += k * a * b;
                }
            }
            sink(wheel, soil, place);
        }
        let needed = up * weight.newtons - force;
        if loads > 0.0 {
            let held = needed - axes[2] * needed.dot(axes[2]);
            moment += (middle / loads - centre).cross(held);
        }
        let off = [-needed.dot(axes[2]), moment.dot(axes[0]), moment.dot(axes[1])];
        if off.iter().all(|one| one.abs() <= BALANCED * weight.newtons) {
            return Ok(Pose::from_parts(origin, turn));
        }
        let [rise, roll, pitch] = solved(stiff, off);
        if !(rise.is_finite() && roll.is_finite() && pitch.is_finite() && axes[2].z > LEANING) {
            return Err(BodyError::NoRest);
        }
        let longest = (rise / FURTHEST_M).abs().max(roll.hypot(pitch) / FURTHEST_RAD).max(1.0);
        let [rise, roll, pitch] = [rise, roll, pitch].map(|part| part / longest);
        origin += axes[2] * rise;
        turn = (turn * Rotation::from_scaled_axis(Vector::new(roll, pitch, 0.0))).normalize();
    }
    Err(BodyError::NoRest)
}

/// The rut that a wheel has made where it stands.
fn sink(wheel: &mut Wheel, soil: &dyn Soil, place: &Place) {
    let footing = soil.wheel(&WheelContact {
        tyre: wheel.tyre,
        load_n: wheel.touch.load_n / wheel.tyres,
        slip: 0.0,
        speed_m_s: 0.0,
        earlier_passes: wheel.earlier,
        position_m: 0.0,
        place: *place,
    });
    if let Some(footing) = footing.filter(|footing| footing.sinkage_m.is_finite()) {
        wheel.sinkage_m = footing.sinkage_m;
    }
}

/// Three equations by Cramer's rule.
fn solved(m: [[f64; 3]; 3], right: [f64; 3]) -> [f64; 3] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let determinant = dot(m[0], cross(m[1], m[2]));
    // The matrix is symmetric, so its rows are its columns.
    [
        dot(right, cross(m[1], m[2])) / determinant,
        dot(m[0], cross(right, m[2])) / determinant,
        dot(m[0], cross(m[1], right)) / determinant,
    ]
}
