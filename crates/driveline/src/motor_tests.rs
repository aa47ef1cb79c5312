use super::*;
use headland_plugin::{Bound, Parameter, parameter};

/// The machine that the tests of drivelines share: 100 kW.
pub(crate) const TEXT: &str = "(max_torque_n_m: 400, max_power_w: 100e3, max_speed_rad_s: 900, copper_w_per_n2_m2: 0.06, \
    iron_torque_n_m: 1.2, windage_n_m_s2: 2e-6, constant_loss_w: 300, heat_capacity_j_k: 15e3, cooling_w_k: 60, \
    coolant_temperature_c: 65, derating_from_c: 140, derating_to_c: 160)";

const CARD: [Parameter; crate::motor::COUNT] = machine!("motor");

fn motor() -> Motor {
    mapped(TEXT)
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

/// A map of the same formula at its nodes: 200 N m at 400 rad/s is a node, 3308 W; half way between nodes the mean of four.
const MAP: &str = "(max_torque_n_m: 400, max_power_w: 100e3, max_speed_rad_s: 800, heat_capacity_j_k: 15e3, cooling_w_k: 60, \
    coolant_temperature_c: 65, derating_from_c: 140, derating_to_c: 160, loss_map: (speeds_rad_s: [0, 400, 800], \
    torques_n_m: [-400, 0, 200, 400], losses_w: [[8000, 300, 2700, 9900], [8908, 908, 3308, 10508], [9000, 2284, 4684, 11884]]))";

fn mapped(text: &str) -> Motor {
    ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(text)
        .unwrap()
}

#[test]
fn losses_of_a_map_by_hand() {
    let motor = mapped(MAP);
    motor.settle("motor", &CARD).unwrap();
    assert!((motor.loss_w(200.0, 400.0) - 3308.0).abs() < 1e-9);
    assert!((motor.loss_w(300.0, 600.0) - 0.25 * (3308.0 + 10508.0 + 4684.0 + 11884.0)).abs() < 1e-9);
    // Braking has its own side, backwards too; a map from 0 on has one side for both.
    assert!((motor.loss_w(-400.0, 400.0) - 8908.0).abs() < 1e-9);
    assert!((motor.loss_w(400.0, -400.0) - 8908.0).abs() < 1e-9);
    let one_side =
        MAP.replace("-400, 0,", "0,").replace("[8000, ", "[").replace("[8908, ", "[").replace("[9000, ", "[");
    assert!((mapped(&one_side).loss_w(-200.0, 400.0) - 3308.0).abs() < 1e-9);
}

#[test]
fn maps_that_do_not_fit_are_refused() {
    let refused =
        |from: &str, to: &str| mapped(&MAP.replace(from, to)).settle("motor", &CARD).unwrap_err().to_string();
    assert!(refused("[0, 400, 800]", "[0, 400, 700]").contains("`motor.loss_map.speeds_rad_s` is 0 to 700"));
    assert!(refused("[-400, 0,", "[-300, 0,").contains("`motor.loss_map.torques_n_m` is -300 to 400"));
    assert!(refused("[8908, ", "[").contains("3 lists of [4, 3, 4] losses"));
    assert!(refused("8908", "-1").contains("`motor.loss_map.losses_w` is -1"));
    assert!(refused("loss_map", "constant_loss_w: 300, loss_map").contains("one of the two"));
    let none = MAP.split(", loss_map").next().unwrap().to_owned() + ", constant_loss_w: 300)";
    assert!(mapped(&none).settle("motor", &CARD).unwrap_err().to_string().contains("told by 1 losses"));
}

#[test]
fn what_cannot_be_is_refused_by_its_full_name() {
    let refused = |from: &str, to: &str| {
        let motor = mapped(&TEXT.replace(from, to));
        motor.settle("motor", &CARD).unwrap_err().to_string()
    };
    assert!(refused("max_power_w: 100e3", "max_power_w: -1").starts_with("`motor.max_power_w` is -1"));
    assert!(refused("derating_to_c: 160", "derating_to_c: 130").starts_with("`motor.derating_to_c`"));
}
