//! Wong and Reece's wheel against Bekker's, against a finer quadrature, and at its limits.

use super::*;
use crate::testing::{DRY_SAND, LOAD_N, ON, XERION};
use headland_plugin::Tyre;

fn soil(earth: Earth) -> WongReece {
    let mut soil = WongReece {
        earth,
        maximum_offset: 0.3,
        maximum_by_slip: 0.2,
        exit_angle_rad: 0.0,
        multipass_exponent: 3.0,
        nodes: Vec::new(),
    };
    soil.settle(Path::new("")).unwrap();
    soil
}

/// Without shear, and with the greatest stress below the axle, the horizontal part of the stress is what presses the rut:
/// b ∫ p dz, at any sinkage.
#[test]
fn without_shear_it_resists_by_bekkers_work_of_compaction() {
    for exponent in [0.5, 0.8, 1.1] {
        let earth = Earth { exponent, cohesion_pa: 0.0, friction_angle_rad: 0.0, ..DRY_SAND };
        let smooth = WongReece { maximum_offset: 0.0, maximum_by_slip: 0.0, ..soil(earth) };
        let footing = smooth.wheel(&ON).unwrap();
        let work = earth.compaction_n(XERION.width_m, footing.sinkage_m);
        assert!((footing.motion_resistance_n / work - 1.0).abs() < 1e-5, "{exponent}: {footing:?} {work}");
    }
}

/// Bekker's rigid wheel stops its series for the load after one term: they agree where the wheel sinks little.
#[test]
fn a_wheel_that_sinks_little_sinks_as_bekkers_rigid_one() {
    for (load, tolerance) in [(0.1 * LOAD_N, 0.03), (0.01 * LOAD_N, 0.01)] {
        let earth = Earth { exponent: 1.0, cohesion_pa: 0.0, friction_angle_rad: 0.0, ..DRY_SAND };
        let smooth = WongReece { maximum_offset: 0.0, maximum_by_slip: 0.0, ..soil(earth) };
        let contact = WheelContact { load_n: load, ..ON };
        let found = smooth.wheel(&contact).unwrap().sinkage_m;
        let b = XERION.width_m;
        let bekker = (3.0 * load / (2.0 * b * earth.stiffness(b) * XERION.diameter_m.sqrt())).powf(2.0 / 3.0);
        assert!((found / bekker - 1.0).abs() < tolerance, "{found} {bekker}");
    }
}

#[test]
fn the_soil_carries_the_load_and_finer_quadrature_changes_nothing() {
    for exponent in [0.11, 0.5, 1.1] {
        let cohesion_pa = if exponent < 0.2 { 2e4 } else { 2e3 };
        let coarse = soil(Earth { exponent, cohesion_pa, ..DRY_SAND });
        let fine = WongReece { nodes: quadrature::nodes(200), ..coarse.clone() };
        for slip in [-0.2, 0.0, 0.05, 0.4] {
            let contact = WheelContact { slip, load_n: if exponent < 0.2 { 3e5 } else { LOAD_N }, ..ON };
            let entry = fine.entry(&contact).unwrap();
            let lift = fine.integrate(&contact, entry).lift * 0.9 * 0.5 * 2.045;
            assert!((lift / contact.load_n - 1.0).abs() < 1e-12);
            let (one, other) = (coarse.wheel(&contact).unwrap(), fine.wheel(&contact).unwrap());
            let off = |one: f64, other: f64| (one - other).abs() / contact.load_n;
            assert!(
                off(one.gross_traction_n, other.gross_traction_n) < 1e-6,
                "{exponent} {slip}: {one:?} {other:?}"
            );
            assert!(off(one.motion_resistance_n, other.motion_resistance_n) < 1e-6, "{exponent} {slip}");
        }
    }
}

/// With a rut a hundredth as long as the wheel is high, cos θ is 1 and the pull is Bekker's: thrust of a flat contact that
/// slips by s, less the compaction. Shear displacement s x along a contact that carries a constant pressure (n → 0).
#[test]
fn a_long_flat_contact_shears_as_janosi_and_hanamoto_integrate_it() {
    let earth = Earth { exponent: 0.02, cohesion_pa: 0.0, shear_displacement_m: 0.05, ..DRY_SAND };
    let tyre = Tyre { diameter_m: 40.0, width_m: 1.0, ..XERION };
    let flat = WongReece { maximum_offset: 0.0, maximum_by_slip: 0.0, ..soil(earth) };
    let contact = WheelContact { tyre: &tyre, slip: 0.2, load_n: 5e5, ..ON };
    let footing = flat.wheel(&contact).unwrap();
    let entry = flat.entry(&contact).unwrap();
    let length = 20.0 * entry;
    // At the front the displacement is that of slip alone: the arc is as long as its chord to entry²/6.
    let expected = 5e5 * earth.friction_angle_rad.tan() * crate::shear::mobilised_along(0.2 * length / 0.05);
    assert!(entry < 0.05, "{entry}");
    assert!((footing.gross_traction_n / expected - 1.0).abs() < 0.02, "{footing:?} {expected}");
}

#[test]
fn more_slip_pulls_more_until_the_strength_is_spent_and_a_braked_wheel_is_held_back() {
    let sand = soil(DRY_SAND);
    let gross = |slip: f64| sand.wheel(&WheelContact { slip, ..ON }).unwrap().gross_traction_n;
    let slips = [-0.5, -0.2, 0.0, 0.02, 0.05, 0.1, 0.2, 0.4];
    let all: Vec<f64> = slips.iter().map(|slip| gross(*slip)).collect();
    assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "{all:?}");
    assert!(gross(-0.5) < 0.0 && gross(0.8) < 1.1 * LOAD_N * DRY_SAND.friction_angle_rad.tan() + 2e3);
}

#[test]
fn no_load_does_nothing_a_bog_swallows_the_wheel_and_a_second_pass_pays_less() {
    let unloaded = soil(DRY_SAND).wheel(&WheelContact { load_n: 0.0, slip: 0.1, ..ON }).unwrap();
    assert_eq!(
        (unloaded.gross_traction_n, unloaded.motion_resistance_n, unloaded.sinkage_m),
        (0.0, 0.0, 0.0)
    );
    let bog = soil(Earth { frictional_modulus: 1e2, cohesive_modulus: 0.0, ..DRY_SAND });
    assert!(bog.wheel(&ON).unwrap().sinkage_m.is_infinite());
    let pass = |earlier_passes: u32| {
        soil(DRY_SAND).wheel(&WheelContact { earlier_passes, ..ON }).unwrap().motion_resistance_n
    };
    assert!((pass(1) / pass(0) - 0.6245).abs() < 1e-4);
}

#[test]
fn a_greatest_stress_outside_the_contact_is_refused() {
    let mut soil = soil(DRY_SAND);
    (soil.maximum_offset, soil.maximum_by_slip) = (0.7, 0.4);
    let refusal = soil.settle(Path::new("")).unwrap_err();
    assert_eq!((refusal.parameter.as_str(), refusal.found.as_str()), ("maximum_by_slip", "0.4 beside 0.7"));
}
