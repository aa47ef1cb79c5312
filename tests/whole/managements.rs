//! Managements measured against the optimum that knows the whole course; `docs/evidence/hybrids.md` has the table.

use crate::evidence;
use crate::root;
use headland_management::{Demanded, Fineness};
use headland_plugin::Demand;
use headland_scenario::{RunSpec, Scenario};
use headland_sim::simulate;
use std::fmt::Write as _;

/// A step of the course, short enough for a management to follow the load [s].
const STEP_S: f64 = 1.0;

/// Stop and go of a loader tractor with a pull and a load at the power take-off that come and go.
fn demands() -> Vec<Demand> {
    let text = "(about: \"stop and go\", vehicle: include(\"vehicles/xerion_3800_cvt.ron\"),
         ground: (terrain: Flat, soil: Constant(coefficient: 0.06)), air: (density_kg_m3: 1.2),
         tasks: [Drawbar(force_n: 3000)],
         cycle: [
             Follow(times_s: [0, 6, 20, 22, 30, 40, 55, 58, 70], speeds_m_s: [0, 4, 4, 0, 0, 6, 6, 0, 0]),
             Follow(times_s: [0, 6, 20, 22, 30, 40, 55, 58, 70], speeds_m_s: [0, 3, 3, 0, 0, 7, 7, 0, 0]),
         ],
         simulation: (fidelity: Longitudinal, step_s: 0.1))";
    let registry = headland_stock::registry();
    let scenario = Scenario::of_text("course.ron", text, &root().join("scenarios"), &registry).unwrap();
    let outcome = simulate(&scenario.model(&registry).unwrap(), scenario.cycle.as_ref().unwrap()).unwrap();
    let asked = headland_sim::demands(&outcome.trace, STEP_S);
    // What the brakes took a hybrid may recover, and a load at the power take-off comes and goes.
    let pto = |step: usize| if step % 40 < 12 { 60e3 } else { 5e3 };
    asked
        .into_iter()
        .enumerate()
        .map(|(step, demand)| Demand { shaft_power_w: pto(step), ..demand })
        .collect()
}

/// Every management is driven over the same course as an optimum that ends at the charge that it ended at: none is better
/// than the optimum, and those that weigh what it costs come nearer than those that do not.
#[test]
fn no_management_beats_what_knows_the_whole_course_and_equivalent_consumption_comes_near() {
    let registry = headland_stock::registry();
    let folder = root().join("scenarios");
    let base = Scenario::read(&folder.join("xerion_parallel.ron"), &registry).unwrap();
    let demands = demands();
    let managements = [
        (
            "Thresholds",
            "Thresholds(start_power_w: 40e3, stop_power_w: 15e3, assist_power_w: 180e3, charge_below: 0.5, \
                        charge_until: 0.6, charging_power_w: 30e3, least_time_s: 5)",
            1.15,
        ),
        (
            "LoadLevelling",
            "LoadLevelling(time_constant_s: 15, target_charge: 0.55, charge_gain_w: 400e3, \
                           initial_power_w: 30e3)",
            1.25,
        ),
        (
            "Ecms",
            "Ecms(equivalence_discharge: 2.6, equivalence_charge: 2.4, target_charge: 0.55, least_time_s: 2)",
            1.06,
        ),
        (
            "AdaptiveEcms",
            "AdaptiveEcms(equivalence: 2.5, proportional_gain: 3, integral_gain_per_s: 0.002, \
                          target_charge: 0.55, least_time_s: 2)",
            1.06,
        ),
    ];
    let mut table =
        String::from("| management | fuel MJ | least MJ | above the least |\n|---|---:|---:|---:|\n");
    for (name, management, most) in managements {
        let with = vec![("vehicle.management".to_owned(), management.to_owned())];
        let scenario = base.run(&RunSpec { id: name.to_owned(), with }, &registry).unwrap();
        let model = scenario.model(&registry).unwrap();
        let demanded = Demanded::new(&*model.driveline, &demands, STEP_S).unwrap();
        let (fuel_j, short_j) = (demanded.managed.fuel_j, demanded.managed.short_j);
        let charge = *demanded.managed.charges.last().unwrap();
        let least = demanded.least(Fineness { charges: 641, levels: 40 }).unwrap();
        let ratio = fuel_j / least.fuel_j;
        let (fuel_mj, least_mj) = (fuel_j / 1e6, least.fuel_j / 1e6);
        let above = 100.0 * (ratio - 1.0);
        let _ = writeln!(table, "| `{name}` | {fuel_mj:.1} | {least_mj:.1} | {above:+.1} % |");
        assert!(short_j < 0.002 * fuel_j, "{name} leaves {short_j} J");
        assert!(least.charges.last().unwrap() - charge > -2e-4, "{name}: {:?}", least.charges.last());
        // The optimum is one of a grid: a thousandth is what that costs it.
        assert!(ratio > 0.999 && ratio < most, "{name}: {ratio} of the least\n{table}");
    }
    evidence::holds("hybrids.md", "managements", &table);
}
