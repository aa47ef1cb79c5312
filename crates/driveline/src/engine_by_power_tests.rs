use super::*;
use proptest::prelude::*;

const TEXT: &str = "(max_power_w: 100e3, efficiency: [(load: 0, efficiency: 0.1), (load: 0.2, efficiency: 0.3), \
    (load: 1, efficiency: 0.4)], idle_fuel_power_w: 4e3, lower_heating_value_j_kg: 43e6, transmission_efficiency: 0.9, \
    max_force_n: 8e3, accessory_power_w: 1e3, alternator_efficiency: 0.5, rotating_mass_kg: 40)";

fn read(text: &str) -> Result<EngineByPower, Refusal> {
    let mut engine: EngineByPower = ron::from_str(text).unwrap();
    engine.settle(Path::new(".")).map(|()| engine)
}

fn engine() -> EngineByPower {
    read(TEXT).unwrap()
}

fn asked(speed_m_s: f64, force_n: f64) -> Demand {
    Demand { speed_m_s, force_n, ..Demand::default() }
}

/// 10 m/s and 5310 N are 53.1 kW, /0.9 = 59 kW, + 1 kW = 60 kW: half way from 0.3 to 0.4, so 60 / 0.35 = 171.43 kW of fuel.
#[test]
fn a_pull_by_hand() {
    let delivery = engine().deliver(&asked(10.0, 5310.0), &[], &mut []);
    assert!((delivery.source_power_w - 60e3 / 0.35).abs() < 1e-6);
    assert!((delivery.losses_w[1] - 5.9e3).abs() < 1e-9 && (delivery.losses_w[2] - 1e3).abs() < 1e-9);
    assert!((delivery.readings.fuel_rate_kg_s * 43e6 - 60e3 / 0.35).abs() < 1e-6);
    let shaft = Shaft {
        torque_n_m: 300.0,
        speed_rad_s: 200.0,
        wheel_speed_m_s: 10.0,
        auxiliary_power_w: 0.0,
        shaft_power_w: 0.0,
    };
    assert!((engine().force_of_shaft_n(&shaft).unwrap() - 5310.0).abs() < 1e-9);
}

/// Accessories of 1 kW at an efficiency of 0.1 + 0.01 = 0.11 take 9091 W; without them idling takes its 4 kW.
#[test]
fn where_the_wheels_push_the_brakes_take_it_all_and_the_engine_idles() {
    let pushed = engine().deliver(&asked(10.0, -3e3), &[], &mut []);
    assert_eq!(pushed.force_n, 0.0);
    assert!((pushed.source_power_w - 1e3 / 0.11).abs() < 1e-6);
    let neutral = engine().deliver(&Demand { coasting: true, ..asked(10.0, 3e3) }, &[], &mut []);
    assert_eq!((neutral.force_n, neutral.source_power_w), (0.0, pushed.source_power_w));
    let idle = read(&TEXT.replace("accessory_power_w: 1e3", "accessory_power_w: 0")).unwrap();
    assert_eq!(idle.deliver(&asked(0.0, 0.0), &[], &mut []).source_power_w, 4e3);
}

#[test]
fn wheels_get_what_full_power_leaves_and_no_more_than_the_greatest_force() {
    let at = |speed: f64, force: f64| engine().deliver(&asked(speed, force), &[], &mut []);
    assert!((at(20.0, 8e3).force_n - 0.9 * 99e3 / 20.0).abs() < 1e-9);
    assert!((at(20.0, 8e3).source_power_w - 100e3 / 0.4).abs() < 1e-6);
    assert_eq!((at(0.0, 9e3).force_n, at(-5.0, -9e3).force_n), (8e3, -8e3));
}

#[test]
fn efficiencies_that_cannot_be_are_refused() {
    let refused = |from: &str, to: &str| read(&TEXT.replace(from, to)).unwrap_err().to_string();
    assert!(refused("load: 0.2", "load: 0").contains("0 after 0"));
    assert!(refused("load: 1,", "load: 0.9,").contains("loads from 0 to 0.9"));
    assert!(refused("efficiency: 0.4", "efficiency: 1.4").contains("`efficiency` is 1.4"));
    assert!(refused("max_power_w: 100e3", "max_power_w: 0").contains("`max_power_w` is 0"));
}

proptest! {
    #[test]
    fn powers_balance_and_losses_are_losses(
        speed_m_s in -30.0f64..30.0, force_n in -2e4f64..2e4, auxiliary_power_w in 0.0f64..5e3, shaft_power_w in 0.0f64..2e5,
        coasting: bool,
    ) {
        let demand =
            Demand { speed_m_s, force_n, coasting, auxiliary_power_w, shaft_power_w, ..Demand::default() };
        let delivery = engine().deliver(&demand, &[], &mut []);
        let taken = delivery.force_n * speed_m_s
            + delivery.losses_w.iter().sum::<f64>()
            + auxiliary_power_w
            + shaft_power_w;
        prop_assert!((delivery.source_power_w - taken).abs() < 1e-6);
        prop_assert!(delivery.losses_w.iter().all(|loss| *loss >= -1e-6));
        prop_assert!(delivery.force_n * force_n >= 0.0 && delivery.force_n.abs() <= force_n.abs());
    }
}
