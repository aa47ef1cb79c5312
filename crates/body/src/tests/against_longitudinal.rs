//! Where the physics is the same, both fidelities say the same.

use super::{GRAVITY, Ideal, MASS_KG, chassis, coast_down, cycle, last, model, run, soil, terrain};
use crate::chassis::Differential;
use headland_plugin::{Contact, Footing, Soil, WheelContact};
use headland_sim::{Cycle, End, Model, Named, Outcome, Phase, Until, simulate};
use headland_soil::{Brixius, Constant, LinearSpeedLaw};
use headland_task::Drawbar;
use headland_terrain::{ConstantGrade, Flat};

const STEP_S: f64 = 2e-3;

#[test]
fn a_coast_down_on_level_ground_stops_when_and_where_the_longitudinal_one_does() {
    let model = model(
        terrain::<Flat>("()"),
        soil::<LinearSpeedLaw>("(coefficient: 0.069, speed_scale_m_s: 27.7777777777)"),
    );
    let cycle = cycle(30.0 / 3.6, coast_down(), STEP_S);
    let (one, three) = (simulate(&model, &cycle).unwrap(), run(&model, &cycle));
    assert_eq!(three.end, End::Finished);
    assert!((three.trace.duration_s() / one.trace.duration_s() - 1.0).abs() < 2e-3);
    assert!((last(&three, "position_m") / last(&one, "position_m") - 1.0).abs() < 2e-3);
    assert!(three.ledger.relative_residual() < 1e-3);
}

/// Time, way and ledger of both.
fn alike(model: &Model, cycle: &Cycle) {
    let (one, three) = (simulate(model, cycle).unwrap(), run(model, cycle));
    assert_eq!((&one.end, &three.end), (&End::Finished, &End::Finished));
    let time = three.trace.duration_s() / one.trace.duration_s() - 1.0;
    let way = last(&three, "position_m") / last(&one, "position_m") - 1.0;
    assert!(time.abs() < 2e-3 && way.abs() < 2e-3, "time {time} way {way}");
    assert!(three.ledger.relative_residual() < 1e-3, "{:?}", three.ledger);
}

#[test]
fn a_coast_down_uphill_and_one_downhill_are_the_longitudinal_ones() {
    for grade in [0.05, -0.03] {
        let ground = terrain::<ConstantGrade>(&format!("(grade: {grade}, heading_rad: 0.7)"));
        let model =
            model(ground, soil::<LinearSpeedLaw>("(coefficient: 0.069, speed_scale_m_s: 27.7777777777)"));
        alike(&model, &cycle(30.0 / 3.6, coast_down(), STEP_S));
    }
}

#[test]
fn a_coast_down_against_a_pull_is_the_longitudinal_one() {
    let mut model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.05)"));
    let pull = Box::new(ron::from_str::<Drawbar>("(force_n: 12e3)").unwrap());
    model.tasks.push(Named { name: "Drawbar".to_owned(), plugin: pull });
    alike(&model, &cycle(30.0 / 3.6, coast_down(), STEP_S));
    // 12 kN at a height of 0.7 m take 12 · 0.7 / 3.6 = 2.33 kN from the front axle. What resists takes more: it acts in the
    // hubs, the traction that meets it at the ground. So does the air, in the centre of gravity.
    let mut hauling = model;
    hauling.driveline = Box::new(Ideal);
    let steady = run(&hauling, &cycle(3.0, vec![Phase::Hold { for_s: 8.0 }], STEP_S));
    let taken_n = MASS_KG * GRAVITY * 2.0 / 3.6 - last(&steady, "axle_1_load_n") - rolling_n(&steady);
    assert!((taken_n / (12e3 * 0.7 / 3.6) - 1.0).abs() < 0.01, "{taken_n}");
}

/// What air and soil take from the front axle in addition [N].
fn rolling_n(outcome: &Outcome) -> f64 {
    let hub_m = 0.5 * 2.045 - 0.25 * MASS_KG * GRAVITY * (0.365 + 170.0 / 150.0) / 1e6;
    (last(outcome, "air_resistance_n") * 1.3 + last(outcome, "soil_resistance_n") * hub_m) / 3.6
}

/// On soil that slips both fidelities find the same slip and pull, each by its own way: one solves for the slip at which
/// forces balance, the other turns wheels until they do.
#[test]
fn wheels_that_pull_on_soil_slip_as_the_longitudinal_ones_do() {
    let mut model = model(
        terrain::<Flat>("()"),
        soil::<Brixius>("(cone_index_pa: 900e3, construction: Radial, pass_factor: 1.5)"),
    );
    model.driveline = Box::new(Ideal);
    let pull = Box::new(ron::from_str::<Drawbar>("(force_n: 30e3)").unwrap());
    model.tasks.push(Named { name: "Drawbar".to_owned(), plugin: pull });
    let cycle = cycle(2.0, vec![Phase::Hold { for_s: 10.0 }], 1e-3);
    let (one, three) = (simulate(&model, &cycle).unwrap(), run(&model, &cycle));
    assert_eq!(three.end, End::Finished);
    for (name, within) in [("slip", 5e-3), ("tractive_force_n", 5e-3), ("axle_1_load_n", 5e-3)] {
        let (a, b) = (last(&one, name), last(&three, name));
        assert!((b / a - 1.0).abs() < within, "{name}: {a} {b}");
    }
}

#[test]
fn wheels_that_are_asked_for_more_than_the_soil_gives_dig_in() {
    let mut model = model(
        terrain::<Flat>("()"),
        soil::<Brixius>("(cone_index_pa: 250e3, construction: Radial, pass_factor: 1.5)"),
    );
    model.driveline = Box::new(Ideal);
    let pull = Box::new(ron::from_str::<Drawbar>("(force_n: 90e3)").unwrap());
    model.tasks.push(Named { name: "Drawbar".to_owned(), plugin: pull });
    let outcome = run(&model, &cycle(2.0, vec![Phase::Hold { for_s: 30.0 }], 1e-3));
    let End::Stopped { reason, .. } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("slip past the limit"), "{reason}");
}

/// Ice to the left, firm ground to the right.
#[derive(Debug)]
struct Split;

impl Soil for Split {
    fn resistance_n(&self, _: &Contact) -> f64 {
        f64::NAN
    }

    fn needs_axles(&self) -> bool {
        true
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        let holds = if contact.place.east_m < 0.0 { 0.1 } else { 0.7 };
        Some(Footing {
            gross_traction_n: contact.load_n * holds * (12.0 * contact.slip / holds).tanh(),
            motion_resistance_n: 0.02 * contact.load_n,
            sinkage_m: 0.0,
        })
    }
}

/// Open differentials give both sides what the ice holds, 2 · 0.1 · W / 2 = 12.8 kN less what resists: not the 25 kN that are
/// pulled. Locked ones give each side its own, up to (0.1 + 0.7) W / 2 = 51 kN.
#[test]
fn with_one_side_on_ice_locked_differentials_pull_what_open_ones_do_not() {
    let end = |differential: Differential| {
        let mut model = model(terrain::<Flat>("()"), Box::new(Split));
        model.driveline = Box::new(Ideal);
        let pull = Box::new(ron::from_str::<Drawbar>("(force_n: 25e3)").unwrap());
        model.tasks.push(Named { name: "Drawbar".to_owned(), plugin: pull });
        let mut chassis = chassis();
        for axle in &mut chassis.axles {
            axle.differential = differential;
        }
        let cycle = cycle(2.0, vec![Phase::Hold { for_s: 6.0 }], 1e-3);
        crate::simulate(&model, &chassis, &cycle, 0.0).unwrap()
    };
    let locked = end(Differential::Locked);
    assert_eq!(locked.end, End::Finished);
    let of = |side: &str| {
        last(&locked, &format!("axle_1_{side}_traction_n"))
            + last(&locked, &format!("axle_2_{side}_traction_n"))
    };
    let (ice_n, firm_n) = (of("left"), of("right"));
    assert!(ice_n < 0.1 * 0.55 * MASS_KG * GRAVITY && firm_n > 2.0 * ice_n, "{ice_n} {firm_n}");
    // Pull, motion resistance, air: nothing is left over that would speed it up.
    let resisting_n = 25e3 + 0.02 * MASS_KG * GRAVITY + last(&locked, "air_resistance_n");
    assert!(((ice_n + firm_n) / resisting_n - 1.0).abs() < 0.01, "{ice_n} {firm_n}");
    let open = end(Differential::Open);
    let End::Stopped { reason, .. } = &open.end else { panic!("{:?}", open.end) };
    assert!(reason.contains("slip past the limit"), "{reason}");
}

#[test]
fn driving_and_braking_leave_a_ledger_that_closes() {
    let mut model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.05)"));
    model.driveline = Box::new(Ideal);
    let phases = vec![
        Phase::Reach { speed_m_s: 8.0, acceleration_m_s2: 0.8 },
        Phase::Hold { for_s: 2.0 },
        Phase::Drive { speed_m_s: 0.0, acceleration_m_s2: 2.0, tolerance_m_s: None, until: Until::Stopped },
        Phase::Stand { until: Until::Elapsed(1.0) },
    ];
    let cycle = cycle(0.0, phases, STEP_S);
    let (one, three) = (simulate(&model, &cycle).unwrap(), run(&model, &cycle));
    assert_eq!(three.end, End::Finished);
    assert!(
        three.ledger.relative_residual() < 1e-3,
        "{} {:?}",
        three.ledger.relative_residual(),
        three.ledger
    );
    let took = |outcome: &Outcome, name: &str| {
        outcome.ledger.sinks.iter().find(|sink| sink.name == name).unwrap().energy_j
    };
    // Tyres that drive slip on any ground; the longitudinal ones do not where the soil knows no slip. Those that brake slip
    // too, and take it from the motion.
    let more_j = three.ledger.source_j - one.ledger.source_j;
    let slip_j = took(&three, "slip");
    assert!((0.5 * slip_j..slip_j).contains(&more_j), "{more_j} {slip_j}");
    let (brakes, slower) = (took(&three, "brakes"), took(&one, "brakes"));
    assert!((brakes / slower - 1.0).abs() < 0.03, "{brakes} {slower}");
}
