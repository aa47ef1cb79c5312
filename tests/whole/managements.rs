//! Managements measured against the optimum that knows the whole course; `docs/evidence/hybrids.md` has the table.

use crate::evidence;
use crate::root;
use headland_management::{Course, Grid, optimum};
use headland_plugin::{Consequence, Demand, Driveline, Share};
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
    let (speed, force) =
        (outcome.trace.get("speed_m_s").unwrap(), outcome.trace.get("tractive_force_n").unwrap());
    let brakes = outcome.trace.get("brake_force_n").unwrap();
    let stride = 10;
    (0..speed.len() / stride)
        .map(|step| {
            let at = step * stride + stride / 2;
            let pto = if step % 40 < 12 { 60e3 } else { 5e3 };
            Demand {
                speed_m_s: speed[at],
                // What the brakes took a hybrid may recover.
                force_n: force[at] - brakes[at],
                shaft_power_w: pto,
                ..Demand::default()
            }
        })
        .collect()
}

/// The hybrid on the course, its charge apart from its other states.
struct Driven<'a> {
    hybrid: &'a dyn Driveline,
    demands: &'a [Demand],
    states: Vec<Vec<f64>>,
    charge: usize,
}

impl<'a> Driven<'a> {
    fn new(hybrid: &'a dyn Driveline, demands: &'a [Demand]) -> Self {
        let names: Vec<_> = hybrid.states().iter().map(|state| state.name).collect();
        let index = |name: &str| names.iter().position(|found| *found == name).unwrap();
        let mut states: Vec<f64> = hybrid.states().iter().map(|state| state.initial).collect();
        states[index("boost")] = 1.0;
        // The range of every step, as the transmission itself chooses it.
        let states = demands
            .iter()
            .map(|demand| {
                states[index("since_range_s")] = 1.0;
                hybrid.decide(demand, &mut states);
                states.clone()
            })
            .collect();
        Self { hybrid, demands, states, charge: index("state_of_charge") }
    }

    /// Drives the course with the management of the hybrid; fuel [J], charge at the end, energy that was missed [J].
    fn managed(&self) -> (f64, f64, f64) {
        let states = self.hybrid.states();
        let mut memory: Vec<f64> = states.iter().map(|state| state.initial).collect();
        let index = |name: &str| states.iter().position(|state| state.name == name).unwrap();
        let (runs, set, since) = (index("engine_runs"), index("engine_set_power_w"), index("since_range_s"));
        let (mut fuel_j, mut short_j) = (0.0, 0.0);
        for (demand, given) in self.demands.iter().zip(&self.states) {
            // The range is that of the course; the transmission has just changed and stays in it.
            memory[..since]
                .iter_mut()
                .zip(given)
                .skip(index("motor_temperature_c"))
                .for_each(|(to, from)| *to = *from);
            memory[index("boost")] = 1.0;
            memory[since] = 0.0;
            self.hybrid.decide(demand, &mut memory);
            let share = Share { engine_runs: memory[runs] > 0.5, engine_w: memory[set] };
            let consequence = self.hybrid.weigh(demand, &memory, share).unwrap();
            let mut rates = vec![0.0; memory.len()];
            self.hybrid.deliver(demand, &memory, &mut rates);
            for (value, rate) in memory.iter_mut().zip(&rates) {
                *value += STEP_S * rate;
            }
            fuel_j += STEP_S * consequence.fuel_w;
            short_j += STEP_S * consequence.short_w;
        }
        (fuel_j, memory[self.charge], short_j)
    }
}

impl Course for Driven<'_> {
    fn steps(&self) -> usize {
        self.demands.len()
    }

    fn step_s(&self) -> f64 {
        STEP_S
    }

    fn most_engine_w(&self, _: usize) -> f64 {
        240e3
    }

    fn power_w(&self, step: usize) -> f64 {
        let Demand { force_n, speed_m_s, shaft_power_w, .. } = self.demands[step];
        force_n * speed_m_s / 0.85 + shaft_power_w
    }

    fn weigh(&self, step: usize, charge: f64, share: Share) -> Consequence {
        let mut states = self.states[step].clone();
        states[self.charge] = charge;
        self.hybrid.weigh(&self.demands[step], &states, share).unwrap()
    }
}

/// Charge energy of 25 Ah at some 725 V.
const FULL_CHARGE_J: f64 = 25.0 * 3600.0 * 725.0;

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
        let driven = Driven::new(&*model.driveline, &demands);
        let (fuel_j, charge, short_j) = driven.managed();
        // The end is a point of the grid, so that the step of the cost there is met.
        let window = (charge - 0.08, charge + 0.08);
        let grid = Grid { window, charges: 81, levels: 40, full_charge_j: FULL_CHARGE_J };
        let least = optimum(&driven, 0.55, charge, grid).unwrap();
        let ratio = fuel_j / least.fuel_j;
        let (fuel_mj, least_mj) = (fuel_j / 1e6, least.fuel_j / 1e6);
        let above = 100.0 * (ratio - 1.0);
        let _ = writeln!(table, "| `{name}` | {fuel_mj:.1} | {least_mj:.1} | {above:+.1} % |");
        assert!(short_j < 0.002 * fuel_j, "{name} leaves {short_j} J");
        assert!(least.charges.last().unwrap() - charge > -2e-4, "{name}: {:?}", least.charges.last());
        // The optimum is one of a grid: half a percent is what that costs it.
        assert!(ratio > 0.995 && ratio < most, "{name}: {ratio} of the least\n{table}");
    }
    evidence::holds("hybrids.md", "managements", &table);
}
