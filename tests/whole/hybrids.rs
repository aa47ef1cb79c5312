//! Hybrids held to what physics allows them; `docs/evidence/hybrids.md` tells how much fuel they take.

use crate::evidence;
use crate::root;
use headland_scenario::{RunSpec, Scenario};
use headland_sim::{End, Outcome, simulate};
use std::fmt::Write as _;
use std::path::Path;

const LEVELLING: &str =
    "LoadLevelling(time_constant_s: 8, target_charge: 0.55, charge_gain_w: 400e3, initial_power_w: 150e3)";

/// The engine runs throughout; its store assists from so far on that it is left alone at nine tenths.
const THRESHOLDS: &str = "Thresholds(start_power_w: 60e3, stop_power_w: 20e3, assist_power_w: 254e3, charge_below: 0.4, \
                          charge_until: 0.6, charging_power_w: 20e3, least_time_s: 20)";

const ECMS: &str =
    "Ecms(equivalence_discharge: 2.9, equivalence_charge: 2.6, target_charge: 0.55, least_time_s: 10)";

const ADAPTIVE: &str = "AdaptiveEcms(equivalence: 2.55, proportional_gain: 30, integral_gain_per_s: 0.002, \
                        target_charge: 0.55, least_time_s: 10)";

/// A vehicle of the project at a steady speed with a steady pull.
fn steady(vehicle: &str, speed_km_h: f64, pull_n: f64, with: &[(&str, String)]) -> Outcome {
    steady_for(120.0, vehicle, speed_km_h, pull_n, with)
}

/// The same for so many seconds.
fn steady_for(time_s: f64, vehicle: &str, speed_km_h: f64, pull_n: f64, with: &[(&str, String)]) -> Outcome {
    let text = format!(
        "(about: \"steady\", vehicle: include(\"vehicles/{vehicle}.ron\"),
          ground: (terrain: Flat, soil: Constant(coefficient: 0.06)), air: (density_kg_m3: 1.2),
          start: (position_m: 0, speed_m_s: \"{speed_km_h} km/h\"), tasks: [Drawbar(force_n: {pull_n})],
          cycle: [Hold(for_s: {time_s})], simulation: (fidelity: Longitudinal, step_s: 0.1))"
    );
    run(&text, with)
}

fn run(text: &str, with: &[(&str, String)]) -> Outcome {
    let registry = headland_stock::registry();
    let folder = root().join("scenarios");
    let scenario = Scenario::of_text("steady.ron", text, &folder, &registry)
        .unwrap_or_else(|error| panic!("{}", error.told()));
    let with = with.iter().map(|(path, ron)| ((*path).to_owned(), ron.clone())).collect();
    let scenario = scenario.run(&RunSpec { id: "it".to_owned(), with }, &registry).unwrap();
    simulate(&scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap()).unwrap()
}

/// The same mass for all, so that only the drive differs.
fn alike() -> (&'static str, String) {
    ("vehicle.mass_kg", "13020".to_owned())
}

fn gained_j(outcome: &Outcome) -> f64 {
    let charge = outcome.ledger.sinks.iter().find(|entry| entry.name.ends_with("charge"));
    charge.map_or(0.0, |entry| entry.energy_j)
}

/// Fuel energy that a joule of the store stands for: between what an engine at its best needs to store one (2.6) and what
/// one saves that is drawn. A wrong factor matters less the less charge changes; the tests hold that to be little.
const EQUIVALENT: f64 = 2.7;

/// Fuel as if the charge had stayed.
fn corrected_j(outcome: &Outcome) -> f64 {
    outcome.ledger.source_j - EQUIVALENT * gained_j(outcome)
}

fn mean(outcome: &Outcome, channel: &str) -> f64 {
    let values = outcome.trace.get(channel).unwrap();
    values.iter().sum::<f64>() / values.len() as f64
}

/// So long that what a battery of 18 kWh gives or takes is little of the fuel, and the windings of a series hybrid do not derate yet.
const LONG_S: f64 = 300.0;

/// 62 kN at 10 km/h load the engine of the transmission's tractor to about nine tenths.
#[test]
fn no_hybrid_saves_more_than_a_twentieth_at_nine_tenths_of_the_load() {
    let mechanical = steady_for(LONG_S, "xerion_3800_cvt", 10.0, 62e3, &[alike()]);
    let power = mean(&mechanical, "engine_speed_rad_s") * mean(&mechanical, "engine_torque_n_m");
    assert!((0.87..0.93).contains(&(power / 254e3)), "{power}");
    let mut table = String::from(
        "| hybrid | management | fuel of the CVT | charge, of the fuel |\n|---|---|---:|---:|\n",
    );
    let hybrids = [("parallel", 0.55), ("series", 0.55), ("power_split", 0.8)];
    let all = hybrids.into_iter().flat_map(|(name, charge)| {
        [THRESHOLDS, LEVELLING, ECMS, ADAPTIVE].map(|management| {
            let charge = format!("target_charge: {charge}");
            (format!("xerion_3800_{name}"), management.replace("target_charge: 0.55", &charge))
        })
    });
    for (vehicle, management) in all {
        let vehicle = vehicle.as_str();
        let hybrid =
            steady_for(LONG_S, vehicle, 10.0, 62e3, &[alike(), ("vehicle.management", management.clone())]);
        assert_eq!(hybrid.end, End::Finished, "{vehicle}");
        let apart = hybrid.trace.get("speed_m_s").unwrap().last().unwrap() * 3.6 - 10.0;
        assert!(apart.abs() < 0.01, "{vehicle} falls behind by {apart} km/h");
        let share = corrected_j(&hybrid) / mechanical.ledger.source_j;
        let (name, named) =
            (vehicle.trim_start_matches("xerion_3800_"), management.split('(').next().unwrap());
        let charged = 100.0 * gained_j(&hybrid) / hybrid.ledger.source_j;
        let _ = writeln!(
            table,
            "| {} | `{named}` | {:.1} % | {charged:+.1} % |",
            name.replace('_', " "),
            100.0 * share
        );
        assert!((0.95..1.2).contains(&share), "{vehicle}: {share} of the fuel of the transmission");
        // A factor that is wrong by a tenth is then wrong by two and a half hundredths of the fuel at most.
        assert!(gained_j(&hybrid).abs() < 0.09 * hybrid.ledger.source_j, "{vehicle}: {}", gained_j(&hybrid));
    }
    evidence::holds("hybrids.md", "nine-tenths", &table);
}

/// Between the wheels and the engine there are two machines in a series hybrid, and gears in the other.
#[test]
fn series_loses_to_mechanical_at_every_steady_load() {
    let mut table = String::from("| km/h | pull kN | fuel of the CVT |\n|---:|---:|---:|\n");
    for (speed_km_h, pull_n) in [(8.0, 20e3), (10.0, 35e3), (10.0, 62e3), (20.0, 15e3)] {
        let mechanical = steady("xerion_3800_cvt", speed_km_h, pull_n, &[alike()]);
        let with = [alike(), ("vehicle.management", LEVELLING.to_owned())];
        let series = steady("xerion_3800_series", speed_km_h, pull_n, &with);
        let share = corrected_j(&series) / mechanical.ledger.source_j;
        let _ = writeln!(table, "| {speed_km_h} | {} | {:.1} % |", pull_n / 1e3, 100.0 * share);
        assert!(share > 1.0, "{speed_km_h} km/h, {pull_n} N: {share}");
    }
    evidence::holds("hybrids.md", "series", &table);
}

/// What flows out of a battery is what its charge falls by, and the ledger's account is the energy of that charge.
#[test]
fn state_of_charge_closes() {
    for (vehicle, capacity_a_h) in
        [("xerion_3800_parallel", 25.0), ("xerion_3800_series", 80.0), ("xerion_3800_electric", 400.0)]
    {
        let levelling = ("vehicle.management", LEVELLING.to_owned());
        let with: &[_] = if vehicle.ends_with("electric") { &[] } else { &[levelling] };
        let outcome = steady(vehicle, 8.0, 20e3, with);
        let trace = &outcome.trace;
        let (time, charge) = (trace.time_s(), trace.get("state_of_charge").unwrap());
        let current = trace.get("battery_current_a").unwrap();
        // The current steps where a management decides, and is held between two steps: the left end holds for the step.
        let drawn: f64 =
            time.windows(2).zip(current).map(|(pair, current)| (pair[1] - pair[0]) * current).sum();
        let fell = (charge[0] - charge[charge.len() - 1]) * 3600.0 * capacity_a_h;
        assert!(fell.abs() > 100.0, "{vehicle}: {fell} A s");
        assert!((drawn - fell).abs() < 2e-3 * fell.abs() + 20.0, "{vehicle}: {drawn} {fell}");
        // 715 to 759 V and what is between them.
        let gained =
            if vehicle.ends_with("electric") { -outcome.ledger.source_j } else { gained_j(&outcome) };
        let volts = -gained / fell;
        assert!((715.0..759.0).contains(&volts), "{vehicle}: {volts} V");
        assert!(outcome.ledger.relative_residual() < 1e-9, "{vehicle}: {:?}", outcome.ledger);
    }
}

/// The same of a supercapacitor of 16 F and 750 V: I = −C dU/dt, and half of C U² is its energy.
#[test]
fn the_charge_of_a_supercapacitor_closes() {
    const CAPACITANCE_F: f64 = 16.0;
    const MOST_V: f64 = 750.0;
    let levelling = LEVELLING.replace("target_charge: 0.55", "target_charge: 0.7");
    let outcome = steady("xerion_3800_power_split", 8.0, 20e3, &[("vehicle.management", levelling)]);
    let trace = &outcome.trace;
    let (time, charge) = (trace.time_s(), trace.get("state_of_charge").unwrap());
    let current = trace.get("battery_current_a").unwrap();
    let drawn: f64 = time.windows(2).zip(current).map(|(pair, current)| (pair[1] - pair[0]) * current).sum();
    let (first, last) = (charge[0] * MOST_V, charge[charge.len() - 1] * MOST_V);
    assert!((first - last).abs() > 20.0, "{first} {last}");
    assert!((drawn / (CAPACITANCE_F * (first - last)) - 1.0).abs() < 5e-3, "{drawn} {first} {last}");
    let energy = 0.5 * CAPACITANCE_F * (last * last - first * first);
    assert!((gained_j(&outcome) / energy - 1.0).abs() < 1e-3, "{} {energy}", gained_j(&outcome));
    assert!(outcome.ledger.relative_residual() < 1e-9, "{:?}", outcome.ledger);
}

#[test]
fn an_empty_battery_ends_the_run_with_time_place_and_reason() {
    let nearly = ("vehicle.driveline.battery.initial_charge", "0.105".to_owned());
    let small = ("vehicle.driveline.battery.capacity_a_h", "40".to_owned());
    let outcome = steady("xerion_3800_electric", 8.0, 20e3, &[nearly, small]);
    let End::Stopped { time_s, position_m, reason } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("battery is empty") && *time_s > 1.0 && *position_m > 2.0, "{time_s} {reason}");
    assert!(outcome.trace.time_s().len() > 10);
}

/// With a start under full load the turbocharger takes a while, and the tractor does not move at once.
#[test]
fn a_drive_that_waits_for_its_boost_is_not_given_up() {
    let text = "(about: \"start\", vehicle: include(\"vehicles/xerion_3800_powershift.ron\"),
          ground: (terrain: Flat, soil: Constant(coefficient: 0.06)), air: (density_kg_m3: 1.2),
          start: (position_m: 0, speed_m_s: 2.2), tasks: [Drawbar(force_n: 62e3)],
          cycle: [Reach(speed_m_s: 2.3, acceleration_m_s2: 0.3), Hold(for_s: 5)],
          simulation: (fidelity: Longitudinal, step_s: 0.02))";
    let outcome = run(text, &[]);
    assert_eq!(outcome.end, End::Finished);
    let acceleration = outcome.trace.get("acceleration_m_s2").unwrap();
    assert!(acceleration[0] < 0.0, "nothing had to be waited for: {}", acceleration[0]);
    let hopeless = text.replace("62e3", "100e3");
    let End::Stopped { time_s, reason, .. } = run(&hopeless, &[]).end else { panic!("it pulled 100 kN") };
    assert!(reason.contains("cannot bring the vehicle") && time_s >= 4.0, "{time_s} {reason}");
}

#[test]
fn off_its_map_a_transmission_is_not_extrapolated() {
    let outcome = steady("xerion_3800_mapped", 10.0, 75e3, &[]);
    let End::Stopped { reason, .. } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("is not extrapolated"), "{reason}");
}

#[test]
fn a_management_belongs_to_two_stores() {
    let registry = headland_stock::registry();
    let told = |text: String| {
        Scenario::of_text("it.ron", &text, &root().join("scenarios"), &registry).unwrap_err().told()
    };
    let scenario = |vehicle: &str| {
        let vehicle = std::fs::read_to_string(root().join("scenarios/vehicles").join(vehicle)).unwrap();
        let vehicle = vehicle.replace("../parts", "parts");
        format!(
            "(about: \"x\", vehicle: {vehicle}, ground: (terrain: Flat, soil: Constant(coefficient: 0.06)),
              air: (density_kg_m3: 1.2), simulation: (fidelity: Longitudinal, step_s: 0.1))"
        )
    };
    let hybrid = scenario("xerion_3800_series.ron");
    let begin = hybrid.find("    management:").unwrap();
    let end = begin + hybrid[begin..].find("    ),\n").unwrap() + 7;
    let without = format!("{}{}", &hybrid[..begin], &hybrid[end..]);
    assert!(told(without).contains("`management`"));
    let cvt = scenario("xerion_3800_cvt.ron");
    let beside = cvt.replacen("    driveline:", &format!("    management: {LEVELLING},\n    driveline:"), 1);
    assert!(told(beside).contains("no two stores"));
    let wrong = scenario("xerion_3800_parallel.ron").replace("equivalence: 2.55", "equivalence: -1");
    assert!(told(wrong).contains("`equivalence`"));
}

/// A number of a part is held to its bound where it stands, in the file of the part.
#[test]
fn a_part_is_refused_where_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    let copy = |from: &Path, change: (&str, &str)| {
        let text = std::fs::read_to_string(from).unwrap().replace(change.0, change.1);
        std::fs::write(folder.path().join(from.file_name().unwrap()), text).unwrap();
    };
    let scenarios = root().join("scenarios");
    copy(&scenarios.join("parts/engine_254_kw.ron"), ("load_share: 0.9", "load_share: 1.9"));
    copy(&scenarios.join("parts/transmission_50_km_h.ron"), ("", ""));
    copy(&scenarios.join("vehicles/xerion_3800_cvt.ron"), ("../parts/", ""));
    let text = "(about: \"x\", vehicle: include(\"xerion_3800_cvt.ron\"), ground: (terrain: Flat, soil: Constant(coefficient: \
                0.06)), air: (density_kg_m3: 1.2), simulation: (fidelity: Longitudinal, step_s: 0.1))";
    let error = Scenario::of_text("it.ron", text, folder.path(), &headland_stock::registry()).unwrap_err();
    let told = error.told();
    assert!(
        told.contains("load_share") && told.contains("engine_254_kw.ron") && told.contains("1.9"),
        "{told}"
    );
}
