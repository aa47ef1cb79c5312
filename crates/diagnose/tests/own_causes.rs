//! An effect of the user's own, in a registry or among the candidates of the scenario, is tried like the built-in ones.

#![allow(clippy::result_large_err, reason = "a test fails once")]

mod setting;

use headland_diagnose::{Diagnosed, Options, Verdict};
use headland_plugin::{Action, Bound, Card, Effect, Plugin, Registry, Situation, parameter};
use headland_scenario::Scenario;
use serde::Deserialize;
use setting::{found, found_with, named, recorded, recorded_with};
use std::path::Path;

/// A lane with ridges at a distance that lets the suspension swing at one speed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Washboard {
    force_n: f64,
    #[serde(default = "resonance_m_s")]
    resonance_m_s: f64,
}

fn resonance_m_s() -> f64 {
    5.0
}

impl Plugin for Washboard {
    const CARD: Card = Card {
        name: "washboard",
        about: "a washboard that shakes the vehicle at one speed",
        equation: "F = F₀ / (1 + (4 (v/v₀ − 1))²)",
        source: "resonance curve of one body on springs",
        validity: "one kind of ridge",
        parameters: &[
            parameter("force_n", "N", "at the resonance, F₀")
                .must_be(Bound::NotNegative)
                .usually(0.0, 4000.0),
            parameter("resonance_m_s", "m/s", "speed of the resonance, v₀").must_be(Bound::Positive).or(5.0),
        ],
    };
}

impl Effect for Washboard {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let off = 4.0 * (at.speed_m_s / self.resonance_m_s - 1.0);
        Action { resistance_n: self.force_n / (1.0 + off * off), ..Action::default() }
    }
}

/// An effect that needs two numbers, so that nobody knows which of them to look for.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stretch {
    force_n: f64,
    from_m: f64,
}

impl Plugin for Stretch {
    const CARD: Card = Card {
        name: "stretch",
        about: "rough ground from a place on",
        equation: "F = F₀ for x ≥ x₀",
        source: "empirical",
        validity: "one stretch",
        parameters: &[
            parameter("force_n", "N", "on it, F₀").must_be(Bound::Positive).usually(0.0, 4000.0),
            parameter("from_m", "m", "where it begins, x₀").usually(0.0, 1e3),
        ],
    };
}

impl Effect for Stretch {
    fn act(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Action {
        let on = f64::from(u8::from(at.position_m >= self.from_m));
        Action { resistance_n: self.force_n * on, ..Action::default() }
    }
}

fn registry() -> Registry {
    let mut registry = headland_stock::registry();
    registry.effect::<Washboard>();
    registry.effect::<Stretch>();
    registry
}

/// Whether a cause comes first, with its amount within its interval, and the improved scenario holds it.
fn comes_first(found: &Diagnosed, id: &str, value: f64, effect: &str) {
    let said = &found.diagnosis;
    assert_eq!(
        (said.findings[0].id.as_str(), said.verdict),
        (id, Verdict::MissingPhysics),
        "{}",
        said.answer
    );
    let amount = &said.findings[0].parameters[0];
    assert!(amount.ci95[0] < value && value < amount.ci95[1], "{amount:?}");
    let improved =
        Scenario::of_text("improved.ron", &found.scenarios[0], Path::new(""), &registry()).unwrap();
    let model = improved.model(&registry()).unwrap();
    assert_eq!(model.effects.iter().map(|one| one.name.as_str()).collect::<Vec<_>>(), [effect]);
}

#[test]
fn an_effect_of_the_users_registry_is_tried_like_the_built_in_ones() {
    let recording = recorded_with(0.069, "washboard(force_n: 1430.0)", &registry());
    let found = found_with(&recording, &Options::default(), "", &registry()).unwrap();
    comes_first(&found, "washboard", 1430.0, "washboard");
    assert!(
        found.diagnosis.answer.contains("A washboard that shakes the vehicle"),
        "{}",
        found.diagnosis.answer
    );
    let without = Options { without: vec!["washboard".to_owned()], ..Options::default() };
    assert!(!named(&found_with(&recording, &without, "", &registry()).unwrap(), "washboard"));
}

#[test]
fn an_effect_of_ones_own_is_not_claimed_where_it_is_not_at_work() {
    let recording = recorded(0.07, "wind(speed_m_s: 6.2, from_rad: 0.4)");
    let found = found_with(&recording, &Options::default(), "", &registry()).unwrap();
    assert_eq!(found.diagnosis.findings[0].id, "wind", "{}", found.diagnosis.answer);
    assert!(!named(&found, "washboard"), "{}", found.diagnosis.answer);
}

#[test]
fn a_candidate_of_several_numbers_is_tried_by_its_first() {
    let recording = recorded_with(0.069, "stretch(force_n: 1200.0, from_m: 40.0)", &registry());
    let more = "candidates: [stretch(force_n: 1000, from_m: 70), stretch(force_n: 1000, from_m: 40)],";
    let found = found_with(&recording, &Options::default(), more, &registry()).unwrap();
    comes_first(&found, "stretch_2", 1200.0, "stretch");
}

#[test]
fn a_formula_of_the_author_is_tried_by_its_amount() {
    let law = |force: f64| {
        format!(
            "expression(resistance: \"a_n * exp(-v / v0_m_s)\", constants: {{\"a_n\": {force:?}, \"v0_m_s\": 1.3}})"
        )
    };
    let recording = recorded(0.069, &law(5000.0));
    let more = format!("candidates: [{}],", law(4000.0));
    let found = found_with(&recording, &Options::default(), &more, &registry()).unwrap();
    comes_first(&found, "expression", 1.25, "expression");
    let finding = &found.diagnosis.findings[0];
    assert_eq!(
        (finding.equation.as_str(), &finding.depends_on[..]),
        ("resistance = a_n * exp(-v / v0_m_s)", &["speed_m_s".to_owned()][..])
    );
}

#[test]
fn a_formula_of_what_the_drive_loses_is_tried_by_its_amount() {
    let law = |share: f64| {
        format!(
            "expression(loss_share: \"n * v / v0_m_s\", constants: {{\"n\": {share:?}, \"v0_m_s\": 5.0}})"
        )
    };
    let more = format!("candidates: [{}],", law(0.12));
    let found = found_with(&recorded(0.069, &law(0.15)), &Options::default(), &more, &registry()).unwrap();
    comes_first(&found, "expression", 1.25, "expression");
}

#[test]
fn a_candidate_that_is_not_in_proportion_to_its_first_number_is_refused() {
    let more = "candidates: [wind(speed_m_s: 5, from_rad: 0.4), stretch(from_m: 40, force_n: 1000)],";
    let error = found_with(&recorded(0.07, ""), &Options::default(), more, &registry()).err().unwrap();
    assert!(error.to_string().contains("in proportion to `"), "{error}");
    let misspelt = Options { only: vec!["washbord".to_owned()], ..Options::default() };
    let error = found(&recorded(0.07, ""), &misspelt).err().unwrap().to_string();
    assert!(error.contains("no cause is named"), "{error}");
}
