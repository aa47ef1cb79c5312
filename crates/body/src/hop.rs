//! Masses below the suspension: wheels that hop on their tyres.
//!
//! m_u dw/dt = N − S − m_u g n_z                    a hub that moves with w along the normal n of the ground
//! S = k_s x + c_s dx/dt,  dx/dt = w − n·v          what its suspension carries, squeezed by x
//! F = (S + m_u g n_z + m_u n·a) n − m_u dx/dt dn/dt     what the body feels of it, whose mass has that of the hub in it
//!
//! Source: the quarter car of Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge* (2014), chapter C. Ahead and across a hub
//! goes with the body; along the normal it does not, so its part of the body's inertia is taken back there. The acceleration
//! a of the body at each hub depends on that at all others; with r × n the arm of a hub and M, I mass and inertia of the body,
//!
//! a_i = a_i⁰ + Σ_j (n_i·n_j / M + (r_i × n_i)·I⁻¹ (r_j × n_j)) m_j a_j
//!
//! with a_i⁰ the one without what is taken back. Left out is what a hub that has moved changes of arms and inertia.

use crate::wheel::Wheel;
use crate::world::State;
use headland_plugin::Refusal;
use rapier3d_f64::math::Matrix;
use rapier3d_f64::prelude::Vector;

/// A mass below a suspension, and how it moves.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Unsprung {
    pub mass_kg: f64,
    pub weight_n: f64,
    /// How fast the suspension is squeezed, dx/dt [m/s].
    pub squeezing_m_s: f64,
    /// Speed of the body along the normal at the hub [m/s].
    pub body_m_s: f64,
    /// What the suspension carries, S [N].
    pub carried_n: f64,
    /// What the normal has changed by since the last step.
    pub turned: Vector,
}

impl Unsprung {
    /// Kinetic energy beside what the body has with it [J].
    pub fn kinetic_j(&self) -> f64 {
        0.5 * self.mass_kg * self.squeezing_m_s * (2.0 * self.body_m_s + self.squeezing_m_s)
    }
}

/// What carries hubs: its mass, the inverse of its inertia in its own axes, and its motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bearer<'a> {
    pub mass_kg: f64,
    pub inverse: &'a Matrix,
    pub state: &'a State,
}

fn unsprung<'w>(wheel: &'w Wheel) -> Option<&'w Unsprung> {
    wheel.strut.as_ref().and_then(|strut| strut.unsprung.as_ref())
}

/// Whether any wheel has a mass of its own.
pub(crate) fn any(wheels: &[Wheel]) -> bool {
    wheels.iter().any(|wheel| unsprung(wheel).is_some())
}

/// Kinetic energy of the hubs beside what the body has with them [J].
pub(crate) fn kinetic_j(wheels: &[Wheel]) -> f64 {
    wheels.iter().filter_map(unsprung).map(Unsprung::kinetic_j).sum()
}

/// What is taken back of the inertia of a body that accelerates freely with `acceleration` under a `force` in its centre of
/// gravity and a `moment` about it, weight and coupling included: force and moment.
pub(crate) fn taken_back(
    wheels: &[Wheel],
    bearer: Bearer,
    (force, moment): (Vector, Vector),
    step_s: f64,
) -> (Vector, Vector) {
    let Bearer { mass_kg, inverse, state } = bearer;
    let (mut more, mut turning) = (Vector::ZERO, Vector::ZERO);
    for wheel in wheels {
        let Some(own) = unsprung(wheel) else { continue };
        // What a hub moves with along a normal that turns.
        let turned = own.turned * (-own.mass_kg * own.squeezing_m_s / step_s);
        more += turned;
        turning += (wheel.touch.hub() - state.centre).cross(turned);
    }
    let (force, moment) = (force + more, moment + turning);
    let turn = state.pose.rotation;
    let turned = |moment: Vector| turn * (*inverse * (turn.inverse() * moment));
    let (pushed, spun) = (force / mass_kg, turned(moment));
    // Normal, arm, mass and what a unit force along the normal turns the body by.
    let hubs: Vec<(Vector, Vector, f64, Vector)> = wheels
        .iter()
        .filter_map(|wheel| {
            let own = unsprung(wheel)?;
            let normal = wheel.touch.normal;
            let arm = (wheel.touch.hub() - state.centre).cross(normal);
            Some((normal, arm, own.mass_kg, turned(arm)))
        })
        .collect();
    let mut rows: Vec<Vec<f64>> = hubs
        .iter()
        .enumerate()
        .map(|(i, (normal, arm, ..))| {
            let shared = hubs.iter().enumerate().map(|(j, (other, _, mass, turning))| {
                let one = if i == j { 1.0 } else { 0.0 };
                one - mass * (normal.dot(*other) / mass_kg + arm.dot(*turning))
            });
            shared.chain([normal.dot(pushed) + arm.dot(spun)]).collect()
        })
        .collect();
    let accelerations = solved(&mut rows);
    let (mut force, mut moment) = (more, turning);
    for ((normal, arm, mass, _), acceleration) in hubs.iter().zip(accelerations) {
        force += *normal * (mass * acceleration);
        moment += *arm * (mass * acceleration);
    }
    (force, moment)
}

/// Gauss's elimination with the largest pivot of each column; each row ends with its right side.
fn solved(rows: &mut [Vec<f64>]) -> Vec<f64> {
    let count = rows.len();
    for column in 0..count {
        let largest =
            (column..count).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()));
        rows.swap(column, largest.unwrap_or(column));
        let (upper, lower) = rows.split_at_mut(column + 1);
        let pivot = &upper[column];
        for row in lower {
            let times = row[column] / pivot[column];
            for (cell, above) in row.iter_mut().zip(pivot).skip(column) {
                *cell -= times * above;
            }
        }
    }
    let mut found = vec![0.0; count];
    for index in (0..count).rev() {
        let known: f64 = (index + 1..count).map(|other| rows[index][other] * found[other]).sum();
        found[index] = (rows[index][count] - known) / rows[index][index];
    }
    found
}

/// Moves the hubs on by a step that the body has made.
pub(crate) fn follow(wheels: &mut [Wheel], (before, after): (&State, &State), step_s: f64) {
    for wheel in wheels {
        let (load_n, normal, point) = (wheel.touch.load_n, wheel.touch.normal, wheel.touch.point);
        let Some(strut) = &mut wheel.strut else { continue };
        let Some(own) = &mut strut.unsprung else { continue };
        let was_m_s = own.body_m_s + own.squeezing_m_s;
        let pushed_n = load_n - own.carried_n - own.weight_n * normal.z;
        let hub_m_s = was_m_s + step_s * pushed_n / own.mass_kg;
        own.body_m_s = (after.velocity + after.turning.cross(point - before.centre)).dot(normal);
        let squeezing_m_s = hub_m_s - own.body_m_s;
        strut.rate_m_s = 0.5 * (own.squeezing_m_s + squeezing_m_s);
        own.squeezing_m_s = squeezing_m_s;
    }
}

/// Refuses masses that the body cannot have below its suspension. Arms count from `centre`; `names` are the parameters that
/// say its inertia in roll and pitch [kg m²], `axles` begins the name of an axle's.
pub(crate) fn check(
    wheels: &[Wheel],
    centre: Vector,
    (mass_kg, roll, pitch): (f64, (&str, f64), (&str, f64)),
    axles: &str,
) -> Result<(), Refusal> {
    let (mut all_kg, mut across, mut along, mut first) = (0.0, 0.0, 0.0, 0.0);
    for wheel in wheels {
        let Some((strut, own)) = wheel.strut.as_ref().and_then(|strut| Some((strut, strut.unsprung?))) else {
            continue;
        };
        if strut.level_m <= 0.0 {
            let most_kg = own.mass_kg * (1.0 + strut.level_m * strut.stiffness_n_m / own.weight_n);
            return Err(Refusal {
                parameter: format!("{axles}{}.suspension.unsprung_mass_kg", wheel.axle),
                found: own.mass_kg.to_string(),
                expected: format!("less than the {most_kg:.0} kg that stand on {} at rest", wheel.told),
            });
        }
        let arm = wheel.arm - centre;
        all_kg += own.mass_kg;
        across += own.mass_kg * arm.y * arm.y;
        along += own.mass_kg * arm.x * arm.x;
        first += own.mass_kg * arm.x;
    }
    let left_kg = mass_kg - all_kg;
    let needed = along + if left_kg > 0.0 { first * first / left_kg } else { f64::INFINITY };
    for ((name, inertia), least) in [(roll, across), (pitch, needed)] {
        if all_kg > 0.0 && inertia <= least {
            return Err(Refusal {
                parameter: name.to_owned(),
                found: format!("{inertia:.0} kg m²"),
                expected: format!(
                    "more than the {least:.0} kg m² that the masses below the suspension have alone"
                ),
            });
        }
    }
    Ok(())
}
