//! The unit that ends a name: `speed_m_s` is in m/s, `drag_area_m2` in m².

use crate::{Unit, parse_unit};

/// Ending and unit, longest endings first where one ends another.
const ENDINGS: &[(&str, &str)] = &[
    ("_n_s2_per_m2", "N s^2/m^2"),
    ("_n_s_per_m", "N s/m"),
    ("_kg_per_m3", "kg/m^3"),
    ("_kg_per_m2", "kg/m^2"),
    ("_n_per_rad", "N/rad"),
    ("_kg_per_s", "kg/s"),
    ("_n_per_m", "N/m"),
    ("_j_per_kg", "J/kg"),
    ("_w_per_n2_m2", "W/N^2/m^2"),
    ("_n_m_s2", "N m s^2"),
    ("_pa_s2", "Pa s^2"),
    ("_pa_s", "Pa s"),
    ("_w_k", "W/K"),
    ("_j_k", "J/K"),
    ("_per_m", "1/m"),
    ("_per_k", "1/K"),
    ("_per_s", "1/s"),
    ("_n_s2_m2", "N s^2/m^2"),
    ("_n_s_m", "N s/m"),
    ("_kg_m2", "kg m^2"),
    ("_kg_m3", "kg/m^3"),
    ("_rad_s2", "rad/s^2"),
    ("_rad_s", "rad/s"),
    ("_m_s2", "m/s^2"),
    ("_m2_s2", "m^2/s^2"),
    ("_m3_s", "m^3/s"),
    ("_j_kg", "J/kg"),
    ("_kg_s", "kg/s"),
    ("_kg_j", "kg/J"),
    ("_w_h", "Wh"),
    ("_n_m", "N m"),
    ("_m_s", "m/s"),
    ("_a_h", "Ah"),
    ("_ohm", "ohm"),
    ("_rad", "rad"),
    ("_deg", "deg"),
    ("_m3", "m^3"),
    ("_m2", "m^2"),
    ("_kg", "kg"),
    ("_pa", "Pa"),
    ("_hz", "Hz"),
    ("_m", "m"),
    ("_s", "s"),
    ("_n", "N"),
    ("_w", "W"),
    ("_j", "J"),
    ("_v", "V"),
    ("_f", "F"),
    ("_a", "A"),
    ("_c", "°C"),
    ("_k", "K"),
];

/// The unit that `name` ends in; `None` where it ends in none (a pure number, or a text).
pub fn unit_of_name(name: &str) -> Option<Unit> {
    let (_, unit) = ENDINGS.iter().find(|(ending, _)| name.ends_with(ending))?;
    let mut unit = parse_unit(unit).ok()?;
    if name.ends_with("_k") {
        // A difference of temperatures, not a reading of a scale.
        unit.offset = 0.0;
    }
    Some(unit)
}

/// The name without its unit: `speed_m_s` gives `speed`.
pub fn stem(name: &str) -> &str {
    ENDINGS.iter().find_map(|(ending, _)| name.strip_suffix(ending)).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dimension;

    #[test]
    fn every_ending_is_a_unit() {
        for (ending, unit) in ENDINGS {
            assert!(parse_unit(unit).is_ok(), "{ending}: {unit}");
        }
    }

    #[test]
    fn no_ending_hides_a_longer_one() {
        for (later, (ending, _)) in ENDINGS.iter().enumerate() {
            for (earlier, _) in &ENDINGS[..later] {
                assert!(!ending.ends_with(earlier), "{ending} is never reached behind {earlier}");
            }
        }
    }

    #[test]
    fn names_tell_their_unit() {
        assert_eq!(unit_of_name("speed_m_s").unwrap().dimension, Dimension::of(1, 0, -1, 0, 0, 0));
        assert_eq!(unit_of_name("engine_torque_n_m").unwrap().dimension, Dimension::of(2, 1, -2, 0, 0, 0));
        assert_eq!(unit_of_name("grade"), None);
        assert_eq!(stem("fuel_rate_kg_s"), "fuel_rate");
    }
}
