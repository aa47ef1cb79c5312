use super::*;
use proptest::prelude::*;

/// The engine that the tests of drivelines share.
pub(crate) const TEXT: &str = "(displacement_m3: 8.8e-3, full_load: [(speed_rad_s: 84, torque_n_m: 900), \
    (speed_rad_s: 147, torque_n_m: 1570), (speed_rad_s: 189, torque_n_m: 1348), (speed_rad_s: 220, torque_n_m: 1110)], \
    idle_speed_rad_s: 84, load_share: 0.9, friction_pa: 1.2e5, friction_rise_pa_s2: 1.6, willans_efficiency: 0.448, \
    lower_heating_value_j_kg: 42.78e6, fuel_density_kg_m3: 832, carbon_dioxide: 3.16, accessory_power_w: 4e3, \
    pump_torque_n_m: 20, fan_power_w: 10e3, alternator_efficiency: 0.6)";

pub(crate) fn read(text: &str) -> Engine {
    ron::Options::default()
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
        .from_str(text)
        .unwrap()
}

fn engine() -> Engine {
    let mut engine = read(TEXT);
    engine.settle().unwrap();
    engine
}

const BOOSTED: Circumstance = Circumstance { boost: 1.0, friction_n_m: 0.0, hand_rad_s: 0.0 };

/// At 150 rad/s and 100 kW: p_me0 = 1.2e5 + 1.6 · 22 500 = 1.56e5 Pa, friction 1.56e5 · 8.8e-3 / 4π = 109.25 N m, 16 387 W;
/// fuel (100 000 + 16 387) / 0.448 = 259 792 W = 6.0727 g/s, 19.19 g/s of CO₂.
#[test]
fn the_willans_line_by_hand() {
    let engine = engine();
    assert!((engine.friction_w(150.0, 0.0) - 16_387.0).abs() < 1.0);
    let fuel = engine.fuel_w(150.0, 100e3, 0.0);
    assert!((fuel - 259_792.0).abs() < 3.0, "{fuel}");
    let (volume, carbon_dioxide) = engine.burnt(fuel);
    assert!((volume * 832.0 - 6.0727e-3).abs() < 1e-6 && (carbon_dioxide - 19.19e-3).abs() < 1e-5);
}

/// At 150 rad/s: 4000 + 20 · 150 + 10 000 (150 / 189)³ = 12 999 W. The greatest power of this curve is at 189 rad/s.
#[test]
fn accessories_by_hand() {
    assert!((engine().curve.peak_speed() - 189.0).abs() < 1.0);
    let fan = 10e3 * (150.0 / engine().curve.peak_speed()).powi(3);
    assert!((engine().accessories_w(150.0) - (7000.0 + fan)).abs() < 1e-6);
    let at = engine().run(60e3, &BOOSTED);
    assert!((at.shaft_w - 60e3 - engine().accessories_w(at.speed_rad_s)).abs() < 1e-9);
}

/// A map that is made of the Willans line at its points gives the same fuel where both are linear: on its nodes.
#[test]
fn a_map_of_the_willans_line_gives_its_fuel() {
    let line = engine();
    let (speeds, torques) = ([80.0, 120.0, 160.0, 220.0], [0.0, 400.0, 800.0, 1200.0, 1600.0]);
    let rows: Vec<Vec<f64>> = speeds
        .iter()
        .map(|speed| {
            torques.iter().map(|torque| line.fuel_w(*speed, torque * speed, 0.0) / 42.78e6).collect()
        })
        .collect();
    let text = TEXT.replace(
        "willans_efficiency: 0.448",
        &format!("fuel_map: (speeds_rad_s: {speeds:?}, torques_n_m: {torques:?}, rates_kg_s: {rows:?})"),
    );
    let mut map = read(&text);
    map.settle().unwrap();
    for speed in speeds {
        for torque in [0.0, 200.0, 900.0, 1550.0, -50.0] {
            let (one, two) =
                (line.fuel_w(speed, torque * speed, 0.0), map.fuel_w(speed, torque * speed, 0.0));
            assert!((one - two).abs() < 1e-6 * one, "{speed} {torque}: {one} {two}");
        }
    }
    // Between its speeds the friction that rises with ω³ makes the straight map lie a little above.
    let (one, two) = (line.fuel_w(140.0, 700.0 * 140.0, 0.0), map.fuel_w(140.0, 700.0 * 140.0, 0.0));
    assert!(two > one && two < 1.01 * one);
    assert_eq!(map.fuel_w(100.0, -300.0 * 100.0, 0.0), 0.0);
}

/// Half of the torque is there at once; full load from b = 0 gives l = σ + (1 − σ) b with τ db/dt = l − b, so that
/// b = 1 − exp(−σ t / τ) at the speed of greatest power.
#[test]
fn boost_comes_with_its_load() {
    let mut engine =
        read(&TEXT.replace("fan_power_w", "unboosted_share: 0.5, boost_time_s: 0.8, fan_power_w"));
    engine.settle().unwrap();
    let none = Circumstance::default();
    assert!((engine.most_w(&none) + engine.accessories_w(189.0) - 0.5 * 1348.0 * 189.0).abs() < 200.0);
    let (mut boost, step) = (0.0, 1e-4);
    for _ in 0..10_000 {
        let at = Circumstance { boost, ..none };
        boost += step * engine.run(engine.most_w(&at), &at).boost_per_s;
    }
    let expected = 1.0 - (-0.5 / 0.8f64).exp();
    assert!((boost - expected).abs() < 1e-3, "{boost} {expected}");
}

/// Where boost misses, the engine turns faster for the same power.
#[test]
fn the_operating_line_rises_where_boost_misses() {
    let mut engine = read(&TEXT.replace("fan_power_w", "unboosted_share: 0.5, fan_power_w"));
    engine.settle().unwrap();
    let slow = engine.speed_rad_s(80e3, &BOOSTED);
    assert!(engine.speed_rad_s(80e3, &Circumstance::default()) > slow + 10.0);
}

/// A governor of 6 % holds 200 rad/s at full load and 212 without.
#[test]
fn a_hand_throttle_droops_with_load() {
    let mut engine = read(&TEXT.replace("fan_power_w", "droop: 0.06, fan_power_w"));
    engine.settle().unwrap();
    let by_hand = Circumstance { hand_rad_s: 200.0, ..BOOSTED };
    let full_w = engine.full_torque_n_m(200.0) * 200.0;
    assert!((engine.speed_rad_s(full_w, &by_hand) - 200.0).abs() < 1e-9);
    assert!((engine.speed_rad_s(0.5 * full_w, &by_hand) - 206.0).abs() < 1e-9);
    assert!((engine.speed_rad_s(0.0, &by_hand) - 212.0).abs() < 1e-9);
}

#[test]
fn what_cannot_be_is_refused_by_its_full_name() {
    let refused = |from: &str, to: &str| read(&TEXT.replace(from, to)).settle().unwrap_err().to_string();
    assert!(refused("load_share: 0.9", "load_share: 1.2").starts_with("`engine.load_share` is 1.2"));
    assert!(
        refused("idle_speed_rad_s: 84", "idle_speed_rad_s: 300").starts_with("`engine.idle_speed_rad_s`")
    );
    assert!(refused("willans_efficiency: 0.448, ", "").contains("fuel_map"));
    let short =
        "fuel_map: (speeds_rad_s: [80, 150], torques_n_m: [0, 1600], rates_kg_s: [[0, 0.01], [0, 0.01]])";
    assert!(refused("willans_efficiency: 0.448", short).contains("nothing is extrapolated"));
    let both = format!("willans_efficiency: 0.4, {short}");
    assert!(refused("willans_efficiency: 0.448", &both).contains("one of the two"));
    let ragged = "fuel_map: (speeds_rad_s: [80, 220], torques_n_m: [0, 1600], rates_kg_s: [[0, 0.01], [0]])";
    assert!(refused("willans_efficiency: 0.448", ragged).contains("2 lists of 2 rates"));
}

proptest! {
    /// From full braking to full power the engine stays between idle and its last speed, and speed and fuel have no steps.
    #[test]
    fn speed_and_fuel_are_continuous_from_braking_to_full_power(share in 0.0f64..1.0, boost in 0.0f64..1.0) {
        let engine = engine();
        let at = Circumstance { boost, ..BOOSTED };
        let (least, most) = (engine.least_w(&at), engine.most_w(&at));
        let power = least + share * (most - least);
        let (one, two) = (engine.run(power, &at), engine.run((power + 1.0).min(most), &at));
        prop_assert!(one.speed_rad_s >= 84.0 - 1e-9 && one.speed_rad_s <= 220.0 + 1e-9);
        prop_assert!((one.speed_rad_s - two.speed_rad_s).abs() < 0.1, "{one:?} {two:?}");
        prop_assert!((one.fuel_w - two.fuel_w).abs() < 200.0, "{one:?} {two:?}");
        prop_assert!(one.torque_n_m() <= engine.full_torque_n_m(one.speed_rad_s) * 1.005);
    }
}
