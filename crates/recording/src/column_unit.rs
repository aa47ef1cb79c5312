//! What a column's header says: a name and, often, a unit.

use headland_units::{Unit, parse_unit, stem, unit_of_name};

/// Endings that loggers hang on a name, and the unit that each means. SI endings are those of channel names.
const TOKENS: &[(&str, &str)] = &[
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("km/h", "km/h"),
    ("mph", "mph"),
    ("mps", "m/s"),
    ("m/s", "m/s"),
    ("rpm", "rpm"),
    ("nm", "N m"),
    ("kn", "kN"),
    ("kw", "kW"),
    ("ms", "ms"),
    ("sec", "s"),
    ("min", "min"),
    ("deg", "deg"),
    ("degc", "°C"),
    ("degf", "°F"),
    ("pct", "%"),
    ("percent", "%"),
    ("%", "%"),
    ("lph", "L/h"),
    ("l/h", "L/h"),
    ("kpa", "kPa"),
    ("bar", "bar"),
    ("psi", "psi"),
];

/// Endings of two words, whose last one alone would be another unit.
const PAIRS: &[(&str, &str)] = &[
    ("_km_h", "km/h"),
    ("_kg_h", "kg/h"),
    ("_g_s", "g/s"),
    ("_g_h", "g/h"),
    ("_l_h", "L/h"),
    ("_m_min", "m/min"),
    ("_deg_s", "deg/s"),
];

/// A header, taken apart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Header {
    /// The header without its unit, trimmed.
    pub stem: String,
    /// The unit, or the text in its place that is none.
    pub unit: Option<Result<Unit, String>>,
}

impl Header {
    /// Takes `Velocity [km/h]`, `vel (mph)`, `speed_kmh`, `Speed km/h` apart.
    pub fn of(text: &str) -> Self {
        let text = text.trim();
        for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
            if let Some(inner) = text.strip_suffix(close)
                && let Some((name, unit)) = inner.rsplit_once(open)
            {
                let unit = unit.trim();
                let read = if unit.is_empty() { None } else { Some(unit_in_words(unit)) };
                return Self { stem: name.trim().to_owned(), unit: read };
            }
        }
        let lower = text.to_lowercase();
        // The ending is of one byte a letter, so that it is as long in the header as in small letters.
        if let Some((ending, unit)) = PAIRS.iter().find(|(ending, _)| lower.ends_with(ending))
            && let Some(name) = text.get(..text.len().saturating_sub(ending.len()))
            && let Ok(unit) = parse_unit(unit)
        {
            return Self { stem: name.to_owned(), unit: Some(Ok(unit)) };
        }
        if let Some(unit) = unit_of_name(text) {
            return Self { stem: stem(text).to_owned(), unit: Some(Ok(unit)) };
        }
        if let Some((name, word)) = text.rsplit_once(['_', ' '])
            && let Some((_, unit)) = TOKENS.iter().find(|(token, _)| word.eq_ignore_ascii_case(token))
            && let Ok(unit) = parse_unit(unit)
        {
            return Self { stem: name.trim_end_matches([',', ' ', '_']).to_owned(), unit: Some(Ok(unit)) };
        }
        Self { stem: text.to_owned(), unit: None }
    }

    /// The stem as it would stand in a channel name: `Wheel Speed` gives `wheel_speed`.
    pub fn key(&self) -> String {
        key(&self.stem)
    }
}

/// Lower case, with one underscore for whatever stands between words.
pub(crate) fn key(text: &str) -> String {
    let words: Vec<String> = text
        .split(|c: char| !c.is_alphanumeric())
        .filter(|word| !word.is_empty())
        .map(str::to_lowercase)
        .collect();
    words.join("_")
}

/// A unit as `units` spells it, or in one of the loggers' spellings; the text where it is none.
pub(crate) fn unit_in_words(text: &str) -> Result<Unit, String> {
    parse_unit(text).or_else(|_| {
        TOKENS
            .iter()
            .find(|(token, _)| text.trim().eq_ignore_ascii_case(token))
            .and_then(|(_, unit)| parse_unit(unit).ok())
            .ok_or_else(|| text.to_owned())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_in_every_place_where_headers_have_them() {
        for header in ["Velocity [km/h]", "vel (km/h)", "speed_kmh", "Speed km/h", "Speed, km/h", "v {km/h}"]
        {
            let unit = Header::of(header).unit.unwrap().unwrap();
            assert!((unit.to_si(36.0) - 10.0).abs() < 1e-12, "{header}");
        }
        assert_eq!(Header::of("Dyno_Spd[mph]").stem, "Dyno_Spd");
        assert_eq!(Header::of("Ambient Temperature [°C]").key(), "ambient_temperature");
        assert_eq!(Header::of("speed_m_s").stem, "speed");
    }

    #[test]
    fn units_of_two_words_end_names_too() {
        for (ending, unit) in PAIRS {
            let header = Header::of(&format!("Fuel{ending}"));
            assert_eq!(header.unit, Some(Ok(parse_unit(unit).unwrap())), "{ending}");
            assert_eq!(header.stem, "Fuel");
        }
        assert_eq!(Header::of("FUEL_G_S").unit.unwrap().unwrap().to_si(1.0), 1e-3);
        assert_eq!(Header::of("fuel_kg_s").unit.unwrap().unwrap().to_si(1.0), 1.0);
    }

    #[test]
    fn a_name_without_a_unit_is_left_alone() {
        for header in ["RR_Fx", "curL", "Time", "CAN1.EEC1.EngineSpeed"] {
            assert_eq!(Header::of(header), Header { stem: header.to_owned(), unit: None });
        }
    }

    #[test]
    fn a_bracket_that_holds_no_unit_is_told() {
        assert_eq!(Header::of("Mode [parsec]").unit, Some(Err("parsec".to_owned())));
    }
}
