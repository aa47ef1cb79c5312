use super::*;
use crate::{ParallelHybrid, PowerSplitHybrid, SeriesHybrid, engine, hydromechanical, motor, store};
use proptest::prelude::*;

fn read<H: Plugin + Driveline>(text: &str) -> H {
    let mut hybrid: H = ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(text)
        .unwrap();
    hybrid.settle(Path::new(".")).unwrap();
    hybrid
}

const CONSUMING: &str = "standby_power_w: 1e3, converter_efficiency: 0.95";

fn parallel() -> ParallelHybrid {
    read(&format!(
        "(engine: {}, motor: {}, motor_ratio: 3, transmission: {}, battery: {}, {CONSUMING})",
        engine::tests::TEXT,
        motor::tests::TEXT,
        hydromechanical::tests::TEXT,
        store::tests::TEXT
    ))
}

/// A machine of 250 kW.
const BIG: &str = "(max_torque_n_m: 1200, max_power_w: 250e3, max_speed_rad_s: 900, copper_w_per_n2_m2: 0.012, \
    iron_torque_n_m: 3, windage_n_m_s2: 4e-6, constant_loss_w: 600, heat_capacity_j_k: 40e3, cooling_w_k: 200, \
    coolant_temperature_c: 65, derating_from_c: 140, derating_to_c: 160)";

fn series() -> SeriesHybrid {
    read(&format!(
        "(engine: {}, motor: {BIG}, generator: {BIG}, generator_ratio: 3, gear_ratio: 65, gear_efficiency: 0.95, \
          wheel_radius_m: 0.93, rotating_mass_kg: 0, battery: {}, {CONSUMING})",
        engine::tests::TEXT,
        store::tests::TEXT
    ))
}

fn power_split() -> PowerSplitHybrid {
    read(&format!(
        "(engine: {}, motor: {BIG}, generator: {BIG}, planetary_ratio: 2.6, motor_ratio: 3, final_ratio: 22, \
          gear_efficiency: 0.95, wheel_radius_m: 0.93, rotating_mass_kg: 0, supercapacitor: {}, {CONSUMING})",
        engine::tests::TEXT,
        store::tests::SUPERCAPACITOR_TEXT
    ))
}

fn hybrids() -> [Box<dyn Driveline>; 3] {
    [Box::new(parallel()), Box::new(series()), Box::new(power_split())]
}

fn asked(speed_m_s: f64, force_n: f64) -> Demand {
    Demand { speed_m_s, force_n, ..Demand::default() }
}

#[test]
fn a_topology_has_as_many_states_as_it_says() {
    fn holds<T: Topology>(hybrid: &Managed<T>) {
        assert_eq!(hybrid.topology.own_states().len(), T::OWN_STATES);
        assert!(T::OWN_STATES <= MOST_OWN_STATES);
    }
    holds(&parallel());
    holds(&series());
    holds(&power_split());
}

/// Boosted, with an engine that is set to a power, and half charged or so.
fn states(hybrid: &dyn Driveline, engine_w: Option<f64>) -> Vec<f64> {
    let mut states: Vec<f64> = hybrid.states().iter().map(|state| state.initial).collect();
    states[BOOST] = 1.0;
    states[RUNS] = f64::from(u8::from(engine_w.is_some()));
    states[SET] = engine_w.unwrap_or(0.0);
    states[CHARGE] = 0.7;
    states
}

fn imbalance_w(delivery: &Delivery, demand: &Demand) -> f64 {
    delivery.source_power_w
        - delivery.force_n * demand.speed_m_s
        - delivery.losses_w.iter().sum::<f64>()
        - demand.auxiliary_power_w
        - demand.shaft_power_w
}

/// The engine gives what it is set to, the store the rest: charge flows out where more is asked and in where less is.
#[test]
fn the_store_makes_up_the_difference() {
    for hybrid in hybrids() {
        let demand = asked(2.5, 25e3);
        let drawn = |engine_w: f64| {
            let delivery = hybrid.deliver(&demand, &states(&*hybrid, Some(engine_w)), &mut []);
            assert_eq!(delivery.force_n, 25e3);
            delivery.readings.battery_current_a
        };
        assert!(drawn(50e3) > 20.0, "{}", drawn(50e3));
        assert!(drawn(120e3) < -20.0, "{}", drawn(120e3));
    }
}

#[test]
fn a_stopped_engine_burns_nothing_and_the_wheels_are_driven() {
    for hybrid in hybrids() {
        let demand = asked(2.0, 20e3);
        let delivery = hybrid.deliver(&demand, &states(&*hybrid, None), &mut []);
        assert_eq!((delivery.source_power_w, delivery.readings.fuel_rate_kg_s), (0.0, 0.0));
        assert_eq!(delivery.force_n, 20e3);
        assert!(delivery.readings.battery_current_a > 50.0);
    }
}

/// Where the store has nothing to give, the engine gives more than it was set to.
#[test]
fn an_empty_store_makes_the_engine_work() {
    for hybrid in hybrids() {
        let demand = asked(2.5, 30e3);
        let mut empty = states(&*hybrid, Some(10e3));
        empty[CHARGE] = if hybrid.losses().contains(&"supercapacitor") { 0.5 } else { 0.2 };
        let delivery = hybrid.deliver(&demand, &empty, &mut []);
        assert_eq!(delivery.force_n, 30e3);
        assert!(delivery.readings.battery_current_a.abs() < 1e-3, "{}", delivery.readings.battery_current_a);
        assert!(delivery.readings.engine_torque_n_m * delivery.readings.engine_speed_rad_s > 75e3);
    }
}

/// A full store takes nothing back: the wheels brake less, or the engine takes it.
#[test]
fn a_full_store_takes_nothing() {
    for hybrid in hybrids() {
        let demand = asked(2.0, -40e3);
        let mut full = states(&*hybrid, None);
        full[CHARGE] = if hybrid.losses().contains(&"supercapacitor") { 1.0 } else { 0.9 };
        let delivery = hybrid.deliver(&demand, &full, &mut []);
        assert!(delivery.force_n > -10e3 && delivery.force_n <= 0.0, "{}", delivery.force_n);
        assert!(delivery.readings.battery_current_a > -1e-3);
        let half = hybrid.deliver(&demand, &states(&*hybrid, None), &mut []);
        assert!(half.force_n < -15e3 && half.readings.battery_current_a < -50.0, "{}", half.force_n);
    }
}

/// Twice the way there and back of the same work without losses would be free; with them a joule stored costs more.
#[test]
fn what_is_stored_and_drawn_again_is_less() {
    for hybrid in hybrids() {
        let demand = asked(2.5, 30e3);
        let weigh = |engine_w: f64| {
            let share = Share { engine_runs: true, engine_w };
            hybrid.weigh(&demand, &states(&*hybrid, Some(0.0)), share).unwrap()
        };
        let (one, two) = (weigh(90e3), weigh(130e3));
        // 40 kW more from the engine put less than 40 kW more into the store.
        let stored = one.store_w - two.store_w;
        assert!(stored < 40e3 && stored > 30e3, "{stored}");
        assert!(two.fuel_w > one.fuel_w + 80e3);
    }
}

/// Willis: with k = 2.6 the generator turns at 3.6 ω_e − 2.6 ω_r and holds the engine's torque over 3.6.
#[test]
fn the_planetary_shares_speeds_and_torques() {
    let split = power_split();
    let demand = asked(2.0, 20e3);
    let states = states(&split, Some(60e3));
    let delivery = split.deliver(&demand, &states, &mut []);
    let engine = delivery.readings.engine_speed_rad_s;
    let ring = 22.0 * 2.0 / 0.93;
    let carrier = 60e3 / engine;
    let out = 20e3 * 0.93 / (22.0 * 0.95);
    assert!((delivery.readings.motor_torque_n_m - (out - carrier * 2.6 / 3.6) / 3.0).abs() < 1e-9);
    let (sun, torque): (f64, f64) = (3.6 * engine - 2.6 * ring, carrier / 3.6);
    let loss = 0.012 * torque * torque + 3.0 * sun + 4e-6 * sun.powi(3) + 600.0;
    assert!((delivery.losses_w[6] - loss).abs() < 1e-6, "{} {loss}", delivery.losses_w[6]);
}

#[test]
fn without_a_management_it_says_that_it_needs_one() {
    assert!(parallel().needs_management());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn powers_balance_in_every_quadrant(
        speed_m_s in -11.0f64..11.0, force_n in -1.2e5f64..1.2e5, auxiliary_power_w in 0.0f64..1e4,
        shaft_power_w in prop_oneof![Just(0.0), 0.0f64..1e5], coasting: bool, charge in 0.2f64..0.9,
        engine_w in prop_oneof![Just(None), (-2e4f64..3e5).prop_map(Some)], boost in 0.0f64..1.0,
    ) {
        for hybrid in hybrids() {
            let demand = Demand { speed_m_s, force_n, coasting, auxiliary_power_w, shaft_power_w, ..Demand::default() };
            let mut states = states(&*hybrid, engine_w);
            (states[CHARGE], states[BOOST]) = (charge, boost);
            let delivery = hybrid.deliver(&demand, &states, &mut []);
            let size = delivery.source_power_w.abs() + delivery.losses_w[5].abs() + (delivery.force_n * speed_m_s).abs();
            prop_assert!(imbalance_w(&delivery, &demand).abs() <= 1e-8 * (size + 1.0), "{hybrid:?}");
            let names = hybrid.losses();
            for (name, loss) in names.iter().zip(delivery.losses_w) {
                prop_assert!(name.ends_with("charge") || loss >= -1e-8 * (size + 1.0), "{name}: {loss}");
            }
            prop_assert!(delivery.losses_w[names.len()..].iter().all(|loss| *loss == 0.0));
            prop_assert!(delivery.source_power_w >= 0.0);
            prop_assert!(delivery.force_n * force_n >= 0.0 && delivery.force_n.abs() <= force_n.abs() + 1e-6);
        }
    }
}

/// What a management is told as the power to follow leaves the store alone, at whatever speed, pull and shaft.
#[test]
fn the_power_to_follow_leaves_the_store_alone() {
    fn worst<T: Topology>(hybrid: &Managed<T>, states: &[f64]) -> f64 {
        let mut worst = 0_f64;
        for speed_m_s in [0.0, 0.4, 1.5, 3.0, 6.0, 10.0] {
            for power_w in [-60e3, -20e3, 0.0, 3e3, 20e3, 60e3, 120e3] {
                for shaft_power_w in [0.0, 30e3] {
                    let force_n = power_w / f64::max(speed_m_s, 1.0);
                    let demand = Demand { shaft_power_w, ..asked(speed_m_s, force_n) };
                    let alone_w = hybrid.alone_w(&demand, states);
                    let asked = Managed::<T>::asked(&demand, states);
                    let bus_w = hybrid.topology.bus_w(&asked, hybrid.wanted_n(&asked));
                    let left_w = bus_w(alone_w) + hybrid.topology.consumers().total_w(&demand);
                    let share = left_w.abs() / alone_w.abs().max(1e3);
                    worst = worst.max(share);
                }
            }
        }
        worst
    }
    let (parallel, series, split) = (parallel(), series(), power_split());
    let all = [
        worst(&parallel, &states(&parallel, Some(5e4))),
        worst(&series, &states(&series, Some(5e4))),
        worst(&split, &states(&split, Some(5e4))),
    ];
    assert!(all.iter().all(|share| *share < 1e-4), "{all:?}");
}
