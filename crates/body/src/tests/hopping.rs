//! Masses below the suspension: the quarter car's two frequencies, loads at rest, energy, and what is refused.

use super::{GRAVITY, MASS_KG, Tow, chassis, coast_down, cycle, hitched, last, model, soil, terrain};
use crate::chassis::{Chassis, Suspension};
use crate::rig::Rig;
use crate::simulate;
use crate::tests::swinging::{StepUp, peak};
use headland_plugin::{Load, Situation, Task};
use headland_sim::{Axles, Carriage, Model, Named, Outcome, Phase, Start, Until};
use headland_soil::Constant;
use headland_terrain::{ConstantGrade, Flat};

const SPRING_N_M: f64 = 300e3;
const HUB_KG: f64 = 450.0;

fn hopping(damping_n_s_m: f64, unsprung_mass_kg: f64) -> Chassis {
    let mut chassis = chassis();
    for axle in &mut chassis.axles {
        axle.suspension = Some(Suspension { stiffness_n_m: SPRING_N_M, damping_n_s_m, unsprung_mass_kg });
    }
    chassis
}

/// The centre of gravity in the middle: bounce alone moves it.
fn even(mut model: Model) -> Model {
    model.axles = Some(Axles::new(vec![super::axle(1.8), super::axle(-1.8)], 1.3, 0.7, 0.5).unwrap());
    model
}

fn over_the_step(chassis: &Chassis, step_s: f64) -> Outcome {
    let model = even(model(Box::new(StepUp), soil::<Constant>("(coefficient: 0.0001)")));
    let cycle = cycle(6.0, vec![Phase::Coast { until: Until::Elapsed(5.5) }], step_s);
    simulate(&model, chassis, &cycle, 0.0).unwrap()
}

/// Angular frequencies of a mass on a spring on a smaller mass on a tyre, the roots of
/// m_s m_u ω⁴ − (m_s (k_s + k_t) + m_u k_s) ω² + k_s k_t = 0 [rad/s].
fn quarter_car(sprung_kg: f64, unsprung_kg: f64, spring: f64, tyre: f64) -> [f64; 2] {
    let middle = sprung_kg * (spring + tyre) + unsprung_kg * spring;
    let apart = (middle * middle - 4.0 * sprung_kg * unsprung_kg * spring * tyre).sqrt();
    [middle - apart, middle + apart].map(|sum| (0.5 * sum / (sprung_kg * unsprung_kg)).sqrt())
}

/// Of 3.25 t on each wheel 450 kg hop: at 1.3 Hz the body, at 7.4 Hz the wheels, both within a hundredth.
#[test]
fn body_and_wheels_swing_at_the_frequencies_of_the_quarter_car() {
    let mut chassis = hopping(400.0, HUB_KG);
    for axle in &mut chassis.axles {
        axle.damping_n_s_m = 0.0;
    }
    let outcome = over_the_step(&chassis, 1e-3);
    let tyre = 1e6 / (0.365 + 170.0 / 150.0);
    let [bounce, hop] = quarter_car(MASS_KG / 4.0 - HUB_KG, HUB_KG, SPRING_N_M, tyre);
    let times = outcome.trace.time_s();
    let rows: Vec<usize> = (0..times.len()).filter(|row| times[*row] > 1.5).collect();
    let heights = super::channel(&outcome, "height_m");
    // Their sum: pitch and roll cancel in it.
    let given: Vec<&[f64]> = ["1_left", "1_right", "2_left", "2_right"]
        .iter()
        .map(|wheel| super::channel(&outcome, &format!("axle_{wheel}_deflection_m")))
        .collect();
    let at: Vec<f64> = rows.iter().map(|row| times[*row]).collect();
    let body: Vec<f64> = rows.iter().map(|row| heights[*row]).collect();
    let tyres: Vec<f64> = rows.iter().map(|row| given.iter().map(|own| own[*row]).sum()).collect();
    let found = [peak(&at, &body, (0.7 * bounce, 1.4 * bounce)), peak(&at, &tyres, (0.7 * hop, 1.4 * hop))];
    assert!((found[0] / bounce - 1.0).abs() < 0.01, "{found:?} {bounce}");
    assert!((found[1] / hop - 1.0).abs() < 0.01, "{found:?} {hop}");
}

/// A suspension carries all but the hub: (W / 4 − m g) / k; and so it stays, also on a slope.
#[test]
fn at_rest_tyres_carry_the_hub_and_the_suspension_does_not() {
    for grade in [0.0, 0.15] {
        let ground = terrain::<ConstantGrade>(&format!("(grade: {grade})"));
        let model = even(model(ground, soil::<Constant>("(coefficient: 0.07)")));
        let cycle = cycle(0.0, vec![Phase::Stand { until: Until::Elapsed(5.0) }], 2e-3);
        let outcome = simulate(&model, &hopping(15e3, HUB_KG), &cycle, 0.0).unwrap();
        let cos = 1.0 / f64::hypot(grade, 1.0);
        let squeezed: f64 =
            [1, 2].map(|axle| last(&outcome, &format!("axle_{axle}_left_suspension_m"))).iter().sum();
        let expected = 2.0 * (MASS_KG / 4.0 - HUB_KG) * GRAVITY * cos / SPRING_N_M;
        assert!((squeezed / expected - 1.0).abs() < 1e-4, "{squeezed} {expected}");
        let loads: f64 = [1, 2].map(|axle| last(&outcome, &format!("axle_{axle}_load_n"))).iter().sum();
        assert!((loads / (MASS_KG * GRAVITY * cos) - 1.0).abs() < 1e-4, "{loads}");
        let squeezes = super::channel(&outcome, "axle_1_left_suspension_m");
        if grade == 0.0 {
            assert!(
                squeezes.iter().all(|now| (now / squeezes[0] - 1.0).abs() < 1e-6),
                "it stands as it was put"
            );
        }
    }
}

/// A push of 25 kN at the hitch.
#[derive(Debug)]
struct Pushed;

impl Task for Pushed {
    fn load(&self, _: &Situation, _: &[f64], _: &mut [f64]) -> Load {
        Load { force_n: 25e3, ..Load::default() }
    }
}

/// Braked on the level and pushed, the body nods and its wheels hop: what is left over of the energy is the error of the step.
#[test]
fn wheels_that_hop_leave_a_ledger_that_closes_at_first_order() {
    let residual_j = |step_s: f64| {
        let mut level = even(model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.05)")));
        level.tasks.push(Named { name: "pushed".to_owned(), plugin: Box::new(Pushed) });
        let cycle = cycle(0.0, vec![Phase::Stand { until: Until::Elapsed(1.0) }], step_s);
        let outcome = simulate(&level, &hopping(4e3, HUB_KG), &cycle, 0.0).unwrap();
        let moved = super::channel(&outcome, "axle_1_left_suspension_m");
        assert!(moved.iter().any(|now| (now - moved[0]).abs() > 5e-3), "it nods");
        outcome.ledger.residual_j
    };
    let [coarse, middle, fine] = [2e-3, 1e-3, 5e-4].map(residual_j);
    let order = ((coarse - middle) / (middle - fine)).log2();
    assert!((order - 1.0).abs() < 0.1 && fine.abs() < 0.6 * middle.abs(), "{coarse} {middle} {fine}");
}

/// Over a step up, whose planes of the ground turn, hubs leave no more of the energy than none do.
#[test]
fn over_a_bump_hubs_leave_a_ledger_that_closes_as_without_them() {
    let [with, without] =
        [HUB_KG, 0.0].map(|hub_kg| over_the_step(&hopping(15e3, hub_kg), 1e-3).ledger.residual_j);
    assert!((with / without - 1.0).abs() < 0.05, "{with} {without}");
    let rough = model(Box::new(StepUp), soil::<Constant>("(coefficient: 0.07)"));
    let outcome = simulate(&rough, &hopping(15e3, HUB_KG), &cycle(8.0, coast_down(), 1e-3), 0.0).unwrap();
    assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
    let took = |name: &str| outcome.ledger.sinks.iter().find(|sink| sink.name == name).unwrap().energy_j;
    assert!(took("suspension damping") > 100.0 && took("tyre damping") > 10.0, "{:?}", outcome.ledger);
}

/// A hub of 10 kg is none: bodies with it and without it go up the step alike.
#[test]
fn a_light_hub_is_as_none() {
    let [light, none] = [10.0, 0.0].map(|hub_kg| over_the_step(&hopping(15e3, hub_kg), 4e-4));
    let heights = |outcome: &Outcome| super::channel(outcome, "height_m").to_vec();
    let furthest = heights(&light).iter().zip(heights(&none)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(furthest < 3e-4, "of 30 mm: {furthest}");
}

/// Vehicle and trailer with hubs of their own: the coupling is that of the last step where their accelerations are found.
#[test]
fn a_trailer_may_have_hubs_too_and_the_ledger_closes() {
    let mut chassis = hopping(15e3, 300.0);
    chassis.trailer = hitched().trailer;
    chassis.trailer.as_mut().unwrap().axles[0].body.suspension =
        Some(Suspension { stiffness_n_m: 400e3, damping_n_s_m: 12e3, unsprung_mass_kg: 350.0 });
    let mut model = model(Box::new(StepUp), soil::<Constant>("(coefficient: 0.05)"));
    model.tasks.push(Named { name: "trailer".to_owned(), plugin: Box::new(Tow) });
    let outcome = simulate(&model, &chassis, &cycle(7.0, coast_down(), 1e-3), 0.0).unwrap();
    assert_eq!(outcome.end, headland_sim::End::Finished);
    assert!(outcome.ledger.relative_residual() < 1e-3, "{:?}", outcome.ledger);
    let rows = super::channel(&outcome, "trailer_axle_1_left_suspension_m");
    let moved = rows.iter().fold(0.0f64, |most, now| most.max((now - rows[0]).abs()));
    assert!(moved > 2e-3, "its wheels hop over the step: {moved}");
}

#[test]
fn hubs_that_a_body_cannot_have_are_refused_by_name() {
    let model = even(model(terrain::<Flat>("()"), soil::<Constant>("(coefficient: 0.07)")));
    let told = |chassis: &Chassis, step_s: f64| {
        Rig::new(&model, chassis, Start::default(), step_s).unwrap_err().to_string()
    };
    let heavy = told(&hopping(15e3, 4_000.0), 1e-3);
    assert!(heavy.contains("`axles.0.suspension.unsprung_mass_kg` is 4000"), "{heavy}");
    assert!(heavy.contains("less than the 3255 kg that stand on the left wheel of axle 1"), "{heavy}");
    // Four hubs of 3 t at 1.8 m: 38 900 kg m², and the whole vehicle has 32 000.
    let lean = told(&hopping(15e3, 3_000.0), 1e-3);
    assert!(lean.contains("`roll_inertia_kg_m2` is 9000 kg m²") && lean.contains("13230 kg m²"), "{lean}");
    let long = told(&hopping(15e3, 40.0), 4e-3);
    assert!(
        long.contains("`step_s` is 0.004") && long.contains("a hub between tyre and suspension hops"),
        "{long}"
    );
    let light = hopping(15e3, HUB_KG);
    let fits = Rig::new(&model, &light, Start::default(), 2e-3);
    let loads = [0, 1].map(|axle| fits.as_ref().unwrap().axle(axle).load_n);
    assert!((loads[0] + loads[1]) / (MASS_KG * GRAVITY) - 1.0 < 1e-9, "{loads:?}");
}
