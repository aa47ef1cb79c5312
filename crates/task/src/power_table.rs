//! Coefficients of rotary power by machine, after ASABE D497.
//!
//! P = a + b W + c F        P [kW], W [m], F [t/h] of crop or material
//!
//! Source: ASABE D497, *Agricultural Machinery Management Data*, table 2, from memory: a default to be overridden by what
//! was measured. The standard's own spread is ±25 to ±50 %.

use headland_plugin::{Refusal, closest};
use serde::Deserialize;

/// Power of one kind of machine.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotaryPower {
    /// a [kW].
    pub a: f64,
    /// b [kW/m].
    pub b: f64,
    /// c [kW h/t].
    pub c: f64,
}

impl RotaryPower {
    /// Power [W] at a width [m] and a flow [kg/s].
    pub fn power_w(&self, width_m: f64, flow_kg_s: f64) -> f64 {
        let tonnes_an_hour = flow_kg_s * KG_S_IN_T_H;
        W_IN_KW * (self.a + self.b * width_m + self.c * tonnes_an_hour)
    }
}

/// 1 kg/s is 3.6 t/h.
const KG_S_IN_T_H: f64 = 3.6;
const W_IN_KW: f64 = 1000.0;

/// Where the rows come from.
pub const MACHINES_SOURCE: &str = "ASABE D497, table 2, from memory";

/// Every machine with a, b and c.
pub const MACHINES: [(&str, RotaryPower); 18] = [
    ("baler, small rectangular", RotaryPower { a: 2.0, b: 0.0, c: 1.0 }),
    ("baler, large rectangular", RotaryPower { a: 4.0, b: 0.0, c: 1.3 }),
    ("baler, round, variable chamber", RotaryPower { a: 4.0, b: 0.0, c: 1.1 }),
    ("baler, round, fixed chamber", RotaryPower { a: 2.5, b: 0.0, c: 1.8 }),
    ("forage harvester, direct cut", RotaryPower { a: 6.0, b: 0.0, c: 5.7 }),
    ("forage harvester, corn silage", RotaryPower { a: 6.0, b: 0.0, c: 3.3 }),
    ("forage harvester, wilted grass", RotaryPower { a: 6.0, b: 0.0, c: 4.0 }),
    ("combine, grain", RotaryPower { a: 20.0, b: 0.0, c: 3.6 }),
    ("combine, corn", RotaryPower { a: 35.0, b: 0.0, c: 1.6 }),
    ("mower, disk", RotaryPower { a: 0.0, b: 5.0, c: 0.0 }),
    ("mower, flail", RotaryPower { a: 0.0, b: 10.0, c: 0.0 }),
    ("mower-conditioner, disk", RotaryPower { a: 0.0, b: 8.0, c: 0.0 }),
    ("mower-conditioner, cutterbar", RotaryPower { a: 0.0, b: 4.5, c: 0.0 }),
    ("manure spreader", RotaryPower { a: 0.0, b: 0.0, c: 0.2 }),
    ("rotary rake", RotaryPower { a: 0.0, b: 2.0, c: 0.0 }),
    ("tedder", RotaryPower { a: 0.0, b: 1.5, c: 0.0 }),
    ("tub grinder", RotaryPower { a: 5.0, b: 0.0, c: 8.4 }),
    ("feed mixer", RotaryPower { a: 0.0, b: 0.0, c: 2.3 }),
];

/// The row that `machine` names, or the own one.
///
/// # Errors
/// [`Refusal`] of both, of neither, and of a name that is not known.
pub(crate) fn choose(machine: Option<&str>, own: Option<RotaryPower>) -> Result<RotaryPower, Refusal> {
    let refuse =
        |found: String, expected: String| Refusal { parameter: "machine".to_owned(), found, expected };
    let Some(name) = machine else {
        let own =
            own.ok_or_else(|| refuse("not given".to_owned(), "a machine by name, or `power`".to_owned()))?;
        let numbers = [("a", own.a), ("b", own.b), ("c", own.c)];
        return match numbers.iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
            Some((name, value)) => Err(Refusal {
                parameter: format!("power.{name}"),
                found: value.to_string(),
                expected: "0 or more".to_owned(),
            }),
            None => Ok(own),
        };
    };
    if own.is_some() {
        return Err(refuse(format!("`{name}` beside `power`"), "one of the two".to_owned()));
    }
    MACHINES.iter().find(|(known, _)| *known == name).map(|(_, row)| *row).ok_or_else(|| {
        let names: Vec<&str> = MACHINES.iter().map(|(known, _)| *known).collect();
        let nearest = closest(name, &names).map_or(String::new(), |near| format!("`{near}`, or another "));
        refuse(format!("`{name}`"), format!("{nearest}of: {}", names.join("; ")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A forage harvester in corn that takes 10 kg/s: 6 + 3.3 · 36 = 124.8 kW.
    #[test]
    fn a_forage_harvester_by_hand() {
        let row = choose(Some("forage harvester, corn silage"), None).unwrap();
        assert!((row.power_w(4.5, 10.0) / 124_800.0 - 1.0).abs() < 1e-12);
        let mower = choose(Some("mower, disk"), None).unwrap();
        assert_eq!(mower.power_w(3.2, 0.0), 16_000.0);
    }

    #[test]
    fn a_machine_is_named_or_described_and_not_both() {
        let own = RotaryPower { a: 1.0, b: 2.0, c: 3.0 };
        assert_eq!(choose(None, Some(own)), Ok(own));
        assert!(choose(Some("tedder"), Some(own)).is_err() && choose(None, None).is_err());
        let refusal = choose(Some("mower disk"), None).unwrap_err();
        assert!(refusal.expected.starts_with("`mower, disk`"), "{refusal}");
        assert_eq!(choose(None, Some(RotaryPower { c: -1.0, ..own })).unwrap_err().parameter, "power.c");
    }
}
