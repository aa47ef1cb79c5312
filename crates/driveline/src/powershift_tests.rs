use super::*;
use crate::engine;
use proptest::prelude::*;

fn read(ratios: &str) -> Powershift {
    let text = format!(
        "(engine: {}, ratios: {ratios}, gear_efficiency: 0.9, idle_torque_n_m: 30, least_speed_rad_s: 130, \
          launch_speed_rad_s: 110, shift_time_s: 0.5, engine_inertia_kg_m2: 2, \
          least_time_s: 1, wheel_radius_m: 0.93, rotating_mass_kg: 0)",
        engine::tests::TEXT
    );
    ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(&text)
        .unwrap()
}

fn gearbox() -> Powershift {
    let mut gearbox = read("[160, 130, 105, 85, 69, 56, 45, 36, 29, 23, 19, 15]");
    gearbox.settle(Path::new(".")).unwrap();
    gearbox
}

fn asked(speed_m_s: f64, force_n: f64) -> Demand {
    Demand { speed_m_s, force_n, ..Demand::default() }
}

fn in_gear(gear: f64) -> [f64; 6] {
    [1.0, gear, 10.0, 1.0, 0.0, 0.0]
}

/// Third gear, 1.2 m/s: 105 · 1.2 / 0.93 = 135.48 rad/s. 50 kN: 50 000 · 0.93 / (105 · 0.9) + 30 = 522.06 N m, 70 731 W.
#[test]
fn a_pull_in_third_gear_by_hand() {
    let delivery = gearbox().deliver(&asked(1.2, 50e3), &in_gear(3.0), &mut [0.0; 6]);
    assert_eq!(delivery.force_n, 50e3);
    assert!((delivery.readings.engine_speed_rad_s - 135.484).abs() < 1e-3);
    assert!((delivery.losses_w[1] - (70_731.0 - 60e3)).abs() < 1.0, "{}", delivery.losses_w[1]);
    assert_eq!(delivery.losses_w[2], 0.0);
}

/// At rest the clutch slips: the engine works at 110 rad/s, and all of it is lost.
#[test]
fn at_the_start_the_clutch_takes_what_the_engine_gives() {
    let delivery = gearbox().deliver(&asked(0.0, 50e3), &in_gear(1.0), &mut [0.0; 6]);
    let torque = 50e3 * 0.93 / (160.0 * 0.9) + 30.0;
    assert!((delivery.losses_w[2] - torque * 110.0).abs() < 1e-6 && delivery.force_n == 50e3);
}

/// From third to fourth the step is 105 / 85: right after the shift the engine is faster by it, half way by half of it.
#[test]
fn a_shift_up_slips_until_it_is_over() {
    let gearbox = gearbox();
    let mut states = in_gear(3.0);
    let demand = asked(1.7, 20e3);
    while gearbox.decide(&demand, &mut states) {}
    assert!(states[GEAR] > 3.0 && states[SINCE] == 0.0);
    states = [1.0, 4.0, 0.0, 105.0 / 85.0, 0.0, 0.0];
    let clutch = 85.0 * 1.7 / 0.93;
    for (since, share) in [(0.0, 1.0), (0.25, 0.5), (0.5, 0.0), (3.0, 0.0)] {
        states[SINCE] = since;
        let delivery = gearbox.deliver(&demand, &states, &mut [0.0; 6]);
        let expected = clutch * (1.0 + (105.0 / 85.0 - 1.0) * share);
        assert!((delivery.readings.engine_speed_rad_s - expected).abs() < 1e-9, "{since}");
    }
}

/// From fourth to third at 1.7 m/s: the engine comes up from 155.38 to 191.94 rad/s, and the clutch of the fourth gear pulls.
#[test]
fn a_shift_down_slips_in_the_clutch_of_the_gear_before() {
    let (gearbox, mut states) = (gearbox(), in_gear(4.0));
    let demand = asked(1.7, 20e3);
    let clutch = 85.0 * 1.7 / 0.93;
    states[GEAR] = 3.0;
    states[STEP] = 85.0 / 105.0;
    let torque = 20e3 * 0.93 / (85.0 * 0.9) + 30.0;
    for (since, share) in [(0.0, 0.0), (0.25, 0.5), (0.49, 0.98)] {
        states[SINCE] = since;
        let delivery = gearbox.deliver(&demand, &states, &mut [0.0; 6]);
        let engine = clutch * (1.0 + (105.0 / 85.0 - 1.0) * share);
        assert!((delivery.readings.engine_speed_rad_s - engine).abs() < 1e-9, "{since}");
        assert!((delivery.losses_w[2] - torque * (engine - clutch)).abs() < 1e-6, "{:?}", delivery.losses_w);
        assert!((delivery.losses_w[4] - 2.0 * engine * clutch * (20.0 / 85.0) / 0.5).abs() < 1e-6);
    }
    states[SINCE] = 0.5;
    let after = gearbox.deliver(&demand, &states, &mut [0.0; 6]);
    assert_eq!((after.losses_w[2], after.losses_w[4]), (0.0, 0.0));
}

/// An engine that is slowed down by the clutch alone leaves ½ J Δω² in it, as two inertias that are brought to one speed do;
/// what it had, ½ J (ω₀² − ω₁²), goes there and into the gears.
#[test]
fn the_clutch_takes_half_of_what_the_slip_makes_of_the_inertia() {
    const PARTS: u32 = 1000;
    let (gearbox, mut states) = (gearbox(), in_gear(4.0));
    let (speed, step) = (1.7, 105.0 / 85.0);
    let clutch = 85.0 * speed / 0.93;
    let slip = clutch * (step - 1.0);
    let torque = 2.0 * slip / 0.5;
    let force = gearbox.wheels_n(torque, 85.0);
    let [mut lost_j, mut stored_j, mut engine_j] = [0.0; 3];
    for part in 0..PARTS {
        let dt = 0.5 / f64::from(PARTS);
        (states[SINCE], states[STEP]) = ((f64::from(part) + 0.5) * dt, step);
        let delivery = gearbox.deliver(&asked(speed, force), &states, &mut [0.0; 6]);
        assert!((delivery.force_n - force).abs() < 1e-9 * force);
        lost_j += delivery.losses_w[2] * dt;
        stored_j += delivery.losses_w[4] * dt;
        let Readings { engine_torque_n_m, engine_speed_rad_s, .. } = delivery.readings;
        engine_j += (engine_torque_n_m * engine_speed_rad_s - delivery.losses_w[3]) * dt;
    }
    let (before, after) = (clutch * step, clutch);
    assert!((lost_j / (0.5 * 2.0 * slip * slip) - 1.0).abs() < 1e-6, "{lost_j}");
    assert!((stored_j / (0.5 * 2.0 * (after * after - before * before)) - 1.0).abs() < 1e-6, "{stored_j}");
    assert!(engine_j.abs() < 1e-6 * lost_j, "{engine_j}");
}

/// What friction and accessories do not take of J dω/dt pushes the vehicle, and no fuel is burnt.
#[test]
fn an_engine_that_has_to_slow_down_pushes() {
    let gearbox = gearbox();
    let mut states = in_gear(5.0);
    (states[SINCE], states[STEP]) = (0.1, 1.5);
    let delivery = gearbox.deliver(&asked(2.0, -10e3), &states, &mut [0.0; 6]);
    assert!(delivery.force_n > 0.0 && delivery.source_power_w.abs() < 1e-6, "{delivery:?}");
    states[SINCE] = 1.0;
    assert!(gearbox.deliver(&asked(2.0, -10e3), &states, &mut [0.0; 6]).force_n < 0.0);
}

/// A shift within another begins with the engine as fast as it is.
#[test]
fn the_speed_of_the_engine_does_not_jump_when_a_shift_begins() {
    let gearbox = gearbox();
    for (speed, gear, force) in [(1.7, 3.0, 5e3), (2.5, 7.0, 90e3), (0.1, 4.0, 60e3)] {
        for since in [10.0, 0.2] {
            let mut states = in_gear(gear);
            (states[SINCE], states[STEP]) = (since, 0.9);
            let demand = asked(speed, force);
            let before = gearbox.turning(speed, &states).engine;
            if gearbox.decide(&demand, &mut states) {
                let after = gearbox.turning(speed, &states).engine;
                assert!((after / before - 1.0).abs() < 1e-12, "{speed} {gear} {since}: {before} {after}");
            }
        }
    }
}

#[test]
fn a_light_load_goes_up_and_a_heavy_one_down_without_hunting() {
    let gearbox = gearbox();
    let decided = |demand: Demand, gear: f64| {
        let mut states = in_gear(gear);
        let mut shifts = 0;
        while gearbox.decide(&demand, &mut states) {
            states[SINCE] = 10.0;
            shifts += 1;
            assert!(shifts < 20, "it hunts: {states:?}");
        }
        states[GEAR]
    };
    let (light, heavy) = (decided(asked(2.5, 5e3), 4.0), decided(asked(2.5, 80e3), 6.0));
    assert!(light > heavy, "{light} {heavy}");
    // Not before it has been in gear for long enough.
    let mut fresh = in_gear(3.0);
    fresh[SINCE] = 0.4;
    assert!(!gearbox.decide(&asked(1.7, 5e3), &mut fresh));
}

#[test]
fn beyond_its_highest_gear_it_says_so() {
    let why = gearbox().exhausted(&asked(16.0, 0.0), &Delivery::NOTHING, &in_gear(12.0));
    assert!(why.unwrap().contains("no gear is high enough for 16.00 m/s"));
    assert_eq!(gearbox().exhausted(&asked(12.0, 0.0), &Delivery::NOTHING, &in_gear(12.0)), None);
}

#[test]
fn gears_that_do_not_fall_are_refused() {
    assert!(
        read("[100, 120]").settle(Path::new(".")).unwrap_err().to_string().contains("fall from gear to gear")
    );
}

proptest! {
    #[test]
    fn powers_balance_in_every_quadrant(
        speed_m_s in -12.0f64..12.0, force_n in -2e5f64..2e5, auxiliary_power_w in 0.0f64..2e4,
        shaft_power_w in prop_oneof![Just(0.0), 0.0f64..2e5], coasting: bool, since in 0.0f64..2.0,
    ) {
        let gearbox = gearbox();
        let demand = Demand { speed_m_s, force_n, coasting, auxiliary_power_w, shaft_power_w, ..Demand::default() };
        let mut states = in_gear(5.0);
        gearbox.decide(&demand, &mut states);
        states[SINCE] = since;
        let delivery = gearbox.deliver(&demand, &states, &mut [0.0; 6]);
        let size = delivery.source_power_w.abs() + (delivery.force_n * speed_m_s).abs() + 1.0;
        let sum = delivery.losses_w.iter().sum::<f64>() + auxiliary_power_w + shaft_power_w;
        prop_assert!((delivery.source_power_w - delivery.force_n * speed_m_s - sum).abs() <= 1e-9 * size);
        let lost = &delivery.losses_w[..4];
        prop_assert!(lost.iter().all(|loss| *loss >= -1e-9 * size), "{:?}", delivery.losses_w);
        // What slows down in a shift up may push where nothing is wanted.
        if delivery.losses_w[4] >= 0.0 {
            prop_assert!(delivery.force_n * force_n >= 0.0 && delivery.force_n.abs() <= force_n.abs() + 1e-9);
        }
    }
}
