use super::*;
use crate::{motor, store};
use proptest::prelude::*;

fn read(ratios: &str, store: &str) -> BatteryElectric {
    let text = format!(
        "(motor: {}, gear_ratios: {ratios}, gear_efficiency: 0.95, wheel_radius_m: 0.93, rotating_mass_kg: 0, \
          shaft_efficiency: 0.9, standby_power_w: 1e3, converter_efficiency: 0.95, {store})",
        motor::tests::TEXT
    );
    let mut drive: BatteryElectric = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(&text)
        .unwrap();
    drive.settle(Path::new(".")).unwrap();
    drive
}

fn drive() -> BatteryElectric {
    read("[60, 30]", &format!("battery: {}", store::tests::TEXT))
}

fn asked(speed_m_s: f64, force_n: f64) -> Demand {
    Demand { speed_m_s, force_n, ..Demand::default() }
}

const STATES: [f64; 3] = [0.5, 65.0, 1.0];

/// 5 m/s and 8 kN in first gear: T = 8000 · 0.93 / (60 · 0.95) = 130.53 N m at 322.58 rad/s, 42 105 W;
/// losses 0.06 · 130.53² + 1.2 · 322.58 + 2e-6 · 322.58³ + 300 = 1776.5 W; 44 882 W with the standby.
#[test]
fn a_pull_in_first_gear_by_hand() {
    let mut rates = [0.0; 3];
    let delivery = drive().deliver(&asked(5.0, 8e3), &STATES, &mut rates);
    assert!((delivery.losses_w[1] - 1776.5).abs() < 0.5, "{}", delivery.losses_w[1]);
    let readings = delivery.readings;
    let terminals = readings.battery_voltage_v * readings.battery_current_a;
    assert!((terminals - 44_881.8).abs() < 1.0, "{terminals}");
    assert!((rates[0] + readings.battery_current_a / 90_000.0).abs() < 1e-15);
    assert!((rates[1] - (1776.5 - 0.0) / 15e3).abs() < 1e-4);
}

#[test]
fn an_empty_battery_drives_no_more_and_says_so() {
    let drive = drive();
    let states = [0.2, 65.0, 1.0];
    let demand = asked(5.0, 8e3);
    let delivery = drive.deliver(&demand, &states, &mut [0.0; 3]);
    assert_eq!(delivery.force_n, 0.0);
    assert!(
        drive
            .exhausted(&demand, &delivery, &states)
            .unwrap()
            .contains("the battery is empty: its charge is 0.200")
    );
    let braking = asked(5.0, -8e3);
    let delivery = drive.deliver(&braking, &states, &mut [0.0; 3]);
    assert_eq!(drive.exhausted(&braking, &delivery, &states), None);
    assert_eq!(delivery.force_n, -8e3);
}

#[test]
fn a_hot_motor_pulls_less() {
    let drive = drive();
    let at =
        |temperature: f64| drive.deliver(&asked(1.0, 1e6), &[0.5, temperature, 1.0], &mut [0.0; 3]).force_n;
    assert!((at(150.0) / at(65.0) - 0.5).abs() < 1e-9);
}

#[test]
fn the_higher_gear_comes_before_the_motor_spins_too_fast_and_goes_again() {
    let drive = drive();
    let mut states = STATES;
    assert!(!drive.decide(&asked(12.0, 0.0), &mut states));
    assert!(drive.decide(&asked(12.7, 0.0), &mut states) && states[GEAR] == 2.0);
    assert!(!drive.decide(&asked(11.0, 0.0), &mut states));
    assert!(drive.decide(&asked(10.0, 0.0), &mut states) && states[GEAR] == 1.0);
}

proptest! {
    #[test]
    fn powers_balance_in_every_quadrant(
        speed_m_s in -12.0f64..12.0, force_n in -6e4f64..6e4, auxiliary_power_w in 0.0f64..2e4,
        shaft_power_w in prop_oneof![Just(0.0), 0.0f64..2e5], coasting: bool, charge in 0.1f64..1.0,
    ) {
        for drive in [drive(), read("[60]", &format!("supercapacitor: {}", store::tests::SUPERCAPACITOR_TEXT))] {
            let demand = Demand { speed_m_s, force_n, coasting, auxiliary_power_w, shaft_power_w, ..Demand::default() };
            let delivery = drive.deliver(&demand, &[charge, 70.0, 1.0], &mut [0.0; 3]);
            let size = delivery.source_power_w.abs() + (delivery.force_n * speed_m_s).abs() + 1.0;
            let sum = delivery.losses_w.iter().sum::<f64>() + auxiliary_power_w + shaft_power_w;
            prop_assert!((delivery.source_power_w - delivery.force_n * speed_m_s - sum).abs() <= 1e-9 * size);
            prop_assert!(delivery.losses_w.iter().all(|loss| *loss >= -1e-9 * size), "{:?}", delivery.losses_w);
            prop_assert!(delivery.force_n * force_n >= 0.0 && delivery.force_n.abs() <= force_n.abs() + 1e-9);
        }
    }
}
