//! Vehicles on wheels, from scenario to ledger.

use crate::root;
use headland_scenario::Scenario;
use headland_sim::{End, Outcome, simulate};

fn outcomes(scenario: &Scenario) -> Vec<(String, Outcome)> {
    let registry = headland_stock::registry();
    let outcome = |scenario: &Scenario| {
        let outcome =
            simulate(&scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap()).unwrap();
        assert_eq!(outcome.end, End::Finished);
        outcome
    };
    if scenario.runs.is_empty() {
        return vec![(String::new(), outcome(scenario))];
    }
    let runs = scenario.runs.iter();
    runs.map(|run| (run.id.clone(), outcome(&scenario.run(run, &registry).unwrap()))).collect()
}

fn account(outcome: &Outcome, name: &str) -> f64 {
    outcome.ledger.sinks.iter().find(|entry| entry.name == name).unwrap().energy_j
}

/// What the drawbar gets of what the driven wheels are given.
fn efficiency(outcome: &Outcome) -> f64 {
    let [pull, soil, slip] = ["drawbar", "soil", "slip"].map(|name| account(outcome, name));
    pull / (pull + soil + slip)
}

#[test]
fn firmer_ground_gives_more_of_the_power_to_the_pull_with_less_slip() {
    let registry = headland_stock::registry();
    let scenario = Scenario::read(&root().join("scenarios/pull_test.ron"), &registry).unwrap();
    let outcomes = outcomes(&scenario);
    let of = |id: &str| &outcomes.iter().find(|(name, _)| name == id).unwrap().1;
    for pull in ["20", "40", "60"] {
        let [soft, tilled, firm] = ["soft", "tilled", "firm"].map(|soil| of(&format!("{soil}-{pull}")));
        assert!(efficiency(soft) < efficiency(tilled) && efficiency(tilled) < efficiency(firm), "{pull}");
        assert!(account(soft, "slip") > account(firm, "slip"), "{pull}");
    }
    for soil in ["soft", "tilled", "firm"] {
        let slip = ["20", "40", "60"].map(|pull| account(of(&format!("{soil}-{pull}")), "slip"));
        assert!(slip.is_sorted() && slip[2] > 4.0 * slip[0], "{soil}: {slip:?}");
    }
    // A light pull wastes on rolling, a heavy one on slip: the best lies between.
    let soft = ["20", "40", "60"].map(|pull| efficiency(of(&format!("soft-{pull}"))));
    assert!(soft[1] > soft[0], "{soft:?}");
}

/// A lane along a side slope of 25 %, a turn downhill and a lane back, where side forces of slope and turn add up or not: the law of
/// one dimension takes what the tyres of the rigid body lose as they slip aside, which on the slope have softened by 7 %.
#[test]
fn a_side_slope_and_the_turn_on_it_cost_one_dimension_what_they_cost_the_rigid_body() {
    let registry = headland_stock::registry();
    let drive = |name: &str| {
        let scenario = Scenario::read(&root().join("scenarios").join(name), &registry).unwrap();
        let model = scenario.model(&registry).unwrap();
        let outcome = scenario.fidelity.simulate(&model, scenario.cycle.as_ref().unwrap()).unwrap();
        assert_eq!(outcome.end, End::Finished);
        outcome
    };
    let (flat, rigid) = (drive("side_slope.ron"), drive("side_slope_rigid.ron"));
    let said = account(&flat, "cornering_drag") + account(&flat, "side_slope");
    let lost = account(&rigid, "side slip");
    assert!((said / lost - 1.0).abs() < 0.07, "{said} J, {lost} J");
    let [said, lost] = [&flat, &rigid].map(|outcome| account(outcome, "slip"));
    assert!((said / lost - 1.0).abs() < 0.2, "{said} J, {lost} J");
}

/// The coefficient of the coast-down study, 0.06906 with four equal loads, and the soil of 955 kPa that it stands for. What
/// the loads move to and fro is of second order: a thousandth of the way.
#[test]
fn a_coast_down_on_wheels_goes_as_far_as_with_the_coefficient_of_the_whole_vehicle() {
    let text = |soil: &str| {
        format!(
            r#"(
            about: "coast-down",
            vehicle: include("vehicles/xerion_3800_axles.ron"),
            gravity_m_s2: 9.81,
            ground: (terrain: Flat, soil: {soil}),
            air: (density_kg_m3: 1.24),
            start: (position_m: 0, speed_m_s: "30 km/h"),
            cycle: [Coast(until: Stopped)],
            simulation: (fidelity: Longitudinal, step_s: 0.05),
        )"#
        )
    };
    let way = |soil: &str| {
        let registry = headland_stock::registry();
        let scenario =
            Scenario::of_text("test.ron", &text(soil), &root().join("scenarios"), &registry).unwrap();
        let (_, outcome) = outcomes(&scenario).remove(0);
        *outcome.trace.get("position_m").unwrap().last().unwrap()
    };
    let wheels = way(r#"Brixius(cone_index_pa: "955 kPa", construction: Bias, pass_factor: 1)"#);
    let whole = way("Constant(coefficient: 0.06906)");
    assert!((wheels / whole - 1.0).abs() < 1e-3, "{wheels} {whole}");
}

/// Slip past the limit is told with time, place and reason.
#[test]
fn a_pull_beyond_the_ground_stops_the_run() {
    let registry = headland_stock::registry();
    let path = root().join("scenarios/pull_test.ron");
    let scenario = Scenario::read(&path, &registry).unwrap();
    let changes =
        [("tasks.Drawbar.force_n", 95e3), ("ground.soil.cone_index_pa", 450e3), ("start.speed_m_s", 0.6)];
    let heavy = scenario.with(&changes, &registry).unwrap();
    let outcome = simulate(&heavy.model(&registry).unwrap(), heavy.cycle.as_ref().unwrap()).unwrap();
    let End::Stopped { time_s, reason, .. } = outcome.end else { panic!("it went on") };
    assert!(time_s == 0.0 && reason.starts_with("slip past the limit"), "{reason}");
}
