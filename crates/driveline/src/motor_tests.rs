use super::*;
use headland_plugin::{Bound, Parameter, parameter};

/// The machine that the tests of drivelines share: 100 kW.
pub(crate) const TEXT: &str = "(max_torque_n_m: 400, max_power_w: 100e3, max_speed_rad_s: 900, copper_w_per_n2_m2: 0.06, \
    iron_torque_n_m: 1.2, windage_n_m_s2: 2e-6, constant_loss_w: 300, heat_capacity_j_k: 15e3, cooling_w_k: 60, \
    coolant_temperature_c: 65, derating_from_c: 140, derating_to_c: 160)";

const CARD: [Parameter; 12] = machine!("motor");

fn motor() -> Motor {
    ron::from_str(TEXT).unwrap()
}

/// 200 N m at 400 rad/s: 2400 + 480 + 128 + 300 = 3308 W of 83 308 W.
#[test]
fn losses_by_hand() {
    assert!((motor().loss_w(200.0, 400.0) - 3308.0).abs() < 1e-9);
    assert!((motor().loss_w(-200.0, 400.0) - 3308.0).abs() < 1e-9);
}

/// 400 N m up to 250 rad/s, then 100 kW; half of it at 150 °C; none at 900 rad/s.
#[test]
fn torque_is_limited_by_power_speed_and_temperature() {
    let motor = motor();
    assert_eq!(motor.limit_n_m(100.0, 65.0), 400.0);
    assert_eq!(motor.limit_n_m(500.0, 65.0), 200.0);
    assert!((motor.limit_n_m(-500.0, 150.0) - 100.0).abs() < 1e-9);
    assert_eq!((motor.limit_n_m(900.0, 65.0), motor.limit_n_m(100.0, 200.0)), (0.0, 0.0));
}

/// 60 W/K and 3308 W end 55.13 K above the coolant, by 1 − 1/e after C/G = 250 s.
#[test]
fn the_winding_warms_to_where_cooling_takes_the_loss() {
    let motor = motor();
    let (mut temperature, step) = (65.0, 0.01);
    for _ in 0..25_000 {
        temperature += step * motor.warming_k_s(3308.0, temperature);
    }
    let expected = 65.0 + 3308.0 / 60.0 * (1.0 - (-1f64).exp());
    assert!((temperature - expected).abs() < 1e-2, "{temperature} {expected}");
}

#[test]
fn what_cannot_be_is_refused_by_its_full_name() {
    let refused = |from: &str, to: &str| {
        let motor: Motor = ron::from_str(&TEXT.replace(from, to)).unwrap();
        motor.settle("motor", &CARD).unwrap_err().to_string()
    };
    assert!(refused("max_power_w: 100e3", "max_power_w: -1").starts_with("`motor.max_power_w` is -1"));
    assert!(refused("derating_to_c: 160", "derating_to_c: 130").starts_with("`motor.derating_to_c`"));
}
