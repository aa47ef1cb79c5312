//! Formulas by hand, and what is refused.

use super::Expression;
use super::names::{FUNCTIONS, VARIABLES, WAY, WAY_UNIT};
use crate::testing::{act, at_10_m_s, build, same};
use headland_plugin::{Air, Place, Plugin, Situation};

/// Every variable has a value of its own, so that none can be taken for another.
fn situation() -> Situation {
    Situation {
        time_s: 50.0,
        position_m: 120.0,
        speed_m_s: 10.0,
        acceleration_m_s2: 0.7,
        tractive_force_n: 450.0,
        mass_kg: 2000.0,
        gravity_m_s2: 9.81,
        place: Place {
            elevation_m: 300.0,
            sin_slope: 0.6,
            sin_roll: 0.07,
            heading_rad: 0.5,
            curvature_per_m: 0.02,
            ..Place::default()
        },
        air: Air { density_kg_m3: 1.2, wind_speed_m_s: 4.0, wind_from_rad: 1.5, temperature_c: -5.0 },
        drag_area_m2: 3.0,
        coasting: true,
        braking: false,
        engine_speed_rad_s: Some(130.0),
        oil_temperature_c: Some(70.0),
        state_of_charge: Some(0.6),
        tyre_pressure_pa: Some(1.2e5),
        pto_power_w: 3e4,
        hydraulic_power_w: 5e3,
        ..Situation::default()
    }
}

fn force_n(text: &str, constants: &str) -> f64 {
    act::<Expression>(
        &format!("(force: \"{text}\", constants: {{\"one_n\": 1.0, {constants}}})"),
        &situation(),
    )
    .force_n
}

fn refused(text: &str) -> String {
    let constants = "{\"k_n_s_m\": 2.0, \"f_n\": 3.0, \"n\": 2.0, \"v0_m_s\": 5.0}";
    build::<Expression>(&format!("(resistance: \"{text}\", constants: {constants})")).unwrap_err()
}

#[test]
fn every_variable_is_what_its_name_says() {
    let expected = [
        10.0, 0.7, 450.0, 130.0, 120.0, 50.0, 0.5, 0.02, 0.6, 0.07, 300.0, -5.0, 70.0, 0.6, 1.2e5, 3e4, 5e3,
        2000.0, 9.81, 15_696.0, 1.2, 3.0, 1.0, 0.0,
    ];
    let expected = expected.into_iter().chain([4.0 * 1f64.cos(), 4.0 * 1f64.sin()]);
    assert_eq!(VARIABLES.len(), expected.clone().count());
    for (variable, expected) in VARIABLES.iter().zip(expected) {
        let value = (variable.of)(&situation());
        assert!((value - expected).abs() < 1e-12, "{}: {value}", variable.name);
    }
}

/// The card is where users find the names.
#[test]
fn the_card_tells_every_name_and_unit() {
    let told: Vec<&str> = Expression::CARD.equation.split_whitespace().collect();
    for variable in &VARIABLES {
        let unit = format!("[{}]", variable.unit);
        assert!(told.windows(2).any(|pair| pair == [variable.name, unit.as_str()]), "{}", variable.name);
    }
    for function in &FUNCTIONS {
        assert!(told.contains(&function.name), "{}", function.name);
    }
    assert!(told.windows(2).any(|pair| pair == [WAY, &format!("[{WAY_UNIT}]")]));
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, expected) in [
        ("2 + 3 * 4", 14.0),
        ("(2 + 3) * 4", 20.0),
        ("2 - 3 - 4", -5.0),
        ("24 / 4 / 3", 2.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2 * -3", -6.0),
        ("--3", 3.0),
        ("1 + 2 < 2 * 2", 1.0),
        ("(1 > 2) + (2 >= 2) + (1 <= 0) + (1 == 1) + (1 != 1)", 2.0),
        (".5e1 − 1", 4.0),
    ] {
        assert_eq!(force_n(&format!("one_n * ({text})"), ""), expected, "{text}");
    }
}

#[test]
fn functions_have_their_values() {
    for (text, expected) in [
        ("min(v / v1_m_s, 3)", 3.0),
        ("max(v / v1_m_s, 3)", 5.0),
        ("clamp(slope, 0, 0.5)", 0.5),
        ("clamp(slope, 0.7, 1)", 0.7),
        ("abs(-slope)", 0.6),
        ("sign(-slope) + 2 * sign(v - v)", -1.0),
        ("sqrt(v / v1_m_s - 1)", 2.0),
        ("pow(v / v1_m_s, 3)", 125.0),
        ("exp(slope)", 1.822_118_800_390_509),
        ("ln(1 + slope)", 0.470_003_629_245_735_5),
        ("log10(100 + slope - slope)", 2.0),
        ("sin(heading)", 0.479_425_538_604_203),
        ("cos(heading)", 0.877_582_561_890_372_8),
        ("tanh(slope)", 0.537_049_566_998_035_3),
        // Nothing decided yet.
        ("latched(slope, 0.5, 0.4)", 0.0),
    ] {
        // What is not used is refused, so each text uses it.
        let value = force_n(&format!("one_n * ({text}) + 0 * one_n * (v / v1_m_s)"), "\"v1_m_s\": 2.0");
        assert!(same(value, expected), "{text}: {value}");
    }
}

/// 0.02 · 20 000 N · (1 + (10 / 5)²) = 2000 N against 150 N · (10 − 4) / (1 m/s) = 900 N; 30 W/K · 25 K; 2 kW in neutral.
#[test]
fn each_formula_acts_where_it_is_said_to() {
    let action = act::<Expression>(
        "(resistance: \"c * N * (1 + (v / v0_m_s)^2)\", force: \"k_n_s_m * max(0, v - v1_m_s)\", \
          auxiliary_power: \"30 * one_w * (t0_c - temperature) / one_k\", shaft_power: \"p_w * (1 - coasting)\", \
          constants: {\"c\": 0.02, \"v0_m_s\": 5.0, \"k_n_s_m\": 150.0, \"v1_m_s\": 4.0, \"one_w\": 1, \
                      \"t0_c\": 30.0, \"one_k\": 1.0, \"p_w\": 2e3})",
        &at_10_m_s(),
    );
    assert!(same(action.resistance_n, 2000.0) && same(action.force_n, 900.0), "{action:?}");
    assert!(same(action.auxiliary_power_w, 750.0) && same(action.shaft_power_w, 2000.0), "{action:?}");
}

/// 0.04 · 10 m/s / (5 m/s) = 0.08 of the drive's force; all of it, or as much again, is no share.
#[test]
fn a_share_of_the_drive_may_be_lost_and_never_all_of_it() {
    let lost = |share: f64| {
        let text =
            format!("(loss_share: \"n * v / v0_m_s\", constants: {{\"n\": {share:?}, \"v0_m_s\": 5.0}})");
        act::<Expression>(&text, &at_10_m_s())
    };
    let action = lost(0.04);
    assert!(same(action.loss_share, 0.08) && same(action.resistance_n, 0.0), "{action:?}");
    assert!(lost(0.5).loss_share.is_nan() && lost(-0.5).loss_share.is_nan());
    let message = build::<Expression>("(loss_share: \"f_n\", constants: {\"f_n\": 1.0})").unwrap_err();
    assert!(message.contains("in N, expected a formula in 1"), "{message}");
}

/// (10 / 5)² · 4 kN / 200 kN = 0.08 of slip; all of the speed is none.
#[test]
fn wheels_may_slip_by_the_force_of_the_drive_and_never_by_all_their_speed() {
    let slips = |force_n: f64| {
        let text = "(slip: \"(v / v0_m_s)^2 * F_drive / f_n\", constants: {\"v0_m_s\": 5.0, \"f_n\": 200e3})";
        let pulling = Situation { tractive_force_n: force_n, ..at_10_m_s() };
        act::<Expression>(text, &pulling)
    };
    assert!(same(slips(4e3).slip, 0.08) && same(slips(4e3).loss_share, 0.0));
    assert!(same(slips(-4e3).slip, -0.08) && slips(60e3).slip.is_nan());
    let message = build::<Expression>("(slip: \"f_n\", constants: {\"f_n\": 1.0})").unwrap_err();
    assert!(message.contains("in N, expected a formula in 1"), "{message}");
}

#[test]
fn constants_are_in_the_units_of_their_names() {
    assert!(same(force_n("one_n * sin(a_deg)", "\"a_deg\": 30.0"), 0.5));
    assert!(same(force_n("one_n * v^0.5 * w_m_s^0.5 / u_m_s", "\"w_m_s\": 40.0, \"u_m_s\": 1.0"), 20.0));
}

#[test]
fn syntax_errors_name_the_character_and_what_was_expected() {
    for (text, expected) in [
        ("f_n * + v", "`+` at character 7, expected a number, a name or `(`"),
        ("f_n *", "the end of the text at character 6, expected a number, a name or `(`"),
        ("", "the end of the text at character 1"),
        ("2 f_n", "`f_n` at character 3, expected an operator or the end"),
        ("(f_n", "the end of the text at character 5, expected an operator or `)`"),
        ("f_n)", "`)` at character 4, expected an operator or the end"),
        ("1 < 2 < 3", "`<` at character 7, expected an operator or the end"),
        ("f_n ; 2", "`;` at character 5"),
        ("min(f_n)", "`)` at character 8, expected an operator or `,`; `min` has 2 arguments"),
        ("abs(f_n, 2)", "`,` at character 8, expected an operator or `)`; `abs` has 1 argument"),
        ("abs * 2", "`*` at character 5, expected `(` behind the function `abs`"),
        (
            "f_n * ρρ + 2",
            "`ρρ` at character 7, expected a constant of `constants` or one of v acceleration F_drive engine_speed x",
        ),
        ("f_n * temperatur", "is `temperature` meant?"),
        ("f_n * ln(-1)", "`ln(-1)` at character 7, which is NaN, expected a finite number"),
        ("f_n / 0", "`f_n / 0` at character 1, which is inf"),
    ] {
        let message = refused(text);
        assert!(message.contains("`resistance` is \"") && message.contains(expected), "{text}: {message}");
    }
}

#[test]
fn units_that_do_not_fit_are_refused() {
    for (text, expected) in [
        ("k_n_s_m * v * v", "in W, expected a formula in N"),
        ("n * slope", "in a pure number, expected a formula in N"),
        ("f_n + k_n_s_m", "`k_n_s_m` at character 7, which is in N s/m, expected N as in `f_n` beside it"),
        ("f_n + 1", "`1` at character 7, which is a pure number, expected N"),
        ("f_n * (v > 3)", "`3` at character 12, which is a pure number, expected m/s"),
        ("f_n * exp(v)", "`v` at character 11, which is in m/s, expected a pure number, as `exp` wants"),
        ("f_n * n^v", "`v` at character 9, which is in m/s, expected a pure number as the exponent"),
        ("k_n_s_m * v^n", "`n` at character 13, expected a written number as the exponent of what is in m/s"),
        ("max(0, f_n, v)", "`,` at character 11"),
        ("clamp(0, f_n, v)", "`v` at character 15, which is in m/s, expected N"),
        ("sqrt(f_n)", "in m^0.5 kg^0.5 s^-1, expected a formula in N"),
    ] {
        let message = refused(text);
        assert!(message.contains("`resistance` is \"") && message.contains(expected), "{text}: {message}");
    }
}

#[test]
fn what_is_missing_or_needless_is_refused() {
    let message = |parameters: &str| build::<Expression>(parameters).unwrap_err();
    assert!(message("()").contains("expected at least one of `resistance`"));
    assert!(message("(force: \"0\", constants: {\"c\": 1.0})").contains("`constants.c` is in no formula"));
    for taken in ["v", "way", "latched"] {
        let found = message(&format!("(force: \"0\", constants: {{\"{taken}\": 1.0}})"));
        assert!(found.contains("the name of a variable"), "{taken}: {found}");
    }
    assert!(message("(force: \"c\", constants: {\"c\": 1, \"c\": 2})").contains("given twice"));
    assert!(message("(force: \"0\", constants: {\"2c\": 1.0})").contains("no digit first"));
    assert!(message("(force: \"f_n\", constants: {\"f_n\": inf})").contains("`constants.f_n` is inf"));
    assert!(message("(drag: \"0\")").contains("drag"));
}

/// A hostile text must not exhaust the stack of the program that reads it.
#[test]
fn texts_without_measure_are_refused() {
    for piece in ["(", "-", "2^", "abs(", "1+("] {
        assert!(refused(&piece.repeat(100_000)).contains("deep"), "{piece}");
    }
    let long = format!("f_n * (k_n_s_m * v0_m_s / f_n + n{})", " + slope".repeat(10_000));
    let constants = "{\"k_n_s_m\": 2.0, \"f_n\": 3.0, \"n\": 2.0, \"v0_m_s\": 5.0}";
    assert!(build::<Expression>(&format!("(force: \"{long}\", constants: {constants})")).is_ok());
}

/// The temperature is not known, and the root of a negative number is none: nothing is made up in their place.
#[test]
fn a_value_that_does_not_exist_is_not_made_up() {
    let mut at = situation();
    at.air.temperature_c = f64::NAN;
    let cold = "(force: \"f_n * (temperature < t_c)\", constants: {\"f_n\": 1.0, \"t_c\": 0.0})";
    assert!(act::<Expression>(cold, &at).force_n.is_nan());
    assert!(force_n("one_n * sqrt(slope - 1)", "").is_nan());
    assert_eq!(force_n("one_n / (slope - slope)", ""), f64::INFINITY);
}

#[test]
fn of_what_forces_make_each_formula_names_what_can_be_found_with_it() {
    let power = "(auxiliary_power: \"k_kg * abs(acceleration) * v\", constants: {\"k_kg\": 100.0})";
    assert!((act::<Expression>(power, &situation()).auxiliary_power_w - 700.0).abs() < 1e-9);
    assert!(build::<Expression>(power).unwrap().follows_acceleration());
    let copper = "(auxiliary_power: \"p_w * (F_drive / f_n)^2\", constants: {\"p_w\": 80.0, \"f_n\": 500.0})";
    let pulling = Situation { tractive_force_n: 1000.0, ..situation() };
    assert!((act::<Expression>(copper, &pulling).auxiliary_power_w - 320.0).abs() < 1e-9);
    assert!(build::<Expression>(&copper.replace("auxiliary_power", "resistance")).is_err());
    // What is lost of the force of the drive is known with it, and an acceleration is not.
    let creep = "(loss_share: \"abs(F_drive) / f_n\", constants: {\"f_n\": 20000.0})";
    assert!((act::<Expression>(creep, &pulling).loss_share - 0.05).abs() < 1e-12);
    assert!(build::<Expression>(creep).unwrap().follows_drive());
    assert!(!build::<Expression>(copper).unwrap().follows_drive());
    let jerky = "(loss_share: \"abs(F_drive) / f_n * acceleration / g\", constants: {\"f_n\": 20000.0})";
    assert!(build::<Expression>(jerky).unwrap_err().contains("`acceleration` in what makes it"));
    let overrun = "(resistance: \"m_kg * max(-acceleration - a_m_s2, 0)\", constants: {\"m_kg\": 5000.0, \"a_m_s2\": 0.2})";
    let slowing = Situation { acceleration_m_s2: -0.7, ..situation() };
    assert!((act::<Expression>(overrun, &slowing).resistance_n - 2500.0).abs() < 1e-9);
    let brake = build::<Expression>(overrun).unwrap();
    assert!(brake.moved_by_acceleration() && brake.follows_acceleration() && !brake.follows_drive());
    assert!(!build::<Expression>(power).unwrap().moved_by_acceleration());
    for (name, text) in
        [("F_drive", "f_n * F_drive / f_n"), ("engine_speed", "f_n * engine_speed / engine_speed")]
    {
        let message =
            build::<Expression>(&format!("(force: \"{text}\", constants: {{\"f_n\": 5.0}})")).unwrap_err();
        let told = format!("`{name}` in what makes it");
        assert!(message.contains(&told) && message.contains("powers may name it"), "{message}");
    }
}

/// On at 4 m/s, off at 2 m/s, whatever lies between: and the other way round where `on` is the lower one. A switch of its own for each.
#[test]
fn a_switch_stays_as_it_is_between_the_values_that_move_it() {
    let both = "(resistance: \"f_n * latched(v, fast_m_s, slow_m_s)\", \
                 force: \"f_n * latched(v, slow_m_s, fast_m_s)\", \
                 constants: {\"f_n\": 100.0, \"fast_m_s\": 4.0, \"slow_m_s\": 2.0})";
    let effect = build::<Expression>(both).unwrap();
    let names: Vec<&str> = effect.states().iter().map(|state| state.name).collect();
    assert_eq!(names, ["latched", "latched_2"]);
    let mut states = [0.0; 2];
    for (speed_m_s, expected, changes) in [
        (3.0, (0.0, 0.0), false),
        (5.0, (100.0, 0.0), true),
        (3.0, (100.0, 0.0), false),
        (2.0, (0.0, 100.0), true),
        (3.0, (0.0, 100.0), false),
        (4.0, (100.0, 0.0), true),
    ] {
        let at = Situation { speed_m_s, ..situation() };
        assert_eq!(effect.decide(&at, &mut states), changes, "{speed_m_s}");
        let action = effect.act(&at, &states, &mut [0.0; 2]);
        assert_eq!((action.resistance_n, action.force_n), expected, "{speed_m_s}");
    }
    let unknown = Situation { speed_m_s: f64::NAN, ..situation() };
    assert!(!effect.decide(&unknown, &mut states) && states == [1.0, 0.0]);
    assert!(effect.act(&unknown, &states, &mut [0.0; 2]).force_n.is_nan());
}

/// 100 N · exp(−60 m / 30 m), and both formulas know one way; it grows backward too.
#[test]
fn the_way_is_what_was_driven_and_not_where_it_began() {
    let fades = "(resistance: \"f_n * exp(-way / l_m)\", force: \"f_n * way / l_m\", \
                  constants: {\"f_n\": 100.0, \"l_m\": 30.0})";
    let effect = build::<Expression>(fades).unwrap();
    assert_eq!(effect.states().iter().map(|state| state.name).collect::<Vec<_>>(), ["way_m"]);
    let mut rates = [f64::NAN];
    let backward = Situation { speed_m_s: -3.0, ..situation() };
    let action = effect.act(&backward, &[60.0], &mut rates);
    assert!(same(action.resistance_n, 100.0 * (-2.0f64).exp()) && same(action.force_n, 200.0));
    assert_eq!(rates, [3.0]);
}

/// dy/dt = (u − y)/τ with τ = 5 s, from y = u at the begin on; what is not known yet is led nowhere.
#[test]
fn what_follows_late_begins_settled_and_closes_in_on_what_it_follows() {
    let late = "(force: \"c_n_s_per_m * lagged(v, lag_s)\", resistance: \"f_n * lagged(v > v0_m_s, lag_s / 2)\", \
                 constants: {\"c_n_s_per_m\": 30.0, \"lag_s\": 5.0, \"f_n\": 100.0, \"v0_m_s\": 2.0})";
    let effect = build::<Expression>(late).unwrap();
    let names: Vec<&str> = effect.states().iter().map(|state| state.name).collect();
    assert_eq!(names, ["lagged", "lagged_2"]);
    let mut states: Vec<f64> = effect.states().iter().map(|state| state.initial).collect();
    let begin = Situation { speed_m_s: 4.0, ..situation() };
    let mut rates = [f64::NAN; 2];
    // Before anything was decided it is what it follows.
    assert_eq!(effect.act(&begin, &states, &mut rates).force_n, 120.0);
    assert_eq!(rates, [0.0; 2]);
    assert!(effect.decide(&begin, &mut states) && states == [1.0, 4.0]);
    let later = Situation { speed_m_s: 1.0, ..situation() };
    assert!(!effect.decide(&later, &mut states) && states == [1.0, 4.0]);
    let action = effect.act(&later, &states, &mut rates);
    assert_eq!((action.force_n, action.resistance_n), (120.0, 100.0));
    assert_eq!(rates, [(0.0 - 1.0) / 2.5, (1.0 - 4.0) / 5.0]);
    let unknown = Situation { speed_m_s: f64::NAN, ..situation() };
    assert!(effect.act(&unknown, &states, &mut rates).force_n.is_nan());
    assert!(rates.iter().all(|rate| *rate == 0.0) && !effect.decide(&unknown, &mut states));
}

#[test]
fn what_follows_late_has_the_unit_of_what_it_follows_and_a_time_constant() {
    assert!(refused("f_n * lagged(v, v0_m_s) / v0_m_s").contains("a time constant in s"));
    assert!(refused("f_n * lagged(v, t)").contains("a formula in N"));
    let five = ["lagged(v, t) / v0_m_s"; 5].join(" + ");
    assert!(refused(&format!("f_n * ({five})")).contains("at most 4 `lagged` in all formulas"));
}

#[test]
fn switches_have_units_and_there_are_not_too_many_of_them() {
    assert!(
        refused("f_n * latched(v, f_n, v0_m_s)")
            .contains("`f_n` at character 18, which is in N, expected m/s")
    );
    let five = ["latched(v, v0_m_s, v0_m_s / 2)"; 5].join(" + ");
    assert!(refused(&format!("f_n * ({five})")).contains("at most 4 switches in all formulas"));
}
