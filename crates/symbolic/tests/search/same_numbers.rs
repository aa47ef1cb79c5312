//! What is found runs as the effect `expression`, with the numbers that were told.

use crate::plant::{At, Made, Plant};
use crate::recovery::options;
use headland_effect::Expression;
use headland_plugin::{Air, Place, Registry, Situation};
use headland_symbolic::{Law, Target, find};
use std::f64::consts::TAU;
use std::path::Path;

fn situation(at: &At) -> Situation {
    Situation {
        time_s: at.t,
        position_m: at.x,
        speed_m_s: at.v,
        place: Place { heading_rad: at.heading, curvature_per_m: at.kappa, ..Place::default() },
        air: Air { temperature_c: at.temperature, ..Air::default() },
        coasting: at.coasting == 1.0,
        ..Situation::default()
    }
}

fn runs_as_told(law: &Law, what: &str, plant: &Plant) {
    let mut registry = Registry::new();
    registry.effect::<Expression>();
    let parameters = format!("({what}: \"{}\", constants: {})", law.text, law.constants_text());
    let effect = registry.effects.build("expression", &parameters, Path::new("."));
    let effect = effect.unwrap_or_else(|error| panic!("{parameters}: {error}"));
    for (run, prediction) in plant.runs.iter().zip(&law.prediction) {
        for (at, told) in run.iter().zip(prediction) {
            let action = effect.act(&situation(at), &[], &mut []);
            let found = if what == "resistance" { action.resistance_n } else { action.auxiliary_power_w };
            assert!((found - told).abs() <= 1e-9 * told.abs().max(1.0), "{parameters}: {found}, {told}");
        }
    }
}

fn front_runs(made: &Made, plant: &Plant, target: Target, what: &str) {
    let problem = headland_symbolic::Problem { target, ..made.problem() };
    let found = find(&problem, &options(), &|| false).unwrap();
    assert!(found.law().is_some() && found.front.len() > 2);
    for law in found.front.iter().filter(|law| law.terms > 0) {
        runs_as_told(law, what, plant);
        for other in &law.powers {
            runs_as_told(other, what, plant);
        }
    }
}

#[test]
fn every_law_of_the_front_runs_in_a_scenario_with_the_same_numbers() {
    let plant = Plant::new(11, 6, 100.0);
    let wave = |at: &At| {
        300.0 * (TAU * at.x / 21.0).sin() * at.coasting + 60.0 * at.v * (-at.temperature / 9.0).exp()
    };
    front_runs(&plant.problem(11, wave), &plant, Target::Force, "resistance");
}

#[test]
fn a_law_in_watts_runs_as_a_power() {
    let plant = Plant::new(12, 4, 100.0);
    let made = plant.problem(12, |at| if at.t > 17.0 { 700.0 } else { 0.0 });
    front_runs(&made, &plant, Target::Power, "auxiliary_power");
}
