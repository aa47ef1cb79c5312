//! The longest step that is stable.
//!
//! dt² k / m + 2 dt c / m < 4          Euler's half-implicit rule on m x″ + c x′ + k x = 0
//!
//! Source: Jury's conditions on the two eigenvalues of one step. Looked at are bounce, roll and pitch on the tyres, the
//! turning of each shaft against its tyres, and hubs between tyre and suspension; and that no wheel leaves its footprint in a step.

use crate::BodyError;
use crate::spin::Spin;
use crate::wheel::Wheel;
use headland_plugin::{Place, Soil, WheelContact};

/// A step is refused beyond this part of what is stable: nearer to it, swings are not resolved.
const SAFE: f64 = 0.5;

/// Inertias that the tyres carry: mass [kg], roll and pitch [kg m²].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried {
    pub mass_kg: f64,
    pub roll_kg_m2: f64,
    pub pitch_kg_m2: f64,
}

/// Refuses a step that is too long for wheels that stand with their static loads.
pub(crate) fn check(
    wheels: &[Wheel],
    spin: &Spin,
    soil: &dyn Soil,
    carried: Carried,
    (step_s, speed_m_s): (f64, f64),
) -> Result<(), BodyError> {
    let sum = |weigh: &dyn Fn(&Wheel) -> f64| {
        wheels.iter().fold((0.0, 0.0), |(k, c), wheel| {
            (k + weigh(wheel) * wheel.standing_n_m(), c + weigh(wheel) * damping_n_s_m(wheel))
        })
    };
    let per = |(k, c): (f64, f64), inertia: f64| (k / inertia, c / inertia);
    // What hops below its suspension is not carried by it.
    let hopping = |arm: &dyn Fn(&Wheel) -> f64| -> f64 {
        let own = |wheel: &Wheel| wheel.strut.and_then(|strut| strut.unsprung).map_or(0.0, |own| own.mass_kg);
        wheels.iter().map(|wheel| arm(wheel) * own(wheel)).sum()
    };
    let body = |arm: &dyn Fn(&Wheel) -> f64, inertia: f64| per(sum(arm), inertia - hopping(arm));
    let mut fastest = vec![
        ("the bounce on the tyres swings", body(&|_| 1.0, carried.mass_kg)),
        ("the roll on the tyres swings", body(&|wheel| wheel.arm.y * wheel.arm.y, carried.roll_kg_m2)),
        ("the pitch on the tyres swings", body(&|wheel| wheel.arm.x * wheel.arm.x, carried.pitch_kg_m2)),
    ];
    for (wheel, strut) in wheels.iter().filter_map(|wheel| Some((wheel, wheel.strut?))) {
        let between = (wheel.stiffness_n_m + strut.stiffness_n_m, wheel.damping_n_s_m + strut.damping_n_s_m);
        fastest.push(match strut.unsprung {
            Some(own) => ("a hub between tyre and suspension hops", per(between, own.mass_kg)),
            None => ("a suspension settles against its tyre", (0.0, between.0 / between.1)),
        });
    }
    for (mass_kg, turning) in spin.shafts() {
        let (k, c) = turning.iter().fold((0.0, 0.0), |(k, c), (index, lead)| {
            let wheel = &wheels[*index];
            let own = lead * lead * gripping_n(wheel, soil) / wheel.body.relaxation_length_m;
            (k + own, c + own * wheel.damping_n_s_m / wheel.stiffness_n_m)
        });
        fastest.push(("a wheel turns against its tyre", per((k, c), mass_kg)));
    }
    let longest = |(k, c): (f64, f64)| SAFE * 4.0 / (c + (c * c + 4.0 * k).sqrt());
    let rolls =
        wheels.iter().map(|wheel| ("a wheel rolls past its footprint", wheel.footprint_m / speed_m_s.abs()));
    let (what, longest_s) = fastest
        .into_iter()
        .map(|(what, swing)| (what, longest(swing)))
        .chain(rolls)
        .fold(("nothing", f64::INFINITY), |least, one| if one.1 < least.1 { one } else { least });
    if step_s > longest_s {
        return Err(BodyError::Step { found_s: step_s, longest_s, what });
    }
    Ok(())
}

/// The most that tyre and suspension in line can damp [N s/m].
fn damping_n_s_m(wheel: &Wheel) -> f64 {
    wheel.strut.map_or(wheel.damping_n_s_m, |strut| strut.damping_n_s_m + wheel.damping_n_s_m)
}

/// Force along a wheel per slip, about none [N].
pub(crate) fn gripping_n(wheel: &Wheel, soil: &dyn Soil) -> f64 {
    const LITTLE: f64 = 1e-3;
    let gross_n = |slip: f64| {
        let footing = soil.wheel(&WheelContact {
            tyre: wheel.tyre,
            load_n: wheel.touch.load_n / wheel.tyres,
            slip,
            speed_m_s: 1.0,
            earlier_passes: wheel.earlier,
            position_m: 0.0,
            place: Place::default(),
        });
        footing.map(|footing| wheel.tyres * footing.gross_traction_n)
    };
    match (gross_n(LITTLE), gross_n(0.0)) {
        (Some(some), Some(none)) if some > none => (some - none) / LITTLE,
        _ => wheel.body.slip_stiffness * wheel.touch.load_n,
    }
}
