//! What is loaded on the way, and ground that gives way.

use super::{GRAVITY, MASS_KG, chassis, coast_down, cycle, last, model, run, soil, terrain};
use crate::chassis::Payload;
use crate::simulate;
use headland_plugin::{Contact, Footing, Load, Situation, Soil, Task, WheelContact};
use headland_sim::{End, Named, Phase, Until};
use headland_soil::Constant;
use headland_terrain::Flat;

/// A tank that fills by 500 kg each second, up to 2 t.
#[derive(Debug)]
struct Filling;

impl Task for Filling {
    fn load(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        Load { mass_kg: (500.0 * at.time_s).min(2_000.0), ..Load::default() }
    }
}

/// 2 t, 1 m behind the centre of gravity: the rear axle, 2 m behind it, takes 2 t g (1.6 + 1) / 3.6.
#[test]
fn what_is_loaded_presses_the_axles_by_the_lever_and_the_ledger_closes() {
    let mut model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.03)"));
    model.tasks.push(Named { name: "filling".to_owned(), plugin: Box::new(Filling) });
    let mut laden = chassis();
    laden.payload = Some(Payload { position_m: -1.0, height_m: 1.3 });
    let level = cycle(3.0, vec![Phase::Coast { until: Until::Elapsed(7.0) }], 2e-3);
    let outcome = simulate(&model, &laden, &level, 0.0).unwrap();
    assert_eq!(outcome.end, End::Finished);
    assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
    let before_n = MASS_KG * GRAVITY * 1.6 / 3.6;
    let slowing_n = 15_019.3 * 0.03 * GRAVITY * (1.3 - 0.95) / 3.6;
    let added_n = last(&outcome, "axle_2_load_n") - before_n + slowing_n;
    let by_hand = 2_000.0 * GRAVITY * 2.6 / 3.6;
    assert!((added_n / by_hand - 1.0).abs() < 0.01, "{added_n} {by_hand}");
    // The height is the vehicle's own: it falls by what the tyres give way, and not by where the load is.
    let fallen_m = |channel: &str| last(&outcome, channel) - super::channel(&outcome, channel)[0];
    let [front_m, rear_m] = ["axle_1_left_deflection_m", "axle_2_left_deflection_m"].map(fallen_m);
    let given_m = (2.0 * front_m + 1.6 * rear_m) / 3.6;
    assert!((fallen_m("height_m") + given_m).abs() < 2e-4, "{} {given_m}", fallen_m("height_m"));
    let nowhere = simulate(&model, &chassis(), &level, 0.0).unwrap();
    let End::Stopped { reason, .. } = nowhere.end else { panic!("{:?}", nowhere.end) };
    assert!(reason.contains("no `payload`"), "{reason}");
}

/// Firm for 5 m, and bottomless behind.
#[derive(Debug)]
struct Bog;

impl Soil for Bog {
    fn resistance_n(&self, _: &Contact) -> f64 {
        f64::NAN
    }

    fn needs_axles(&self) -> bool {
        true
    }

    fn wheel(&self, contact: &WheelContact) -> Option<Footing> {
        if contact.position_m > 5.0 {
            let sinkage_m = f64::INFINITY;
            return Some(Footing { gross_traction_n: f64::NAN, motion_resistance_n: f64::NAN, sinkage_m });
        }
        Some(Footing {
            gross_traction_n: 8.0 * contact.slip * contact.load_n,
            motion_resistance_n: 0.05 * contact.load_n,
            sinkage_m: 1e-6 * contact.load_n,
        })
    }
}

#[test]
fn a_wheel_that_sinks_to_its_hub_ends_the_run_and_is_named() {
    let model = model(terrain::<Flat>("()"), Box::new(Bog));
    let outcome = run(&model, &cycle(4.0, coast_down(), 2e-3));
    let End::Stopped { reason, position_m, .. } = &outcome.end else { panic!("{:?}", outcome.end) };
    assert!(reason.contains("wheel of axle 1 sinks to its hub"), "{reason}");
    assert!((position_m - 3.4).abs() < 0.05, "{position_m}");
    // Up to there the front wheels stand in ruts of a µm per newton: 35 kN make 35 mm.
    let ruts = super::channel(&outcome, "axle_1_left_sinkage_m");
    assert!((ruts[ruts.len() - 10] - 0.0355).abs() < 2e-3, "{}", ruts[ruts.len() - 10]);
}

/// Ground that has no number for its resistance behind 5 m, as a plugin of the user's own may have none.
#[derive(Debug)]
struct Unsaid(f64);

impl Soil for Unsaid {
    fn resistance_n(&self, contact: &Contact) -> f64 {
        if contact.position_m > 5.0 { self.0 } else { 0.05 * contact.load_n }
    }
}

/// It was taken for none: the vehicle rolled on as if nothing resisted it, and the run was said to be finished.
#[test]
fn a_resistance_that_is_no_number_ends_the_run_with_its_place_and_what_was_before() {
    for broken in [f64::NAN, f64::INFINITY] {
        let model = model(terrain::<Flat>("()"), Box::new(Unsaid(broken)));
        let outcome = run(&model, &cycle(4.0, coast_down(), 2e-3));
        let End::Stopped { reason, position_m, .. } = &outcome.end else {
            panic!("{broken}: {:?}", outcome.end)
        };
        assert!(reason.contains("expected a finite force"), "{reason}");
        assert!((3.3..3.5).contains(position_m), "{position_m}");
        assert!(super::channel(&outcome, "speed_m_s").iter().all(|speed| speed.is_finite()));
    }
}

/// Something at the hitch that from 1 s on pulls back, or pushes, with so much.
#[derive(Debug)]
struct Hauled(Load);

impl Task for Hauled {
    fn load(&self, at: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        if at.time_s >= 1.0 { self.0 } else { Load::default() }
    }
}

/// Rolls out from 4 m/s against such a load; gives why it ended, where, and its run.
fn hauled(load: Load) -> (String, f64, headland_sim::Outcome) {
    let mut model = model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.03)"));
    model.tasks.push(Named { name: "hauled".to_owned(), plugin: Box::new(Hauled(load)) });
    let outcome = run(&model, &cycle(4.0, coast_down(), 2e-3));
    let End::Stopped { reason, position_m, time_s } = outcome.end.clone() else {
        panic!("{load:?}: {:?}", outcome.end)
    };
    assert!((time_s - 1.0).abs() < 3e-3, "{time_s}");
    (reason, position_m, outcome)
}

/// A pull without measure took the vehicle to a speed that has no square; that was taken for none, and the run was said to be
/// finished. Now it ends before the step: 4 t − ½ 0.03 g t² on the way, and everything up to there is a number that closes.
#[test]
fn forces_without_measure_end_the_run_where_they_begin_and_keep_what_was_before() {
    let most = f64::MAX;
    let back = |drawbar_force_n| Load { drawbar_force_n, ..Load::default() };
    let push = |force_n| Load { force_n, ..Load::default() };
    for load in [back(most), push(most), push(-most), back(1e200)] {
        let (reason, position_m, outcome) = hauled(load);
        assert!(reason.contains("the motion is no finite number"), "{reason}");
        assert!((position_m - (4.0 - 0.015 * GRAVITY)).abs() < 0.02, "{position_m}");
        let trace = &outcome.trace;
        assert!(trace.len() > 490 && (trace.time_s().last().unwrap() - 1.0).abs() < 3e-3);
        for channel in ["position_m", "speed_m_s", "height_m", "pitch_rad", "axle_1_left_load_n"] {
            assert!(super::channel(&outcome, channel).iter().all(|value| value.is_finite()), "{channel}");
        }
        assert!((last(&outcome, "speed_m_s") - (4.0 - 0.03 * GRAVITY)).abs() < 0.02);
        assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
    }
}

/// 100 MN make 15 m/s of 13 t within 2 ms, 10 GN 1500 m/s: the vehicle stood after one such step, and was said to be finished.
#[test]
fn a_pull_that_throws_the_vehicle_back_within_a_step_ends_the_run() {
    for (drawbar_force_n, told) in [
        (1e8, "turns 3.7 m/s into -11"),
        (1e10, "rolls past its footprint"),
        (1e150, "rolls past its footprint"),
    ] {
        let (reason, position_m, outcome) = hauled(Load { drawbar_force_n, ..Load::default() });
        assert!(reason.contains(told) && reason.len() < 200, "{reason}");
        assert!((3.8..3.9).contains(&position_m), "{position_m}");
        assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
    }
}

/// A driveline that takes back what it is asked to, at any speed.
#[derive(Debug)]
struct TakesBack;

impl headland_plugin::Driveline for TakesBack {
    fn losses(&self) -> &'static [&'static str] {
        &[]
    }

    fn source(&self) -> &'static str {
        "store"
    }

    fn rotating_mass_kg(&self, _: bool) -> f64 {
        100.0
    }

    fn deliver(
        &self,
        demand: &headland_plugin::Demand,
        _: &[f64],
        _: &mut [f64],
    ) -> headland_plugin::Delivery {
        let force_n = if demand.coasting { 0.0 } else { demand.force_n.max(-120e3) };
        let source_power_w = force_n * demand.speed_m_s;
        headland_plugin::Delivery { force_n, source_power_w, ..headland_plugin::Delivery::NOTHING }
    }
}

/// Wheels that stood were driven backward by a driveline that braked, which knew nothing of it: slip took energy that nobody gave.
#[test]
fn a_hard_stop_closes_its_ledger_better_the_shorter_its_steps() {
    let left = |step_s: f64| {
        let ground = super::terrain::<Flat>("()");
        let mut model = super::model(ground, super::soil::<Constant>("(coefficient: 0.06)"));
        model.driveline = Box::new(TakesBack);
        let phases =
            vec![Phase::Reach { speed_m_s: 0.0, acceleration_m_s2: 5.0 }, Phase::Hold { for_s: 1.0 }];
        let outcome = super::run(&model, &super::cycle(5.5, phases, step_s));
        assert_eq!(outcome.end, End::Finished);
        outcome.ledger.relative_residual()
    };
    let all = [2e-3, 1e-3, 5e-4, 2.5e-4].map(left);
    // First order or better: each half of a step leaves half or less.
    assert!(all[1] < 1e-3 && all.windows(2).all(|pair| pair[1] < 0.55 * pair[0]), "{all:?}");
}

/// Brakes that lock every wheel pitch the body while they stop the wheels. What spins a wheel turned the body, and nothing of the
/// body's turning came back to the wheel; a driveline that held wheels which rolled back took that for nothing; and of wheels
/// that brakes stop within one step, what turned the body in that step came a step too late to them. Each left a share of the
/// energy that no shorter step made less.
#[test]
fn a_stop_on_wheels_that_lock_closes_its_ledger_at_first_order() {
    let left = |step_s: f64, for_s: f64| {
        let ground = super::terrain::<Flat>("()");
        let mut model = super::model(ground, super::soil::<Constant>("(coefficient: 0.06)"));
        model.driveline = Box::new(super::Ideal);
        let mut phases = vec![Phase::Reach { speed_m_s: 0.0, acceleration_m_s2: 9.0 }];
        phases.extend((for_s > 0.0).then_some(Phase::Hold { for_s }));
        let outcome = super::run(&model, &super::cycle(8.0, phases, step_s));
        assert_eq!(outcome.end, End::Finished);
        let slips = super::channel(&outcome, "axle_1_left_slip");
        assert!(slips.iter().any(|slip| *slip < -0.9), "its wheels have to slide");
        (outcome.ledger.relative_residual(), super::last(&outcome, "position_m"))
    };
    // Until it stands, and with the rocking after that, of which the tyres wind up and unwind. Brakes let go and hold within a
    // step of the moment that is due: of first order, too, though not the same part of each step.
    for for_s in [0.0, 0.2, 1.0] {
        let all = [1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5].map(|step_s| left(step_s, for_s));
        let halves = all.windows(2).all(|pair| pair[1].0 < 0.55 * pair[0].0);
        assert!(all[0].0 < 1e-4 && halves, "rocking for {for_s} s: {all:?}");
        let off_m: Vec<f64> = all[..4].iter().map(|(_, way_m)| (way_m - all[4].1).abs()).collect();
        assert!(off_m.windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "rocking for {for_s} s: {off_m:?}");
    }
}

/// A tyre that had slid was wound up as if it had gripped all the way: 0.7 m, by which it pushed the vehicle back with all its
/// friction and spun the wheels at 5 m/s. It grips over 3 μ σ / c = 0.14 m, and a second after the stop the vehicle stands.
#[test]
fn tyres_that_slid_to_a_stop_rock_no_further_than_they_grip() {
    let ground = super::terrain::<Flat>("()");
    let mut model = super::model(ground, super::soil::<Constant>("(coefficient: 0.06)"));
    model.driveline = Box::new(super::Ideal);
    let phases = vec![Phase::Reach { speed_m_s: 0.0, acceleration_m_s2: 9.0 }, Phase::Hold { for_s: 1.0 }];
    let outcome = super::run(&model, &super::cycle(8.0, phases, 1e-3));
    let (ways, speeds) = (super::channel(&outcome, "position_m"), super::channel(&outcome, "speed_m_s"));
    let stopped = speeds.iter().position(|speed| *speed <= 0.0).unwrap();
    let furthest_m = ways[stopped..].iter().map(|way| (way - ways[stopped]).abs()).fold(0.0, f64::max);
    let grips_m = 3.0 * 0.8 * 0.7 / 12.0;
    assert!(furthest_m < 1.5 * grips_m, "{furthest_m} m");
    let fastest_m_s = speeds[stopped..].iter().fold(0.0, |most: f64, speed| most.max(speed.abs()));
    assert!(fastest_m_s < 1.0 && *speeds.last().unwrap() == 0.0, "{fastest_m_s} m/s");
}
