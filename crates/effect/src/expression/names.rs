//! What an expression may name: variables with their units, and functions.

use super::program::Step;
use headland_plugin::{Air, Situation};

/// A quantity of the situation.
#[derive(Debug)]
pub(super) struct Variable {
    pub name: &'static str,
    pub unit: &'static str,
    pub of: fn(&Situation) -> f64,
}

const fn variable(name: &'static str, unit: &'static str, of: fn(&Situation) -> f64) -> Variable {
    Variable { name, unit, of }
}

/// What forces make of what is asked, and is not known before them: a power may name all of it, a force the acceleration, and what is
/// lost of the force of the drive that force.
pub(super) const MADE: [&str; 3] = [ACCELERATION, DRIVE, ENGINE];
pub(super) const ACCELERATION: &str = "acceleration";
pub(super) const DRIVE: &str = "F_drive";
const ENGINE: &str = "engine_speed";

/// Every variable; NaN where it is not known. Signs are those of [`Situation`]; the cross wind counts from the right.
pub(super) const VARIABLES: [Variable; 26] = [
    variable("v", "m/s", |at| at.speed_m_s),
    variable(ACCELERATION, "m/s²", |at| at.acceleration_m_s2),
    variable(DRIVE, "N", |at| at.tractive_force_n),
    variable(ENGINE, "rad/s", |at| at.engine_speed_rad_s.unwrap_or(f64::NAN)),
    variable("x", "m", |at| at.position_m),
    variable("t", "s", |at| at.time_s),
    variable("heading", "rad", |at| at.place.heading_rad),
    variable("kappa", "1/m", |at| at.place.curvature_per_m),
    variable("slope", "1", |at| at.place.sin_slope),
    variable("roll", "1", |at| at.place.sin_roll),
    variable("elevation", "m", |at| at.place.elevation_m),
    variable("temperature", "°C", |at| at.air.temperature_c),
    variable("oil_temperature", "°C", |at| at.oil_temperature_c.unwrap_or(f64::NAN)),
    variable("state_of_charge", "1", |at| at.state_of_charge.unwrap_or(f64::NAN)),
    variable("tyre_pressure", "Pa", |at| at.tyre_pressure_pa.unwrap_or(f64::NAN)),
    variable("pto_power", "W", |at| at.pto_power_w),
    variable("hydraulic_power", "W", |at| at.hydraulic_power_w),
    variable("m", "kg", |at| at.mass_kg),
    variable("g", "m/s²", |at| at.gravity_m_s2),
    variable("N", "N", |at| at.mass_kg * at.gravity_m_s2 * at.place.cos_slope()),
    variable("rho", "kg/m³", |at| at.air.density_kg_m3),
    variable("area", "m²", |at| at.drag_area_m2),
    variable("coasting", "1", |at| f64::from(u8::from(at.coasting))),
    variable("braking", "1", |at| f64::from(u8::from(at.braking))),
    variable("headwind", "m/s", |at| wind_m_s(&at.air) * (at.air.wind_from_rad - at.place.heading_rad).cos()),
    variable("crosswind", "m/s", |at| {
        wind_m_s(&at.air) * (at.air.wind_from_rad - at.place.heading_rad).sin()
    }),
];

const fn wind_m_s(air: &Air) -> f64 {
    air.wind_speed_m_s
}

/// What a function asks of the units of its arguments, and what unit its value has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rule {
    /// Arguments of one unit, and a value of the same.
    Same,
    /// A pure number gives a pure number.
    Pure,
    /// Any unit, and a pure number.
    Sign,
    /// The root of the unit.
    Root,
    /// As the operator `^`.
    Power,
    /// Arguments of one unit, and a pure number.
    Switch,
    /// Any unit, and seconds; a value of the first unit.
    Lag,
}

/// A function that expressions may call.
#[derive(Debug)]
pub(super) struct Function {
    pub name: &'static str,
    pub arguments: usize,
    pub rule: Rule,
    pub step: Step,
}

const fn function(name: &'static str, rule: Rule, step: Step) -> Function {
    let arguments = match step {
        Step::Push(_) | Step::Load(_) | Step::Recall(_) => 0,
        Step::One(_) => 1,
        Step::Two(_) | Step::Lag(_) => 2,
        Step::Three(_) | Step::Latch(_) => 3,
    };
    Function { name, arguments, rule, step }
}

/// Every function. What is not a number stays so: none of them turns NaN into a number.
pub(super) const FUNCTIONS: [Function; 15] = [
    function("min", Rule::Same, Step::Two(least)),
    function("max", Rule::Same, Step::Two(greatest)),
    function("clamp", Rule::Same, Step::Three(clamp)),
    function("abs", Rule::Same, Step::One(f64::abs)),
    function("sign", Rule::Sign, Step::One(sign)),
    function("sqrt", Rule::Root, Step::One(f64::sqrt)),
    function("pow", Rule::Power, Step::Two(power)),
    function("exp", Rule::Pure, Step::One(f64::exp)),
    function("ln", Rule::Pure, Step::One(f64::ln)),
    function("log10", Rule::Pure, Step::One(f64::log10)),
    function("sin", Rule::Pure, Step::One(f64::sin)),
    function("cos", Rule::Pure, Step::One(f64::cos)),
    function("tanh", Rule::Pure, Step::One(f64::tanh)),
    function("latched", Rule::Switch, Step::Latch(0)),
    function("lagged", Rule::Lag, Step::Lag(0)),
];

/// The distance that was driven since the run began, either way: the one variable that is remembered [m].
pub(super) const WAY: &str = "way";
pub(super) const WAY_UNIT: &str = "m";

/// The unit of what a value is followed by late.
pub(super) const LAG_UNIT: &str = "s";

/// The name of the state of [`WAY`].
pub(super) const WAY_STATE: &str = "way_m";

/// What an expression may remember beside the way, by the names of its states: whether each of its switches is on.
pub(super) const SWITCHES: [&str; 4] = ["latched", "latched_2", "latched_3", "latched_4"];

/// And what follows a value late.
pub(super) const LAGS: [&str; 4] = ["lagged", "lagged_2", "lagged_3", "lagged_4"];

/// Comparisons by their sign: 1 where they hold, 0 where not.
pub(super) const COMPARISONS: [(&str, Step); 6] = [
    ("<", Step::Two(|a, b| truth(a, b, a < b))),
    ("<=", Step::Two(|a, b| truth(a, b, a <= b))),
    (">", Step::Two(|a, b| truth(a, b, a > b))),
    (">=", Step::Two(|a, b| truth(a, b, a >= b))),
    ("==", Step::Two(|a, b| truth(a, b, a == b))),
    ("!=", Step::Two(|a, b| truth(a, b, a != b))),
];

fn truth(a: f64, b: f64, holds: bool) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { f64::from(u8::from(holds)) }
}

/// `f64::min` takes the other number where one is NaN; here NaN wins.
fn least(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }
}

fn greatest(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// NaN where the bounds are the wrong way round.
fn clamp(x: f64, low: f64, high: f64) -> f64 {
    if low <= high && !x.is_nan() { x.clamp(low, high) } else { f64::NAN }
}

/// 0 at 0.
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// Small whole powers are products; NaN to the power of 0 and 1 to the power of NaN stay NaN.
pub(super) fn power(base: f64, exponent: f64) -> f64 {
    /// Beyond it, rounding of repeated products outweighs their speed.
    const MOST_PRODUCTS: f64 = 8.0;
    if base.is_nan() || exponent.is_nan() {
        f64::NAN
    } else if exponent.abs() <= MOST_PRODUCTS && exponent == exponent.trunc() {
        #[expect(clippy::cast_possible_truncation, reason = "a small whole number")]
        base.powi(exponent as i32)
    } else {
        base.powf(exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::super::program::Program;
    use super::*;

    #[test]
    fn every_unit_is_one_and_no_name_stands_twice() {
        let mut names: Vec<&str> = VARIABLES.iter().map(|variable| variable.name).collect();
        names.extend(FUNCTIONS.iter().map(|function| function.name));
        names.push(WAY);
        for name in &names {
            assert_eq!(names.iter().filter(|other| other == &name).count(), 1, "{name}");
        }
        for variable in &VARIABLES {
            assert!(headland_units::parse_unit(variable.unit).is_ok(), "{variable:?}");
        }
    }

    #[test]
    fn nothing_turns_what_is_no_number_into_one() {
        let nan = f64::NAN;
        for Function { name, step, .. } in &FUNCTIONS {
            let values = match step {
                Step::One(f) => vec![f(nan)],
                Step::Two(f) => vec![f(nan, 0.0), f(1.0, nan)],
                Step::Three(f) => vec![f(nan, 0.0, 1.0), f(0.0, nan, 1.0), f(0.0, 0.0, nan)],
                Step::Latch(place) => {
                    let mut program = Program::default();
                    for operand in [Step::Load(|at| at.speed_m_s), Step::Push(0.0), Step::Push(1.0)] {
                        program.push(operand).unwrap();
                    }
                    program.push(*step).unwrap();
                    let unknown = Situation { speed_m_s: nan, ..Situation::default() };
                    vec![program.value(&unknown, &vec![0.0; place + 1])]
                }
                Step::Lag(place) => {
                    let of = |first: f64, second: f64| {
                        let mut program = Program::default();
                        program.push(Step::Push(first)).unwrap();
                        program.push(Step::Push(second)).unwrap();
                        program.push(*step).unwrap();
                        program.value(&Situation::default(), &vec![0.0; place + 1])
                    };
                    vec![of(nan, 1.0), of(1.0, nan), of(1.0, 0.0), of(1.0, -1.0)]
                }
                Step::Push(_) | Step::Load(_) | Step::Recall(_) => Vec::new(),
            };
            assert!(!values.is_empty() && values.iter().all(|value| value.is_nan()), "{name}: {values:?}");
        }
        for (sign, step) in &COMPARISONS {
            let Step::Two(f) = step else { panic!("{sign}") };
            assert!(f(nan, 1.0).is_nan() && f(1.0, nan).is_nan(), "{sign}");
        }
        assert!(clamp(1.0, 2.0, 0.0).is_nan());
    }

    #[test]
    fn powers_are_those_of_the_standard_library() {
        for exponent in [-3.0, -0.5, 0.0, 1.5, 2.0, 8.0, 40.0] {
            let (one, other) = (power(1.7, exponent), 1.7f64.powf(exponent));
            assert!((one / other - 1.0).abs() < 1e-14, "{exponent}: {one}, {other}");
        }
    }
}
