//! Days of work: what was gathered is somewhere, what was driven over was worked, and a test bench gives what it asks.

use crate::root;
use headland_batch::{Comparison, Plan, Row};
use headland_scenario::Scenario;
use headland_sim::{End, Outcome, simulate};

fn driven(name: &str, changes: &[(&str, f64)]) -> Outcome {
    let registry = headland_stock::registry();
    let scenario = Scenario::read(&root().join(format!("scenarios/{name}.ron")), &registry).unwrap();
    let scenario = scenario.with(changes, &registry).unwrap();
    let outcome = simulate(&scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap()).unwrap();
    assert_eq!(outcome.end, End::Finished, "{name}");
    outcome
}

fn gain(outcome: &Outcome, channel: &str) -> f64 {
    let values = outcome.trace.get(channel).unwrap_or_else(|| panic!("no `{channel}`"));
    values.last().unwrap() - values.first().unwrap()
}

fn lasted_s(outcome: &Outcome, name: &str) -> f64 {
    let phases = outcome.phases.iter().filter(|phase| phase.name.as_deref() == Some(name));
    phases.map(|phase| phase.to_s - phase.from_s).sum()
}

/// What the crop gave is in the wagon or was emptied out of it at 90 kg/s; on each square metre stood 1.5 kg.
#[test]
fn nothing_of_the_harvest_is_lost() {
    let day = driven("harvesting", &[]);
    let gathered = gain(&day, "wagon_gathered_kg");
    let emptied = 90.0 * lasted_s(&day, "emptying");
    assert!(emptied > 5000.0, "{emptied}");
    assert!((gathered / (gain(&day, "wagon_payload_kg") + emptied) - 1.0).abs() < 1e-9);
    assert!((gathered / (1.5 * gain(&day, "wagon_area_m2")) - 1.0).abs() < 1e-9);
    assert!(day.ledger.sinks.iter().any(|entry| entry.name == "mass change"));
}

/// Filled at 120 kg/s, spread at 2.5 kg/m².
#[test]
fn what_was_spread_was_filled_before() {
    let day = driven("spreading", &[]);
    let filled = 120.0 * (lasted_s(&day, "filling") + lasted_s(&day, "filling again"));
    let spread = 2.5 * gain(&day, "spreader_area_m2");
    assert!((filled / (spread + gain(&day, "spreader_payload_kg")) - 1.0).abs() < 1e-9, "{filled} {spread}");
}

/// Four lanes of 150 m with 3 m of plough. It is lowered behind the beginning of a lane and lifted behind its end, and the
/// last lane has no end.
#[test]
fn the_area_ploughed_is_that_of_the_lanes_and_half_the_step_finds_the_same_field() {
    let (day, finer) = (driven("ploughing", &[]), driven("ploughing", &[("simulation.step_s", 0.01)]));
    let area = gain(&day, "plough_area_m2");
    assert!((area / 1800.0 - 1.0).abs() < 0.02, "{area}");
    assert!((gain(&finer, "plough_area_m2") / area - 1.0).abs() < 1e-4);
    assert!((finer.ledger.source_j / day.ledger.source_j - 1.0).abs() < 1e-4);
    let other = driven("ploughing", &[("cycle.tasks.plough.fluctuation.seed", 2.0)]);
    assert!((other.ledger.source_j / day.ledger.source_j - 1.0).abs() > 1e-4);
}

/// Full load at 2100 rpm by hand: 1110 N m · 219.911 rad/s = 244.10 kW, friction 1.9e5 Pa · 8.8e-3 m³ · ω / 4π = 29.26 kW,
/// (244.10 + 29.26) / 0.448 = 610.2 kW of fuel, 14.263 g/s, 210.4 g/kWh.
#[test]
fn the_first_mode_of_the_brake_is_full_load_at_rated_speed() {
    let bench = driven("iso_8178_c1", &[]);
    let first = |channel: &str| bench.trace.get(channel).unwrap()[10];
    assert!((first("engine_speed_rad_s") - 219.911_486).abs() < 1e-6);
    assert!((first("engine_torque_n_m") - 1110.0).abs() < 1e-6);
    assert!((first("fuel_rate_kg_s") / 14.263e-3 - 1.0).abs() < 1e-4, "{}", first("fuel_rate_kg_s"));
    assert_eq!(bench.phases.len(), 8);
}

/// The spells and ramps of 40 CFR 1039 last 1800 s; on the ramp from idle to the intermediate speed, half of the way is
/// 1100 rpm and 785 N m.
#[test]
fn the_ramped_cycle_goes_straight_from_mode_to_mode() {
    let bench = driven("iso_8178_ramped", &[]);
    assert!((bench.trace.duration_s() - 1800.0).abs() < 1e-9);
    let at = bench.trace.time_s().partition_point(|time| *time < 136.0 - 1e-9);
    let value = |channel: &str| bench.trace.get(channel).unwrap()[at];
    assert!((value("engine_speed_rad_s") - 1100.0 * std::f64::consts::PI / 30.0).abs() < 1e-9);
    assert!((value("engine_torque_n_m") - 785.0).abs() < 1e-6, "{}", value("engine_torque_n_m"));
}

/// A buckets' worth is lifted, dumped and gone five times; a trailer comes empty home.
#[test]
fn the_loader_and_the_trailer_end_empty() {
    assert!(gain(&driven("loader", &[]), "loader_payload_kg").abs() < 1e-6);
    assert!((gain(&driven("transport", &[]), "trailer_payload_kg") + 14_000.0).abs() < 1e-6);
}

fn row(comparison: &str, cycle: &str) -> Row {
    let registry = headland_stock::registry();
    let path = root().join(format!("scenarios/comparisons/{comparison}.ron"));
    let plan = Plan::new(Comparison::read(&path).unwrap(), &registry, 1).unwrap();
    let number = (0..plan.total())
        .find(|number| plan.comparison.cycles[plan.spec(*number).cycle].name == cycle)
        .unwrap_or_else(|| panic!("no cycle `{cycle}` in {comparison}"));
    headland_batch::run(&plan, &registry, number).0
}

/// By hand, with w the weights of ISO 8178-4, T and n those of the modes, and 133.05 N m of friction (1.9e5 Pa · 8.8e-3 m³ / 4π):
/// Σ w (T + 133.05) ω / (0.448 · 42.78e6 J/kg) = 8.3604 g/s, Σ w T ω = 136.61 kW: 10.033 kg in 20 minutes, 220.3 g/kWh.
#[test]
fn the_modes_of_the_brake_weigh_what_their_times_are() {
    let bench = row("iso_8178", "C1, weighted");
    let (fuel_kg, work_j) = (bench.value("fuel_kg"), bench.value("engine_work_j"));
    assert!((fuel_kg / 10.0325 - 1.0).abs() < 2e-4, "{fuel_kg}");
    assert!((3.6e9 * fuel_kg / work_j / 220.31 - 1.0).abs() < 2e-4, "{}", 3.6e9 * fuel_kg / work_j);
    let told = std::fs::read_to_string(root().join("docs/working_day.md")).unwrap();
    assert!(told.contains("10.03 kg") && told.contains("220.3 g/kWh"));
    let ramped = row("iso_8178", "C1, ramped");
    let (fuel_kg, work_j) = (ramped.value("fuel_kg"), ramped.value("engine_work_j"));
    let (kg, g_kwh) = (format!("{fuel_kg:.2} kg"), format!("{:.1} g/kWh", 3.6e9 * fuel_kg / work_j));
    assert!(told.contains(&kg) && told.contains(&g_kwh), "{kg} {g_kwh}");
}

/// Runs of a scenario have no table of g/kWh, so its cycles stand in a comparison too, and are the same ones.
#[test]
fn the_comparison_after_powermix_drives_what_its_scenario_drives() {
    let registry = headland_stock::registry();
    let whole = Scenario::read(&root().join("scenarios/powermix.ron"), &registry).unwrap();
    assert_eq!(whole.runs.len(), 14);
    for run in &whole.runs {
        let scenario = whole.run(run, &registry).unwrap();
        let outcome =
            simulate(&scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap()).unwrap();
        let compared = row("powermix", &run.id).value("energy_from_fuel_j");
        assert!((compared / outcome.ledger.source_j - 1.0).abs() < 1e-9, "{}: {compared}", run.id);
    }
}
