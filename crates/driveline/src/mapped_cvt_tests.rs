use super::*;
use crate::engine;
use proptest::prelude::*;

fn read(map: &str) -> MappedCvt {
    let text = format!(
        "(engine: {}, speeds_m_s: [0, 2, 4], forces_n: [-50e3, 0, 50e3], engine_speeds_rad_s: {map}, \
          transmission_efficiency: 0.85, idle_torque_n_m: 30, max_force_n: 100e3, wheel_radius_m: 0.93, \
          rotating_mass_kg: 0)",
        engine::tests::TEXT
    );
    ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(&text)
        .unwrap()
}

fn cvt() -> MappedCvt {
    let mut cvt = read("[[90, 100, 120], [100, 110, 160], [0, 150, 190]]");
    cvt.settle(Path::new(".")).unwrap();
    cvt
}

fn asked(speed_m_s: f64, force_n: f64) -> Demand {
    Demand { speed_m_s, force_n, ..Demand::default() }
}

const STATES: [f64; 3] = [1.0, 0.0, 0.0];

/// 3 m/s and 25 kN are the middle of four points: (110 + 160 + 150 + 190) / 4 = 152.5 rad/s. 75 kW / 0.85 + 30 · 152.5 =
/// 92 810 W go into the transmission.
#[test]
fn between_four_points_the_engine_turns_at_their_mean() {
    let delivery = cvt().deliver(&asked(3.0, 25e3), &STATES, &mut [0.0; 3]);
    assert!((delivery.readings.engine_speed_rad_s - 152.5).abs() < 1e-9);
    assert!((delivery.losses_w[1] - (92_810.29 - 75e3)).abs() < 0.01, "{}", delivery.losses_w[1]);
    assert!((delivery.readings.cvt_ratio - 152.5 * 0.93 / 3.0).abs() < 1e-9);
}

/// At 140 rad/s by hand, and 5 m/s, where the map holds nothing: 25 kN · 5 m/s / 0.85 + 30 · 140 = 151 259 W.
#[test]
fn an_engine_whose_speed_is_known_asks_no_map() {
    let cvt = cvt();
    let demand = Demand { engine_speed_rad_s: 140.0, ..asked(5.0, 25e3) };
    let delivery = cvt.deliver(&demand, &STATES, &mut [0.0; 3]);
    assert_eq!(cvt.exhausted(&demand, &delivery, &STATES), None);
    assert_eq!(delivery.readings.engine_speed_rad_s, 140.0);
    assert!((delivery.losses_w[1] - (151_258.82 - 125e3)).abs() < 0.01, "{}", delivery.losses_w[1]);
    // The engine of the test gives no 400 kW, and what was recorded was there.
    let hard = Demand { engine_speed_rad_s: 140.0, ..asked(5.0, 80e3) };
    let force_n = |demand: &Demand| cvt.deliver(demand, &STATES, &mut [0.0; 3]).force_n;
    assert!(force_n(&hard) < 75e3);
    assert_eq!(force_n(&Demand { recorded: true, ..hard }), 80e3);
}

#[test]
fn nothing_is_extrapolated() {
    let cvt = cvt();
    let why = |demand: Demand| {
        let delivery = cvt.deliver(&demand, &STATES, &mut [0.0; 3]);
        cvt.exhausted(&demand, &delivery, &STATES)
    };
    assert_eq!(why(asked(3.0, 25e3)), None);
    assert!(why(asked(4.1, 10e3)).unwrap().contains("4.10 m/s"));
    assert!(why(asked(3.0, 60e3)).unwrap().contains("60000 N"));
    // A point that was never seen hides the cells about it, and no others.
    assert!(why(asked(3.0, -10e3)).is_some());
    assert_eq!(why(asked(2.0, -10e3)), None);
    assert_eq!(why(Demand { coasting: true, ..asked(9.0, 0.0) }), None);
}

#[test]
fn the_engine_gives_no_more_than_its_full_load() {
    let delivery = cvt().deliver(&asked(4.0, 45e3), &STATES, &mut [0.0; 3]);
    assert_eq!(delivery.force_n, 45e3);
    let hard = Demand { shaft_power_w: 60e3, ..asked(4.0, 50e3) };
    let delivery = cvt().deliver(&hard, &STATES, &mut [0.0; 3]);
    let readings = delivery.readings;
    assert!(delivery.force_n < 50e3 && delivery.force_n > 20e3);
    let full = cvt().engine.full_torque_n_m(readings.engine_speed_rad_s);
    assert!((readings.engine_torque_n_m / full - 1.0).abs() < 1e-6);
}

#[test]
fn a_map_that_the_engine_cannot_turn_is_refused() {
    let refused = |map: &str| read(map).settle(Path::new(".")).unwrap_err().to_string();
    assert!(refused("[[90, 100, 120], [100, 110, 160], [0, 150, 400]]").contains("400"));
    assert!(refused("[[90, 100, 120], [100, 110, 160]]").contains("3 lists of 3"));
}

proptest! {
    #[test]
    fn powers_balance_on_the_map_and_off_it(
        speed_m_s in -5.0f64..5.0, force_n in -6e4f64..6e4, auxiliary_power_w in 0.0f64..2e4,
        shaft_power_w in prop_oneof![Just(0.0), 0.0f64..2e5], coasting: bool,
    ) {
        let cvt = cvt();
        let demand = Demand { speed_m_s, force_n, coasting, auxiliary_power_w, shaft_power_w, ..Demand::default() };
        let delivery = cvt.deliver(&demand, &STATES, &mut [0.0; 3]);
        let size = delivery.source_power_w.abs() + (delivery.force_n * speed_m_s).abs() + 1.0;
        let sum = delivery.losses_w.iter().sum::<f64>() + auxiliary_power_w + shaft_power_w;
        prop_assert!((delivery.source_power_w - delivery.force_n * speed_m_s - sum).abs() <= 1e-9 * size);
        prop_assert!(delivery.force_n * force_n >= 0.0 && delivery.force_n.abs() <= force_n.abs() + 1e-9);
    }
}

#[test]
fn a_map_may_stand_in_a_file_of_its_own_and_not_beside_its_lists() {
    let lists = "speeds_m_s: [0, 2, 4], forces_n: [-50e3, 0, 50e3], \
                 engine_speeds_rad_s: [[90, 100, 120], [100, 110, 160], [0, 150, 190]]";
    let rest = "transmission_efficiency: 0.85, idle_torque_n_m: 30, max_force_n: 100e3, wheel_radius_m: 0.93, \
                rotating_mass_kg: 0";
    let settled = |map: &str| {
        let text = format!("(engine: {}, {map} {rest})", engine::tests::TEXT);
        let mut cvt: MappedCvt = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
            .from_str(&text)
            .unwrap();
        cvt.settle(Path::new(".")).map(|()| cvt).map_err(|refusal| refusal.to_string())
    };
    let own = settled(&format!("map: ({lists}, covered_share: 0.9),")).unwrap();
    assert_eq!(own.engine_rad_s(3.0, 25e3, 0.0), cvt().engine_rad_s(3.0, 25e3, 0.0));
    assert!(settled(&format!("map: ({lists}), {lists},")).unwrap_err().contains("`map` is given beside"));
    assert!(settled("").unwrap_err().contains("`map` is not given"));
}
