//! Every model that is built in; the only place that knows them all.

use headland_plugin::Registry;

/// Every soil, terrain, driveline, management, task and effect that is built in.
pub fn registry() -> Registry {
    let mut registry = Registry::new();
    headland_soil::register(&mut registry);
    headland_terrain::register(&mut registry);
    headland_driveline::register(&mut registry);
    headland_management::register(&mut registry);
    headland_task::register(&mut registry);
    headland_effect::register(&mut registry);
    registry
}

#[cfg(test)]
mod tests {
    use super::registry;
    use headland_plugin::{Card, Kind, Parameter};

    /// The effects that every version knows.
    const EFFECTS: [&str; 33] = [
        "wind",
        "grade",
        "grade_constant",
        "rotating_inertia",
        "mass",
        "payload_change",
        "aerodynamic_drag",
        "rolling_resistance",
        "rolling_speed_law",
        "rolling_temperature",
        "soft_ground",
        "multipass",
        "neutral_drag",
        "driveline_temperature",
        "brake_drag",
        "braking",
        "cornering_drag",
        "side_slope",
        "roughness",
        "load_dependence",
        "drawbar_load",
        "speed_threshold",
        "wheel_slip",
        "driveline_efficiency",
        "variator_loss",
        "shift_transient",
        "auxiliary_power",
        "engine_friction",
        "turbo_lag",
        "cold_start",
        "regeneration_limit",
        "battery_resistance",
        "expression",
    ];

    #[test]
    fn every_effect_that_users_rely_on_is_there() {
        let registry = registry();
        for name in EFFECTS {
            assert!(registry.effects.card(name).is_some(), "no effect is named `{name}`");
        }
    }

    #[test]
    fn every_kind_has_a_model() {
        for kind in Kind::ALL {
            assert!(!registry().cards(kind).is_empty(), "no {}", kind.name());
        }
    }

    #[test]
    fn every_card_is_complete() {
        let registry = registry();
        for card in Kind::ALL.into_iter().flat_map(|kind| registry.cards(kind)) {
            let Card { name, about, equation, source, validity, parameters } = card;
            for text in [about, equation, source, validity] {
                assert!(text.len() > 2, "{name}: {card:?}");
            }
            for parameter in *parameters {
                complete(name, parameter);
            }
        }
    }

    /// What is no number: a file, a name, a choice.
    const WORDS: [&str; 3] = ["path", "name", "true or false"];

    fn wordy(unit: &str) -> bool {
        WORDS.contains(&unit) || unit.contains(['(', '|'])
    }

    /// A unit, words, and a range that the bound allows; what is no number, and points, have no range.
    fn complete(name: &str, parameter: &Parameter) {
        let Parameter { unit, about, bound, plausible, default, .. } = *parameter;
        assert!(!unit.is_empty() && !about.is_empty(), "{name}: {parameter:?}");
        let numbers = !wordy(unit);
        assert_eq!(plausible.is_some(), numbers, "{name}: {parameter:?}");
        if let Some((low, high)) = plausible {
            assert!(low < high && bound.holds(low) && bound.holds(high), "{name}: {parameter:?}");
        }
        if let Some(value) = default {
            assert!(value.is_infinite() || bound.holds(value), "{name}: {parameter:?}");
        }
    }

    /// A parameter whose name ends in a unit is in that unit.
    #[test]
    fn names_end_in_their_units() {
        let registry = registry();
        for card in Kind::ALL.into_iter().flat_map(|kind| registry.cards(kind)) {
            for parameter in card.parameters {
                let unit = parameter.unit.trim_start_matches('[').trim_end_matches(']');
                if unit == "1" || wordy(unit) {
                    assert!(
                        headland_units::unit_of_name(parameter.name).is_none(),
                        "{}: {parameter:?}",
                        card.name
                    );
                    continue;
                }
                let named = headland_units::unit_of_name(parameter.name).unwrap();
                let said = headland_units::parse_unit(unit).unwrap();
                assert_eq!(named.dimension, said.dimension, "{}: {parameter:?}", card.name);
                assert_eq!(named.factor, said.factor, "{}: {parameter:?}", card.name);
            }
        }
    }
}
