use super::*;
use proptest::prelude::*;

/// The transmission that the tests of drivelines share: nodes at some 4, 9, 19 and 40 km/h with the engine at 188 rad/s.
pub(crate) const TEXT: &str = "(ranges: [(mechanical_ratio: 0.1395, hydrostatic_ratio: 0.1163), \
    (mechanical_ratio: 0.314, hydrostatic_ratio: 0.1017), (mechanical_ratio: 0.6626, hydrostatic_ratio: 0.2034), \
    (mechanical_ratio: 1.395, hydrostatic_ratio: 0.4214)], pump_ratio: 1.2, pump_displacement_m3: 125e-6, \
    motor_displacement_m3: 125e-6, max_pressure_pa: 42e6, viscosity_pa_s: 0.02, leakage: 1e-9, viscous_drag: 1e5, \
    friction: 0.02, mesh_efficiency: 0.985, spin_torque_n_m: 40, final_ratio: 22, axle_efficiency: 0.95, \
    wheel_radius_m: 0.93, rotating_mass_kg: 0)";

pub(crate) fn transmission() -> Hydromechanical {
    let transmission: Hydromechanical = ron::from_str(TEXT).unwrap();
    transmission.settle().unwrap();
    transmission
}

/// At the node of the second range (0.314 · 188.5 rad/s at the output) the motor rests, so the pump only leaks:
/// T_out = 30 000 · 0.93 / (22 · 0.95) = 1334.93 N m, gears 0.314 · 1334.93 · 188.5 = 79 013 W.
#[test]
fn at_a_node_the_gears_carry_the_power() {
    let transmission = transmission();
    let output = 0.314 * 188.5;
    let speed = output * 0.93 / 22.0;
    let through = transmission.through(1.0, speed, 30e3, 188.5);
    // T_m = 0.1017 · 1334.93 = 135.76 N m on 125e-6 / 2π m³: 6.824 MPa.
    assert!((through.pressure_pa / 6.824e6 - 1.0).abs() < 1e-3, "{}", through.pressure_pa);
    assert!(through.stroke.abs() < 0.01);
    // Leakage 1e-9 · 2 · 1.9894e-5 / 0.02 · Δp² = 93 W; pump 1e5 · 1.9894e-5 · 0.02 · 226.2² = 2036 W and
    // 0.02 · 1.9894e-5 · 6.824e6 · 226.2 = 614 W; mesh 1185 W; spin 7540 W.
    let expected = 79_013.0 + 93.0 + 2036.0 + 614.0 + 1185.0 + 7540.0;
    assert!((through.input_w / expected - 1.0).abs() < 1e-3, "{} {expected}", through.input_w);
}

/// Without losses what goes in is what comes out, in every range and at every share of the hydrostat.
#[test]
fn without_losses_power_goes_through_unchanged() {
    let lossless = Hydromechanical {
        leakage: 0.0,
        viscous_drag: 0.0,
        friction: 0.0,
        mesh_efficiency: 1.0,
        spin_torque_n_m: 0.0,
        axle_efficiency: 1.0,
        ..transmission()
    };
    for (range, speed) in [(0.0, 0.3), (0.0, 2.0), (1.0, 3.0), (2.0, 6.0), (3.0, 9.0)] {
        for force in [20e3, -5e3] {
            let input = lossless.through(range, speed, force, 180.0).input_w;
            assert!((input - force * speed).abs() < 1e-6, "{range} {speed}: {input}");
        }
    }
}

/// Where it is best it is at a node, and between two nodes it is worse: the saw-tooth of such transmissions.
#[test]
fn efficiency_falls_away_from_the_nodes() {
    let transmission = transmission();
    let efficiency = |range: f64, ratio: f64| {
        let speed = ratio * 188.5 * 0.93 / 22.0;
        150e3 / transmission.through(range, speed, 150e3 / speed, 188.5).input_w
    };
    let (node, low, high) = (efficiency(1.0, 0.314), efficiency(1.0, 0.22), efficiency(1.0, 0.42));
    assert!(node > low + 0.01 && node > high + 0.01, "{low} {node} {high}");
    assert!((0.80..0.93).contains(&node) && low > 0.75, "{low} {node} {high}");
}

#[test]
fn a_range_stays_until_it_does_not_reach() {
    let transmission = transmission();
    let at = |km_h: f64| km_h / 3.6;
    assert_eq!(transmission.choose(0.0, at(1.0), 188.5), 0.0);
    assert_eq!(transmission.choose(0.0, at(6.4), 188.5), 0.0);
    assert_eq!(transmission.choose(1.0, at(6.4), 188.5), 1.0);
    assert_eq!(transmission.choose(0.0, at(9.0), 188.5), 1.0);
    assert_eq!(transmission.choose(1.0, at(40.0), 188.5), 3.0);
}

/// A gap, a first range that does not reach standstill, no range: refused.
#[test]
fn ranges_that_do_not_join_are_refused() {
    let refused = |from: &str, to: &str| {
        let wrong: Hydromechanical = ron::from_str(&TEXT.replace(from, to)).unwrap();
        wrong.settle().unwrap_err().to_string()
    };
    assert!(refused("hydrostatic_ratio: 0.1017", "hydrostatic_ratio: 0.01").contains("without a gap"));
    assert!(refused("hydrostatic_ratio: 0.1163", "hydrostatic_ratio: 0.05").contains("standstill"));
    assert!(refused("friction: 0.02", "friction: 0.7").starts_with("`transmission.friction` is 0.7"));
}

proptest! {
    /// It never gives more than it takes.
    #[test]
    fn losses_are_losses(range in 0u8..4, speed in 0.0f64..12.0, force in -9e4f64..9e4, engine in 85.0f64..220.0) {
        let through = transmission().through(f64::from(range), speed, force, engine);
        prop_assert!(through.input_w - force * speed >= 0.0, "{through:?}");
    }
}
