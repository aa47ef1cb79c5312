//! Parts by themselves: what is carried, shafts, the friction ellipse.

use super::{TYRE, axle, chassis, soil};
use crate::chassis::{Differential, Payload};
use crate::spin::Spin;
use crate::wheel::{Felt, Scene, Touch, Wheel};
use crate::world::properties;
use headland_plugin::{Place, Soil};
use headland_sim::{Axle, Axles};
use headland_soil::Constant;
use rapier3d_f64::prelude::Vector;

/// 2 t at 1 m behind and 0.7 m above the centre of gravity of 13 t: it moves by 2/15 of the way; the inertia about the left
/// axis grows by 13 · 2 / 15 t times the square of the distance.
#[test]
fn what_is_carried_moves_the_centre_of_gravity_and_adds_to_inertia() {
    let mut chassis = chassis();
    chassis.payload = Some(Payload { position_m: -1.0, height_m: 2.0 });
    let laden = properties(&chassis, 13_000.0, 1.3, 15_000.0);
    let share = 2.0 / 15.0;
    assert!((laden.local_com - Vector::new(-share, 0.0, 0.7 * share)).length() < 1e-12);
    assert!((laden.mass() - 15_000.0).abs() < 1e-9);
    let added = 13_000.0 * share * (1.0 + 0.49);
    let about_left = laden.reconstruct_inertia_matrix().col(1).y;
    assert!((about_left - 32_000.0 - added).abs() < 1e-6 * about_left, "{about_left} {added}");
    let product = laden.reconstruct_inertia_matrix().col(2).x;
    assert!((product - 13_000.0 * share * 0.7).abs() < 1e-6 * about_left, "{product}");
}

fn spin(differential: Differential, centre: Differential, lead: Option<f64>) -> Spin {
    let axles = Axles::new(vec![axle(1.6), Axle { lead, ..axle(-2.0) }], 1.3, 0.7, 0.5).unwrap();
    let mut chassis = chassis();
    chassis.centre = centre;
    for axle in &mut chassis.axles {
        axle.differential = differential;
    }
    Spin::new(&axles, &chassis, &[(0, 1.0), (0, 1.0), (1, 1.0), (1, 1.0)], 800.0, 2.0)
}

#[test]
fn an_open_differential_gives_equal_torques_and_a_locked_one_equal_speeds() {
    // The left front wheel stands on ice: it gives no force back.
    let ground = |wheel: usize| if wheel == 0 { 0.0 } else { 2_000.0 };
    let mut open = spin(Differential::Open, Differential::Open, None);
    open.advance((4_000.0, 1.0), 0.0, ground, 0.01);
    // 2 kN for each front wheel of 200 kg: the one spins up at 10 m/s², the other holds its speed.
    assert!((open.wheels_m_s[0] - 2.1).abs() < 1e-12 && (open.wheels_m_s[1] - 2.0).abs() < 1e-12);
    let mut locked = spin(Differential::Locked, Differential::Locked, Some(1.0));
    locked.advance((4_000.0, 1.0), 0.0, ground, 0.01);
    // 4 kN less 6 kN on 800 kg.
    assert!(locked.wheels_m_s.iter().all(|speed| (speed - (2.0 - 0.025)).abs() < 1e-12));
}

/// A track as a row of wheels: locked to one another they turn at one speed, whatever the ground does to each; open they do not.
#[test]
fn a_locked_row_of_wheels_turns_at_one_speed() {
    const AXLES: u32 = 5;
    let row = |differential: Differential| {
        let list = (0..AXLES).map(|index| axle(1.6 - 0.8 * f64::from(index)));
        let axles = Axles::new(list.collect(), 1.3, 0.7, 0.5).unwrap();
        let mut chassis = chassis();
        chassis.centre = differential;
        chassis.axles = vec![chassis.axles[0]; AXLES as usize];
        chassis.axles.iter_mut().for_each(|axle| axle.differential = differential);
        let wheels: Vec<(usize, f64)> = (0..AXLES as usize).flat_map(|axle| [(axle, 1.0); 2]).collect();
        let mut spin = Spin::new(&axles, &chassis, &wheels, 1_000.0, 2.0);
        for _ in 0..50 {
            // The wheels behind find more hold than those before them.
            spin.advance((10e3, 1.0), 0.0, |wheel| 300.0 * wheel as f64, 0.01);
        }
        spin.wheels_m_s
    };
    let locked = row(Differential::Locked);
    // 10 kN less 300 N (0 + 1 + … + 9) against 1 t, for half a second.
    assert!((locked[0] - (2.0 + 0.5 * (10e3 - 13.5e3) / 1e3)).abs() < 1e-9, "{locked:?}");
    assert!(locked.iter().all(|speed| (speed - locked[0]).abs() < 1e-12), "{locked:?}");
    let open = row(Differential::Open);
    assert!(open.windows(2).any(|pair| (pair[0] - pair[1]).abs() > 0.1), "{open:?}");
}

#[test]
fn axles_turn_by_their_leads_and_work_is_what_energy_changes_by() {
    let mut led = spin(Differential::Locked, Differential::Locked, Some(1.05));
    assert!((led.wheels_m_s[2] / led.wheels_m_s[0] - 1.05).abs() < 1e-12);
    let (before_j, step_s) = (led.kinetic_j(), 0.02);
    let rolled: Vec<f64> = led.wheels_m_s.clone();
    let turned = led.advance((3_000.0, 1.0), 1_000.0, |_| 500.0, step_s);
    let ground_j: f64 = rolled.iter().zip(&led.wheels_m_s).map(|(a, b)| 500.0 * 0.5 * (a + b) * step_s).sum();
    let gained_j = 3_000.0 * turned.driven_m - turned.brakes_j - ground_j;
    assert!((led.kinetic_j() - before_j - gained_j).abs() < 1e-9);
}

#[test]
fn brakes_stop_wheels_and_never_turn_them_back() {
    let mut spin = spin(Differential::Locked, Differential::Locked, Some(1.0));
    for _ in 0..100 {
        spin.advance((0.0, 1.0), 50e3, |_| 0.0, 0.01);
    }
    assert!(spin.wheels_m_s.iter().all(|speed| *speed == 0.0));
    let held = spin.advance((1e6, 1.0), f64::INFINITY, |_| 0.0, 0.01);
    assert_eq!((held.driven_m, held.brakes_j, spin.driven_m_s()), (0.0, 0.0, 0.0));
}

/// An engine that brakes harder than the ground turns wheels stops them; it drove them backward, from nothing.
#[test]
fn a_driveline_that_brakes_turns_no_wheel_back_and_one_that_drives_backward_does() {
    let mut braking = spin(Differential::Locked, Differential::Locked, Some(1.0));
    for _ in 0..100 {
        braking.advance((-50e3, 1.0), 0.0, |_| -1e3, 0.01);
    }
    assert!(braking.wheels_m_s.iter().all(|speed| *speed == 0.0), "{:?}", braking.wheels_m_s);
    let mut driving = spin(Differential::Locked, Differential::Locked, Some(1.0));
    for _ in 0..100 {
        driving.advance((-50e3, -1.0), 0.0, |_| -1e3, 0.01);
    }
    assert!(driving.driven_m_s() < -1.0, "{:?}", driving.wheels_m_s);
}

fn wheel<'a>(slip: f64, side: f64) -> Wheel<'a> {
    Wheel {
        name: String::new(),
        told: String::new(),
        axle: 0,
        arm: Vector::ZERO,
        tyre: &TYRE,
        tyres: 1.0,
        body: chassis().axles[0],
        stiffness_n_m: 6e5,
        damping_n_s_m: 0.0,
        earlier: 0,
        footprint_m: 0.3,
        strut: None,
        slip,
        side,
        sinkage_m: 0.0,
        sinking_m_s: 0.0,
        radius_m: 1.0,
        tilting_n: 0.0,
        touch: Touch { load_n: 30e3, ..Touch::default() },
        felt: Felt::default(),
    }
}

/// A vehicle of 120 kN that drives at 2 m/s.
fn scene(soil: &dyn Soil) -> Scene<'_> {
    Scene { soil, place: Place::default(), position_m: 0.0, speed_m_s: 2.0, load_n: 120e3, slip_limit: 0.5 }
}

#[test]
fn forces_are_stiffness_times_little_slip_and_stay_in_the_friction_circle() {
    let soil = soil::<Constant>("(coefficient: 0.07)");
    let scene = scene(&*soil);
    let felt = |slip: f64, side: f64| {
        let mut wheel = wheel(slip, side);
        wheel.feel(&scene, 0.0, 0.0);
        wheel.felt
    };
    let little = felt(1e-4, -1e-4);
    assert!((little.gross_n / (12.0 * 30e3 * 1e-4) - 1.0).abs() < 1e-5);
    assert!((little.side_n / (-6.0 * 30e3 * 1e-4) - 1.0).abs() < 1e-5);
    // A quarter of the whole vehicle's load, a quarter of its 8.4 kN.
    assert!((little.resistance_n - 2_100.0).abs() < 1e-9);
    for (slip, side) in [(0.4, 0.0), (0.0, 0.9), (0.3, -0.3), (-0.2, 0.1)] {
        let Felt { gross_n, side_n, .. } = felt(slip, side);
        let hold_n = 0.8 * 30e3;
        assert!(gross_n.hypot(side_n) <= hold_n * (1.0 + 1e-12), "{slip} {side}");
    }
    let both = felt(0.3, 0.3);
    assert!(
        both.gross_n < 0.75 * felt(0.3, 0.0).gross_n,
        "driving takes from the side, and the side from driving"
    );
}

/// Along 0.8 of the load, across half of that: each alone reaches its own, both together the ellipse between them, and with
/// the same on both it is the circle.
#[test]
fn a_tyre_that_holds_less_across_stays_in_an_ellipse() {
    let soil = soil::<Constant>("(coefficient: 0.07)");
    let scene = scene(&*soil);
    let felt = |slip: f64, side: f64, across: f64| {
        let mut wheel = wheel(slip, side);
        wheel.body.side_friction = across;
        wheel.feel(&scene, 0.0, 0.0);
        [wheel.felt.gross_n / 30e3, wheel.felt.side_n / 30e3]
    };
    let (along, across) = (0.8, 0.4);
    let [gross, side] = felt(0.8, 0.0, across);
    assert!((gross / along - 1.0).abs() < 1e-4 && side == 0.0, "{gross}");
    let [gross, side] = felt(0.0, -0.8, across);
    assert!((side / -across - 1.0).abs() < 1e-4 && gross == 0.0, "{side}");
    // Little slip is felt by the stiffness alone, whatever the most is.
    assert!((felt(0.0, 1e-4, across)[1] / 6e-4 - 1.0).abs() < 1e-5);
    for (slip, aside) in [(0.8, 0.8), (-0.8, 0.8), (0.4, -0.1), (0.1, 0.4), (0.04, 0.02)] {
        let [gross, side] = felt(slip, aside, across);
        let of_all = (gross / along).hypot(side / across);
        assert!(of_all <= 1.0 + 1e-12, "{slip} {aside}: {of_all}");
        let alone = [felt(slip, 0.0, across)[0] / along, felt(0.0, aside, across)[1] / across];
        let asked = alone[0].hypot(alone[1]);
        assert!((of_all - asked.min(1.0)).abs() < 1e-12, "{slip} {aside}: {of_all} of {asked}");
        assert!((gross * alone[1] * across - side * alone[0] * along).abs() < 1e-12, "both are cut alike");
        let [gross, side] = felt(slip, aside, along);
        assert!(gross.hypot(side) <= along * (1.0 + 1e-12));
    }
    let [gross, side] = felt(0.8, 0.8, along);
    assert!((gross.hypot(side) - along).abs() < 1e-12 && (gross - side).abs() < 1e-2, "{gross} {side}");
}
