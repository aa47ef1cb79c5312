use super::*;
use proptest::prelude::*;

const FULL_LOAD: &str = "[(speed_rad_s: 80.0, torque_n_m: 900.0), (speed_rad_s: 150.0, torque_n_m: 1570.0), \
                         (speed_rad_s: 190.0, torque_n_m: 1340.0), (speed_rad_s: 235.0, torque_n_m: 0.0)]";

fn engine() -> EngineCvt {
    let mut engine: EngineCvt = ron::from_str(&format!(
        "(displacement_m3: 8.8e-3, willans_efficiency: 0.46, willans_friction_pa: 0.9e5, \
          lower_heating_value_j_kg: 42.8e6, full_load: {FULL_LOAD}, idle_speed_rad_s: 85.0, load_share: 0.9, \
          transmission_efficiency: 0.85, max_force_n: 90e3, accessory_power_w: 8e3, alternator_efficiency: 0.6, \
          wheel_radius_m: 0.95, rotating_mass_kg: 800.0)"
    ))
    .unwrap();
    engine.settle(Path::new(".")).unwrap();
    engine
}

fn asked(speed_m_s: f64, force_n: f64) -> Demand {
    Demand { speed_m_s, force_n, ..Demand::default() }
}

fn imbalance_w(engine: &EngineCvt, demand: &Demand) -> f64 {
    let delivery = engine.deliver(demand, &[], &mut []);
    let taken = delivery.force_n * demand.speed_m_s
        + delivery.losses_w.iter().sum::<f64>()
        + demand.auxiliary_power_w
        + demand.shaft_power_w;
    delivery.source_power_w - taken
}

/// By hand: 5 m/s and 20 kN are 100 kW, /0.85 = 117 647 W, + 8 kW = 125 647 W at the engine, /0.9 = 139 608 W on the
/// full-load curve. There T = 900 + 670/70 (ω − 80) = 134.286 + 9.57143 ω, so ω = 113.985 rad/s.
/// Friction 0.9e5 · 8.8e-3 · 113.985 / 4π = 7184 W; fuel (125 647 + 7184) / 0.46 = 288 763 W = 6.747 g/s.
#[test]
fn a_pull_of_20_kn_at_5_m_s_by_hand() {
    let delivery = engine().deliver(&asked(5.0, 20e3), &[], &mut []);
    assert_eq!(delivery.force_n, 20e3);
    let readings = delivery.readings;
    let omega = ((134.285_714f64.powi(2) + 4.0 * 9.571_428_6 * 139_607.84).sqrt() - 134.285_714)
        / (2.0 * 9.571_428_6);
    assert!((readings.engine_speed_rad_s / omega - 1.0).abs() < 1e-6);
    assert!((readings.engine_speed_rad_s - 113.98).abs() < 0.05);
    assert!((readings.fuel_rate_kg_s - 6.747e-3).abs() < 2e-6);
    assert!((readings.engine_torque_n_m * omega - 125_647.0).abs() < 1.0);
    assert!((readings.cvt_ratio - omega / (5.0 / 0.95)).abs() < 1e-3);
    assert!((delivery.losses_w[1] - 17_647.06).abs() < 0.01);
}

/// The Willans line in mean pressures, worked apart from the code's form in powers.
#[test]
fn fuel_follows_the_willans_line_in_pressures() {
    for force_n in [2e3, 15e3, 30e3] {
        let readings = engine().deliver(&asked(4.0, force_n), &[], &mut []).readings;
        let p_me = 4.0 * PI * readings.engine_torque_n_m / 8.8e-3;
        let p_mf = 42.8e6 * readings.fuel_rate_kg_s * 4.0 * PI / (readings.engine_speed_rad_s * 8.8e-3);
        assert!((p_me - (0.46 * p_mf - 0.9e5)).abs() < 1e-6 * p_mf);
    }
}

/// Friction at 85 rad/s is 5357 W: idling takes (8000 + 5357) / 0.46 = 29.0 kW of fuel, 0.68 g/s.
#[test]
fn in_neutral_it_idles_and_pulls_nothing() {
    let delivery = engine().deliver(&Demand { coasting: true, ..asked(8.0, 20e3) }, &[], &mut []);
    assert_eq!((delivery.force_n, delivery.readings.engine_speed_rad_s), (0.0, 85.0));
    assert!((delivery.readings.fuel_rate_kg_s - 6.784e-4).abs() < 1e-6);
    assert!(delivery.readings.cvt_ratio.is_nan());
}

/// 10 N m of friction more at ω take 10 ω more of indicated work, 10 ω / e of fuel; the shaft gives the same.
#[test]
fn added_friction_costs_fuel_by_the_slope_of_the_willans_line() {
    let before = engine().deliver(&asked(5.0, 20e3), &[], &mut []);
    let after = engine().deliver(&Demand { engine_friction_n_m: 10.0, ..asked(5.0, 20e3) }, &[], &mut []);
    let expected = 10.0 * before.readings.engine_speed_rad_s / engine().willans_efficiency;
    assert!(((after.source_power_w - before.source_power_w) / expected - 1.0).abs() < 1e-9);
    assert_eq!(after.readings.engine_torque_n_m, before.readings.engine_torque_n_m);
}

#[test]
fn the_wheels_get_at_most_what_full_load_gives() {
    let delivery = engine().deliver(&asked(10.0, 90e3), &[], &mut []);
    let most = 0.85 * (1340.0 * 190.0 - 8e3);
    assert!((delivery.force_n * 10.0 - most).abs() < 1e-6);
    assert!((delivery.readings.engine_torque_n_m - 1340.0).abs() < 1e-6);
    assert_eq!(engine().deliver(&asked(0.0, 1e9), &[], &mut []).force_n, 90e3);
    assert_eq!(engine().deliver(&asked(0.0, -1e9), &[], &mut []).force_n, -90e3);
}

/// Light overrun only relieves the accessories; more is motored with the fuel cut; the rest is not delivered.
#[test]
fn overrun_saves_fuel_then_cuts_it_then_ends_at_the_highest_speed() {
    let at = |force_n: f64| engine().deliver(&asked(10.0, force_n), &[], &mut []);
    assert!(at(-500.0).source_power_w < at(0.0).source_power_w && at(-500.0).source_power_w > 0.0);
    let motored = at(-2000.0);
    assert_eq!((motored.source_power_w, motored.force_n), (0.0, -2000.0));
    // 20 kW · 0.85 − 8 kW = 9 kW of friction, 9000 / 5357 of idle speed.
    assert!((motored.readings.engine_speed_rad_s - 85.0 * 9000.0 / 5357.04).abs() < 0.01);
    let limit = at(-80e3);
    let friction = 0.9e5 * 8.8e-3 * 235.0 / (4.0 * PI);
    assert!((limit.force_n * 10.0 + (friction + 8e3) / 0.85).abs() < 1e-6);
    assert!((limit.readings.engine_speed_rad_s - 235.0).abs() < 1e-9);
}

#[test]
fn backwards_it_drives_as_forwards() {
    let (ahead, back) = (
        engine().deliver(&asked(3.0, 9e3), &[], &mut []),
        engine().deliver(&asked(-3.0, -9e3), &[], &mut []),
    );
    assert_eq!((ahead.source_power_w, ahead.losses_w), (back.source_power_w, back.losses_w));
}

#[test]
fn a_torque_alone_does_not_tell_the_force() {
    assert_eq!(engine().force_of_torque_n(500.0, 3.0), None);
}

#[test]
fn an_idle_speed_beyond_the_curve_is_refused() {
    let mut engine = engine();
    engine.idle_speed_rad_s = 300.0;
    assert!(engine.settle(Path::new(".")).unwrap_err().to_string().contains("idle_speed_rad_s"));
}

proptest! {
    #[test]
    fn powers_balance_and_losses_are_losses_in_every_quadrant(
        speed_m_s in -20.0f64..20.0, force_n in -2e5f64..2e5, auxiliary_power_w in 0.0f64..2e4,
        shaft_power_w in prop_oneof![Just(0.0), 0.0f64..4e5], coasting: bool,
    ) {
        let demand = Demand {
            speed_m_s,
            force_n,
            coasting,
            auxiliary_power_w,
            shaft_power_w,
            ..Demand::default()
        };
        let engine = engine();
        let delivery = engine.deliver(&demand, &[], &mut []);
        let size = delivery.source_power_w.abs() + (delivery.force_n * speed_m_s).abs() + 1.0;
        prop_assert!(imbalance_w(&engine, &demand).abs() <= 1e-9 * size);
        prop_assert!(delivery.source_power_w >= 0.0);
        prop_assert!(delivery.losses_w.iter().all(|loss| *loss >= -1e-9 * size), "{:?}", delivery.losses_w);
        prop_assert!(delivery.force_n * force_n >= 0.0 && delivery.force_n.abs() <= force_n.abs());
        let speed = delivery.readings.engine_speed_rad_s;
        prop_assert!((85.0..=235.0 + 1e-9).contains(&speed), "{speed}");
    }

    #[test]
    fn any_finite_demand_has_an_answer(speed_m_s in prop::num::f64::NORMAL, force_n in prop::num::f64::NORMAL) {
        prop_assume!(speed_m_s.abs() < 1e100);
        let delivery = engine().deliver(&asked(speed_m_s, force_n), &[], &mut []);
        prop_assert!(delivery.force_n.is_finite() && delivery.source_power_w.is_finite());
        prop_assert!(delivery.losses_w.iter().all(|loss| loss.is_finite()));
        prop_assert!(delivery.readings.engine_torque_n_m.is_finite());
    }

    /// Force and fuel have no steps: nearby demands have nearby answers.
    #[test]
    fn fuel_is_continuous_in_the_force(force_n in -3e4f64..3e4) {
        let fuel = |force_n: f64| engine().deliver(&asked(6.0, force_n), &[], &mut []).source_power_w;
        prop_assert!((fuel(force_n + 1e-3) - fuel(force_n - 1e-3)).abs() < 1.0);
    }
}

/// At 170 rad/s by hand: T_full = 1570 − 230/40 · 20 = 1455 N m, 247 350 W; less 8 kW, times 0.85, at 10 m/s: 20 344.75 N.
#[test]
fn an_engine_that_is_kept_at_a_speed_runs_at_it_and_gives_what_it_has_there() {
    let kept = |force_n, engine_speed_rad_s| {
        engine().deliver(&Demand { engine_speed_rad_s, ..asked(10.0, force_n) }, &[], &mut [])
    };
    for force_n in [-1e3, 0.0, 5e3, 60e3] {
        assert_eq!(kept(force_n, 170.0).readings.engine_speed_rad_s, 170.0, "{force_n}");
    }
    assert!((kept(60e3, 170.0).force_n - 20_344.75).abs() < 1e-6);
    assert_eq!(kept(5e3, 300.0).readings.engine_speed_rad_s, 235.0);
    let free = engine().deliver(&asked(10.0, 5e3), &[], &mut []);
    assert_eq!(kept(5e3, 0.0).source_power_w, free.source_power_w);
    let demand = Demand { engine_speed_rad_s: 170.0, shaft_power_w: 40e3, ..asked(10.0, 5e3) };
    assert!(imbalance_w(&engine(), &demand).abs() < 1e-6);
}

/// 60 kN at 10 m/s were recorded: 600 kW / 0.85 + 8 kW at the shaft, at 170 rad/s, where full load is 247 kW.
#[test]
fn full_load_bounds_nothing_that_was_recorded() {
    for engine_speed_rad_s in [0.0, 170.0] {
        let demand = Demand { engine_speed_rad_s, recorded: true, ..asked(10.0, 60e3) };
        let delivery = engine().deliver(&demand, &[], &mut []);
        assert_eq!(delivery.force_n, 60e3);
        let shaft_w = delivery.readings.engine_torque_n_m * delivery.readings.engine_speed_rad_s;
        assert!((shaft_w - (600e3 / 0.85 + 8e3)).abs() < 1e-6, "{shaft_w}");
        assert!(imbalance_w(&engine(), &demand).abs() < 1e-6);
    }
}

/// What an engine shows on its instruments makes the force that it was asked for, in overrun too.
#[test]
fn a_recorded_shaft_tells_the_force_that_went_with_it() {
    for (speed_m_s, force_n) in [(8.0, 15e3), (3.0, 5e3), (12.0, -4e3)] {
        let demand = Demand { auxiliary_power_w: 1200.0, shaft_power_w: 9e3, ..asked(speed_m_s, force_n) };
        let delivery = engine().deliver(&demand, &[], &mut []);
        let Readings { engine_torque_n_m, engine_speed_rad_s, .. } = delivery.readings;
        let shaft = Shaft {
            torque_n_m: engine_torque_n_m,
            speed_rad_s: engine_speed_rad_s,
            wheel_speed_m_s: speed_m_s,
            auxiliary_power_w: 1200.0,
            shaft_power_w: 9e3,
        };
        let told = engine().force_of_shaft_n(&shaft).unwrap();
        assert!((told - delivery.force_n).abs() < 1e-6, "{told} of {force_n}");
        // At a standstill no wheel takes the power.
        assert_eq!(engine().force_of_shaft_n(&Shaft { wheel_speed_m_s: 1e-3, ..shaft }), None);
    }
}
