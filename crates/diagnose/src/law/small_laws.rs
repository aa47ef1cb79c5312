//! The small losses of an electric drive as formulas, for where one is not small.

use crate::Case;
use crate::balances::balance::Kind;
use crate::causes::catalogue::{Cause, ELECTRIC, LawText};
use crate::causes::losses::SPEED_SQUARED;
use crate::causes::trial::Pool;
use crate::choosing::search::Found;
use crate::choosing::state::Part;
use crate::law::unlisted::put;

/// A small loss of a drive as a formula.
struct SmallLaw {
    /// The loss.
    small: &'static str,
    text: &'static str,
    /// Constants of the formula: name, unit, value, and to which power it stands in it.
    units: &'static [(&'static str, &'static str, f64, i32)],
    depends_on: &'static [&'static str],
}

/// A speed and a force at which a loss is told.
const V1: (&str, &str, f64, i32) = ("v1_m_s", "m/s", 10.0, 1);
const F1: (&str, &str, f64, i32) = ("f1_n", "N", 1000.0, 1);
const V1_SQUARED: (&str, &str, f64, i32) = (V1.0, V1.1, V1.2, 2);
const F1_SQUARED: (&str, &str, f64, i32) = (F1.0, F1.1, F1.2, 2);
const BOTH: &[&str] = &["tractive_force_n", "speed_m_s"];

/// Those that nothing listed says; a loss in proportion to the power of the drive is one of its efficiency.
const SMALL_LAWS: [SmallLaw; 4] = [
    SmallLaw {
        small: SPEED_SQUARED,
        text: "(v / v1_m_s)^2",
        units: &[V1_SQUARED],
        depends_on: &["speed_m_s"],
    },
    SmallLaw {
        small: "battery_force_squared",
        text: "(F_drive / f1_n)^2",
        units: &[F1_SQUARED],
        depends_on: &["tractive_force_n"],
    },
    SmallLaw {
        small: "battery_power_speed",
        text: "abs(F_drive / f1_n) * (v / v1_m_s)^2",
        units: &[F1, V1_SQUARED],
        depends_on: BOTH,
    },
    SmallLaw {
        small: "battery_power_force",
        text: "(F_drive / f1_n)^2 * abs(v / v1_m_s)",
        units: &[F1_SQUARED, V1],
        depends_on: BOTH,
    },
];

impl SmallLaw {
    /// What a loss of one makes where every ratio is one [W].
    fn watts(&self) -> f64 {
        self.units.iter().map(|(_, _, value, power)| value.powi(*power)).product()
    }

    fn constants_text(&self, power_w: f64) -> String {
        let others = self.units.iter().map(|(name, _, value, _)| format!(", \"{name}\": {value:?}"));
        format!("{{\"a1_w\": {power_w:?}{}}}", others.collect::<String>())
    }
}

/// A loss of an electric drive that is free because it is small, and is not: a consumer of its shape, which no search can
/// find beside it, and the column of what is free.
pub fn outgrown(case: &mut Case, pool: &mut Pool, found: &Found) -> Option<(Part, usize)> {
    /// What is so many times its usual size is not small,
    const MOST: f64 = 3.0;
    /// where it is known by so many standard deviations.
    const SURE: f64 = 8.0;
    let of = |law: &'static SmallLaw| {
        let (_, small) = pool.small.iter().find(|(id, _)| *id == law.small)?;
        let position = found.used.iter().position(|used| used == small)?;
        let value = found.estimate.beta[position];
        let sd = found.estimate.covariance[(position, position)].sqrt();
        (value >= MOST * pool.sd[*small] && value > SURE * sd).then_some((
            value / pool.sd[*small],
            law,
            *small,
            value,
            sd,
        ))
    };
    let all = SMALL_LAWS.iter().filter_map(of);
    let (_, law, small, value, sd) = all.max_by(|one, other| one.0.total_cmp(&other.0))?;
    let watts = law.watts();
    let constant = |name: &str, unit: &str, value: f64, sd: Option<f64>| headland_symbolic::Constant {
        name: name.to_owned(),
        unit: unit.to_owned(),
        value,
        sd,
    };
    let power_w = value * watts;
    let text = LawText {
        role: ELECTRIC,
        text: format!("a1_w * {}", law.text),
        constants_text: law.constants_text(power_w),
        constants: std::iter::once(constant("a1_w", "W", power_w, Some(sd * watts)))
            .chain(law.units.iter().map(|(name, unit, value, _)| constant(name, unit, *value, None)))
            .collect(),
        depends_on: law.depends_on.to_vec(),
        terms: 1,
        // It was free from the start, and nothing was chosen.
        cost: 0.0,
    };
    let column = pool.columns[small].iter().map(|rows| rows * value).collect();
    Some((put(case, pool, Cause::of_law(text, Kind::Battery), column), small))
}
