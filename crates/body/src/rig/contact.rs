//! The wheels of a body: as they are built, where they meet the ground, and what it does to the body through them.
//!
//! E = ½ I ω² + Σ (J Ω ω + ½ J Ω²)        a body that tilts with ω, and wheels that turn in it with Ω = w / r about the same axis
//! I dω/dt = M − Σ J dΩ/dt                what spins a wheel up turns the body back
//! J dΩ/dt = T − G r − J dω/dt            and what tilts the body slows the wheel in it
//!
//! Source: Lagrange's equations of E; I has the wheels in it. dω/dt is that of the step before, and where brakes stop a wheel
//! within a step, and with that turn the body, that of this one too: the brakes take it.

use crate::chassis::Chassis;
use crate::ground::Ground;
use crate::spin::Spin;
use crate::standing::below;
use crate::wheel::{Felt, Strut, Touch, Wheel};
use crate::world::State;
use headland_sim::Axles;
use rapier3d_f64::prelude::Vector;

/// All wheels of a vehicle as it stands with its weight, axle by axle, the left one first.
pub(crate) fn wheels<'a>(
    axles: &'a Axles,
    chassis: &Chassis,
    (mass_kg, gravity_m_s2): (f64, f64),
) -> Vec<Wheel<'a>> {
    let weight_n = mass_kg * gravity_m_s2;
    let mut wheels = Vec::new();
    for (index, axle) in axles.list().iter().enumerate() {
        let of_tyre = |tyres: f64| tyres * axle.tyre.stiffness_n_per_m();
        let sides: &[(&str, f64)] =
            if axle.wheels == 1 { &[("middle", 0.0)] } else { &[("left", 0.5), ("right", -0.5)] };
        for (side, part) in sides {
            let tyres = f64::from(axle.wheels) / sides.len() as f64;
            let given_m = axles.load_n(index, weight_n, 0.0) / of_tyre(f64::from(axle.wheels));
            let hub_m = 0.5 * axle.tyre.diameter_m - given_m;
            wheels.push(Wheel {
                name: format!("axle_{}_{side}", index + 1),
                told: format!("the {side} wheel of axle {}", index + 1),
                axle: index,
                arm: Vector::new(
                    axle.position_m,
                    part * axle.track_m,
                    hub_m - axles.centre_of_gravity_height_m,
                ),
                tyre: &axle.tyre,
                tyres,
                body: chassis.axles[index],
                stiffness_n_m: of_tyre(tyres),
                damping_n_s_m: tyres * chassis.axles[index].damping_n_s_m,
                earlier: axles.earlier(index, false),
                // The chord of a circle that the ground cuts off.
                footprint_m: ((axle.tyre.diameter_m - given_m) * given_m).max(0.0).sqrt(),
                strut: chassis.axles[index].suspension.map(|own| {
                    let load_n = axles.load_n(index, weight_n, 0.0) / sides.len() as f64;
                    Strut::level(own, load_n, gravity_m_s2)
                }),
                slip: 0.0,
                side: 0.0,
                sinkage_m: 0.0,
                sinking_m_s: 0.0,
                radius_m: hub_m,
                tilting_n: 0.0,
                touch: Touch::default(),
                felt: Felt::default(),
            });
        }
    }
    wheels
}

/// Lets wheels of a body meet the ground below them, steered by an angle; gives what is wrong.
pub(super) fn touch(
    wheels: &mut [Wheel],
    state: &State,
    ground: &Ground,
    angle_rad: impl Fn(&Wheel) -> f64,
) -> Option<String> {
    let axes = (state.ahead(), state.left());
    let mut trouble = None;
    for wheel in wheels {
        let hub = state.point(wheel.arm);
        match below(ground, wheel, hub, axes.0) {
            Ok(spot) => {
                let angle_rad = angle_rad(wheel);
                wheel.meet(hub, &spot, axes, angle_rad, |point| state.velocity_at(point));
            }
            Err(_) => {
                trouble = Some(format!(
                    "{} comes to the edge of the map, {:.1} m east and {:.1} m north of its origin",
                    wheel.told, hub.x, hub.y
                ));
            }
        }
    }
    trouble
}

/// How far a tyre of a body gives way now [m].
pub(super) fn deflection_m(wheel: &Wheel, state: &State, ground: &Ground) -> f64 {
    let hub = state.point(wheel.arm);
    below(ground, wheel, hub, state.ahead()).map_or(0.0, |spot| {
        0.5 * wheel.tyre.diameter_m - Wheel::above(hub, &spot).0 - wheel.sinkage_m - wheel.raised_m()
    })
}

/// What the ground does to a body through its wheels: force, and moment about the centre of gravity.
pub(super) fn forces(wheels: &[Wheel], spin: &Spin, state: &State, way: f64) -> (Vector, Vector) {
    let (mut force, mut moment) = (Vector::ZERO, Vector::ZERO);
    for (index, wheel) in wheels.iter().enumerate() {
        let (own, held) = (wheel.force_n(), wheel.touch.along * (-way * wheel.felt.resistance_n));
        force += own + held;
        moment += (wheel.touch.point - state.centre).cross(own);
        moment += (wheel.touch.hub() - state.centre).cross(held);
        // What spins a wheel up turns the vehicle back.
        let inertia = spin.masses_kg[index] * wheel.radius_m;
        moment -= wheel.touch.across * (inertia * spin.changes_m_s2[index]);
    }
    (force, moment)
}

/// What keeps wheels turning with a body as it tilts from `before` to `after`; gives what of it acted on wheels that brakes
/// stopped in this very step, which the brakes did not have to take [J].
pub(super) fn tilt(wheels: &mut [Wheel], spin: &Spin, (before, after): (&State, &State), step_s: f64) -> f64 {
    let change = (after.turning - before.turning) / step_s;
    let mut spared_j = 0.0;
    for (index, wheel) in wheels.iter_mut().enumerate() {
        let tilting_n = spin.masses_kg[index] * wheel.radius_m * wheel.touch.across.dot(change);
        let stopped_m = spin.stopped_m[index];
        spared_j += tilting_n * stopped_m;
        wheel.tilting_n = if stopped_m == 0.0 { tilting_n } else { 0.0 };
    }
    spared_j
}

/// Kinetic energy of wheels that turn in a body that tilts, beside what each has by itself: J Ω ω [J].
pub(super) fn tilted_j(wheels: &[Wheel], spin: &Spin, state: &State) -> f64 {
    let own = |(index, wheel): (usize, &Wheel)| {
        let tilting_m_s = wheel.radius_m * wheel.touch.across.dot(state.turning);
        spin.masses_kg[index] * spin.wheels_m_s[index] * tilting_m_s
    };
    wheels.iter().enumerate().map(own).sum()
}
