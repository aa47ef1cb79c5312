use super::*;
use proptest::prelude::*;

/// Ratio and radius of a BMW i3; battery and limits in round numbers near it.
fn drive() -> ElectricSingleSpeed {
    ron::from_str(
        "(open_circuit_voltage_v: 360.0, open_circuit_rise_v: 40.0, resistance_ohm: 0.12, capacity_a_h: 60.0, \
          initial_state_of_charge: 0.8, max_torque_n_m: 250.0, max_regeneration_torque_n_m: 100.0, \
          max_power_w: 125e3, gear_ratio: 9.665, gear_efficiency: 0.97, wheel_radius_m: 0.35, \
          drive_efficiency: 0.9, standby_power_w: 200.0, rotating_mass_kg: 60.0)",
    )
    .unwrap()
}

fn asked(speed_m_s: f64, force_n: f64) -> Demand {
    Demand { speed_m_s, force_n, ..Demand::default() }
}

fn deliver(drive: &ElectricSingleSpeed, demand: &Demand, charge: f64) -> (Delivery, f64) {
    let mut rates = [f64::NAN];
    (drive.deliver(demand, &[charge], &mut rates), rates[0])
}

/// 20 m/s and 1000 N: T = 1000 · 0.35 / (9.665 · 0.97) = 37.333 N m at 552.286 rad/s, 20 618.6 W; / 0.9 + 200 = 23 109.5 W.
/// At half charge U = 360 V: I = (360 − √(129 600 − 0.48 · 23 109.5)) / 0.24 = 65.623 A.
#[test]
fn a_thousand_newtons_at_20_m_s_by_hand() {
    let (delivery, rate) = deliver(&drive(), &asked(20.0, 1000.0), 0.5);
    let readings = delivery.readings;
    assert!((delivery.force_n - 1000.0).abs() < 1e-9);
    assert!((readings.motor_torque_n_m - 37.333).abs() < 1e-3);
    assert!((readings.motor_speed_rad_s - 552.286).abs() < 1e-3);
    let current = (360.0 - (129_600.0f64 - 0.48 * 23_109.5).sqrt()) / 0.24;
    assert!((readings.battery_current_a - current).abs() < 1e-3);
    assert!((readings.battery_voltage_v - (360.0 - 0.12 * current)).abs() < 1e-3);
    assert!((rate + current / (3600.0 * 60.0)).abs() < 1e-9);
}

/// Braking, the gear helps: T = −1000 · 0.35 · 0.97 / 9.665, and the battery takes back T ω · 0.9 less standby.
#[test]
fn regeneration_returns_less_than_the_wheels_give() {
    let (delivery, rate) = deliver(&drive(), &asked(20.0, -1000.0), 0.5);
    assert!((delivery.force_n + 1000.0).abs() < 1e-9 && rate > 0.0);
    let back = delivery.readings.battery_voltage_v * delivery.readings.battery_current_a;
    assert!((back - (-20e3 * 0.97 * 0.9 + 200.0)).abs() < 1e-6);
}

#[test]
fn a_recorded_torque_comes_back_as_the_reading() {
    for (torque, speed) in
        [(80.0, 12.0), (-60.0, 12.0), (80.0, 0.0), (-30.0, 0.0), (-50.0, -2.0), (40.0, -2.0)]
    {
        let force_n = drive().force_of_torque_n(torque, speed).unwrap();
        let (delivery, _) = deliver(&drive(), &asked(speed, force_n), 0.5);
        assert!((delivery.readings.motor_torque_n_m - torque).abs() < 1e-9, "{torque} N m at {speed} m/s");
        assert!((delivery.force_n - force_n).abs() < 1e-9 * force_n.abs());
    }
}

#[test]
fn motor_limits_hold_by_torque_at_low_and_by_power_at_high_speed() {
    let leverage = 9.665 / 0.35;
    let force = |speed: f64, force_n: f64| deliver(&drive(), &asked(speed, force_n), 0.5).0.force_n;
    assert!((force(1.0, 1e6) - 250.0 * leverage * 0.97).abs() < 1e-6);
    assert!((force(1.0, -1e6) + 100.0 * leverage / 0.97).abs() < 1e-6);
    assert!((force(40.0, 1e6) * 40.0 - 125e3 * 0.97).abs() < 1e-6);
    assert!((force(60.0, -1e6) * 60.0 + 125e3 / 0.97).abs() < 1e-6);
}

/// With 2 Ω the battery gives at most 360² / 8 = 16 200 W, at half its voltage; the wheels get 0.97 · 0.9 of 16 000 W.
#[test]
fn a_weak_battery_limits_the_wheels() {
    let weak = ElectricSingleSpeed { resistance_ohm: 2.0, ..drive() };
    let (delivery, _) = deliver(&weak, &asked(20.0, 5000.0), 0.5);
    assert!((delivery.force_n * 20.0 - 0.97 * 0.9 * 16_000.0).abs() < 1e-6);
    assert!((delivery.readings.battery_voltage_v - 180.0).abs() < 1e-3);
}

#[test]
fn an_empty_battery_drives_no_more_and_a_full_one_takes_nothing_back() {
    assert_eq!(deliver(&drive(), &asked(20.0, 1000.0), 0.0).0.force_n, 0.0);
    assert_eq!(deliver(&drive(), &asked(20.0, -1000.0), 1.0).0.force_n, 0.0);
    assert!(deliver(&drive(), &asked(20.0, -1000.0), 0.0).0.force_n < -999.0);
}

#[test]
fn in_neutral_the_battery_serves_the_other_consumers_alone() {
    let demand = Demand { coasting: true, auxiliary_power_w: 1500.0, ..asked(15.0, 800.0) };
    let (delivery, _) = deliver(&drive(), &demand, 0.5);
    assert_eq!((delivery.force_n, delivery.readings.motor_torque_n_m), (0.0, 0.0));
    let terminal = delivery.readings.battery_voltage_v * delivery.readings.battery_current_a;
    assert!((terminal - 1700.0).abs() < 1e-9);
}

#[test]
fn resistance_that_is_added_is_as_good_as_its_own() {
    let added = Demand { battery_resistance_ohm: 0.05, ..asked(20.0, 1000.0) };
    let own = ElectricSingleSpeed { resistance_ohm: 0.17, ..drive() };
    let (one, two) = (deliver(&drive(), &added, 0.5).0, deliver(&own, &asked(20.0, 1000.0), 0.5).0);
    assert!((one.readings.battery_voltage_v - two.readings.battery_voltage_v).abs() < 1e-9);
    assert!((one.losses_w[0] - two.losses_w[0]).abs() < 1e-9 && one.losses_w[0] > 0.0);
}

#[test]
fn a_battery_without_resistance_loses_nothing() {
    let ideal = ElectricSingleSpeed { resistance_ohm: 0.0, ..drive() };
    let (delivery, _) = deliver(&ideal, &asked(20.0, 1000.0), 0.5);
    assert_eq!(delivery.losses_w[0], 0.0);
    assert!((delivery.readings.battery_current_a * 360.0 - delivery.source_power_w).abs() < 1e-9);
}

#[test]
fn voltage_rises_with_charge_and_a_battery_without_voltage_is_refused() {
    let idle = |charge| deliver(&drive(), &asked(0.0, 0.0), charge).0.readings;
    assert!(idle(1.0).battery_voltage_v - idle(0.0).battery_voltage_v > 39.9);
    let mut flat = ElectricSingleSpeed { open_circuit_rise_v: 720.0, ..drive() };
    assert!(flat.settle(Path::new(".")).unwrap_err().to_string().starts_with("`open_circuit_rise_v` is 720"));
}

proptest! {
    #[test]
    fn powers_balance_and_losses_are_losses_in_every_quadrant(
        speed_m_s in -45.0f64..45.0, force_n in -2e4f64..2e4, auxiliary_power_w in 0.0f64..8e3,
        shaft_power_w in prop_oneof![Just(0.0), 0.0f64..5e5], charge in -0.01f64..1.01, coasting: bool,
    ) {
        let demand = Demand {
            speed_m_s,
            force_n,
            coasting,
            auxiliary_power_w,
            shaft_power_w,
            ..Demand::default()
        };
        let (delivery, rate) = deliver(&drive(), &demand, charge);
        let wheels = delivery.force_n * speed_m_s;
        let taken = wheels + delivery.losses_w.iter().sum::<f64>() + auxiliary_power_w + shaft_power_w;
        let size = delivery.source_power_w.abs() + wheels.abs() + 1.0;
        prop_assert!((delivery.source_power_w - taken).abs() <= 1e-9 * size);
        prop_assert!(delivery.losses_w.iter().all(|loss| *loss >= -1e-9 * size), "{:?}", delivery.losses_w);
        prop_assert!(delivery.force_n * force_n >= 0.0);
        prop_assert!(delivery.force_n.abs() <= force_n.abs() * (1.0 + 1e-12));
        let stored = delivery.readings.battery_current_a / (3600.0 * 60.0);
        prop_assert!((rate + stored).abs() <= 1e-12 + 1e-9 * stored.abs());
    }

    #[test]
    fn any_finite_demand_has_an_answer(speed_m_s in prop::num::f64::NORMAL, force_n in prop::num::f64::NORMAL) {
        prop_assume!(speed_m_s.abs() < 1e100 && force_n.abs() < 1e200);
        let (delivery, rate) = deliver(&drive(), &asked(speed_m_s, force_n), 0.5);
        prop_assert!(delivery.force_n.is_finite() && delivery.source_power_w.is_finite() && rate.is_finite());
        prop_assert!(delivery.losses_w.iter().all(|loss| loss.is_finite()));
    }
}
