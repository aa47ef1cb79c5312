//! Hand numbers, limits and refusals of Bekker's wheel.

use super::*;
use crate::testing::{DRY_SAND, LOAD_N, ON, XERION};
use headland_plugin::Tyre;

fn bare(earth: Earth) -> Bekker {
    let mut soil = Bekker {
        earth,
        tyre_resistance: 0.0,
        bulldozing: false,
        slip_sinkage: 0.0,
        multipass_exponent: 3.0,
        pushed: Bulldozing::default(),
    };
    soil.settle(Path::new("")).unwrap();
    soil
}

fn at_pressure(inflation_pa: f64) -> Tyre {
    Tyre { inflation_pa, ..XERION }
}

/// Sinkage [m] and resistance per load of the tyre of the coast-down study at a ground pressure.
fn towed(soil: &Bekker, pressure_pa: f64) -> (f64, f64) {
    let tyre = at_pressure(pressure_pa);
    let footing = soil.wheel(&WheelContact { tyre: &tyre, ..ON }).unwrap();
    (footing.sinkage_m, footing.motion_resistance_n / LOAD_N)
}

/// The tyre of the coast-down study on three soils at 40 to 47 kPa, and at 80 kPa, computed elsewhere: dry sand 36 mm and
/// 2.0 % at 40 kPa, 7.3 % at 80; LETE sand 0.13 %; sandy loam of 15 % moisture 0.37 to 0.54 %.
#[test]
fn compaction_takes_the_shares_of_load_that_were_computed_for_the_study() {
    let (sinkage, share) = towed(&bare(DRY_SAND), 40e3);
    assert!((sinkage - 0.036).abs() < 5e-4 && (share - 0.020).abs() < 5e-4, "{sinkage} {share}");
    let (_, share) = towed(&bare(DRY_SAND), 80e3);
    assert!((share - 0.073).abs() < 5e-4, "{share}");
    let lete = Earth { exponent: 0.793, cohesive_modulus: 102e3, frictional_modulus: 5301e3, ..DRY_SAND };
    let (_, share) = towed(&bare(lete), 40e3);
    assert!((share - 0.0013).abs() < 5e-5, "{share}");
    let loam = Earth { exponent: 0.7, cohesive_modulus: 5.27e3, frictional_modulus: 1515.04e3, ..DRY_SAND };
    let (low, high) = (towed(&bare(loam), 40e3).1, towed(&bare(loam), 47e3).1);
    assert!((low - 0.0037).abs() < 2e-4 && (high - 0.0054).abs() < 2e-4, "{low} {high}");
}

/// Dry sand under a hard wheel: k = 990/0.9 + 1 528 430 = 1 529 530; 3 · 31 929.8 / (1.9 · 0.9 · k · 1.43003) = 0.025 611;
/// to the power 2/3.2: z = 0.101 23 m; R = 0.9 k z^2.1 / 2.1 = 5341 N, by hand.
#[test]
fn a_hard_wheel_sinks_until_the_sand_carries_it() {
    let tyre = at_pressure(1e6);
    let contact = WheelContact { tyre: &tyre, ..ON };
    let footing = bare(DRY_SAND).wheel(&contact).unwrap();
    assert!((footing.sinkage_m - 0.101_23).abs() < 3e-5, "{}", footing.sinkage_m);
    assert!((footing.motion_resistance_n / 5341.0 - 1.0).abs() < 2e-3, "{}", footing.motion_resistance_n);
}

/// Where the tyre just does not flatten, both ways of standing are the same.
#[test]
fn the_rigid_and_the_flexible_wheel_meet_at_the_critical_pressure() {
    let soil = bare(DRY_SAND);
    let hard = at_pressure(1e6);
    let rigid = soil.stand(&WheelContact { tyre: &hard, ..ON }).unwrap();
    let critical = DRY_SAND.stiffness(0.9) * rigid.sinkage_m.powf(DRY_SAND.exponent);
    let tyre = at_pressure(critical * (1.0 - 1e-9));
    let flexible = soil.stand(&WheelContact { tyre: &tyre, ..ON }).unwrap();
    assert!((flexible.sinkage_m / rigid.sinkage_m - 1.0).abs() < 1e-8);
    assert!((flexible.length_m / rigid.length_m - 1.0).abs() < 1e-7);
}

#[test]
fn without_slip_only_the_tyre_itself_takes_torque_and_much_slip_finds_coulombs_strength() {
    let mut soil = bare(DRY_SAND);
    soil.tyre_resistance = 0.02;
    let towed = soil.wheel(&ON).unwrap();
    assert!((towed.gross_traction_n - 0.02 * LOAD_N).abs() < 1e-9);
    let tight = bare(Earth { cohesion_pa: 0.0, shear_displacement_m: 1e-9, ..DRY_SAND });
    let slipping = tight.wheel(&WheelContact { slip: 0.9, ..ON }).unwrap();
    let strength = LOAD_N * DRY_SAND.friction_angle_rad.tan();
    assert!((slipping.gross_traction_n / strength - 1.0).abs() < 1e-6);
    let braked = tight.wheel(&WheelContact { slip: -0.9, ..ON }).unwrap();
    assert!((braked.gross_traction_n + slipping.gross_traction_n).abs() < 1e-6);
}

/// On dry sand at 40 kPa the flat part is (31 930 − 6216) / 36 000 m and the curved one
/// √(2.045 · 0.0364 − 0.0364²) = 0.270 m.
#[test]
fn cohesion_acts_on_the_contact_and_friction_on_the_load() {
    let tyre = at_pressure(40e3);
    let contact = WheelContact { tyre: &tyre, slip: 0.5, ..ON };
    let length = bare(DRY_SAND).stand(&contact).unwrap().length_m;
    assert!((length - 0.9847).abs() < 5e-4, "{length}");
    let cohesive = bare(Earth { friction_angle_rad: 0.0, ..DRY_SAND }).wheel(&contact).unwrap();
    let expected = 0.9 * length * 1040.0 * mobilised_along(0.5 * length / 0.01);
    assert!((cohesive.gross_traction_n / expected - 1.0).abs() < 1e-12);
}

#[test]
fn slip_digs_later_passes_pay_less_and_a_pushed_bank_is_added() {
    let mut soil = bare(DRY_SAND);
    let first = soil.wheel(&ON).unwrap();
    let second = soil.wheel(&WheelContact { earlier_passes: 1, ..ON }).unwrap();
    assert!((second.motion_resistance_n / first.motion_resistance_n - 0.6245).abs() < 1e-4);
    assert!((second.sinkage_m / first.sinkage_m - 2f64.powf(1.0 / 3.0)).abs() < 1e-12);
    soil.slip_sinkage = 1.0;
    let slipping = soil.wheel(&WheelContact { slip: 0.2, ..ON }).unwrap();
    assert!((slipping.sinkage_m / first.sinkage_m - 4.0 / 3.0).abs() < 1e-12);
    let deeper = (4f64 / 3.0).powf(2.1);
    assert!((slipping.motion_resistance_n / first.motion_resistance_n - deeper).abs() < 1e-9);
    soil.bulldozing = true;
    let pushing = soil.wheel(&ON).unwrap().motion_resistance_n - first.motion_resistance_n;
    assert!((pushing - soil.pushed.resistance_n(0.9, first.sinkage_m)).abs() < 1e-9 && pushing > 100.0);
}

#[test]
fn no_load_leaves_no_trace_and_a_bog_swallows_the_wheel() {
    let unloaded = bare(DRY_SAND).wheel(&WheelContact { load_n: 0.0, slip: 0.1, ..ON }).unwrap();
    assert_eq!((unloaded.motion_resistance_n, unloaded.sinkage_m), (0.0, 0.0));
    assert!(unloaded.gross_traction_n.abs() < 1e-9);
    let bog = bare(Earth { frictional_modulus: 1e3, cohesive_modulus: 0.0, ..DRY_SAND });
    let sunk = bog.wheel(&ON).unwrap();
    assert!(sunk.motion_resistance_n.is_nan() && sunk.sinkage_m.is_infinite());
}

#[test]
fn an_earth_that_cannot_be_is_refused_with_its_place() {
    let mut soil = bare(DRY_SAND);
    soil.earth.exponent = 9.0;
    let refusal = soil.settle(Path::new("")).unwrap_err();
    assert_eq!((refusal.parameter.as_str(), refusal.found.as_str()), ("earth.exponent", "9"));
}
