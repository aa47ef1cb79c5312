//! Tests of the rigid body of a scenario.

use crate::{Fidelity, Scenario};
use headland_sim::End;
use std::path::Path;

const GOOD: &str = r#"(
    about: "a coast-down on four wheels",
    vehicle: (
        mass_kg: 13000, rotating_mass_kg: 900, drag_area_m2: 6,
        axles: [
            (position_m: 1.8, track_m: 2.1, wheels: 2, lead: 1, tyre: (
                width_m: 0.9, diameter_m: 2.045, section_height_m: 0.54, inflation_pa: 1.5e5, carcass_pa: 0)),
            (position_m: -1.8, track_m: 2.1, wheels: 2, lead: 1, tyre: (
                width_m: 0.9, diameter_m: 2.045, section_height_m: 0.54, inflation_pa: 1.5e5, carcass_pa: 0)),
        ],
        centre_of_gravity_height_m: 1.3, hitch_height_m: 0.7, slip_limit: 0.5,
        body: (
            roll_inertia_kg_m2: 9e3, pitch_inertia_kg_m2: 32e3, yaw_inertia_kg_m2: 33e3, hitch_position_m: -3,
            steering: (mode: Front, limit_rad: "35 deg", rate_rad_s: 0.5, look_ahead_m: 5),
            centre: Locked,
            axles: [
                (damping_n_s_m: 6e3, friction: 0.8, slip_stiffness: 12, cornering_stiffness_per_rad: 6,
                 relaxation_length_m: 0.7, differential: Open),
                (damping_n_s_m: 6e3, friction: 0.8, slip_stiffness: 12, cornering_stiffness_per_rad: 6,
                 relaxation_length_m: 0.7, differential: Open),
            ],
        ),
        driveline: Neutral,
    ),
    ground: (terrain: Flat, soil: Constant(coefficient: 0.07)),
    air: (density_kg_m3: 1.2),
    start: (position_m: 0, speed_m_s: 5),
    cycle: [Coast(until: Stopped)],
    simulation: (fidelity: RigidBody(record_s: "50 ms"), step_s: 0.004),
)"#;

fn of(text: &str) -> Scenario {
    Scenario::of_text("test.ron", text, Path::new(""), &headland_stock::registry())
        .unwrap_or_else(|error| panic!("{}", error.told()))
}

fn told(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    let text = GOOD.replacen(from, to, 1);
    Scenario::of_text("test.ron", &text, Path::new(""), &headland_stock::registry()).unwrap_err().told()
}

#[test]
fn one_word_changes_the_fidelity_and_nothing_else_does() {
    let rigid = of(GOOD);
    let Fidelity::RigidBody { record_s, .. } = rigid.fidelity else { panic!("{:?}", rigid.fidelity) };
    assert_eq!(record_s, 0.05);
    let flat = of(&GOOD.replace("RigidBody(record_s: \"50 ms\")", "Longitudinal"));
    assert_eq!(flat.fidelity, Fidelity::Longitudinal);
    let registry = headland_stock::registry();
    let way = |scenario: &Scenario| {
        let model = scenario.model(&registry).unwrap();
        let outcome = scenario.fidelity.simulate(&model, scenario.cycle.as_ref().unwrap()).unwrap();
        *outcome.trace.get("position_m").unwrap().last().unwrap()
    };
    assert!((way(&rigid) / way(&flat) - 1.0).abs() < 2e-3, "{} {}", way(&rigid), way(&flat));
}

/// A pull without measure was done in one step and told as a vehicle that had rolled out; backward it is no pull.
#[test]
fn a_pull_without_measure_ends_the_run_at_its_start_and_is_told() {
    let pull = |force_n: f64| format!("tasks: [Drawbar(force_n: {force_n:e})],\n    start:");
    let scenario = of(&GOOD.replace("start:", &pull(f64::MAX)));
    let model = scenario.model(&headland_stock::registry()).unwrap();
    let outcome = scenario.fidelity.simulate(&model, scenario.cycle.as_ref().unwrap()).unwrap();
    let End::Stopped { reason, time_s, position_m } = outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("under 1.8e308 N the motion is no finite number"), "{reason}");
    assert_eq!((time_s, position_m, outcome.trace.get("speed_m_s").unwrap()), (0.0, 0.0, &[5.0][..]));
    let backward = told("start:", &pull(-f64::MAX));
    assert!(backward.contains("`force_n` is -1797") && backward.contains("expected 0 or more"), "{backward}");
}

#[test]
fn what_the_body_lacks_is_told_where_it_should_stand() {
    let start = GOOD.find("        body: (").unwrap();
    let end = GOOD.find("        driveline: Neutral").unwrap();
    let without = told(&GOOD[start..end], "");
    assert!(without.contains("lacks the field `body`") && without.contains("RigidBody"), "{without}");
    let lame = told(" hitch_position_m: -3,", "");
    assert!(lame.contains("`body` lacks the field `hitch_position_m`"), "{lame}");
}

#[test]
fn what_cannot_be_is_refused_where_it_stands() {
    let step = told("step_s: 0.004", "step_s: 0.2");
    assert!(step.contains("`step_s` is 0.2, expected at most") && step.contains("test.ron:29"), "{step}");
    let inertia = told("roll_inertia_kg_m2: 9e3", "roll_inertia_kg_m2: 9e5");
    assert!(inertia.contains("`roll_inertia_kg_m2` is 900000") && inertia.contains("other two"), "{inertia}");
    let spring = told(
        "differential: Open)",
        "differential: Open, suspension: (stiffness_n_m: 3e5, damping_n_s_m: 0))",
    );
    assert!(spring.contains("`damping_n_s_m` is 0, expected more than 0"), "{spring}");
    let hub = told(
        "differential: Open)",
        "differential: Open, suspension: (stiffness_n_m: 3e5, damping_n_s_m: 1e4, unsprung_mass_kg: -5))",
    );
    assert!(
        hub.contains("`unsprung_mass_kg` is -5, expected 0 or more") && hub.contains("test.ron:18"),
        "{hub}"
    );
    let heavy = told(
        "differential: Open)",
        "differential: Open, suspension: (stiffness_n_m: 3e5, damping_n_s_m: 1e4, unsprung_mass_kg: 5000))",
    );
    assert!(
        heavy.contains("`axles.0.suspension.unsprung_mass_kg` is 5000") && heavy.contains("test.ron:18"),
        "{heavy}"
    );
    let crab = told("mode: Front", "mode: Crab(angle_rad: 2)");
    assert!(crab.contains("a crab of 2 rad") && crab.contains("test.ron:14:30"), "{crab}");
    let line = told("track_m: 2.1", "track_m: 0");
    assert!(line.contains("`axles.0.track_m` is 0") && line.contains("test.ron:6"), "{line}");
    let beyond = told(
        "terrain: Flat",
        "terrain: Profile(heading_rad: 0, points: [(position_m: 1, elevation_m: 0), (position_m: 60, elevation_m: 0)])",
    );
    assert!(
        beyond.contains("`position_m` is 0, expected 1.0 to 60.0") && beyond.contains("test.ron:27"),
        "{beyond}"
    );
    let fast = told("speed_m_s: 5", "speed_m_s: 500");
    assert!(fast.contains("a wheel rolls past its footprint") && fast.contains("test.ron:29"), "{fast}");
    let friction = told("friction: 0.8", "friction: -0.8");
    assert!(friction.contains("`friction` is -0.8, expected 0.01 to 3"), "{friction}");
    let aside = told("friction: 0.8", "friction: 0.8, side_friction: 0");
    assert!(aside.contains("`side_friction` is 0, expected 0.01 to 3"), "{aside}");
    let weightless = told("mass_kg: 13000, rotating_mass_kg: 900", "mass_kg: 13000, rotating_mass_kg: 0");
    assert!(weightless.contains("`rotating_mass_kg` is 0, expected more than 0"), "{weightless}");
    let mass = told("mass_kg: 13000", "mass_kg: 0");
    assert!(mass.contains("`mass_kg` is 0, expected more than 0"), "{mass}");
}

const TRAILER: &str = r#"steering: (mode: Front, limit_rad: "35 deg", rate_rad_s: 0.5, look_ahead_m: 5),
            trailer: (
                centre_of_gravity_height_m: 1.4, roll_radius_m: 0.9, pitch_radius_m: 1.6, yaw_radius_m: 1.7, rotating_mass_kg: 150,
                axles: [(
                    position_m: -4.5, track_m: 1.9, wheels: 2,
                    tyre: (width_m: 0.5, diameter_m: 1.3, section_height_m: 0.3, inflation_pa: "2 bar", carcass_pa: 0),
                    damping_n_s_m: 5e3, friction: 0.8, slip_stiffness: 12, cornering_stiffness_per_rad: 6, relaxation_length_m: 0.5,
                )],
            ),"#;
const STEERING: &str = r#"steering: (mode: Front, limit_rad: "35 deg", rate_rad_s: 0.5, look_ahead_m: 5),"#;
const TOWING: &str = r#"air: (density_kg_m3: 1.2),
    tasks: {"trailer": Trailer(
        carriage: (mass_kg: 2000, carried_share: 0.1, rolling_coefficient: 0.03, drag_area_m2: 0),
        capacity_kg: 6000, initial_kg: 5000, fill_rate_kg_s: 50, empty_rate_kg_s: 300, tipping_power_w: 0,
    )},"#;

#[test]
fn a_trailer_is_read_with_its_axles_and_drives_in_both_fidelities() {
    let text = GOOD.replace(STEERING, TRAILER).replace("air: (density_kg_m3: 1.2),", TOWING);
    let registry = headland_stock::registry();
    let way = |text: &str| {
        let scenario = of(text);
        let model = scenario.model(&registry).unwrap();
        let outcome = scenario.fidelity.simulate(&model, scenario.cycle.as_ref().unwrap()).unwrap();
        assert_eq!(outcome.end, headland_sim::End::Finished);
        *outcome.trace.get("position_m").unwrap().last().unwrap()
    };
    let (three, one) = (way(&text), way(&text.replace("RigidBody(record_s: \"50 ms\")", "Longitudinal")));
    // A high trailer leans on its hitch as it slows down, and its wheels turn: neither is known in one dimension.
    assert!((three / one - 1.0).abs() < 0.015, "{three} {one}");
}

#[test]
fn a_trailer_that_cannot_be_is_refused_where_it_stands() {
    let bare = GOOD.replace(STEERING, TRAILER);
    let told = |text: &str| {
        Scenario::of_text("test.ron", text, Path::new(""), &headland_stock::registry()).unwrap_err().told()
    };
    assert!(
        told(&bare).contains("no task tows one") && told(&bare).contains("trailer: ("),
        "{}",
        told(&bare)
    );
    let towing = bare.replace("air: (density_kg_m3: 1.2),", TOWING);
    for (from, to, expected) in [
        ("yaw_radius_m: 1.7", "yaw_radius_m: 0", "yaw_radius_m"),
        (
            "position_m: -4.5, track_m: 1.9, wheels: 2",
            "position_m: -4.5, track_m: 1.9, wheels: 3",
            "as many left as right",
        ),
        ("position_m: -4.5", "position_m: 4.5", "position_m"),
        ("inflation_pa: \"2 bar\"", "inflation_pa: -1", "inflation_pa"),
    ] {
        assert!(towing.contains(from), "{from}");
        let told = told(&towing.replace(from, to));
        assert!(told.contains(expected), "{told}");
    }
}

/// A drive at corners of a second: asked once a step it takes what it takes asked often, within what a step of a second leaves.
#[test]
fn a_quasistatic_run_takes_as_much_as_one_in_fine_steps() {
    let text = |fidelity: &str, step_s: &str| {
        format!(
            "(about: \"town\", vehicle: include(\"vehicles/bmw_i3.ron\"),
              ground: (terrain: Flat, soil: Constant(coefficient: 0.011)), air: (density_kg_m3: 1.2),
              cycle: [Follow(times_s: [0, 1, 2, 3, 4, 5, 6, 9, 10, 11, 12], speeds_m_s: [0, 1.5, 3.5, 5, 6, 7, 7, 7, 5, 2, 0])],
              simulation: (fidelity: {fidelity}, step_s: {step_s}))"
        )
    };
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios"));
    let of = |text: &str| Scenario::of_text("test.ron", text, folder, &headland_stock::registry());
    let registry = headland_stock::registry();
    let simulated = |fidelity: &str, step_s: &str| {
        let scenario = of(&text(fidelity, step_s)).unwrap();
        let model = scenario.model(&registry).unwrap();
        scenario.fidelity.simulate(&model, scenario.cycle.as_ref().unwrap()).unwrap()
    };
    let fine = simulated("Longitudinal", "0.01");
    let quick = simulated("QuasiStatic(record_s: \"1 s\")", "1");
    let fidelity = of(&text("QuasiStatic(record_s: 1)", "1")).unwrap().fidelity;
    assert_eq!((quick.steps, fidelity), (12, Fidelity::QuasiStatic { record_s: 1.0 }));
    assert!(
        (quick.ledger.source_j / fine.ledger.source_j - 1.0).abs() < 0.02,
        "{:?} {:?}",
        quick.ledger,
        fine.ledger
    );
    let refused = text("QuasiStatic(record_s: 0)", "1");
    assert!(of(&refused).unwrap_err().told().contains("record_s"));
}
