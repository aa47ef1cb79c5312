//! Vehicles with axles: what is read, and what is refused with its place.

use crate::{Scenario, ScenarioError};
use std::path::Path;

const GOOD: &str = r#"(
    about: "two axles",
    vehicle: (
        mass_kg: 9000,
        rotating_mass_kg: 0,
        drag_area_m2: 5,
        axles: [
            (position_m: 1.5, track_m: 1.9, wheels: 2, lead: 1.02,
             tyre: (name: "small", width_m: "420 mm", diameter_m: 1.3, section_height_m: 0.3, inflation_pa: "1.2 bar", carcass_pa: 0)),
            (position_m: -1.2, track_m: 1.9, wheels: 4, lead: 1,
             tyre: (width_m: 0.52, diameter_m: 1.7, section_height_m: 0.36, inflation_pa: 1.2e5, carcass_pa: 0, stiffness_n_per_m: 4e5)),
        ],
        centre_of_gravity_height_m: 1.1,
        hitch_height_m: 0.6,
        slip_limit: 0.4,
        driveline: Neutral,
    ),
    ground: (terrain: Flat, soil: WismerLuth(cone_index_pa: "800 kPa", pass_factor: 1.3)),
    air: (density_kg_m3: 1.2),
    simulation: (fidelity: Longitudinal, step_s: 0.05),
)"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    Scenario::of_text("test.ron", text, Path::new(""), &headland_stock::registry())
}

/// What is told where one piece is another, and where the carets stand.
fn broken(from: &str, to: &str) -> (String, usize) {
    assert!(GOOD.contains(from), "`{from}` is not in the scenario");
    let error = read(&GOOD.replacen(from, to, 1)).expect_err("the change is a mistake");
    (error.told(), error.location().map_or(0, |at| at.line))
}

#[test]
fn axles_are_read_with_their_tyres() {
    let model = read(GOOD).unwrap().model(&headland_stock::registry()).unwrap();
    let axles = model.axles.unwrap();
    let [front, rear] = axles.list() else { panic!("{axles:?}") };
    assert!((front.tyre.width_m - 0.42).abs() < 1e-12 && (front.tyre.inflation_pa - 1.2e5).abs() < 1e-6);
    assert_eq!((front.lead, rear.wheels, rear.tyre.stiffness_n_per_m), (Some(1.02), 4, Some(4e5)));
    assert_eq!((axles.centre_of_gravity_height_m, axles.hitch_height_m, axles.slip_limit), (1.1, 0.6, 0.4));
}

#[test]
fn what_cannot_stand_is_refused_at_its_place() {
    let (told, line) = broken("position_m: -1.2", "position_m: 1.2");
    assert!(told.contains("both sides of the centre of gravity") && line == 8, "{told}");
    let (told, line) = broken("diameter_m: 1.7", "diameter_m: -1.7");
    assert!(told.contains("`diameter_m`") && told.contains("more than 0") && line == 11, "{told}");
    let (told, line) = broken("section_height_m: 0.36", "section_height_m: 0.9");
    assert!(told.contains("less than half of `diameter_m`") && line == 11, "{told}");
    let (told, _) = broken("lead: 1.02", "lead: 12");
    assert!(told.contains("0.5 to 2"), "{told}");
    let (told, _) = broken("slip_limit: 0.4", "slip_limit: 40");
    assert!(told.contains("`slip_limit`") && told.contains("0.01 to 0.9"), "{told}");
    let (told, _) = broken("wheels: 4, ", "");
    assert!(told.contains("`wheels`"), "{told}");
}

#[test]
fn what_belongs_to_axles_is_asked_for_with_them_and_refused_without() {
    let (told, _) = broken("        hitch_height_m: 0.6,\n", "");
    assert!(told.contains("`hitch_height_m`"), "{told}");
    let start = GOOD.find("        axles: [").unwrap();
    let end = GOOD.find("        ],\n").unwrap() + "        ],\n".len();
    let (told, _) = broken(&GOOD[start..end], "");
    assert!(told.contains("a vehicle without `axles`"), "{told}");
}

#[test]
fn a_soil_of_single_wheels_below_a_whole_vehicle_is_refused() {
    let start = GOOD.find("        axles: [").unwrap();
    let end = GOOD.find("        driveline").unwrap();
    let (told, line) = broken(&GOOD[start..end], "");
    assert!(told.contains("this soil speaks of single wheels") && line == 9, "{told}");
}

#[test]
fn road_load_holds_the_resistance_of_all_wheels() {
    let without = GOOD.replacen(", soil: WismerLuth(cone_index_pa: \"800 kPa\", pass_factor: 1.3)", "", 1);
    let load = "road_load: (f0_n: 100, f1_n_s_m: 1, f2_n_s2_m2: 0.4, air_density_kg_m3: 1.2)";
    let told = read(&without.replacen("drag_area_m2: 5", load, 1)).unwrap_err().told();
    assert!(told.contains("road-load coefficients hold the resistance of all wheels"), "{told}");
}
